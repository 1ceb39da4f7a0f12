//! Events that do not wait for zeros, and what changes for all where something was set.

use super::super::modes::Trial;
use super::{EventLocator, Fired};
use crate::cause::Cause;
use crate::mechanism::System;

impl EventLocator {
    /// Events that do not wait for zeros, in file order, as far as they count in the phase in force.
    pub fn pending<S: System + ?Sized>(&self, system: &S, events: impl Iterator<Item = usize>) -> Vec<Fired> {
        let (phase, described) = (system.phase() as u32, &system.description().events);
        let counts = |event: &usize| {
            let phases = described[*event].phases.as_ref();
            !self.ignored.contains(event) && phases.is_none_or(|phases| phases.contains(&phase))
        };
        let fired = |event: usize| Fired { event, actions: described[event].actions.to_vec(), pending: true };
        events.filter(counts).map(fired).collect()
    }

    /// Whether the condition of an event holds at a state.
    pub fn holds<S: System + ?Sized>(&mut self, system: &S, event: usize, (t, y): (f64, &[f64])) -> bool {
        if !system.description().events[event].conditional {
            return true;
        }
        self.sampler.at_state(system, t, y);
        self.sampler.condition(event) > 0.0
    }

    /// The values of all events' functions at a state.
    pub fn values<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64])) -> Vec<f64> {
        let watched: Vec<usize> = (0..self.sampler.events()).filter(|event| !self.scanner.is_ignored(*event)).collect();
        if watched.is_empty() {
            return Vec::new();
        }
        self.sampler.at_state(system, t, y);
        (0..self.sampler.events()).map(|event| self.sampler.value(event)).collect()
    }

    /// Looks anew at discontinuities after something was set, and at events whose functions were not what they are now: a function that
    /// jumps over its zero is on its new side, and one that does not jump goes on as if nothing had happened.
    pub fn reassigned<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        before: &[f64],
        trial: Trial<'_, S>,
    ) -> Result<(), Box<Cause>> {
        self.forget_surfaces();
        self.within_rounding = false;
        self.choose(system, (t, y), None, trial)?;
        self.forget_surfaces();
        for (event, (before, now)) in before.iter().zip(self.values(system, (t, y))).enumerate() {
            if *before != now {
                let zero = self.sampler.rounding_at(system, event, (t, y));
                let on = now.is_nan() || now.abs() <= zero || self.scanner.holds(event) && now < 0.0;
                self.scanner.sides[event] = if on { 0.0 } else { now.signum() };
                self.scanner.refresh(event);
                self.scanner.leaving[event] = 0.0;
                self.scanner.zero[event] = if on { self.surface_of(system, event, (t, y)) } else { 0.0 };
                self.scanner.hold(event);
            }
        }
        Ok(())
    }
}
