//! What can be wrong with a model file, and how it is told.
//!
//! Every problem is one entry of the [`catalogue`]: a code, a message, a label for the caret and help.
//! Each entry has a constructor of its own, so that no message is written anywhere else:
//!
//! ```
//! use dalembert_symbolic::diagnose::{Place, catalogue::names, did_you_mean};
//!
//! let place = Place::default().key("define").key("a");
//! let problem = names::unknown_name(place, "thta", did_you_mean("thta", ["theta", "phi"]));
//! assert_eq!(problem.message, "unknown name `thta`");
//! assert_eq!(problem.help, "did you mean `theta`?");
//! ```

pub mod catalogue;
mod place;
mod render;
mod suggest;

use crate::language::Span;

pub use catalogue::Entry;
pub use render::render;
pub use suggest::{did_you_mean, did_you_mean_or, nearest};

/// One thing that is wrong with a model file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The entry of the catalogue, `E201`; with `W` for a warning.
    pub code: &'static str,
    /// One line, lower case, naming the offender in backticks.
    pub message: String,
    /// What stands under the caret; boxed, so that a `Result<T, Problem>` stays small.
    pub label: Box<str>,
    /// A way out; may be empty.
    pub help: String,
    /// Where in the file.
    pub place: Place,
}

/// Where in a model file: a path of keys and indices, and then perhaps some bytes of the scalar there.
///
/// With an empty path the span counts bytes of the file itself; that is how errors of YAML's own syntax are placed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Place {
    /// From the root down.
    pub path: Vec<Step>,
    /// True when the key itself is meant, not its value.
    pub key: bool,
    /// Bytes of the scalar's (or key's) text; `None`: all of it.
    pub span: Option<Span>,
}

/// One step down into a YAML file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Step {
    /// Into a mapping, by the key as written.
    Key(String),
    /// Into a list.
    Index(usize),
}
