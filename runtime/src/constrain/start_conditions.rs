//! What a start is to meet beside constraints.
//!
//! Equations without speeds that are free go to the place, with the constraints; the others to the speeds at that place.  Where these lead nowhere
//! both move together.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::start::{CLOSED, Closing, MISSED, ROUNDED};
use crate::cause::Cause;
use crate::matrix::svd;
use crate::mechanism::dense::mass_matrix;
use crate::mechanism::{Along, At, Function, System};

/// Gauss's and Newton's iterations at most.
const ITERATIONS: usize = 500;
/// Combinations of rows, each of size 1, that are below this are none.
const DEPENDENT: f64 = 1e-10;
/// Differences that steer are taken over this part of a coordinate's size.
const APART: f64 = 1e-6;
/// A step that makes what is left no less is halved down to this part of it.
const SHORTEST: f64 = 1e-6;

/// The equations that a start is to meet beside constraints, by their places in `System::start_conditions`.
pub(super) struct Conditions {
    range: Range<usize>,
    /// Those that no free speed changes.
    pub of_places: Vec<usize>,
    /// The others.
    pub of_speeds: Vec<usize>,
}

impl Conditions {
    /// With which of [q; q'] keep their values.
    pub fn new<S: System + ?Sized>(system: &S, range: Range<usize>, held: &[bool]) -> Self {
        let speeds = if range.is_empty() { Vec::new() } else { system.start_condition_speeds() };
        let moves = |k: &usize| speeds.iter().any(|(of, i)| *of as usize == *k && !held[system.len() + *i as usize]);
        let (of_speeds, of_places) = range.clone().partition(moves);
        Conditions { range, of_places, of_speeds }
    }

    pub fn is_empty(&self) -> bool {
        self.range.is_empty()
    }
}

/// Slopes by which of a state.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum By {
    Places,
    Speeds,
}

