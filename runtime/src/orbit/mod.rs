//! Motions that repeat.
//!
//! 1. [`Simulation::orbit`](crate::Simulation::orbit) begins an [`OrbitSearch`]: how the motion closes, and where to look: `search.rs`; guesses
//!    come from a run's near returns or from a mode: `guess.rs`.
//! 2. A motion closes when the image of its end is its start: `closing.rs`; it is cut into pieces that are run with their slopes, and found by
//!    shortest Gauss-Newton steps: `laps.rs`.  What depends on time gives the period: `drive.rs`.
//! 3. The smallest map that closes it: `smallest.rs`; directions that are known beforehand: `structure.rs`; multipliers of the rest, by the
//!    periodic QR algorithm: `multipliers.rs`, `stability.rs`.
//! 4. What is found: `found.rs`.

mod closing;
mod drive;
mod found;
mod guess;
mod laps;
mod multipliers;
mod search;
mod smallest;
mod stability;
mod structure;

pub use found::{Multiplier, Orbit};
pub use search::OrbitSearch;
