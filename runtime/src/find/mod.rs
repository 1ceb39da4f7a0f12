//! Starts, parameters and end times for which a motion does what is wanted.
//!
//! 1. [`Simulation::find`](crate::Simulation::find) begins a [`Search`]: what is unknown, and what is wanted of it: look in `search.rs`.
//!    What a model file asks for in `motions` begins one, too: `asked.rs`.
//! 2. A trial is a run with its slopes: look in `trial.rs`.
//! 3. Conditions are met, and records followed, by shortest Gauss-Newton steps: look in `newton.rs`; largest and smallest values are found
//!    by Newton's steps on exact gradients: `extreme.rs`.
//! 4. Where slopes vanish at a root, fewer digits hold: `multiple.rs`; how many hold at all: `errors.rs`.
//! 5. What is found: `found.rs`; how well a record determines it: `fit.rs`; where residuals stay, by the slopes of the gradient: `least.rs`.
//! 6. Pictures: `picture.rs`.

mod asked;
mod errors;
mod extreme;
mod fit;
mod found;
mod least;
mod multiple;
mod newton;
mod picture;
mod search;
mod trial;

#[cfg(feature = "cli")]
pub(crate) use asked::another;
pub use fit::{Fit, Record};
pub use found::{Found, Value};
pub(crate) use newton::Linearised;
pub use search::Search;
