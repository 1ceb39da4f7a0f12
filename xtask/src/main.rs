//! Work on the project itself: `cargo xtask golden`, `cargo xtask book`, `cargo xtask page`,
//! `cargo xtask constants`, `cargo xtask man`.

mod book;
mod constants;
mod golden;
mod man;
mod page;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

const USAGE: &str = "\
cargo xtask golden --record   write down what the program prints of every model and error
cargo xtask golden            compare with what was written down, and tell what differs
cargo xtask book              build the book in docs/book as a web site, with mdBook
cargo xtask page -o FOLDER     write dalembert.html there: the library in a browser, as one file
cargo xtask constants FILES [--by TESTS]  change thresholds of these files, and tell which changes none of these programs of tests notices, or none at all
cargo xtask man -o FOLDER      write a man page of the program and of each of its commands there";

/// The workspace's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_owned()
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match arguments.as_slice() {
        ["golden", "--record"] => golden::record(),
        ["golden"] => golden::compare(),
        ["book"] => book::build(),
        ["page", "-o", folder] => page::build(folder),
        ["constants", arguments @ ..] if !arguments.is_empty() => {
            let mut lists = arguments.split(|argument| *argument == "--by");
            constants::study(lists.next().unwrap_or_default(), lists.next().unwrap_or_default())
        }
        ["man", "-o", folder] => man::write(folder),
        _ => Err(USAGE.to_owned()),
    };
    match outcome {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(text) => {
            eprintln!("{text}");
            ExitCode::FAILURE
        }
    }
}
