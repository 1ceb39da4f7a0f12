//! Prints `docs/faults.md`.

#[path = "../tests/faults/table.rs"]
mod table;

fn main() {
    let outcomes = table::plant_all();
    for wrong in table::wrong(&outcomes) {
        eprintln!("{wrong}");
    }
    print!("{}", table::page(&outcomes));
}
