//! The packages that are published say what they are, and bring their licences along.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

const PUBLISHED: [(&str, &str); 5] = [
    ("dalembert", "runtime"),
    ("dalembert-macros", "macros"),
    ("dalembert-mechanism", "mechanism"),
    ("dalembert-models", "models"),
    ("dalembert-symbolic", "symbolic"),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder")
}

fn cargo(arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO")).args(arguments).current_dir(root()).output().expect("cargo can be started");
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr).find("warning"), None, "{}", text(&output.stderr));
    text(&output.stdout)
}

#[test]
fn manifests_are_complete() {
    let metadata = cargo(&["metadata", "--no-deps", "--format-version", "1", "--offline", "--locked"]);
    let metadata: Value = serde_json::from_str(&metadata).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    // `publish = false` is an empty list of registries.
    let mut published: Vec<&Value> = packages.iter().filter(|package| package["publish"].is_null()).collect();
    published.sort_by_key(|package| package["name"].as_str());
    let names: Vec<&str> = published.iter().filter_map(|package| package["name"].as_str()).collect();
    assert_eq!(names, PUBLISHED.map(|(name, _)| name));
    for package in published {
        for key in ["description", "documentation", "license", "rust_version"] {
            assert!(package[key].as_str().is_some_and(|text| !text.is_empty()), "{}: {key}", package["name"]);
        }
        assert_eq!(package["readme"], "README.md", "{}", package["name"]);
        // No more are taken.
        for (key, most) in [("keywords", 5), ("categories", 5)] {
            assert!(
                package[key].as_array().is_some_and(|list| (1..=most).contains(&list.len())),
                "{}",
                package["name"]
            );
        }
        assert_eq!(package["metadata"]["docs"]["rs"]["all-features"], true, "{}", package["name"]);
    }
}

#[test]
fn licences_go_along_and_are_those_of_the_workspace() {
    for (name, folder) in PUBLISHED {
        let list = cargo(&["package", "--list", "--allow-dirty", "--offline", "--package", name]);
        for file in ["LICENSE-APACHE", "LICENSE-MIT", "README.md"] {
            assert!(list.lines().any(|line| line == file), "{name}: {file}");
        }
        for file in ["LICENSE-APACHE", "LICENSE-MIT"] {
            let text = |path: &str| std::fs::read_to_string(root().join(path)).expect("a licence");
            assert!(text(file) == text(&format!("{folder}/{file}")), "{folder}/{file} is not the licence");
        }
    }
}
