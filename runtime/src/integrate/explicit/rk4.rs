//! The classical method of Runge and Kutta.

use super::tableau::{Estimate, Scheme, Tableau, r};
use crate::integrate::NO_CONTROL;

/// Four stages, order 4.  Stable for vibrations up to hω = 2√2 (catalogue A1).
///
/// Source: Kutta, Z. Math. Phys. 46 (1901) 435.
pub(crate) const RK4: &Tableau = &Tableau {
    order: 4,
    rows: &[(0.0, &[]), (0.5, &[r(0, 1, 2)]), (0.5, &[r(1, 1, 2)]), (1.0, &[r(2, 1, 1)])],
    weights: &[r(0, 1, 6), r(1, 1, 3), r(2, 1, 3), r(3, 1, 6)],
    first_same_as_last: false,
    estimate: Estimate::None,
    dense_rows: &[],
    dense: &[],
    control: NO_CONTROL,
};

/// [`RK4`] as a type.
pub(crate) struct Rk4;

impl Scheme for Rk4 {
    const TABLEAU: &'static Tableau = RK4;
}
