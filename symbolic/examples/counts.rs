//! Prints `docs/counts.md`.

#[path = "../tests/counts/table.rs"]
mod table;

fn main() {
    print!("{}", table::table());
}
