//! Drawn mechanisms with contacts against time stepping.

use dalembert_tests::at_once::at_once;
use dalembert_tests::random_contacts::{KINDS, Verdict, draw, judge};

/// Drawn runs with their verdicts, on all cores.
fn judged(runs: &[u64]) -> Vec<(u64, Verdict)> {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    at_once(0..runs.len() as u64, threads, |k| (runs[k as usize], judge(&draw(runs[k as usize]))))
}

/// In run 69 friction pushed a sliding box on: it had slid the other way before the last of its hops was taken from it. In run 50 what time
/// passed while hops were left out gained energy.
#[test]
fn no_drawn_contact_is_wrong_without_a_word() {
    let judged = judged(&[0, 1, 2, 50, 69]);
    for (run, verdict) in &judged {
        assert!(!matches!(verdict, Verdict::Wrong(_)), "run {run}: {verdict:?}\n{}", draw(*run).text());
    }
    let right = judged.iter().filter(|(_, verdict)| *verdict == Verdict::Right).count();
    assert!(right >= 1, "{judged:?}");
}

/// In run 354 a corner that landed while the other came to rest was looked at where it had been before the other was closed, and fell through the
/// floor; in run 163 a box that falls flush along a wall struck it for ever, with speeds that were rounding; run 90 ended where a box rests in
/// a corner.
#[test]
fn what_rests_and_what_falls_along_walls_goes_on() {
    for (run, verdict) in judged(&[90, 163, 354]) {
        assert!(matches!(verdict, Verdict::Right | Verdict::Lawful), "run {run}: {verdict:?}");
    }
}

#[test]
fn every_kind_is_drawn() {
    for kind in KINDS {
        assert!((0..100).any(|run| draw(run).kind == kind), "{kind}");
    }
}
