//! Random runs against runs with bounded steps: the quick form of `docs/random-runs.md`.

use dalembert_tests::random_runs::{Verdict, draw, judge, survey};

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

/// Narrow wells and pulses that steps resolve, which were called a direction that is lost.
#[test]
fn what_is_narrow_is_no_lost_direction() {
    for run in [2946, 6170, 7032] {
        let verdict = judge(&draw(run));
        assert!(matches!(verdict, Verdict::Right { .. }), "{run}: {verdict:?}");
    }
}

/// The zero of a discontinuity was sought beyond the step that was tried, which then was tried again for ever.
#[test]
fn a_step_that_fell_short_is_not_tried_again() {
    let verdict = judge(&draw(6899));
    assert!(matches!(verdict, Verdict::Right { .. }), "{verdict:?}");
}
