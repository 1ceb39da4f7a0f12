//! Taylor's method: a step is as long as the motion's power series at its start is known to the tolerance.
//!
//! 1. Coefficients, order by order, from those of M, h, J and γ: look in `expansion.rs`.
//! 2. The step: look in `step.rs`; its dense output in `dense.rs`.

mod dense;
mod expansion;
mod step;

use crate::mechanism::SERIES_TERMS;

pub(super) use step::Taylor;

/// The order.
pub(super) const ORDER: usize = SERIES_TERMS - 1;
