//! What is chosen of a motion before it begins.

use super::{Followed, Integration};
use crate::events::Ticks;

impl Integration {
    /// Fails beyond so many steps.
    pub fn limit(mut self, max_steps: u64) -> Self {
        self.max_steps = max_steps;
        self
    }

    /// Adds what rounding takes from a step to the next one, or not.
    pub fn compensate(mut self, compensated: bool) -> Self {
        self.compensated = compensated;
        self
    }

    /// Divides the way to a stop otherwise than usual and lets steps grow more slowly, or not: steps that neither the
    /// tolerance nor the equations limit are others than usual.
    pub fn decorrelate_steps(mut self, decorrelate_steps: bool) -> Self {
        self.decorrelate_steps = decorrelate_steps;
        self
    }

    /// Takes no steps that are longer than those of another run allow.
    pub fn following(mut self, followed: Option<Followed>) -> Self {
        self.followed = followed;
        self
    }

    /// Begins beside this state, moved by rounding, which decides what is at its zero.
    pub fn beginning_beside(mut self, start: Option<Vec<f64>>) -> Self {
        self.beside = start;
        self
    }

    /// Goes on with a run whose components were in these ranges.
    pub fn having_seen(mut self, seen: Option<[Vec<f64>; 2]>) -> Self {
        self.seen_before = seen;
        self
    }

    /// Ends where this event happens, in the state after it.
    pub fn ending_after(mut self, event: Option<usize>) -> Self {
        self.ends_after = event;
        self
    }

    /// With these clocks.
    pub fn ticking(mut self, ticks: Ticks) -> Self {
        self.ticks = ticks;
        self
    }

    /// Lets these events do nothing.
    pub fn ignoring(mut self, events: Vec<usize>) -> Self {
        self.ignored_events = events;
        self
    }

    /// Brings states back to the constraints, or only measures how far they are from them.
    pub fn projecting(mut self, projects: bool) -> Self {
        self.projects = projects;
        self
    }

    /// Chooses Baumgarte's gain by the steps that are taken at first.
    pub fn finding_gain(mut self) -> Self {
        self.finds_gain = true;
        self
    }
}
