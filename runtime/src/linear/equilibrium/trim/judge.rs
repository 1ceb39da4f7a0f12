//! Whether what was found is a rest, and what of it is determined.

use nalgebra::{DMatrix, DVector};

use super::super::least_steps::{BALANCED, Rest};
use super::search::Search;
use crate::linear::{LinearError, Residual};
use crate::matrix::{equilibrated, solve_least, svd};
use crate::mechanism::dense::multiplier_effects;

/// Directions in which slopes, brought to one size, are below this part of the largest change nothing: nine digits of the slopes are
/// lost there, and of what they give some six would be left.
const UNDETERMINED: f64 = 1e-9;
/// A value that rounding of forces leaves no three digits of, beside the larger of itself and of where its search began, changes
/// nothing but rounding.
const UNKNOWN: f64 = 1e-3;
/// What has less than this part of such a direction, or of what is left, takes no part in it.
const TAKES_PART: f64 = 1e-6;
/// So many roundings of its terms are left of an equation.
const ROUNDINGS: f64 = 4.0;

impl Search {
    /// What is left of forces and, by the names of rows, of constraints.
    pub(super) fn forces_left(&self) -> Vec<Residual> {
        let left = self.left();
        let mut residual = self.base.forces(&left[..self.base.n]);
        residual.retain(|left| left.force != 0.0);
        let system = self.base.system.borrow();
        let missed = self.closed.iter().zip(&left[self.base.n..]).filter(|(_, left)| **left != 0.0);
        residual.extend(missed.map(|((row, _), left)| Residual {
            coordinate: system.description().rows[*row].name.to_string(),
            force: *left,
            unit: String::new(),
        }));
        residual
    }

    pub(super) fn nowhere(&self, iterations: usize) -> LinearError {
        LinearError::NoEquilibrium { iterations, point: self.place(), residual: self.forces_left() }
    }

    /// Refuses what is no rest, and values that nothing determines.
    pub(super) fn diagnosed(&self, iterations: usize) -> Result<(), LinearError> {
        if !self.is_met(BALANCED) {
            let holds = self.in_the_way();
            let unknowns = self.unknowns.iter().map(|unknown| self.name(*unknown)).collect();
            return Err(match holds.is_empty() {
                true => self.nowhere(iterations),
                false => LinearError::CannotHold { holds, unknowns, point: self.place(), residual: self.forces_left() },
            });
        }
        let (scaled, _, _) = equilibrated(&self.slopes_beside_rounding());
        let wide = scaled.ncols().saturating_sub(scaled.nrows());
        let rows = scaled.nrows() + wide;
        // Rows of zeros, so that all directions in which nothing changes are among those of the decomposition.
        let solved = svd(scaled.resize_vertically(rows, 0.0), false, true);
        let failed = LinearError::NoConvergence { what: "the singular value decomposition of the slopes" };
        let (values, directions) = solved.and_then(|svd| Some((svd.singular_values, svd.v_t?))).ok_or(failed)?;
        let (first, most) = (directions.ncols() - self.unknowns.len(), values.max());
        let free = (0..values.len()).filter(|k| values[*k] <= UNDETERMINED * most);
        let takes_part = |direction: usize, column: usize| directions[(direction, column)].abs() > TAKES_PART;
        for direction in free {
            let moving = (0..self.unknowns.len()).filter(|k| takes_part(direction, first + k));
            let unknowns: Vec<String> = moving.map(|k| self.name(self.unknowns[k])).collect();
            if !unknowns.is_empty() {
                let along = self.free.iter().enumerate().filter(|(column, _)| takes_part(direction, *column));
                return Err(LinearError::Undetermined {
                    unknowns,
                    along: along.map(|(_, i)| self.coordinate(*i)).collect(),
                });
            }
        }
        Ok(())
    }

    /// The slopes, without those that rounding of an equation's terms makes; of something sought the last ones stay: whether they say
    /// what it is, its uncertainty tells.
    fn slopes_beside_rounding(&self) -> DMatrix<f64> {
        let (mut slopes, measures) = (self.slopes(), self.measures());
        let places = self.sizes();
        let places = self.free.iter().map(|i| places[*i]);
        let others = self.unknowns().into_iter().skip(self.free.len()).map(f64::abs);
        let first = slopes.ncols() - self.unknowns.len();
        for (index, size) in places.chain(others).enumerate().filter(|(_, size)| *size > 0.0) {
            let rounding = |(slope, measure): (&f64, &f64)| (slope * size).abs() <= ROUNDINGS * f64::EPSILON * measure;
            let rounding: Vec<bool> = slopes.column(index).iter().zip(&measures).map(rounding).collect();
            if index >= first && rounding.iter().all(|rounding| *rounding) {
                continue;
            }
            let column = slopes.column_mut(index).into_iter().zip(rounding);
            column.filter(|(_, rounding)| *rounding).for_each(|(slope, _)| *slope = 0.0);
        }
        slopes
    }

