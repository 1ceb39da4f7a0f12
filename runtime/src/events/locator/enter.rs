//! What is looked at anew after phases or speeds changed: which events count, on which side they are, and which are past their zero.

use super::super::modes::Trial;
use super::super::sample;
use super::{EventLocator, Fired, ON, OPEN};
use crate::cause::Cause;
use crate::constrain::{Moment, never_stopping};
use crate::mechanism::{Direction, System};

impl EventLocator {
    /// Looks anew at everything after the phase changed or speeds were `hit`: which events count, and on which side
    /// they are.
    pub fn enter<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        hit: bool,
        trial: Trial<'_, S>,
    ) -> Result<(), Box<Cause>> {
        self.forget_surfaces();
        if hit {
            // What was held may have been struck off its surface.
            self.held.fill(false);
        }
        self.choose(system, (t, y), None, trial)?;
        self.scanner
            .activate(system, &never_stopping(system, &Moment { t, y, scales: &[], fastest: &[], step: self.step }));
        let least = sample::least_rates(system, (t, y), self.step);
        for (function, least) in least.into_iter().enumerate() {
            // One that slept until now has no size yet but what it gains in a step.
            let seen = self.scanner.largest(function);
            let variation = match self.scanner.awake(function) {
                true => self.sampler.variation(system, function, (t, y), self.step),
                false => 0.0,
            };
            self.sampler.at_state(system, t, y);
            let value = self.sampler.value(function);
            let slides = sample::slides(system, function).is_some_and(|side| side * value > 0.0);
            let near = match self.sampler.terms_of_gap(system, function, (t, y)) {
                Some((terms, within)) => {
                    let open = OPEN * seen.max(variation).max(terms);
                    // What closes others moves the sides of one that opens into each other by as much as closed ones are apart.
                    if value < 0.0 { open.max(within) } else { open }
                }
                // What was decided to slide as it does, however slowly, may stop at once.
                None if slides => 0.0,
                None => ON * seen.max(variation),
            };
            let on = value.is_nan()
                || value.abs() <= near.max(least)
                || value.abs() <= self.sampler.rounding_at(system, function, (t, y));
            self.scanner.sides[function] = if on { 0.0 } else { value.signum() };
            self.scanner.refresh(function);
            self.scanner.leaving[function] = 0.0;
            self.scanner.zero[function] = if on { self.surface_of(system, function, (t, y)).max(least) } else { 0.0 };
        }
        for function in 0..self.sampler.events() {
            if self.scanner.sides[function] == 0.0 && self.scanner.awake(function) {
                let scale = (self.step, self.scanner.largest(function), hit);
                self.scanner.leaving[function] = self.sampler.leaves(system, function, (t, y), scale);
                self.scanner.hold(function);
            }
        }
        Ok(())
    }

    /// What is zero of an event's function that is at its zero in the state that was evaluated last: it stays about the value there, by
    /// its rounding and what it changes by in no time.
    pub(super) fn surface_of<S: System + ?Sized>(&mut self, system: &S, event: usize, (t, y): (f64, &[f64])) -> f64 {
        let value = self.sampler.value(event).abs();
        let zero = value + self.sampler.zero_at_start(system, event, (t, y), self.step);
        if zero.is_nan() { 0.0 } else { zero }
    }

    /// Events that change phases or speeds and are past their zero, in their direction, where a phase was `entered`, or
    /// leave it so, there or after an impact.
    pub fn already_past<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64]), entered: bool) -> Vec<Fired> {
        let mut fired = Vec::new();
        for (function, event) in system.description().events.iter().enumerate() {
            if !event.changes_motion() || !self.scanner.awake(function) {
                continue;
            }
            let side = match self.scanner.sides[function] {
                0.0 => self.scanner.leaving[function],
                side if entered => side,
                _ => 0.0,
            };
            self.sampler.at_state(system, t, y);
            let past = match event.direction {
                // What slides against its mode has stopped: coming to rest on a contact may turn the sliding on others.
                Direction::Both => sample::slides(system, function).is_some_and(|own| own * side < 0.0),
                Direction::Rising => side > 0.0,
                Direction::Falling => side < 0.0,
            };
            if past && self.sampler.condition(function) > 0.0 {
                fired.push(Fired { event: function, actions: event.actions.to_vec(), pending: false });
            }
        }
        fired
    }
}
