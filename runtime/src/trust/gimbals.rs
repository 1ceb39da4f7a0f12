//! Angles that lock where the mechanism does not: gimbal lock.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use super::warning::Warning;
use crate::cause::{Cause, GimbalLock};
use crate::mechanism::dense::{constraint_matrix, mass_matrix};
use crate::mechanism::{At, Gimbal, System, rows_in_force};

/// The part of the largest inertia below which a combination of the angles' rates moves nothing: rounding of M's elements, with room for
/// a thousand terms.
const MOVES_NOTHING: f64 = 1e-12;
/// A combination of rates contains an angle to more than this part.
const TAKES_PART: f64 = 1e-3;
/// How many tolerances from the lock a state is not told from it: errors of a run exceed its tolerance so many times before it is
/// half done.
const UNTOLD: f64 = 10.0;
/// The sine of the angle from the lock, within which a run that fails has failed by it.
const BESIDE: f64 = 1e-3;
/// The sine within which a motion passes near a lock, 1.1 degrees: rates of angles are fifty times those of the body there.
const NEAR: f64 = 0.02;
/// How many times shorter than elsewhere steps are beside a lock where it is worth a warning: a lock that costs less than that does no harm.
const SHORTER: f64 = 10.0;

/// Watches the product of the axes of each three angles that turn a frame one after the other.
///
/// It is a sine of the middle angle.  Where its argument passes a multiple of π the equations were singular within the step, whatever the
/// method made of them; where the sine is as small as the error of the angles, nobody knows whether it did.
#[derive(Clone, Debug)]
pub(crate) struct GimbalGuard {
    /// The sine's argument for each sequence, at the end of the last step.
    arguments: Vec<f64>,
    t: f64,
    /// Below it a sine is not told from 0.
    least: f64,
    /// What was seen near the lock of each sequence; nothing before it came near.
    approaches: Vec<Option<Approach>>,
    /// How many steps there were, and how long the longest was, s.
    steps: u64,
    longest: f64,
}

/// How a motion passes near a lock.
#[derive(Clone, Debug)]
struct Approach {
    /// When it was nearest, s, the state [q; q'] then, and the smallest sine.
    t: f64,
    y: Vec<f64>,
    sine: f64,
    /// How many steps ended near it, and how long the shortest was, s.
    steps: u64,
    shortest: f64,
}

/// The argument of the sine that the product of the axes is a multiple of.
fn argument(gimbal: &Gimbal, q: &[f64]) -> f64 {
    gimbal.factor * q[gimbal.coordinates[1] as usize] + gimbal.phase
}

/// Which part of the way from one argument to another leads to the first multiple of π between them.
fn passed(from: f64, to: f64) -> Option<f64> {
    let met = if to > from { (from / PI).floor() + 1.0 } else { (from / PI).ceil() - 1.0 } * PI;
    let part = (met - from) / (to - from);
    (from != to && part <= 1.0).then_some(part)
}

impl GimbalGuard {
    /// At the start of a run; `None` where nothing can lock.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, y: &[f64], tolerance: Option<f64>) -> Option<Self> {
        let gimbals = system.gimbals();
        let arguments = gimbals.iter().map(|gimbal| argument(gimbal, y)).collect();
        let (least, approaches) = (UNTOLD * tolerance.unwrap_or(0.0), vec![None; gimbals.len()]);
        let guard = GimbalGuard { arguments, t, least, approaches, steps: 0, longest: 0.0 };
        (!gimbals.is_empty()).then_some(guard)
    }

    /// Begins anew after the state was changed.
    pub fn restart<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        self.t = t;
        for (last, gimbal) in self.arguments.iter_mut().zip(system.gimbals()) {
            *last = argument(gimbal, y);
        }
    }

    /// Looks at the end of a step; tells if the motion came to a lock on the way.
    pub fn observe<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) -> Option<Cause> {
        let before = std::mem::replace(&mut self.t, t);
        (self.steps, self.longest) = (self.steps + 1, self.longest.max(t - before));
        for ((last, seen), gimbal) in self.arguments.iter_mut().zip(&mut self.approaches).zip(system.gimbals()) {
            let now = argument(gimbal, y);
            let earlier = std::mem::replace(last, now);
            let crossed = passed(earlier, now);
            let sine = now.sin();
            if sine.abs() < NEAR {
                seen.get_or_insert_with(|| Approach::before(t)).observe(t - before, (t, y), sine.abs());
            }
            if crossed.is_none() && sine.abs() > self.least {
                continue;
            }
            let Some(lock) = nearest_lock(system, gimbal, t, y) else { continue };
            let rate = now.cos() * gimbal.factor * y[system.len() + gimbal.coordinates[1] as usize];
            let reached = match crossed {
                Some(part) => before + part * (t - before),
                None if sine * rate < 0.0 => t - sine / rate,
                None => t,
            };
            return Some(Cause::GimbalLock { lock, t: reached });
        }
        None
    }

    /// Warns of each lock that the motion passed so near that its steps became short.
    pub fn warnings<'a, S: System + ?Sized>(&'a self, system: &'a S) -> impl Iterator<Item = Warning> + 'a {
        let seen = self.approaches.iter().zip(system.gimbals());
        seen.filter_map(|(seen, gimbal)| {
            let Approach { t, y, sine, steps, shortest } = seen.as_ref()?;
            let lock = (SHORTER * shortest < self.longest).then(|| nearest_lock(system, gimbal, *t, y))??;
            let part = *steps as f64 / self.steps as f64;
            Some(Warning::NearGimbalLock { lock, t: *t, angle: sine.asin() / gimbal.factor.abs(), part })
        })
    }
}