    /// What is held, and would move if it were not, towards less of what is left.
    pub(super) fn in_the_way(&self) -> Vec<String> {
        let weights = self.measures();
        let part = |(left, measure): (f64, &f64)| if left == 0.0 { 0.0 } else { left / measure };
        let left = DVector::from_vec(self.left().into_iter().zip(&weights).map(part).collect());
        let slopes = self.by_place();
        let eases = |i: &&usize| {
            let column =
                DVector::from_fn(left.len(), |row, _| slopes[(row, **i)] / weights[row].max(f64::MIN_POSITIVE));
            left.dot(&column).abs() > TAKES_PART * left.norm() * column.norm()
        };
        self.held.iter().filter(eases).map(|i| self.coordinate(*i)).collect()
    }

    /// Adds what multipliers, which balance as much as they can, make of the rounding of one force in others.
    pub(super) fn pass_on(&self, measures: &mut [f64]) {
        let n = self.base.n;
        let effects = multiplier_effects(&**self.base.system.borrow(), self.at(), &self.rows);
        let Some(inverse) = solve_least(&effects, &DMatrix::identity(n, n)).filter(|_| !self.rows.is_empty()) else {
            return;
        };
        let passed = (&effects * inverse).abs() * DVector::from_column_slice(&measures[..n]);
        let carried = self.lambda.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let all = passed.iter().zip(effects.row_iter()).map(|(passed, row)| passed + carried * row.lp_norm(1));
        measures.iter_mut().zip(all).for_each(|(sum, passed)| *sum += passed);
    }

    /// What rounding of forces and constraints makes of each value.
    pub(super) fn uncertainties(&self) -> Vec<f64> {
        let (slopes, measures) = (self.slopes_beside_rounding(), self.measures());
        let inverse = solve_least(&slopes, &DMatrix::identity(slopes.nrows(), slopes.nrows()));
        let first = slopes.ncols() - self.unknowns.len();
        let rounding = |k: usize| {
            let of = |inverse: &DMatrix<f64>| {
                inverse.row(first + k).iter().zip(&measures).map(|(x, measure)| (x * measure).abs()).sum::<f64>()
            };
            ROUNDINGS * f64::EPSILON * inverse.as_ref().map_or(f64::INFINITY, of)
        };
        (0..self.unknowns.len()).map(rounding).collect()
    }

    /// What rounding makes of each value; refuses one that it leaves no digits of, and one that is 0 as far as it is known and does not serve as 0.
    pub(super) fn known_uncertainties(&mut self, from: &[f64]) -> Result<Vec<f64>, LinearError> {
        let uncertainties = self.uncertainties();
        let nothing: Vec<bool> = (0..from.len()).map(|k| self.values[k].abs() <= uncertainties[k]).collect();
        if let Some(error) = self.left_without(&nothing) {
            return Err(error);
        }
        let unknown =
            |k: &usize| from[*k] != 0.0 && uncertainties[*k] > UNKNOWN * from[*k].abs().max(self.values[*k].abs());
        match (0..from.len()).find(unknown) {
            Some(k) => {
                Err(LinearError::Undetermined { unknowns: vec![self.name(self.unknowns[k])], along: Vec::new() })
            }
            None => Ok(uncertainties),
        }
    }

    /// Why it does not rest with 0 in the place of these values; `None` where it does.
    fn left_without(&mut self, nothing: &[bool]) -> Option<LinearError> {
        let found = self.unknowns();
        let mut without = found.clone();
        let first = without.len() - nothing.len();
        without[first..].iter_mut().zip(nothing).filter(|(_, nothing)| **nothing).for_each(|(value, _)| *value = 0.0);
        self.set(&without);
        let error = (!self.is_met(BALANCED)).then(|| LinearError::CannotHold {
            holds: self.held.iter().map(|i| self.coordinate(*i)).collect(),
            unknowns: self.unknowns.iter().map(|unknown| self.name(*unknown)).collect(),
            point: self.place(),
            residual: self.forces_left(),
        });
        self.set(&found);
        error
    }
}
