//! Putting steps together to a motion.

use super::{Clock, Method, OneStep, Rates, StepControl, Tolerance, first_step};
use crate::error::Cause;
use crate::mechanism::{SingularMass, System};
use crate::run::{Recorder, Segment, Work};

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
}

/// A motion that is under way.
pub(crate) struct March<S: System + ?Sized> {
    rates: Rates,
    stepper: Box<dyn OneStep<S>>,
    pace: Pace,
    control: StepControl,
    clock: Clock,
    /// The next step; 0 when it must be chosen anew.
    h: f64,
    y: Vec<f64>,
    /// What rounding took from y in the last step.
    carry: Vec<f64>,
    rate: Vec<f64>,
    end: Vec<f64>,
    pieces: Vec<f64>,
    work: Work,
    max_steps: u64,
}

impl<S: System + ?Sized> March<S> {
    /// A march from (t, q, v), not yet begun.
    pub fn new(method: Method, pace: Pace, rates: Rates, t: f64, y: Vec<f64>, max_steps: u64) -> Self {
        let stepper = method.stepper(rates.width);
        let zero = vec![0.0; rates.width];
        let pieces = vec![0.0; rates.width * stepper.pieces()];
        March {
            control: StepControl::new(stepper.tableau().control),
            stepper,
            pace,
            clock: Clock::new(t),
            h: 0.0,
            carry: zero.clone(),
            rate: zero.clone(),
            end: zero,
            pieces,
            work: Work::default(),
            max_steps,
            rates,
            y,
        }
    }

    /// The present time, s.
    pub fn time(&self) -> f64 {
        self.clock.now()
    }

    /// The present state with its work.
    pub fn state(&self) -> &[f64] {
        &self.y
    }

    /// Vectors of a step's dense output.
    pub fn pieces(&self) -> usize {
        self.stepper.pieces()
    }

    /// Work done so far.
    pub fn work(&self) -> Work {
        Work { evaluations: self.rates.evaluations, ..self.work }
    }

    /// Begins, or begins anew after the state or the equations changed.
    pub fn restart(&mut self, system: &S) -> Result<(), Cause> {
        self.carry.fill(0.0);
        self.h = 0.0;
        self.control = StepControl::new(self.stepper.tableau().control);
        self.rates
            .evaluate(system, self.clock.now(), &self.y, &mut self.rate)
            .map_err(|fault| singular(system, fault))?;
        finite(system, &self.rate, "rate")
    }

    /// Goes on to `until`.
    pub fn advance(&mut self, system: &mut S, until: f64, recorder: &mut Recorder) -> Result<Halt, Cause> {
        while self.clock.now() < until {
            let (next, lands) = self.attempt(system, until)?;
            let from = self.clock.now();
            if recorder.wants_dense(next) {
                let h = next - from;
                self.stepper
                    .dense(&mut self.rates, system, (from, h, &self.y), &self.end, &mut self.pieces)
                    .map_err(|fault| singular(system, fault))?;
                let segment = Segment { t: from, h, width: self.rates.width, pieces: &self.pieces };
                recorder.accept(system, Some(&segment), next, &self.end);
            } else {
                recorder.accept(system, None, next, &self.end);
            }
            self.commit(next, lands);
        }
        Ok(Halt::Arrived)
    }

    /// Tries steps until one is good; returns where it ends and whether that is `stop`.
    fn attempt(&mut self, system: &S, stop: f64) -> Result<(f64, bool), Cause> {
        if self.work.steps >= self.max_steps {
            return Err(Cause::TooManySteps { limit: self.max_steps });
        }
        let now = self.clock.now();
        if self.h == 0.0 {
            self.h = self.first(system, stop - now).map_err(|fault| singular(system, fault))?;
        }
        loop {
            let (h, next, lands) = self.plan(stop);
            if next <= now {
                return Err(match self.pace {
                    Pace::Fixed(h) => Cause::StepBelowResolution { h },
                    Pace::Adaptive { .. } => Cause::StepTooSmall { h },
                });
            }
            let outcome = self.try_step(system, now, h, next);
            match &self.pace {
                Pace::Fixed(_) => {
                    outcome.map_err(|fault| singular(system, fault))?;
                    finite(system, &self.end, "state")?;
                    return Ok((next, lands));
                }
                Pace::Adaptive { .. } => {
                    let error = *outcome.as_ref().unwrap_or(&f64::NAN);
                    if error <= 1.0 {
                        let proposal = self.control.accepted(h, error);
                        // A step cut short by a stop says nothing against the longer one before it.
                        self.h = if lands { proposal.max(self.h) } else { proposal };
                        return Ok((next, lands));
                    }
                    self.work.rejected += 1;
                    self.h = self.control.rejected(h, error);
                    if self.h < 16.0 * f64::EPSILON * now.abs() || self.h < f64::MIN_POSITIVE / f64::EPSILON {
                        outcome.map_err(|fault| singular(system, fault))?;
                        finite(system, &self.end, "state")?;
                        return Err(Cause::StepTooSmall { h: self.h });
                    }
                }
            }
        }
    }

