//! `docs/why-it-did-not-compile.md` is that of the catalogue and its examples.
//!
//! With `UPDATE_EXPECTED=1` in the environment the page is written anew.

mod page;

use dalembert_symbolic::diagnose::catalogue::CATALOGUE;
use std::fs;
use std::path::PathBuf;

#[test]
fn the_page_is_that_of_the_catalogue() {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../docs/why-it-did-not-compile.md");
    let now = page::page();
    if std::env::var_os("UPDATE_EXPECTED").is_some() {
        fs::write(&file, &now).unwrap();
    }
    let held = fs::read_to_string(&file).unwrap_or_default();
    let differs = now.lines().zip(held.lines()).find(|(a, b)| a != b);
    assert!(now == held, "regenerate docs/why-it-did-not-compile.md; the first line that differs: {differs:?}");
}

#[test]
fn every_kind_of_error_has_a_section_with_an_example() {
    let page = page::page();
    let sections: Vec<&str> = page.split("\n### ").skip(1).collect();
    assert_eq!(sections.len(), CATALOGUE.iter().map(|s| s.len()).sum::<usize>());
    for section in sections {
        let code = section.split(' ').next().unwrap_or("");
        let said = section.contains(&format!("[{code}]: "));
        assert!(said || section.contains("No file of a few lines"), "{section}");
    }
}
