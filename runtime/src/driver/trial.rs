//! A fixed step that suits a tolerance, found by trial steps over the start.

use super::between::Defect;
use super::noise::{StagnatingError, by_terms, note_start_up_errors};
use super::{Integration, StepPolicy};
use crate::constrain::Projection;
use crate::integrate::{OneStep, StepControl, StepFailure, Tolerance, Trial, longest_step, order, stepper};
use crate::mechanism::{At, Method, System};

/// The start is as much of the motion as the method of order 8 does in so many steps at this tolerance.
const SCOUTED: usize = 200;
const SCOUT: f64 = 1e-6;
/// Steps are tried from so many states of it.
const SAMPLES: usize = 24;
/// The step is changed at most so often, until its error is that part of what it may be, or more.
const ROUNDS: usize = 20;
const ENOUGH: f64 = 0.5;
/// The error of one step is rounding where half the step, or less, leaves so much of it; if it is below this part of the ranges,
/// so that the motion is resolved.
const REMAINS: f64 = 0.5;
const RESOLVED: f64 = 1e-3;
/// A step is halved to no fewer roundings of the time.
const RESOLVED_TIME: f64 = 64.0;

/// How a fixed step was found.
pub(super) struct FoundStep {
    method: Method,
    tolerance: Tolerance,
    /// Whether one step was good for all of the way: the motion had told nothing of what is to come.
    whole: bool,
}

impl Integration {
    /// Takes the longest step whose errors over the start of the motion come to no more than the tolerance, and returns it.
    ///
    /// The error of a step h is what it differs by from two of h/2, in units of the tolerance; its root mean square over
    /// states of the start, times the number of steps that the start takes, is to be 1.  So errors are proportional to the
    /// tolerance.  What happens only later (an encounter, a stiffer spring) the step does not know; where the start tells nothing, since one step is
    /// good for all of the way, it is found anew where the equations change.  Where rounding does not let errors be so small, the step is the one
    /// below which they do not fall.
    pub fn find_step(&mut self, system: &dyn System, method: Method, tolerance: &Tolerance, longest: f64) -> f64 {
        let (from, left) = (self.clock.now(), longest.min(self.until - self.clock.now()));
        self.any_step = method == Method::Exact;
        if system.description().structure.uniformly_accelerated {
            // Each method follows a parabola, whatever the step.
            self.any_step = true;
            return self.keep_step(left);
        }
        if method == Method::Exact && self.stays(system) {
            self.hold();
            return self.keep_step(left);
        }
        if method == Method::Exact {
            let resolved = longest_step(system, from, self.stepper.start().y, tolerance.relative);
            // Equal parts of the way, since each length has its matrices.
            return self.keep_step(resolved.map_or(left, |resolved| left / (left / resolved).ceil().max(1.0)));
        }
        let given = tolerance;
        let mut tolerance = tolerance.clone();
        let states = scout(system, self.projects, (from, self.until), self.stepper.start().y, &mut tolerance);
        let seen = states.last().map_or(left, |(t, _)| t - from);
        let every = states.len().div_ceil(SAMPLES).max(1);
        let samples: Vec<&(f64, Vec<f64>)> = states.iter().step_by(every).collect();
        let mut trial = TrialSteps::new(method, system.len());
        let power = 1.0 / f64::from(order(method));
        let mut h = (seen / states.len().max(1) as f64).min(left);
        let (mut good, mut bad) = (0.0_f64, f64::INFINITY);
        let mut before = (0.0, 0.0);
        for _ in 0..ROUNDS {
            let squares: f64 = samples.iter().map(|(t, y)| trial.error(system, *t, y, h, &tolerance).powi(2)).sum();
            let of_step = (squares / samples.len().max(1) as f64).sqrt();
            let error = of_step * (seen / h).max(1.0);
            let remains = h <= 0.5 * before.0 && of_step >= REMAINS * before.1;
            if error > 1.0 && remains && of_step * tolerance.relative < RESOLVED {
                good = before.0;
                break;
            }
            before = (h, of_step);
            if error <= 1.0 {
                good = good.max(h);
                if error >= ENOUGH || h >= left {
                    break;
                }
            } else {
                bad = bad.min(h);
            }
            let wanted = h * (0.8 / error).powf(power).clamp(0.1, 4.0);
            // Between what was too long and what was not.
            let next = if error.is_finite() { wanted } else { 0.3 * h };
            h = if next > good && next < bad { next } else { (good * bad).sqrt() };
            h = h.min(left);
            if bad < 1.05 * good {
                break;
            }
        }
        let h = if good > 0.0 { good } else { h };
        self.found = Some(FoundStep { method, tolerance: given.clone(), whole: h >= left });
        self.keep_step(h)
    }

    /// Finds the step anew where the motion had told nothing of what is to come; none is longer than before.
    pub(super) fn find_step_again(&mut self, system: &dyn System) {
        let StepPolicy::Fixed(longest) = self.policy else { return };
        if self.clock.now() >= self.until {
            return;
        }
        if let Some(FoundStep { method, tolerance, .. }) = self.found.take_if(|found| found.whole) {
            self.find_step(system, method, &tolerance, longest);
        }
    }

    /// Halves the step that was found, within which something is passed over, until the error of one from the present state is no more than
    /// [`Defect::MOST`]; false where it was given, or times tell no shorter one apart.
    pub(super) fn halve_found_step(&mut self, system: &dyn System) -> bool {
        let (StepPolicy::Fixed(whole), Some(found)) = (&self.policy, &self.found) else { return false };
        let (now, y) = (self.clock.now(), self.stepper.start().y);
        let mut trial = TrialSteps::new(found.method, system.len());
        let resolved = |h: &f64| *h > RESOLVED_TIME * f64::EPSILON * now.abs() && *h > f64::MIN_POSITIVE / f64::EPSILON;
        let halves = std::iter::successors(Some(0.5 * whole), |h| Some(0.5 * h)).take_while(resolved);
        let mut suits = |h: &f64| trial.error(system, now, y, *h, &found.tolerance) <= Defect::MOST;
        let Some(h) = halves.into_iter().find(|h| suits(h)) else { return false };
        self.clock.set(now);
        self.keep_step(h);
        true
    }

