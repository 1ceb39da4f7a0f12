//! Why a search found nothing.

use std::fmt;

use super::NoSlopes;

/// What keeps a search from its end; values are SI.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum NotFound {
    /// There are no unknowns, or nothing is wanted of them.
    NothingWanted,
    /// The motion repeats itself: it is no matter of values at an end.
    Closes {
        /// Its name.
        motion: String,
    },
    /// The value that a motion of the file gives a condition contains a parameter that is unknown.
    MovingGoal {
        /// What has the value.
        name: String,
        /// The parameter.
        parameter: String,
    },
    /// A record cannot be followed.
    BadRecord {
        /// What it must be.
        why: &'static str,
    },
    /// No step leads nearer.
    Stuck {
        /// What the conditions are missed by there.
        residuals: Vec<(String, f64)>,
        /// The unknowns there.
        values: Vec<(String, f64)>,
        /// What keeps a motion nearer by from having slopes.
        why: Option<Box<NoSlopes>>,
        /// An event that does not happen any more in a motion nearer by.
        event: Option<String>,
    },
    /// A trial takes far more steps than the first one.
    LeadsAway {
        /// After so many steps it was given up.
        steps: u64,
    },
    /// The search was broken off.
    Interrupted {
        /// The unknowns that it had come to.
        values: Vec<(String, f64)>,
    },
    /// Conditions cannot be met together.
    Contradictory {
        /// What they are missed by at the least.
        residuals: Vec<(String, f64)>,
        /// The unknowns there.
        values: Vec<(String, f64)>,
    },
    /// Something has no largest, or smallest, value near by.
    NoExtreme {
        /// It.
        name: String,
        /// The unknowns where the search ended.
        values: Vec<(String, f64)>,
    },
    /// Conditions leave no unknown free, so that nothing has a largest, or smallest, value under them.
    NothingFree {
        /// What was to have one.
        name: String,
        /// The unknowns that meet the conditions.
        values: Vec<(String, f64)>,
    },
    /// A record does not tell unknowns apart.
    NotIdentified {
        /// By which parts of themselves they may be changed together.
        direction: Vec<(String, f64)>,
    },
}

impl fmt::Display for NotFound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotFound::NothingWanted => {
                f.write_str("a search needs something unknown, and a condition, an extreme value or a record")
            }
            NotFound::Closes { motion } => {
                write!(
                    f,
                    "the motion `{motion}` closes: the command `orbit` finds such motions; `solve` wants `such_that`, `maximise`, `minimise` or `fit`"
                )
            }
            NotFound::MovingGoal { name, parameter } => write!(
                f,
                "the value of `{name}` contains `{parameter}`, which is unknown: give another value, or make the difference an output"
            ),
            NotFound::BadRecord { why } => write!(f, "the record cannot be followed: {why}"),
            NotFound::Stuck { residuals, values, why, event } => {
                write!(f, "the search does not get nearer than {}", Listed(values))?;
                if !residuals.is_empty() {
                    write!(f, ", where it misses {}", Listed(residuals))?;
                }
                match (why, event) {
                    (Some(why), _) => write!(f, "; nearer by, {why}"),
                    (None, Some(event)) => {
                        write!(f, "; nearer by, `{event}` does not happen any more, or another event does")
                    }
                    (None, None) => Ok(()),
                }
            }
            NotFound::LeadsAway { steps } => write!(
                f,
                "a trial leads somewhere else, or chatters: it takes more than {steps} steps, which are many times those of the first; begin \
                 with another guess"
            ),
            NotFound::Interrupted { values } => write!(f, "interrupted; the search had come to {}", Listed(values)),
            NotFound::Contradictory { residuals, values } => write!(
                f,
                "the conditions cannot be met together near by: at {} they are missed by {}",
                Listed(values),
                Listed(residuals)
            ),
            NotFound::NoExtreme { name, values } => {
                write!(f, "`{name}` has no such value near by; the search ended at {}", Listed(values))
            }
            NotFound::NothingFree { name, values } => write!(
                f,
                "the conditions leave nothing free by which `{name}` might become larger or smaller: near by {} alone meets them; give more unknowns, \
                 or fewer conditions",
                Listed(values)
            ),
            NotFound::NotIdentified { direction } => {
                let parts: Vec<String> = direction.iter().map(|(name, part)| format!("{name} by {part:.4}")).collect();
                write!(
                    f,
                    "the record does not tell the unknowns apart: they can be scaled together, {} of themselves; give one of them",
                    parts.join(", ")
                )
            }
        }
    }
}

/// `x = 1.5, y = 2`.
pub(super) struct Listed<'a>(pub &'a [(String, f64)]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            write!(f, "{}{name} = {value:.6e}", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}
