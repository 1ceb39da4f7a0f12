//! What stays where it is.

use super::{Control, Counters, Endpoint, OneStep, Segment, StepFailure, Trial};
use crate::mechanism::System;

/// A mechanism at rest in a stable equilibrium, as far as rounding tells: it stays there.
///
/// A method would take what rounding leaves of the forces for a vibration, with steps that its stability limits.
pub(crate) struct AtRest {
    y: Vec<f64>,
    still: Vec<f64>,
    control: Control,
    counters: Counters,
    work: f64,
}

impl AtRest {
    /// Where a method is now.
    pub fn new(of: &dyn OneStep) -> Self {
        let Endpoint { y, rate, work } = of.start();
        let (y, still) = (y.to_vec(), vec![0.0; rate.len()]);
        AtRest { y, still, control: of.control(), counters: of.counters(), work }
    }
}

impl OneStep for AtRest {
    fn control(&self) -> Control {
        self.control
    }

    fn counters(&self) -> Counters {
        self.counters
    }

    fn start(&self) -> Endpoint<'_> {
        Endpoint { y: &self.y, rate: &self.still, work: self.work }
    }

    fn state_mut(&mut self) -> &mut [f64] {
        &mut self.y
    }

    fn end(&self) -> Endpoint<'_> {
        self.start()
    }

    fn end_mut(&mut self) -> &mut [f64] {
        &mut self.y
    }

    fn begin(&mut self, _: &dyn System, _: f64) -> Result<(), StepFailure> {
        Ok(())
    }

    fn evaluate(&mut self, _: &dyn System, _: f64, _: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        rate.fill(0.0);
        Ok(())
    }

    fn attempt(&mut self, _: &dyn System, _: Trial<'_>) -> Result<f64, StepFailure> {
        Ok(0.0)
    }

    fn conclude(&mut self, _: &dyn System, _: f64, _: bool) -> Result<bool, StepFailure> {
        Ok(true)
    }

    fn errors(&self) -> &[f64] {
        &self.still
    }

    fn accept(&mut self, _: bool) {}

    fn keeps_constraints(&self) -> bool {
        true
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, _: f64) -> Result<(), StepFailure> {
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: self.y.len(), pieces: &self.y }
    }
}
