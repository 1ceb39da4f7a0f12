//! Integrating the equations of motion in time.
//!
//! 1. [`Rates`] makes a first-order system of a mechanism: look in `rates.rs`.
//! 2. A family of one-step methods, each in its folder with the files `tableau`, `step`, `dense`,
//!    implements [`OneStep`]: look in `explicit/`.
//! 3. [`StepControl`] chooses steps against a [`Tolerance`]: look in `control.rs`.
//! 4. Between its ends a step is a [`Segment`]: look in `segment.rs`.
//!
//! `march` puts steps together to a motion.

mod choose;
mod clock;
mod control;
mod explicit;
mod rates;
mod segment;
mod stiffness;
mod tolerance;

pub(crate) use choose::{stability, stepper};

pub(crate) use clock::Clock;
pub(crate) use control::{StepControl, first_step};
pub(crate) use explicit::Tableau;
pub(crate) use rates::Rates;
pub(crate) use segment::Segment;
pub(crate) use stiffness::StiffnessDetector;
pub(crate) use tolerance::Tolerance;

use crate::mechanism::{Singular, System};

/// What a march asks of a family of one-step methods.
///
/// A step goes from (t, y), where the rate is known, to t + h.
pub(crate) trait OneStep<S: System + ?Sized> {
    /// Order, stability function and constants of control.
    fn tableau(&self) -> &'static Tableau;

    /// Computes the increment of y and returns its error in units of the tolerance (0 without one).
    fn attempt(
        &mut self,
        rates: &mut Rates,
        system: &S,
        from: (f64, f64, &[f64]),
        rate: &[f64],
        tolerance: Option<&Tolerance>,
    ) -> Result<f64, Singular>;

    /// y(t + h) − y(t) of the last attempt.
    fn increment(&self) -> &[f64];

    /// The rate at the end of the step, (t, y) being the end.
    fn end_rate(&mut self, rates: &mut Rates, system: &S, t: f64, y: &[f64]) -> Result<&[f64], Singular>;

    /// The rate at the end of the step, after [`OneStep::end_rate`].
    fn last_rate(&self) -> &[f64];

    /// h‖Δf‖/‖Δy‖ near the end of the step, an estimate of h|λ| of the stiffest mode; after
    /// [`OneStep::end_rate`].
    fn stiffness(&self, h: f64, end: &[f64]) -> f64;

    /// How many vectors dense output has.
    fn pieces(&self) -> usize;

    /// Writes dense output of the step; after [`OneStep::end_rate`].
    fn dense(
        &mut self,
        rates: &mut Rates,
        system: &S,
        from: (f64, f64, &[f64]),
        end: &[f64],
        pieces: &mut [f64],
    ) -> Result<(), Singular>;
}
