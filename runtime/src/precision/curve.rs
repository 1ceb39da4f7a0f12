//! A candidate's points, from coarse to fine.

use super::point::{AccuracyControl, Point};
use super::{Candidate, Measured, Reference};
use crate::error::Error;
use crate::mechanism::{Enforcement, Method};
use crate::simulate::Settings;

/// What a candidate costs at each error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Curve {
    /// The candidate's name.
    pub name: String,
    /// Its method; `auto` where it chose one itself.
    pub method: Method,
    /// From coarse to fine.
    pub points: Vec<Point>,
}

/// Two paces a decade of the tolerance, two a factor of two of the step.
const FINER: f64 = 0.316_227_766_016_837_94;
const SHORTER: f64 = std::f64::consts::FRAC_1_SQRT_2;
/// The loosest tolerance.
const LOOSEST: f64 = 1e-2;
/// A curve may stand still for so many points: springs in the place of constraints are not what the reference has, and below this
/// error there may be nothing but rounding.
const STANDSTILL: usize = 4;
const NEARLY_ROUNDED: f64 = 1e-9;
/// A curve has no more points.
const MOST: usize = 60;

/// Whether two runs that keep their steps took as many: ticks and known times cut both alike, and the shorter step is no further run.
fn took_as_many(before: &Point, point: &Point) -> bool {
    let steps = |point: &Point| match (point.control, &point.outcome) {
        (AccuracyControl::Step(_), Ok(found)) => Some(found.work.steps),
        _ => None,
    };
    steps(point).is_some() && steps(before) == steps(point)
}

/// The step that a run takes on the average, s.
fn average_step(point: &Point, reference: &Reference) -> f64 {
    let steps = point.outcome.as_ref().map_or(1, |found| found.work.steps);
    let times = reference.times();
    (times[times.len() - 1] - times[0]) / steps as f64
}

impl Curve {
    /// Runs a candidate from coarse to fine, until the reference has no more digits or the cost passes all bounds.
    pub(super) fn measure(candidate: &Candidate, reference: &Reference, repetitions: usize) -> Result<Curve, Error> {
        let mut system = candidate.system.boxed_clone();
        let method = candidate.settings.method;
        let springs = matches!(candidate.settings.enforcement, Enforcement::Springs { .. });
        let mut curve = Curve { name: candidate.name.clone(), method, points: Vec::new() };
        let adapts = method.adapts_to(&system.description().structure);
        let mut control =
            if adapts { AccuracyControl::Tolerance(LOOSEST) } else { AccuracyControl::Step(reference.longest_step()) };
        for _ in 0..MOST {
            let Some(point) = Point::measure(&mut *system, candidate, control, reference, repetitions)? else { break };
            let at_floor = point.outcome.as_ref().is_ok_and(|found| found.error <= reference.floor());
            match curve.points.last_mut().filter(|before| took_as_many(before, &point)) {
                Some(before) => before.control = AccuracyControl::Step(average_step(before, reference)),
                None => curve.points.push(point),
            }
            if at_floor {
                break;
            }
            if springs && curve.stands_still() || curve.is_rounding() {
                break;
            }
            control = match control {
                AccuracyControl::Tolerance(tolerance) if tolerance < 1.5 * Settings::TIGHTEST => break,
                AccuracyControl::Tolerance(tolerance) => AccuracyControl::Tolerance(tolerance * FINER),
                AccuracyControl::Step(step) => AccuracyControl::Step(step * SHORTER),
            };
        }
        Ok(curve)
    }

    /// Points that came to something, from coarse to fine.
    pub fn measured(&self) -> impl Iterator<Item = &Measured> {
        self.points.iter().filter_map(|point| point.outcome.as_ref().ok())
    }

    /// The least of `cost` at which the error is no larger than this one from there on, interpolated in logarithms.
    pub fn at(&self, error: f64, cost: impl Fn(&Measured) -> f64) -> Option<f64> {
        let found: Vec<&Measured> = self.measured().collect();
        let reached = found.iter().rposition(|point| point.error > error).map_or(0, |last| last + 1);
        let fine = found.get(reached)?;
        // Coarser ones may have been rejected or not tried: what is known is no more than this.
        let Some(coarse) = reached.checked_sub(1).map(|before| found[before]) else { return Some(cost(fine)) };
        let part = ((coarse.error / error).ln() / (coarse.error / fine.error).ln()).clamp(0.0, 1.0);
        Some((cost(coarse).ln() + part * (cost(fine).ln() - cost(coarse).ln())).exp())
    }

    /// The order at which the error falls with the cost: the slope of −log error over log cost, by least squares over the
    /// finer two thirds of the points.
    pub fn order(&self) -> Option<f64> {
        let found: Vec<(f64, f64)> = self.measured().map(|point| (point.cost.ln(), -point.error.ln())).collect();
        let fine = &found[found.len() / 3..];
        let count = fine.len() as f64;
        let (x, y) = (fine.iter().map(|p| p.0).sum::<f64>() / count, fine.iter().map(|p| p.1).sum::<f64>() / count);
        let across: f64 = fine.iter().map(|p| (p.0 - x).powi(2)).sum();
        let up: f64 = fine.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (fine.len() >= 3 && across > 0.0).then_some(up / across)
    }

    /// The median of error over tolerance: 1 … 30 is good.
    pub fn honesty(&self) -> Option<f64> {
        let ratio = |point: &Point| match (point.control, &point.outcome) {
            (AccuracyControl::Tolerance(tolerance), Ok(found)) => Some(found.error / tolerance),
            _ => None,
        };
        let mut ratios: Vec<f64> = self.points.iter().filter_map(ratio).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied()
    }

    /// True where more work has not made a difference for a while.
    fn stands_still(&self) -> bool {
        let found: Vec<&Measured> = self.measured().collect();
        let Some(before) = found.len().checked_sub(STANDSTILL) else { return false };
        found[before..].windows(2).all(|pair| (pair[1].error / pair[0].error - 1.0).abs() < 0.01)
    }

    /// True where errors are small, and more work has not halved them for a while.
    fn is_rounding(&self) -> bool {
        let errors: Vec<f64> = self.measured().map(|point| point.error).collect();
        let Some(before) = errors.len().checked_sub(STANDSTILL) else { return false };
        let least = |errors: &[f64]| errors.iter().copied().fold(f64::INFINITY, f64::min);
        let reached = least(&errors[..before]);
        reached < NEARLY_ROUNDED && least(&errors[before..]) > 0.5 * reached
    }
}
