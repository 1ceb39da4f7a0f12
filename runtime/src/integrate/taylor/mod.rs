//! Taylor's method: a step is as long as the motion's power series at its start is known to the tolerance.
//!
//! 1. Coefficients, order by order, from those of M, h, J and γ: look in `expansion.rs`.
//! 2. The step: look in `step.rs`; its dense output in `dense.rs`.

mod dense;
mod expansion;
mod step;

pub(super) use step::Taylor;

/// The order.  The work of a step grows with its square, its length tends to the radius of convergence: unrolled prototypes of four scenes cost
/// the same within a tenth with three orders more or fewer than the best, which was 14 to 24 at tolerances from 10⁻⁹ to 10⁻¹⁶.
pub(super) const ORDER: usize = 20;
