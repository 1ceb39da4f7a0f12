//! What is asked of a step between its ends.

use super::{March, Pace, Step};
use crate::cause::Cause;
use crate::events::{OwnedSegment, Watch};
use crate::events::draws::Draws;
use crate::mechanism::System;
use crate::run::Recorder;

/// Holds the dense output of steps against the equations at one point inside each.
///
/// A lie detector only: what is smooth passes by far, see [`Defect::MOST`].  The point is drawn, mostly from the largest
/// gap between the stages of DOP853.
#[derive(Clone, Debug)]
pub(super) struct Defect {
    draws: Draws,
    longest: f64,
    y: Vec<f64>,
    slope: Vec<f64>,
    rate: Vec<f64>,
}

impl Defect {
    /// Steps whose defect over their length is more than this times the tolerance are lies.
    pub const MOST: f64 = 1e3;

    /// At the start of a march.
    pub fn new() -> Self {
        Defect { draws: Draws::new(0x0dec_af00), longest: 0.0, y: Vec::new(), slope: Vec::new(), rate: Vec::new() }
    }

    fn place(&mut self) -> f64 {
        let within = if self.draws.between(0.0, 1.0) < 0.8 { (0.36, 0.58) } else { (0.05, 0.95) };
        self.draws.between(within.0, within.1)
    }
}

/// A step is tried again for what was seen inside it at most so often.
const RETRIES: u32 = 16;
/// Distances are zero within this part of the largest.
const NEAR: f64 = 1e-9;
/// A method with fewer evaluations per step than this is checked on its long steps only.
const CHEAP: usize = 10;

impl<S: System + ?Sized> March<S> {
    /// Tries steps until one is good between its ends too; returns it, and whether its dense output is made.
    ///
    /// In this order, since each reads what the one before has cleared: the error test; the defect of the dense output,
    /// which halves; features that arguments of local functions reveal, which cut.
    pub(super) fn sound(
        &mut self,
        system: &S,
        stop: f64,
        watch: &mut Option<Watch>,
        recorder: &Recorder,
    ) -> Result<(Step, bool), Cause> {
        let mut most = f64::INFINITY;
        for _ in 0..RETRIES {
            let step = self.attempt(system, stop, most, watch)?;
            let watched = watch.as_ref().is_some_and(Watch::wants_dense);
            if !watched && !recorder.wants_dense(step.next) {
                return Ok((step, false));
            }
            self.dense(system, step)?;
            if let Pace::Fixed(_) = self.pace {
                self.meets(system, step, watch)?;
                return Ok((step, true));
            }
            if self.lies(system, step)? {
                most = 0.5 * step.h;
            } else if let Some(theta) = watch.as_mut().and_then(|watch| watch.cut(system, &self.segment(step))) {
                most = theta * step.h;
                // That steps become short says nothing about the acceleration here.
                self.jumps.restart();
            } else {
                self.meets(system, step, watch)?;
                return Ok((step, true));
            }
            self.work.retries += 1;
        }
        let step = self.attempt(system, stop, most, watch)?;
        self.dense(system, step)?;
        Ok((step, true))
    }

    /// Refuses a step within which the ends of a force meet, as far as the tolerance tells.
    fn meets(&self, system: &S, step: Step, watch: &mut Option<Watch>) -> Result<(), Cause> {
        let part = match &self.pace {
            Pace::Fixed(_) => NEAR,
            Pace::Adaptive { tolerance, .. } => tolerance.relative.clamp(NEAR, 1e-5),
        };
        watch.as_mut().map_or(Ok(()), |watch| watch.meets(system, &self.segment(step), part))
    }

    /// Why no further step can be taken, in the words of the file where it is ends that meet.
    pub(super) fn explained(&self, system: &S, cause: Cause, watch: &mut Option<Watch>) -> Cause {
        let Some(watch) = watch else { return cause };
        let ahead = (1e3 * self.h.abs()).max(1e-6 * self.defect.longest);
        watch.explain(system, cause, (self.clock.now(), &self.y), ahead)
    }

    /// True where the dense output of the step that was tried is far from fulfilling the equations.
    fn lies(&mut self, system: &S, step: Step) -> Result<bool, Cause> {
        let Pace::Adaptive { tolerance, .. } = &self.pace else { return Ok(false) };
        // Where stability limits the step, dense output is poor and says nothing.
        if self.stepper.stiffness(step.h, &self.end) > 0.5 * self.stepper.tableau().control.stiff {
            return Ok(false);
        }
        let short = step.h < 0.5 * self.defect.longest;
        self.defect.longest = self.defect.longest.max(step.h);
        if short && self.stepper.tableau().rows.len() < CHEAP {
            return Ok(false);
        }
        let theta = self.defect.place();
        let (mut y, mut slope, mut rate) = (
            std::mem::take(&mut self.defect.y),
            std::mem::take(&mut self.defect.slope),
            std::mem::take(&mut self.defect.rate),
        );
        for list in [&mut y, &mut slope, &mut rate] {
            list.resize(self.rates.width, 0.0);
        }
        let now = self.clock.now();
        self.segment(step).evaluate_with_slope(theta, &mut y, &mut slope);
        let evaluated = self.rates.evaluate(system, now + theta * step.h, &y, &mut rate);
        for (slope, rate) in slope.iter_mut().zip(&rate) {
            *slope = slope.mul_add(1.0 / step.h, -rate);
        }
        let size = step.h * tolerance.mean_square(&slope, &self.y, self.stepper.increment()).sqrt();
        (self.defect.y, self.defect.slope, self.defect.rate) = (y, slope, rate);
        // A state that has no accelerations is for the error test to judge, in a shorter step.
        Ok(evaluated.is_err() || !(size <= Defect::MOST))
    }

    /// Takes one error-controlled step under the modes in force only to see where it leads; the march stays where it
    /// is.  `None` where there is none.
    pub(super) fn trial(&mut self, system: &S) -> Option<OwnedSegment> {
        let (h, control, rate) = (self.h, self.control.clone(), self.rate.clone());
        let outcome = self.try_shorter(system);
        self.h = h;
        self.control = control;
        self.rate.copy_from_slice(&rate);
        outcome
    }

    fn try_shorter(&mut self, system: &S) -> Option<OwnedSegment> {
        const ROUNDS: u32 = 200;
        let now = self.clock.now();
        self.rates.evaluate(system, now, &self.y, &mut self.rate).ok()?;
        if self.h == 0.0 {
            self.h = self.first(system, self.until - now).ok()?;
        }
        for _ in 0..ROUNDS {
            let h = self.h.min(self.until - now);
            let step = Step { h, next: now + h, lands: false };
            if !(step.next > now) {
                return None;
            }
            let error = self.try_step(system, step, false).unwrap_or(f64::NAN);
            if error <= 1.0 {
                self.dense(system, step).ok()?;
                let pieces = self.pieces.clone();
                return Some(OwnedSegment { t: now, h, width: self.rates.width, pieces });
            }
            self.h = self.control.rejected(h, error);
        }
        None
    }
}
