//! The coefficients of a Rosenbrock method.

use crate::integrate::{Control, Rational};

/// No method here has more stages.
pub(crate) const STAGES: usize = 8;

/// A Rosenbrock method whose last stages are the increments of embedded solutions (stiffly accurate): the solution is the
/// argument of a stage after the last, and the last U is the error estimate.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Order of the solution.
    pub order: u32,
    /// γ.
    pub gamma: f64,
    /// aᵢⱼ; a line more, with the weights of the solution.
    pub arguments: &'static [&'static [f64]],
    /// cᵢⱼ.
    pub couplings: &'static [&'static [f64]],
    /// cᵢ.
    pub nodes: &'static [f64],
    /// dᵢ, weights of ∂f/∂t.
    pub times: &'static [f64],
    /// Weights of k₁, k₂, k₃ in y + θ(Δ + (1−θ)(k₁ + θ(k₂ + θ k₃))).
    pub dense: [[f64; STAGES]; 3],
    /// R(z).
    pub stability: Rational,
    /// Step-size control.
    pub control: Control,
}
