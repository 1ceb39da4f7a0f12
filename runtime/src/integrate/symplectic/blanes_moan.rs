//! Blanes and Moan's splitting of order 4 for kinetic energies quadratic in the speeds.

use super::tableau::Splitting;

/// SRKN₆ᵇ: six evaluations a step, order 4; stable for hω ≤ 3.16.
///
/// Source: Blanes and Moan, J. Comp. Appl. Math. 142 (2002) 313, table 3.
pub(crate) const SRKN4: &Splitting = &Splitting {
    order: 4,
    kicks: &[B1, B2, B3, B4, B3, B2, B1],
    drifts: &[A1, A2, A3, A3, A2, A1],
    needs_middle: false,
};

const B1: f64 = 0.082_984_406_417_405_2;
const B2: f64 = 0.396_309_801_498_368;
const B3: f64 = -0.039_056_304_922_348_6;
const B4: f64 = 1.0 - 2.0 * (B1 + B2 + B3);
const A1: f64 = 0.245_298_957_184_271;
const A2: f64 = 0.604_872_665_711_080;
const A3: f64 = 0.5 - (A1 + A2);
