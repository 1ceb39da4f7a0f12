//! Trying steps until one is good, and taking it.

use super::noise::StagnatingError;
use super::{Integration, Step, StepPolicy};
use crate::cause::Cause;
use crate::events::EventLocator;
use crate::integrate::{StepFailure, Trial};
use crate::mechanism::System;
use crate::mechanism::sliding::return_to_surfaces;

/// So many steps in a row whose dense output stability makes poor are no chance.
const POOR: u32 = 3;

impl Integration {
    /// Tries steps until one is good.
    ///
    /// None is longer than `most` seconds; one that would be is taken of just that length.
    #[inline]
    pub(super) fn attempt(
        &mut self,
        system: &dyn System,
        stop: f64,
        most: f64,
        locator: &mut Option<Box<EventLocator>>,
    ) -> Result<Step, Box<Cause>> {
        if self.work.steps - self.free_steps >= self.max_steps {
            return Err(Cause::TooManySteps { limit: self.max_steps }.into());
        }
        let now = self.clock.now();
        if self.h == 0.0 {
            self.h = self.first(system, stop - now);
        }
        self.rejected.clear();
        let mut stagnating = StagnatingError::default();
        loop {
            let mut step = self.plan(stop);
            let met = locator.as_mut().map_or(step.h, |locator| locator.ahead(system, now, step.h));
            let (mut h, mut reports) = (most, false);
            if let StepPolicy::Adaptive { .. } = self.policy {
                if met < step.h {
                    self.jumps.restart();
                }
                h = met.min(most);
                // Where stability limits a step its dense output is poor: a state that is reported is the end of a step, or within a shorter one.
                let report = self.reports_at - now;
                let good = self.stiffness.between_ends(step.h, self.limiting_rate * step.h).max(report);
                let is_poor = good < step.h;
                self.poor_steps = if is_poor { self.poor_steps + 1 } else { 0 };
                // A few may pass where something grows.
                reports = self.poor_steps >= POOR && report > self.shortest() && good < h.min(step.h);
                if reports {
                    h = good;
                }
            } else if met < step.h.min(most) && self.passes_over(system) {
                continue;
            }
            if h < step.h {
                step = Step { h, next: self.clock.after(h), lands: false };
            }
            let Step { h, next, lands } = step;
            if next <= now {
                let cause = match self.policy {
                    StepPolicy::Fixed(h) => Cause::StepBelowResolution { h },
                    StepPolicy::Adaptive { .. } => Cause::StepTooSmall { h },
                };
                return Err(cause.into());
            }
            let outcome = self.try_step(system, step, false);
            match &self.policy {
                StepPolicy::Fixed(_) => {
                    let error = outcome.map_err(|failure| failure.cause(system.description()))?;
                    self.all_finite(system, error)?;
                    return Ok(step);
                }
                StepPolicy::Adaptive { .. } => {
                    let error = *outcome.as_ref().unwrap_or(&f64::NAN);
                    if error <= 1.0 {
                        // Dense output makes other stages in the place of these.
                        self.step_times_rate = self.stepper.stiffness(h, self.stiffness.least());
                        if !reports {
                            self.limiting_rate = self.step_times_rate / h;
                        }
                        self.look_for_jumps(system, step)?;
                        self.held_steps = if error >= self.control.growing() { self.held_steps + 1 } else { 0 };
                        if self.held_steps > 0 {
                            self.look_for_noise_that_holds(system, step);
                        }
                        let proposal = self.control.accepted(h, error).min(self.stepper.convergent());
                        // A step cut short by a stop says nothing against the longer one before it.
                        self.h = if lands || reports { proposal.max(self.h) } else { proposal };
                        if self.decorrelate_steps {
                            self.h = self.h.min(self.stiffness.between_ends(h, self.step_times_rate));
                        }
                        return Ok(step);
                    }
                    self.work.rejected += 1;
                    // Where nothing has moved yet the least error is infinitely many times too large.
                    let told = matches!(outcome, Ok(_) | Err(StepFailure::Stalled { .. }));
                    if told && self.stepper.errors().iter().all(|error| error.is_finite()) {
                        self.look_for_noise(system, step);
                        if outcome.is_ok() {
                            self.look_for_start_up_error(&mut stagnating, (error, h));
                        }
                    }
                    self.h = match outcome {
                        Err(StepFailure::Stalled { .. }) => self.control.stalled(h),
                        _ => self.control.rejected(h, error),
                    };
                    if self.h < self.shortest() {
                        outcome.map_err(|failure| failure.cause(system.description()))?;
                        self.all_finite(system, error)?;
                        return Err(Cause::StepTooSmall { h: self.h }.into());
                    }
                }
            }
        }
    }

