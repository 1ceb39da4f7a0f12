//! What a command finds beside its options.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

#[cfg(not(target_family = "wasm"))]
use signal_hook::consts::{SIGINT, SIGTERM};

use super::Entry;
use super::load::Loaded;

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
        self.interrupted.map_or_else(by_signals, Arc::clone)
    }
}

fn by_signals() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    #[cfg(not(target_family = "wasm"))]
    for signal in [SIGINT, SIGTERM] {
        // The flag goes first: no signal is lost that comes before the others are there.  They have a flag of their own: the first signal
        // does not end the program.  Where signals cannot be had, they end the program as they always did.
        let again = Arc::new(AtomicBool::new(false));
        let _ = signal_hook::flag::register(signal, flag.clone());
        let _ = signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, again.clone());
        let _ = signal_hook::flag::register(signal, again);
    }
    flag
}
