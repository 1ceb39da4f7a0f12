//! What can go wrong, with the data to see why.

use std::path::PathBuf;
use std::sync::Arc;
use std::{fmt, io};

use crate::integrate::Method;
use crate::linear::LinearError;
use crate::mechanism::{Singular, SingularMass, System};
use crate::run::{Run, State};
use crate::trust::Unbounded;

/// A setting that makes no sense, or a run that could not go on.
#[derive(Clone, Debug)]
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
    /// A file could not be written.
    File {
        /// Which one.
        path: PathBuf,
        /// What the operating system says.
        problem: Arc<io::Error>,
    },
    /// Small motions: no equilibrium, no linearisation, no modes.
    Linear(Box<LinearError>),
    /// The run ended early.  It comes with the time, the state and what was computed until then.
    Run(Box<Failure>),
}

/// A run that ended early.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Why.
    pub cause: Cause,
    /// When, and in which state: the last one that was accepted, unless the cause names another time.
    pub state: State,
    /// What was computed until then.
    pub run: Run,
}

/// Why a run could not go on.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// The step that the tolerance asks for vanishes beside the time: the motion ends here (a pole, a
    /// discontinuity that the model does not declare).
    StepTooSmall {
        /// The step, s.
        h: f64,
    },
    /// Rounding errors alone exceed the tolerance, however small the step.
    ToleranceTooTight {
        /// What was asked for.
        asked: f64,
        /// What might be attained here.
        attainable: f64,
    },
    /// t + h = t at the fixed step h.
    StepBelowResolution {
        /// The step, s.
        h: f64,
    },
    /// A number is infinite or not a number.
    NonFinite {
        /// Of what: the acceleration of a coordinate, say.
        what: String,
    },
    /// M has no inverse.
    SingularMass {
        /// The coordinate whose pivot vanishes.
        coordinate: String,
    },
    /// The run goes by a system of balances, and one of its equations says nothing in this state: power and energy at
    /// rest.
    VoidBalance {
        /// The system of balances.
        system: String,
        /// The equation's balance.
        balance: String,
        /// True where the balance is one of power or energy.
        at_rest: bool,
    },
    /// The run goes by a system of balances, and they are not independent in this state.
    SingularBalances {
        /// The system of balances.
        system: String,
        /// An unknown that it does not determine: an acceleration `theta''`, or a reaction.
        unknown: String,
    },
    /// The coordinates fail where the mechanism does not: an element of M grows beyond bounds.
    CoordinateSingularity {
        /// The coordinate.
        coordinate: String,
        /// When it is reached, s.
        t: f64,
    },
    /// Both sides of a discontinuity push back to it.
    Chattering {
        /// The discontinuity's argument, as the model file has it.
        switch: String,
    },
    /// The acceleration jumps where the model declares no discontinuity: a force along a direction (`unit`, or
    /// a division by `norm`) has lost it.
    DirectionLost {
        /// The coordinate whose acceleration jumps most.
        coordinate: String,
    },
    /// More steps than `max_steps`.
    TooManySteps {
        /// The limit.
        limit: u64,
    },
}

impl Error {
    /// Why a run ended early; `None` for a bad setting.
    pub fn cause(&self) -> Option<&Cause> {
        match self {
            Error::Run(failure) => Some(&failure.cause),
            _ => None,
        }
    }

    /// What was computed before a run ended early.
    pub fn partial(&self) -> Option<&Run> {
        match self {
            Error::Run(failure) => Some(&failure.run),
            _ => None,
        }
    }
}

impl Cause {
    pub(crate) fn singular<S: System + ?Sized>(mechanism: &S, fault: Singular) -> Self {
        let systems = &mechanism.description().balances;
        let name = |system: usize| systems.get(system).map_or_else(String::new, |s| s.name.to_string());
        match fault {
            Singular::Mass(SingularMass { coordinate }) => {
                Cause::SingularMass { coordinate: coordinate_name(mechanism, coordinate) }
            }
            Singular::VoidBalance { system, equation } => {
                let balance = systems.get(system).and_then(|s| s.equations.get(equation));
                Cause::VoidBalance {
                    system: name(system),
                    balance: balance.map_or_else(|| format!("equation {}", equation + 1), |b| b.name.to_string()),
                    at_rest: balance.is_some_and(|b| b.void_at_rest),
                }
            }
            Singular::Balances { system, unknown } => {
                let known = systems.get(system).and_then(|s| s.unknowns.get(unknown));
                let unknown = known.map_or_else(|| format!("unknown {}", unknown + 1), ToString::to_string);
                Cause::SingularBalances { system: name(system), unknown }
            }
        }
    }

