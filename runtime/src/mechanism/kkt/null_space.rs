//! Null spaces in coordinates that pivots choose.

use nalgebra::{DMatrix, DVector};

/// Rows below this part of the largest depend on others.
const DEPENDENT: f64 = 1e-9;

/// All solutions x = x₀ + Z y of J x = b, b being 0 where no right side is given.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Solutions {
    /// x₀, 0 in the independent coordinates.
    pub particular: DVector<f64>,
    /// Z: each column has a 1 in the row of its coordinate.
    pub basis: DMatrix<f64>,
    /// The coordinates that are independent, in order.
    pub independent: Vec<usize>,
    /// (row, coordinate) of the pivots.
    pub pivots: Vec<(usize, usize)>,
}

impl Solutions {
    /// Gauss's and Jordan's elimination with complete pivoting, rows divided by their norms.
    pub fn of(jacobian: &DMatrix<f64>, right: &[f64]) -> Self {
        let (m, n) = jacobian.shape();
        let mut a = jacobian.clone().insert_column(n, 0.0);
        for (k, mut row) in a.row_iter_mut().enumerate() {
            row[n] = right.get(k).copied().unwrap_or(0.0);
            let norm = row.columns(0, n).norm();
            if norm > 0.0 {
                row.scale_mut(1.0 / norm);
            }
        }
        let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = ((0..m).collect(), (0..n).collect());
        let mut rank = 0;
        while rank < m.min(n) {
            let rest = (rank..m).flat_map(|i| (rank..n).map(move |j| (i, j)));
            let Some((i, j)) = rest.max_by(|x, y| a[*x].abs().total_cmp(&a[*y].abs())) else { break };
            // Numbers that are not finite are no pivots either.
            if !(a[(i, j)].abs() > DEPENDENT && a[(i, j)].is_finite()) {
                break;
            }
            a.swap_rows(rank, i);
            rows.swap(rank, i);
            a.swap_columns(rank, j);
            columns.swap(rank, j);
            let pivot = a[(rank, rank)];
            a.row_mut(rank).scale_mut(1.0 / pivot);
            for k in (0..m).filter(|k| *k != rank) {
                let factor = a[(k, rank)];
                if factor != 0.0 {
                    let line = a.row(rank).clone_owned();
                    let mut row = a.row_mut(k);
                    row -= factor * line;
                }
            }
            rank += 1;
        }
        let mut particular = DVector::zeros(n);
        (0..rank).for_each(|i| particular[columns[i]] = a[(i, n)]);
        let mut order: Vec<(usize, usize)> = columns[rank..].iter().copied().enumerate().collect();
        order.sort_by_key(|(_, column)| *column);
        let mut basis = DMatrix::zeros(n, n - rank);
        for (k, (place, column)) in order.iter().enumerate() {
            basis[(*column, k)] = 1.0;
            (0..rank).for_each(|i| basis[(columns[i], k)] = -a[(i, rank + place)]);
        }
        let independent = order.into_iter().map(|(_, column)| column).collect();
        Solutions { particular, basis, independent, pivots: rows.into_iter().zip(columns).take(rank).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_meet_the_rows() {
        let j = DMatrix::from_row_slice(2, 4, &[1.0, 2.0, 0.0, -1.0, 2.0, 4.0, 0.0, -2.0]);
        let Solutions { particular, basis, independent, pivots } = Solutions::of(&j, &[3.0, 6.0]);
        assert_eq!((basis.ncols(), independent.len(), pivots.len()), (3, 3, 1));
        assert!((&j * &basis).norm() < 1e-15);
        assert!((&j * particular - DVector::from_vec(vec![3.0, 6.0])).norm() < 1e-15);
        for (k, i) in independent.iter().enumerate() {
            assert_eq!(basis[(*i, k)], 1.0);
        }
    }
}
