//! How well a system of momentum balances determines the motion.

use crate::mechanism::{At, Balances, System};

/// The system of balances that a run went by, and its worst condition number on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Conditioning {
    /// The system's name.
    pub system: String,
    /// The largest condition number at the ends of accepted steps, of A with scaled rows and columns (see
    /// [`Balances::reciprocal_condition`]); infinite where A is singular.
    pub worst: f64,
    /// When that was, s.
    pub t: f64,
}

/// Watches the condition number along a run.
#[derive(Clone, Debug)]
pub(crate) struct ConditionMonitor {
    balances: Balances,
    found: Conditioning,
}

impl ConditionMonitor {
    /// For the derivation in force; `None` where that is Lagrange's equations.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, y: &[f64]) -> Option<Self> {
        let index = system.derivation()?;
        let balances = Balances::new(system, index)?;
        let name = system.description().balances[index].name.to_string();
        let mut monitor = ConditionMonitor { balances, found: Conditioning { system: name, worst: 1.0, t } };
        monitor.observe(system, t, y);
        Some(monitor)
    }

    /// Looks at A at the end of a step.
    pub fn observe<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let n = system.len();
        self.balances.evaluate(system, At::packed(t, y, n));
        let condition = 1.0 / self.balances.reciprocal_condition();
        if condition > self.found.worst {
            (self.found.worst, self.found.t) = (condition, t);
        }
    }

    /// What was found.
    pub fn found(self) -> Conditioning {
        self.found
    }
}