    pub(crate) fn coordinate_singularity<S: System + ?Sized>(system: &S, unbounded: Unbounded) -> Self {
        Cause::CoordinateSingularity { coordinate: coordinate_name(system, unbounded.coordinate), t: unbounded.t }
    }

    pub(crate) fn direction_lost<S: System + ?Sized>(system: &S, coordinate: usize) -> Self {
        Cause::DirectionLost { coordinate: coordinate_name(system, coordinate) }
    }

    /// Names the number of [q; v; W] that is not finite, `primes` derivatives of it being meant.
    pub(crate) fn non_finite<S: System + ?Sized>(system: &S, index: usize, primes: usize) -> Self {
        let n = system.len().max(1);
        let what = match index / n {
            order @ (0 | 1) => format!("`{}{}`", coordinate_name(system, index % n), "'".repeat(order + primes)),
            _ => "the work of the forces".to_owned(),
        };
        Cause::NonFinite { what }
    }
}

fn coordinate_name<S: System + ?Sized>(system: &S, index: usize) -> String {
    system.description().coordinates.get(index).map_or_else(|| format!("coordinate {index}"), |c| c.name.to_string())
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::BadSetting { setting, value, expected } => write!(f, "`{setting}` is {value}; expected {expected}"),
            Error::NoStep { method } => write!(f, "`{method}` needs a fixed step: give `step`"),
            Error::WrongLength { setting, given, expected } => {
                write!(f, "`{setting}` has {given} numbers; the mechanism has {expected} coordinates")
            }
            Error::UnknownName { kind, name, known } => {
                write!(f, "no {kind} is called `{name}`")?;
                match known.as_slice() {
                    [] => write!(f, "; there is none"),
                    known => write!(f, "; there are {}", Listed(known)),
                }
            }
            Error::File { path, problem } => write!(f, "cannot write `{}`: {problem}", path.display()),
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

impl std::error::Error for Error {}

impl From<LinearError> for Error {
    fn from(problem: LinearError) -> Self {
        Error::Linear(Box::new(problem))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (t = {} s", self.cause, self.state.t)?;
        // A chain's hundred numbers help nobody; they are in `state`.
        if self.state.q.len() <= 4 { write!(f, "; last state {})", self.state) } else { write!(f, ")") }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::StepTooSmall { h } => {
                write!(f, "step too small: the tolerance asks for a step of {h:e} s, which vanishes beside the time")
            }
            Cause::ToleranceTooTight { asked, attainable } => {
                write!(f, "tolerance too tight: {asked:e} is below rounding here; {attainable:e} might be attained")
            }
            Cause::StepBelowResolution { h } => write!(f, "step below resolution: t + {h:e} s is t"),
            Cause::NonFinite { what } => write!(f, "{what} is not finite"),
            Cause::SingularMass { coordinate } => {
                write!(f, "singular mass matrix: nothing gives `{coordinate}` an inertia here")
            }
            Cause::VoidBalance { system, balance, at_rest } => {
                write!(f, "void balance: in `{system}`, {balance} ")?;
                match at_rest {
                    true => write!(
                        f,
                        "says nothing about what is at rest, since power vanishes with the speeds; start with a speed, \
                         or go by another system"
                    ),
                    false => write!(f, "contains no acceleration and no reaction in this state; go by another system"),
                }
            }
            Cause::SingularBalances { system, unknown } => write!(
                f,
                "singular balances: `{system}` does not determine {unknown} in this state, where its equations depend \
                 on each other; go by another system"
            ),
            Cause::CoordinateSingularity { coordinate, t } => write!(
                f,
                "coordinate singularity: `{coordinate}` cannot describe the motion beyond t = {t} s, where its inertia \
                 grows without bound; choose another coordinate, such as an angle"
            ),
            Cause::Chattering { switch } => write!(
                f,
                "chattering: both sides of `{switch}` = 0 push back to it; describe what happens there as a phase"
            ),
            Cause::DirectionLost { coordinate } => write!(
                f,
                "direction lost: the acceleration of `{coordinate}` jumps, as where a `unit` or `norm` vanishes; stop \
                 before it by an event, such as `norm(v) - crawl`"
            ),
            Cause::TooManySteps { limit } => write!(f, "more than {limit} steps; raise `max_steps` to go on"),
        }
    }
}
