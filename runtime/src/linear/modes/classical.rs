//! Classical damping: the damping matrix is diagonal in normal modes, so that each has its own two eigenvalues and a real shape.
//!
//! Equal eigenvalues of different modes then have as many shapes as their number by construction: an iteration on the first-order form would mix them.

use nalgebra::{Complex, DVector};

use super::{Reduction, Spectrum};
use crate::linear::matrices::symmetric_eigen;
use crate::linear::{LinearError, Linearised};
use crate::matrix::is_symmetric;

/// Parts of ΦᵀCΦ off its diagonal below this part of their terms are rounding: they change eigenvalues by the square of it.
const DECOUPLED: f64 = 1e-12;
/// Squares of frequencies that differ by this part of them are equal: as for repeated modes, 10⁶ ε.
const EQUAL: f64 = 1e6 * f64::EPSILON;

/// An eigenvalue and its shape.
type Pair = (Complex<f64>, DVector<f64>);

/// Both eigenvalues of each mode with its shape, orthonormal in M; `None` where damping couples normal modes.
///
/// λ² + c λ + k = 0 with c = φᵀCφ and k = φᵀKφ (Caughey and O'Kelly 1965).
///
/// # Errors
/// As [`super::normal_modes`].
pub fn decoupled(linear: &Linearised) -> Result<Option<Vec<Pair>>, LinearError> {
    let damping = linear.c();
    if !is_symmetric(&damping) || !is_symmetric(&linear.k()) {
        return Ok(None);
    }
    let spectrum = Spectrum::new(&linear.mass, &linear.conservative(), Reduction::Cholesky);
    let Spectrum { squares, mut shapes } = spectrum.map_err(|fault| fault.named(linear))?;
    for (first, count) in equal(&squares) {
        let space = shapes.columns(first, count).into_owned();
        let within = space.transpose() * &damping * &space;
        let failed = LinearError::NoConvergence { what: "the eigenvalue iteration" };
        let (_, turned) = symmetric_eigen((&within + within.transpose()) * 0.5).ok_or(failed)?;
        shapes.columns_mut(first, count).copy_from(&(space * turned));
    }
    let modal = shapes.transpose() * &damping * &shapes;
    let terms = shapes.abs().transpose() * damping.abs() * shapes.abs();
    let n = squares.len();
    let couples = |i: usize, j: usize| i != j && modal[(i, j)].abs() > DECOUPLED * terms[(i, j)];
    if (0..n).any(|i| (0..n).any(|j| couples(i, j))) {
        return Ok(None);
    }
    let both = |k: usize| {
        let shape = shapes.column(k).into_owned();
        roots(modal[(k, k)], squares[k]).map(|value| (value, shape.clone()))
    };
    Ok(Some((0..n).flat_map(both).collect()))
}

/// Where squares in rising order are equal: the first of them, and their number.
fn equal(squares: &[f64]) -> Vec<(usize, usize)> {
    let mut groups: Vec<(usize, usize)> = Vec::new();
    for (k, square) in squares.iter().enumerate() {
        match groups.last_mut() {
            Some((_, count)) if (square - squares[k - 1]).abs() <= EQUAL * square.abs() => *count += 1,
            _ => groups.push((k, 1)),
        }
    }
    groups.retain(|group| group.1 > 1);
    groups
}

/// Both roots of λ² + c λ + k = 0, neither by a difference of near numbers.
fn roots(c: f64, k: f64) -> [Complex<f64>; 2] {
    let (half, square) = (-0.5 * c, 0.25 * c * c - k);
    if square < 0.0 {
        let omega = (-square).sqrt();
        return [Complex::new(half, omega), Complex::new(half, -omega)];
    }
    let far = half + square.sqrt().copysign(half);
    let near = if far == 0.0 { 0.0 } else { k / far };
    [Complex::new(far, 0.0), Complex::new(near, 0.0)]
}
