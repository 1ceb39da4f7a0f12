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
mod suggest;
mod words;

use crate::place::Span;

pub use crate::place::{Place, Step};
pub use catalogue::Entry;
pub use suggest::{did_you_mean, did_you_mean_or, nearest, rate_meant};
pub use words::{counted, listed, quoted};

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

impl Problem {
    /// Whether the model can be used all the same.
    pub fn is_warning(&self) -> bool {
        self.code.starts_with('W')
    }

    /// The same problem, found in a text that stands at `place`; a span there shifts this one's.
    pub fn moved_to(self, place: &Place) -> Problem {
        let offset = place.span.map_or(0, |span| span.start);
        let span = self
            .place
            .span
            .map(|span| Span { start: span.start.saturating_add(offset), end: span.end.saturating_add(offset) });
        Problem { place: Place { span: span.or(place.span), ..place.clone() }, ..self }
    }
}
