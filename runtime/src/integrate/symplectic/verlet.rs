//! The method of Störmer and Verlet, in its form with speeds.

use super::tableau::Splitting;

/// q'½ = q' + h/2 q''(q), q₁ = q + h q'½, q'₁ = q'½ + h/2 q''(q₁), order 2, one evaluation a step.
///
/// Stable for hω ≤ 2.  Source: Hairer, Lubich, Wanner, Acta Numerica 12 (2003) 399.
pub(crate) const VERLET: &Splitting = &Splitting { order: 2, kicks: &[0.5, 0.5], drifts: &[1.0], needs_middle: false };
