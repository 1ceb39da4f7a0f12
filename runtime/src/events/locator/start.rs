//! Events where a motion starts or ends.

use super::super::{modes, sample};
use super::{EventLocator, Fired, counts};
use crate::mechanism::{Action, Direction, System};

impl EventLocator {
    /// Notes on which side of zero events' functions are where a motion of `span` seconds starts with a step of `step`.  What is at its zero at
    /// the start `beside` this one, which was moved by rounding, is so here.
    pub fn start<S: System + ?Sized>(
        &mut self,
        system: &S,
        (t, y): (f64, &[f64]),
        beside: Option<&[f64]>,
        (step, span): (f64, f64),
    ) {
        let least = sample::least_rates(system, (t, y), step);
        for (event, least) in least.into_iter().enumerate() {
            let mut zero = self.sampler.zero_at_start(system, event, (t, y), step);
            let rate_beside = beside.and_then(|y| {
                let zero = self.sampler.zero_at_start(system, event, (t, y), step);
                self.sampler.at_state(system, t, y);
                (self.sampler.value(event).abs() <= zero).then(|| self.sampler.rate_of(event))
            });
            self.sampler.at_state(system, t, y);
            let value = self.sampler.value(event);
            if let Some(rate) = rate_beside {
                // What rests there drifts here.
                zero = zero.max(value.abs() + (self.sampler.rate_of(event) - rate).abs() * span);
            }
            let zero = zero.max(least);
            // A force that holds was decided to be within its limits: what it is beyond them is rounding.
            let zero = if self.scanner.holds(event) { zero.max(-value) } else { zero };
            let on = value.is_nan() || value.abs() <= zero;
            self.scanner.sides[event] = if on { 0.0 } else { value.signum() };
            self.scanner.zero[event] = zero;
            self.scanner.leaving[event] =
                if on { self.sampler.leaves_at_start(system, (event, zero), (t, y), span) } else { 0.0 };
            self.scanner.hold(event);
        }
    }

    /// Events that record, set or stop, at their zero where a motion ends with a step of `step`, and moving past: a motion that starts there
    /// waits for them.
    pub fn at_end<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64]), step: f64) -> Vec<usize> {
        let waits = |action: &Action| matches!(action, Action::Record | Action::Stop | Action::Set(_));
        let events = self.sampler.events();
        let happens = |event: &usize| {
            let described = &system.description().events[*event];
            let side = self.scanner.sides[*event];
            if !described.actions.iter().all(waits) || !self.scanner.awake(*event) || side == 0.0 {
                return false;
            }
            let zero = self.sampler.zero_at_start(system, *event, (t, y), step);
            self.sampler.at_state(system, t, y);
            let rate = self.sampler.rate_of(*event);
            let near = self.sampler.value(*event).abs() <= zero && rate * side < 0.0;
            // The zero may lie in the last step, as far as its rounding tells.
            let known = (rate * (t - self.logged[*event])).abs() <= zero;
            near && !known && counts(described.direction, side < 0.0) && self.sampler.condition(*event) > 0.0
        };
        (0..events).filter(happens).collect()
    }

    /// What leads away from the surface of a discontinuity to both sides of it, where modes were chosen last.
    pub fn undecided<S: System + ?Sized>(&self, system: &S) -> Option<String> {
        self.undecided.map(|switch| modes::text(system, switch))
    }

    /// Events with which a motion starts: those that leave a phase that they name and are past their zero, in their direction, or at it
    /// and move past, and impacts that are at it and move past.  Impacts that are past it, changes of the phase by events that name
    /// none, which would change it again and again, and what sets held values at its zero and moves past, are told.
    pub fn at_start<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64])) -> (Vec<Fired>, Vec<usize>) {
        let phase = system.phase() as u32;
        let (mut past, events) = (Vec::new(), &system.description().events);
        let mut fired = self.already_past(system, (t, y), true);
        fired.retain(|Fired { event, actions, .. }| {
            let beyond = self.scanner.sides[*event] != 0.0;
            // What contacts do at the start is decided: only those that approach are left.
            if actions.iter().any(|action| matches!(action, Action::Contact(_))) {
                return !beyond;
            }
            let strikes = actions.iter().any(|action| matches!(action, Action::Impact { .. }));
            if strikes && beyond {
                past.push(*event);
            }
            let elsewhere = actions.iter().any(|action| matches!(action, Action::Phase(other) if *other != phase));
            let named = events[*event].phases.is_some();
            if elsewhere && !named {
                past.push(*event);
            }
            if strikes { !beyond } else { elsewhere && named }
        });
        // From which side a contact without a direction is closed is not known where nothing moves yet.
        past.extend((0..events.len()).filter(|event| {
            let strikes = events[*event].actions.iter().any(|action| matches!(action, Action::Impact { .. }));
            let rests = self.scanner.sides[*event] == 0.0 && self.scanner.leaving[*event] != 0.0;
            strikes && events[*event].direction == Direction::Both && self.scanner.awake(*event) && rests && {
                self.sampler.at_state(system, t, y);
                self.sampler.rate_of(*event) == 0.0
            }
        }));
        past.extend((0..events.len()).filter(|event| self.sets_and_leaves(system, *event)));
        (fired, past)
    }

    /// Events that stop or set, past their zero in their direction where a motion starts, or at it and moving past: they wait until it comes back.
    pub fn waiting_at_start<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64])) -> Vec<usize> {
        let events = &system.description().events;
        self.sampler.at_state(system, t, y);
        let waits = |event: &usize| {
            let described = &events[*event];
            let acts = described.actions.iter().any(|action| matches!(action, Action::Stop | Action::Set(_)));
            let side = match self.scanner.sides[*event] {
                0.0 => self.scanner.leaving[*event],
                side => side,
            };
            let past = match described.direction {
                Direction::Both => false,
                Direction::Rising => side > 0.0,
                Direction::Falling => side < 0.0,
            };
            acts && past && self.scanner.awake(*event) && self.sampler.condition(*event) > 0.0
        };
        (0..events.len()).filter(waits).collect()
    }

    /// Whether an event that sets held values starts at its zero and leaves it in its direction, so that it does not happen.
    fn sets_and_leaves<S: System + ?Sized>(&self, system: &S, event: usize) -> bool {
        let described = &system.description().events[event];
        let sets = described.actions.iter().any(|action| matches!(action, Action::Set(_)));
        let leaves = match described.direction {
            Direction::Both => false,
            Direction::Rising => self.scanner.leaving[event] > 0.0,
            Direction::Falling => self.scanner.leaving[event] < 0.0,
        };
        sets && leaves && self.scanner.sides[event] == 0.0 && self.scanner.awake(event)
    }
}
