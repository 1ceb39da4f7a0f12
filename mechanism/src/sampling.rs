//! What a mechanism remembers between events, what sets it, and when.

use super::{List, Quantity};

/// Held values, what makes events happen, clocks, and what events set.
///
/// A held value m is constant between the events that set it: forces, inputs and rates of states may contain it as they contain parameters.
/// It stands at the end of the block of constants of generated code, as the modes of discontinuities do.
///
/// ```
/// use dalembert::prelude::*;
/// dalembert::model!(yaml = r#"
/// name: Held
/// parameters: {m: 1 kg}
/// coordinates: {x: m}
/// memory: {push: 2 N}
/// bodies: {b: {mass: m, position: "[x, 0]"}}
/// forces: {f: {on: b, force: "[push, 0]"}}
/// events: {half: {every: 1 s, from: 1 s, then: {set: {push: push/2}}}}
/// scene: {until: 2}
/// "#);
/// let run = Held::default().simulate().run()?;
/// assert_eq!(run.memory("push"), Some(0.5));
/// assert!((run.last()["x'"] - 3.0).abs() < 1e-9);
/// # Ok::<(), dalembert::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sampling {
    /// Held values, in the order of `System::memory`.
    pub memory: List<Quantity>,
    /// What makes each event happen; empty where all are zeros of functions.
    pub triggers: List<Trigger>,
    /// Clocks, in the order of `System::clocks`.
    pub clocks: List<Clock>,
    /// What events set, in the order of `System::assignments`: all of one set at once.
    pub sets: List<List<Target>>,
    /// Whether something that is set contains accelerations or multipliers.
    pub sets_use_accelerations: bool,
}

/// What makes an event happen.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Trigger {
    /// Its function passes through zero.
    #[default]
    Zero,
    /// A tick of a clock, by its place.
    Tick(u32),
    /// Any of these held values, by their places, has been set.
    Set(List<u32>),
}

/// A clock: tick k is at `from` + k `every`, k = 0, 1, ….
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clock {
    /// Both as fractions (numerator, denominator) of seconds, where the file gives plain numbers; such times are rounded once.
    pub exact: Option<[(i128, i128); 2]>,
}

/// What an event sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A held value, by its place.
    Memory(u32),
    /// A state of first order, by the place of its hidden coordinate.
    State(u32),
}

impl Sampling {
    /// What makes an event happen.
    pub fn trigger(&self, event: usize) -> &Trigger {
        self.triggers.get(event).unwrap_or(&Trigger::Zero)
    }

    /// Whether nothing is held, set or sampled.
    pub fn is_empty(&self) -> bool {
        self.memory.is_empty() && self.clocks.is_empty() && self.sets.is_empty()
    }

    /// The place of the first value of a set among all assignments.
    pub fn first_of_set(&self, set: usize) -> usize {
        self.sets.iter().take(set).map(|targets| targets.len()).sum()
    }

    /// How many values all sets have.
    pub fn assignments(&self) -> usize {
        self.first_of_set(self.sets.len())
    }

    /// The held value of this name.
    pub fn place_of(&self, name: &str) -> Option<usize> {
        self.memory.iter().position(|held| *held.name == *name)
    }
}

/// That of a mechanism that remembers nothing.
pub static NO_SAMPLING: Sampling = Sampling {
    memory: List::Borrowed(&[]),
    triggers: List::Borrowed(&[]),
    clocks: List::Borrowed(&[]),
    sets: List::Borrowed(&[]),
    sets_use_accelerations: false,
};
