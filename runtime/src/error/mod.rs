//! What can go wrong, with the data to see why.

mod linear;
mod no_orbit;
mod no_slopes;
mod not_found;

use std::path::PathBuf;
use std::sync::Arc;
use std::{fmt, io};

pub use linear::{LinearError, Residual};
#[cfg(feature = "cli")]
pub(crate) use no_orbit::StuckInWords;
pub use no_orbit::{NearReturn, NoOrbit};
pub use no_slopes::NoSlopes;
pub use not_found::NotFound;

use crate::cause::{Cause, NoSeries};
use crate::mechanism::Method;
use crate::numbers::counted;
use crate::run::{Failure, Run};

/// A setting that makes no sense, or a run that could not go on.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Error {
    /// A setting has no meaning.
    BadSetting {
        /// Which one: `step`.
        setting: &'static str,
        /// What was asked for.
        value: f64,
        /// What would have had a meaning.
        expected: &'static str,
    },
    /// The method chooses no steps itself, and none was given.
    NoStep {
        /// The method.
        method: Method,
    },
    /// The method moves places and speeds in turn, and the mechanism is not made so.
    NotSeparable {
        /// The method.
        method: Method,
        /// What stands in the way.
        reason: Inseparable,
    },
    /// The method is for linear systems with constant coefficients, and the mechanism is not one.
    NotLinear {
        /// What stands in the way.
        reason: Nonlinear,
    },
    /// The method expands the motion in a power series, and there is none.
    NoSeries {
        /// What stands in the way.
        reason: NoSeries,
    },
    /// The method steps over contacts, and something stands in the way.
    NoTimeStepping {
        /// What.
        reason: Unsteppable,
    },
    /// Contacts have so many combinations of what they do that only steps over them lead on, and the method locates their events.
    TooManyCombinations {
        /// The method.
        method: Method,
        /// How many contacts and frictions there are.
        contacts: usize,
        /// How many combinations; `None`: more than a `usize` counts.
        combinations: Option<usize>,
    },
    /// Forces are made of reactions, which only multipliers give together with the accelerations.
    NeedsMultipliers,
    /// Springs stand for constraints without dampers, which alone hold one that contains speeds.
    NeedsDamping {
        /// It.
        constraint: String,
    },
    /// A list has the wrong length.
    WrongLength {
        /// Which one: `start`.
        setting: &'static str,
        /// How many numbers it has.
        given: usize,
        /// How many it must have.
        expected: usize,
    },
    /// The mechanism has nothing of this name.
    UnknownName {
        /// What was looked for: `scene`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// There is nothing to measure errors from: no two methods agree on the motion, say.
    NoReference {
        /// What stands in the way.
        why: String,
    },
    /// A picture was to be a PNG, a PDF or a GIF, and the crate was built without the feature `png`.
    NeedsPng {
        /// Its file.
        path: PathBuf,
    },
    /// A file could not be written.
    File {
        /// Which one.
        path: PathBuf,
        /// What the operating system says.
        problem: Arc<io::Error>,
    },
    /// The motion has no slopes.
    NoSlopes(Box<NoSlopes>),
    /// A search found nothing.
    NotFound(Box<NotFound>),
    /// No motion that closes was found.
    NoOrbit(Box<NoOrbit>),
    /// Small motions: no equilibrium, no linearisation, no modes.
    Linear(Box<LinearError>),
    /// The run ended early.  It comes with the time, the state and what was computed until then.
    Run(Box<Failure>),
}

/// What keeps a method for separable systems from a mechanism.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Inseparable {
    /// The mechanism has constraints, and the method is not made of Verlet steps, whose constrained form is RATTLE.
    Constraints,
    /// M changes along a run.
    MassMatrix,
    /// Forces depend on speeds, or switch with them, or are not known not to.
    Speeds,
    /// There are states of first order: to move places and speeds in turn would need their own motion.
    States,
    /// A constraint contains speeds.
    Rates {
        /// The constraint, or its component.
        constraint: String,
    },
    /// Forces are made of reactions, as friction is.
    Friction,
    /// Constraints are enforced by the null space, or brought back by Baumgarte's stabilisation: both go with accelerations.
    Enforcement,
}

