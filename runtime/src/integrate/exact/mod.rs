//! Linear systems with constant coefficients, propagated exactly: e^{Ah} once, then a product a step.
//!
//! The matrix and what a step is: look in `step.rs`; the polynomial between the ends: in `dense.rs`.

mod dense;
mod step;
#[cfg(test)]
mod tests;

pub(crate) use step::{Exact, fastest_rate, longest_step, operations};
