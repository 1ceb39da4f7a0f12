//! What an expression may depend on, and the unit that it is to have.

use super::dimension::{Dimension, Measure};
use super::facts::Depends;

/// The unit that an expression is to have.
#[derive(Clone, Copy, Debug)]
pub enum Expected {
    /// Any.
    Any,
    /// That of a kind of quantity, in a model with units.
    Si(Dimension),
    /// That of something else.
    Like(Measure),
}

/// What a rate counts: cycles (Hz) or angles (rad/s, rpm).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counts {
    /// Neither, or not known.
    Any,
    /// `Hz`, `kHz` and so on.
    Cycles,
    /// `rad`, `deg`, `rpm`.
    Angles,
}

impl Counts {
    /// By a unit as written.
    pub fn of(unit: Option<&str>) -> Counts {
        let names = || unit.unwrap_or_default().split(|c: char| !c.is_alphabetic());
        let cycles = names().any(|name| name.ends_with("Hz"));
        let angles = names().any(|name| matches!(name, "deg" | "rpm") || name.ends_with("rad"));
        match (cycles, angles) {
            (true, false) => Counts::Cycles,
            (false, true) => Counts::Angles,
            _ => Counts::Any,
        }
    }

    /// What to write where one is wanted and the other found.
    pub fn unlike(self, found: Counts) -> Option<&'static str> {
        match (self, found) {
            (Counts::Angles, Counts::Cycles) => Some("5 cycles a second are `2*pi*5 rad/s`, or 300 `rpm`"),
            (Counts::Cycles, Counts::Angles) => Some("write it in `Hz`, divided by 2 pi"),
            _ => None,
        }
    }
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// What is being written, with its article, for messages.
    pub what: &'static str,
    /// What it must not depend on.
    pub refused: Depends,
    /// True where `energy` and its parts may stand.
    pub energy: bool,
    /// True where an input's name stands for its expression instead of a symbol.
    pub signals: bool,
    /// The unit that is wanted.
    pub unit: Expected,
    /// True where a bare number in a sum is in the unit of the other terms.
    pub numbers_fit: bool,
    /// True where what is written is tested as an identity.
    pub tested: bool,
    /// What a value is to count, if it is a rate.
    pub counts: Counts,
}

const REACTION: Depends = Depends::MULTIPLIER.and(Depends::BEYOND_LINEAR);
const ACCELERATION: Depends = Depends::ACCELERATION.and(Depends::JERK).and(REACTION);
const VELOCITY: Depends = ACCELERATION.and(Depends::VELOCITY);
const STATE: Depends = Depends::STATE.and(Depends::STATE_RATE);
const MEMORY: Depends = Depends::MEMORY;
const MOTION: Depends = VELOCITY.and(Depends::COORDINATE).and(STATE);

/// What the rate of a state is called in messages.
pub const RATE_OF_STATE: &str = "the rate of a state";

impl Rules {
    /// The rate of a state of first order, or an equation for it.
    pub const fn rate_of_state() -> Rules {
        Rules { refused: ACCELERATION, ..Rules::any(RATE_OF_STATE) }
    }

    /// Of parameters and sizes only.
    pub const fn constant(what: &'static str) -> Rules {
        Rules { refused: MOTION.and(Depends::TIME).and(Depends::INPUT).and(MEMORY), ..Rules::any(what) }
    }

    /// Of parameters, time, held values and other inputs.
    pub const fn signal(what: &'static str) -> Rules {
        Rules { refused: MOTION, signals: true, ..Rules::any(what) }
    }

    /// Of parameters, time, held values and inputs.
    pub const fn of_time(what: &'static str) -> Rules {
        Rules { refused: MOTION, ..Rules::any(what) }
    }

    /// Of coordinates, time and inputs.
    pub const fn position(what: &'static str) -> Rules {
        Rules { refused: VELOCITY.and(STATE).and(MEMORY), ..Rules::any(what) }
    }

    /// Of coordinates, states of first order, time and inputs.
    pub const fn inertial(what: &'static str) -> Rules {
        Rules { refused: VELOCITY.and(Depends::STATE_RATE).and(MEMORY), ..Rules::any(what) }
    }

    /// Of coordinates, states of first order, time, held values and inputs.
    pub const fn potential(what: &'static str) -> Rules {
        Rules { refused: VELOCITY.and(Depends::STATE_RATE), ..Rules::any(what) }
    }

    /// Of coordinates, velocities, time and inputs.
    pub const fn velocity(what: &'static str) -> Rules {
        Rules { refused: ACCELERATION, ..Rules::any(what) }
    }

    /// As [`Rules::velocity`], without states of first order and held values.
    pub const fn mechanical(what: &'static str) -> Rules {
        Rules { refused: ACCELERATION.and(STATE).and(MEMORY), ..Rules::any(what) }
    }

    /// As [`Rules::velocity`], and of reactions, linearly.
    pub const fn load(what: &'static str) -> Rules {
        let refused = Depends::ACCELERATION.and(Depends::JERK).and(Depends::BEYOND_LINEAR);
        Rules { refused, ..Rules::any(what) }
    }

    /// As [`Rules::velocity`], without discontinuities.
    pub const fn constraint() -> Rules {
        Rules { refused: ACCELERATION.and(STATE).and(MEMORY).and(Depends::SWITCH), ..Rules::any("a constraint") }
    }

    /// Of coordinates, time and inputs, without discontinuities.
    pub const fn joint(what: &'static str) -> Rules {
        Rules { refused: VELOCITY.and(STATE).and(MEMORY).and(Depends::SWITCH), ..Rules::any(what) }
    }

    /// Of everything but accelerations, and energies.
    pub const fn invariant(what: &'static str) -> Rules {
        Rules { energy: true, ..Rules::velocity(what) }
    }

    /// Of everything.
    pub const fn anything(what: &'static str) -> Rules {
        Rules { energy: true, ..Rules::any(what) }
    }

    /// Of everything but energies: what definitions may hold.
    pub const fn any(what: &'static str) -> Rules {
        Rules {
            what,
            refused: Depends::JERK,
            energy: false,
            signals: false,
            unit: Expected::Any,
            numbers_fit: false,
            tested: false,
            counts: Counts::Any,
        }
    }

    /// A quantity of this kind.
    pub const fn si(self, dimension: Dimension) -> Rules {
        Rules { unit: Expected::Si(dimension), ..self }
    }

    /// With sums in which a bare number is in the unit of the other terms.
    pub const fn numbers_fit(self) -> Rules {
        Rules { numbers_fit: true, ..self }
    }

    /// In an identity that is tested.
    pub const fn tested(self) -> Rules {
        Rules { tested: true, ..self }
    }

    /// A rate that counts what this unit does.
    pub fn counting(self, unit: Option<&str>) -> Rules {
        Rules { counts: Counts::of(unit), ..self }
    }

    /// In the unit of something else.
    pub const fn like(self, measure: Measure) -> Rules {
        Rules { unit: Expected::Like(measure), ..self }
    }
}
