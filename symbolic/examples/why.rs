//! Prints `docs/why-it-did-not-compile.md`.

#[path = "../tests/why/page.rs"]
mod page;

fn main() {
    print!("{}", page::page());
}
