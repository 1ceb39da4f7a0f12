//! Linear systems with constant coefficients, propagated exactly: e^{Ah} once, then a product a step.
//!
//! What a step is: look in `step.rs`; its matrices: in `propagator.rs`; what drives the system: in `force.rs`; the polynomial
//! between the ends: in `dense.rs`.

mod dense;
#[cfg(test)]
mod driven_tests;
mod force;
mod propagator;
mod step;
#[cfg(test)]
mod tests;

pub(crate) use step::{Exact, LENGTHS, fastest_rate, longest_step, operations};
