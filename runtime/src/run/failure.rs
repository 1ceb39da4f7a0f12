//! A run that ended early.

use std::fmt;

use super::state::plain;
use super::{Run, State};
use crate::cause::Cause;

/// A run that ended early.
#[derive(Clone)]
#[non_exhaustive]
pub struct Failure {
    /// Why.
    pub cause: Cause,
    /// When, and in which state: the last one that was accepted, unless the cause names another time.
    pub state: State,
    /// What was computed until then.
    pub run: Run,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (t = {} s", self.cause, plain(self.state.t))?;
        // A chain's hundred numbers help nobody; they are in `state`.
        if self.state.q.len() <= 4 { write!(f, "; last state {})", self.state) } else { write!(f, ")") }
    }
}

/// What `Display` says: a run's numbers would fill many screens.
impl fmt::Debug for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Failure({self})")
    }
}
