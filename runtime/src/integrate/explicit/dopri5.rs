//! Dormand and Prince's method of order 5 with an error estimate of order 4 and dense output of order 4.

use super::tableau::{Estimate, Scheme, Tableau, Term, r};
use crate::integrate::{Control, SAFETY};

/// Seven stages, the last of which is the next step's first, order 5.
///
/// Source: Dormand and Prince, J. Comp. Appl. Math. 6 (1980) 19; dense output by Shampine, as in Hairer,
/// Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.6.
pub(crate) const DOPRI5: &Tableau = &Tableau {
    order: 5,
    rows: &ROWS,
    weights: WEIGHTS,
    first_same_as_last: true,
    estimate: Estimate::Single(ERROR),
    dense_rows: &[],
    dense: &[DENSE],
    control: Control { exponent: 1.0 / 5.0, safety: SAFETY, shrink: 0.2, grow: 10.0, at_first: 6.0, stiff: 3.25 },
};

/// [`DOPRI5`] as a type.
pub(crate) struct Dopri5;

impl Scheme for Dopri5 {
    const TABLEAU: &'static Tableau = DOPRI5;
}

const ROWS: [(f64, &[Term]); 7] = [
    (0.0, &[]),
    (0.2, &[r(0, 1, 5)]),
    (0.3, &[r(0, 3, 40), r(1, 9, 40)]),
    (0.8, &[r(0, 44, 45), r(1, -56, 15), r(2, 32, 9)]),
    (8.0 / 9.0, &[r(0, 19372, 6561), r(1, -25360, 2187), r(2, 64448, 6561), r(3, -212, 729)]),
    (1.0, &[r(0, 9017, 3168), r(1, -355, 33), r(2, 46732, 5247), r(3, 49, 176), r(4, -5103, 18656)]),
    (1.0, WEIGHTS),
];

const WEIGHTS: &[Term] = &[r(0, 35, 384), r(2, 500, 1113), r(3, 125, 192), r(4, -2187, 6784), r(5, 11, 84)];

/// Weights less those of the embedded method of order 4.
const ERROR: &[Term] =
    &[r(0, 71, 57600), r(2, -71, 16695), r(3, 71, 1920), r(4, -17253, 339200), r(5, 22, 525), r(6, -1, 40)];

const DENSE: &[Term] = &[
    r(0, -12715105075, 11282082432),
    r(2, 87487479700, 32700410799),
    r(3, -10690763975, 1880347072),
    r(4, 701980252875, 199316789632),
    r(5, -1453857185, 822651844),
    r(6, 69997945, 29380423),
];
