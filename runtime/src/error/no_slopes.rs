//! Why a motion has no slopes.

use std::fmt;

use crate::cause::Cause;

/// What keeps a motion from having slopes, by its start or by a parameter.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum NoSlopes {
    /// The mechanism was written by hand, and tells no slopes of its functions.
    Unknown,
    /// The accelerations come from something else than Lagrange's equations with multipliers.
    Accelerations,
    /// Steps went over contacts, whose events alone have slopes.
    StepsOver,
    /// Events set held values or states, or happen at ticks.
    Memory,
    /// The start meets equations beside constraints.
    StartConditions,
    /// A constraint that the start cannot meet any more when it changes, since all that might make up for it is held.
    HeldStart {
        /// What changes.
        unknown: String,
        /// The constraint.
        constraint: String,
    },
    /// An event, or a switch, is touched and not crossed.
    Touches {
        /// s.
        t: f64,
        /// It.
        event: String,
    },
    /// Two events happen at once, and their order decides what follows.
    Together {
        /// s.
        t: f64,
        /// They.
        events: [String; 2],
    },
    /// The motion stays where a force jumps.
    Rests {
        /// s.
        t: f64,
        /// The argument of the switch.
        switch: String,
    },
    /// Impacts accumulate, infinitely many in a finite time.
    ImpactsAccumulate {
        /// s.
        t: f64,
    },
    /// Contacts rebound or slip in an impact, whose slopes are not known yet.
    Rebounds {
        /// s.
        t: f64,
    },
    /// The motion depends on how constraints or contacts share a force that the equations leave open.
    Shares {
        /// They.
        constraints: Vec<String>,
    },
    /// An input turns sharply or jumps, and the speeds with it.
    Kick {
        /// s.
        t: f64,
    },
    /// Something is not finite, or a step cannot be taken.
    Fault {
        /// s.
        t: f64,
        /// What.
        cause: Cause,
    },
}

impl NoSlopes {
    /// What ends a run with slopes early, where something does.
    pub(crate) fn cause(&self) -> Option<&Cause> {
        match self {
            NoSlopes::Fault { cause, .. } => Some(cause),
            _ => None,
        }
    }
}

impl fmt::Display for NoSlopes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the motion has no slopes: ")?;
        match self {
            NoSlopes::Unknown => f.write_str("the mechanism does not tell those of its functions"),
            NoSlopes::StepsOver => f.write_str(
                "`moreau` steps over the events of contacts, at which slopes would have to be known: take a method that locates events",
            ),
            NoSlopes::Memory => f.write_str(
                "events set values that are held, or happen at ticks, or contacts slide in space, whose slopes are not known yet; two runs with --set tell a difference",
            ),
            NoSlopes::Accelerations => f.write_str(
                "its accelerations come from balances, or something else than multipliers enforces its constraints",
            ),
            NoSlopes::StartConditions => {
                f.write_str("its start meets equations beside constraints (`also`); give a start by numbers")
            }
            NoSlopes::HeldStart { unknown, constraint } => write!(
                f,
                "where only `{unknown}` changes, and the start holds what it holds, nothing can meet the constraint `{constraint}`; leave \
                 other coordinates or rates of the start open"
            ),
            NoSlopes::Touches { t, event } => {
                write!(f, "`{event}` is touched and not crossed at t = {t} s: when it happens changes like a root")
            }
            NoSlopes::Together { t, events: [one, other] } => {
                write!(f, "`{one}` and `{other}` happen together at t = {t} s, and their order decides what follows")
            }
            NoSlopes::Rests { t, switch } => {
                write!(f, "the motion rests from t = {t} s where a force jumps (`{switch}` = 0); write it as `friction`, or rest as a phase")
            }
            NoSlopes::ImpactsAccumulate { t } => write!(
                f,
                "impacts accumulate at t = {t} s, where the contact rests, and the slopes of that are not known yet; two runs with --set tell a \
                 difference"
            ),
            NoSlopes::Rebounds { t } => write!(
                f,
                "contacts rebound or slip in an impact at t = {t} s, and the slopes of that are not known yet; two runs with --set tell a \
                 difference"
            ),
            NoSlopes::Shares { constraints } => write!(
                f,
                "it depends on how `{}` share a force that the equations leave open; let fewer of them hold",
                constraints.join("`, `")
            ),
            NoSlopes::Kick { t } => {
                write!(f, "an input turns sharply or jumps at t = {t} s, and the speeds jump with it")
            }
            NoSlopes::Fault { t, cause } => write!(f, "at t = {t} s: {cause}"),
        }
    }
}
