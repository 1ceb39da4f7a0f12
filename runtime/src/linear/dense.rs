//! Dense decompositions: nalgebra's, and for large matrices faer's, which is many times faster there, where the crate
//! has it (feature `modal`).

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// Matrices of more rows are large.
#[cfg(feature = "modal")]
const LARGE: usize = 80;

/// Eigenvalues and orthonormal eigenvectors, as columns, of a symmetric matrix, in no order; `None` where the
/// iteration does not end.
pub(super) fn symmetric_eigen(matrix: DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    #[cfg(feature = "modal")]
    if n > LARGE {
        let solved = from_nalgebra(&matrix).self_adjoint_eigen(faer::Side::Lower).ok()?;
        let values = DVector::from_fn(n, |k, _| solved.S()[k]);
        return Some((values, DMatrix::from_fn(n, n, |i, k| solved.U()[(i, k)])));
    }
    let solved = SymmetricEigen::try_new(matrix, f64::EPSILON, 100 * n.max(10))?;
    Some((solved.eigenvalues, solved.eigenvectors))
}

/// A = U diag(values) Vᵀ of a square matrix.
pub(super) struct Singular {
    u: DMatrix<f64>,
    pub values: DVector<f64>,
    pub v: DMatrix<f64>,
}

impl Singular {
    /// `None` where the iteration does not end.
    pub fn of(matrix: &DMatrix<f64>) -> Option<Singular> {
        let n = matrix.nrows();
        #[cfg(feature = "modal")]
        if n > LARGE {
            let solved = from_nalgebra(matrix).svd().ok()?;
            let dense = |from: faer::MatRef<'_, f64>| DMatrix::from_fn(n, n, |i, k| from[(i, k)]);
            let values = DVector::from_fn(n, |k, _| solved.S()[k]);
            return Some(Singular { u: dense(solved.U()), values, v: dense(solved.V()) });
        }
        let solved = matrix.clone().try_svd(true, true, f64::EPSILON, 0)?;
        let (u, v_t) = solved.u.zip(solved.v_t).unwrap_or_else(|| (DMatrix::identity(n, n), DMatrix::identity(n, n)));
        Some(Singular { u, values: solved.singular_values, v: v_t.transpose() })
    }

    /// The shortest x that minimises |A x − b|; singular values up to a threshold count as 0.
    pub fn least_squares(&self, b: &DVector<f64>, threshold: f64) -> DVector<f64> {
        let mut parts = self.u.tr_mul(b);
        for (part, value) in parts.iter_mut().zip(self.values.iter()) {
            *part = if *value > threshold { *part / value } else { 0.0 };
        }
        &self.v * parts
    }

    /// Columns of V whose singular values fulfil a condition.
    pub fn directions(&self, keep: impl Fn(f64) -> bool) -> DMatrix<f64> {
        let kept: Vec<DVector<f64>> =
            (0..self.values.len()).filter(|k| keep(self.values[*k])).map(|k| self.v.column(k).into_owned()).collect();
        if kept.is_empty() { DMatrix::zeros(self.v.nrows(), 0) } else { DMatrix::from_columns(&kept) }
    }
}

#[cfg(feature = "modal")]
fn from_nalgebra(matrix: &DMatrix<f64>) -> faer::Mat<f64> {
    faer::Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same for small and for large matrices, of deficient rank too.
    #[test]
    fn decompositions_are_right_at_any_size() {
        for n in [3, 120] {
            let matrix = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 if i == 0 || i == n - 1 => 1.0,
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            let (values, vectors) = symmetric_eigen(matrix.clone()).unwrap();
            let back = &vectors * DMatrix::from_diagonal(&values) * vectors.transpose();
            assert!((&back - &matrix).amax() < 1e-13);
            let singular = Singular::of(&matrix).unwrap();
            let back = &singular.u * DMatrix::from_diagonal(&singular.values) * singular.v.transpose();
            assert!((&back - &matrix).amax() < 1e-13);
            let null = singular.directions(|value| value < 1e-12);
            assert!(null.ncols() == 1 && (null[(0, 0)].abs() - 1.0 / (n as f64).sqrt()).abs() < 1e-12);
            let b = DVector::from_fn(n, |i, _| if i == 0 { 1.0 } else { -1.0 / (n as f64 - 1.0) });
            let x = singular.least_squares(&b, 1e-12);
            assert!((&matrix * &x - &b).amax() < 1e-12 && x.sum().abs() < 1e-9);
        }
    }
}
