//! Dense matrices whose rows and columns may be of any size; systems that are solved in room that is there.

use nalgebra::{ComplexField, DMatrix, DVector, DVectorView, Dyn, SVD};

/// L U of a square matrix, row by row, in place, by Gauss's elimination: L below the diagonal, U on it and above.  The pivot of
/// a column is its largest element; `pivots` tells which row was exchanged with each.  False where it is singular or not finite.
pub(crate) fn factor_lu<T: ComplexField<RealField = f64> + Copy>(matrix: &mut [T], pivots: &mut [usize]) -> bool {
    (0..pivots.len()).all(|k| eliminate(matrix, pivots, k))
}

fn eliminate<T: ComplexField<RealField = f64> + Copy>(matrix: &mut [T], pivots: &mut [usize], k: usize) -> bool {
    let n = pivots.len();
    let size = |matrix: &[T], i: usize| matrix[i * n + k].norm1();
    let best = (k..n).fold(k, |best, i| if size(matrix, i) > size(matrix, best) { i } else { best });
    pivots[k] = best;
    if best != k {
        (0..n).for_each(|j| matrix.swap(k * n + j, best * n + j));
    }
    let pivot = matrix[k * n + k];
    if !(pivot.norm1() > 0.0 && pivot.is_finite()) {
        return false;
    }
    let (above, below) = matrix.split_at_mut((k + 1) * n);
    let line = &above[k * n..];
    for row in below.chunks_exact_mut(n) {
        let factor = row[k] / pivot;
        row[k] = factor;
        if factor != T::zero() {
            row[k + 1..].iter_mut().zip(&line[k + 1..]).for_each(|(x, y)| *x -= factor * *y);
        }
    }
    true
}

/// x becomes (L U)⁻¹ x, of a matrix that [`factor_lu`] factored.
pub(crate) fn solve_lu<T: ComplexField<RealField = f64> + Copy>(matrix: &[T], pivots: &[usize], x: &mut [T]) {
    let n = pivots.len();
    for (k, pivot) in pivots.iter().enumerate() {
        x.swap(k, *pivot);
    }
    for i in 1..n {
        let sum = (0..i).fold(x[i], |sum, j| sum - matrix[i * n + j] * x[j]);
        x[i] = sum;
    }
    for i in (0..n).rev() {
        let sum = (i + 1..n).fold(x[i], |sum, j| sum - matrix[i * n + j] * x[j]);
        x[i] = sum / matrix[i * n + i];
    }
}

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
    solve_least_of_rank(matrix, right, usize::MAX)
}

/// As [`solve_least`], of a matrix whose rank is no more than this where what it is made of is met exactly: what is more is left out.
pub(crate) fn solve_least_of_rank(matrix: &DMatrix<f64>, right: &DMatrix<f64>, most: usize) -> Option<DMatrix<f64>> {
    Least::of(matrix, most)?.solve(right)
}

/// As [`solve_least_of_rank`], what is left of A x − b measured as it is: only the columns of A are brought to one size.
pub(crate) fn solve_least_as_measured(
    matrix: &DMatrix<f64>,
    right: &DMatrix<f64>,
    most: usize,
) -> Option<DMatrix<f64>> {
    let power = |column: DVectorView<'_, f64>| {
        let largest = column.amax();
        if largest > 0.0 { (-largest.log2()).round().exp2() } else { 1.0 }
    };
    let columns = DVector::from_iterator(matrix.ncols(), matrix.column_iter().map(power));
    let scaled = matrix * DMatrix::from_diagonal(&columns);
    Least::scaled(scaled, DVector::from_element(matrix.nrows(), 1.0), columns, most)?.solve(right)
}

/// As [`solve_least`]; numbers that are small beside the others have their own digits where the equations determine these well (iterative refinement:
/// Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 12.2).
pub(crate) fn solve_least_refined(matrix: &DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let least = Least::of(matrix, usize::MAX)?;
    let mut x = least.solve(right)?;
    let mut last = f64::INFINITY;
    for _ in 0..REFINEMENTS {
        let step = least.solve(&(right - matrix * &x))?;
        let size: f64 = step.row_iter().zip(&least.columns).map(|(row, factor)| row.amax() / factor).sum();
        // Rounding comes to rest.
        if size >= 0.5 * last || size.is_nan() {
            break;
        }
        x += step;
        last = size;
    }
    Some(x)
}

/// Each time leaves of what was left before what the matrix's condition makes of a rounding: so many do for any that can be solved with.
const REFINEMENTS: u32 = 16;

/// A matrix, equilibrated and decomposed, to solve with.
struct Least {
    rows: DVector<f64>,
    columns: DVector<f64>,
    /// `None` of an empty matrix.
    decomposed: Option<SVD<f64, Dyn, Dyn>>,
    /// Singular values below this are 0.
    negligible: f64,
}

