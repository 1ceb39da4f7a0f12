//! Elimination in double-double, with all pivots to choose from.

use crate::number::DoubleDouble;

/// A pivot that is no more than this of its scaled matrix is zero.
const ZERO: f64 = 1e-22;

/// A square matrix factored, rows and columns scaled and exchanged.
pub(super) struct Factored {
    n: usize,
    /// L below the diagonal (ones on it left out), U on it and above; row by row.
    entries: Vec<DoubleDouble>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    row_scales: Vec<f64>,
    column_scales: Vec<f64>,
}

/// A matrix whose rank is too small.
pub(super) struct Deficient {
    /// Its rank.
    pub rank: usize,
    /// The columns that take part in some combination that vanishes.
    pub columns: Vec<usize>,
}

/// Factors a square matrix, given row by row; `noise` is the scale of its entries' rounding errors, entry by entry.
pub(super) fn factor(matrix: &[DoubleDouble], noise: &[f64], n: usize) -> Result<Factored, Deficient> {
    let (row_scales, column_scales) = scales(matrix, n);
    let scaled = |i: usize, j: usize| row_scales[i] * column_scales[j];
    let mut entries: Vec<DoubleDouble> = (0..n * n).map(|k| matrix[k] * scaled(k / n, k % n)).collect();
    // Powers of two, so scaling is exact; what rounding may have left of a zero counts as zero.
    let floor = noise.iter().enumerate().fold(0.0_f64, |most, (k, m)| most.max(m * scaled(k / n, k % n)));
    let zero = ZERO.max(1e4 * DoubleDouble::UNIT * floor);
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
    for k in 0..n {
        let rest = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let size = |(i, j): &(usize, usize)| entries[i * n + j].to_f64().abs();
        let Some((i, j)) = rest.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        let largest = size(&(i, j));
        if largest.is_nan() || largest <= zero {
            return Err(deficient(&entries, &columns, n, k));
        }
        for c in 0..n {
            entries.swap(k * n + c, i * n + c);
        }
        for r in 0..n {
            entries.swap(r * n + k, r * n + j);
        }
        rows.swap(k, i);
        columns.swap(k, j);
        let pivot = entries[k * n + k];
        for i in k + 1..n {
            if entries[i * n + k] == DoubleDouble::ZERO {
                continue;
            }
            let factor = entries[i * n + k] / pivot;
            entries[i * n + k] = factor;
            for c in k + 1..n {
                let above = entries[k * n + c];
                if above != DoubleDouble::ZERO {
                    entries[i * n + c] = entries[i * n + c] - factor * above;
                }
            }
        }
    }
    Ok(Factored { n, entries, rows, columns, row_scales, column_scales })
}

impl Factored {
    /// The solution of A x = b.
    pub fn solve(&self, right: &[DoubleDouble]) -> Vec<DoubleDouble> {
        let n = self.n;
        let mut y: Vec<DoubleDouble> = self.rows.iter().map(|&i| right[i] * self.row_scales[i]).collect();
        for i in 0..n {
            for j in 0..i {
                let known = self.entries[i * n + j] * y[j];
                y[i] = y[i] - known;
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n {
                let known = self.entries[i * n + j] * y[j];
                y[i] = y[i] - known;
            }
            y[i] = y[i] / self.entries[i * n + i];
        }
        let mut x = vec![DoubleDouble::ZERO; n];
        for (k, &j) in self.columns.iter().enumerate() {
            x[j] = y[k] * self.column_scales[j];
        }
        x
    }

    /// The solution of A x = b after one step of refinement, which makes every row right by its own terms (Skeel 1980), and how large each
    /// unknown was on the way: |x|, or the change where that was larger, since what it leaves is a rounding of it.
    pub fn refined(&self, matrix: &[DoubleDouble], right: &[DoubleDouble]) -> (Vec<DoubleDouble>, Vec<f64>) {
        let mut found = self.solve(right);
        let line = |i: usize| &matrix[i * self.n..][..self.n];
        let left: Vec<DoubleDouble> =
            (0..self.n).map(|i| line(i).iter().zip(&found).fold(right[i], |rest, (m, x)| rest - *m * *x)).collect();
        let changes = self.solve(&left);
        found.iter_mut().zip(&changes).for_each(|(x, change)| *x += *change);
        let sizes = found.iter().zip(&changes).map(|(x, change)| x.to_f64().abs().max(change.to_f64().abs())).collect();
        (found, sizes)
    }

    /// |A⁻¹| m: how far errors of size m on the right change each unknown.
    pub fn spread(&self, right: &[f64]) -> Vec<f64> {
        let n = self.n;
        let entries: Vec<f64> = self.entries.iter().map(|x| x.to_f64()).collect();
        let mut spread = vec![0.0; n];
        let mut y = vec![0.0; n];
        for (place, &row) in self.rows.iter().enumerate() {
            let size = right[row] * self.row_scales[row];
            if size == 0.0 {
                continue;
            }
            y.fill(0.0);
            y[place] = size;
            for i in place..n {
                let known: f64 = (place..i).map(|j| entries[i * n + j] * y[j]).sum();
                y[i] -= known;
            }
            for i in (0..n).rev() {
                let known: f64 = (i + 1..n).map(|j| entries[i * n + j] * y[j]).sum();
                y[i] = (y[i] - known) / entries[i * n + i];
            }
            for (k, &j) in self.columns.iter().enumerate() {
                spread[j] += (y[k] * self.column_scales[j]).abs();
            }
        }
        spread
    }
}

/// Gaussian elimination in `f64` with exchanged rows; `None` where a pivot vanishes.
pub(super) fn solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| matrix[a * n + k].abs().total_cmp(&matrix[b * n + k].abs()))?;
        (0..n).for_each(|c| matrix.swap(k * n + c, pivot * n + c));
        right.swap(k, pivot);
        let top = matrix[k * n + k];
        if top == 0.0 || !top.is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = matrix[i * n + k] / top;
            if factor != 0.0 {
                (k..n).for_each(|c| matrix[i * n + c] -= factor * matrix[k * n + c]);
                right[i] -= factor * right[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k * n + j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k * n + k];
    }
    Some(right)
}

