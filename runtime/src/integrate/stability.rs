//! What a step multiplies a mode by.

use nalgebra::Complex;

use super::nystrom::Tableau as Nystrom;
use super::symplectic::Splitting;

/// The stability function of a method: a step of h multiplies y' = λy by R(z), z = hλ.
#[derive(Clone, Debug)]
pub(crate) enum Stability {
    /// R(z) = Σ cₖzᵏ.
    Polynomial(Vec<f64>),
    /// R(z) = P(z)/Q(z).
    Rational(Rational),
    /// R(z) = eᶻ.
    Exponential,
    /// For methods that know only pairs ±λ of modes of q'' = λ² q.
    Splitting(&'static Splitting),
    /// As these.
    Nystrom(&'static Nystrom),
}

impl Stability {
    /// |R(z)|; of a pair of modes that of the one that grows more.
    pub fn amplification(&self, z: Complex<f64>) -> f64 {
        match self {
            Stability::Polynomial(coefficients) => polynomial(coefficients, z).norm(),
            Stability::Rational(Rational { above, below }) => (polynomial(above, z) / polynomial(below, z)).norm(),
            Stability::Exponential => z.re.exp(),
            Stability::Splitting(scheme) => scheme.amplification(z),
            Stability::Nystrom(tableau) => tableau.amplification(z),
        }
    }
}

/// Coefficients of P and Q.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rational {
    pub above: &'static [f64],
    pub below: &'static [f64],
}

/// Σ cₖzᵏ.
fn polynomial(coefficients: &[f64], z: Complex<f64>) -> Complex<f64> {
    coefficients.iter().rev().fold(Complex::new(0.0, 0.0), |sum, c| sum * z + c)
}