impl Least {
    fn of(matrix: &DMatrix<f64>, most: usize) -> Option<Self> {
        if matrix.is_empty() {
            let [rows, columns] = [matrix.nrows(), matrix.ncols()].map(DVector::zeros);
            return Some(Least { rows, columns, decomposed: None, negligible: 0.0 });
        }
        let (scaled, rows, columns) = equilibrated(matrix);
        Least::scaled(scaled, rows, columns, most)
    }

    /// Of a matrix whose rows and columns have been multiplied by these.
    fn scaled(scaled: DMatrix<f64>, rows: DVector<f64>, columns: DVector<f64>, most: usize) -> Option<Self> {
        if scaled.is_empty() {
            return Some(Least { rows, columns, decomposed: None, negligible: 0.0 });
        }
        let size = scaled.amax().max(f64::MIN_POSITIVE) * scaled.nrows().max(scaled.ncols()) as f64;
        let decomposed = svd(scaled, true, true)?;
        let beyond = decomposed.singular_values.get(most).copied().unwrap_or(0.0);
        Some(Least { rows, columns, decomposed: Some(decomposed), negligible: beyond.max(1e-13 * size) })
    }

    fn solve(&self, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
        let Some(decomposed) = &self.decomposed else {
            return Some(DMatrix::zeros(self.columns.len(), right.ncols()));
        };
        let mut b = right.clone();
        b.row_iter_mut().zip(&self.rows).for_each(|(mut row, factor)| row.scale_mut(*factor));
        let mut x = decomposed.solve(&b, self.negligible).ok()?;
        x.row_iter_mut().zip(&self.columns).for_each(|(mut row, factor)| row.scale_mut(*factor));
        x.iter().all(|x| x.is_finite()).then_some(x)
    }
}

/// The singular value decomposition, with the left and the right vectors where they are asked for; `None` of numbers that are not finite, and where no
/// iteration ends: by itself nalgebra's has no limit.
pub(crate) fn svd<T: ComplexField<RealField = f64>>(
    matrix: DMatrix<T>,
    left: bool,
    right: bool,
) -> Option<SVD<T, Dyn, Dyn>> {
    /// What counts as 0 beside its neighbours, in roundings: where the least never does, more may.
    const ROUNDINGS: [f64; 3] = [5.0, 25.0, 125.0];
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let most = 100 * matrix.nrows().max(matrix.ncols()).max(10);
    let tried = |roundings: f64| matrix.clone().try_svd(left, right, roundings * f64::EPSILON, most);
    ROUNDINGS.into_iter().find_map(tried)
}

/// How many singular values are above a threshold; `None` as of [`svd`].
pub(crate) fn rank(matrix: DMatrix<f64>, threshold: f64) -> Option<usize> {
    svd(matrix, false, false).map(|svd| svd.rank(threshold))
}

/// Whether a matrix is symmetric but for rounding.
pub(crate) fn is_symmetric(matrix: &DMatrix<f64>) -> bool {
    let largest = matrix.amax();
    (matrix - matrix.transpose()).amax() <= 1e-13 * largest
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    #[test]
    fn factors_solve_with_exchanged_rows() {
        let matrix = [0.0, 2.0, 1.0, 4.0, 1.0, 0.0, 2.0, 3.0, 5.0].map(|x| Complex::new(x, 0.5 * x * x));
        let (mut factors, mut pivots) = (matrix, [0; 3]);
        assert!(factor_lu(&mut factors, &mut pivots));
        let expected = [Complex::new(1.0, -1.0), Complex::new(0.5, 2.0), Complex::new(-3.0, 0.0)];
        let mut x: Vec<Complex<f64>> =
            matrix.chunks(3).map(|row| row.iter().zip(&expected).map(|(a, x)| a * x).sum()).collect();
        solve_lu(&factors, &pivots, &mut x);
        assert!(x.iter().zip(&expected).all(|(x, expected)| (x - expected).norm() < 1e-13), "{x:?}");
    }

    #[test]
    fn what_is_no_number_has_no_singular_values() {
        assert_eq!(rank(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]), 1e-12), Some(1));
        for x in [f64::NAN, f64::INFINITY] {
            assert_eq!(rank(DMatrix::from_element(3, 4, x), 1e-12), None);
            assert!(svd(DMatrix::from_element(3, 4, Complex::new(0.0, x)), true, true).is_none());
        }
    }

    #[test]
    fn a_singular_matrix_is_not_factored() {
        assert!(!factor_lu(&mut [1.0, 2.0, 2.0, 4.0], &mut [0; 2]));
        assert!(!factor_lu(&mut [f64::NAN], &mut [0]));
        assert!(factor_lu(&mut [1.0, 2.0, 2.0, 5.0], &mut [0; 2]));
    }
}
