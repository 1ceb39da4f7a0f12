//! Roots at which slopes vanish.

use nalgebra::DVector;

use super::newton::Linearised;
use super::search::{Equations, Seeker, Solution};
use super::trial::Trial;

/// A root x of order m: along a direction v the equations change like a power, u·r(x + s v) ≈ c sᵐ.
pub(super) struct MultipleRoot {
    /// m.
    pub order: usize,
    /// v, in parts of the unknowns' scales, of unit length.
    pub direction: DVector<f64>,
    /// The linearisation without this direction.
    pub others: Linearised,
    /// u, of unit length.
    weights: DVector<f64>,
    /// |c|.
    coefficient: f64,
}

/// Where no direction changes the equations by less than this part of what others do, or of what is wanted, slopes are as exact as a root
/// needs; at a root of second order, known to half of fourteen digits, they are smaller.
const WEAK: f64 = 1e-3;
/// How far from a root it is seen how slopes grow there, in parts of the unknowns: this root of the tolerance.  A triple root is known to the
/// third root, nearer by.
const AWAY: f64 = 0.25;
/// Slopes that are less than this, in parts of what is wanted, are rounding: they are known to some eleven digits.
const ROUNDING: f64 = 1e-10;

impl MultipleRoot {
    /// What the slopes say at x + s v and at x + 2 s v, of which those along v grow like s^(m − 1); `None` where they stay.
    pub fn at(
        seeker: &mut Seeker,
        solution: &Solution,
        scales: &[f64],
        equations: &dyn Fn(&Seeker, Trial, &[f64]) -> Equations,
    ) -> Option<MultipleRoot> {
        let (weights, sigma, direction) = solution.linear.weakest()?;
        if sigma > WEAK * solution.linear.strongest().max(1.0) {
            return None;
        }
        let away = seeker.source.settings.tolerance.powf(AWAY);
        let mut slope = |s: f64| {
            let moved = solution.values.iter().zip(scales).zip(direction.iter());
            let moved: Vec<f64> = moved.map(|((x, scale), v)| x + s * scale * v).collect();
            let trial = seeker.try_at(&moved).ok()?;
            let same = trial.varied.agrees(&solution.equations.trial.varied);
            same.then(|| (equations(seeker, trial, scales).j * &direction).dot(&weights).abs())
        };
        let way = |sign: f64, slope: &mut dyn FnMut(f64) -> Option<f64>| {
            Some([slope(sign * away)?, slope(2.0 * sign * away)?])
        };
        let [near, far] = way(1.0, &mut slope).or_else(|| way(-1.0, &mut slope))?;
        let power = (far / near).log2().round();
        if far < ROUNDING || power.is_nan() || power < 1.0 || power.is_infinite() {
            return None;
        }
        let order = 1.0 + power;
        Some(MultipleRoot {
            order: order as usize,
            coefficient: near / (order * away.powf(power)),
            others: solution.linear.without_weakest(),
            direction,
            weights,
        })
    }

    /// How far away along v the root may be, if the equations leave r, known to `error`: (u·r/c)^(1/m).
    pub fn distance(&self, r: &DVector<f64>, error: &DVector<f64>, rounding: f64) -> f64 {
        let left = self.weights.dot(r).abs() + self.weights.dot(error).abs() + rounding;
        (left / self.coefficient).powf(1.0 / self.order as f64)
    }

    /// The unknowns whose digits it takes: those that move by a tenth at least of what v does.
    pub fn unknowns(&self, names: &[String]) -> Vec<String> {
        let moved = names.iter().zip(self.direction.iter()).filter(|(_, part)| part.abs() >= 0.1);
        moved.map(|(name, _)| name.clone()).collect()
    }
}
