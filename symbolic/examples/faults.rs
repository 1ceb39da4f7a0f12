//! Prints `docs/faults.md`.

#[path = "../tests/faults/table.rs"]
mod table;

fn main() {
    let outcomes = table::plant_all(&table::Extent::TEST, true);
    for wrong in table::wrong(&outcomes) {
        eprintln!("{wrong}");
    }
    print!("{}", table::page(&outcomes));
}
