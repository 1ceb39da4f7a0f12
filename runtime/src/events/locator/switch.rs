//! Discontinuities where they switch: which leave their surface, and to which side.

use super::super::impulse::{self, Impulse, kinetic_before, turn};
use super::super::modes::{self, Chosen, Known, Trial};
use super::{AT_ONCE, EventLocator, ON, RESTARTS, SEVERAL};
use crate::cause::Cause;
use crate::constrain::held_switches;
use crate::mechanism::System;

/// What happened at a state where switches were on their surface.
pub(crate) struct Switched {
    /// True if any was.
    pub any: bool,
    /// When the motion goes on: just after a jump of a closure, s.
    pub resume: f64,
    /// A jump of the speeds.
    pub impulse: Option<Impulse>,
}

impl EventLocator {
    /// A switch leaves its surface.
    pub fn leave<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (switch, side): (usize, f64),
        (t, y): (f64, &[f64]),
        trial: Trial<'_, S>,
    ) -> Result<(), Box<Cause>> {
        self.forget_surfaces();
        self.surface[switch] = true;
        self.choose(system, (t, y), Some((switch, side)), trial)?;
        self.forget_surfaces();
        Ok(())
    }

    /// Switches at a state in which [`EventLocator::fire`] found switches to cross zero, or at a stop time, or both, and finds
    /// what a jump of inputs does to the speeds.  Returns whether it was one of these.
    pub fn switch<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        trial: Trial<'_, S>,
    ) -> Result<Switched, Box<Cause>> {
        let (mut timed, mut resume) = (false, t);
        let mut breaks = Vec::new();
        while let Some(stop) = self.stops.pop(t) {
            (timed, self.within_rounding) = (true, false);
            resume = resume.max(stop.after);
            for (switch, side) in stop.switches {
                self.beyond[switch] = Some(side);
            }
            breaks.extend(stop.breaks);
        }
        self.leave_what_jumps(system, (t, y));
        let any = timed || self.surface.contains(&true) || self.beyond.iter().any(Option::is_some);
        let mut jump = None;
        if any {
            let inputs = 3 * system.description().inputs.len();
            let (mut before, mut after) = (vec![0.0; inputs], vec![0.0; inputs]);
            system.inputs(t, &mut before);
            let kinetic = if timed { kinetic_before(system, (t, y)) } else { 0.0 };
            for (input, one) in breaks {
                before[3 * input..3 * input + 3].copy_from_slice(&one.value);
                resume = resume.max(one.after);
            }
            self.choose(system, (resume, y), None, trial)?;
            system.inputs(resume, &mut after);
            if timed {
                jump = impulse::impulse(system, (t, y), &before, &after, kinetic)?;
                if jump.is_none() {
                    jump = turn(system, (t, resume), y, kinetic)?;
                }
            }
            if let Some(impulse) = &jump {
                // Speeds that jump may have other sides.
                self.surface.fill(false);
                let mut y = y.to_vec();
                let speeds = y.iter_mut().skip(impulse.jump.len());
                speeds.zip(&impulse.jump).for_each(|(speed, jump)| *speed += jump);
                self.choose(system, (resume, &y), None, trial)?;
            }
            self.forget_surfaces();
        }
        if self.stops.list.is_empty() && self.stops.horizon <= t {
            self.stops.extend(system, (&mut self.sampler, &mut self.arguments), y)?;
            resume = self.stops.pass(resume);
        }
        Ok(Switched { any, resume, impulse: jump })
    }

    /// Takes off its surface what others that switch at this instant move away from it: a tank that is full in the moment in which its pump turns
    /// round.
    fn leave_what_jumps<S: System + ?Sized>(&mut self, system: &mut S, (t, y): (f64, &[f64])) {
        if !self.surface.contains(&true) || self.beyond.iter().all(Option::is_none) {
            return;
        }
        let before = system.modes().to_vec();
        let after = before.iter().zip(&self.beyond).enumerate();
        let after: Vec<f64> =
            after.map(|(k, (mode, side))| side.map_or(*mode, |side| modes::mode(system, k, side))).collect();
        system.set_modes(&after);
        self.sampler.at_state(system, t, y);
        system.set_modes(&before);
        for switch in (0..self.surface.len()).filter(|switch| self.surface[*switch]).collect::<Vec<_>>() {
            let function = self.sampler.function_of(switch);
            let value = self.sampler.value(function);
            if value.abs() > ON * self.scanner.largest(function) {
                self.surface[switch] = false;
                self.beyond[switch] = Some(value.signum());
            }
        }
    }

    pub(super) fn forget_surfaces(&mut self) {
        self.surface.fill(false);
        self.beyond.fill(None);
    }

    /// Chooses the modes and sets the switches' sides to match.
    pub(super) fn choose<S: System + ?Sized>(
        &mut self,
        system: &mut S,
        (t, y): (f64, &[f64]),
        leaves: Option<(usize, f64)>,
        trial: Trial<'_, S>,
    ) -> Result<(), Box<Cause>> {
        let at_once = t - self.last_restart <= AT_ONCE * self.step || self.within_rounding;
        self.restarts = if at_once { self.restarts + 1 } else { 0 };
        self.last_restart = t;
        self.scanner.restart();
        self.monitors.forget();
        if !at_once {
            self.met.fill(false);
        }
        let released = std::mem::replace(&mut self.held, held_switches(system, (t, y)));
        // What was met at the instant about which restarts crowd is on its surface still: that it has left it is rounding.  What was held until now
        // begins there, too.
        let crowds = self.restarts > RESTARTS;
        let on = |k: usize| self.surface[k] || crowds && self.met[k] || released[k] && !self.held[k];
        let surface: Vec<bool> = (0..self.surface.len()).map(on).collect();
        let next_stop = self.stops.next();
        let known =
            Known { surface: &surface, beyond: &self.beyond, leaves, held: &self.held, step: self.step, next_stop };
        let Chosen { on, undecided } = modes::choose(system, &mut self.sampler, (t, y), &known, trial)?;
        self.met.iter_mut().zip(&on).for_each(|(met, on)| *met |= on);
        self.undecided = undecided;
        if self.restarts > SEVERAL {
            for switch in (0..on.len()).filter(|switch| on[*switch]) {
                modes::rest_if_sides_agree(system, &mut self.sampler, (t, y), switch);
            }
        }
        // What is met again and again at one instant stays there, if it can.
        if (RESTARTS..2 * RESTARTS).contains(&self.restarts) {
            modes::stay_where_on(system, &mut self.sampler, (t, y), (&on, AT_ONCE * self.step));
        }
        self.sampler.at_state(system, t, y);
        for (switch, on) in on.into_iter().enumerate() {
            let function = self.sampler.function_of(switch);
            self.scanner.look_at(function, !self.held[switch]);
            let slides = system.sliding().contains(&switch);
            self.scanner.sides[function] = if slides { 1.0 } else { modes::side(system, switch) };
            self.scanner.fresh[function] |= on;
            if on || slides {
                // What is on its surface begins there, on whichever side rounding has put it.
                self.scanner.zero[function] = if slides { 0.0 } else { self.sampler.value(function).abs() };
            }
            if on && self.restarts >= 2 * RESTARTS {
                return Err(modes::chattering(system, (t, y), switch).into());
            }
        }
        Ok(())
    }
}
