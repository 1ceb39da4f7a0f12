//! Prints `docs/elimination.md`.

#[path = "../tests/elimination/models.rs"]
mod models;
#[path = "../tests/elimination/table.rs"]
mod table;

fn main() {
    print!("{}", table::page());
}
