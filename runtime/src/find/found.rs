//! What a search found.

use super::fit::Fit;
use crate::run::Run;
#[cfg(feature = "cli")]
use crate::run::written;

/// Values for which a motion does what is wanted, and the motion.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Found {
    /// What was unknown, in the order in which it was named.
    pub values: Vec<Value>,
    /// What the conditions, and what is largest or smallest, come to.
    pub reached: Vec<Value>,
    /// Where the motion ends, s.
    pub end_time: Value,
    /// The motion.
    pub run: Run,
    /// Newton steps that were taken.
    pub steps: usize,
    /// Runs with slopes that were made.
    pub runs: usize,
    /// Directions in which nothing that is wanted changes: by how much of itself each unknown moves.  The nearest solution to the guess was
    /// taken.
    pub free: Vec<Vec<(String, f64)>>,
    /// The order m of the root: what is wanted changes like the m-th power of the distance along some direction, and one m-th of the digits
    /// hold; 1 of a simple root.
    pub multiplicity: usize,
    /// The unknowns that have so few digits.
    pub multiple_in: Vec<String>,
    /// How well a record determines the values, where there was one.
    pub fit: Option<Fit>,
}

/// A number, SI, and how far it may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Value {
    /// What it is of.
    pub name: String,
    /// SI.
    pub value: f64,
    /// What a run at another tolerance, and the last step, say of it.
    pub error: f64,
}

impl Value {
    /// The number with the digits that hold.
    #[cfg(feature = "cli")]
    pub(crate) fn written(&self) -> String {
        written(self.value, if self.error.is_nan() { f64::INFINITY } else { self.error })
    }
}

impl Found {
    /// What was found for an unknown, or what a condition comes to.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.values.iter().chain(&self.reached).find(|value| value.name == name).map(|value| value.value)
    }
}
