//! Motions that repeat.
//!
//! 1. [`Simulation::orbit`](crate::Simulation::orbit) begins an [`OrbitSearch`]: how the motion closes, and where to look: `search.rs`; guesses
//!    come from a run's near returns or from a mode: `guess.rs`.
//! 2. A motion closes when the image of its end is its start: `closing.rs`; it is cut into pieces that are run with their slopes, and found by
//!    shortest Gauss-Newton steps: `laps.rs`.  What depends on time gives the period: `drive.rs`, where it acts:
//!    `acting.rs`.
//! 3. The smallest map that closes it: `smallest.rs`; directions that are known beforehand: `structure.rs`; multipliers of the rest, by the
//!    periodic QR algorithm: `multipliers.rs`, `stability.rs`.
//! 4. From the guess to what is told: `begun.rs`; what is found: `found.rs`, and to more digits: `double_double.rs`; families of such motions: `family.rs`, and the walk along them with
//!    branches: `walk.rs`; where they change: `thresholds.rs`, and where they answer most: `peaks.rs`; stability over two parameters:
//!    `stability_map.rs`; how far methods miss its start each time that they should be back: `returns.rs`; pictures: `picture.rs`.

mod acting;
mod begun;
mod closing;
#[cfg(feature = "interpret")]
mod double_double;
mod drive;
mod family;
mod found;
mod guess;
mod laps;
mod multipliers;
mod peaks;
mod picture;
mod returns;
mod search;
mod smallest;
mod stability;
mod stability_map;
mod structure;
mod thresholds;
mod walk;

pub use family::{Family, Member, OrbitChange, Peak, Threshold};
pub use found::{ExtendedOrbit, ExtendedValue, Multiplier, Orbit};
pub use search::OrbitSearch;
pub use stability_map::{Boundary, BoundaryPoint, StabilityMap};
