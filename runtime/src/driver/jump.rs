//! Jumps of the acceleration that the model does not declare.

use super::{Integration, Step};
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
    usual_step: f64,
    /// The longest step since then, s.
    longest: f64,
    /// Change of the acceleration per time over the last step.
    jerk: f64,
    /// So many short steps changed most of it.
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
/// Where so many steps that are this short beside the longest change most of the acceleration it may jump to and fro.
const FLIPS: u32 = 8;
const SHORT: f64 = 0.3;
/// So many times faster than over the step before, the acceleration does not change but by a jump.
const SUDDEN: f64 = 1e3;
/// So many short steps in a row are a stall.
const STALL: u32 = 20_000;
/// What happens at once happens within this part of a step, and while the state changes by so many units of the tolerance.
const LEAST_PART: f64 = 1.0 / 256.0;
const RESOLVED: f64 = 10.0;
/// Changes of no more than so many times their rounding are that.
const LOUD: f64 = 1e3;
/// A change of the acceleration over a step is noticed where it changes a rate by this part of the tolerance.
const NOTICED: f64 = 0.1;

impl JumpDetector {
    /// For a motion of `span` seconds.
    pub fn new(span: f64) -> Self {
        JumpDetector { usual_step: 0.0, longest: 0.0, jerk: f64::NAN, flips: 0, shortest: 1e-9 * span, short: 0 }
    }

    /// Looks at a step of h with these accelerations at its ends; a jump is one only if a closer look confirms it.
    pub fn observe(&mut self, h: f64, before: &[f64], after: &[f64]) -> Option<Upset> {
        let changes = before.iter().zip(after).map(|(before, after)| (after - before).abs());
        let change = changes.fold(0.0, larger);
        let size = || before.iter().chain(after).fold(0.0, |most, a| larger(most, a.abs()));
        let jerk = change / h;
        let most = change > 0.5 * size();
        self.longest = self.longest.max(h);
        self.flips += u32::from(most && h < SHORT * self.longest);
        // Ever more rarely: what vibrates fast may look like that too, for long.
        let flips = most && self.flips >= FLIPS && self.flips.is_power_of_two();
        let jumps = flips || h < COLLAPSE * self.usual_step && most && jerk > SUDDEN * self.jerk;
        self.usual_step = h.max(0.8 * self.usual_step);
        self.jerk = jerk;
        self.short = if h < self.shortest { self.short + 1 } else { 0 };
        if jumps {
            let moved = before.iter().zip(after).position(|(before, after)| (after - before).abs() == change);
            return moved.map(Upset::Jump);
        }
        (self.short > STALL).then_some(Upset::Stall)
    }

    /// Forgets what was before a restart.
    pub fn restart(&mut self) {
        (self.usual_step, self.longest, self.flips) = (0.0, 0.0, 0);
        self.jerk = f64::NAN;
    }
}

impl Integration {
    /// Refuses a step across which the acceleration jumps, unless it is time that makes it jump.
    pub(super) fn look_for_jumps(&mut self, system: &dyn System, step: Step) -> Result<(), Box<Cause>> {
        // Rows that begin or cease to count there change accelerations by what rounding makes of them.
        if self.dwell.is_there() || self.deficient(system).is_some() {
            self.jumps.restart();
            return Ok(());
        }
        let (start, end) = (self.stepper.start(), self.stepper.end());
        let n = start.y.len() / 2;
        match self.jumps.observe(step.h, &start.rate[n..], &end.rate[n..]) {
            None => Ok(()),
            Some(Upset::Stall) => {
                let noise = self.noise(system);
                let lost =
                    (0..n).find(|coordinate| self.is_of_direction(system, *coordinate, LOUD * noise[*coordinate]));
                if let Some(coordinate) = lost {
                    let coordinate = system.description().coordinate_name(coordinate);
                    return Err(Cause::DirectionLost { coordinate }.into());
                }
                // Steps that have been short from the beginning on are many, and have not collapsed.
                let needed = (self.until - self.clock.now()) / step.h;
                match step.h < COLLAPSE * self.jumps.longest {
                    true => Err(Cause::StepTooSmall { h: step.h }.into()),
                    false if needed <= self.max_steps as f64 => {
                        self.jumps.short = 0;
                        Ok(())
                    }
                    false => {
                        let needed = needed.ceil();
                        Err(Cause::NeedsMoreSteps { step: step.h, needed, limit: self.max_steps }.into())
                    }
                }
            }
            Some(Upset::Jump(coordinate)) => {
                let (before, after) = (start.rate[n + coordinate], end.rate[n + coordinate]);
                let (end, mut earlier) = (end.y.to_vec(), vec![0.0; 2 * n]);
                let mut effect = vec![0.0; 2 * n];
                effect[n + coordinate] = step.h * (after - before);
                // What moves nothing made no step collapse.
                if self.in_units(step, &effect) < NOTICED
                    || (after - before).abs() <= LOUD * self.noise(system)[coordinate]
                {
                    return Ok(());
                }
                let evaluated = self.stepper.evaluate(system, self.clock.now(), &end, &mut earlier);
                evaluated.map_err(|failure| failure.cause(system.description()))?;
                let by_state = (earlier[n + coordinate] - before).abs();
                if by_state > 0.5 * (after - before).abs() && self.jumps_within(system, step, coordinate)? {
                    let coordinate = system.description().coordinate_name(coordinate);
                    return Err(Cause::DirectionLost { coordinate }.into());
                }
                Ok(())
            }
        }
    }