/// What keeps time stepping over contacts from a mechanism.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Unsteppable {
    /// The mechanism has neither friction nor contacts.
    NoContacts,
    /// An event of the file contains accelerations or reactions, in its function, its condition or what it sets.
    Event {
        /// It.
        event: String,
    },
    /// An event of the file strikes, or goes to another phase.
    Strikes {
        /// It.
        event: String,
    },
    /// A force that is no friction is made of a reaction.
    Reaction {
        /// The constraint or contact.
        constraint: String,
    },
    /// Constraints are enforced by something else than multipliers, or brought back by Baumgarte's stabilisation, or accelerations come from balances.
    Enforcement,
}

impl fmt::Display for Unsteppable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unsteppable::NoContacts => f.write_str("it has neither `friction` nor `contacts`; every other method is more accurate"),
            Unsteppable::Event { event } => write!(
                f,
                "its event `{event}` contains accelerations or reactions, which such steps have as impulses only; let it happen by places and speeds"
            ),
            Unsteppable::Strikes { event } => {
                write!(f, "its event `{event}` strikes or changes the phase; write it as a contact")
            }
            Unsteppable::Reaction { constraint } => write!(
                f,
                "a force that is no friction is made of `reaction({constraint})`, which such steps do not know beforehand; write it as `friction`"
            ),
            Unsteppable::Enforcement => {
                f.write_str("its constraints are to be enforced otherwise than by multipliers, or accelerations to come from balances")
            }
        }
    }
}

/// What keeps the exact propagation of linear systems from a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Nonlinear {
    /// The mechanism has constraints.
    Constraints,
    /// The equations of motion are not linear, or their coefficients change.
    Coefficients,
}

impl fmt::Display for Nonlinear {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Nonlinear::Constraints => "it has constraints",
            Nonlinear::Coefficients => "its equations of motion are not linear with constant coefficients",
        })
    }
}

impl fmt::Display for Inseparable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Inseparable::Constraints => "it has constraints; `verlet` (RATTLE), `suzuki4` and `kahanli8` keep them",
            Inseparable::MassMatrix => "its mass matrix changes along the motion",
            Inseparable::Speeds => "its forces depend on speeds",
            Inseparable::States => {
                "it has states of first order, whose motion is none of places and speeds in turn; `gauss2`, `gauss4` and `gauss6` take them"
            }
            Inseparable::Rates { constraint } => return write!(f, "its constraint `{constraint}` contains speeds"),
            Inseparable::Friction => "its forces are made of reactions, as friction is",
            Inseparable::Enforcement => {
                "its constraints are enforced by the null space or by Baumgarte's stabilisation, which act on accelerations; \
                 take `multipliers`"
            }
        })
    }
}

impl Error {
    /// [`Error::UnknownName`].
    pub(crate) fn unknown(kind: &'static str, name: &str, known: impl IntoIterator<Item: ToString>) -> Error {
        let known = known.into_iter().map(|known| known.to_string()).collect();
        Error::UnknownName { kind, name: name.to_owned(), known }
    }

    /// Why a run ended early; `None` for a bad setting.
    pub fn cause(&self) -> Option<&Cause> {
        match self {
            Error::Run(failure) => Some(&failure.cause),
            _ => None,
        }
    }

    /// Why a run, with slopes or without, ended early.
    fn ended_by(&self) -> Option<&Cause> {
        match self {
            Error::NoSlopes(why) => why.cause(),
            error => error.cause(),
        }
    }

    /// Whether a run, or a search, was ended from outside.
    pub(crate) fn is_interruption(&self) -> bool {
        match self {
            Error::NoOrbit(why) => matches!(**why, NoOrbit::Interrupted { .. }),
            Error::NotFound(why) => matches!(**why, NotFound::Interrupted { .. }),
            error => matches!(error.ended_by(), Some(Cause::Interrupted)),
        }
    }

    /// Whether a run ended since it took more steps than this limit.
    pub(crate) fn takes_more_steps_than(&self, most: u64) -> bool {
        let limit = match self.ended_by() {
            Some(Cause::TooManySteps { limit } | Cause::NeedsMoreSteps { limit, .. }) => Some(*limit),
            _ => None,
        };
        limit == Some(most)
    }

