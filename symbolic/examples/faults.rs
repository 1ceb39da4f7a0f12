//! Prints `docs/faults.md`.

#[path = "../tests/faults/table.rs"]
mod table;

fn main() {
    let few = std::env::args().any(|word| word == "--few");
    let extent = if few { table::Extent::Test } else { table::Extent::Page };
    let outcomes = table::plant_all(extent, true);
    for wrong in table::wrong(&outcomes) {
        eprintln!("{wrong}");
    }
    print!("{}", table::page(&outcomes, &table::smallest(extent), &table::held(extent)));
}
