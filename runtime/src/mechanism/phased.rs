//! The phase in force, and room to solve for its motion.

use std::sync::{Mutex, PoisonError};

use super::{At, Form, Singular, System};

/// What the motion so far tells of the constraints' rows; lists are empty where it tells nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RowHistory {
    /// The largest √(J_k M⁻¹ J_kᵀ) that each row has had, to tell negligible rows by.
    pub norms: Vec<f64>,
    /// The multipliers of all rows where the rows were last as independent as they usually are: rows that cease to count
    /// near a singular position keep them meanwhile.
    pub multipliers: Vec<f64>,
    /// Rows that are chosen last near a singular position, so that the same ones are left out throughout.
    pub last: Vec<usize>,
}

/// What a constrained mechanism keeps beside its parameters.
#[derive(Debug, Default)]
pub(super) struct Phased {
    /// The phase in force.
    pub phase: usize,
    /// What is known of the constraints from the motion so far.
    pub history: RowHistory,
    /// Nobody waits for it: whoever evaluates in parallel has a mechanism of its own.
    form: Mutex<Form>,
}

impl Clone for Phased {
    fn clone(&self) -> Self {
        Phased { phase: self.phase, history: self.history.clone(), form: Mutex::default() }
    }
}

impl Phased {
    /// Accelerations and multipliers by elimination.
    pub fn motion<S: System + ?Sized>(
        &self,
        system: &S,
        at: At<'_>,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let mut form = self.form.lock().unwrap_or_else(PoisonError::into_inner);
        form.motion(system, at, a, lambda)
    }
}

/// 1 for this phase, 0 for all others.
pub(super) fn indicate(indicators: &mut [f64], phase: usize) {
    for (k, indicator) in indicators.iter_mut().enumerate() {
        *indicator = if k == phase { 1.0 } else { 0.0 };
    }
}
