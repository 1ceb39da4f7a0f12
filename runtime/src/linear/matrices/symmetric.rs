//! Eigenvalues of symmetric matrices.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use super::tridiagonal::tridiagonal_eigen;

/// Matrices of more rows are left to the tridiagonal form, which is faster and knows small eigenvalues less well.
const LARGE: usize = 60;
/// Jacobi's method needs some six sweeps, and a few more for matrices with entries of very different size.
const MOST_SWEEPS: usize = 40;

/// Eigenvalues and orthonormal eigenvectors, as columns, of a symmetric matrix, in no order; `None` where an element is no finite number, and
/// where the iteration of a large matrix does not end.
///
/// Jacobi's rotations for small matrices, of which what is left after [`MOST_SWEEPS`] is rounding: the least eigenvalues of a positive matrix are as exact as its entries, in
/// each row's own measure, beside 1e12 too (Demmel and Veselić 1992).
pub fn symmetric_eigen(matrix: DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if n > LARGE {
        if let Some(found) = tridiagonal_eigen(&matrix) {
            return Some(found);
        }
        let solved = SymmetricEigen::try_new(matrix, f64::EPSILON, 100 * n)?;
        return Some((solved.eigenvalues, solved.eigenvectors));
    }
    Some(jacobi(matrix))
}

fn jacobi(mut a: DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let n = a.nrows();
    let mut vectors = DMatrix::identity(n, n);
    for _ in 0..MOST_SWEEPS {
        let mut rotated = false;
        for p in 0..n {
            for q in p + 1..n {
                let off = a[(p, q)];
                let (x, y) = (a[(p, p)], a[(q, q)]);
                // Relative to both diagonal elements, not to the largest of all.
                if off == 0.0 || off.abs() <= 0.25 * f64::EPSILON * (x.abs().sqrt() * y.abs().sqrt()) {
                    continue;
                }
                rotated = true;
                let theta = 0.5 * (y - x) / off;
                let tangent = if theta.is_finite() {
                    let size = 1.0 / (theta.abs() + theta.hypot(1.0));
                    if theta < 0.0 { -size } else { size }
                } else {
                    0.0
                };
                let cosine = 1.0 / tangent.hypot(1.0);
                rotate(&mut a, &mut vectors, (p, q), (cosine, tangent * cosine));
                (a[(p, p)], a[(q, q)]) = (x - tangent * off, y + tangent * off);
                (a[(p, q)], a[(q, p)]) = (0.0, 0.0);
            }
        }
        if !rotated {
            break;
        }
    }
    (a.diagonal(), vectors)
}

/// JᵀAJ and VJ with a rotation J of the coordinates p and q.
fn rotate(a: &mut DMatrix<f64>, v: &mut DMatrix<f64>, (p, q): (usize, usize), (cosine, sine): (f64, f64)) {
    for k in 0..a.nrows() {
        let (x, y) = (a[(k, p)], a[(k, q)]);
        let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
        (a[(k, p)], a[(p, k)], a[(k, q)], a[(q, k)]) = (x, x, y, y);
        let (x, y) = (v[(k, p)], v[(k, q)]);
        (v[(k, p)], v[(k, q)]) = (cosine * x - sine * y, sine * x + cosine * y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same for small and for large matrices, of deficient rank too.
    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        for n in [1, 3, 20, 120] {
            let matrix = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 if i == 0 || i == n - 1 => 1.0,
                0 => 2.0,
                1 => -1.0,
                _ => 0.0,
            });
            let (values, vectors) = symmetric_eigen(matrix.clone()).unwrap();
            let back = &vectors * DMatrix::from_diagonal(&values) * vectors.transpose();
            assert!((&back - &matrix).amax() < 1e-13, "{n}");
            assert!((vectors.transpose() * &vectors - DMatrix::identity(n, n)).amax() < 1e-13, "{n}");
        }
    }

    /// Scales of coordinates from 1e-8 to 1e8 give eigenvalues from 1e-16 to 1e16, each right to its digits.
    #[test]
    fn small_eigenvalues_beside_large_ones_are_right() {
        let scale = |i: usize| 10.0_f64.powi(8 - 8 * i as i32);
        let matrix = DMatrix::from_fn(3, 3, |i, j| scale(i) * scale(j) * if i == j { 2.0 } else { 1.0 });
        let (values, _) = symmetric_eigen(matrix).unwrap();
        let mut values: Vec<f64> = values.iter().copied().collect();
        values.sort_by(f64::total_cmp);
        // To 1e-16 the pivots of LDLᵀ: 2, 3/2, 4/3 of the squares of the scales.
        for (value, expected) in values.iter().zip([4.0 / 3.0 * 1e-16, 1.5, 2e16]) {
            assert!((value / expected - 1.0).abs() < 1e-14, "{value} {expected}");
        }
    }
}
