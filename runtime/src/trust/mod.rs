//! How far a run can be trusted.

mod drift;
mod report;
mod warning;

pub use drift::Drift;
pub(crate) use drift::Monitor;
pub use report::Trust;
pub use warning::Warning;
