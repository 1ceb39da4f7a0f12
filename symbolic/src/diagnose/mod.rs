//! What can be wrong with a model file, and how it is told.

use crate::language::Span;

/// One thing that is wrong with a model file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The entry of the catalogue, `E012`.
    pub code: &'static str,
    /// One line, lower case, naming the offender in backticks.
    pub message: String,
    /// What stands under the caret.
    pub label: String,
    /// A way out; may be empty.
    pub help: String,
    /// Where in the file.
    pub place: Place,
}

/// Where in a model file: a path of keys and indices, and then perhaps some bytes of the scalar there.
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
