//! Clocks that tick for held noise.

use super::{System, Trigger};

/// Whether a clock ticks for noise alone.
pub(crate) fn is_of_noise<S: System + ?Sized>(system: &S, clock: usize) -> bool {
    let ticks = |event: &usize| *system.sampling().trigger(*event) == Trigger::Tick(clock as u32);
    let mut events = (0..system.description().events.len()).filter(ticks).peekable();
    let is_noise = |event: usize| system.held_noise().iter().any(|noise| noise.event as usize == event);
    events.peek().is_some() && events.all(is_noise)
}
