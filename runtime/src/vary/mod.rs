//! How a motion changes with its start and with parameters.
//!
//! 1. [`Simulation::slopes`](crate::Simulation::slopes) runs a motion and follows it with columns, one for each unknown: look in `flow.rs`.
//! 2. Columns obey the variational equations: look in `variational.rs`; their accelerations come from the generated functions on numbers
//!    with a slope ([`System::slopes`]): `response.rs`.
//! 3. Where they start: `start.rs`; on constraints: `constraints.rs`; across events, impacts and switches: `junction.rs`.
//! 4. A piece of a motion with the slopes by all of its start, of which orbits are made: `leg.rs`.

mod constraints;
mod flow;
mod junction;
mod leg;
mod momenta;
mod response;
mod second;
mod slopes;
mod start;
mod variational;

use crate::error::NoSlopes;
#[cfg(feature = "cli")]
pub(crate) use flow::no_share_decides;
pub(crate) use junction::put;
pub(crate) use leg::{Leg, leg};
pub(crate) use response::Response;
pub(crate) use second::{Second, TOLD, finer, second};
#[cfg(feature = "cli")]
pub(crate) use slopes::run_with_slopes;
pub(crate) use slopes::{Point, Varied, named, unknown, varied};
pub use slopes::{Slope, Slopes};

/// Something that a motion depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unknown {
    /// A number of the start [q; q'].
    Start(usize),
    /// A free parameter.
    Parameter(usize),
}
