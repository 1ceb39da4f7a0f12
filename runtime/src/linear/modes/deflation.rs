//! Zeros that a system z' = A z has in every state of a family, left out by their number.
//!
//! A null space of A, and then of RᵀAR on what is orthogonal to it, and so on, is left out: as many dimensions of each as
//! there are everywhere.  Where one more eigenvalue goes through 0 it stays in what is left, however near to 0 it is: with
//! those zeros it forms a chain that rounding would split by √ε, without them it crosses 0 by itself.

use nalgebra::DMatrix;

use crate::linear::LinearError;
use crate::linear::matrices::Singular;

/// Singular values of A, in units of √M, below this part of its norm are those of directions in which nothing happens: as in
/// `branch/continuation.rs` those of directions in which all states are solutions.
const ZERO: f64 = 1e-9;

/// The dimensions of these null spaces, one after the other.
///
/// # Errors
/// [`LinearError::NoConvergence`].
pub fn nullities(a: &DMatrix<f64>) -> Result<Vec<usize>, LinearError> {
    let least = ZERO * a.norm();
    let (mut left, mut found) = (a.clone(), Vec::new());
    while left.nrows() > 0 {
        let singular = decomposed(&left)?;
        let count = singular.values.iter().filter(|value| **value <= least).count();
        if count == 0 {
            break;
        }
        left = compressed(&left, &singular, count);
        found.push(count);
    }
    Ok(found)
}

/// A on what is left without null spaces of these dimensions.
///
/// # Errors
/// [`LinearError::NoConvergence`].
pub fn without_zeros(a: &DMatrix<f64>, nullities: &[usize]) -> Result<DMatrix<f64>, LinearError> {
    nullities.iter().try_fold(a.clone(), |left, count| {
        let singular = decomposed(&left)?;
        Ok(compressed(&left, &singular, *count))
    })
}

fn decomposed(matrix: &DMatrix<f64>) -> Result<Singular, LinearError> {
    Singular::of(matrix).ok_or(LinearError::NoConvergence { what: "the singular value decomposition of A" })
}

/// RᵀAR, R orthogonal to the directions of the least singular values.
fn compressed(a: &DMatrix<f64>, singular: &Singular, count: usize) -> DMatrix<f64> {
    let mut order: Vec<usize> = (0..singular.values.len()).collect();
    order.sort_by(|i, j| singular.values[*i].total_cmp(&singular.values[*j]));
    let beyond = singular.v.select_columns(&order[count.min(order.len())..]);
    beyond.transpose() * a * beyond
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heading ψ, its rate and a lean with eigenvalue λ that turns: ψ' = φ, φ' = λ φ, beside a rate of decay.
    fn turning(lambda: f64) -> DMatrix<f64> {
        let plain = dmatrix![0.0, 1.0, 0.0; 0.0, lambda, 0.0; 0.0, 0.0, -3.0];
        let mixing = dmatrix![1.0, 0.4, 0.2; -0.3, 1.1, 0.5; 0.7, -0.2, 0.9];
        let inverse = mixing.clone().try_inverse().expect("regular");
        &mixing * plain * inverse
    }

    #[test]
    fn an_eigenvalue_that_crosses_zero_beside_zeros_keeps_its_size() {
        assert_eq!(nullities(&turning(0.3)).unwrap(), [1]);
        assert_eq!(nullities(&turning(0.0)).unwrap(), [1, 1]);
        for lambda in [1e-3, 1e-8, 1e-12, -1e-12] {
            let left = without_zeros(&turning(lambda), &[1]).unwrap();
            // The product of the two eigenvalues that are left.
            assert!((left.determinant() / -3.0 - lambda).abs() < 1e-14, "{lambda}");
        }
    }
}
