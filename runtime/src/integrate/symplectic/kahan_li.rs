//! Kahan and Li's composition of order 8.

use super::tableau::{Splitting, composed};

/// s17odr8a: seventeen steps of Störmer and Verlet, some of them backwards, order 8.
///
/// Source: Kahan and Li, Math. Comp. 66 (1997) 1089; Hairer, Lubich, Wanner, Geometric Numerical Integration (2006),
/// V.3.2, equation (3.11).
pub(crate) const KAHAN_LI_8: &Splitting =
    &Splitting { order: 8, kicks: &COMPOSED.0, drifts: &COMPOSED.1, needs_middle: true };

const COMPOSED: ([f64; 18], [f64; 17]) = composed([W1, W2, W3, W4, W5, W6, W7, W8, W9, W8, W7, W6, W5, W4, W3, W2, W1]);

const W1: f64 = 0.130_202_483_088_890_08;
const W2: f64 = 0.561_162_981_775_108_4;
const W3: f64 = -0.389_474_962_644_847_3;
const W4: f64 = 0.158_841_906_555_155_6;
const W5: f64 = -0.395_903_894_133_237_6;
const W6: f64 = 0.184_539_640_978_315_7;
const W7: f64 = 0.258_374_387_686_322_05;
const W8: f64 = 0.295_011_723_609_310_3;
const W9: f64 = 1.0 - 2.0 * (W1 + W2 + W3 + W4 + W5 + W6 + W7 + W8);
