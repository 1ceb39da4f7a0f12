//! Eigenvalues and eigenvectors of matrices that are not symmetric.

use nalgebra::{Complex, DMatrix, DVector, Schur};

/// Iterations for each eigenvalue; two or three are usual.
const MOST_ITERATIONS: usize = 100;

/// λ and V of A V = V diag(λ), of a real square matrix.
///
/// A is balanced (scaled by powers of two until rows and columns are of one size), brought to real Schur form, and the
/// eigenvectors come by back substitution: conjugate pairs are conjugate to the last digit, real eigenvalues real.
/// Source: Golub and Van Loan, Matrix Computations, §7.5–7.6; balancing by Parlett and Reinsch (1969).
pub struct Eigen {
    pub values: Vec<Complex<f64>>,
    /// Of unit length, as columns.
    pub vectors: DMatrix<Complex<f64>>,
}

impl Eigen {
    /// `None` where the iteration does not end.
    pub fn of(matrix: &DMatrix<f64>) -> Option<Eigen> {
        if matrix.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let n = matrix.nrows();
        if matrix.iter().all(|x| *x == 0.0) {
            return Some(Eigen { values: vec![Complex::new(0.0, 0.0); n], vectors: DMatrix::identity(n, n) });
        }
        let parts = decoupled(matrix);
        if parts.len() > 1 {
            return Eigen::of_parts(matrix, &parts);
        }
        let (balanced, scale) = balance(matrix.clone());
        let (q, t) = schur(&balanced)?;
        let mut values = vec![Complex::new(0.0, 0.0); n];
        let mut vectors = DMatrix::zeros(n, n);
        let smallest = f64::EPSILON * t.amax().max(f64::MIN_POSITIVE);
        let mut k = 0;
        while k < n {
            let pair = k + 1 < n && t[(k + 1, k)] != 0.0;
            let roots = if pair {
                block_roots(&t, k)
            } else {
                vec![(Complex::new(t[(k, k)], 0.0), vec![Complex::new(1.0, 0.0)])]
            };
            for (offset, (value, start)) in roots.into_iter().enumerate() {
                values[k + offset] = value;
                let y = substitute_back(&t, k, value, &start, smallest);
                let mut column = combine(&q, &y);
                column.iter_mut().zip(scale.iter()).for_each(|(x, scale)| *x *= *scale);
                let length = column.norm();
                vectors.set_column(k + offset, &(column / Complex::from(length)));
            }
            k += if pair { 2 } else { 1 };
        }
        Some(Eigen { values, vectors })
    }

    /// Of a matrix whose parts have nothing to do with each other: equal eigenvalues of different parts have shapes of their own.
    fn of_parts(matrix: &DMatrix<f64>, parts: &[Vec<usize>]) -> Option<Eigen> {
        let n = matrix.nrows();
        let (mut values, mut vectors) = (vec![Complex::new(0.0, 0.0); n], DMatrix::zeros(n, n));
        for part in parts {
            let found = Eigen::of(&matrix.select_rows(part).select_columns(part))?;
            for (k, column) in part.iter().enumerate() {
                values[*column] = found.values[k];
                part.iter().enumerate().for_each(|(i, row)| vectors[(*row, *column)] = found.vectors[(i, k)]);
            }
        }
        Some(Eigen { values, vectors })
    }

    /// The condition number of the eigenvectors.
    pub fn condition(&self) -> f64 {
        condition(&self.vectors)
    }
}

/// Rows and columns that elements other than 0 join, directly or through others.
fn decoupled(matrix: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let n = matrix.nrows();
    let mut left: Vec<usize> = (0..n).collect();
    let mut parts = Vec::new();
    while let Some(first) = left.first().copied() {
        left.remove(0);
        let mut part = vec![first];
        let mut next = 0;
        while next < part.len() {
            let i = part[next];
            let (joined, apart) = left.iter().partition(|j| matrix[(i, **j)] != 0.0 || matrix[(**j, i)] != 0.0);
            left = apart;
            part.extend::<Vec<usize>>(joined);
            next += 1;
        }
        part.sort_unstable();
        parts.push(part);
    }
    parts
}

