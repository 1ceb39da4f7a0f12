//! Putting steps together to a motion.
//!
//! What may end a step early: look in `interrupt.rs`; what is asked of a step between its ends: in `between.rs`; jumps of the acceleration that nobody declared: in `jump.rs`.

mod between;
mod interrupt;
mod jump;

use between::Defect;
use jump::{JumpDetector, Upset};

use crate::cause::Cause;
use crate::events::Watch;
use crate::integrate::{
    Clock, OneStep, Rates, Segment, StepControl, StiffnessDetector, Tolerance, first_step, stepper,
};
use crate::mechanism::{Method, Singular, System};
use crate::run::{Recorder, Work};
use crate::trust::Warning;

/// How steps are chosen.
#[derive(Clone, Debug)]
pub(crate) enum Pace {
    /// All alike, but for the last before a stop.
    Fixed(f64),
    /// Against a tolerance, none longer than `longest`.
    Adaptive {
        /// The tolerance.
        tolerance: Tolerance,
        /// s.
        longest: f64,
    },
}

/// Why a march paused without an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Halt {
    /// It is where it was to go.
    Arrived,
    /// An event ended it.
    Event,
}

/// A step to try, or one that was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Its length, s.
    pub h: f64,
    /// Where it ends, s.
    pub next: f64,
    /// True when it ends at a time that was asked for.
    pub lands: bool,
}

/// A motion that is under way.
pub(crate) struct March<S: System + ?Sized> {
    pub(super) rates: Rates,
    stepper: Box<dyn OneStep<S>>,
    pace: Pace,
    control: StepControl,
    pub(super) clock: Clock,
    /// The next step; 0 when it must be chosen anew.
    h: f64,
    pub(super) y: Vec<f64>,
    /// What rounding took from y in the last step.
    carry: Vec<f64>,
    rate: Vec<f64>,
    pub(super) end: Vec<f64>,
    pub(super) pieces: Vec<f64>,
    work: Work,
    max_steps: u64,
    compensated: bool,
    watch: Option<Watch>,
    defect: Defect,
    /// Until when the motion goes on at most, s.
    until: f64,
    stiffness: StiffnessDetector,
    jumps: JumpDetector,
}

impl<S: System + ?Sized> March<S> {
    /// A march from (t, q, v), not yet begun.
    pub fn new(method: Method, pace: Pace, rates: Rates, t: f64, y: Vec<f64>) -> Self {
        let stepper = stepper(method, rates.width);
        let zero = vec![0.0; rates.width];
        let pieces = vec![0.0; rates.width * stepper.pieces()];
        March {
            control: StepControl::new(stepper.tableau().control),
            stiffness: StiffnessDetector::new(stepper.tableau().control.stiff),
            jumps: JumpDetector::new(0.0),
            stepper,
            pace,
            clock: Clock::new(t),
            h: 0.0,
            carry: zero.clone(),
            rate: zero.clone(),
            end: zero,
            pieces,
            work: Work::default(),
            max_steps: u64::MAX,
            compensated: true,
            watch: None,
            defect: Defect::new(),
            until: t,
            rates,
            y,
        }
    }

    /// Fails beyond so many steps.
    pub fn limit(mut self, max_steps: u64) -> Self {
        self.max_steps = max_steps;
        self
    }

    /// Adds what rounding takes from a step to the next one, or not.
    pub fn compensate(mut self, compensated: bool) -> Self {
        self.compensated = compensated;
        self
    }

    /// The present time, s.
    pub fn time(&self) -> f64 {
        self.clock.now()
    }

    /// The present state with its work.
    pub fn state(&self) -> &[f64] {
        &self.y
    }

    /// The present state with its work, to be changed before the march begins anew.
    pub fn state_mut(&mut self) -> &mut [f64] {
        &mut self.y
    }

    /// Vectors of a step's dense output.
    pub fn pieces(&self) -> usize {
        self.stepper.pieces()
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        let samples = self.work.samples + self.watch.as_ref().map_or(0, Watch::samples);
        Work { evaluations: self.rates.evaluations, samples, ..self.work }
    }

    /// Begins at the present state a motion that goes on to `until` at most: watches it, chooses the modes.
    pub fn begin(&mut self, system: &mut S, until: f64) -> Result<(), Cause> {
        let now = self.clock.now();
        finite(system, &self.y, 0)?;
        self.jumps = JumpDetector::new(until - now);
        self.until = until;
        self.h = 0.0;
        self.work.samples += self.watch.as_ref().map_or(0, Watch::samples);
        self.watch = None;
        if let Some(mut watch) = Watch::new(system, (now, until), &self.y)? {
            let y = self.y.clone();
            let outcome = watch.begin(system, (now, &y), &mut |system| self.trial(system));
            self.watch = Some(watch);
            outcome?;
        }
        self.restart(system, false)
    }