    /// A step's length and end, and whether the end is the stop.
    fn plan(&self, stop: f64) -> (f64, f64, bool) {
        let now = self.clock.now();
        let left = stop - now;
        match &self.pace {
            Pace::Fixed(h) => {
                let next = self.clock.after_equal_step(*h);
                if next >= stop - 1e-9 * h { (left, stop, true) } else { (*h, next, false) }
            }
            Pace::Adaptive { longest, .. } => {
                let h = self.h.min(*longest);
                if left <= 1.01 * h {
                    (left, stop, true)
                } else if left < 2.0 * h {
                    (0.5 * left, self.clock.after(0.5 * left), false)
                } else {
                    (h, self.clock.after(h), false)
                }
            }
        }
    }

    /// One step of h; leaves the end and its rate behind and returns the error.
    fn try_step(&mut self, system: &S, now: f64, h: f64, next: f64) -> Result<f64, SingularMass> {
        let tolerance = match &self.pace {
            Pace::Fixed(_) => None,
            Pace::Adaptive { tolerance, .. } => Some(tolerance),
        };
        let error = self.stepper.attempt(&mut self.rates, system, (now, h, &self.y), &self.rate, tolerance)?;
        let increment = self.stepper.increment();
        for (i, end) in self.end.iter_mut().enumerate() {
            *end = self.y[i] + (increment[i] + self.carry[i]);
        }
        if error <= 1.0 {
            let rate = self.stepper.end_rate(&mut self.rates, system, next, &self.end)?;
            if !rate.iter().all(|rate| rate.is_finite()) {
                return Ok(f64::NAN);
            }
        }
        Ok(error)
    }

    /// Takes the step that was tried.
    fn commit(&mut self, next: f64, lands: bool) {
        let increment = self.stepper.increment();
        for (i, carry) in self.carry.iter_mut().enumerate() {
            *carry = (increment[i] + *carry) - (self.end[i] - self.y[i]);
        }
        std::mem::swap(&mut self.y, &mut self.end);
        self.rate.copy_from_slice(self.stepper.last_rate());
        match self.pace {
            _ if lands => self.clock.set(next),
            Pace::Fixed(h) => self.clock.equal_step(h),
            Pace::Adaptive { .. } => self.clock.step(next - self.clock.now()),
        }
        self.work.steps += 1;
    }

    /// The first step.
    fn first(&mut self, system: &S, left: f64) -> Result<f64, SingularMass> {
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

/// Names the coordinate.
pub(crate) fn singular<S: System + ?Sized>(system: &S, fault: SingularMass) -> Cause {
    Cause::SingularMass { coordinate: coordinate_name(system, fault.coordinate) }
}

/// The name of a coordinate.
pub(crate) fn coordinate_name<S: System + ?Sized>(system: &S, index: usize) -> String {
    system.description().coordinates.get(index).map_or_else(|| format!("coordinate {index}"), |c| c.name.to_string())
}

/// An error that names the first number of [q; v; W] that is not finite.
fn finite<S: System + ?Sized>(system: &S, y: &[f64], kind: &str) -> Result<(), Cause> {
    let Some(index) = y.iter().position(|y| !y.is_finite()) else { return Ok(()) };
    let n = system.len();
    let what = match (index / n.max(1), kind) {
        (0, "state") => format!("`{}`", coordinate_name(system, index)),
        (0, _) => format!("`{}'`", coordinate_name(system, index)),
        (1, "state") => format!("`{}'`", coordinate_name(system, index - n)),
        (1, _) => format!("`{}''`", coordinate_name(system, index - n)),
        _ => "the work of the forces".to_owned(),
    };
    Err(Cause::NonFinite { what })
}
