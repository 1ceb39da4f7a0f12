//! How the way to a stop is divided into steps.

use super::{Integration, Step, StepPolicy};

impl Integration {
    /// The next step to try.
    pub(super) fn plan(&mut self, stop: f64) -> Step {
        let left = stop - self.clock.now();
        match &self.policy {
            StepPolicy::Fixed(h) => {
                let next = self.clock.after_equal_step(*h);
                if next >= stop - 1e-9 * h {
                    Step { h: left, next: stop, lands: true }
                } else {
                    Step { h: *h, next, lands: false }
                }
            }
            StepPolicy::Adaptive { longest, tolerance } => {
                let of_method = self.stepper.longest(tolerance.relative);
                let followed = self.followed.as_ref().map_or(f64::INFINITY, |steps| steps.longest(self.clock.now()));
                let longest = longest.min(of_method).min(followed);
                let h = self.h.min(longest);
                if of_method.is_finite() && !self.decorrelate_steps {
                    return self.equal_part(stop, h, longest);
                }
                if left <= 1.01 * h && !self.divides() {
                    return Step { h: left, next: stop, lands: true };
                }
                let part = if self.decorrelate_steps { UNEVEN } else { 0.5 };
                let h = if left < 2.0 * h { part * left } else { h };
                Step { h, next: self.clock.after(h), lands: false }
            }
        }
    }

    /// A step of h or less, where each length costs something: the least number of equal parts of the way between two stops that are no
    /// longer than `longest`, halved so and so often.
    fn equal_part(&mut self, stop: f64, h: f64, longest: f64) -> Step {
        let left = stop - self.clock.now();
        let divides = |part: f64| (left / part - (left / part).round()).abs() <= ROUNDING;
        let halved = |part: f64| {
            let times = (part / h - ROUNDING).log2().ceil().max(0.0);
            (0..HALVINGS).map(move |more| part * (-times - f64::from(more)).exp2())
        };
        // A step that was cut leaves a way that these parts do not divide.
        let known = halved(self.even).find(|part| self.since_stop > 0 && divides(*part));
        let part = known.unwrap_or_else(|| {
            self.even = left / (left / longest - ROUNDING).ceil().max(1.0);
            halved(self.even).next().unwrap_or(h)
        });
        if (left / part).round() <= 1.0 {
            return Step { h: left, next: stop, lands: true };
        }
        Step { h: part, next: self.clock.after(part), lands: false }
    }

    /// Whether the way to the next stop is still to be divided, however short it is.
    pub(super) fn divides(&self) -> bool {
        self.decorrelate_steps && self.since_stop < DIVISIONS
    }
}

/// The part of the way to a stop or a crossing that a decorrelated run takes first, and of what is left; never more than
/// the step that was allowed.  The longest of its steps is shorter than that of any two another run may take.
pub(super) const UNEVEN: f64 = 0.4;
const DIVISIONS: u32 = 2;
/// What the rounding of times makes of a number of steps.
const ROUNDING: f64 = 1e-6;
/// Parts are halved no more than so often for those that came before to go on.
const HALVINGS: u32 = 5;
