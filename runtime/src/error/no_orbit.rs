//! Why no motion that closes was found.

use std::fmt;

use super::not_found::Listed;

/// What keeps a motion from closing, or a search from finding one that does; values are SI.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum NoOrbit {
    /// The mechanism has states of first order, of which closing motions and their multipliers are not known yet.
    States,
    /// The mechanism holds values that events set, of which closing motions and their multipliers are not known yet.
    Memory,
    /// The motion was asked for in double-double, which it is not known in.
    DoubleOnly {
        /// What is in the way.
        why: String,
    },
    /// What the search comes to is an equilibrium, which repeats itself after any time.
    Rest,
    /// The motion comes near to none of its states again, so that there is no period to begin with.
    NoGuess {
        /// How long it was followed, s.
        until: f64,
    },
    /// A motion of the file is no motion that closes.
    ClosesNot {
        /// It.
        motion: String,
    },
    /// The event that closes the motion does not happen.
    NoReturn {
        /// It.
        event: String,
        /// How long it was waited for, s.
        until: f64,
    },
    /// The event that closes the motion changes nothing and does not end it.
    OnlyNoted {
        /// It.
        event: String,
    },
    /// The motion ends in another phase than it began.
    OtherPhase {
        /// The phase at its start.
        begins: String,
        /// That in which it ends, after the exchange.
        ends: String,
    },
    /// The mechanism does not move alike from a state and from its image, which the closing exchanges or mirrors.
    NoSymmetry {
        /// The coordinate whose acceleration differs.
        coordinate: String,
        /// Its acceleration.
        here: f64,
        /// That of the image, taken back.
        there: f64,
    },
    /// A coordinate cannot be left free at the end: forces, constraints or events depend on it.
    ShiftMatters {
        /// It.
        coordinate: String,
    },
    /// Time enters the equations otherwise than by sines and cosines of constant frequencies, and no period was given.
    NotPeriodic,
    /// Frequencies with which time enters the equations have no common period.
    Incommensurate {
        /// Two of them, rad/s.
        frequencies: [f64; 2],
    },
    /// There is no such mode that oscillates.
    NoMode {
        /// Its number.
        mode: usize,
        /// How many there are.
        known: usize,
    },
    /// An energy was asked for, or to vary, of a mechanism that does not keep it.
    NoEnergy,
    /// The period that was given is not one of what depends on time.
    NotThePeriod {
        /// It, s.
        period: f64,
    },
    /// The event that closes the motion happens when what depends on time is not what it was at the start.
    NotAPeriodLater {
        /// It.
        event: String,
        /// How long after the start, s.
        later: f64,
    },
    /// An event that changes the motion has no image among those that do, so much later.
    NoImageOfEvent {
        /// It.
        event: String,
    },
    /// A piece of a trial takes far more steps than pieces of the motion that it began with.
    LeadsAway {
        /// After so many steps it was given up.
        steps: u64,
    },
    /// The search was broken off.
    Interrupted {
        /// The start that it had come to.
        start: Vec<(String, f64)>,
    },
    /// A family turns so sharply that no step is short enough.
    TurnsSharply,
    /// No family of such motions can be followed by this.
    NoFamily {
        /// What was to vary.
        name: String,
    },
    /// The motion does not depend on what was to vary.
    NoEffect {
        /// It.
        name: String,
    },
    /// A family has no threshold of this number.
    NoThreshold {
        /// It.
        number: usize,
        /// How many there are.
        known: usize,
    },
    /// No step leads nearer.
    Stuck {
        /// What the first piece misses by there.
        residuals: Vec<(String, f64)>,
        /// The start there.
        start: Vec<(String, f64)>,
        /// Where the run that was described comes near to states of its own again, the nearest first.
        returns: Vec<NearReturn>,
    },
}

/// A state that a run comes near to again.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NearReturn {
    /// When it is there first, s.
    pub t: f64,
    /// After how long it is nearest again, s.
    pub after: f64,
    /// How near, as a part of the farthest that it goes from it.
    pub distance: f64,
}

impl NearReturn {
    pub(crate) fn new(t: f64, after: f64, distance: f64) -> NearReturn {
        NearReturn { t, after, distance }
    }
}

/// What is said of a search that does not get nearer.
pub(crate) struct StuckInWords<'a> {
    /// The start, and what the motion misses by, listed.
    pub start: &'a str,
    pub residuals: &'a str,
    pub returns: &'a [NearReturn],
}

