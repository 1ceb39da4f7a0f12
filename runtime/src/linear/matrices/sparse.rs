//! Matrices as the values of their structural non-zeros.

use nalgebra::DMatrix;

/// A matrix as a list of (row, column, value); places that are not listed are zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseMatrix {
    /// How many rows.
    pub rows: usize,
    /// How many columns.
    pub columns: usize,
    /// (row, column, value), each place once.
    pub entries: Vec<(u32, u32, f64)>,
}

impl SparseMatrix {
    /// Values in the places of a pattern.
    pub fn new(rows: usize, columns: usize, pattern: &[(u32, u32)], values: &[f64]) -> Self {
        let entries = pattern.iter().zip(values).map(|(place, value)| (place.0, place.1, *value)).collect();
        SparseMatrix { rows, columns, entries }
    }

    /// A symmetric matrix from the values of its lower triangle.
    pub fn symmetric(n: usize, pattern: &[(u32, u32)], values: &[f64]) -> Self {
        let mut matrix = SparseMatrix::new(n, n, pattern, values);
        let upper = matrix.entries.iter().filter(|e| e.0 != e.1).map(|e| (e.1, e.0, e.2)).collect::<Vec<_>>();
        matrix.entries.extend(upper);
        matrix
    }

    /// The identity.
    pub fn identity(n: usize) -> Self {
        SparseMatrix { rows: n, columns: n, entries: (0..n as u32).map(|i| (i, i, 1.0)).collect() }
    }

    /// The non-zeros of a dense matrix.
    pub fn from_dense(dense: &DMatrix<f64>) -> Self {
        let (rows, columns) = dense.shape();
        let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        let entries = places.filter(|p| dense[*p] != 0.0).map(|p| (p.0 as u32, p.1 as u32, dense[p])).collect();
        SparseMatrix { rows, columns, entries }
    }

    /// All elements, on the heap.
    pub fn to_dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.rows, self.columns);
        for (row, column, value) in &self.entries {
            dense[(*row as usize, *column as usize)] += value;
        }
        dense
    }

    /// The symmetric part (A + Aᵀ)/2 and the skew part (A − Aᵀ)/2 of a square matrix.
    ///
    /// Parts that are rounding of ∂F are zero: sums and differences below 8 ε of the elements they come from, and differences below 8 ε of the
    /// geometric mean of the elements on the diagonal beside them, below which terms of springs are that cancel in an element.
    pub fn split(&self) -> (SparseMatrix, SparseMatrix) {
        let mut pairs = std::collections::BTreeMap::<(u32, u32), (f64, f64)>::new();
        for &(row, column, value) in &self.entries {
            if row >= column {
                pairs.entry((row, column)).or_default().0 += value;
            }
            if row <= column {
                pairs.entry((column, row)).or_default().1 += value;
            }
        }
        let mut diagonal = vec![0.0; self.rows];
        let own = self.entries.iter().filter(|(row, column, _)| row == column);
        own.for_each(|(row, _, value)| diagonal[*row as usize] += value.abs());
        let empty = SparseMatrix { rows: self.rows, columns: self.columns, entries: Vec::new() };
        let (mut symmetric, mut skew) = (empty.clone(), empty);
        for ((row, column), (lower, upper)) in pairs {
            if row == column {
                symmetric.entries.push((row, row, lower));
                continue;
            }
            let own = lower.abs().max(upper.abs());
            let springs = (diagonal[row as usize] * diagonal[column as usize]).sqrt();
            let [even, odd] = [(lower + upper, own), (lower - upper, own.max(springs))]
                .map(|(x, beside)| if x.abs() <= 16.0 * f64::EPSILON * beside { 0.0 } else { 0.5 * x });
            symmetric.entries.extend([(row, column, even), (column, row, even)]);
            skew.entries.extend([(row, column, odd), (column, row, -odd)]);
        }
        symmetric.entries.retain(|e| e.2 != 0.0);
        skew.entries.retain(|e| e.2 != 0.0);
        (symmetric, skew)
    }

    /// True when every element is zero.
    pub fn is_zero(&self) -> bool {
        self.entries.iter().all(|e| e.2 == 0.0)
    }

    /// The diagonal, if nothing else is non-zero.
    pub fn diagonal(&self) -> Option<Vec<f64>> {
        let mut diagonal = vec![0.0; self.rows];
        for (row, column, value) in &self.entries {
            if row == column {
                diagonal[*row as usize] += value;
            } else if *value != 0.0 {
                return None;
            }
        }
        Some(diagonal)
    }

    /// Adds A x to y.
    pub fn add_product(&self, x: &[f64], y: &mut [f64]) {
        for (row, column, value) in &self.entries {
            y[*row as usize] += value * x[*column as usize];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A gyroscopic force of 7.7 that is off by its rounding dissipates nothing; what is larger is in both parts.
    #[test]
    fn rounding_is_in_neither_part() {
        let rounded = |even: f64| DMatrix::from_row_slice(2, 2, &[0.0, -7.7 + even, 7.7 + even, 0.0]);
        let (symmetric, skew) = SparseMatrix::from_dense(&rounded(4.5e-16)).split();
        assert!(symmetric.is_zero() && (skew.to_dense()[(1, 0)] - 7.7).abs() < 1e-14);
        let (symmetric, _) = SparseMatrix::from_dense(&rounded(1e-13)).split();
        assert!((symmetric.to_dense()[(1, 0)] - 1e-13).abs() < 1e-15);
        // Terms of springs that cancel but for rounding of those on the diagonal; a follower force that is more.
        let springs = |odd: f64| DMatrix::from_row_slice(2, 2, &[7e3, 2e-3 + odd, 2e-3 - odd, 5.0]);
        assert!(SparseMatrix::from_dense(&springs(2e-14)).split().1.is_zero());
        assert!(!SparseMatrix::from_dense(&springs(1e-11)).split().1.is_zero());
    }
}
