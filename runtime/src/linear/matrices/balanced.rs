//! Balancing.

use nalgebra::DMatrix;

/// Sweeps of balancing.
const SWEEPS: usize = 30;

/// D⁻¹ A D with D of powers of 2 so that rows and columns of it are of one size (Osborne, J. ACM 7, 1960), and D: ranks count by what is small
/// beside the whole.
pub fn balanced(matrix: &DMatrix<f64>) -> (DMatrix<f64>, Vec<f64>) {
    let n = matrix.nrows();
    let (mut a, mut scales) = (matrix.clone(), vec![1.0; n]);
    for _ in 0..SWEEPS {
        let mut changed = false;
        for i in 0..n {
            let off = |k: &usize| *k != i;
            let row: f64 = (0..n).filter(off).map(|k| a[(i, k)].abs()).sum();
            let column: f64 = (0..n).filter(off).map(|k| a[(k, i)].abs()).sum();
            if row == 0.0 || column == 0.0 {
                continue;
            }
            let factor = (0.5 * (row / column).log2()).round().exp2();
            if factor == 1.0 || !factor.is_normal() {
                continue;
            }
            a.column_mut(i).scale_mut(factor);
            a.row_mut(i).scale_mut(1.0 / factor);
            scales[i] *= factor;
            changed = true;
        }
        if !changed {
            break;
        }
    }
    (a, scales)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balancing_keeps_the_matrix_up_to_units() {
        let matrix = DMatrix::from_row_slice(3, 3, &[0.0, 1e12, 0.0, 1e-12, -1.0, 1e9, 0.0, 1e-9, -2.0]);
        let (balanced, scales) = balanced(&matrix);
        assert!(balanced.amax() <= 4.0, "{balanced}");
        for i in 0..3 {
            for j in 0..3 {
                assert_eq!(balanced[(i, j)] * scales[i] / scales[j], matrix[(i, j)]);
            }
        }
    }
}
