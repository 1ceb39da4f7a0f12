// What each part of the gate is for: faults that slip through where it is turned off.

use dalembert_symbolic::derive::Derivation;
use dalembert_symbolic::gate::Gate;

use super::Outcome;

/// The parts, by their names, and the gate without each.
const PARTS: [(&str, Gate); 4] = {
    let all = Gate { digits: true, rows: true, motion: true, sides: true };
    [
        ("precision", Gate { digits: false, ..all }),
        ("rows", Gate { rows: false, ..all }),
        ("motion", Gate { motion: false, ..all }),
        ("sides", Gate { sides: false, ..all }),
    ]
};

/// Whether a derivation that the gate refuses is accepted without each part.
pub fn slips(derivation: &Derivation) -> Vec<bool> {
    PARTS.iter().map(|(_, gate)| gate.judge(derivation.clone()).is_ok()).collect()
}

/// What slips through without one part.
pub struct Slipped<'o> {
    /// The part.
    pub part: &'static str,
    /// The faults.
    pub faults: Vec<&'o Outcome>,
}

impl Slipped<'_> {
    /// What slips through without each part.
    pub fn of(outcomes: &[Outcome]) -> Vec<Slipped<'_>> {
        let without = |k: usize| outcomes.iter().filter(move |o| o.slips.get(k) == Some(&true)).collect();
        PARTS.iter().enumerate().map(|(k, (part, _))| Slipped { part, faults: without(k) }).collect()
    }
}
