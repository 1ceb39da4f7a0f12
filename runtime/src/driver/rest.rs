//! Mechanisms that stand still.

use super::noise::by_terms;
use super::{Integration, StepPolicy};
use crate::integrate::{AtRest, PERTURBATION};
use crate::mechanism::dense::sizes_alike;
use crate::mechanism::{Action, At, System};
use crate::trust::all_rates;

/// Accelerations up to so many times their noise are none: a second run starts five times as far off as places are moved to see it.
const EXPLAINED: f64 = 16.0;
/// What grows by less than e to this power until the end, and what swings by fewer radians, is neutral.
const NEUTRAL: f64 = 1.0;

/// Forces of which rounding would move the equilibrium by more than this part of the places are not known to vanish in it.
const UNKNOWN: f64 = 1e-6;

impl Integration {
    /// Goes on with the method where the mechanism was held at rest: something was changed.
    pub(super) fn awake(&mut self) {
        if let Some(mut method) = self.asleep.take() {
            method.state_mut().copy_from_slice(self.stepper.start().y);
            self.stepper = method;
        }
    }

    /// Holds the mechanism where it is if it is at rest in an equilibrium that is not unstable, as far as rounding tells.
    pub(super) fn sleep(&mut self, system: &dyn System) {
        // Steps grow by themselves where there are no accelerations at all.
        let pushed = || self.stepper.start().rate[system.len()..].iter().any(|a| *a != 0.0);
        if matches!(self.policy, StepPolicy::Adaptive { .. }) && pushed() && self.is_at_rest(system) {
            self.hold();
        }
    }

    /// Holds the mechanism where it is.
    pub(super) fn hold(&mut self) {
        let rest = Box::new(AtRest::new(&*self.stepper));
        self.asleep = Some(std::mem::replace(&mut self.stepper, rest));
    }

    /// Whether the mechanism is where it will be until the end: at rest, whatever its events do.
    pub(super) fn stays(&self, system: &dyn System) -> bool {
        let acts = |action: &Action| {
            matches!(action, Action::Phase(_) | Action::Impact { .. } | Action::Set(_) | Action::Contact(_))
        };
        let events = &system.description().events;
        !events.iter().any(|event| event.actions.iter().any(acts)) && self.is_at_rest(system)
    }

    /// No speed, no force beyond rounding, nothing that time or a discontinuity changes, and no motion that grows.
    fn is_at_rest(&self, system: &dyn System) -> bool {
        let (start, n, now) = (self.stepper.start(), system.len(), self.clock.now());
        let (q, v) = start.y.split_at(n);
        let description = system.description();
        let changes = description.structure.time_dependent || !description.switches.is_empty();
        if changes || v.iter().any(|v| *v != 0.0) {
            return false;
        }
        let at = At::new(now, q, v);
        let a = &start.rate[n..2 * n];
        let terms = by_terms(system, at.accelerated(a), self.until);
        let Some(perturbation) = by_places(system, at, a) else { return false };
        let noise = |i: usize| terms.as_ref().map_or(0.0, |terms| terms[i]);
        if !(0..n).all(|i| a[i].abs() <= EXPLAINED * (noise(i) + perturbation[i])) {
            return false;
        }
        let Some(rates) = all_rates(system, now, q, v) else { return false };
        let span = self.until - now;
        if rates.iter().any(|rate| rate.re * span > NEUTRAL) {
            return false;
        }
        // What brings it back least strongly, 1/s².
        let swings = rates.iter().map(|rate| rate.norm()).filter(|rate| rate * span > NEUTRAL);
        let stiffness = swings.fold(f64::INFINITY, f64::min).powi(2);
        let sizes = sizes_alike(description, q);
        if (0..n).any(|i| sizes[i] > 0.0 && noise(i) > UNKNOWN * stiffness * sizes[i]) {
            return false;
        }
        // Constraints hold what has no eigenvalue of its own.  Where nothing brings it back a force as small as one rounding of its terms may be meant.
        let neutral = rates.iter().filter(|rate| rate.norm() * span <= NEUTRAL).count();
        neutral <= 2 * system.active_rows().len() || (0..n).all(|i| a[i].abs() <= noise(i))
    }
}

/// By how much accelerations change when all places move by a few roundings; `None` where there are none.
fn by_places(system: &dyn System, at: At<'_>, a: &[f64]) -> Option<Vec<f64>> {
    let n = a.len();
    let (mut moved, mut q, mut noise) = (vec![0.0; n], at.q.to_vec(), vec![0.0_f64; n]);
    for other in [1.0, -1.0] {
        for (i, (q, place)) in q.iter_mut().zip(at.q).enumerate() {
            *q = place * (1.0 + if i % 2 == 0 { PERTURBATION } else { other * PERTURBATION });
        }
        system.accelerations(At { q: &q, ..at }, &mut moved).ok()?;
        (0..n).for_each(|i| noise[i] = noise[i].max((moved[i] - a[i]).abs()));
    }
    noise.iter().all(|noise| noise.is_finite()).then_some(noise)
}
