//! What the program prints of every model file, written down and compared: a change of names or of shape changes none of it.
//!
//! The record lies in `target/golden`, outside of what is versioned: it is made of the commit before a change.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::root;

/// Commands whose answers are recorded, with their options.
const COMMANDS: [(&str, &[&str]); 5] =
    [("check", &["--json"]), ("show", &[]), ("show", &["--rust"]), ("simulate", &["--json"]), ("modes", &["--json"])];
/// Values that differ from run to run.
const TIMES: [&str; 1] = ["seconds"];
/// So many differences are told one by one.
const TOLD: usize = 20;

/// Answers by file and command.
type Answers = BTreeMap<String, String>;

/// Writes down what the program prints.
///
/// # Errors
/// Files that cannot be read or written.
pub fn record() -> Result<String, String> {
    let answers = answers()?;
    let folder = folder();
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    for (name, text) in &answers {
        let path = folder.join(name);
        fs::write(&path, text).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(format!("{} answers are written down in {}", answers.len(), folder.display()))
}

/// Compares what the program prints with what was written down.
///
/// # Errors
/// What differs, or that nothing was written down.
pub fn compare() -> Result<String, String> {
    let folder = folder();
    let entries = fs::read_dir(&folder).map_err(|error| {
        format!("{}: {error}: `cargo xtask golden --record` at the commit before", folder.display())
    })?;
    let mut before = Answers::new();
    for entry in entries {
        let path = entry.map_err(|error| error.to_string())?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        before.insert(name, fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?);
    }
    let differences = differences(&before, &answers()?);
    if differences.is_empty() {
        return Ok(format!("{} answers, all as they were", before.len()));
    }
    let more = differences.len().saturating_sub(TOLD);
    let mut lines: Vec<String> = differences.into_iter().take(TOLD).collect();
    if more > 0 {
        lines.push(format!("and {more} more"));
    }
    Err(lines.join("\n"))
}

/// One line and the first place that differs for each answer that is not as it was.
fn differences(before: &Answers, now: &Answers) -> Vec<String> {
    let told = |name: &String| match (before.get(name), now.get(name)) {
        (Some(before), Some(now)) if before == now => None,
        (Some(before), Some(now)) => Some(first_difference(name, before, now)),
        (None, _) => Some(format!("{name}: not there before")),
        (_, None) => Some(format!("{name}: not there any more")),
    };
    let mut names: Vec<&String> = before.keys().chain(now.keys()).collect();
    names.sort();
    names.dedup();
    names.into_iter().filter_map(told).collect()
}

fn first_difference(name: &str, before: &str, now: &str) -> String {
    let (mut old, mut new) = (before.lines(), now.lines());
    let mut number = 0;
    loop {
        number += 1;
        match (old.next(), new.next()) {
            (Some(old), Some(new)) if old == new => {}
            (old, new) => {
                let line = |line: Option<&str>| line.unwrap_or("(the end)").to_owned();
                return format!("{name}, line {number}\n  - {}\n  + {}", line(old), line(new));
            }
        }
    }
}

fn folder() -> PathBuf {
    root().join("target/golden")
}

/// What the program prints of all models by all commands, and of all files with errors by `check`.
fn answers() -> Result<Answers, String> {
    let mut answers = Answers::new();
    for path in files("models")? {
        for (command, options) in COMMANDS {
            let (name, text) = answer(&path, command, options);
            answers.insert(name, text);
        }
    }
    for path in files("symbolic/errors")? {
        let (name, text) = answer(&path, "check", &[]);
        answers.insert(name, text);
    }
    Ok(answers)
}

/// The model files of a folder.
fn files(folder: &str) -> Result<Vec<PathBuf>, String> {
    let path = root().join(folder);
    let entries = fs::read_dir(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "yaml"));
    files.sort();
    Ok(files)
}

/// The name of an answer and its text: what is printed, or the error.
fn answer(path: &Path, command: &str, options: &[&str]) -> (String, String) {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let file = path.to_string_lossy();
    let arguments: Vec<&str> = ["dalembert", command, &file].into_iter().chain(options.iter().copied()).collect();
    let mut out = Vec::new();
    let outcome = dalembert::cli::run(&[], &arguments, &mut out);
    let printed = String::from_utf8_lossy(&out).into_owned();
    let text = match outcome {
        Ok(()) => timeless(&printed),
        Err(error) => format!("{printed}{error}\n"),
    };
    (format!("{stem}-{command}{}.txt", options.concat()), text.replace(&*file, &stem))
}

/// JSON a value a line without times; other text as it is.
fn timeless(printed: &str) -> String {
    let Ok(mut value) = serde_json::from_str::<Value>(printed) else { return printed.to_owned() };
    if let Value::Object(entries) = &mut value {
        TIMES.iter().for_each(|key| _ = entries.remove(*key));
    }
    serde_json::to_string_pretty(&value).unwrap_or_default() + "\n"
}

#[cfg(test)]
mod tests {
    use super::{Answers, differences, timeless};

    #[test]
    fn what_differs_is_told_with_its_line() {
        let answers = |list: &[(&str, &str)]| -> Answers {
            list.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
        };
        let before = answers(&[("a", "1\n2\n"), ("b", "x"), ("c", "same")]);
        let now = answers(&[("a", "1\n3\n"), ("c", "same"), ("d", "new")]);
        let told = differences(&before, &now);
        assert_eq!(told, ["a, line 2\n  - 2\n  + 3", "b: not there any more", "d: not there before"]);
        assert!(differences(&before, &before).is_empty());
    }

    #[test]
    fn times_are_left_out() {
        assert_eq!(timeless(r#"{"t": 1, "seconds": 0.2}"#), "{\n  \"t\": 1\n}\n");
        assert_eq!(timeless("plain"), "plain");
    }
}
