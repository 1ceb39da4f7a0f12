//! What is changed by hand between two steps.

use super::Integration;
use crate::cause::Cause;
use crate::constrain::{Change, Kinematics};
use crate::events::{begin_at, begin_at_state, impulse};
use crate::mechanism::System;
use crate::run::Recorder;

impl Integration {
    /// Follows changed clocks, and decides what all contacts do after a change by hand, before which their sides were placed and moved like this.
    pub fn changed_by_hand(
        &mut self,
        system: &mut dyn System,
        before: &[Kinematics],
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        self.ticks.follow(system, self.clock.now());
        if !before.is_empty() {
            begin_at(system, self.clock.now(), self.stepper.start().y);
            self.settle_after(system, Change::ByHand(before, begin_at_state), recorder)?;
        }
        Ok(())
    }

    /// Lets the speeds jump where inputs were changed by hand from the first to the second of these, (u, u', u'') of each; T was `kinetic` before.
    ///
    /// # Errors
    /// What would need an infinite force.
    pub fn inputs_changed(
        &mut self,
        system: &mut dyn System,
        (before, after): (&[f64], &[f64]),
        kinetic: f64,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        let (now, y) = (self.clock.now(), self.stepper.start().y);
        let impulse = impulse(system, (now, y), before, after, kinetic)?;
        self.apply_impulse(impulse, recorder);
        self.apply_velocity_jump(system, 0.0, recorder)
    }
}
