//! What a start is to meet beside constraints.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::start::{Closing, MISSED};
use crate::cause::Cause;
use crate::matrix::svd;
use crate::mechanism::{At, System};

/// Gauss's and Newton's iterations at most.
const ITERATIONS: usize = 500;
/// Combinations of rows, each of size 1, that are below this are none.
const DEPENDENT: f64 = 1e-10;
/// Differences that steer are taken over this part of a coordinate's size.
const APART: f64 = 1e-6;

impl<S: System + ?Sized> Closing<'_, S> {
    /// Moves on to what the start is to meet beside constraints, by least steps (Gauss and Newton; differences only
    /// steer).
    pub fn start_conditions(&self, y: &mut [f64], range: Range<usize>) -> Result<(), Box<Cause>> {
        let free: Vec<usize> = (0..2 * self.n).filter(|i| !self.held[*i]).collect();
        let pairs = self.system.start_conditions(At::packed(self.t, y, self.n));
        let wanted = self.wanted(&pairs[range.clone()]);
        // An energy does not change with speeds where these vanish: something has to move.
        let differs = |(value, wanted): &(f64, f64)| (value - wanted).abs() > MISSED * value.abs().max(wanted.abs());
        if y[self.n..].iter().all(|v| *v == 0.0) && pairs[range.clone()].iter().any(differs) {
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
            let halves = std::iter::successors(Some(1.0), |part| Some(0.5 * part)).take_while(|part| *part > 1e-6);
            let moved = |part: f64| {
                let mut tried = y.to_vec();
                free.iter().zip(step.iter()).for_each(|(i, s)| tried[*i] -= part * s * sizes[*i]);
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
            Some(k) => {
                let constraint = format!("also, its equation {}", k - first + 1);
                Err(Cause::StartMissesConstraint { constraint, residual: left[k] }.into())
            }
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
            slopes.set_column(i, &((self.values(&moved, range) - &here) / (APART * size)));
        }
        slopes
    }
}
