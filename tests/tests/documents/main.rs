//! The documents speak of files that are there, their commands print what they show, and their links lead somewhere.

mod book;
mod commands;
mod links;
mod page;

use std::path::Path;

/// Folders at the top of the workspace whose paths the documents name in full.
const FOLDERS: [&str; 6] = ["symbolic/", "macros/", "runtime/", "models/", "tests/", "docs/"];

#[test]
fn every_path_in_the_documents_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let mut named = 0;
    let pages = |folder: &str| {
        let entries = std::fs::read_dir(root.join(folder)).expect("a folder of documents");
        entries
            .map(|entry| entry.expect("an entry").path())
            .filter(|path| path.extension().is_some_and(|end| end == "md"))
    };
    let top = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    for document in top.into_iter().chain(pages("docs/decisions")).chain(pages("docs/numerics")) {
        let text = std::fs::read_to_string(&document).expect("a document");
        for path in text.split('`').skip(1).step_by(2) {
            let full = FOLDERS.iter().any(|folder| path.starts_with(folder));
            // `NAME` stands for a name that the reader chooses.
            if !full || path.contains("NAME") || path.contains(' ') {
                continue;
            }
            named += 1;
            assert!(root.join(path).exists(), "{} names `{path}`, which does not exist", document.display());
        }
    }
    assert!(named > 20, "only {named} paths were found");
}

/// A module's own words say where the rest of it is: "look in `step.rs`", "found in `modes/`", beside it.
#[test]
fn every_module_that_module_docs_name_exists() {
    fn files(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            match path.is_dir() {
                true => files(&path, found),
                false if path.extension().is_some_and(|end| end == "rs") => found.push(path),
                false => {}
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let mut all = Vec::new();
    ["symbolic/src", "mechanism/src", "runtime/src"].iter().for_each(|folder| files(&root.join(folder), &mut all));
    let mut named = 0;
    for file in all {
        let text = std::fs::read_to_string(&file).expect("a file");
        for line in text.lines().take_while(|line| line.starts_with("//!")) {
            let places = ["look in ", "found in "].into_iter().filter_map(|words| line.split_once(words));
            // Links lead to items, which rustdoc looks up.
            let names = places.flat_map(|(_, rest)| {
                let parts: Vec<&str> = rest.split('`').collect();
                (1..parts.len())
                    .step_by(2)
                    .filter(|k| !parts[k - 1].ends_with('['))
                    .map(|k| parts[k])
                    .collect::<Vec<_>>()
            });
            for name in names.filter(|name| !name.contains("::")) {
                named += 1;
                // With a folder it may be another one of the crate.
                let source = file.ancestors().find(|folder| folder.ends_with("src")).expect("a crate");
                let there = [file.with_file_name(name), source.join(name)]
                    .into_iter()
                    .any(|path| path.exists() || path.with_extension("rs").exists());
                assert!(there, "{} names `{name}`, which is not there", file.display());
            }
        }
    }
    assert!(named > 20, "only {named} modules were found");
}

#[test]
fn every_generated_page_names_the_example_that_prints_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let mut named = 0;
    for page in std::fs::read_dir(root.join("docs")).expect("the folder of documents") {
        let Ok(text) = std::fs::read_to_string(page.expect("an entry").path()) else { continue };
        for command in text.split("--example ").skip(1) {
            let example = command.split(' ').next().unwrap_or("");
            named += 1;
            let exists = |package: &str| root.join(format!("{package}/examples/{example}.rs")).exists();
            assert!(exists("symbolic") || exists("tests"), "there is no example `{example}`");
        }
    }
    assert!(named >= 4, "only {named} examples were found");
}

#[test]
fn every_test_that_the_catalogue_of_failures_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let text = std::fs::read_to_string(root.join("docs/stability.md")).expect("the catalogue");
    let mut named = 0;
    for reference in text.split('`').skip(1).step_by(2) {
        let Some((path, test)) = reference.split_once(".rs: ") else { continue };
        named += 1;
        let source = std::fs::read_to_string(root.join(format!("{path}.rs")));
        let source = source.unwrap_or_else(|error| panic!("{reference}: {error}"));
        assert!(source.contains(&format!("fn {test}(")), "`{reference}` is no test");
    }
    assert!(named > 50, "only {named} tests are named");
}

/// `cargo run`, the first command of README, has one program to run.
#[test]
fn cargo_run_means_the_program() {
    let told = std::process::Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--offline", "--format-version", "1"])
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(".."))
        .output()
        .expect("cargo");
    let all: serde_json::Value = serde_json::from_slice(&told.stdout).expect("JSON");
    let members = all["workspace_default_members"].as_array().expect("members");
    let packages =
        all["packages"].as_array().expect("packages").iter().filter(|package| members.contains(&package["id"]));
    let targets = packages.flat_map(|package| package["targets"].as_array().expect("targets"));
    let programs =
        targets.filter(|target| target["kind"].as_array().is_some_and(|kinds| kinds.iter().any(|k| k == "bin")));
    let names: Vec<&str> = programs.filter_map(|target| target["name"].as_str()).collect();
    assert_eq!(names, ["dalembert"]);
}
