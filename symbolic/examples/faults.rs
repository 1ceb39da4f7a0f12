//! Prints `docs/faults.md`.

#[path = "../tests/faults/table.rs"]
mod table;

fn main() {
    let extent = if std::env::args().any(|word| word == "--few") { table::Extent::TEST } else { table::Extent::PAGE };
    let outcomes = table::plant_all(&extent, true);
    for wrong in table::wrong(&outcomes) {
        eprintln!("{wrong}");
    }
    print!("{}", table::page(&outcomes, &table::smallest(&extent)));
}
