//! The explicit midpoint rule.

use super::tableau::{Estimate, Scheme, Tableau, r};
use crate::integrate::NO_CONTROL;

/// y₁ = y + h f(t + h/2, y + h f/2), order 2.  Amplifies every undamped vibration, slowly (catalogue A2).
///
/// Source: Runge, Math. Ann. 46 (1895) 167.
pub(crate) const MIDPOINT: &Tableau = &Tableau {
    order: 2,
    rows: &[(0.0, &[]), (0.5, &[r(0, 1, 2)])],
    weights: &[r(1, 1, 1)],
    first_same_as_last: false,
    estimate: Estimate::None,
    dense_rows: &[],
    dense: &[],
    control: NO_CONTROL,
};

/// [`MIDPOINT`] as a type.
pub(crate) struct Midpoint;

impl Scheme for Midpoint {
    const TABLEAU: &'static Tableau = MIDPOINT;
}
