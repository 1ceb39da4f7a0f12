//! What the values of a reference were computed in.

use std::fmt;

use crate::mechanism::Method;

/// What the values of a reference were computed in.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Arithmetic {
    /// `f64`: the values are those of the first of the two methods.
    Double {
        /// Why there are no more digits.
        why: DoubleOnly,
    },
    /// Double-double, 32 digits: the values are those of a method of extrapolation, run twice.
    DoubleDouble {
        /// The largest difference of the two runs, whose orders and tolerances are not the same, in parts of ranges.
        agreement: f64,
        /// The largest difference from the first method in `f64`, in parts of ranges.
        from_double: f64,
    },
    /// `f64`: the values are those at the start of a motion that repeats, which it has again after each period.
    Returns {
        /// The period, s.
        period: f64,
        /// How many periods.
        periods: usize,
    },
}

/// Why a reference, or a motion that repeats, is in `f64` only.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum DoubleOnly {
    /// Nobody gave the model to interpret.
    NoModel,
    /// The model to interpret is not the mechanism's.
    OtherModel,
    /// The mechanism has constraints.
    Constraints,
    /// The equations of motion, or inputs, have discontinuities or tables.
    Switches,
    /// The mechanism has events that do more than record.
    Events,
    /// An input is not the model file's.
    Inputs,
    /// Forces depend on time.
    Time,
    /// A pivot of M vanishes, or something is not finite.
    Singular,
    /// The steps are too many.
    TooLong {
        /// Evaluations of the accelerations that do not suffice.
        evaluations: u64,
    },
    /// Corrections of a motion that repeats end before its digits do.
    Unsettled {
        /// The size of the last one, in parts of what it changes.
        by: f64,
    },
    /// It was broken off.
    Interrupted,
    /// It is further from the first method in `f64` than rounding explains.
    Differs {
        /// The method.
        from: Method,
        /// By how much, in parts of ranges.
        by: f64,
    },
}

impl fmt::Display for DoubleOnly {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DoubleOnly::NoModel => f.write_str("there is no model to interpret"),
            DoubleOnly::OtherModel => f.write_str("the model to interpret is another one"),
            DoubleOnly::Constraints => f.write_str("there are constraints"),
            DoubleOnly::Switches => f.write_str("there are discontinuities or tables"),
            DoubleOnly::Events => f.write_str("there are events"),
            DoubleOnly::Inputs => f.write_str("an input is not the file's"),
            DoubleOnly::Time => f.write_str("its forces depend on time"),
            DoubleOnly::Unsettled { by } => write!(f, "its corrections end at {by:.0e} of what they change"),
            DoubleOnly::Singular => f.write_str("the accelerations are not known somewhere"),
            DoubleOnly::TooLong { evaluations } => write!(f, "it takes more than {evaluations} evaluations"),
            DoubleOnly::Interrupted => f.write_str("it was broken off"),
            DoubleOnly::Differs { from, by } => write!(f, "it differs from {from} by {by:.0e}"),
        }
    }
}
