//! Euler's method.

use super::tableau::{Estimate, Scheme, Tableau, r};
use crate::integrate::NO_CONTROL;

/// y₁ = y + h f(t, y), order 1.  Amplifies every undamped vibration (catalogue A1).
///
/// Source: Euler, Institutionum calculi integralis I (1768), §650.
pub(crate) const EULER: &Tableau = &Tableau {
    order: 1,
    rows: &[(0.0, &[])],
    weights: &[r(0, 1, 1)],
    first_same_as_last: false,
    estimate: Estimate::None,
    dense_rows: &[],
    dense: &[],
    control: NO_CONTROL,
};

/// [`EULER`] as a type.
pub(crate) struct Euler;

impl Scheme for Euler {
    const TABLEAU: &'static Tableau = EULER;
}
