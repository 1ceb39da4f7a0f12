//! Suzuki's composition of order 4.

use super::tableau::{Splitting, composed};

/// Five steps of Störmer and Verlet, the third backwards, order 4; stable for hω ≤ 2.72.
///
/// Source: Suzuki, Phys. Lett. A 146 (1990) 319; Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), II.4, example
/// 4.3.
pub(crate) const SUZUKI_4: &Splitting =
    &Splitting { order: 4, kicks: &COMPOSED.0, drifts: &COMPOSED.1, needs_middle: false };

const COMPOSED: ([f64; 6], [f64; 5]) = composed([W, W, 1.0 - 4.0 * W, W, W]);

/// 1/(4 − ∛4).
const W: f64 = 0.414_490_771_794_375_74;
