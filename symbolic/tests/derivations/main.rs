//! What each derivation costs is held by `docs/derivations.md`; Lagrange's equations cost the same beside balances.

mod table;

use dalembert_symbolic::lower::{Counts, compile};

#[test]
fn costs_are_those_of_the_page() {
    let held = include_str!("../../../docs/derivations.md");
    let now = table::page();
    let differs = now.lines().zip(held.lines()).find(|(a, b)| a != b);
    assert!(now == held, "costs have changed; if that is meant, regenerate docs/derivations.md: {differs:?}");
}

/// A model file without these sections.
fn without(text: &str, sections: &[&str]) -> String {
    let mut kept = String::new();
    let mut inside = false;
    for line in text.lines() {
        if !line.starts_with([' ', '#']) {
            inside = sections.iter().any(|section| line.starts_with(&format!("{section}:")));
        }
        if !inside {
            kept += line;
            kept.push('\n');
        }
    }
    kept
}

/// M, h, accelerations, F and its Jacobians need as many operations beside balances as without them.
#[test]
fn balances_cost_nothing_at_run_time() {
    // What may name a reaction is left out of both.
    let observed = ["outputs", "checks", "events"];
    let mut compared = 0;
    for (name, text) in table::models() {
        let counts = |text: &str| -> Counts {
            compile(text, &[]).unwrap_or_else(|problems| panic!("{name}: {problems:?}")).counts
        };
        let beside = without(&text, &observed);
        let alone = without(&beside, &["balances"]);
        if alone.len() < beside.len() {
            let (beside, alone) = (counts(&beside), counts(&alone));
            // Thousands of sums are in another order beside others.
            let near = beside.jacobians.abs_diff(alone.jacobians) <= alone.jacobians / 1000;
            assert!(near, "{name}: {beside:?} {alone:?}");
            assert_eq!(Counts { jacobians: 0, ..beside }, Counts { jacobians: 0, ..alone }, "{name}");
            compared += 1;
        }
    }
    assert!(compared >= 38, "{compared}");
}
