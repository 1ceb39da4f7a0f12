//! Which thresholds the tests pin: each is made larger and smaller by a factor, and the tests are run until one fails.
//!
//! The workspace is copied. In the copy every `const NAME: f64 = …;` of the files that are asked for becomes a function that reads its factor from
//! the environment, so that all is compiled once.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::root;

/// The factors that are tried: what the tests do not tell from four times as much is not pinned.
const FACTORS: [&str; 2] = ["4", "0.25"];
/// The variable that names a threshold and its factor.
const VARIABLE: &str = "CHANGED_CONSTANT";
/// A test that takes so many times as long as unchanged noticed something.
const PATIENCE: u32 = 10;

/// A program of tests, with how long it takes.
struct Tests {
    program: PathBuf,
    package: PathBuf,
    takes: Duration,
}

/// Changes the thresholds of these files one by one, and tells which changes none of these programs of tests noticed, or none at all where none is named:
/// `dalembert` are the tests in that crate, `strangers` those of a file or folder of that name.
pub fn study(files: &[&str], programs: &[&str]) -> Result<String, String> {
    let copy = root().join("target/constants/workspace");
    copy_workspace(&copy)?;
    let mut names = Vec::new();
    for file in files {
        let path = copy.join(file);
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{file}: {error}"))?;
        let (text, found) = opened(file, &text);
        write_if_changed(&path, &text)?;
        names.extend(found);
        let crate_root = file.split_once("/src/").map(|(package, _)| format!("{package}/src/lib.rs"));
        add_reader(&copy.join(crate_root.ok_or_else(|| format!("{file} is not in a folder `src`"))?))?;
    }
    let tests = tests(&copy, programs)?;
    let mut told = String::new();
    let mut unnoticed = 0;
    for name in &names {
        for factor in FACTORS {
            let noticed = tests.iter().find(|tests| !passes(tests, &format!("{name}={factor}"), PATIENCE));
            let by = noticed.map(|tests| name_of(&tests.program));
            eprintln!("{name} × {factor}: {}", by.as_deref().unwrap_or("no test"));
            if by.is_none() {
                unnoticed += 1;
                let _ = writeln!(told, "{name} × {factor}");
            }
        }
    }
    Ok(format!("{told}{unnoticed} of {} changes were noticed by no test", FACTORS.len() * names.len()))
}

/// Copies the files that git knows, those alone that differ: so that what was compiled stays.
fn copy_workspace(to: &Path) -> Result<(), String> {
    let listed =
        Command::new("git").args(["ls-files"]).current_dir(root()).output().map_err(|error| error.to_string())?;
    for file in String::from_utf8_lossy(&listed.stdout).lines() {
        let (from, to) = (root().join(file), to.join(file));
        let Ok(content) = std::fs::read(&from) else { continue };
        if std::fs::read(&to).ok().as_deref() != Some(&content) {
            if let Some(folder) = to.parent() {
                std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
            }
            std::fs::write(&to, content).map_err(|error| error.to_string())?;
        }
    }
    Ok(())
}

fn write_if_changed(path: &Path, text: &str) -> Result<(), String> {
    if std::fs::read_to_string(path).ok().as_deref() == Some(text) {
        return Ok(());
    }
    std::fs::write(path, text).map_err(|error| error.to_string())
}

/// A file whose private thresholds before its tests are functions, with their names.
fn opened(file: &str, text: &str) -> (String, Vec<String>) {
    let (source, tests) = text.split_at(text.find("#[cfg(test)]").unwrap_or(text.len()));
    let constants: Vec<(&str, &str)> = source.lines().filter_map(constant).collect();
    // What an array or a count is made of stays.
    let is_fixed = |name: &str| {
        let others = source.lines().filter(|line| line.contains("const ") && constant(line).is_none());
        others.into_iter().any(|line| words(line).any(|word| word == name))
    };
    let constants: BTreeMap<&str, &str> = constants.into_iter().filter(|(name, _)| !is_fixed(name)).collect();
    let mut out = String::new();
    for line in source.lines() {
        match constant(line).filter(|(name, _)| constants.contains_key(name)) {
            Some((name, value)) => {
                let value = called(value, &constants);
                let _ = writeln!(
                    out,
                    "#[allow(non_snake_case)] fn {name}() -> f64 {{ crate::changed_constant(\"{file}:{name}\", {value}) }}"
                );
            }
            None if line.trim_start().starts_with("//") => {
                let _ = writeln!(out, "{line}");
            }
            None => {
                let _ = writeln!(out, "{}", called(line, &constants));
            }
        }
    }
    let names = constants.keys().map(|name| format!("{file}:{name}")).collect();
    (out + &called(tests, &constants), names)
}

/// The name and the value of a threshold, if the line is one of a private one.
fn constant(line: &str) -> Option<(&str, &str)> {
    let (name, value) = line.trim_start().strip_prefix("const ")?.split_once(": f64 = ")?;
    Some((name, value.strip_suffix(';')?))
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|word| !word.is_empty())
}

