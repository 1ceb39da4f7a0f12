//! The least part of their limits that contacts can need: min over w of max |T_k|/L_k, T_k = f_k + Z_k w and L_k affine in w.

use nalgebra::{DMatrix, DVector};

use super::IN_SPAN;
use super::bounds::{Bound, Lowest, lowest};
use crate::matrix::svd;

/// Ratios that exceed their bounds by less are as good as met: some hundred roundings, beside which instants of slipping are known.
const EXACT: f64 = 1e-13;
/// Rounds in which bounds are added to what is round, at the most: where they do not come to an end, as by rounding, the best share so far is taken.
const ROUNDS: usize = 60;
/// Ratios that are smaller than the largest by this part of it are not the largest where that is the least; steps of Newton's method from there.
const NEAR: f64 = 0.05;
const NEWTON_STEPS: usize = 10;

/// What a contact holds, and what it can hold, as w has it: T = `force` + `idle` w, L = `limit`.
#[derive(Clone)]
pub(super) struct Part {
    pub force: DVector<f64>,
    pub idle: DMatrix<f64>,
    pub limit: Bound,
}

impl Part {
    pub fn at(&self, w: &DVector<f64>) -> DVector<f64> {
        &self.force + &self.idle * w
    }

    /// |T|/L; infinite where nothing can hold it.
    pub fn ratio(&self, w: &DVector<f64>) -> f64 {
        let limit = self.limit.at(w);
        if limit > 0.0 { self.at(w).norm() / limit } else { f64::INFINITY }
    }

    /// T in a direction less s L, an affine function of w that is never more than |T| − s L.
    fn along(&self, direction: &DVector<f64>, s: f64) -> Bound {
        Bound {
            slope: self.idle.tr_mul(direction) - s * &self.limit.slope,
            value: self.force.dot(direction) - s * self.limit.value,
        }
    }

    /// The same in other units of force.
    fn in_units_of(&self, force: f64) -> Part {
        let limit = Bound { slope: &self.limit.slope / force, value: self.limit.value / force };
        Part { force: &self.force / force, idle: &self.idle / force, limit }
    }

    fn is_finite(&self) -> bool {
        let all = self.force.iter().chain(self.idle.iter()).chain(self.limit.slope.iter());
        all.chain([&self.limit.value]).all(|x| x.is_finite())
    }
}

/// w at which the largest ratio of all parts is the least: by parametric programmes, min max (|T| − s L)/L⁻ where s is the largest ratio so far and L⁻ the
/// limits there (Crouzeix, Ferland, Schaible, J. Optim. Theory Appl. 47, 1985, 35), with bounds that touch |T|, more of them where one is not yet exact
/// (Kelley, J. SIAM 8, 1960, 703), until Newton's method finds the rest of the way.
///
/// What jams can be pressed as hard as one likes: so hard then that halfway from the least ratio of that to 1 is held.
pub(super) fn least_largest(parts: &[Part]) -> Option<DVector<f64>> {
    if parts.is_empty() || !parts.iter().all(Part::is_finite) {
        return None;
    }
    let mut w = pressed(parts, least_squares(parts)?)?;
    let parts: Vec<Part> = parts.iter().map(|part| part.in_units_of(part.limit.at(&w))).collect();
    let mut cuts = Cuts::along_axes(&parts);
    let mut best = w.clone();
    for _ in 0..ROUNDS {
        if let Some(exact) = polished(&parts, &w) {
            return Some(exact);
        }
        let s = largest(&parts, &best);
        let limits: Vec<f64> = parts.iter().map(|part| part.limit.at(&best)).collect();
        let exceeded = match lowest(&cuts.bounds(s, &limits), &mut w)? {
            Lowest::At(height) => cuts.add_at(&w, s, height + EXACT * s.max(1.0), &limits),
            Lowest::Falls(way) => {
                let least = far_along(&parts, &way);
                if least < s.min(1.0) {
                    return Some(jammed(&parts, &best, &way, least));
                }
                cuts.add_far_along(&way, s)
            }
        };
        let falls = s - largest(&parts, &w);
        if falls > 0.0 {
            best.copy_from(&w);
        }
        if !exceeded && falls <= EXACT * s.max(1.0) {
            break;
        }
    }
    Some(best)
}