impl<S: System + ?Sized> Closing<'_, S> {
    /// What is left of equations of the start at a state.
    pub fn left(&self, y: &[f64], equations: &[usize]) -> DVector<f64> {
        if equations.is_empty() {
            return DVector::zeros(0);
        }
        let mut turned = y.to_vec();
        self.spin(&mut turned);
        let pairs = self.system.start_conditions(At::packed(self.t, &turned, self.n));
        DVector::from_iterator(equations.len(), equations.iter().map(|k| pairs[*k].0 - pairs[*k].1))
    }

    /// Their slopes by all places, which kept angular velocities go with, or by all speeds.
    pub fn slopes_of(&self, y: &[f64], equations: &[usize], by: By) -> DMatrix<f64> {
        let n = self.n;
        let mut slopes = DMatrix::zeros(equations.len(), n);
        if equations.is_empty() {
            return slopes;
        }
        let mut turned = y.to_vec();
        self.spin(&mut turned);
        let at = At::packed(self.t, &turned, n);
        let mut values = vec![0.0; self.system.start_conditions(at).len()];
        for i in 0..n {
            let (mut q, mut v) = (vec![0.0; n], vec![0.0; n]);
            match by {
                By::Places => {
                    q[i] = 1.0;
                    let carried = self.spins.iter().filter(|spin| spin.places().contains(&i));
                    carried.for_each(|spin| spin.slopes((y, &q), None, &mut v));
                }
                By::Speeds => v[i] = 1.0,
            }
            self.system.slopes(Function::StartConditions, at, &Along { q: &q, v: &v, ..Along::default() }, &mut values);
            equations.iter().enumerate().for_each(|(row, k)| slopes[(row, i)] = values[*k]);
        }
        slopes
    }

    /// What equations of the start are made of: their values, and what the state changes of them.
    pub fn terms_of(&self, y: &[f64], equations: &[usize]) -> DVector<f64> {
        if equations.is_empty() {
            return DVector::zeros(0);
        }
        let (q, v) = y.split_at(self.n);
        let pairs = self.system.start_conditions(At::packed(self.t, y, self.n));
        let size = |list: &[f64]| DVector::from_row_slice(list).abs();
        let moved = self.slopes_of(y, equations, By::Places).abs() * size(q)
            + self.slopes_of(y, equations, By::Speeds).abs() * size(v);
        let own = |(k, moved): (&usize, &f64)| pairs[*k].0.abs().max(pairs[*k].1.abs()).max(*moved);
        DVector::from_iterator(equations.len(), equations.iter().zip(moved.iter()).map(own))
    }

    /// ∂²/∂q∂q_i of equations of places, each times its multiplier, from differences: it only steers.
    pub fn bent_by(&self, y: &[f64], i: usize, size: f64, multipliers: &[f64]) -> DVector<f64> {
        let of_places = &self.conditions.of_places;
        let slopes = |side: f64| {
            let mut moved = y.to_vec();
            moved[i] += side * APART * size;
            self.slopes_of(&moved, of_places, By::Places)
        };
        let difference = (slopes(1.0) - slopes(-1.0)) / (2.0 * APART * size);
        difference.transpose() * DVector::from_row_slice(multipliers)
    }

    /// Why a start is none: an equation that it misses.
    pub fn missed_condition(&self, equation: usize, residual: f64) -> Box<Cause> {
        let constraint = format!("also, its equation {}", equation - self.conditions.range.start + 1);
        Cause::StartMissesConstraint { constraint, residual }.into()
    }

    /// At a place, the speeds of least kinetic energy among those that meet constraints and equations: these are taken as they are linear about the last
    /// speeds, again and again.
    pub fn meet_by_speeds(&self, y: &mut [f64]) -> Result<(), Box<Cause>> {
        let (n, equations) = (self.n, &self.conditions.of_speeds);
        let mass = mass_matrix(self.system, At::packed(self.t, y, n));
        let energy = |v: &DVector<f64>| (v.transpose() * &mass * v)[(0, 0)].max(0.0).sqrt();
        let (mut seeded, mut last) = (false, f64::INFINITY);
        for _ in 0..ITERATIONS {
            let (left, terms) = (self.left(y, equations), self.terms_of(y, equations));
            if left.iter().any(|x| !x.is_finite()) {
                break;
            }
            let slopes = self.slopes_of(y, equations, By::Speeds);
            let still = |k: usize| (0..n).all(|i| self.held[n + i] || slopes[(k, i)] == 0.0);
            if (0..left.len()).any(|k| left[k].abs() > MISSED * terms[k] && still(k)) {
                // An energy does not change with speeds where these vanish: something has to move.
                if seeded {
                    break;
                }
                (0..n).filter(|i| !self.held[n + i]).for_each(|i| y[n + i] = 1.0);
                seeded = true;
                continue;
            }
            let from = y.to_vec();
            self.least_speeds(y, (&slopes, &left));
            let step = DVector::from_iterator(n, (n..2 * n).map(|i| y[i] - from[i]));
            let weigh = |left: &DVector<f64>| left.zip_map(&terms, |x, term| if term > 0.0 { x / term } else { x });
            let size = weigh(&left).norm().max(CLOSED);
            let halves = std::iter::successors(Some(1.0), |part| Some(0.5 * part));
            let goes = halves.take_while(|part| *part > SHORTEST).find(|part| {
                (0..n).for_each(|i| y[n + i] = from[n + i] + part * step[i]);
                weigh(&self.left(y, equations)).norm() <= size
            });
            let Some(part) = goes else {
                y.copy_from_slice(&from);
                break;
            };
            let moved = part * energy(&step);
            if moved <= ROUNDED * energy(&DVector::from_row_slice(&y[n..])) || moved > 0.5 * last && size <= CLOSED {
                break;
            }
            last = moved;
        }
        self.judge_conditions(y, equations)
    }

    /// Refuses a state that misses equations of the start.
    fn judge_conditions(&self, y: &[f64], equations: &[usize]) -> Result<(), Box<Cause>> {
        let (left, terms) = (self.left(y, equations), self.terms_of(y, equations));
        match (0..left.len()).find(|k| left[*k].is_nan() || left[*k].abs() > MISSED * terms[*k]) {
            Some(k) => Err(self.missed_condition(equations[k], left[k])),
            None => Ok(()),
        }
    }

    /// Moves on to all that the start is to meet by least steps of places and speeds (Gauss and Newton; differences only
    /// steer).
    pub fn least_steps(&self, y: &mut [f64]) -> Result<(), Box<Cause>> {
        let range = self.conditions.range.clone();
        let free: Vec<usize> = (0..2 * self.n).filter(|i| !self.held[*i]).collect();
        let pairs = self.system.start_conditions(At::packed(self.t, y, self.n));
        let wanted = self.wanted(&pairs[range.clone()]);
        // An energy does not change with speeds where these vanish: something has to move.
        let differs = |k: &usize| (pairs[*k].0 - pairs[*k].1).abs() > MISSED * pairs[*k].0.abs().max(pairs[*k].1.abs());
        if y[self.n..].iter().all(|v| *v == 0.0) && self.conditions.of_speeds.iter().any(differs) {
            free.iter().filter(|i| **i >= self.n).for_each(|i| y[*i] = 1.0);
        }
        let mut left = self.values(y, &range) - &wanted;
        let mut terms = wanted.abs();
        for _ in 0..ITERATIONS {
            if free.is_empty() || left.iter().any(|x| !x.is_finite()) {
                break;
            }
            let sizes = self.sizes(y);
            let slopes = self.slopes(y, &range, &sizes);
            terms = wanted.abs().sup(&(slopes.abs() * &sizes));
            let weigh = |left: &DVector<f64>| left.zip_map(&terms, |x, term| if term > 0.0 { x / term } else { x });
            // Every row counts as much, however much of it is still wanted.
            let mut weighted = DMatrix::from_fn(left.len(), free.len(), |k, j| slopes[(k, free[j])] * sizes[free[j]]);
            let mut right = left.clone();
            for (mut row, right) in weighted.row_iter_mut().zip(right.iter_mut()) {
                let norm = row.norm();
                if norm > 0.0 {
                    row.scale_mut(1.0 / norm);
                    *right /= norm;
                }
            }
            let Some(Ok(step)) = svd(weighted, true, true).map(|svd| svd.solve(&right, DEPENDENT)) else { break };
            let halves = std::iter::successors(Some(1.0), |part| Some(0.5 * part)).take_while(|part| *part > SHORTEST);
            let moved = |part: f64| {
                let mut tried = y.to_vec();
                free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] -= part * s * sizes[*i]);
                self.spin(&mut tried);
                let after = self.values(&tried, &range) - &wanted;
                (tried, after)
            };
            let size = weigh(&left).norm();
            let Some((tried, after)) = halves.map(moved).find(|(_, after)| weigh(after).norm() < size) else { break };
            y.copy_from_slice(&tried);
            left = after;
        }
        let first = left.len() - range.len();
        match (first..left.len()).find(|k| left[*k].is_nan() || left[*k].abs() > MISSED * terms[*k]) {
            Some(k) => Err(self.missed_condition(range.start + k - first, left[k])),
            None => Ok(()),
        }
    }

    /// c of the holonomic rows, c' of all, and what the start is to meet beside them.
    fn values(&self, y: &[f64], range: &Range<usize>) -> DVector<f64> {
        let (triples, pairs) = (self.triples(y), self.system.start_conditions(At::packed(self.t, y, self.n)));
        let place = self.holonomic.iter().map(|row| triples[*row][0]);
        let rate = self.rows.iter().map(|row| triples[*row][1]);
        DVector::from_vec(place.chain(rate).chain(pairs[range.clone()].iter().map(|pair| pair.0)).collect())
    }

    /// What those are to be.
    fn wanted(&self, pairs: &[(f64, f64)]) -> DVector<f64> {
        let zeros = std::iter::repeat_n(0.0, self.holonomic.len() + self.rows.len());
        DVector::from_vec(zeros.chain(pairs.iter().map(|pair| pair.1)).collect())
    }

    /// Their derivatives by [q; q'], from differences.
    fn slopes(&self, y: &[f64], range: &Range<usize>, sizes: &DVector<f64>) -> DMatrix<f64> {
        let here = self.values(y, range);
        let mut slopes = DMatrix::zeros(here.len(), y.len());
        for (i, size) in sizes.iter().enumerate() {
            let mut moved = y.to_vec();
            moved[i] += APART * size;
            self.spin(&mut moved);
            slopes.set_column(i, &((self.values(&moved, range) - &here) / (APART * size)));
        }
        slopes
    }
}
