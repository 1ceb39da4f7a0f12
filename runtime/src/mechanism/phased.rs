//! The phase in force, and room to solve for its motion.

use std::sync::{Mutex, PoisonError};

use super::{At, Form, Singular, System};

/// What a constrained mechanism keeps beside its parameters.
#[derive(Debug, Default)]
pub(super) struct Phased {
    /// The phase in force.
    pub phase: usize,
    /// The largest norms that the constraints' rows have had.
    pub norms: Vec<f64>,
    /// Nobody waits for it: whoever evaluates in parallel has a mechanism of its own.
    form: Mutex<Form>,
}

impl Clone for Phased {
    fn clone(&self) -> Self {
        Phased { phase: self.phase, norms: self.norms.clone(), form: Mutex::default() }
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