/// Powers of two that bring the largest entry of every row, and then of every column, near 1.
fn scales(matrix: &[DoubleDouble], n: usize) -> (Vec<f64>, Vec<f64>) {
    let size = |k: usize| matrix[k].to_f64().abs();
    // A mass matrix keeps its symmetry where its diagonal is there.
    let diagonal: Vec<f64> = (0..n).map(|i| size(i * n + i)).collect();
    if diagonal.iter().all(|d| *d > 0.0 && d.is_finite()) {
        let scales: Vec<f64> = diagonal.iter().map(|d| power_of_two(1.0 / d.sqrt())).collect();
        return (scales.clone(), scales);
    }
    let largest = |values: &mut dyn Iterator<Item = f64>| {
        let most = values.fold(0.0_f64, f64::max);
        if most > 0.0 && most.is_finite() { power_of_two(1.0 / most) } else { 1.0 }
    };
    let rows: Vec<f64> = (0..n).map(|i| largest(&mut (0..n).map(|j| size(i * n + j)))).collect();
    let columns = (0..n).map(|j| largest(&mut (0..n).map(|i| size(i * n + j) * rows[i]))).collect();
    (rows, columns)
}

fn power_of_two(x: f64) -> f64 {
    let exponent = x.log2().round();
    if exponent.is_finite() { exponent.clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

/// The combination of columns that vanishes when elimination stops at step `rank`.
fn deficient(entries: &[DoubleDouble], columns: &[usize], n: usize, rank: usize) -> Deficient {
    let mut part = vec![false; n];
    for free in rank..n {
        let mut x = vec![0.0; n];
        x[free] = 1.0;
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..n).map(|j| entries[i * n + j].to_f64() * x[j]).sum();
            x[i] = -known / entries[i * n + i].to_f64();
        }
        for (k, value) in x.iter().enumerate() {
            part[columns[k]] |= value.abs() > 1e-9;
        }
    }
    Deficient { rank, columns: (0..n).filter(|j| part[*j]).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn matrix(rows: &[&[f64]]) -> Vec<DoubleDouble> {
        rows.iter().flat_map(|row| row.iter().map(|x| DoubleDouble::from(*x))).collect()
    }

    #[test]
    fn rows_of_any_scale_are_solved_to_thirty_digits() {
        let m = matrix(&[&[2e12, 1e-3, 0.0], &[1e-3, 3e-9, 1e-10], &[0.0, 1e-10, 5e-9]]);
        let Ok(factored) = factor(&m, &[0.0; 9], 3) else { panic!("regular") };
        let wanted = [3e-7, 2.0, -7e3].map(DoubleDouble::from);
        let right: Vec<DoubleDouble> =
            m.chunks(3).map(|row| row.iter().zip(&wanted).fold(DoubleDouble::ZERO, |s, (a, x)| s + *a * *x)).collect();
        for (found, wanted) in factored.solve(&right).iter().zip(&wanted) {
            assert!(((*found - *wanted) / *wanted).to_f64().abs() < 1e-27, "{found:?}");
        }
    }

    #[test]
    fn the_columns_of_a_combination_that_vanishes_are_named() {
        // The third is the sum of the others; the fourth stands alone.
        let m = matrix(&[&[2.0, 1.0, 3.0, 0.0], &[1.0, 5.0, 6.0, 0.0], &[3.0, 6.0, 9.0, 0.0], &[0.0, 0.0, 0.0, 1e-9]]);
        let Err(found) = factor(&m, &[0.0; 16], 4) else { panic!("singular") };
        assert_eq!((found.rank, found.columns), (3, vec![0, 1, 2]));
    }
}