    /// Whether the acceleration of a coordinate changes at once within the step that was tried: most of what it does over all of it is
    /// found in ever smaller parts, down to rounding; or, if speeds do it, down to what the tolerance lets be of a state, and their direction
    /// alone does.
    fn jumps_within(&mut self, system: &dyn System, step: Step, coordinate: usize) -> Result<bool, Box<Cause>> {
        const HALVINGS: u32 = 50;
        self.dense(system, step)?;
        let (now, n) = (self.clock.now(), system.len());
        let place = n + coordinate;
        let (mut state, mut rate) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        let mut sides = [self.stepper.start().y.to_vec(), self.stepper.end().y.to_vec()];
        let mut ends = [self.stepper.start().rate[place], self.stepper.end().rate[place]];
        let all = (ends[1] - ends[0]).abs();
        let turned = [&sides[0][..n], &sides[1][n..]].concat();
        self.stepper
            .evaluate(system, now, &turned, &mut rate)
            .map_err(|failure| failure.cause(system.description()))?;
        let by_speeds = (rate[place] - ends[0]).abs() > 0.5 * all;
        let (mut from, mut part) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            part *= 0.5;
            self.segment(step).evaluate(from + part, &mut state);
            let evaluated = self.stepper.evaluate(system, now + (from + part) * step.h, &state, &mut rate);
            evaluated.map_err(|failure| failure.cause(system.description()))?;
            let later = (rate[place] - ends[0]).abs() <= (ends[1] - rate[place]).abs();
            from += if later { part } else { 0.0 };
            ends[usize::from(!later)] = rate[place];
            sides[usize::from(!later)].copy_from_slice(&state);
            if (ends[1] - ends[0]).abs() <= 0.5 * all {
                return Ok(false);
            }
            let apart: Vec<f64> = sides[0].iter().zip(&sides[1]).map(|(a, b)| b - a).collect();
            // What places do is followed down to rounding.
            let known = if by_speeds { self.in_units(step, &apart) <= RESOLVED } else { sides[0] == sides[1] };
            if part <= LEAST_PART && known {
                break;
            }
        }
        Ok(!by_speeds || self.is_of_direction(system, coordinate, 0.5 * all))
    }

    /// Whether the acceleration of a coordinate is another by more than this, and more than half of itself, against the speeds at the step's
    /// start than along them, however small they are: what is regularised vanishes with them.
    fn is_of_direction(&mut self, system: &dyn System, coordinate: usize, least: f64) -> bool {
        const SCALES: [f64; 2] = [1e-6, 1e-9];
        let n = system.len();
        let (now, start) = (self.clock.now(), self.stepper.start().y.to_vec());
        let mut rate = vec![0.0; 2 * n];
        let mut at = |scale: f64| {
            let state: Vec<f64> = start.iter().enumerate().map(|(i, y)| if i < n { *y } else { scale * y }).collect();
            self.stepper.evaluate(system, now, &state, &mut rate).ok().map(|()| rate[n + coordinate])
        };
        SCALES.into_iter().all(|scale| match (at(scale), at(-scale)) {
            (Some(along), Some(against)) => {
                (along - against).abs() > least.max(0.5 * along.abs().max(against.abs())) && along != against
            }
            _ => false,
        })
    }
}
