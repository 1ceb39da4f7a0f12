//! What a command finds beside its options.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use super::load::Loaded;
use super::{Entry, signals};

/// The models that go by a name, one that is loaded already, and what interrupts.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The library.
    pub models: &'a [Entry],
    /// A model that was derived before the command; its name goes before the library's.
    pub kept: Option<&'a Loaded>,
    /// What interrupts; `None`: Ctrl-C and SIGTERM.
    pub interrupted: Option<&'a Arc<AtomicBool>>,
}

impl<'a> Context<'a> {
    /// The library alone, interrupted by signals.
    pub fn of(models: &'a [Entry]) -> Self {
        Context { models, kept: None, interrupted: None }
    }

    /// The model of this name that is loaded already.
    pub fn kept(&self, name: &str) -> Option<&'a Loaded> {
        self.kept.filter(|kept| kept.name == name)
    }

    /// True from the first interruption on; a second Ctrl-C ends the program.
    pub fn interruption(&self) -> Arc<AtomicBool> {
        self.interrupted.map_or_else(signals::awaited, Arc::clone)
    }
}
