//! The first step.

use super::{Integration, StepPolicy};
use crate::integrate::{first_step, radians};
use crate::mechanism::System;

impl Integration {
    /// The first step: a thousandth of the way or so, which the error test shortens.
    ///
    /// Where each length of a step costs something it is the longest one.  Where the method lets it, it is longer if the accelerations
    /// at its end, reached by a parabola, differ so little from those at its start that it is short beside what the method resolves of a
    /// vibration; by no more than a step may grow at first, since other times are not looked at.
    ///
    /// It follows the tolerance as other steps do, so that runs at two tolerances have no step in common, even where the
    /// growth of steps is all that limits them.
    pub(super) fn first(&mut self, system: &dyn System, left: f64) -> f64 {
        let (longest, relative) = match &self.policy {
            StepPolicy::Fixed(h) => return *h,
            StepPolicy::Adaptive { longest, tolerance } => (*longest, tolerance.relative),
        };
        let of_method = self.stepper.longest(relative);
        if of_method.is_finite() {
            return longest.min(of_method);
        }
        let control = self.stepper.control();
        let h = longest.min(first_step(&control, relative, left));
        if control.at_first <= 1.0 {
            return h;
        }
        let slow = self.rate_of_change(system, h).map_or(0.0, |rate| radians(&control, relative) / rate);
        if slow > h { longest.min(slow.min(control.at_first * control.grow * h)) } else { h }
    }

    /// ω with which accelerations change over a parabola of h seconds, 1/s; `None` where there are none at its end.
    fn rate_of_change(&mut self, system: &dyn System, h: f64) -> Option<f64> {
        let (start, n) = (self.stepper.start(), system.len());
        let (mut y, before) = (start.y.to_vec(), start.rate.to_vec());
        let way: Vec<f64> = (0..n).map(|i| h * (before[i] + 0.5 * h * before[n + i])).collect();
        for i in 0..n {
            y[i] += way[i];
            y[n + i] += h * before[n + i];
        }
        let mut after = vec![0.0; 2 * n];
        self.stepper.evaluate(system, self.clock.now() + h, &y, &mut after).ok()?;
        let changes: Vec<f64> = (0..n).map(|i| after[n + i] - before[n + i]).collect();
        match &self.policy {
            StepPolicy::Adaptive { tolerance, .. } => Some(tolerance.rate_of_change(&way, &changes)),
            StepPolicy::Fixed(_) => None,
        }
    }
}