/// Directions of parts in which |T| is bounded from below.
struct Cuts<'a> {
    parts: &'a [Part],
    known: Vec<(usize, DVector<f64>)>,
}

impl<'a> Cuts<'a> {
    fn along_axes(parts: &'a [Part]) -> Self {
        let mut known = Vec::new();
        for (k, part) in parts.iter().enumerate() {
            for axis in 0..part.force.len() {
                for sign in [1.0, -1.0] {
                    known.push((k, DVector::from_fn(part.force.len(), |i, _| if i == axis { sign } else { 0.0 })));
                }
            }
        }
        Cuts { parts, known }
    }

    /// (|T| − s L)/L⁻ from below; L ≥ 0 is asked of what holds nothing, too.
    fn bounds(&self, s: f64, limits: &[f64]) -> Vec<Bound> {
        let bound = |(k, direction): &(usize, DVector<f64>)| {
            let Bound { slope, value } = self.parts[*k].along(direction, s);
            Bound { slope: slope / limits[*k], value: value / limits[*k] }
        };
        let presses = self.parts.iter().zip(limits).filter(|(part, _)| part.limit.slope.amax() > 0.0);
        let presses = presses.map(|(part, limit)| Bound {
            slope: -s * &part.limit.slope / *limit,
            value: -s * part.limit.value / limit,
        });
        self.known.iter().map(bound).chain(presses).collect()
    }

    /// Cuts what is more than a height at a place; whether anything is.
    fn add_at(&mut self, w: &DVector<f64>, s: f64, height: f64, limits: &[f64]) -> bool {
        let before = self.known.len();
        for (k, part) in self.parts.iter().enumerate() {
            let force = part.at(w);
            if (force.norm() - s * part.limit.at(w)) / limits[k] > height {
                self.known.push((k, force.normalize()));
            }
        }
        self.known.len() > before
    }

    /// Cuts what does not fall along a way in the end; whether anything does not.
    fn add_far_along(&mut self, way: &DVector<f64>, s: f64) -> bool {
        let before = self.known.len();
        for (k, part) in self.parts.iter().enumerate() {
            let force = &part.idle * way;
            if force.norm() > s * part.limit.slope.dot(way).max(0.0) {
                self.known.push((k, force.normalize()));
            }
        }
        self.known.len() > before
    }
}

/// The largest ratio far along a way.
fn far_along(parts: &[Part], way: &DVector<f64>) -> f64 {
    let ratio = |part: &Part| match (&part.idle * way).norm() {
        0.0 => 0.0,
        size => size / part.limit.slope.dot(way).max(0.0),
    };
    parts.iter().map(ratio).fold(0.0, f64::max)
}

/// The w with the least sum of squares of T/L, as far as limits are known at 0; rows that are rounding count for nothing in it.
fn least_squares(parts: &[Part]) -> Option<DVector<f64>> {
    let size = |part: &Part| if part.limit.value > 0.0 { part.limit.value } else { 1.0 };
    let all: Vec<f64> = parts.iter().flat_map(|part| part.force.iter().map(move |force| force / size(part))).collect();
    let mut rows = DMatrix::zeros(all.len(), parts.first()?.idle.ncols());
    let mut first = 0;
    for part in parts {
        rows.rows_mut(first, part.idle.nrows()).copy_from(&(&part.idle / size(part)));
        first += part.idle.nrows();
    }
    let svd = svd(rows, true, true)?;
    let nothing = IN_SPAN * svd.singular_values.max();
    Some(-svd.solve(&DVector::from_vec(all), nothing).ok()?)
}

/// w where all limits are positive, from one on; `None` where there is none.
fn pressed(parts: &[Part], mut w: DVector<f64>) -> Option<DVector<f64>> {
    let least = |w: &DVector<f64>| parts.iter().map(|part| part.limit.at(w)).fold(f64::INFINITY, f64::min);
    if least(&w) > 0.0 {
        return Some(w);
    }
    let short = |part: &Part| Bound { slope: -&part.limit.slope, value: -part.limit.value };
    let short: Vec<Bound> = parts.iter().map(short).collect();
    if let Lowest::Falls(way) = lowest(&short, &mut w)? {
        // As hard as what is held there.
        let force = parts.iter().map(|part| part.at(&w).norm()).fold(0.0, f64::max);
        w += (force - least(&w)).max(0.0) * way;
    }
    (least(&w) > 0.0).then_some(w)
}

