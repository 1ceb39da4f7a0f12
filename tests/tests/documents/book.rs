//! The book: all of its pages are in its table of contents, its commands print what they show, its pictures are what its commands draw, and its
//! Rust is that of examples that are compiled.

use std::path::PathBuf;

use super::commands::{Outcome, WRITE_PICTURES, run_page};
use super::page::{blocks, pages, root, targets};

const PAGES: &str = "docs/book/src";
/// All pictures together, bytes: a clone should not become heavy by them.
const MOST_BYTES: u64 = 1_500_000;

fn pictures() -> PathBuf {
    root().join(PAGES).join("pictures")
}

#[test]
fn the_table_of_contents_has_every_page() {
    let contents = std::fs::read_to_string(root().join(PAGES).join("SUMMARY.md")).expect("the table of contents");
    let listed = targets(&contents);
    for (page, _) in pages(PAGES) {
        let name = page.file_name().expect("a name").to_string_lossy().into_owned();
        assert!(name == "SUMMARY.md" || listed.contains(&name), "{name} is not in the table of contents");
    }
}

/// Each page in a thread of its own.
#[test]
fn every_command_of_the_book_prints_what_it_shows() {
    let pages = pages(PAGES);
    let outcomes: Vec<Outcome> = std::thread::scope(|scope| {
        let runs: Vec<_> = pages.iter().map(|(path, text)| scope.spawn(|| run_page(path, text))).collect();
        runs.into_iter().map(|run| run.join().expect("the page's commands print what it shows")).collect()
    });
    let commands: usize = outcomes.iter().map(|outcome| outcome.commands).sum();
    assert!(commands > 90, "only {commands} commands");
    let drawn = || outcomes.iter().flat_map(|outcome| outcome.pictures.iter().map(move |name| (name, &outcome.folder)));
    let shown = |name: &str| pages.iter().any(|(_, text)| targets(text).contains(&format!("pictures/{name}")));
    if std::env::var_os(WRITE_PICTURES).is_some() {
        for (name, folder) in drawn().filter(|(name, _)| shown(name)) {
            std::fs::copy(folder.join(name), pictures().join(name)).expect("a picture");
        }
    }
    let mut bytes = 0;
    for entry in std::fs::read_dir(pictures()).expect("the book's pictures") {
        let entry = entry.expect("an entry");
        let name = entry.file_name().to_string_lossy().into_owned();
        bytes += entry.metadata().expect("its size").len();
        assert!(drawn().any(|(other, _)| *other == name), "no command of the book draws {name}");
        assert!(shown(&name), "no page shows {name}");
    }
    assert!(bytes < MOST_BYTES, "the pictures have {bytes} bytes");
}

/// A block of Rust stands word for word in the file that the last link before it names.
#[test]
fn the_rust_of_the_book_is_that_of_examples() {
    let mut compared = 0;
    for (path, text) in pages(PAGES) {
        let mut named = None;
        for block in blocks(&text) {
            named = targets(block.before).into_iter().rfind(|target| target.ends_with(".rs")).or(named);
            if block.kind != "rust" {
                continue;
            }
            compared += 1;
            let file = named.as_deref().unwrap_or_else(|| panic!("{}: no example is named", path.display()));
            let source = std::fs::read_to_string(root().join(PAGES).join(file)).expect("an example");
            let trimmed = |text: &str| text.lines().map(str::trim).collect::<Vec<_>>().join("\n");
            let stands = trimmed(&source).contains(trimmed(block.text).trim());
            assert!(stands, "{}: this does not stand in {file}:\n{}", path.display(), block.text);
        }
    }
    assert!(compared >= 2, "only {compared} blocks");
}
