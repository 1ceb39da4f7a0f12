//! Where a mechanism rests or moves steadily, what is free there, and its matrices for small departures.

mod discontinuity;
mod family;
mod linearise;
mod probe;
mod search;
mod timed;

#[cfg(test)]
pub(super) mod tests;

pub use discontinuity::Jump;
pub use family::Freedom;
pub(super) use family::{RELAXATIONS, beside};
pub(super) use linearise::linearised_at;
pub use linearise::{Linearised, linearise, state_matrix};
pub(super) use probe::Probe;
pub(crate) use probe::force_unit;
pub(super) use search::Pace;
pub use search::{Equilibrium, Guess, equilibria, equilibrium_here, equilibrium_near};