    /// Goes on to `until`, or to an event that stops; tells `progress` the time after every step.
    pub fn advance(
        &mut self,
        system: &mut S,
        until: f64,
        recorder: &mut Recorder,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Halt, Cause> {
        while self.clock.now() < until {
            let stop = self.watch.as_ref().map_or(until, |watch| watch.next_stop(until));
            let mut watch = self.watch.take();
            let tried = self.sound(system, stop, &mut watch, recorder);
            let tried = tried.map_err(|cause| self.explained(system, cause, &mut watch));
            self.watch = watch;
            let (step, dense) = tried?;
            self.look_for_stiffness(step, recorder);
            let Some(mut watch) = self.watch.take() else {
                self.keep(system, step, dense, recorder)?;
                progress(self.clock.now());
                continue;
            };
            let outcome = self.watched(system, step, &mut watch, recorder);
            self.watch = Some(watch);
            progress(self.clock.now());
            if outcome? == Halt::Event {
                return Ok(Halt::Event);
            }
        }
        Ok(Halt::Arrived)
    }

    /// Writes down and takes a step that nothing can interrupt.
    fn keep(&mut self, system: &S, step: Step, dense: bool, recorder: &mut Recorder) -> Result<(), Cause> {
        if dense {
            recorder.accept(system, Some(&self.segment(step)), step.next, &self.end)?;
        } else {
            recorder.accept(system, None, step.next, &self.end)?;
        }
        self.commit(step);
        Ok(())
    }

    /// Begins anew after the state or the equations changed.
    ///
    /// At a time that was known beforehand the length of the last step says what it said before: it is kept.
    pub(super) fn restart(&mut self, system: &S, keeps_step: bool) -> Result<(), Cause> {
        self.carry.fill(0.0);
        if !keeps_step {
            self.h = 0.0;
        }
        self.control = StepControl::new(self.stepper.tableau().control);
        self.jumps.restart();
        self.rates
            .evaluate(system, self.clock.now(), &self.y, &mut self.rate)
            .map_err(|fault| fault.cause(system.description()))?;
        finite(system, &self.rate, 1)
    }

    /// Dense output of the step that was tried.
    pub(super) fn dense(&mut self, system: &S, step: Step) -> Result<(), Cause> {
        self.stepper
            .dense(&mut self.rates, system, (self.clock.now(), step.h, &self.y), &self.end, &mut self.pieces)
            .map_err(|fault| fault.cause(system.description()))
    }

    pub(super) fn segment(&self, step: Step) -> Segment<'_> {
        Segment { t: self.clock.now(), h: step.h, width: self.rates.width, pieces: &self.pieces }
    }

    /// Tries steps until one is good.
    ///
    /// None is longer than `most` seconds; one that would be is taken of just that length.
    fn attempt(
        &mut self,
        system: &S,
        stop: f64,
        most: f64,
        watch: &mut Option<Watch>,
    ) -> Result<Step, Cause> {
        if self.work.steps >= self.max_steps {
            return Err(Cause::TooManySteps { limit: self.max_steps });
        }
        let now = self.clock.now();
        if self.h == 0.0 {
            self.h = self.first(system, stop - now).map_err(|fault| fault.cause(system.description()))?;
        }
        loop {
            let mut step = self.plan(stop);
            if let Pace::Adaptive { .. } = self.pace {
                let met = watch.as_mut().map_or(step.h, |watch| watch.ahead(system, now, step.h));
                if met.min(most) < step.h {
                    let h = met.min(most);
                    if met < step.h {
                        self.jumps.restart();
                    }
                    step = Step { h, next: self.clock.after(h), lands: false };
                }
            }
            let Step { h, next, lands } = step;
            if next <= now {
                return Err(match self.pace {
                    Pace::Fixed(h) => Cause::StepBelowResolution { h },
                    Pace::Adaptive { .. } => Cause::StepTooSmall { h },
                });
            }
            let outcome = self.try_step(system, step, false);
            match &self.pace {
                Pace::Fixed(_) => {
                    let error = outcome.map_err(|fault| fault.cause(system.description()))?;
                    self.all_finite(system, error)?;
                    return Ok(step);
                }
                Pace::Adaptive { .. } => {
                    let error = *outcome.as_ref().unwrap_or(&f64::NAN);
                    if error <= 1.0 {
                        self.look_for_jumps(system, step)?;
                        let proposal = self.control.accepted(h, error);
                        // A step cut short by a stop says nothing against the longer one before it.
                        self.h = if lands { proposal.max(self.h) } else { proposal };
                        return Ok(step);
                    }
                    self.work.rejected += 1;
                    self.h = self.control.rejected(h, error);
                    if self.h < 16.0 * f64::EPSILON * now.abs() || self.h < f64::MIN_POSITIVE / f64::EPSILON {
                        outcome.map_err(|fault| fault.cause(system.description()))?;
                        self.all_finite(system, error)?;
                        return Err(Cause::StepTooSmall { h: self.h });
                    }
                }
            }
        }
    }

    /// Refuses a step whose end, or the rate there, is not finite.
    fn all_finite(&self, system: &S, error: f64) -> Result<(), Cause> {
        finite(system, &self.end, 0)?;
        if error.is_nan() { finite(system, self.stepper.last_rate(), 1) } else { Ok(()) }
    }

