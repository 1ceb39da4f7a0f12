//! The least that the largest of several sizes can be: min over w of max |p_k|, p_k = f_k + Z_k w.

use nalgebra::{DMatrix, DVector};

use super::IN_SPAN;
use super::bounds::{Bound, lowest};
use crate::matrix::svd;

/// Sizes that exceed their bounds by less, in parts of a limit, are as good as met: some hundred roundings, beside which instants of slipping are known.
const EXACT: f64 = 1e-13;
/// Rounds in which bounds are added to what is round, at the most: where they do not come to an end, as by rounding, the best share so far is taken.
const ROUNDS: usize = 60;
/// Sizes that are smaller than the largest by this part of it are not the largest where that is the least; steps of Newton's method from there.
const NEAR: f64 = 0.05;
const NEWTON_STEPS: usize = 10;

/// T/L of one contact: `force` + `idle` w.
pub(super) struct Part {
    pub force: DVector<f64>,
    pub idle: DMatrix<f64>,
}

impl Part {
    pub fn at(&self, w: &DVector<f64>) -> DVector<f64> {
        &self.force + &self.idle * w
    }

    /// The part in a direction, an affine function of w that is never more than the size.
    fn along(&self, direction: &DVector<f64>) -> Bound {
        Bound { slope: self.idle.tr_mul(direction), value: self.force.dot(direction) }
    }
}

/// w at which the largest size of all parts is the least: by bounds that touch the sizes, more of them where one is not yet exact
/// (Kelley, J. SIAM 8, 1960, 703), until Newton's method finds the rest of the way.
pub(super) fn least_largest(parts: &[Part]) -> Option<DVector<f64>> {
    let unknowns = parts.first()?.idle.ncols();
    let all: Vec<f64> = parts.iter().flat_map(|part| part.force.iter().copied()).collect();
    if all.iter().any(|x| !x.is_finite()) || parts.iter().any(|part| part.idle.iter().any(|x| !x.is_finite())) {
        return None;
    }
    let mut rows = DMatrix::zeros(all.len(), unknowns);
    let mut first = 0;
    for part in parts {
        rows.rows_mut(first, part.idle.nrows()).copy_from(&part.idle);
        first += part.idle.nrows();
    }
    // From the least sum of squares on; rows that are rounding count for nothing in it.
    let svd = svd(rows, true, true)?;
    let nothing = IN_SPAN * svd.singular_values.max();
    let mut w: DVector<f64> = -svd.solve(&DVector::from_vec(all), nothing).ok()?;
    let mut bounds: Vec<Bound> = Vec::new();
    for part in parts {
        for axis in 0..part.force.len() {
            for sign in [1.0, -1.0] {
                let direction = DVector::from_fn(part.force.len(), |i, _| if i == axis { sign } else { 0.0 });
                bounds.push(part.along(&direction));
            }
        }
    }
    for _ in 0..ROUNDS {
        if let Some(exact) = polished(parts, &w) {
            return Some(exact);
        }
        let largest = lowest(&bounds, &mut w)?;
        let count = bounds.len();
        for part in parts {
            let size = part.at(&w).norm();
            if size > largest + EXACT * largest.max(1.0) {
                bounds.push(part.along(&(part.at(&w) / size)));
            }
        }
        if bounds.len() == count {
            break;
        }
    }
    Some(w)
}

/// The largest size of all parts.
fn largest(parts: &[Part], w: &DVector<f64>) -> f64 {
    parts.iter().map(|part| part.at(w).norm()).fold(0.0, f64::max)
}

/// w at which the largest size of all parts is the least, from one near it, by Newton's method for those whose sizes are the largest there; `None` where
/// they are others, or the method leads elsewhere.
fn polished(parts: &[Part], w: &DVector<f64>) -> Option<DVector<f64>> {
    let near = (1.0 - NEAR) * largest(parts, w);
    let mut active: Vec<&Part> = parts.iter().filter(|part| part.at(w).norm() >= near).collect();
    while !active.is_empty() {
        let (found, multipliers) = stationary(&active, w)?;
        let (place, least) = multipliers.argmin();
        if least >= 0.0 {
            let below = bound_below(&active, &found, &multipliers);
            return (largest(parts, &found) - below <= EXACT * below.max(1.0)).then_some(found);
        }
        active.remove(place);
    }
    None
}

