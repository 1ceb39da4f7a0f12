//! Mechanisms described in YAML: derived, compiled, integrated, linearised and judged.

#[cfg(feature = "cli")]
pub mod cli;
mod error;
mod events;
mod integrate;
pub mod mechanism;
pub mod prelude;
mod run;
pub mod show;
mod simulate;
#[cfg(test)]
mod testing;
pub mod trust;

pub use dalembert_macros::model;
pub use error::{Cause, Error, Failure};
pub use integrate::{Method, ParseMethodError};
pub use run::{Occurrence, Run, State, Work};
pub use simulate::{Settings, Simulate, Simulation, StateMut, Stepping, simulate, simulate_with};
