//! Scales of rows, columns and coordinates, and ranks judged by them.

use nalgebra::{DMatrix, DVector};

use super::{Singular, SparseMatrix};
use crate::matrix::equilibrated;

/// A matrix of which the rank must be known fast where it is full.
const LARGE: usize = 60;

/// Numbers below this part of others are rounding.
const ROUNDING: f64 = 1e-15;
/// Angles and pure numbers below this are.
pub const NO_ANGLE: f64 = 1e-12;

/// What each number is large beside: the largest of those with its unit; where all of these are rounding, 1 for angles and pure
/// numbers, and for others the largest of all, 1 of an angle among them.
pub fn natural_sizes<U: AsRef<str>>(units: &[U], numbers: &[f64]) -> Vec<f64> {
    let is_angle = |unit: &U| matches!(unit.as_ref(), "1" | "rad");
    let all = units.iter().zip(numbers).fold(0.0_f64, |most, (unit, x)| {
        let least = if is_angle(unit) { 1.0 } else { 0.0 };
        x.abs().max(least).max(most)
    });
    let size = |unit: &U| {
        let alike = units.iter().zip(numbers).filter(|(other, _)| other.as_ref() == unit.as_ref());
        let largest = alike.fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
        match if is_angle(unit) { NO_ANGLE } else { ROUNDING * all } {
            rounding if largest > rounding => largest,
            _ if is_angle(unit) || all == 0.0 => 1.0,
            _ => all,
        }
    };
    units.iter().map(size).collect()
}

/// Beyond this an angle's sine has lost half of its digits, rad.
const TURNED: f64 = 1e8;
/// Beyond this a search has found nothing.
const FAR: f64 = 1e30;

/// Whether a search has gone so far that rounding decides what it finds.
pub fn is_lost<U: AsRef<str>>(units: &[U], numbers: &[f64]) -> bool {
    let farthest = |unit: &U| if unit.as_ref() == "rad" { TURNED } else { FAR };
    units.iter().zip(numbers).any(|(unit, x)| x.abs() > farthest(unit))
}

/// The part of a step of Newton's method with which a search begins: none turns an angle further than half a turn, or its own size.  Where a stiffness
/// all but vanishes a whole step would lead to angles of so many turns that rounding hides what their sines are.  Numbers may be angles where
/// a file has no units.
pub fn first_part<U: AsRef<str>>(units: &[U], numbers: &[f64], step: &[f64]) -> f64 {
    let is_angle = |unit: &U| matches!(unit.as_ref(), "" | "1" | "rad");
    let angles = units.iter().zip(numbers.iter().zip(step)).filter(|(unit, _)| is_angle(unit));
    let part = |(x, step): (&f64, &f64)| std::f64::consts::PI.max(x.abs()) / step.abs();
    angles.map(|(_, turn)| part(turn)).fold(1.0, f64::min)
}

/// The parts of a step that are tried: from [`first_part`] on ever halves, to a millionth of it.
pub fn tried_parts<U: AsRef<str>>(units: &[U], numbers: &[f64], step: &[f64]) -> impl Iterator<Item = f64> + use<U> {
    let first = first_part(units, numbers, step);
    std::iter::successors(Some(first), |part| Some(0.5 * part)).take_while(move |part| *part > 1e-6 * first)
}

/// An orthonormal basis of the null space of a square matrix, by the singular values of the equilibrated one.
pub fn null_space(matrix: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = matrix.nrows();
    let (scaled, _, columns) = equilibrated(matrix);
    if n == 0 || (n > LARGE && is_regular(&scaled)) {
        return Some(DMatrix::zeros(n, 0));
    }
    let singular = Singular::of(&scaled)?;
    let threshold = Scaled::threshold(n, singular.values.max());
    let null = singular.directions(|value| value <= threshold);
    if null.ncols() == 0 || columns.iter().all(|factor| *factor == columns[0]) {
        return Some(null);
    }
    Some((DMatrix::from_diagonal(&columns) * null).qr().q())
}

/// Quick and safe: pivots of an LU factorization far above rounding.
fn is_regular(matrix: &DMatrix<f64>) -> bool {
    let pivots = matrix.clone().lu().u().diagonal().abs();
    pivots.min() > 1e-8 * pivots.max()
}

/// Coordinates in units of 1/√Mᵢᵢ: in them, different units of coordinates do not matter.
pub struct Scaled {
    roots: DVector<f64>,
}

impl Scaled {
    /// Scales by M's diagonal; coordinates without inertia are left alone.
    pub fn new(mass: &SparseMatrix) -> Self {
        let mut roots = DVector::zeros(mass.rows);
        for (row, column, value) in &mass.entries {
            if row == column {
                roots[*row as usize] += value;
            }
        }
        Scaled { roots: roots.map(|m: f64| if m > 0.0 && m.is_finite() { m.sqrt() } else { 1.0 }) }
    }

    /// Singular values and eigenvalues below this are zero to rounding: 16 n ε ‖A‖.
    pub fn threshold(n: usize, norm: f64) -> f64 {
        16.0 * n as f64 * f64::EPSILON * norm
    }

    pub fn stiffness(&self, stiffness: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(stiffness.nrows(), stiffness.ncols(), |i, j| {
            stiffness[(i, j)] / (self.roots[i] * self.roots[j])
        })
    }

    pub fn force(&self, force: &[f64]) -> DVector<f64> {
        DVector::from_fn(force.len(), |i, _| force[i] / self.roots[i])
    }

    /// From scaled to given coordinates.
    pub fn step(&self, scaled: &DVector<f64>) -> Vec<f64> {
        scaled.iter().zip(self.roots.iter()).map(|(x, root)| x / root).collect()
    }

    /// From given to scaled coordinates.
    pub fn coordinates(&self, given: &[f64]) -> DVector<f64> {
        DVector::from_fn(given.len(), |i, _| given[i] * self.roots[i])
    }

    pub fn norm(&self, given: &[f64]) -> f64 {
        self.coordinates(given).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of angles beside lengths, and of lengths beside angles, is no size.
    #[test]
    fn numbers_are_measured_by_those_with_their_unit() {
        let units = ["m", "m", "rad"];
        assert_eq!(natural_sizes(&units, &[1e12, 0.0, 1e-15]), [1e12, 1e12, 1.0]);
        assert_eq!(natural_sizes(&units, &[1e-12, 3e-13, 0.2]), [1e-12, 1e-12, 0.2]);
        assert_eq!(natural_sizes(&units, &[1e-19, 0.0, 1e-20]), [1.0; 3]);
        assert_eq!(natural_sizes(&units[..2], &[1e-19, 0.0]), [1e-19; 2]);
        assert_eq!(natural_sizes(&units[..2], &[0.0; 2]), [1.0; 2]);
    }
}
