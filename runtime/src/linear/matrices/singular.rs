//! The singular value decomposition, for ranks and least squares.

use nalgebra::{DMatrix, DVector};

use super::symmetric_eigen;
use crate::matrix::{is_symmetric, svd};

/// Large symmetric matrices go by their eigenvalues, which cost less.
const LARGE: usize = 60;

/// A = U diag(values) Vᵀ of a square matrix.
pub struct Singular {
    u: DMatrix<f64>,
    pub values: DVector<f64>,
    pub v: DMatrix<f64>,
}

impl Singular {
    /// `None` where the iteration does not end.
    pub fn of(matrix: &DMatrix<f64>) -> Option<Singular> {
        let n = matrix.nrows();
        if n > LARGE && is_symmetric(matrix) {
            let (values, v) = symmetric_eigen(matrix.clone())?;
            let mut u = v.clone();
            for (mut column, value) in u.column_iter_mut().zip(values.iter()) {
                column *= value.signum();
            }
            return Some(Singular { u, values: values.abs(), v });
        }
        let solved = svd(matrix.clone(), true, true)?;
        Some(Singular { u: solved.u?, values: solved.singular_values, v: solved.v_t?.transpose() })
    }

    /// The shortest x that minimises |A x − b|; singular values up to a threshold count as 0.
    pub fn least_squares(&self, b: &DVector<f64>, threshold: f64) -> DVector<f64> {
        let mut parts = self.u.tr_mul(b);
        for (part, value) in parts.iter_mut().zip(self.values.iter()) {
            *part = if *value > threshold { *part / value } else { 0.0 };
        }
        &self.v * parts
    }

    /// As [`Singular::least_squares`], with the matrix itself: the iteration ends where elements beside the diagonal are below √ε, which small ones of x
    /// would be made of (iterative refinement: Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 12.2).
    pub fn refined(&self, matrix: &DMatrix<f64>, b: &DVector<f64>, threshold: f64) -> DVector<f64> {
        let mut x = self.least_squares(b, threshold);
        let mut last = f64::INFINITY;
        loop {
            let step = self.least_squares(&(b - matrix * &x), threshold);
            let size = step.norm();
            // Rounding comes to rest.
            if size >= 0.5 * last || size == 0.0 || size.is_nan() {
                return x;
            }
            x += step;
            last = size;
        }
    }

    /// Columns of V whose singular values fulfil a condition.
    pub fn directions(&self, keep: impl Fn(f64) -> bool) -> DMatrix<f64> {
        let kept: Vec<DVector<f64>> =
            (0..self.values.len()).filter(|k| keep(self.values[*k])).map(|k| self.v.column(k).into_owned()).collect();
        if kept.is_empty() { DMatrix::zeros(self.v.nrows(), 0) } else { DMatrix::from_columns(&kept) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By its vectors alone x would be (0, 1): (1e-9)² is rounding beside 1.
    #[test]
    fn what_is_small_in_a_solution_has_digits_of_its_own() {
        for small in [1e-6, 1e-9, 1e-12] {
            let matrix = DMatrix::from_row_slice(2, 2, &[1.0, -small, 0.0, 1.0]);
            let singular = Singular::of(&matrix).unwrap();
            let x = singular.refined(&matrix, &DVector::from_vec(vec![0.0, 1.0]), 1e-14);
            assert!((x[0] - small).abs() < 1e-14 * small && (x[1] - 1.0).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn decompositions_are_right_at_any_size() {
        for n in [3, 120] {
            let matrix = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 if i == 0 || i == n - 1 => 1.0,
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            let singular = Singular::of(&matrix).unwrap();
            let back = &singular.u * DMatrix::from_diagonal(&singular.values) * singular.v.transpose();
            assert!((&back - &matrix).amax() < 1e-13);
            let null = singular.directions(|value| value < 1e-12);
            assert!(null.ncols() == 1 && (null[(0, 0)].abs() - 1.0 / (n as f64).sqrt()).abs() < 1e-12);
            let b = DVector::from_fn(n, |i, _| if i == 0 { 1.0 } else { -1.0 / (n as f64 - 1.0) });
            let x = singular.least_squares(&b, 1e-12);
            assert!((&matrix * &x - &b).amax() < 1e-11 && x.sum().abs() < 1e-9);
        }
    }
}
