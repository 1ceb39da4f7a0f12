//! What is asked of a step between its ends.

use super::{Integration, Step, StepPolicy};
use crate::cause::Cause;
use crate::events::draws::Draws;
use crate::events::{EventLocator, OwnedSegment};
use crate::integrate::Segment;
use crate::mechanism::System;
use crate::run::Recorder;
use crate::trust::positive_inertia;

/// Holds the dense output of steps against the equations at one point inside each.
///
/// It notices gross errors only: what is smooth passes by far, see [`Defect::MOST`].  The point is drawn, mostly from the largest
/// gap between the stages of DOP853.
#[derive(Clone, Debug)]
pub(super) struct Defect {
    draws: Draws,
    longest: f64,
    /// The length of a step whose defect no halves of it mended: it is rounding, up to that length.
    unmended: f64,
    y: Vec<f64>,
    slope: Vec<f64>,
    rate: Vec<f64>,
}

impl Defect {
    /// Steps whose defect over their length is more than this times the tolerance do not follow the equations.
    pub const MOST: f64 = 1e3;

    /// Steps for stiff motions aim at a defect that does 1 to the state, in units of the tolerance, and are tried again where it does so much: one is
    /// left a little beside its slow motion where it is brought back to constraints, and swings on the way there.
    pub const REPEATED: f64 = 10.0;

    /// At the start of an integration of states of this size.
    pub fn new(size: usize) -> Self {
        let zero = vec![0.0; size];
        let draws = Draws::new(0x0dec_af00);
        Defect { draws, longest: 0.0, unmended: 0.0, y: zero.clone(), slope: zero.clone(), rate: zero }
    }

    fn place(&mut self) -> f64 {
        if self.draws.between(0.0, 1.0) < 0.8 { self.middle() } else { self.draws.between(0.05, 0.95) }
    }

    /// A point where the dense output of no method for stiff motions is exact whatever it interpolates.
    fn middle(&mut self) -> f64 {
        self.draws.between(0.36, 0.58)
    }
}

/// A step is tried again for what was seen inside it at most so often.
const RETRIES: u32 = 16;
/// Steps are cut no shorter than so many roundings of the time.
const RESOLVED: f64 = 64.0;
/// Distances are zero within this part of the largest.
const NEAR: f64 = 1e-9;

impl Integration {
    /// Tries steps of `most` seconds at most until one is good between its ends too; returns it, and whether its dense output is made.
    ///
    /// In this order, since each reads what the one before has cleared: the error test; the defect of the dense output,
    /// which halves; features that arguments of local functions reveal, which cut.
    #[inline]
    pub(super) fn sound(
        &mut self,
        system: &dyn System,
        (stop, mut most): (f64, f64),
        locator: &mut Option<Box<EventLocator>>,
        recorder: &Recorder,
    ) -> Result<(Step, bool), Box<Cause>> {
        let (mut retries, mut defective) = (0, Vec::new());
        loop {
            let step = self.attempt(system, stop, most, locator)?;
            if retries == RETRIES {
                if defective.len() == RETRIES as usize {
                    self.defect.unmended = defective[0];
                }
                self.dense(system, step)?;
                return Ok((step, true));
            }
            if most.is_finite() {
                // Shorter steps that follow one cut before a feature say nothing about the acceleration.
                self.jumps.restart();
            }
            let has_no_feature = locator.as_mut().is_none_or(|locator| {
                locator.has_no_feature(
                    system,
                    (self.clock.now(), step.next),
                    (self.stepper.start(), self.stepper.end()),
                )
            });
            let watched = locator.as_ref().is_some_and(|locator| locator.wants_dense(system));
            if has_no_feature && !watched && !recorder.wants_dense(step.next) {
                return Ok((step, false));
            }
            self.dense(system, step)?;
            if let StepPolicy::Fixed(_) = self.policy {
                // Once is enough to be told.
                let looks = !has_no_feature && self.passed_over.is_none();
                if looks && self.cut(system, step, locator).is_some() && self.passes_over(system) {
                    self.work.retries += 1;
                    continue;
                }
                self.meets(system, step, locator)?;
                return Ok((step, true));
            }
            if let Some(shorter) = self.too_long_to_read(system, step) {
                defective.push(step.h);
                most = shorter;
            } else if has_no_feature {
                return Ok((step, true));
            } else if let Some(shorter) = self.cut(system, step, locator) {
                most = shorter;
                self.jumps.restart();
            } else {
                self.meets(system, step, locator)?;
                return Ok((step, true));
            }
            retries += 1;
            self.work.retries += 1;
        }
    }