    /// The next step to try.
    fn plan(&self, stop: f64) -> Step {
        let now = self.clock.now();
        let left = stop - now;
        match &self.pace {
            Pace::Fixed(h) => {
                let next = self.clock.after_equal_step(*h);
                if next >= stop - 1e-9 * h {
                    Step { h: left, next: stop, lands: true }
                } else {
                    Step { h: *h, next, lands: false }
                }
            }
            Pace::Adaptive { longest, .. } => {
                let h = self.h.min(*longest);
                if left <= 1.01 * h {
                    Step { h: left, next: stop, lands: true }
                } else {
                    let h = if left < 2.0 * h { 0.5 * left } else { h };
                    Step { h, next: self.clock.after(h), lands: false }
                }
            }
        }
    }

    /// Tries a step; leaves its end behind, and its rate there if it is good (or `whatever` its error), which
    /// is returned.
    pub(super) fn try_step(&mut self, system: &S, step: Step, whatever: bool) -> Result<f64, Singular> {
        let from = (self.clock.now(), step.h, self.y.as_slice());
        let tolerance = match &self.pace {
            Pace::Fixed(_) => None,
            Pace::Adaptive { tolerance, .. } => Some(tolerance),
        };
        let error = self.stepper.attempt(&mut self.rates, system, from, &self.rate, tolerance)?;
        let increment = self.stepper.increment();
        for (i, end) in self.end.iter_mut().enumerate() {
            *end = self.y[i] + (increment[i] + self.carry[i]);
        }
        if error <= 1.0 || whatever {
            let rate = self.stepper.end_rate(&mut self.rates, system, step.next, &self.end)?;
            if !rate.iter().all(|rate| rate.is_finite()) {
                return Ok(f64::NAN);
            }
        }
        Ok(error)
    }

    /// Takes the step that was tried.
    pub(super) fn commit(&mut self, step: Step) {
        let increment = self.stepper.increment();
        for (i, carry) in self.carry.iter_mut().enumerate() {
            *carry = if self.compensated { (increment[i] + *carry) - (self.end[i] - self.y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        self.rate.copy_from_slice(self.stepper.last_rate());
        match self.pace {
            Pace::Fixed(h) if step.h == h => self.clock.equal_step(h),
            Pace::Adaptive { .. } if !step.lands => self.clock.step(step.h),
            _ => self.clock.set(step.next),
        }
        self.work.steps += 1;
    }

    /// Refuses a step across which the acceleration jumps, unless it is time that makes it jump.
    fn look_for_jumps(&mut self, system: &S, step: Step) -> Result<(), Cause> {
        let n = self.rates.n;
        let (before, after) = (&self.rate[n..2 * n], &self.stepper.last_rate()[n..2 * n]);
        match self.jumps.observe(step.h, before, after) {
            None => Ok(()),
            Some(Upset::Stall) => Err(Cause::StepTooSmall { h: step.h }),
            Some(Upset::Jump(coordinate)) => {
                let mut earlier = vec![0.0; self.rates.width];
                self.rates
                    .evaluate(system, self.clock.now(), &self.end, &mut earlier)
                    .map_err(|fault| fault.cause(system.description()))?;
                let by_state = (earlier[n + coordinate] - before[coordinate]).abs();
                if by_state > 0.5 * (after[coordinate] - before[coordinate]).abs() {
                    return Err(Cause::DirectionLost { coordinate: system.description().coordinate_name(coordinate) });
                }
                Ok(())
            }
        }
    }

    /// Warns once the step is limited by stability.
    fn look_for_stiffness(&mut self, step: Step, recorder: &mut Recorder) {
        if let Pace::Adaptive { .. } = self.pace {
            let step_times_rate = self.stepper.stiffness(step.h, &self.end);
            if self.stiffness.observe(step_times_rate) {
                recorder.warn(Warning::Stiff { t: step.next, step_times_rate });
            }
        }
    }

    /// The first step.
    fn first(&mut self, system: &S, left: f64) -> Result<f64, Singular> {
        match &self.pace {
            Pace::Fixed(h) => Ok(*h),
            Pace::Adaptive { tolerance, longest } => {
                let from = (self.clock.now(), self.y.as_slice(), self.rate.as_slice());
                let order = self.stepper.tableau().order;
                first_step(&mut self.rates, system, from, tolerance, order, longest.min(left))
            }
        }
    }
}

/// An error that names the first number that is not finite.
pub(super) fn finite<S: System + ?Sized>(system: &S, y: &[f64], primes: usize) -> Result<(), Cause> {
    match y.iter().position(|y| !y.is_finite()) {
        Some(index) => Err(non_finite(system, index, primes)),
        None => Ok(()),
    }
}

/// Names the number of [q; v; W] that is not finite, `primes` derivatives of it being meant.
fn non_finite<S: System + ?Sized>(system: &S, index: usize, primes: usize) -> Cause {
    let n = system.len().max(1);
    let name = || system.description().coordinate_name(index % n);
    let what = match index / n {
        order @ (0 | 1) => format!("`{}{}`", name(), "'".repeat(order + primes)),
        _ => "the work of the forces".to_owned(),
    };
    Cause::NonFinite { what }
}
