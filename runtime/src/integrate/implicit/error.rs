//! The error estimate of Radau's method.

use super::step::Collocation;
use super::tableau::STAGES;
use crate::integrate::{OneStep, StepFailure, Tolerance};
use crate::mechanism::System;

/// The estimate is of order 3 and the solution of order 5: steps are chosen against TIGHTER ε^(4/5) instead of ε, so that errors
/// are proportional to the tolerance.
const POWER: f64 = 0.2;
const TIGHTER: f64 = 0.3;

impl Collocation {
    /// The estimate in units of the tolerance: (1 − hγ₀J)⁻¹ (γ₀ h f(t, y) + Σ eᵢ (Yᵢ − y)), γ₀ the real eigenvalue of A; where
    /// that is too large, f is taken at y moved by it, which damps what stiff components make of it.
    ///
    /// Source: Hairer and Wanner II, equations (IV.8.19) and (IV.8.20); there in first and in repeated steps only, here wherever a
    /// step would be repeated.
    pub(super) fn error(
        &mut self,
        system: &dyn System,
        (t, h): (f64, f64),
        weights: [f64; STAGES],
        tolerance: &Tolerance,
    ) -> Result<f64, StepFailure> {
        let scale = tolerance.relative.powf(POWER) / TIGHTER;
        let Some((gamma, ..)) = self.tableau.real else { return Ok(0.0) };
        self.estimate(h, gamma, weights, None);
        let first = scale * self.ends.in_units(&self.errors, h, tolerance);
        if first <= 1.0 {
            return Ok(first);
        }
        let (mut moved, mut rate) = (std::mem::take(&mut self.room), std::mem::take(&mut self.ends.end_rate));
        moved.iter_mut().zip(self.ends.y.iter().zip(&self.errors)).for_each(|(at, (y, error))| *at = y + error);
        let evaluated = self.evaluate(system, t, &moved, &mut rate);
        self.estimate(h, gamma, weights, Some(&rate));
        (self.room, self.ends.end_rate) = (moved, rate);
        evaluated?;
        Ok(scale * self.ends.in_units(&self.errors, h, tolerance))
    }

    fn estimate(&mut self, h: f64, gamma: f64, weights: [f64; STAGES], rate: Option<&[f64]>) {
        let n = self.ends.n;
        let rate = rate.unwrap_or(&self.ends.rate);
        for j in 0..n {
            let change = |of: &[f64]| (0..self.tableau.stages()).map(|i| weights[i] * of[i * n + j]).sum::<f64>();
            self.errors[j] = gamma * h * rate[j] + change(&self.stages.places);
            self.errors[n + j] = gamma * h * rate[n + j] + change(&self.stages.speeds);
        }
        self.newton.real.solve_pair(&self.newton.slopes, gamma * h, &mut self.errors);
    }
}
