//! What happens along a motion: events, discontinuities, and features that a step might jump over.
//!
//! 1. The event functions and the arguments of the switches, with their rates, along the dense output of a step: look in
//!    `sample.rs`; arguments of local functions inside them and inside the equations of motion: in `arguments.rs`.
//! 2. All their zeros within the step are found, hidden pairs included: look in `certify.rs`, `root.rs` and `scan.rs`.
//! 3. Steps that jumped over a feature of the equations are cut: look in `features.rs`.
//! 4. At a discontinuity the modes are chosen anew: look in `modes.rs`; where arguments go under each combination of sides: in
//!    `combinations.rs`; what inputs that turn sharply do to the speeds: in `impulse.rs`.
//! 5. Discontinuities of time are known beforehand: look in `stops.rs`; on which sides of them a motion begins: in
//!    `sides.rs`; those of inputs that are closures are scanned for: in `signals.rs`; ticks of clocks: in
//!    `ticks.rs`.

use crate::mechanism::System;

mod arguments;
mod certify;
#[cfg(test)]
mod certify_tests;
mod combinations;
pub(crate) mod draws;
mod features;
mod impulse;
mod locator;
mod modes;
mod root;
mod sample;
mod scan;
mod sides;
mod signals;
mod stops;
#[cfg(test)]
mod tests;
mod ticks;

#[cfg(feature = "ensemble")]
pub(crate) use features::{excludes_feature, ratio as calm_ratio};
pub use impulse::Impulse;
pub(crate) use impulse::{gained, impulse};
pub(crate) use locator::{EventLocator, Fired, Interruption, RESTARTS, Switched};
pub(crate) use modes::OwnedSegment;
pub(crate) use modes::mode as switch_mode;
pub(crate) use modes::text as switch_text;
pub(crate) use root::{Around, locate};
pub(crate) use scan::Crossing;
pub(crate) use sides::{begin_at, begin_at_state};
pub(crate) use signals::WIDTH as CLOSURE_WIDTH;
pub(crate) use ticks::Ticks;

/// Where events are noted.
pub(crate) trait Log {
    /// Notes an event in a state; `ends` tells whether it ends the run.
    fn event<S: System + ?Sized>(&mut self, system: &S, event: usize, t: f64, y: &[f64], ends: bool);

    /// Notes what the function of an event does that is no event.
    fn note(&mut self, note: EventNote);
}

/// What the function of an event does that is no event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct EventNote {
    /// The event's name.
    pub event: String,
    /// When, s.
    pub t: f64,
    /// What.
    pub what: Remarkable,
}

/// What an event's function may do beside crossing zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Remarkable {
    /// It comes to zero and turns back.
    Touch,
    /// It changes its sign by a jump or through a pole.
    Jump,
    /// It ceases or begins to be defined.
    Edge,
}
