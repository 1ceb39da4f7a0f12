//! Random runs against runs with bounded steps: the quick form of `docs/random-runs.md`.

use dalembert_tests::random_runs::{Verdict, survey};

#[test]
fn no_random_run_is_wrong_without_a_word() {
    let judged = survey(0..40, 2, |_| {});
    let wrong = |verdict: &Verdict| matches!(verdict, Verdict::Wrong { .. } | Verdict::Stopped { .. });
    if let Some(one) = judged.iter().find(|one| wrong(&one.verdict)) {
        panic!("run {}: {:?}\n{}", one.run, one.verdict, one.drawn.text);
    }
    // Most of them are judged at all.
    let right = judged.iter().filter(|one| matches!(one.verdict, Verdict::Right { .. })).count();
    assert!(right >= 30, "{right} of {}", judged.len());
}
