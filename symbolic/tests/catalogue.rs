//! Every entry of the catalogue of errors, raised by a whole file and shown as expected.
//!
//! `errors/E201.yaml` is the file and `errors/E201.txt` what is said about it.  With `UPDATE_EXPECTED=1` in the
//! environment the texts are written anew; read them before you commit them.

use dalembert_symbolic::diagnose::catalogue::CATALOGUE;
use dalembert_symbolic::diagnose::{Entry, Problem};
use dalembert_symbolic::file::render;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;
use std::fs;
use std::path::PathBuf;

/// Entries that no file of a few lines raises, and where they are tested instead.
const ELSEWHERE: &[(&str, &str)] = &[
    ("E011", "a file of more than 1 MiB: `limits` below"),
    ("E503", "two derivations that disagree are a fault of the program: the tests of `derive`"),
    ("E520", "the four numbers of a rotation stand in no expression: `space/homogeneity.rs` puts them into one"),
    ("E326", "a file beside the model's: `resolve/motions.rs`"),
    ("E122", "an expression of more than 64 KiB: `limits` below"),
];

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("errors")
}

fn problems(text: &str) -> Vec<Problem> {
    let model = match load(text, &[]) {
        Ok(model) => model,
        Err(problems) => return problems,
    };
    match judged(model) {
        Ok(judged) => judged.derivation.model.warnings,
        Err(problems) => problems,
    }
}

fn entries() -> impl Iterator<Item = &'static Entry> {
    CATALOGUE.iter().copied().flatten()
}

#[test]
fn every_entry_is_shown_as_expected() {
    let update = std::env::var_os("UPDATE_EXPECTED").is_some();
    let mut wrong = String::new();
    for entry in entries().filter(|entry| ELSEWHERE.iter().all(|(code, _)| *code != entry.code)) {
        let name = format!("{}.yaml", entry.code);
        let Ok(text) = fs::read_to_string(folder().join(&name)) else {
            wrong += &format!("{name} is missing: {}\n", entry.title);
            continue;
        };
        let shown = comparable(entry, render(&name, &text, &problems(&text)));
        let expected = folder().join(format!("{}.txt", entry.code));
        if update {
            fs::write(&expected, &shown).unwrap();
        }
        let wanted = fs::read_to_string(&expected).unwrap_or_default();
        if shown != wanted {
            wrong += &format!("{name}: expected\n{wanted}\nfound\n{shown}\n");
        }
        if !shown.contains(&format!("[{}]: ", entry.code)) {
            wrong += &format!("{name} does not raise {}: {}\n", entry.code, entry.title);
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// Verdicts tell numbers found at random states: each becomes `#`, and all of them one, so that the states may change.
fn comparable(entry: &Entry, shown: String) -> String {
    if !entry.code.starts_with("E5") && entry.code != "E403" {
        return shown;
    }
    let line = |line: &str| {
        let told = line.starts_with("error") || line.contains("= help: ") || line.contains("^ ");
        if told { without_numbers(line) } else { line.to_owned() }
    };
    shown.lines().map(line).map(|line| line + "\n").collect()
}

fn without_numbers(line: &str) -> String {
    // The command that reproduces a state is full of them.
    let (line, rest) = line.split_once("try `simulate").unwrap_or((line, ""));
    let command = if rest.is_empty() { "" } else { "try `simulate #`" };
    let (code, rest) = line.split_at(line.find(':').unwrap_or(0));
    let numeric = |word: &str| word.trim_end_matches([',', ':', ';']).parse::<f64>().is_ok();
    let words = rest.split(' ').map(|word| if numeric(word) { "#" } else { word });
    format!("{code}{}{command}", words.collect::<Vec<_>>().join(" "))
}

/// What a help proposes to write leads to another error or to none: "write `…`" and "did you mean `…`?" are applied.
#[test]
fn proposals_lead_on() {
    let mut applied = 0;
    for entry in entries().filter(|entry| ELSEWHERE.iter().all(|(code, _)| *code != entry.code)) {
        let Ok(text) = fs::read_to_string(folder().join(format!("{}.yaml", entry.code))) else { continue };
        let all = problems(&text);
        for problem in &all {
            let Some(proposal) = proposal(&problem.help) else { continue };
            let range = dalembert_symbolic::file::locate(&text, &[&problem.place]).remove(0);
            // `did you mean` replaces what is marked, with what stands before it where that is part of the proposal.
            let before = proposal.find(&text[range.clone()]).unwrap_or(0);
            let lead = proposal[..before].trim_end_matches(['*', '(']);
            let start = text[..range.start].trim_end().strip_suffix(lead).map_or(range.start, str::len);
            let start = if before > 0 { start } else { range.start };
            let mended = format!("{}{proposal}{}", &text[..start], &text[range.end..]);
            let same = |p: &Problem| p.message == problem.message && p.place == problem.place;
            let after = problems(&mended);
            assert!(!after.iter().any(same), "{}: {}\n{mended}", problem.code, problem.help);
            let unread = after.iter().find(|p| p.code < "E200" && !all.iter().any(|q| q.message == p.message));
            assert!(unread.is_none(), "{}: {} gives {unread:?}\n{mended}", problem.code, problem.help);
            applied += 1;
        }
    }
    assert!(applied >= 20, "{applied}");
}

/// The words to write in the place of what is marked, where a help gives them whole.
fn proposal(help: &str) -> Option<&str> {
    let rest = ["did you mean `", "write it like `", "write `"].iter().find_map(|lead| help.split_once(lead))?.1;
    let words = rest.split('`').next()?;
    let whole = !words.contains(['…', '{'])
        && !words.contains(" e ")
        && !help.contains("BODY")
        && !help.contains("for an equation");
    whole.then_some(words)
}

#[test]
fn limits() {
    let large = format!("about: {}\n", "x".repeat(1 << 20));
    assert_eq!(problems(&large)[0].code, "E011");
    let long = format!("name: A\ncoordinates: {{x: m}}\ndefine: {{a: \"x{}\"}}\n", "+1".repeat(40_000));
    assert_eq!(problems(&long)[0].code, "E122");
}
