//! How far a run can be trusted.

mod conditioning;
mod drift;
mod ends;
mod gimbals;
mod inertia;
mod reactions;
mod stability;
#[cfg(test)]
mod tests;
mod warning;

pub(crate) use conditioning::ConditionMonitor;
pub use conditioning::Conditioning;
pub use drift::Drift;
pub(crate) use drift::Monitor;
pub(crate) use ends::ends_that_meet;
pub(crate) use gimbals::{GimbalGuard, explain_lock, lock_here};
pub(crate) use inertia::{InertiaGuard, inertia_condition, positive_inertia};
pub(crate) use reactions::{deciding, not_unique};
pub(crate) use stability::{Watchman, all_rates, check_step, rates, rates_however_many};
pub use warning::{Loss, Warning};