    /// Lets the next fixed step be half as long, since this one would pass over a feature; false where it was given: that is told.
    pub(super) fn passes_over(&mut self, system: &dyn System) -> bool {
        let halved = self.halve_found_step(system);
        if !halved {
            self.passed_over.get_or_insert(self.clock.now());
        }
        halved
    }

    /// How long a step is to be instead, s, that jumps over a feature; what times cannot resolve cuts none.
    fn cut(&self, system: &dyn System, step: Step, locator: &mut Option<Box<EventLocator>>) -> Option<f64> {
        let theta = locator.as_mut()?.cut(system, &self.segment(step))?;
        let shorter = theta * step.h;
        (shorter > RESOLVED * f64::EPSILON * self.clock.now().abs()).then_some(shorter)
    }

    /// Refuses a step within which the ends of a force meet, as far as the tolerance tells.
    fn meets(
        &self,
        system: &dyn System,
        step: Step,
        locator: &mut Option<Box<EventLocator>>,
    ) -> Result<(), Box<Cause>> {
        let part = match &self.policy {
            StepPolicy::Fixed(_) => NEAR,
            StepPolicy::Adaptive { tolerance, .. } => tolerance.relative.clamp(NEAR, 1e-5),
        };
        locator.as_mut().map_or(Ok(()), |locator| locator.meets(system, &self.segment(step), part))
    }

    /// Why no further step can be taken, in the words of the file where it is ends that meet.
    ///
    /// Steps that vanish are explained by what stands just ahead.
    pub(super) fn explained(
        &mut self,
        system: &dyn System,
        cause: Cause,
        locator: &mut Option<Box<EventLocator>>,
    ) -> Cause {
        let ahead = (1e5 * self.h.abs()).max(1e-4 * self.defect.longest);
        let (now, n) = (self.clock.now(), system.len());
        let cause = match cause {
            Cause::StepTooSmall { .. } => {
                let mut y = self.stepper.start().y.to_vec();
                for i in 0..n {
                    y[i] += ahead * y[n + i];
                }
                let beyond = self.stepper.evaluate(system, now + ahead, &y, &mut vec![0.0; 2 * n]);
                let beyond = beyond.map_err(|failure| failure.cause(system.description()));
                beyond
                    .map_or_else(Some, |()| positive_inertia(system, now + ahead, &y).err().map(|known| *known))
                    .unwrap_or(cause)
            }
            cause => cause,
        };
        let Some(locator) = locator else { return cause };
        locator.explain(system, cause, (now, self.stepper.start().y), ahead)
    }

    /// How long a step is to be instead, s, the dense output of which does not follow the equations.
    fn too_long_to_read(&mut self, system: &dyn System, step: Step) -> Option<f64> {
        if self.stepper.damps() {
            return self.interpolates_worse(system, step);
        }
        // Where stability limits the step, dense output is poor and says nothing.
        if self.step_times_rate > self.stiffness.least() || step.h <= self.defect.unmended {
            return None;
        }
        // An evaluation more is dear to a method whose steps have few: its long steps only.
        let short = step.h < 0.5 * self.defect.longest;
        self.defect.longest = self.defect.longest.max(step.h);
        if short && self.stepper.dense_is_free() {
            return None;
        }
        let theta = self.defect.place();
        let defect = self.defect(system, step, theta);
        let mut size = self.in_units(step, &defect);
        if size > Defect::MOST {
            self.forgive_noise(system, step, &defect, Defect::MOST);
            size = self.in_units(step, &defect);
        }
        self.defect.slope = defect;
        // A state that has no accelerations is for the error test to judge, in a shorter step.
        (size.is_nan() || size > Defect::MOST).then_some(0.5 * step.h)
    }

    /// How long a step of an implicit method is to be instead, s, the dense output of which is off by more than the tolerance.
    ///
    /// Where equations are stiff its ends follow them however long it is, and tell nothing of what is between them: of what follows a function of
    /// time, or of a transient that the step passes over.  The next step is no longer than this one may be.
    fn interpolates_worse(&mut self, system: &dyn System, step: Step) -> Option<f64> {
        if step.h <= self.defect.unmended {
            return None;
        }
        let theta = self.defect.middle();
        let defect = self.defect(system, step, theta);
        let mut size = self.by_change(step, &defect);
        if size > Defect::REPEATED {
            self.forgive_noise(system, step, &defect, Defect::REPEATED);
            size = self.by_change(step, &defect);
        }
        self.defect.slope = defect;
        if size.is_nan() {
            return Some(0.5 * step.h);
        }
        let good = step.h * self.control.between_ends(size);
        self.h = self.h.min(good);
        (size > Defect::REPEATED).then_some(good)
    }