impl fmt::Display for StuckInWords<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StuckInWords { start, residuals, returns } = self;
        write!(
            f,
            "the search does not get nearer than a start at {start}, from which the motion misses by {residuals}"
        )?;
        let parts = returns.iter().map(|NearReturn { t, after, distance }| {
            format!("to that of t = {t:.6} s after {after:.6} s, by {distance:.2e} of how far it goes from it")
        });
        match parts.collect::<Vec<_>>() {
            parts if parts.is_empty() => {
                f.write_str("; the run that was described comes near to none of its states again")
            }
            parts => write!(
                f,
                "; the run that was described comes nearest to its own states again: {}",
                parts.join(", and ")
            ),
        }
    }
}

impl fmt::Display for NoOrbit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoOrbit::Memory => f.write_str(
                "the mechanism holds values that events set, or directions in which contacts slide in space, of which closing motions and their multipliers are not known yet; `modes --sampled` \
                 tells the stability of a loop that is sampled",
            ),
            NoOrbit::DoubleOnly { why } => write!(f, "the motion is not known in double-double: {why}"),
            NoOrbit::States => f.write_str(
                "the mechanism has states of first order, of which closing motions and their multipliers are not known yet; `simulate` until it \
                 repeats itself, with an event that records",
            ),
            NoOrbit::Rest => f.write_str(
                "what was found is an equilibrium, which repeats itself after any time; begin farther from it, or with another period",
            ),
            NoOrbit::NoGuess { until } => write!(
                f,
                "the motion comes near to none of its states again until t = {until} s: give a period, or a longer run"
            ),
            NoOrbit::ClosesNot { motion } => {
                write!(f, "the motion `{motion}` of the file does not say how it closes: `solve` is for it")
            }
            NoOrbit::NoReturn { event, until } => {
                write!(f, "`{event}`, which is to close the motion, does not happen within {until} s")
            }
            NoOrbit::OnlyNoted { event } => write!(
                f,
                "`{event}` changes nothing, so that it cannot close a motion: let it `stop`, or close by a period"
            ),
            NoOrbit::OtherPhase { begins, ends } => {
                write!(f, "the motion begins in phase `{begins}` and ends in `{ends}`: does it need an exchange of phases?")
            }
            NoOrbit::NoSymmetry { coordinate, here, there } => write!(
                f,
                "the mechanism does not move alike from a state and from its image: the acceleration of `{coordinate}` is {here:.6e} and \
                 that of the image {there:.6e}"
            ),
            NoOrbit::ShiftMatters { coordinate } => {
                write!(f, "`{coordinate}` cannot differ at the end: forces, constraints or events depend on it")
            }
            NoOrbit::NotPeriodic => f.write_str(
                "the equations depend on time otherwise than by sines and cosines of constant frequencies: give the period",
            ),
            NoOrbit::Incommensurate { frequencies: [a, b] } => write!(
                f,
                "the frequencies {a} rad/s and {b} rad/s, with which time enters the equations, have no common period"
            ),
            NoOrbit::NoMode { mode, known } => {
                write!(f, "there is no mode {mode} that oscillates; there are {known}")
            }
            NoOrbit::NoEnergy => {
                f.write_str("the mechanism does not keep its energy, so that motions have none to ask for")
            }
            NoOrbit::NotThePeriod { period } => write!(
                f,
                "what depends on time does not repeat itself after {period} s: give a multiple of its period, or none, which finds it"
            ),
            NoOrbit::NotAPeriodLater { event, later } => write!(
                f,
                "`{event}`, which is to close the motion, happens {later} s after the start, and what depends on time does not repeat itself \
                 after that: let the motion close after a period"
            ),
            NoOrbit::NoImageOfEvent { event } => write!(
                f,
                "what `{event}` watches is watched by no event in the image of a state, that part of the period later: let the motion close \
                 after the whole period"
            ),
            NoOrbit::LeadsAway { steps } => write!(
                f,
                "a trial leads somewhere else, or chatters: it takes more than {steps} steps, which are many times those of the motion that it \
                 began with; begin nearer to a motion that closes"
            ),
            NoOrbit::Interrupted { start } => write!(f, "interrupted; the search had come to {}", Listed(start)),
            NoOrbit::TurnsSharply => f.write_str("the family turns too sharply to be followed"),
            NoOrbit::NoFamily { name } => write!(f, "the motion belongs to no family that can be followed by `{name}`"),
            NoOrbit::NoEffect { name } => write!(
                f,
                "the equations do not contain `{name}`: it changes where the search begins, and not the motion that is found; \
                 `energy` varies along a family of free motions"
            ),
            NoOrbit::NoThreshold { number, known } => {
                write!(f, "the family has no threshold {number}: there are {known}")
            }
            NoOrbit::Stuck { residuals, start, returns } => {
                let [start, residuals] = [start, residuals].map(|list| Listed(list).to_string());
                write!(f, "{}", StuckInWords { start: &start, residuals: &residuals, returns })
            }
        }
    }
}
