//! Dense matrices whose rows and columns may be of any size.

use nalgebra::{DMatrix, DVector};

/// R A C with the largest element of every row and column near 1, and the diagonals of R and C, powers of two: so
/// that what is small beside 1e12 counts in its own row (Ruiz 2001).
pub(crate) fn equilibrated(matrix: &DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>, DVector<f64>) {
    let (n, m) = matrix.shape();
    let (mut rows, mut columns) = (DVector::from_element(n, 1.0), DVector::from_element(m, 1.0));
    let mut scaled = matrix.clone();
    let power = |largest: f64| if largest > 0.0 { (-0.5 * largest.log2()).round().exp2() } else { 1.0 };
    let symmetric = n == m && is_symmetric(matrix);
    for _ in 0..12 {
        let by_row: Vec<f64> = scaled.row_iter().map(|row| power(row.amax())).collect();
        let by_column: Vec<f64> =
            if symmetric { by_row.clone() } else { scaled.column_iter().map(|column| power(column.amax())).collect() };
        if by_row.iter().chain(&by_column).all(|factor| *factor == 1.0) {
            break;
        }
        for j in 0..m {
            for i in 0..n {
                scaled[(i, j)] *= by_row[i] * by_column[j];
            }
            columns[j] *= by_column[j];
        }
        rows.iter_mut().zip(&by_row).for_each(|(row, factor)| *row *= factor);
    }
    (scaled, rows, columns)
}

/// The least x that leaves the least of A x − b, A equilibrated.
pub(crate) fn solve_least(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if matrix.is_empty() {
        return Some(DMatrix::zeros(matrix.ncols(), right.ncols()));
    }
    let (scaled, rows, columns) = equilibrated(matrix);
    let mut b = right.clone();
    b.row_iter_mut().enumerate().for_each(|(i, mut row)| row.scale_mut(rows[i]));
    let size = scaled.amax().max(f64::MIN_POSITIVE) * scaled.nrows().max(scaled.ncols()) as f64;
    let mut x = scaled.svd(true, true).solve(&b, 1e-13 * size).ok()?;
    x.row_iter_mut().enumerate().for_each(|(i, mut row)| row.scale_mut(columns[i]));
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// Whether a matrix is symmetric but for rounding.
pub(crate) fn is_symmetric(matrix: &DMatrix<f64>) -> bool {
    let largest = matrix.amax();
    (matrix - matrix.transpose()).amax() <= 1e-13 * largest
}
