//! Rigid bodies in space: frames, moments of inertia, loads, balances; what is accepted and what is refused.

mod body_axes;
mod claims;
mod faults;
mod homogeneity;
mod hostile;
mod inertia;
mod joints;
mod rotation;
mod written;

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

/// All problems of a file, from reading to judging.
fn problems(text: &str) -> Vec<Problem> {
    match load(text, &[]) {
        Err(problems) => problems,
        Ok(model) => judged(model).err().unwrap_or_default(),
    }
}

fn codes(text: &str) -> Vec<&'static str> {
    problems(text).iter().map(|problem| problem.code).collect()
}

#[track_caller]
fn accepted(text: &str) {
    let found: Vec<String> = problems(text).iter().map(|p| format!("{} {} | {}", p.code, p.message, p.help)).collect();
    assert!(found.is_empty(), "{text}\n{}", found.join("\n"));
}

/// The file with one text in the place of another.
#[track_caller]
fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "`{old}` is not there");
    text.replacen(old, new, 1)
}
