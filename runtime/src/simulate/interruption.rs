//! What ends runs early from outside.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether runs are to end, as is said from outside; none unless somebody may say so.
#[derive(Clone, Debug, Default)]
pub(crate) struct Interruption(Option<Arc<AtomicBool>>);

impl Interruption {
    /// Whether it was said.
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|asked| asked.load(Ordering::Relaxed))
    }
}

#[cfg(feature = "cli")]
impl From<Arc<AtomicBool>> for Interruption {
    fn from(asked: Arc<AtomicBool>) -> Interruption {
        Interruption(Some(asked))
    }
}

/// Runs are the same, whoever may end them.
impl PartialEq for Interruption {
    fn eq(&self, _: &Interruption) -> bool {
        true
    }
}
