//! Links and anchors of the documents lead somewhere.

use std::path::Path;

use super::page::{anchors, pages, root, targets};

/// What is wrong with a link from a page, if anything.
fn broken(page: &Path, text: &str, target: &str) -> Option<String> {
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() { page.to_owned() } else { page.parent()?.join(file) };
    if !path.exists() {
        return Some(format!("{}: `{target}` does not exist", page.display()));
    }
    let other = if file.is_empty() { text.to_owned() } else { std::fs::read_to_string(&path).unwrap_or_default() };
    let found = anchor.is_empty() || anchors(&other).iter().any(|other| other == anchor);
    (!found).then(|| format!("{}: `{target}` names no heading", page.display()))
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let all: Vec<_> = ["", "docs", "docs/book/src", "models", "benchmarks"].into_iter().flat_map(pages).collect();
    let mut followed = 0;
    let mut faults = Vec::new();
    for (page, text) in &all {
        for target in targets(text).iter().filter(|target| !target.contains("://")) {
            followed += 1;
            faults.extend(broken(page, text, target));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(followed > 150, "only {followed} links were found");
    assert!(root().join("docs/book/book.toml").exists());
}
