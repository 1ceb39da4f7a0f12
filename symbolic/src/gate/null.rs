//! Null spaces and ranks in double-double, where they are plain.

use crate::number::DoubleDouble;

/// A pivot that is no more than this of its scaled matrix is zero: rounding leaves some 1e-30.
const ZERO: f64 = 1e-20;
/// One that is more than `ZERO`, and less than this, is neither: nothing is said of such a matrix.
const PLAIN: f64 = 1e-6;
/// Rows and columns are scaled so often, each to a largest entry of 1.
const SCALINGS: usize = 3;

/// The columns of a matrix, all of the same length.
pub(super) type Columns = Vec<Vec<DoubleDouble>>;

/// A basis of all combinations of columns of this length that vanish; `None` where that is a matter of rounding.
pub(super) fn null_space(columns: &[Vec<DoubleDouble>], length: usize) -> Option<Columns> {
    let count = columns.len();
    let (mut rows, scales) = scaled(columns, length);
    let mut order: Vec<usize> = (0..count).collect();
    let mut rank = 0;
    while rank < length.min(count) {
        let rest = (rank..length).flat_map(|i| (rank..count).map(move |j| (i, j)));
        let size = |(i, j): &(usize, usize)| rows[*i][*j].to_f64().abs();
        let Some((i, j)) = rest.max_by(|a, b| size(a).total_cmp(&size(b))) else { break };
        let pivot = size(&(i, j));
        if !pivot.is_finite() || (ZERO..PLAIN).contains(&pivot) {
            return None;
        }
        if pivot < ZERO {
            break;
        }
        rows.swap(rank, i);
        rows.iter_mut().for_each(|row| row.swap(rank, j));
        order.swap(rank, j);
        let above = rows[rank].clone();
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != rank) {
            let factor = row[rank] / above[rank];
            if i != rank && factor != DoubleDouble::ZERO {
                row.iter_mut().zip(&above).skip(rank).for_each(|(x, y)| *x = *x - factor * *y);
                row[rank] = DoubleDouble::ZERO;
            }
        }
        rank += 1;
    }
    let vector = |free: usize| {
        let mut combination = vec![DoubleDouble::ZERO; count];
        combination[order[free]] = DoubleDouble::ONE * scales[order[free]];
        for k in 0..rank {
            combination[order[k]] = -rows[k][free] / rows[k][k] * scales[order[k]];
        }
        combination
    };
    Some((rank..count).map(vector).collect())
}

/// How many columns are independent.
pub(super) fn rank(columns: &[Vec<DoubleDouble>], length: usize) -> Option<usize> {
    Some(columns.len() - null_space(columns, length)?.len())
}

/// Whether the columns of `inner` are combinations of those of `outer`.
pub(super) fn contains(outer: &[Vec<DoubleDouble>], inner: &[Vec<DoubleDouble>], length: usize) -> Option<bool> {
    Some(rank(&[outer, inner].concat(), length)? == rank(outer, length)?)
}

/// The rows of a matrix, rows and columns scaled by powers of two, and the scales of its columns.
fn scaled(columns: &[Vec<DoubleDouble>], length: usize) -> (Vec<Vec<DoubleDouble>>, Vec<f64>) {
    let mut rows: Vec<Vec<DoubleDouble>> = (0..length).map(|i| columns.iter().map(|c| c[i]).collect()).collect();
    let mut scales = vec![1.0; columns.len()];
    let largest = |sizes: &mut dyn Iterator<Item = DoubleDouble>| {
        let most = sizes.fold(0.0_f64, |most, x| most.max(x.to_f64().abs()));
        if most > 0.0 && most.is_finite() { (-most.log2().round()).exp2() } else { 1.0 }
    };
    for _ in 0..SCALINGS {
        for row in &mut rows {
            let by = largest(&mut row.iter().copied());
            row.iter_mut().for_each(|x| *x = *x * by);
        }
        for (j, scale) in scales.iter_mut().enumerate() {
            let by = largest(&mut rows.iter().map(|row| row[j]));
            rows.iter_mut().for_each(|row| row[j] = row[j] * by);
            *scale *= by;
        }
    }
    (rows, scales)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(numbers: &[&[f64]]) -> Columns {
        numbers.iter().map(|column| column.iter().map(|x| DoubleDouble::from(*x)).collect()).collect()
    }

    #[test]
    fn combinations_that_vanish_are_found_in_any_measure() {
        let of = columns(&[&[1e-9, 2e9], &[2e-9, 4e9], &[1e-9, 3e9]]);
        let null = null_space(&of, 2).unwrap();
        assert_eq!(null.len(), 1);
        for row in 0..2 {
            let sum = null[0].iter().zip(&of).fold(DoubleDouble::ZERO, |sum, (y, c)| sum + *y * c[row]);
            assert_eq!(sum.to_f64(), 0.0);
        }
        assert_eq!(rank(&of, 2), Some(2));
        assert_eq!(contains(&of[..1], &of[1..2], 2), Some(true));
        assert_eq!(contains(&of[..1], &of[2..], 2), Some(false));
    }

    #[test]
    fn of_columns_that_nearly_depend_on_each_other_nothing_is_said() {
        assert_eq!(rank(&columns(&[&[1.0, 1.0], &[1.0, 1.0 + 1e-10]]), 2), None);
        assert_eq!(rank(&columns(&[&[1.0, 1.0], &[1.0, 1.001]]), 2), Some(2));
    }
}