/// w on a way along which the ratios fall to one below 1: halfway between them, or here where they are lower.
fn jammed(parts: &[Part], w: &DVector<f64>, way: &DVector<f64>, least: f64) -> DVector<f64> {
    let ratio = 0.5 * (1.0 + least);
    let beyond = |along: f64| largest(parts, &(w + along * way)) > ratio;
    let (mut from, mut to) = (0.0, 1.0);
    if !beyond(from) {
        return w.clone();
    }
    while beyond(to) && to < f64::MAX {
        (from, to) = (to, 2.0 * to);
    }
    while to - from > EXACT * to {
        let middle = 0.5 * (from + to);
        if beyond(middle) { from = middle } else { to = middle }
    }
    w + to * way
}

/// The largest ratio of all parts.
fn largest(parts: &[Part], w: &DVector<f64>) -> f64 {
    parts.iter().map(|part| part.ratio(w)).fold(0.0, f64::max)
}

/// w at which the largest ratio of all parts is the least, from one near it, by Newton's method for those whose ratios are the largest there; `None` where
/// they are others, or the method leads elsewhere.
fn polished(parts: &[Part], w: &DVector<f64>) -> Option<DVector<f64>> {
    let near = (1.0 - NEAR) * largest(parts, w);
    if near.is_infinite() {
        return None;
    }
    let mut active: Vec<&Part> = parts.iter().filter(|part| part.ratio(w) >= near).collect();
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

/// w and y with |T_k| = s L_k for all parts, Σ y_k (Z_kᵀ T_k − s² L_k ∇L_k) = 0, Σ y_k L_k² = 1, by Newton's method from w on.
fn stationary(parts: &[&Part], w: &DVector<f64>) -> Option<(DVector<f64>, DVector<f64>)> {
    let (d, m) = (w.len(), parts.len());
    let mut w = w.clone();
    let mut s = parts.iter().map(|part| part.ratio(&w)).fold(0.0, f64::max);
    let mut multipliers = DVector::from_element(m, 1.0 / m as f64);
    for _ in 0..NEWTON_STEPS {
        let mut matrix = DMatrix::zeros(d + m + 1, d + m + 1);
        let mut right = DVector::zeros(d + m + 1);
        right[d + m] = 1.0;
        for (i, part) in parts.iter().enumerate() {
            let (at, limit, rises) = (part.at(&w), part.limit.at(&w), &part.limit.slope);
            let (y, slope) = (multipliers[i], part.idle.tr_mul(&at) - s * s * limit * rises);
            let mut curved = matrix.view_mut((0, 0), (d, d));
            curved += y * (part.idle.tr_mul(&part.idle) - s * s * rises * rises.transpose());
            matrix.view_mut((0, d + i), (d, 1)).copy_from(&slope);
            matrix.view_mut((d + i, 0), (1, d)).copy_from(&slope.transpose());
            let mut by_ratio = matrix.view_mut((0, d + m), (d, 1));
            by_ratio -= 2.0 * s * y * limit * rises;
            let mut weighed = matrix.view_mut((d + m, 0), (1, d));
            weighed += 2.0 * y * limit * rises.transpose();
            matrix[(d + i, d + m)] = -s * limit * limit;
            matrix[(d + m, d + i)] = limit * limit;
            let mut missed = right.rows_mut(0, d);
            missed -= y * slope;
            right[d + i] = 0.5 * ((s * limit).powi(2) - at.norm_squared());
            right[d + m] -= y * limit * limit;
        }
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

/// Below this no w has its largest ratio: Σ |T|/Σ L along the directions of T, with weights for which w has no part in it.
fn bound_below(parts: &[&Part], w: &DVector<f64>, multipliers: &DVector<f64>) -> f64 {
    let s = parts.iter().map(|part| part.ratio(w)).fold(0.0, f64::max);
    let (mut slope, mut forces, mut limits) = (DVector::zeros(w.len()), 0.0, 0.0);
    for (part, y) in parts.iter().zip(multipliers.iter()) {
        let force = part.at(w);
        let weight = y * force.norm();
        slope += weight * part.along(&force.normalize(), s).slope;
        forces += weight * force.norm();
        limits += weight * part.limit.at(w);
    }
    (forces - slope.dot(w).abs()) / limits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(force: DVector<f64>, idle: DMatrix<f64>, limit: f64) -> Part {
        let limit = Bound { slope: DVector::zeros(idle.ncols()), value: limit };
        Part { force, idle, limit }
    }

    fn part(force: &[f64], idle: &[&[f64]], limit: f64) -> Part {
        let rows = DMatrix::from_fn(idle.len(), idle[0].len(), |i, j| idle[i][j]);
        fixed(DVector::from_column_slice(force), rows, limit)
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
        let one = DMatrix::from_column_slice(2, 1, &[-0.14562399883500696, 1.866863440011213e-17]);
        let other = DMatrix::from_column_slice(2, 1, &[0.14562399883500698, -1.8094811928646528e-28]);
        let feet = [
            fixed(DVector::from_vec(vec![-1.427212141897822, -0.28931022396251604]), one, 1.0),
            fixed(DVector::from_vec(vec![-1.427212141897822, -0.2893102239625161]), other, 1.0),
        ];
        let w = least_largest(&feet).expect("a share");
        assert!(w.amax() < 1e-9, "{w}");
    }
    /// A ladder of weight 1 at an angle α from the vertical, T on the wall upwards: N_wall = ½ tan α - T tan α, N_floor = 1 - T, T_floor = N_wall. The
    /// largest angle at which it stands is the one of two limits at once, tan α = 2 μ_f/(1 - μ_f μ_w).
    #[test]
    fn a_ladder_leans_as_far_as_both_limits_let_it() {
        let ladder = |tan: f64, floor: f64, wall: f64| {
            let row = |force: f64, idle: f64| (DVector::from_element(1, force), DMatrix::from_element(1, 1, idle));
            let limit = |value: f64, slope: f64| Bound { slope: DVector::from_element(1, slope), value };
            let (held_by_floor, held_by_wall) = (row(0.5 * tan, -tan), row(0.0, 1.0));
            [
                Part { force: held_by_floor.0, idle: held_by_floor.1, limit: limit(floor, -floor) },
                Part { force: held_by_wall.0, idle: held_by_wall.1, limit: limit(0.5 * wall * tan, -wall * tan) },
            ]
        };
        for (floor, wall) in [(0.4, 0.5), (0.3, 0.3), (0.5, 0.01), (1e-3, 10.0)] {
            let tan = 2.0 * floor / (1.0 - floor * wall);
            assert!((least(&ladder(tan, floor, wall)) - 1.0).abs() < 1e-12, "{}", least(&ladder(tan, floor, wall)));
            // Of a steeper one both need as much: s with tan = 2 s μ_f/(1 - s² μ_f μ_w).
            let s = least(&ladder(0.6 * tan, floor, wall));
            assert!((2.0 * s * floor / (1.0 - s * s * floor * wall) - 0.6 * tan).abs() < 1e-12 * tan, "{s}");
        }
    }

    /// Jaws that squeeze by 1 more for each w, and hold 3 together: with μ = 2 they can hold whatever they like.
    #[test]
    fn what_jams_is_pressed_as_hard_as_it_needs() {
        let jaw = |load: f64| Part {
            force: DVector::from_vec(vec![load, 0.5]),
            idle: DMatrix::from_column_slice(2, 1, &[0.0, 1.0]),
            limit: Bound { slope: DVector::from_element(1, 2.0), value: 1e-3 },
        };
        let jaws = [jaw(1.5), jaw(-1.5)];
        // |T|/L falls to 1/2: three quarters are held.
        assert!((least(&jaws) - 0.75).abs() < 1e-12, "{}", least(&jaws));
    }
}