impl Approach {
    /// Nothing was seen yet.
    fn before(t: f64) -> Approach {
        Approach { t, y: Vec::new(), sine: f64::INFINITY, steps: 0, shortest: f64::INFINITY }
    }

    /// Looks at the end of a step of this length.
    fn observe(&mut self, step: f64, (t, y): (f64, &[f64]), sine: f64) {
        (self.steps, self.shortest) = (self.steps + 1, self.shortest.min(step));
        if sine < self.sine {
            (self.t, self.sine) = (t, sine);
            self.y.clear();
            self.y.extend_from_slice(y);
        }
    }
}

/// The lock of a sequence that is nearest to a state, if M is singular there.
fn nearest_lock<S: System + ?Sized>(system: &S, gimbal: &Gimbal, t: f64, y: &[f64]) -> Option<GimbalLock> {
    let middle = gimbal.coordinates[1] as usize;
    let mut q = y[..system.len()].to_vec();
    q[middle] = ((argument(gimbal, y) / PI).round() * PI - gimbal.phase) / gimbal.factor;
    is_locked(system, gimbal, At::place(t, &q)).then(|| named(system, gimbal))
}

fn named<S: System + ?Sized>(system: &S, gimbal: &Gimbal) -> GimbalLock {
    let angles = gimbal.coordinates.map(|k| system.description().coordinate_name(k as usize));
    GimbalLock { frame: gimbal.frame.to_string(), angles }
}

/// Whether some rates of the three angles, of two at least, neither move a mass nor meet a constraint: M v = 0 and J v = 0.
fn is_locked<S: System + ?Sized>(system: &S, gimbal: &Gimbal, at: At<'_>) -> bool {
    let m = mass_matrix(system, at);
    let rows: Vec<usize> = rows_in_force(system).collect();
    let size = m.diagonal().map(|m| if m > 0.0 { m.sqrt() } else { 1.0 });
    let columns = gimbal.coordinates.map(|k| k as usize);
    let moved = DMatrix::from_fn(m.nrows(), 3, |i, k| m[(i, columns[k])] / (size[i] * size[columns[k]]));
    let j = constraint_matrix(system, at, &rows);
    let scaled = DMatrix::from_fn(j.nrows(), j.ncols(), |i, k| j[(i, k)] / size[k]);
    let held = DMatrix::from_fn(j.nrows(), 3, |i, k| {
        let norm = scaled.row(i).norm();
        if norm > 0.0 { scaled[(i, columns[k])] / norm } else { 0.0 }
    });
    let all = DMatrix::from_fn(moved.nrows() + held.nrows(), 3, |i, k| {
        if i < moved.nrows() { moved[(i, k)] } else { held[(i - moved.nrows(), k)] }
    });
    if all.iter().any(|x| !x.is_finite()) {
        return false;
    }
    let decomposed = (all.transpose() * &all).symmetric_eigen();
    let (least, _) = decomposed.eigenvalues.argmin();
    let rates = decomposed.eigenvectors.column(least);
    let moves = (&all * rates).norm();
    moves <= MOVES_NOTHING * all.norm() && rates.iter().filter(|rate| rate.abs() > TAKES_PART).count() > 1
}

/// The lock in which a state is.
pub(crate) fn lock_here<S: System + ?Sized>(system: &S, at: At<'_>) -> Option<GimbalLock> {
    let locked = |gimbal: &&Gimbal| argument(gimbal, at.q).sin().abs() < BESIDE && is_locked(system, gimbal, at);
    system.gimbals().iter().find(locked).map(|gimbal| named(system, gimbal))
}

/// Names a lock beside the last state of a run as the cause of its end.
pub(crate) fn explain_lock(system: &dyn System, t: f64, y: &[f64], cause: Cause) -> Cause {
    let explicable = matches!(
        cause,
        Cause::StepTooSmall { .. }
            | Cause::ToleranceTooTight { .. }
            | Cause::NonFinite { .. }
            | Cause::SingularMass { .. }
            | Cause::NegativeInertia { .. }
            | Cause::IterationStalled { .. }
            | Cause::DirectionLost { .. }
            | Cause::TooManySteps { .. }
            | Cause::NeedsMoreSteps { .. }
    );
    if !explicable {
        return cause;
    }
    let beside = system.gimbals().iter().filter(|gimbal| argument(gimbal, y).sin().abs() < BESIDE);
    let lock = beside.filter_map(|gimbal| nearest_lock(system, gimbal, t, y)).next();
    lock.map_or(cause, |lock| Cause::GimbalLock { lock, t })
}

#[cfg(test)]
mod tests {
    use super::passed;
    use std::f64::consts::PI;

    #[test]
    fn multiples_are_passed_once_in_either_direction() {
        assert_eq!(passed(0.3, 0.3), None);
        assert_eq!(passed(0.0, 0.3), None);
        assert_eq!(passed(0.1, 3.0), None);
        assert_eq!(passed(0.25, -0.25), Some(0.5));
        assert_eq!(passed(-0.25, 0.75), Some(0.25));
        assert_eq!(passed(0.5 * PI, 1.5 * PI), Some(0.5));
        // Two in one step, which leave the sine's sign as it was: the first counts.
        assert_eq!(passed(-0.5 * PI, 1.5 * PI), Some(0.25));
    }
}
