//! The coefficients of a collocation method.

use nalgebra::Complex;

use crate::integrate::{Control, Rational};

/// No method here has more stages.
pub(crate) const STAGES: usize = 3;

/// A coefficient as a multiple of 2⁻²⁰ and the rest, 70 bits together.
///
/// A coefficient that is rounded makes the same error in every step, so that energies drift; products that are rounded
/// make errors of either sign (Hairer, McLachlan, Razakarivony, BIT 48 (2008) 231).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Split(pub f64, pub f64);

impl Split {
    /// The number nearest to it.
    pub fn value(self) -> f64 {
        self.0 + self.1
    }
}

/// Σ cⱼ xⱼ.
#[inline(always)]
pub(super) fn sum(row: &[Split], x: impl Fn(usize) -> f64) -> f64 {
    let (mut high, mut low) = (0.0, 0.0);
    for (j, c) in row.iter().enumerate() {
        let x = x(j);
        high += c.0 * x;
        low += c.1 * x;
    }
    high + low
}

/// An eigenvalue, its right and its left eigenvector.
type Eigen<T> = (T, [T; STAGES], [T; STAGES]);

/// A collocation method of s stages.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Order of the solution.
    pub order: u32,
    /// cᵢ.
    pub nodes: &'static [Split],
    /// aᵢⱼ, row by row: Vᵢ = q' + h Σ aᵢⱼ kⱼ.
    pub speeds: &'static [Split],
    /// (A²)ᵢⱼ, row by row: Qᵢ = q + cᵢ h q' + h² Σ (A²)ᵢⱼ kⱼ.
    pub places: &'static [Split],
    /// bⱼ: q'₁ = q' + h Σ bⱼ kⱼ.
    pub speed_weights: &'static [Split],
    /// (bᵀA)ⱼ: q₁ = q + h q' + h² Σ (bᵀA)ⱼ kⱼ.
    pub place_weights: &'static [Split],
    /// The real eigenvalue of A, its right and its left eigenvector.
    pub real: Option<Eigen<f64>>,
    /// The complex eigenvalue of A with a positive imaginary part, its right and its left eigenvector.
    pub complex: Option<Eigen<Complex<f64>>>,
    /// Weights of the error estimate; nothing: for fixed steps only.
    pub estimate: Option<[f64; STAGES]>,
    /// R(z).
    pub stability: Rational,
    /// Step-size control.
    pub control: Control,
}

impl Tableau {
    /// s.
    pub fn stages(&self) -> usize {
        self.nodes.len()
    }
}

/// x + iy.
pub(super) const fn z(re: f64, im: f64) -> Complex<f64> {
    Complex::new(re, im)
}
