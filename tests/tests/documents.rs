//! The documents speak of files that are there.

use std::path::Path;

use dalembert_symbolic::lower::compile;

/// Folders at the top of the workspace whose paths the documents name in full.
const FOLDERS: [&str; 6] = ["symbolic/", "macros/", "runtime/", "models/", "tests/", "docs/"];

#[test]
fn every_path_in_the_documents_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let mut named = 0;
    for document in ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = std::fs::read_to_string(root.join(document)).expect("a document at the top of the workspace");
        for path in text.split('`').skip(1).step_by(2) {
            let full = FOLDERS.iter().any(|folder| path.starts_with(folder));
            // `NAME` stands for a name that the reader chooses.
            if !full || path.contains("NAME") || path.contains(' ') {
                continue;
            }
            named += 1;
            assert!(root.join(path).exists(), "{document} names `{path}`, which does not exist");
        }
    }
    assert!(named > 20, "only {named} paths were found");
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
fn every_model_of_the_tutorial_is_accepted_without_a_warning() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let text = std::fs::read_to_string(root.join("docs/tutorial.md")).expect("the tutorial");
    let models: Vec<&str> = text.split("```yaml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(models.len() >= 10, "only {} models", models.len());
    for model in models {
        let program = compile(model, &[]).unwrap_or_else(|problems| panic!("{model}\n{problems:?}"));
        assert!(program.model.warnings.is_empty(), "{model}\n{:?}", program.model.warnings);
    }
}

/// A page's fenced blocks: what follows the fence, and the text.
fn blocks(page: &str) -> Vec<(&str, &str)> {
    let fenced = page.split("```").skip(1).step_by(2);
    fenced.filter_map(|block| block.split_once('\n')).collect()
}

/// Words of a command line, with double quotes.
fn words(command: &str) -> Vec<String> {
    let parts = command.split('"').enumerate();
    let mut words = Vec::new();
    for (k, part) in parts {
        match k % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

/// What a command prints, errors included; the model of the page and what is written for others by their files.
fn printed(command: &str, folder: &Path) -> String {
    let arguments = words(command).into_iter().map(|word| match [".yaml", ".npz"].iter().any(|ending| word.ends_with(ending)) {
        true => folder.join(word).to_string_lossy().into_owned(),
        false => word,
    });
    let arguments: Vec<String> = std::iter::once("dalembert".to_owned()).chain(arguments).collect();
    let mut out = Vec::new();
    let ended = dalembert::cli::run(dalembert_models::MODELS, arguments, &mut out);
    let text = String::from_utf8(out).expect("text");
    ended.map_or_else(|problem| format!("{text}{problem}\n"), |()| text.clone())
}

/// Runs every command of a page, and looks for what it shows, lines in order; a `yaml` block is the model file that the next command with one
/// names.  Returns how many commands there are.
fn commands_print_what_they_show(page: &str) -> usize {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace's folder");
    let folder = std::env::temp_dir().join(format!("dalembert-{}-{}", page.replace('/', "-"), std::process::id()));
    let page = std::fs::read_to_string(root.join(page)).expect("the page");
    std::fs::create_dir_all(&folder).expect("a folder");
    let blocks = blocks(&page);
    let (mut commands, mut model) = (0, None);
    for (k, (kind, text)) in blocks.iter().enumerate() {
        if *kind == "yaml" {
            let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}\n{problems:?}"));
            assert!(program.model.warnings.is_empty(), "{:?}", program.model.warnings);
            model = Some(text);
        }
        let Some(command) = text.strip_prefix("cargo run --release -- ") else { continue };
        commands += 1;
        if let Some(file) = command.split_whitespace().find(|word| word.ends_with(".yaml"))
            && let Some(text) = model.take()
        {
            std::fs::write(folder.join(file), text).expect("a file");
        }
        let printed = printed(command, &folder);
        let mut lines = printed.lines();
        for shown in blocks[k + 1].1.lines().filter(|line| *line != "...") {
            assert!(lines.any(|line| line.starts_with(shown)), "{command}`{shown}` is not printed:\n{printed}");
        }
    }
    std::fs::remove_dir_all(&folder).expect("removed");
    commands
}

#[test]
fn every_command_of_the_page_on_space_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/space.md"), 10);
}

#[test]
fn every_command_of_the_page_on_orbits_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/orbits.md"), 8);
}

#[test]
fn every_command_of_the_page_on_bridges_prints_what_it_shows() {
    assert_eq!(commands_print_what_they_show("docs/bridges.md"), 3);
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
