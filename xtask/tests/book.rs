//! The book of `cargo xtask book`, by mdBook: its links lead to files of the site.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// All pages in a folder and below it.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = paths.partition(|path| path.is_dir());
    let own = files.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "html"));
    own.chain(folders.iter().flat_map(|folder| pages(folder))).collect()
}

/// What a page links to and shows, without anchors.
fn targets(page: &str) -> impl Iterator<Item = &str> {
    let quoted = ["href=\"", "src=\""].into_iter().flat_map(|key| page.split(key).skip(1));
    quoted.filter_map(|rest| rest.split(['"', '#', '?']).next()).filter(|target| !target.is_empty())
}

/// Where there is no mdBook this says so and passes.
#[test]
fn every_link_of_the_site_leads_to_a_file() {
    let built = Command::new(env!("CARGO_BIN_EXE_xtask")).arg("book").output().unwrap();
    let said = String::from_utf8_lossy(&built.stderr);
    if said.contains("`cargo install mdbook`") {
        println!("not run: no mdBook here");
        return;
    }
    assert!(built.status.success(), "{said}");
    let printed = String::from_utf8_lossy(&built.stdout);
    let index = Path::new(printed.trim());
    let (mut followed, mut broken) = (0, Vec::new());
    for path in pages(index.parent().unwrap()) {
        let page = fs::read_to_string(&path).unwrap();
        for target in targets(&page).filter(|target| !target.contains(':')) {
            followed += 1;
            if !path.parent().unwrap().join(target).exists() {
                broken.push(format!("{}: `{target}` does not exist", path.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    assert!(followed > 1000, "only {followed} links were found");
}