/// w and y with |p_k| = s for all parts, Σ y_k Z_kᵀ p_k = 0, Σ y_k = 1, by Newton's method from w on.
fn stationary(parts: &[&Part], w: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
    let (d, m) = (w.len(), parts.len());
    let mut w = w.clone();
    let mut s = parts.iter().map(|part| part.at(&w).norm()).fold(0.0, f64::max);
    let mut multipliers = DVector::from_element(m, 1.0 / m as f64);
    for _ in 0..NEWTON_STEPS {
        let mut matrix = DMatrix::zeros(d + m + 1, d + m + 1);
        let mut right = DVector::zeros(d + m + 1);
        for (i, part) in parts.iter().enumerate() {
            let at = part.at(&w);
            let slope = part.idle.tr_mul(&at);
            let mut curved = matrix.view_mut((0, 0), (d, d));
            curved += multipliers[i] * part.idle.tr_mul(&part.idle);
            matrix.view_mut((0, d + i), (d, 1)).copy_from(&slope);
            matrix.view_mut((d + i, 0), (1, d)).copy_from(&slope.transpose());
            matrix[(d + i, d + m)] = -s;
            matrix[(d + m, d + i)] = 1.0;
            let mut missed = right.rows_mut(0, d);
            missed -= multipliers[i] * slope;
            right[d + i] = 0.5 * (s * s - at.norm_squared());
        }
        right[d + m] = 1.0 - multipliers.sum();
        let factored = svd(matrix, true, true)?;
        let nothing = IN_SPAN * factored.singular_values.max();
        let step = factored.solve(&right, nothing).ok()?;
        w += step.rows(0, d);
        multipliers += step.rows(d, m);
        s += step[d + m];
        if !(s.is_finite() && w.iter().all(|w| w.is_finite())) {
            return None;
        }
        if step.rows(0, d).amax() <= EXACT * w.amax().max(1.0) {
            break;
        }
    }
    Some((w, multipliers))
}

/// Below this no w has its largest size: the mean of the sizes along their directions, with weights for which w has no part in it.
fn bound_below(parts: &[&Part], w: &DVector<f64>, multipliers: &DVector<f64>) -> f64 {
    let weights: Vec<f64> = parts.iter().zip(multipliers.iter()).map(|(part, y)| y * part.at(w).norm()).collect();
    let sum: f64 = weights.iter().sum();
    let (mut slope, mut bound) = (DVector::zeros(w.len()), 0.0);
    for (part, weight) in parts.iter().zip(&weights) {
        let own = part.along(&part.at(w).normalize());
        slope += weight / sum * own.slope;
        bound += weight / sum * own.value;
    }
    bound - slope.dot(w).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(force: &[f64], idle: &[&[f64]], limit: f64) -> Part {
        let rows = DMatrix::from_fn(idle.len(), idle[0].len(), |i, j| idle[i][j]);
        Part { force: DVector::from_column_slice(force) / limit, idle: rows / limit }
    }

    fn least(parts: &[Part]) -> f64 {
        largest(parts, &least_largest(parts).expect("a share"))
    }

    #[test]
    fn all_in_one_line_reach_their_limits_together() {
        // 26 N on two feet; on three with other limits: 26/(3 + 5 + 7).
        let two = [part(&[0.0], &[&[1.0]], 13.0), part(&[26.0], &[&[-1.0]], 26.0)];
        assert!((least(&two) - 26.0 / 39.0).abs() < 1e-14);
        let three = [
            part(&[26.0], &[&[-1.0, -1.0]], 3.0),
            part(&[0.0], &[&[1.0, 0.0]], 5.0),
            part(&[0.0], &[&[0.0, 1.0]], 7.0),
        ];
        assert!((least(&three) - 26.0 / 15.0).abs() < 1e-13);
    }

    #[test]
    fn in_space_sizes_count() {
        // Two feet along x, pushed across and along: what is along is shared so that hypot(3, p) and hypot(1, 4 − p) are alike.
        let feet = [part(&[4.0, 3.0], &[&[-1.0], &[0.0]], 1.0), part(&[0.0, 1.0], &[&[1.0], &[0.0]], 1.0)];
        // 9 + p² = 1 + (4 − p)²: p = 1.
        assert!((least(&feet) - 10.0_f64.sqrt()).abs() < 1e-12, "{}", least(&feet));
    }

    /// Feet along x of which idle forces across are rounding of rounding: as equations they would ask for 10²⁷.
    #[test]
    fn what_is_rounding_moves_nothing() {
        let feet = [
            Part {
                force: DVector::from_vec(vec![-1.427212141897822, -0.28931022396251604]),
                idle: DMatrix::from_column_slice(2, 1, &[-0.14562399883500696, 1.866863440011213e-17]),
            },
            Part {
                force: DVector::from_vec(vec![-1.427212141897822, -0.2893102239625161]),
                idle: DMatrix::from_column_slice(2, 1, &[0.14562399883500698, -1.8094811928646528e-28]),
            },
        ];
        let w = least_largest(&feet).expect("a share");
        assert!(w.amax() < 1e-9, "{w}");
    }
}
