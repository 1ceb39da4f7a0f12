//! Drawn mechanisms with contacts against time stepping: the quick form of `docs/random-contacts.md`.

use dalembert_tests::random_contacts::{KINDS, Verdict, draw, judge};

/// In run 69 friction pushed a sliding box on: it had slid the other way before the last of its hops was taken from it. In run 50 what time
/// passed while hops were left out gained energy.
#[test]
fn no_drawn_contact_is_wrong_without_a_word() {
    let runs = (0..12).chain([50, 69]);
    let judged: Vec<(u64, Verdict)> = runs.map(|run| (run, judge(&draw(run)))).collect();
    for (run, verdict) in &judged {
        assert!(!matches!(verdict, Verdict::Wrong(_)), "run {run}: {verdict:?}\n{}", draw(*run).text());
    }
    let right = judged.iter().filter(|(_, verdict)| *verdict == Verdict::Right).count();
    assert!(right >= 3, "{judged:?}");
}

#[test]
fn every_kind_is_drawn() {
    for kind in KINDS {
        assert!((0..100).any(|run| draw(run).kind == kind), "{kind}");
    }
}
