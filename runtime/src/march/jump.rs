//! Jumps of the acceleration that the model does not declare.

use super::{March, Step};
use crate::cause::Cause;
use crate::integrate::larger;
use crate::mechanism::System;

/// Notices jumps of the acceleration, and steps so short that the run would never end.
///
/// Discontinuities that a model declares are switched at, so that steps never see them.  What is left is a
/// force along a direction that is lost, as `unit(velocity(puck))` where the puck comes to rest: the step
/// collapses there, and the acceleration jumps across it.
#[derive(Clone, Debug)]
pub(crate) struct JumpDetector {
    /// The length of steps before they collapsed, s.
    calm: f64,
    /// The longest step since then, s.
    longest: f64,
    /// Change of the acceleration per time over the last step.
    pace: f64,
    /// So many of the steps changed most of it since they are short.
    flips: u32,
    /// Steps shorter than this, s, count as a stall.
    shortest: f64,
    short: u32,
}

/// What is wrong with a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Upset {
    /// The acceleration of this coordinate jumps.
    Jump(usize),
    /// The steps stay too short.
    Stall,
}

/// So many times shorter than before is a collapse.
const COLLAPSE: f64 = 1e-3;
/// Where steps stay this short beside the longest, and so many of them change most of the acceleration, it may jump to and fro.
const SHORT: f64 = 1e-2;
const FLIPS: u32 = 8;
/// So many times faster than over the step before, the acceleration does not change but by a jump.
const SUDDEN: f64 = 1e3;
/// So many short steps in a row are a stall.
const STALL: u32 = 20_000;
/// A change of the acceleration over a step is noticed where it changes a rate by this part of the tolerance.
const NOTICED: f64 = 0.1;

impl JumpDetector {
    /// For a motion of `span` seconds.
    pub fn new(span: f64) -> Self {
        JumpDetector { calm: 0.0, longest: 0.0, pace: f64::NAN, flips: 0, shortest: 1e-9 * span, short: 0 }
    }

    /// Looks at a step of h with these accelerations at its ends; a jump is one only if a closer look confirms it.
    pub fn observe(&mut self, h: f64, before: &[f64], after: &[f64]) -> Option<Upset> {
        let changes = before.iter().zip(after).map(|(before, after)| (after - before).abs());
        let change = changes.fold(0.0, larger);
        let size = || before.iter().chain(after).fold(0.0, |most, a| larger(most, a.abs()));
        let pace = change / h;
        let most = change > 0.5 * size();
        self.longest = self.longest.max(h);
        self.flips = if h < SHORT * self.longest { self.flips + u32::from(most) } else { 0 };
        // Ever more rarely: what vibrates fast may look like that too, for long.
        let flips = most && self.flips >= FLIPS && self.flips.is_power_of_two();
        let jumps = flips || h < COLLAPSE * self.calm && most && pace > SUDDEN * self.pace;
        self.calm = h.max(0.8 * self.calm);
        self.pace = pace;
        self.short = if h < self.shortest { self.short + 1 } else { 0 };
        if jumps {
            let moved = before.iter().zip(after).position(|(before, after)| (after - before).abs() == change);
            return moved.map(Upset::Jump);
        }
        (self.short > STALL).then_some(Upset::Stall)
    }

    /// Forgets what was before a restart.
    pub fn restart(&mut self) {
        (self.calm, self.longest, self.flips) = (0.0, 0.0, 0);
        self.pace = f64::NAN;
    }
}

impl March {
    /// Refuses a step across which the acceleration jumps, unless it is time that makes it jump.
    pub(super) fn look_for_jumps(&mut self, system: &dyn System, step: Step) -> Result<(), Box<Cause>> {
        // Rows that begin or cease to count there change accelerations by what rounding makes of them.
        if self.dwelling.is_there() || self.deficient(system).is_some() {
            self.jumps.restart();
            return Ok(());
        }
        let (start, end) = (self.stepper.start(), self.stepper.end());
        let n = start.y.len() / 2;
        match self.jumps.observe(step.h, &start.rate[n..], &end.rate[n..]) {
            None => Ok(()),
            Some(Upset::Stall) => Err(Cause::StepTooSmall { h: step.h }.into()),
            Some(Upset::Jump(coordinate)) => {
                let (before, after) = (start.rate[n + coordinate], end.rate[n + coordinate]);
                let (end, mut earlier) = (end.y.to_vec(), vec![0.0; 2 * n]);
                let mut effect = vec![0.0; 2 * n];
                effect[n + coordinate] = step.h * (after - before);
                // What moves nothing made no step collapse.
                if self.in_units(step, &effect) < NOTICED {
                    return Ok(());
                }
                let evaluated = self.stepper.evaluate(system, self.clock.now(), &end, &mut earlier);
                evaluated.map_err(|setback| setback.cause(system.description()))?;
                let by_state = (earlier[n + coordinate] - before).abs();
                if by_state > 0.5 * (after - before).abs() && self.jumps_within(system, step, coordinate)? {
                    let coordinate = system.description().coordinate_name(coordinate);
                    return Err(Cause::DirectionLost { coordinate }.into());
                }
                Ok(())
            }
        }
    }

    /// Whether the acceleration of a coordinate changes within one of 256 parts of the step that was tried by most of what it
    /// does over all of it: what is narrow, but resolved by such short steps, does not.
    fn jumps_within(&mut self, system: &dyn System, step: Step, coordinate: usize) -> Result<bool, Box<Cause>> {
        const HALVINGS: u32 = 8;
        self.dense(system, step)?;
        let (now, place) = (self.clock.now(), system.len() + coordinate);
        let mut state = vec![0.0; 2 * system.len()];
        let mut rate = state.clone();
        let mut ends = [self.stepper.start().rate[place], self.stepper.end().rate[place]];
        let all = (ends[1] - ends[0]).abs();
        let (mut from, mut part) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            part *= 0.5;
            self.segment(step).evaluate(from + part, &mut state);
            let evaluated = self.stepper.evaluate(system, now + (from + part) * step.h, &state, &mut rate);
            evaluated.map_err(|setback| setback.cause(system.description()))?;
            if (rate[place] - ends[0]).abs() > (ends[1] - rate[place]).abs() {
                ends[1] = rate[place];
            } else {
                (from, ends[0]) = (from + part, rate[place]);
            }
        }
        Ok((ends[1] - ends[0]).abs() > 0.5 * all)
    }
}
