//! Ticks of clocks, and what events set.

use super::{Integration, StopReason};
use crate::cause::Cause;
use crate::constrain::with_shares;
use crate::events::{EventLocator, Fired};
use crate::mechanism::{At, System, Target, Trigger};
use crate::run::Recorder;

/// What was set at an instant since it was looked at last.
#[derive(Clone, Debug, Default)]
pub(super) struct Assigned {
    /// Which held values were.
    held: Vec<bool>,
    /// Whether anything was.
    pub any: bool,
}

/// So much earlier, in parts of the last step, assigned values are looked at for jumps: far more than an event is located to.
const MOMENT: f64 = 1e-9;
/// No less earlier, in parts of the time.
const LATE: f64 = 64.0 * f64::EPSILON;
/// What changes by less of itself in this moment is rounding.
const JUMP: f64 = 1e-12;

impl Integration {
    /// Does what the events of the earliest ticks that have come say.
    pub(super) fn tick(&mut self, system: &mut dyn System, recorder: &mut Recorder) -> Result<StopReason, Box<Cause>> {
        let events = self.ticks.take(self.clock.now());
        let Some(mut locator) = self.locator.take() else { return Ok(StopReason::Arrived) };
        let fired = locator.pending(system, events.into_iter());
        let outcome = if fired.is_empty() {
            Ok(StopReason::Arrived)
        } else {
            recorder.leave(system, self.clock.now(), self.stepper.start());
            self.act(system, fired, &mut locator, recorder)
        };
        self.locator = Some(locator);
        outcome
    }

    /// Sets what one `set` says, all of it from the values before; the last step was this long, s.
    ///
    /// # Errors
    /// [`Cause::NonFinite`] names what would not be a number.
    pub(super) fn assign(
        &mut self,
        system: &mut dyn System,
        (event, set): (usize, usize),
        last_step: f64,
        assigned: &mut Assigned,
    ) -> Result<(), Box<Cause>> {
        let (n, sampling) = (system.len(), system.sampling());
        let (first, targets) = (sampling.first_of_set(set), sampling.sets[set].to_vec());
        let mut values = assignments(system, (self.clock.now(), self.stepper.start().y))?;
        if *sampling.trigger(event) == Trigger::Zero {
            self.before_jumps(system, last_step, &mut values);
        }
        let mut memory = system.memory().to_vec();
        assigned.held.resize(memory.len(), false);
        for (target, value) in targets.iter().zip(&values[first..]) {
            if !value.is_finite() {
                let name = match target {
                    Target::Memory(place) => system.sampling().memory[*place as usize].name.to_string(),
                    Target::State(place) => system.description().coordinate_name(*place as usize),
                };
                let what = format!("`{name}`, set by `{}`,", system.description().events[event].name);
                return Err(Cause::NonFinite { what }.into());
            }
            match target {
                Target::Memory(place) => {
                    memory[*place as usize] = *value;
                    assigned.held[*place as usize] = true;
                }
                Target::State(place) => self.stepper.state_mut()[n + *place as usize] = *value,
            }
        }
        system.set_memory(&memory);
        assigned.any = true;
        Ok(())
    }

    /// Puts what was just before in the place of assigned values that jump where an event is located: `sign(x)` where x rises through 0 is −1, and
    /// not what rounding makes of it.
    fn before_jumps(&self, system: &dyn System, last_step: f64, values: &mut [f64]) {
        let (now, n, start) = (self.clock.now(), system.len(), self.stepper.start());
        let moment = (MOMENT * last_step).max(LATE * now.abs());
        let earlier = |by: f64| {
            let (q, v) = start.y.split_at(n);
            let rates = v.iter().zip(&start.rate[n..2 * n]);
            let places = q.iter().zip(rates.clone()).map(|(q, (v, a))| q - by * (v - 0.5 * by * a));
            let y: Vec<f64> = places.chain(rates.map(|(v, a)| v - by * a)).collect();
            assignments(system, (now - by, &y))
        };
        // Where they are not known there is nothing to take.
        let (Ok(near), Ok(far)) = (earlier(moment), earlier(10.0 * moment)) else { return };
        for ((value, near), far) in values.iter_mut().zip(near).zip(far) {
            let jump = (*value - near).abs();
            if jump > 0.5 * (*value - far).abs() && jump > JUMP * value.abs().max(near.abs()) {
                *value = near;
            }
        }
    }

    /// Events that follow what was set, in file order, each once.
    pub(super) fn consequences(&self, system: &dyn System, assigned: &Assigned, locator: &EventLocator) -> Vec<Fired> {
        let triggers = system.sampling().triggers.iter().enumerate();
        let follows = |(_, trigger): &(usize, &Trigger)| match trigger {
            Trigger::Set(held) => held.iter().any(|place| assigned.held.get(*place as usize) == Some(&true)),
            _ => false,
        };
        locator.pending(system, triggers.filter(follows).map(|(event, _)| event))
    }
}

/// All that the events of a mechanism would set at a state.
fn assignments(system: &dyn System, (t, y): (f64, &[f64])) -> Result<Vec<f64>, Box<Cause>> {
    let (n, sampling) = (system.len(), system.sampling());
    let mut values = vec![0.0; sampling.assignments()];
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = At::packed(t, y, n);
    if sampling.sets_use_accelerations {
        (a, lambda) = with_shares(system, at)
            .map_err(|fault| crate::integrate::StepFailure::from(fault).cause(system.description()))?;
    }
    system.assignments(at.accelerated(&a).constrained(&lambda), &mut values);
    Ok(values)
}
