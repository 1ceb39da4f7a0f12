//! Why a question about a scene's needs has no answer.

use std::fmt;

use dalembert_symbolic::diagnose::Problem;

use super::Needs;

/// Why there is no answer.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum NeedsError {
    /// The file has mistakes.
    Model {
        /// All of them.
        problems: Vec<Problem>,
    },
    /// The model has nothing of this name.
    UnknownName {
        /// What was looked for: `scene`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// The file has this not at all, or not so that a value can be written into it: in lines or brackets.
    NotEditable {
        /// What was to be changed: `scene`.
        what: String,
    },
    /// An accuracy that has no meaning here.
    BadNeed {
        /// What was asked for.
        within: f64,
    },
    /// What is wanted is 0 all along, so that deviations have nothing to be measured by.
    Still {
        /// Its name.
        name: String,
    },
    /// The model has states of first order, which no smaller model that is tried keeps.
    States,
    /// The model holds values, or samples, which no smaller model that is tried keeps.
    Memory,
    /// The full model's run fails.
    Fails {
        /// Why.
        why: String,
    },
    /// Two runs of the full model differ by too much for the need.
    NotKnown {
        /// By how much, in the measure of which `within` is the limit.
        known: f64,
        /// The need.
        within: f64,
    },
    /// The search was broken off.
    Interrupted {
        /// What was found until then, without what goes together; `None` where the full model had not been judged yet.
        so_far: Option<Box<Needs>>,
    },
}

impl fmt::Display for NeedsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NeedsError::Model { problems } => {
                let messages: Vec<&str> = problems.iter().map(|problem| problem.message.as_str()).collect();
                f.write_str(&messages.join("; "))
            }
            NeedsError::UnknownName { kind, name, known } => {
                write!(f, "no {kind} is called `{name}`")?;
                match known.as_slice() {
                    [] => write!(f, "; there is none"),
                    known => write!(f, "; there are {}", known.join(", ")),
                }
            }
            NeedsError::NotEditable { what } => {
                write!(f, "the file has no `{what}` in lines or brackets, into which another value could be written")
            }
            NeedsError::States => f.write_str(
                "the model has states of first order, which `needs` does not leave out, hold or follow yet; `--slopes` of `simulate` tells how an \
                 output changes with each parameter",
            ),
            NeedsError::Memory => f.write_str(
                "the model holds values that events set, or directions in which contacts slide in space, which `needs` does not leave out yet; `simulate --set` runs it with other parameters",
            ),
            NeedsError::BadNeed { within } => {
                write!(
                    f,
                    "an accuracy of {within:e} has no meaning here: between 1e-9 and 0.5 of a quantity's range, or a positive amount"
                )
            }
            NeedsError::Still { name } => write!(
                f,
                "`{name}` is 0 all along, so that a deviation has no range to be measured by; ask for something that moves, or say by which amount it may be off (`absolute`)"
            ),
            NeedsError::Fails { why } => write!(f, "the full model's run fails: {why}"),
            NeedsError::NotKnown { known, within } => write!(
                f,
                "two runs of the full model differ by {:.1e} of what is asked for, which is too much to judge a smaller model by; ask \
                 for less, or end the scene earlier",
                known / within
            ),
            NeedsError::Interrupted { .. } => f.write_str("interrupted"),
        }
    }
}

impl std::error::Error for NeedsError {}
