//! Shortest Gauss-Newton steps.

use nalgebra::{DMatrix, DVector};

use crate::matrix::svd;

/// Between the singular values that count and those that do not lie at least so many decades: slopes are known to some eleven digits, and
/// directions that change nothing are seen thirteen decades below the others.
pub(super) const GAP: f64 = 1e-6;

/// A linearised system in scaled unknowns, J x = −r, by its singular values.
#[derive(Clone)]
pub(crate) struct Linearised {
    u: DMatrix<f64>,
    sigma: DVector<f64>,
    /// Right singular vectors, a column each, all of them.
    v: DMatrix<f64>,
    rank: usize,
}

impl Linearised {
    /// Of J with rows divided by their norms and columns in units of the unknowns' scales, as the caller gives it; slopes that are no numbers
    /// tell of no direction.
    pub fn new(j: &DMatrix<f64>) -> Linearised {
        let (rows, columns) = j.shape();
        // With as many rows as columns at least, all directions have a singular value.
        let all = rows.max(columns);
        let svd = svd(j.clone().resize_vertically(all, 0.0), true, true)
            .unwrap_or_else(|| DMatrix::zeros(all, columns).svd(true, true));
        let (sigma, v) = (svd.singular_values, svd.v_t.unwrap_or_default().transpose());
        let u = svd.u.unwrap_or_default().rows(0, rows).into_owned();
        let rank = (0..sigma.len()).find(|k| {
            let before = if *k == 0 { f64::INFINITY } else { sigma[k - 1] };
            sigma[*k] == 0.0 || sigma[*k] <= GAP * before.min(f64::MAX) && *k > 0
        });
        let rank = rank.unwrap_or(sigma.len());
        Linearised { u, sigma, v, rank }
    }

    /// The same with another number of directions in which nothing changes.
    pub fn with_free(mut self, count: usize) -> Linearised {
        let nonzero = self.sigma.iter().filter(|sigma| **sigma > 0.0).count();
        self.rank = self.sigma.len().saturating_sub(count).min(nonzero);
        self
    }

    /// With so many directions at least: those that changed something at other values do not stop to at a root.
    pub fn at_least(mut self, rank: usize) -> Linearised {
        let nonzero = self.sigma.iter().filter(|sigma| **sigma > 0.0).count();
        self.rank = self.rank.max(rank.min(nonzero));
        self
    }

    /// Without the directions that change no more than this.
    pub fn beyond(mut self, least: f64) -> Linearised {
        self.rank = self.sigma.iter().take(self.rank).filter(|sigma| **sigma > least).count();
        self
    }

    /// How many directions change something.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// The largest singular value; 0 of none.
    pub fn strongest(&self) -> f64 {
        self.sigma.iter().copied().next().unwrap_or(0.0)
    }

    /// The smallest singular value that counts, u σ vᵀ.
    pub fn weakest(&self) -> Option<(DVector<f64>, f64, DVector<f64>)> {
        let k = self.rank.checked_sub(1)?;
        Some((self.u.column(k).into_owned(), self.sigma[k], self.v.column(k).into_owned()))
    }

    /// Without that direction.
    pub fn without_weakest(&self) -> Linearised {
        Linearised { rank: self.rank.saturating_sub(1), ..self.clone() }
    }

    /// The shortest x for which |J x + r| is least.
    ///
    /// Source: Deuflhard, Newton Methods for Nonlinear Problems (2004), section 4.3.
    pub fn step(&self, r: &DVector<f64>) -> DVector<f64> {
        let mut x = DVector::zeros(self.v.nrows());
        for k in 0..self.rank {
            let share = -self.u.column(k).dot(r) / self.sigma[k];
            x.axpy(share, &self.v.column(k), 1.0);
        }
        x
    }

    /// Directions in which nothing changes, of unit length.
    pub fn free(&self) -> Vec<DVector<f64>> {
        (self.rank..self.sigma.len()).map(|k| self.v.column(k).into_owned()).collect()
    }

    /// (JᵀJ)⁻¹ in the directions that count.
    pub fn covariance(&self) -> DMatrix<f64> {
        let n = self.v.nrows();
        let mut sum = DMatrix::zeros(n, n);
        for k in 0..self.rank {
            let v = self.v.column(k);
            sum += v * v.transpose() / (self.sigma[k] * self.sigma[k]);
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_shortest_and_free_directions_are_told() {
        // x + y = 2 from (0, 0): (1, 1), with (1, −1) free.
        let mut undefined = DMatrix::from_element(3, 3, 1.0);
        undefined[(1, 1)] = f64::NAN;
        assert_eq!(Linearised::new(&undefined).rank(), 0);
        let linear = Linearised::new(&DMatrix::from_row_slice(1, 2, &[1.0, 1.0]));
        let step = linear.step(&DVector::from_element(1, -2.0));
        assert!((step - DVector::from_element(2, 1.0)).norm() < 1e-14);
        let free = linear.free();
        assert_eq!(free.len(), 1);
        assert!((free[0][0] + free[0][1]).abs() < 1e-14);
        // A direction eleven decades below is none; one of three decades is.
        let linear = Linearised::new(&DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 1e-11]));
        assert_eq!(linear.free().len(), 1);
        let linear = Linearised::new(&DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, 1e-3]));
        assert!(linear.free().is_empty());
    }
}