    /// What was computed before a run ended early.
    pub fn partial(&self) -> Option<&Run> {
        match self {
            Error::Run(failure) => Some(&failure.run),
            _ => None,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::BadSetting { setting, value, expected } => write!(f, "`{setting}` is {value}; expected {expected}"),
            Error::NoStep { method } => write!(f, "`{method}` needs a fixed step: give `step`"),
            Error::NotSeparable { method, reason } => write!(
                f,
                "`{method}` is for separable systems: a constant mass matrix, forces that do not depend on speeds, constraints \
                 without speeds; the mechanism is not one, since {reason}"
            ),
            Error::NotLinear { reason } => {
                write!(
                    f,
                    "`exact` propagates linear systems with constant coefficients; the mechanism is not one, since {reason}"
                )
            }
            Error::NoSeries { reason } => {
                write!(f, "`taylor` expands the motion in a power series; there is none, since {reason}")
            }
            Error::NoTimeStepping { reason } => {
                write!(f, "`moreau` steps over friction and contacts; it does not take this mechanism, since {reason}")
            }
            Error::TooManyCombinations { method, contacts, combinations } => {
                let count = combinations
                    .map_or_else(|| "too many combinations to be counted".to_owned(), |n| format!("{n} combinations"));
                let most = crate::mechanism::MOST_COMBINATIONS;
                write!(
                    f,
                    "{contacts} contacts and frictions have {count} of sticking, slipping and opening, of which `{method}` and all methods that locate events take {most}: \
                     give `moreau` and a step (`--method moreau --step 1e-3`), which steps over them with an error of the first order"
                )
            }
            Error::NeedsMultipliers => {
                write!(f, "a force is made of reactions, as friction is: take `multipliers`, which find both together")
            }
            Error::NeedsDamping { constraint } => {
                write!(
                    f,
                    "no spring holds the constraint `{constraint}`, which contains speeds, only a damper: give `--damping`"
                )
            }
            Error::WrongLength { setting, given, expected } => {
                let counts = if *setting == "memory" { "held value" } else { "coordinate" };
                let (given, expected) = (counted(*given, "number"), counted(*expected, counts));
                write!(f, "`{setting}` has {given}; the mechanism has {expected}")
            }
            Error::UnknownName { kind, name, known } => {
                write!(f, "no {kind} is called `{name}`")?;
                match known.as_slice() {
                    [] => write!(f, "; there is none"),
                    known => write!(f, "; there are {}", Listed(known)),
                }
            }
            Error::NoReference { why } => {
                write!(f, "there is nothing to measure errors from: {why}")
            }
            Error::NeedsPng { path } => write!(
                f,
                "cannot draw `{}`: PNG, PDF and GIF need the feature `png` of the crate `dalembert`; name a file .svg (a chart) or .html \
                 (an animation), or build with it",
                path.display()
            ),
            Error::File { path, problem } => write!(f, "cannot write `{}`: {problem}", path.display()),
            Error::NoSlopes(why) => write!(f, "{why}"),
            Error::NotFound(why) => write!(f, "{why}"),
            Error::NoOrbit(why) => write!(f, "{why}"),
            Error::Linear(problem) => write!(f, "{problem}"),
            Error::Run(failure) => write!(f, "{failure}"),
        }
    }
}

/// Names in backticks, with commas.
struct Listed<'a>(&'a [String]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, name) in self.0.iter().enumerate() {
            write!(f, "{}`{name}`", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::File { problem, .. } => Some(&**problem),
            _ => None,
        }
    }
}

impl From<NoSlopes> for Error {
    fn from(why: NoSlopes) -> Self {
        Error::NoSlopes(Box::new(why))
    }
}

impl From<NoOrbit> for Error {
    fn from(why: NoOrbit) -> Self {
        Error::NoOrbit(Box::new(why))
    }
}

impl From<NotFound> for Error {
    fn from(why: NotFound) -> Self {
        Error::NotFound(Box::new(why))
    }
}

impl From<LinearError> for Error {
    fn from(problem: LinearError) -> Self {
        Error::Linear(Box::new(problem))
    }
}