    /// h times the defect of the dense output of the step that was tried at θ, as what it does to a state; NaN where there is none.
    fn defect(&mut self, system: &dyn System, step: Step, theta: f64) -> Vec<f64> {
        let (mut y, mut slope, mut rate) = (
            std::mem::take(&mut self.defect.y),
            std::mem::take(&mut self.defect.slope),
            std::mem::take(&mut self.defect.rate),
        );
        self.segment(step).evaluate_with_slope(theta, &mut y, &mut slope);
        match self.stepper.evaluate(system, self.clock.now() + theta * step.h, &y, &mut rate) {
            Ok(()) => slope.iter_mut().zip(&rate).for_each(|(slope, rate)| *slope -= step.h * rate),
            Err(_) => slope.fill(f64::NAN),
        }
        if let Some(gamma) = self.stepper.damp(&mut slope) {
            slope.iter_mut().for_each(|slope| *slope *= gamma);
        }
        (self.defect.y, self.defect.rate) = (y, rate);
        slope
    }

    /// The largest of errors [q; q'] of the step that was tried, in units of the tolerance: stiff accelerations at its start tell nothing of them.
    fn by_change(&self, step: Step, errors: &[f64]) -> f64 {
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return 0.0 };
        let (start, end, n) = (self.stepper.start().y, self.stepper.end().y, errors.len() / 2);
        let sizes = (0..n).flat_map(|i| {
            let [place, speed] = tolerance.units_by_change(i, step.h, [i, n + i].map(|k| end[k] - start[k]));
            [errors[i] / place, errors[n + i] / speed]
        });
        sizes.map(f64::abs).fold(0.0, |most, size| if size > most || size.is_nan() { size } else { most })
    }

    /// Lets the tolerance know which of these errors [q; q'], more than `most` times its units, are rounding.
    fn forgive_noise(&mut self, system: &dyn System, step: Step, errors: &[f64], most: f64) {
        let mut noise = self.noise(system);
        let known = self.damp_noise(&mut noise, step.h);
        let n = noise.len();
        let start = self.stepper.start();
        let (from, ends) = (start.rate, (start.y, self.stepper.end().y));
        let StepPolicy::Adaptive { tolerance, .. } = &mut self.policy else { return };
        for (i, noise) in noise.into_iter().enumerate() {
            let [place, speed] = tolerance.units(i, step.h, ends, from);
            let own = [errors[i].abs(), errors[n + i].abs()];
            if own[0] > most * place || own[1] > most * speed {
                tolerance.noise(i, noise, (step.h, known), own);
            }
        }
    }

    /// The root mean square of errors [q; q'] over the step that was tried, in units of the tolerance.
    pub(super) fn in_units(&self, step: Step, errors: &[f64]) -> f64 {
        let StepPolicy::Adaptive { tolerance, .. } = &self.policy else { return 0.0 };
        let start = self.stepper.start();
        let (from, ends, n) = (start.rate, (start.y, self.stepper.end().y), errors.len() / 2);
        let sum: f64 = (0..n)
            .map(|i| {
                let [place, speed] = tolerance.units(i, step.h, ends, from);
                (errors[i] / place).powi(2) + (errors[n + i] / speed).powi(2)
            })
            .sum();
        if errors.is_empty() { 0.0 } else { (sum / errors.len() as f64).sqrt() }
    }

    /// Takes one error-controlled step under the modes in force only to see where it leads; the integration stays where it
    /// is, and has to begin anew.  `None` where there is none.
    pub(super) fn trial(&mut self, system: &dyn System) -> Option<OwnedSegment> {
        let (h, control) = (self.h, self.control.clone());
        let outcome = self.try_shorter(system);
        (self.h, self.control) = (h, control);
        outcome
    }

    fn try_shorter(&mut self, system: &dyn System) -> Option<OwnedSegment> {
        const ROUNDS: u32 = 200;
        let now = self.clock.now();
        self.stepper.begin(system, now).ok()?;
        if self.h == 0.0 {
            self.h = self.first(system, self.until - now);
        }
        for _ in 0..ROUNDS {
            let h = self.h.min(self.until - now);
            let step = Step { h, next: now + h, lands: false };
            if step.next <= now || step.next.is_nan() {
                return None;
            }
            let error = self.try_step(system, step, false).unwrap_or(f64::NAN);
            if error <= 1.0 {
                self.dense(system, step).ok()?;
                let Segment { t, h, width, pieces } = self.segment(step);
                return Some(OwnedSegment { t, h, width, pieces: pieces.to_vec() });
            }
            self.h = self.control.rejected(h, error);
        }
        None
    }
}
