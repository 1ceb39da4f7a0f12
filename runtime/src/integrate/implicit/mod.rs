//! Collocation: implicit Runge–Kutta methods whose unknowns are the accelerations of the stages.
//!
//! With kᵢ = a(t + cᵢh, Qᵢ, Vᵢ), Qᵢ = q + cᵢ h q' + h² Σ (A²)ᵢⱼ kⱼ and Vᵢ = q' + h Σ aᵢⱼ kⱼ the n coordinates of s stages are
//! solved for, not their 2n states.  Simplified Newton's method falls apart along the eigenvectors of A into real and complex
//! systems of size n, P(hμ) = 1 − hμ ∂a/∂q' − h²μ² ∂a/∂q for each eigenvalue μ (Hairer and Wanner, Solving Ordinary
//! Differential Equations II, 1996, IV.8).
//!
//! The methods of Gauss are symplectic, for any mechanism, at a fixed step; that of Radau is for stiff ones.

mod dense;
mod error;
mod gauss;
mod radau;
mod stages;
mod step;
mod tableau;
#[cfg(test)]
mod tests;

pub(crate) use gauss::{GAUSS_2, GAUSS_4, GAUSS_6};
pub(crate) use radau::RADAU_5;
pub(crate) use step::Collocation;
