// `docs/why-it-did-not-compile.md`: the catalogue of errors with a real example of each.

use std::fmt::Write;
use std::fs;
use std::path::PathBuf;

use dalembert_symbolic::diagnose::Entry;
use dalembert_symbolic::diagnose::catalogue::CATALOGUE;

const HEAD: &str = "# Why your model did not compile

Every kind of error, with a whole file that raises it and what is then said; `#` stands for a number found at a random
state. Codes with `W` are warnings. Everything wrong with a file is reported at once, but YAML's own syntax comes alone,
since nothing after it can be read.

Where two derivations disagree (E506), read the help first: it names the single force, moment or term whose flip or
removal makes them agree, where there is one. How often such a fault is noticed is measured in [faults.md](faults.md).

Regenerate: `cargo run --example why -p dalembert-symbolic > docs/why-it-did-not-compile.md`.
";

/// The subjects of the catalogue, in its order.
const SUBJECTS: [&str; 12] = [
    "YAML",
    "Expressions, keys and units",
    "Names, sizes and indices",
    "Units",
    "States of first order",
    "Held values",
    "Friction and contacts",
    "Held noise",
    "The shape of a file",
    "Mechanics",
    "What deriving and testing at random states finds",
    "Not supported yet",
];

/// The whole page.
pub fn page() -> String {
    let mut text = HEAD.to_owned();
    text += "\n";
    for (subject, entries) in SUBJECTS.iter().zip(CATALOGUE) {
        let codes =
            entries.first().zip(entries.last()).map_or(String::new(), |(a, b)| format!(" ({}–{})", a.code, b.code));
        let _ = writeln!(text, "- [{subject}](#{}){codes}", anchor(subject));
    }
    for (subject, entries) in SUBJECTS.iter().zip(CATALOGUE) {
        let _ = write!(text, "\n## {subject}\n");
        for entry in *entries {
            text += &section(entry);
        }
    }
    text
}

/// A heading as links name it.
fn anchor(heading: &str) -> String {
    heading.to_lowercase().replace(' ', "-").replace(',', "")
}

fn section(entry: &Entry) -> String {
    let mut text = format!("\n### {} {}\n{}\n", entry.code, entry.title, entry.explanation);
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("errors");
    let read = |end: &str| fs::read_to_string(folder.join(format!("{}.{end}", entry.code)));
    match (read("yaml"), read("txt")) {
        (Ok(file), Ok(said)) => {
            text += &fenced("yaml", &file);
            text += &fenced("text", &said);
        }
        _ => {
            let message = entry.message.replace("{{", "{").replace("}}", "}");
            let _ = write!(text, "\nNo file of a few lines raises it. What is said: {message}.\n");
        }
    }
    text
}

/// A block of code; what cannot be printed is shown as such.
fn fenced(language: &str, content: &str) -> String {
    let shown: String = content.chars().map(|c| if c.is_control() && c != '\n' { '\u{fffd}' } else { c }).collect();
    format!("\n```{language}\n{}\n```\n", shown.trim_end())
}