    /// Refuses a step whose end, or the rate there, is not finite.
    fn all_finite(&self, system: &dyn System, error: f64) -> Result<(), Box<Cause>> {
        let end = self.stepper.end();
        finite(system, end.y, 0)?;
        if error.is_nan() { finite(system, end.rate, 1) } else { Ok(()) }
    }

    /// Tries a step, and returns its error (NaN where the rate at its end is not finite).  If it is good, or `whatever` its
    /// error, its end is brought to the constraints where the method does not end there, and has its rate.
    pub(super) fn try_step(&mut self, system: &dyn System, step: Step, whatever: bool) -> Result<f64, StepFailure> {
        let tolerance = match &self.policy {
            StepPolicy::Fixed(_) => None,
            StepPolicy::Adaptive { tolerance, .. } => Some(&**tolerance),
        };
        let trial = Trial { t: self.clock.now(), h: step.h, tolerance };
        let error = self.stepper.attempt(system, trial)?;
        if !(error <= 1.0 || whatever) {
            return Ok(error);
        }
        let moved = match &mut self.projection {
            Some(projection) if self.stepper.keeps_constraints() => {
                projection.look(system, step.next, self.stepper.end_mut())?
            }
            Some(projection) => projection.project(system, step.next, self.stepper.end_mut())?,
            None => false,
        };
        let moved = moved | self.return_to_surfaces(system, step.next);
        let finite = self.stepper.conclude(system, step.next, moved)?;
        Ok(if finite { error } else { f64::NAN })
    }

    /// Brings the end of a step to the surfaces in which the motion slides; true where it moved.
    fn return_to_surfaces(&mut self, system: &dyn System, t: f64) -> bool {
        !system.sliding().is_empty() && return_to_surfaces(system, t, self.stepper.end_mut())
    }

    /// Takes the step that was tried.
    pub(super) fn commit(&mut self, step: Step) {
        self.stepper.accept(self.compensated);
        if let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy {
            tolerance.observe(self.stepper.start().y);
        }
        match self.policy {
            StepPolicy::Fixed(h) if step.h == h => self.clock.equal_step(h),
            StepPolicy::Adaptive { .. } if !step.lands => self.clock.step(step.h),
            _ => self.clock.set(step.next),
        }
        self.work.steps += 1;
        self.last_step = step.h;
        self.since_stop = if step.lands { 0 } else { self.since_stop + 1 };
    }

    /// The shortest step that is one beside the present time, s.
    pub(super) fn shortest(&self) -> f64 {
        (16.0 * f64::EPSILON * self.clock.now().abs()).max(f64::MIN_POSITIVE / f64::EPSILON)
    }
}

/// An error that names the first number that is not finite.
pub(super) fn finite(system: &dyn System, y: &[f64], primes: usize) -> Result<(), Box<Cause>> {
    match y.iter().position(|y| !y.is_finite()) {
        Some(index) => Err(non_finite(system, index, primes).into()),
        None => Ok(()),
    }
}

/// Names the number of [q; q'] that is not finite, `primes` derivatives of it being meant.
fn non_finite(system: &dyn System, index: usize, primes: usize) -> Cause {
    let n = system.len().max(1);
    let name = system.description().coordinate_name(index % n);
    Cause::NonFinite { what: format!("`{name}{}`", "'".repeat(index / n + primes)) }
}