/// A text in which thresholds are calls.
fn called(text: &str, constants: &BTreeMap<&str, &str>) -> String {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(part_of_word) {
        let length = rest[start..].find(|c| !part_of_word(c)).unwrap_or(rest.len() - start);
        let (before, word) = (&rest[..start], &rest[start..start + length]);
        // `f64::NAME` is another one.
        let own = constants.contains_key(word) && !before.ends_with("::");
        out.push_str(before);
        out.push_str(word);
        out.push_str(if own { "()" } else { "" });
        rest = &rest[start + length..];
    }
    out + rest
}

/// Lets a crate read which threshold is another one.
fn add_reader(crate_root: &Path) -> Result<(), String> {
    let text = std::fs::read_to_string(crate_root).map_err(|error| format!("{}: {error}", crate_root.display()))?;
    if text.contains("fn changed_constant") {
        return Ok(());
    }
    let reader = format!(
        "\npub(crate) fn changed_constant(name: &str, value: f64) -> f64 {{
    static CHANGED: std::sync::LazyLock<Option<(String, f64)>> = std::sync::LazyLock::new(|| {{
        let text = std::env::var(\"{VARIABLE}\").ok()?;
        let (name, factor) = text.split_once('=')?;
        Some((name.to_owned(), factor.parse().ok()?))
    }});
    match &*CHANGED {{
        Some((changed, factor)) if changed == name => factor * value,
        _ => value,
    }}
}}\n"
    );
    std::fs::write(crate_root, text + &reader).map_err(|error| error.to_string())
}

/// The name of a program of tests without what cargo adds to it.
fn name_of(program: &Path) -> String {
    let name = program.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    name.rsplit_once('-').map_or(name.clone(), |(name, _)| name.to_owned())
}

/// The programs of tests of the copy that have these names, or all, built, the quickest first.
fn tests(copy: &Path, names: &[&str]) -> Result<Vec<Tests>, String> {
    let built = Command::new("cargo")
        .args(["test", "--workspace", "--no-run", "--message-format=json-render-diagnostics"])
        .current_dir(copy)
        .stderr(Stdio::inherit())
        .output()
        .map_err(|error| error.to_string())?;
    if !built.status.success() {
        return Err("the changed workspace does not build".to_owned());
    }
    let mut tests = Vec::new();
    for line in String::from_utf8_lossy(&built.stdout).lines() {
        let Ok(message) = serde_json::from_str::<serde_json::Value>(line) else { continue };
        let (Some(program), Some(manifest)) = (message["executable"].as_str(), message["manifest_path"].as_str())
        else {
            continue;
        };
        let is_asked_for = names.is_empty() || names.contains(&name_of(Path::new(program)).as_str());
        if message["profile"]["test"] == true && is_asked_for {
            let package = Path::new(manifest).parent().unwrap_or(copy).to_owned();
            tests.push(Tests { program: program.into(), package, takes: Duration::MAX });
        }
    }
    for one in &mut tests {
        let began = Instant::now();
        if passes(one, "", 1) {
            one.takes = began.elapsed();
        } else {
            eprintln!("{} fails as it is, and is left out", one.program.display());
        }
    }
    tests.retain(|one| one.takes < Duration::MAX);
    tests.sort_by_key(|one| one.takes);
    if tests.is_empty() {
        Err("no program of tests has such a name, and passes as it is".to_owned())
    } else {
        Ok(tests)
    }
}

/// Whether tests pass with a threshold changed, in no more than so many times their usual time.
fn passes(tests: &Tests, change: &str, patience: u32) -> bool {
    let child = Command::new(&tests.program)
        .current_dir(&tests.package)
        .env(VARIABLE, change)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let Ok(mut child) = child else { return false };
    let until = Instant::now().checked_add(tests.takes.saturating_mul(patience));
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) if until.is_none_or(|until| Instant::now() < until) => {
                std::thread::sleep(Duration::from_millis(20));
            }
            _ => {
                let _ = child.kill();
                let _ = child.wait();
                return false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_become_calls_and_nothing_else_does() {
        let text = "/// LEAST of all.\nconst LEAST: f64 = 2.0 * MOST;\nconst MOST: f64 = 4.0 * f64::EPSILON;\nconst SIZE: f64 = 3.0;\n\
                    const ALL: [f64; 1] = [SIZE];\nfn f(x: f64) -> bool { x < LEAST && x > f64::LEAST_OF + other::MOST }\n";
        let (opened, names) = opened("a/src/b.rs", text);
        assert_eq!(names, ["a/src/b.rs:LEAST", "a/src/b.rs:MOST"]);
        assert!(opened.contains("fn LEAST() -> f64 { crate::changed_constant(\"a/src/b.rs:LEAST\", 2.0 * MOST()) }"));
        assert!(opened.contains("x < LEAST() && x > f64::LEAST_OF + other::MOST }") && opened.contains("[SIZE]"));
        assert!(opened.contains("/// LEAST of all."));
    }
}
