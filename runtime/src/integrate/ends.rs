//! The two ends of a step, for methods that go from one to the other in one piece.

use super::{Endpoint, StepFailure, Tolerance};
use crate::mechanism::System;

/// State, rate and W = ∫P dt where a step begins, and where the one that was tried ends.
pub(super) struct Ends {
    /// How many coordinates there are.
    pub n: usize,
    pub y: Vec<f64>,
    /// What rounding took from y in the last step.
    pub carry: Vec<f64>,
    pub rate: Vec<f64>,
    pub end: Vec<f64>,
    pub end_rate: Vec<f64>,
    /// What the step adds to y, what was left over from the step before included.
    pub increment: Vec<f64>,
    /// W so far, and what the step adds; `None`: nobody asks.
    work: Option<(f64, f64)>,
    /// Evaluations of the accelerations at the ends.
    pub evaluations: u64,
}

/// The ends of a step of a method that keeps them in `ends`, for its [`OneStep`](super::OneStep).
macro_rules! between_ends {
    () => {
        fn start(&self) -> Endpoint<'_> {
            self.ends.first()
        }

        fn state_mut(&mut self) -> &mut [f64] {
            &mut self.ends.y
        }

        fn end(&self) -> Endpoint<'_> {
            self.ends.last()
        }

        fn end_mut(&mut self) -> &mut [f64] {
            &mut self.ends.end
        }
    };
}
pub(super) use between_ends;

impl Ends {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        let state = || vec![0.0; 2 * n];
        Ends {
            n,
            y: state(),
            carry: state(),
            rate: state(),
            end: state(),
            end_rate: state(),
            increment: state(),
            work: work.then_some((0.0, 0.0)),
            evaluations: 0,
        }
    }

    /// Where the step begins.
    pub fn first(&self) -> Endpoint<'_> {
        Endpoint { y: &self.y, rate: &self.rate, work: self.work.map_or(0.0, |work| work.0) }
    }

    /// Where it ends.
    pub fn last(&self) -> Endpoint<'_> {
        Endpoint { y: &self.end, rate: &self.end_rate, work: self.work.map_or(0.0, |work| work.0 + work.1) }
    }

    /// Begins at the present state, with nothing left over.
    pub fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.carry.fill(0.0);
        self.evaluations += 1;
        Ok(system.rate(t, &self.y, &mut self.rate)?)
    }

    /// The end follows from what the step adds.
    pub fn add_up(&mut self) {
        for ((end, y), increment) in self.end.iter_mut().zip(&self.y).zip(&self.increment) {
            *end = y + increment;
        }
    }

    /// Whether anybody asks for W.
    pub fn works(&self) -> bool {
        self.work.is_some()
    }

    /// What the step adds to W.
    pub fn add_work(&mut self, added: f64) {
        self.work.iter_mut().for_each(|work| work.1 = added);
    }

    /// The rate at the end, which was `moved` or not; false where it is not finite.
    pub fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        if moved {
            self.move_end();
        }
        self.evaluations += 1;
        system.rate(t, &self.end, &mut self.end_rate)?;
        Ok(self.end_rate.iter().all(|rate| rate.is_finite()))
    }

    /// Takes note that the end was moved: what was lost to rounding is beside the constraints.
    pub fn move_end(&mut self) {
        let ends = self.end.iter().zip(&self.y);
        self.increment.iter_mut().zip(ends).for_each(|(increment, (end, y))| *increment = end - y);
    }

    /// Goes to the end; what rounding took is added to the next step if `compensated`.
    pub fn accept(&mut self, compensated: bool) {
        for (i, carry) in self.carry.iter_mut().enumerate() {
            *carry = if compensated { self.increment[i] - (self.end[i] - self.y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        std::mem::swap(&mut self.rate, &mut self.end_rate);
        if let Some((done, added)) = &mut self.work {
            *done += *added;
        }
    }

    /// The root mean square of errors of the end in units of the tolerance.
    pub fn in_units(&self, errors: &[f64], h: f64, tolerance: &Tolerance) -> f64 {
        let n = self.n;
        let sum: f64 = (0..n)
            .map(|j| {
                let changes = tolerance.coupled_changes(j, |k| (self.end[k] - self.y[k]).abs());
                let [place, speed] = tolerance.units_by_change(j, h, changes);
                (errors[j] / place).powi(2) + (errors[n + j] / speed).powi(2)
            })
            .sum();
        (sum / (2 * n).max(1) as f64).sqrt()
    }
}
