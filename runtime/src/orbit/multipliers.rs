//! Multipliers of a product of matrices, without the product.

use nalgebra::{Complex, DMatrix};

/// Sweeps of orthogonal iteration: eigenvalues whose sizes differ by a factor of 1.7 or more are told apart to all digits.
const SWEEPS: usize = 60;
/// What is no more than so many roundings is rounding: a few for each product.  Subspaces that the last sweep turned by no more are told
/// apart; within others the eigenvalues are of one size, or a pair, and may be taken from a product.  Where a factor leaves no more of a
/// direction, it leaves nothing.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// A multiplier of a map, as its modulus' logarithm and its angle: it may be too small for a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polar {
    /// ln |μ|; −∞ for 0, also where it is 0 but for rounding.
    pub log: f64,
    /// arg μ, rad, from −π to π.
    pub angle: f64,
}

/// The eigenvalues of A_N … A_2 A_1, the largest first, by orthogonal iteration over the factors (the periodic QR algorithm): triangular
/// factors are multiplied element by element as logarithms, and only blocks whose eigenvalues are of one size are multiplied out.
///
/// Source: Bojanczyk, Golub, Van Dooren, The periodic Schur decomposition, Proc. SPIE 1770 (1992) 31; Lust, Int. J. Bifurcation and Chaos
/// 11 (2001) 2389.
pub(super) fn multipliers(factors: &[DMatrix<f64>]) -> Vec<Polar> {
    let m = factors.first().map_or(0, |factor| factor.ncols());
    if m == 0 || factors.iter().any(|factor| factor.iter().any(|x| !x.is_finite())) {
        return Vec::new();
    }
    let mut q = DMatrix::<f64>::identity(m, m);
    let mut first = q.clone();
    let mut triangles = Vec::new();
    for _ in 0..SWEEPS {
        triangles.clear();
        first.copy_from(&q);
        for factor in factors {
            let qr = (factor * &q).qr();
            q = qr.q();
            triangles.push(qr.r());
        }
    }
    // A_N … A_1 = Q_N R Q₀ᵀ has the eigenvalues of Q₀ᵀ Q_N R.
    let turn = first.transpose() * &q;
    let mut found = Vec::with_capacity(m);
    let mut from = 0;
    while from < m {
        let mut to = from + 1;
        while to < m && turn.view((to, 0), (m - to, to)).norm() > ROUNDINGS {
            to += 1;
        }
        found.extend(block(&triangles, &turn, from, to));
        from = to;
    }
    found.sort_by(|a, b| b.log.total_cmp(&a.log));
    found
}

/// The eigenvalues of a diagonal block, multiplied out with its size taken out step by step.
fn block(triangles: &[DMatrix<f64>], turn: &DMatrix<f64>, from: usize, to: usize) -> Vec<Polar> {
    let size = to - from;
    let mut product = DMatrix::<f64>::identity(size, size);
    let mut log = 0.0;
    for triangle in triangles {
        product = triangle.view((from, from), (size, size)) * product;
        let norm = product.norm();
        if norm <= ROUNDINGS * triangle.norm() {
            return vec![Polar { log: f64::NEG_INFINITY, angle: 0.0 }; size];
        }
        product /= norm;
        log += norm.ln();
    }
    let product = turn.view((from, from), (size, size)) * product;
    let polar = |value: &Complex<f64>| Polar { log: log + value.norm().ln(), angle: value.arg() };
    product.complex_eigenvalues().iter().map(polar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_that_no_product_holds_are_found() {
        // S D S⁻¹ in forty factors with bases that differ, eigenvalues 2, −0.5, 1e−100 (|ln| 230).
        let basis = |k: usize| {
            DMatrix::from_fn(3, 3, |i, j| if i == j { 2.0 } else { 0.6 * ((3 * i + j + 5 * k) as f64).sin() })
        };
        let count = 40;
        let root = |x: f64| x.powf(1.0 / count as f64);
        let factor = |k: usize| {
            let sign = if k == 0 { -1.0 } else { 1.0 };
            let d = DMatrix::from_diagonal(&nalgebra::DVector::from_row_slice(&[
                root(2.0),
                sign * root(0.5),
                root(1e-100),
            ]));
            basis((k + 1) % count) * d * basis(k).try_inverse().expect("a basis")
        };
        let found = multipliers(&(0..count).map(factor).collect::<Vec<_>>());
        let expected = [(2.0_f64.ln(), 0.0), (0.5_f64.ln(), std::f64::consts::PI), (-100.0 * 10.0_f64.ln(), 0.0)];
        for (polar, (log, angle)) in found.iter().zip(expected) {
            assert!((polar.log - log).abs() < 1e-11, "{polar:?} {log}");
            assert!((polar.angle.abs() - angle).abs() < 1e-11);
        }
    }

    #[test]
    fn pairs_on_the_unit_circle_are_found_together() {
        // Two rotations in coupled planes.
        let turned = |angle: f64| DMatrix::from_row_slice(2, 2, &[angle.cos(), -angle.sin(), angle.sin(), angle.cos()]);
        let mut a = DMatrix::<f64>::zeros(4, 4);
        a.view_mut((0, 0), (2, 2)).copy_from(&turned(0.3));
        a.view_mut((2, 2), (2, 2)).copy_from(&turned(0.1));
        let s = DMatrix::from_fn(4, 4, |i, j| if i == j { 1.5 } else { 0.3 * ((i + 4 * j) as f64).cos() });
        let a = &s * a * s.clone().try_inverse().expect("a basis");
        let mut angles: Vec<f64> = multipliers(&[a.clone(), a]).iter().map(|polar| polar.angle.abs()).collect();
        angles.sort_by(f64::total_cmp);
        for (angle, expected) in angles.iter().zip([0.2, 0.2, 0.6, 0.6]) {
            assert!((angle - expected).abs() < 1e-12, "{angle}");
        }
    }

    #[test]
    fn a_factor_that_loses_a_dimension_makes_a_zero() {
        let a = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]);
        let found = multipliers(&[a, DMatrix::identity(2, 2)]);
        assert!((found[0].log - 5.0_f64.ln()).abs() < 1e-14);
        assert_eq!(found[1].log, f64::NEG_INFINITY);
    }
}
