//! Where a mechanism rests or moves steadily, what is free there, and its matrices for small departures.

#[cfg(feature = "modal")]
mod candidate;
mod corner;
mod discontinuity;
mod family;
mod least_steps;
mod linearise;
mod point;
#[cfg(feature = "modal")]
mod sampled;
mod search;
#[cfg(feature = "modal")]
mod state_space;
mod timed;
mod trim;

#[cfg(test)]
pub(super) mod tests;

pub use discontinuity::Jump;
pub use family::ZeroStiffness;
pub(super) use family::{RELAXATIONS, beside};
pub(super) use linearise::linearised_at;
pub use linearise::{Linearised, linearise, state_matrix};
pub(super) use point::LinearisationPoint;
pub(crate) use point::force_unit;
#[cfg(feature = "modal")]
pub use sampled::{SampledLoop, linearise_sampled};
#[cfg(all(feature = "cli", feature = "modal"))]
pub(crate) use sampled::{periods, ticking};
pub(super) use search::ConvergenceHistory;
pub use search::{Equilibrium, Guess, equilibria, equilibrium_here, equilibrium_near};
#[cfg(feature = "modal")]
pub use state_space::{StateSpace, linearise_states};
pub use trim::{Trimmed, TrimmedValue, Unknown, trim, trim_steady};
