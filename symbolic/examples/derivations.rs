//! Prints `docs/derivations.md`.

#[path = "../tests/derivations/table.rs"]
mod table;

fn main() {
    print!("{}", table::page());
}
