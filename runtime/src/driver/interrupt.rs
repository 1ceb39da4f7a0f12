//! Steps that events and discontinuities may end early.

use super::plan::UNEVEN;
use super::{Integration, Step, StepPolicy, StopReason, finite};
use crate::cause::Cause;
use crate::constrain::Kinematics;
use crate::events::{Crossing, EventLocator, Fired, Impulse, Interruption, Switched};
use crate::integrate::StepFailure;
use crate::mechanism::{Action, System};
use crate::run::Recorder;

/// What became of a step that is watched.
pub(super) enum Outcome {
    /// It is taken, or what an event leaves of it.
    Kept(StopReason),
    /// It fell short of what lies before a crossing, or is too long to show what happens near its start: nothing is taken, and the
    /// next one is no longer than this, s.
    MissedFeature(f64),
}

impl Integration {
    /// Writes down and takes a step, whose dense output is made if that is wanted or watched, as far as the first event that stops or the first
    /// discontinuity.
    pub(super) fn watched(
        &mut self,
        system: &mut dyn System,
        (step, dense): (Step, bool),
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<Outcome, Box<Cause>> {
        let interruption = if locator.wants_dense(system) { locator.scan(system, &self.segment(step))? } else { None };
        if let Some(shorter) = locator.early(&self.segment(step)).filter(|_| locator.wants_dense(system)) {
            return Ok(Outcome::MissedFeature(shorter));
        }
        match interruption {
            None => {
                self.take_whole(system, (step, dense), locator, recorder).map(|()| Outcome::Kept(StopReason::Arrived))
            }
            Some(Interruption::Leaves { switch, side }) => {
                recorder.leave(system, self.clock.now(), self.stepper.start());
                let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
                let kinematics = self.kinematics(system);
                locator.leave(system, (switch, side), (now, &y), &mut |system| self.trial(system))?;
                self.forces_jumped(system, &kinematics, locator, recorder)?;
                Ok(Outcome::Kept(StopReason::Arrived))
            }
            Some(Interruption::At(crossing)) => self.take_to_crossing(system, (step, crossing), locator, recorder),
        }
    }

    /// Writes down and takes a step in which nothing happens, and switches what the stop at its end does.
    fn take_whole(
        &mut self,
        system: &mut dyn System,
        (step, dense): (Step, bool),
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        if locator.wants_dense(system) {
            let segment = self.segment(step);
            recorder.means(self.stepper.means());
            recorder.accept(system, Some(&segment), step.next, self.stepper.end())?;
            locator.pass(system, &segment, recorder);
            self.commit(step);
        } else {
            self.keep(system, step, dense, recorder)?;
            locator.step(step.h);
        }
        if step.lands {
            recorder.leave(system, step.next, self.stepper.start());
            self.switch(system, locator, recorder)?;
        }
        Ok(())
    }

    /// Writes down and takes a step as far as a crossing, and does what happens there; where the way to the next stop is divided, takes a
    /// part of the way to the crossing only.
    fn take_to_crossing(
        &mut self,
        system: &mut dyn System,
        (step, crossing): (Step, Crossing),
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<Outcome, Box<Cause>> {
        if self.divides() && self.part(system, step.h * crossing.theta, locator, recorder)? {
            return Ok(Outcome::Kept(StopReason::Arrived));
        }
        let together = locator.simultaneous(crossing, &self.segment(step));
        let fired = match self.shorten(system, step, crossing, locator)? {
            Some((shorter, error)) if self.is_blind(error) && !locator.may_stop_in_space(system, crossing.function) => {
                // Newton's method may have gone beyond the step that was tried, which is not to be tried again.
                let shorter = self.control.rejected(shorter.h, error);
                return Ok(Outcome::MissedFeature(shorter.min(RETRIED * step.h)));
            }
            Some((shorter, error)) if self.is_blurred(system, (crossing.function, shorter, error), locator) => {
                return Ok(Outcome::MissedFeature(BEFORE_A_STOP * shorter.h.min(crossing.theta * step.h)));
            }
            Some((shorter, _)) => {
                let (segment, end) = (self.segment(shorter), self.stepper.end());
                recorder.means(self.stepper.means());
                recorder.accept(system, Some(&segment), shorter.next, end)?;
                locator.record_before(system, &segment, recorder, &together)?;
                let fired = locator.fire(system, &together, (shorter.next, end.y), recorder);
                self.observe(system, shorter);
                self.commit(shorter);
                fired
            }
            None => locator.fire(system, &together, (self.clock.now(), self.stepper.start().y), recorder),
        };
        self.act_at_crossing(system, fired, locator, recorder).map(Outcome::Kept)
    }

    /// Does what events say that fire at the present state, with ticks of the same instant, and switches what is on its surface there.
    fn act_at_crossing(
        &mut self,
        system: &mut dyn System,
        mut fired: Vec<Fired>,
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<StopReason, Box<Cause>> {
        let now = self.clock.now();
        if self.ticks.is_due(now) {
            // A tick at the same instant has its place in the file's order.
            let ticks = self.ticks.take(now);
            fired.extend(locator.pending(system, ticks.into_iter()));
            fired.sort_by_key(|fired| fired.event);
        }
        let first = fired.iter().flat_map(|fired| &fired.actions).find(|action| **action != Action::Record);
        if first == Some(&Action::Stop) && !fired.iter().any(|fired| fired.pending) {
            self.waiting.retain(|waiting| !fired.iter().any(|fired| fired.event == *waiting));
            // What jumps where an event ends the run belongs to it.
            if locator.is_due(self.clock.now()) {
                recorder.leave(system, self.clock.now(), self.stepper.start());
                self.switch(system, locator, recorder)?;
            }
            return Ok(StopReason::Event);
        }
        recorder.leave(system, self.clock.now(), self.stepper.start());
        if !fired.is_empty() {
            return self.act(system, fired, locator, recorder);
        }
        // A stop time may coincide with the crossing.
        if !self.switch(system, locator, recorder)? {
            self.restart(system, recorder)?;
        }
        Ok(StopReason::Arrived)
    }

    /// Whether a step that a crossing made shorter is much worse than the longer one, which passed what lies there by.
    fn is_blind(&self, error: f64) -> bool {
        matches!(self.policy, StepPolicy::Adaptive { .. }) && error > BLIND
    }

    /// Whether a step to where something stops in space does not end there: where a sliding rate vanishes its direction is what the method's stages make of
    /// it, which only shorter steps tell.
    fn is_blurred(
        &self,
        system: &dyn System,
        (function, step, error): (usize, Step, f64),
        locator: &mut EventLocator,
    ) -> bool {
        if !(matches!(self.policy, StepPolicy::Adaptive { .. }) && locator.may_stop_in_space(system, function)) {
            return false;
        }
        if error == f64::INFINITY {
            return true;
        }
        let (start, end) = (self.stepper.start().y, self.stepper.end().y);
        let before = locator.value_at(system, function, (self.clock.now(), start));
        let after = locator.value_at(system, function, (step.next, end));
        !(error <= 1.0 && after.abs() <= STOPPED * before.abs())
    }

    /// Lets constraints that a phase may bring know how large they are on the way to it: a flight in one step begins and ends
    /// on the floor.
    fn observe(&mut self, system: &dyn System, step: Step) {
        let Some(mut projection) = self.projection.take() else { return };
        let segment = self.segment(step);
        let mut y = vec![0.0; segment.width];
        for theta in [0.0, 0.5] {
            segment.evaluate(theta, &mut y);
            projection.observe(system, segment.t + theta * segment.h, &y);
        }
        self.projection = Some(projection);
    }

    /// Takes only a part of the way to a crossing; false where that is nothing.
    fn part(
        &mut self,
        system: &dyn System,
        way: f64,
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let h = UNEVEN * way;
        let step = Step { h, next: self.clock.after(h), lands: false };
        if step.next <= self.clock.now() {
            return Ok(false);
        }
        self.try_step(system, step, true).map_err(|failure| failure.cause(system.description()))?;
        finite(system, self.stepper.end().y, 0)?;
        self.dense(system, step)?;
        let segment = self.segment(step);
        recorder.means(self.stepper.means());
        recorder.accept(system, Some(&segment), step.next, self.stepper.end())?;
        locator.record_before(system, &segment, recorder, &[])?;
        self.commit(step);
        Ok(true)
    }

    /// Switches what is on its surface at the present state, and lets inputs that turn or jump there act on the speeds; returns
    /// whether anything was.
    fn switch(
        &mut self,
        system: &mut dyn System,
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let (now, n) = (self.clock.now(), system.len());
        let y = self.stepper.start().y.to_vec();
        let kinematics = self.kinematics(system);
        let switched = locator.switch(system, (now, &y), &mut |system| self.trial(system))?;
        let Switched { any, resume, impulse } = switched;
        if !any {
            return Ok(false);
        }
        if resume > now {
            self.clock.set(resume);
        }
        self.apply_impulse(impulse, recorder);
        let late = resume - now;
        self.apply_velocity_jump(system, late, recorder)?;
        let (q, v) = self.stepper.state_mut().split_at_mut(n);
        q.iter_mut().zip(v.iter().zip(&y[n..])).for_each(|(q, (after, before))| *q += 0.5 * late * (before + after));
        if let Some(projection) = &mut self.projection {
            projection.observe(system, resume, self.stepper.start().y);
        }
        self.forces_jumped(system, &kinematics, locator, recorder)?;
        Ok(true)
    }

    /// Lets the speeds jump, and writes that down.
    pub(super) fn apply_impulse(&mut self, impulse: Option<Impulse>, recorder: &mut Recorder) {
        let Some(impulse) = impulse else { return };
        let n = impulse.jump.len();
        self.stepper.state_mut()[n..].iter_mut().zip(&impulse.jump).for_each(|(v, jump)| *v += jump);
        recorder.impulse(impulse);
    }

    /// Goes on after a jump of forces, and maybe of speeds, that leaves contacts as they are or not; these were their gaps and rates.
    fn forces_jumped(
        &mut self,
        system: &mut dyn System,
        kinematics: &[Kinematics],
        locator: &mut EventLocator,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        if self.settle_contacts(system, kinematics, recorder)? {
            let fired = self.already_past(system, (true, true), locator, recorder)?;
            if !fired.is_empty() {
                return self.act(system, fired, locator, recorder).map(|_| ());
            }
        }
        self.restart(system, recorder)
    }

    /// Steps again, as far as the zero of a watched function at about θ of the step that was tried, and tells the error;
    /// `None` if that is where the step began.
    ///
    /// The dense output finds the zero; the method's own step to it, corrected by Newton's method, is more
    /// accurate (catalogue E7).
    fn shorten(
        &mut self,
        system: &dyn System,
        step: Step,
        Crossing { function, theta, jumps, .. }: Crossing,
        locator: &mut EventLocator,
    ) -> Result<Option<(Step, f64)>, Box<Cause>> {
        let now = self.clock.now();
        let resolution = f64::EPSILON * now.abs().max(theta * step.h);
        let mut h = theta * step.h;
        let mut shorter = None;
        // By how much a step that ends before a jump is made longer.
        let mut reach = 1e-12 * step.h;
        let mut before = f64::INFINITY;
        for _ in 0..8 {
            if h <= resolution {
                return Ok(shorter);
            }
            let trial = Step { h, next: self.clock.after(h), lands: false };
            let tried = self.try_step(system, trial, true);
            if matches!(tried, Err(StepFailure::Stalled { .. })) && self.may_cut() {
                // Newton's method does not find the direction of a rate that vanishes, or only rounding.
                return Ok(Some((trial, f64::INFINITY)));
            }
            let error = tried.map_err(|failure| failure.cause(system.description()))?;
            finite(system, self.stepper.end().y, 0)?;
            self.dense(system, trial)?;
            shorter = Some((trial, error));
            if jumps {
                match locator.beyond(system, function, &self.segment(trial))? {
                    // The state there is one that a shorter step reaches, too.
                    Some(place) if place < 1.0 - 1e-9 => h *= place,
                    Some(_) => break,
                    None => {
                        h += reach;
                        reach *= 1e3;
                    }
                }
                continue;
            }
            let (segment, end) = (self.segment(trial), self.stepper.end());
            let (value, rate) = locator.value_and_rate(system, function, &segment, end.y);
            let correction = -value / rate;
            // Near the start of a loose step dense output may be off by a good part of the way.
            if !(correction.abs() > resolution && correction.abs() < 0.6 * h) {
                break;
            }
            // Small corrections that no longer fall are what rounding makes of the function.
            if correction.abs() > 0.1 * before && correction.abs() < ROUNDING * h {
                break;
            }
            before = correction.abs();
            h += correction;
        }
        Ok(shorter)
    }
}

/// A shorter step has a smaller error than a longer one, unless the longer one did not see what is there.
const BLIND: f64 = 4.0;
/// A step that ends where something stops leaves this part of its rate at the most.
const STOPPED: f64 = 1e-6;
/// This part of the way to where something stops in space is gone first, where all of it at once does not lead there.
const BEFORE_A_STOP: f64 = 0.9;
/// The step after one that fell short is this part of it at the longest.
const RETRIED: f64 = 0.5;
/// Corrections of the time of a crossing that are smaller than this part of a step may be rounding.
const ROUNDING: f64 = 1e-12;
