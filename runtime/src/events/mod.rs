//! What happens along a motion: events and discontinuities.
//!
//! 1. The event functions and the arguments of the switches are sampled on the dense output of a step:
//!    look in `sample.rs`.
//! 2. All their zeros within the step are found, hidden pairs included: look in `scan.rs` and `root.rs`.
//! 3. At a discontinuity the modes are chosen anew: look in `modes.rs`.
//! 4. Discontinuities of time are known beforehand: look in `stops.rs`.

use crate::mechanism::System;

mod modes;
mod root;
mod sample;
mod scan;
mod stops;
#[cfg(test)]
mod tests;
mod watch;

pub(crate) use watch::{Interruption, Watch};

/// Where events are noted.
pub(crate) trait Log {
    /// Notes an event in a state; `ends` tells whether it ends the run.
    fn event<S: System + ?Sized>(&mut self, system: &S, event: usize, t: f64, y: &[f64], ends: bool);
}
