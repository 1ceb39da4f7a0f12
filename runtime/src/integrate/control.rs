//! Choosing the step.

use super::{OneStep, Setback, Tolerance};
use crate::mechanism::System;

/// Constants of the step-size control h ← h·clamp(0.9·err₀^β/err^α), α = exponent − 3β/4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// 1/(q + 1), q the order of the error estimate.
    pub exponent: f64,
    /// Weight of the previous step's error (the integral part).
    pub beta: f64,
    /// The smallest factor.
    pub shrink: f64,
    /// The largest factor.
    pub grow: f64,
    /// h|λ| above this is near the stability limit.
    pub stiff: f64,
}

/// The step a method proposes next, from the errors of the last steps.
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.4;
/// Gustafsson, ACM TOMS 17 (1991) 533, for the proportional–integral form.
#[derive(Clone, Debug)]
pub(crate) struct StepControl {
    constants: Control,
    previous_error: f64,
    rejected: bool,
}

impl StepControl {
    const SAFETY: f64 = 0.9;

    /// At the start, and after every restart.
    pub fn new(constants: Control) -> Self {
        StepControl { constants, previous_error: 1e-4, rejected: false }
    }

    /// The next step after one of h was accepted with this error (at most 1).
    pub fn accepted(&mut self, h: f64, error: f64) -> f64 {
        let Control { exponent, beta, shrink, grow, .. } = self.constants;
        let proportional = error.powf(exponent - 0.75 * beta) / self.previous_error.powf(beta);
        let factor = (proportional / Self::SAFETY).clamp(1.0 / grow, 1.0 / shrink);
        let limit = if self.rejected { 1.0 } else { f64::INFINITY };
        self.previous_error = error.max(1e-4);
        self.rejected = false;
        h * (1.0 / factor).min(limit)
    }

    /// The step to try after one of h was rejected with this error (more than 1, or not finite).
    pub fn rejected(&mut self, h: f64, error: f64) -> f64 {
        let Control { exponent, beta, shrink, .. } = self.constants;
        self.rejected = true;
        if error.is_finite() {
            h / (error.powf(exponent - 0.75 * beta) / Self::SAFETY).min(1.0 / shrink)
        } else {
            h * shrink
        }
    }
}

/// A first step: one that an explicit Euler step's curvature allows.
///
/// Source: Hairer, Nørsett, Wanner I, section II.4, "starting step size".
pub(crate) fn first_step(
    stepper: &mut dyn OneStep,
    system: &dyn System,
    t: f64,
    tolerance: &Tolerance,
    longest: f64,
) -> Result<f64, Setback> {
    let (y, rate) = (stepper.start().y.to_vec(), stepper.start().rate.to_vec());
    let size = tolerance.norm(&y, &y);
    let speed = tolerance.norm(&rate, &y);
    let guess = if size < 1e-10 || speed < 1e-10 { 1e-6 } else { 0.01 * size / speed };
    let guess = guess.min(longest);
    let moved: Vec<f64> = y.iter().zip(&rate).map(|(y, rate)| y + guess * rate).collect();
    let mut new_rate = vec![0.0; y.len()];
    stepper.evaluate(system, t + guess, &moved, &mut new_rate)?;
    let change: Vec<f64> = new_rate.iter().zip(&rate).map(|(new, old)| new - old).collect();
    let curvature = (tolerance.norm(&change, &y) / guess).max(speed);
    let order = f64::from(stepper.order());
    let step = if curvature <= 1e-15 { (guess * 1e-3).max(1e-6) } else { (0.01 / curvature).powf(1.0 / order) };
    let step = step.min(100.0 * guess).min(longest);
    Ok(if step.is_finite() { step } else { guess })
}
