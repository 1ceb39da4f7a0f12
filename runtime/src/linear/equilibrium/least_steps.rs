//! Newton's method by least steps, for rests of which there may be many.

use nalgebra::DMatrix;

use crate::linear::matrices::{first_part, is_lost};
use crate::matrix::solve_least;

/// Newton's method gives up after so many steps.
const ITERATIONS: usize = 100;
/// A step is halved down to this part of itself: what is no better by then is no better but by rounding.
const SHORTEST: f64 = 1e-9;
/// An equation holds where no more than this part of its terms is left; what Newton's method ends with has some roundings.
pub(super) const BALANCED: f64 = 1e-9;
/// Below so many roundings of its terms an equation is not improved.
const EXACT: f64 = 4.0 * f64::EPSILON;
/// What has become smaller than this part of all that it was is 0, if that is a rest too.
const GONE: f64 = 1e-12;

/// Equations of a rest, at some values of what is sought.
pub(super) trait Rest {
    /// What is sought.
    fn unknowns(&self) -> Vec<f64>;

    /// Goes to other values.
    fn set(&mut self, unknowns: &[f64]);

    /// The units of those that are coordinates, which come first.
    fn units(&self) -> Vec<String>;

    /// What is left of each equation.
    fn left(&self) -> Vec<f64>;

    /// The sizes of their terms.
    fn measures(&self) -> Vec<f64>;

    /// The slopes of [`Rest::left`] by the unknowns.
    fn slopes(&self) -> DMatrix<f64>;

    /// The largest part of its terms that is left of an equation; NaN where one is no number.
    fn residual(&self) -> f64 {
        let part = |(left, measure): (f64, f64)| if left == 0.0 { 0.0 } else { left.abs() / measure };
        let larger = |most: f64, part: f64| if part.is_nan() || part > most { part } else { most };
        self.left().into_iter().zip(self.measures()).map(part).fold(0.0, larger)
    }

    /// Whether no equation has more than this part of its terms left.
    fn is_met(&self, part: f64) -> bool {
        self.residual() <= part
    }

    /// Newton's method by least steps, halved until the equations are better met; how many steps there were.
    ///
    /// # Errors
    /// After how many steps there are no slopes, or no step.
    fn newton(&mut self) -> Result<usize, usize> {
        let mut reach: Vec<f64> = self.unknowns().iter().map(|x| x.abs()).collect();
        let mut iterations = 0;
        while iterations < ITERATIONS && !self.is_met(EXACT) {
            let slopes = self.slopes();
            if slopes.iter().any(|x| !x.is_finite()) || is_lost(&self.units(), &self.unknowns()) {
                return Err(iterations);
            }
            // What nothing that is sought changes cannot be better met.
            let weight = |most: f64| if most > 0.0 { 1.0 / most } else { 0.0 };
            let weights: Vec<f64> = slopes.row_iter().map(|row| weight(row.amax())).collect();
            let size = |left: &[f64]| left.iter().zip(&weights).map(|(f, w)| (f * w).powi(2)).sum::<f64>();
            // What is met to rounding is left alone: slopes that are rounding, too, would make any step of it.
            let measures = self.measures();
            let unmet = |left: Vec<f64>| -> Vec<f64> {
                let unmet = |(f, measure): (f64, &f64)| if f.abs() <= EXACT * measure { 0.0 } else { f };
                left.into_iter().zip(&measures).map(unmet).collect()
            };
            let left = unmet(self.left());
            let step = solve_least(&slopes, &DMatrix::from_column_slice(left.len(), 1, &left)).ok_or(iterations)?;
            let (from, before) = (self.unknowns(), size(&left));
            let first = first_part(&self.units(), &from, step.as_slice());
            let mut part = first;
            loop {
                let tried: Vec<f64> = from.iter().zip(step.iter()).map(|(x, step)| x - part * step).collect();
                self.set(&tried);
                if size(&unmet(self.left())) < before {
                    break;
                }
                part *= 0.5;
                if part < SHORTEST * first {
                    self.set(&from);
                    return Ok(iterations);
                }
            }
            iterations += 1;
            reach.iter_mut().zip(self.unknowns()).for_each(|(reach, x)| *reach = reach.max(x.abs()));
            self.without_rounding(&reach);
        }
        Ok(iterations)
    }

    /// Sets to 0 what has all but vanished, beside all that it was or, as what was 0 before a step and should have stayed so, beside the others, if
    /// that is a rest too.
    fn without_rounding(&mut self, reach: &[f64]) {
        let from = self.unknowns();
        let gone = |(x, reach): (&f64, &f64)| if x.abs() <= GONE * reach { 0.0 } else { *x };
        let largest = vec![reach.iter().fold(0.0_f64, |most, x| most.max(*x)); reach.len()];
        for beside in [&largest, reach] {
            let clean: Vec<f64> = from.iter().zip(beside).map(gone).collect();
            if clean == from {
                return;
            }
            self.set(&clean);
            if self.is_met(EXACT) {
                return;
            }
            self.set(&from);
        }
    }
}