/// The largest singular value over the least.
pub fn condition(vectors: &DMatrix<Complex<f64>>) -> f64 {
    if vectors.is_empty() {
        return 1.0;
    }
    let singular = vectors.clone().singular_values();
    singular.max() / singular.min()
}

/// A and the diagonal D so that the matrix given was D A D⁻¹.
fn balance(mut a: DMatrix<f64>) -> (DMatrix<f64>, DVector<f64>) {
    let n = a.nrows();
    let mut scale = DVector::from_element(n, 1.0);
    for _ in 0..50 {
        let mut done = true;
        for i in 0..n {
            let (mut row, mut column) = (0.0_f64, 0.0_f64);
            for j in (0..n).filter(|j| *j != i) {
                row += a[(i, j)].abs();
                column += a[(j, i)].abs();
            }
            if row == 0.0 || column == 0.0 {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if factor == 1.0 || !factor.is_normal() || column * factor + row / factor >= 0.95 * (column + row) {
                continue;
            }
            done = false;
            scale[i] *= factor;
            for j in 0..n {
                a[(i, j)] /= factor;
                a[(j, i)] *= factor;
            }
        }
        if done {
            break;
        }
    }
    (a, scale)
}

/// Q and T of A = Q T Qᵀ.  Where the shifts go in circles (they may, for matrices of much symmetry), a reflected copy
/// of A has none.
fn schur(a: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let n = a.nrows();
    if n == 0 {
        return Some((DMatrix::zeros(0, 0), DMatrix::zeros(0, 0)));
    }
    let most = MOST_ITERATIONS * n.max(10);
    if let Some(found) = Schur::try_new(a.clone(), f64::EPSILON, most) {
        return Some(cleaned(found.unpack()));
    }
    (1..4).find_map(|attempt| {
        let normal = DVector::from_fn(n, |i, _| (1.0 + (i as f64 + 0.3) * f64::from(attempt) * 1.7).sin()).normalize();
        let reflection = DMatrix::identity(n, n) - &normal * normal.transpose() * 2.0;
        let (q, t) = Schur::try_new(&reflection * a * &reflection, f64::EPSILON, most)?.unpack();
        Some(cleaned((reflection * q, t)))
    })
}

/// Below the diagonal of T nothing is left but the lower corners of complex pairs.
fn cleaned((q, mut t): (DMatrix<f64>, DMatrix<f64>)) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = t.nrows();
    for j in 0..n {
        for i in j + 1..n {
            let rounding = i > j + 1 || t[(i, j)].abs() <= f64::EPSILON * (t[(i, i)].abs() + t[(j, j)].abs());
            if rounding {
                t[(i, j)] = 0.0;
            }
        }
    }
    (q, t)
}

/// Both eigenvalues of the block at k, each with its vector in the block.
fn block_roots(t: &DMatrix<f64>, k: usize) -> Vec<(Complex<f64>, Vec<Complex<f64>>)> {
    let (a, b, c, d) = (t[(k, k)], t[(k, k + 1)], t[(k + 1, k)], t[(k + 1, k + 1)]);
    let (mean, half) = (0.5 * (a + d), 0.5 * (a - d));
    // In parts, so that neither square overflows.
    let discriminant = half * half + b * c;
    let roots = if discriminant >= 0.0 {
        let root = discriminant.sqrt();
        [Complex::new(mean + root, 0.0), Complex::new(mean - root, 0.0)]
    } else {
        let root = (-discriminant).sqrt();
        [Complex::new(mean, root), Complex::new(mean, -root)]
    };
    let vector = |value: Complex<f64>| vec![value - d, Complex::new(c, 0.0)];
    roots.into_iter().map(|value| (value, vector(value))).collect()
}