    /// The step that was found and is taken, s.
    pub fn found_step(&self) -> Option<f64> {
        match (&self.policy, &self.found) {
            (StepPolicy::Fixed(h), Some(_)) => Some(*h),
            _ => None,
        }
    }

    fn keep_step(&mut self, h: f64) -> f64 {
        self.policy = StepPolicy::Fixed(h);
        self.h = 0.0;
        h
    }
}

/// States along the start of a motion, brought to the constraints if it `projects`, and the ranges that the tolerance is to know.
fn scout(
    system: &dyn System,
    projects: bool,
    (from, until): (f64, f64),
    y: &[f64],
    tolerance: &mut Tolerance,
) -> Vec<(f64, Vec<f64>)> {
    let mut stepper = stepper(Method::Dop853, system.len(), false);
    stepper.state_mut().copy_from_slice(y);
    let mut control = StepControl::new(stepper.control());
    let mut states = vec![(from, y.to_vec())];
    let mut known = tolerance.clone();
    known.relative = SCOUT;
    let (mut t, mut h) = (from, 1e-3 * (until - from));
    if stepper.begin(system, t).is_err() {
        return states;
    }
    let mut stagnating = StagnatingError::default();
    // Trial steps are to begin on the constraints.
    let mut projection = Projection::new(system).map(|projection| projection.only_looking(!projects));
    for _ in 0..2 * SCOUTED {
        h = h.min(until - t);
        if t + h <= t || states.len() > SCOUTED {
            break;
        }
        let error = stepper.attempt(system, Trial { t, h, tolerance: Some(&known) }).unwrap_or(f64::NAN);
        let concluded = error <= 1.0 && {
            let moved = projection.as_mut().map_or(Ok(false), |p| p.project(system, t + h, stepper.end_mut()));
            moved.is_ok_and(|moved| stepper.conclude(system, t + h, moved) == Ok(true))
        };
        if !concluded {
            note_start_up_errors(&mut stagnating, &mut known, stepper.as_ref(), (error, h));
            note_rounding(system, (t, until), stepper.as_ref(), h, [&mut known, tolerance]);
            h = control.rejected(h, if error <= 1.0 { f64::NAN } else { error });
            continue;
        }
        stagnating = StagnatingError::default();
        t += h;
        h = control.accepted(h, error);
        stepper.accept(true);
        let y = stepper.start().y;
        known.observe(y);
        tolerance.observe(y);
        states.push((t, y.to_vec()));
    }
    states
}

/// What of the errors of a rejected step of h from t is rounding of the equations' terms, these tolerances take note of.
fn note_rounding(
    system: &dyn System,
    (t, until): (f64, f64),
    stepper: &dyn OneStep,
    h: f64,
    tolerances: [&mut Tolerance; 2],
) {
    let (n, start, errors) = (system.len(), stepper.start(), stepper.errors());
    let at = At::packed(t, start.y, n).accelerated(&start.rate[n..]);
    let Some(noise) = by_terms(system, at, until) else { return };
    for tolerance in tolerances {
        for (i, noise) in noise.iter().enumerate() {
            tolerance.noise(i, *noise, (h, f64::INFINITY), [errors[i].abs(), errors[n + i].abs()]);
        }
        tolerance.spread_noise(errors, h);
    }
}

/// One step beside two of half its length.
struct TrialSteps {
    stepper: Box<dyn OneStep>,
    whole: Vec<f64>,
}

impl TrialSteps {
    fn new(method: Method, n: usize) -> Self {
        TrialSteps { stepper: stepper(method, n, false), whole: vec![0.0; 2 * n] }
    }

    /// What they differ by, a root mean square in units of the tolerance; infinite where a step cannot be done.
    fn error(&mut self, system: &dyn System, t: f64, y: &[f64], h: f64, tolerance: &Tolerance) -> f64 {
        if self.both(system, t, y, h).is_err() {
            return f64::INFINITY;
        }
        let (n, end) = (y.len() / 2, self.stepper.start().y);
        let change = |k: usize| (end[k] - y[k]).abs();
        let sum: f64 = (0..n)
            .map(|j| {
                // What stays where it is moves by rounding, to which no step is short enough.
                let [place, speed] = tolerance.units_by_change(j, h, tolerance.coupled_changes(j, change));
                ((end[j] - self.whole[j]) / place).powi(2) + ((end[n + j] - self.whole[n + j]) / speed).powi(2)
            })
            .sum();
        let error = (sum / (2 * n).max(1) as f64).sqrt();
        if error.is_finite() { error } else { f64::INFINITY }
    }

    fn both(&mut self, system: &dyn System, t: f64, y: &[f64], h: f64) -> Result<(), StepFailure> {
        let stepper = &mut self.stepper;
        stepper.state_mut().copy_from_slice(y);
        stepper.begin(system, t)?;
        stepper.attempt(system, Trial { t, h, tolerance: None })?;
        self.whole.copy_from_slice(stepper.end().y);
        for from in [t, t + 0.5 * h] {
            stepper.attempt(system, Trial { t: from, h: 0.5 * h, tolerance: None })?;
            stepper.conclude(system, from + 0.5 * h, false)?;
            stepper.accept(true);
        }
        Ok(())
    }
}
