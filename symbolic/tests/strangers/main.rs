//! What went wrong in strangers' hands when files were judged: each file beside a neighbour that must stay as it is.

mod carried;
mod energies;
mod features;
mod files;
mod friction;
mod impacts;
mod inputs;
mod loops;
mod massless;
mod reactions;
mod slow;
mod states;

use dalembert_symbolic::lower::compile;

/// The codes and messages of a file; empty if it is accepted.
fn told(text: &str) -> Vec<String> {
    let problems = compile(text, &[]).err().unwrap_or_default();
    problems.iter().map(|problem| format!("{} {}", problem.code, problem.message)).collect()
}

/// The file is refused with a problem that contains this text.
#[track_caller]
fn refused(text: &str, message: &str) {
    let found = told(text);
    assert!(found.iter().any(|line| line.contains(message)), "{text}: {found:?}");
}

/// The file is accepted.
#[track_caller]
fn accepted(text: &str) {
    let found = told(text);
    assert!(found.is_empty(), "{text}: {found:?}");
}