/// y of (T − λ) y = 0 with its last elements, those of the block at k, given.
fn substitute_back(
    t: &DMatrix<f64>,
    k: usize,
    value: Complex<f64>,
    start: &[Complex<f64>],
    smallest: f64,
) -> Vec<Complex<f64>> {
    let mut y = vec![Complex::new(0.0, 0.0); k];
    y.extend_from_slice(start);
    let guarded = |pivot: Complex<f64>| if pivot.norm() < smallest { Complex::new(smallest, 0.0) } else { pivot };
    let mut i = k;
    while i > 0 {
        let pair = i > 1 && t[(i - 1, i - 2)] != 0.0;
        let rest = |row: usize, y: &[Complex<f64>]| -> Complex<f64> { (i..y.len()).map(|j| y[j] * t[(row, j)]).sum() };
        if pair {
            let (r, s) = (i - 2, i - 1);
            let (f, g) = (-rest(r, &y), -rest(s, &y));
            let (a, d) = (Complex::from(t[(r, r)]) - value, Complex::from(t[(s, s)]) - value);
            let (b, c) = (t[(r, s)], t[(s, r)]);
            let determinant = a * d - b * c;
            let floor = smallest * (a.norm() + d.norm() + b.abs() + c.abs());
            let determinant = if determinant.norm() < floor { Complex::new(floor, 0.0) } else { determinant };
            y[r] = (d * f - g * b) / determinant;
            y[s] = (a * g - f * c) / determinant;
            i -= 2;
        } else {
            y[i - 1] = -rest(i - 1, &y) / guarded(Complex::from(t[(i - 1, i - 1)]) - value);
            i -= 1;
        }
        // Nearly parallel eigenvectors grow on the way up.
        let largest = y.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
        if largest > 1e100 {
            y.iter_mut().for_each(|x| *x /= largest);
        }
    }
    y
}

fn combine(q: &DMatrix<f64>, y: &[Complex<f64>]) -> DVector<Complex<f64>> {
    let mut sum = DVector::zeros(q.nrows());
    for (column, part) in q.column_iter().zip(y) {
        for (total, x) in sum.iter_mut().zip(column.iter()) {
            *total += *part * *x;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(a: &DMatrix<f64>) {
        let found = Eigen::of(a).unwrap();
        let complex = a.map(Complex::from);
        for (k, value) in found.values.iter().enumerate() {
            let v = found.vectors.column(k);
            let left = (&complex * v - v * *value).norm();
            assert!(left <= 1e-13 * a.norm() * a.nrows() as f64, "{value} leaves {left} of {a}");
            assert!((v.norm() - 1.0).abs() < 1e-14);
        }
        // A real matrix: every pair is conjugate to the last digit.
        let pairs = found.values.iter().filter(|x| x.im > 0.0);
        assert!(pairs.clone().all(|x| found.values.contains(&x.conj())));
        let trace: f64 = found.values.iter().map(|x| x.re).sum();
        assert!((trace - a.trace()).abs() < 1e-12 * a.norm().max(1.0));
    }

    #[test]
    fn random_matrices_of_all_sizes() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for n in [1, 2, 3, 4, 5, 8, 13, 40] {
            for _ in 0..5 {
                check(&DMatrix::from_fn(n, n, |_, _| random()));
            }
        }
    }

    /// Matrices on which shifts go in circles, and those without a basis of eigenvectors.
    #[test]
    fn matrices_of_much_symmetry_and_defective_ones() {
        for n in [2, 3, 4, 6, 12] {
            check(&DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == (j + 1) % n))));
            check(&DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i + 1 == j))));
        }
        check(&DMatrix::zeros(3, 3));
        check(&DMatrix::identity(4, 4));
        check(&dmatrix![0.0, 0.0, 1.0, 0.0; 0.0, 0.0, 0.0, 1.0; -1.0, 1.0, 0.0, 0.0; 0.0, -1.0, 0.0, 0.0]);
    }

    /// Balanced, a matrix with entries from 1e-8 to 1e8 has its small eigenvalues to their digits.
    #[test]
    fn balancing_keeps_small_eigenvalues() {
        let found = Eigen::of(&dmatrix![1.0, 1e8, 1e16; 1e-8, 2.0, 1e8; 0.0, 1e-8, 3.0]).unwrap();
        let plain = Eigen::of(&dmatrix![1.0, 1.0, 1.0; 1.0, 2.0, 1.0; 0.0, 1.0, 3.0]).unwrap();
        let sorted = |eigen: Eigen| {
            let mut list: Vec<f64> = eigen.values.iter().map(|x| x.re).collect();
            list.sort_by(f64::total_cmp);
            list
        };
        for (a, b) in sorted(found).iter().zip(sorted(plain)) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }
}
