//! Events: what makes them happen, what they do, and what they set.

use crate::diagnose::Place;
use crate::expr::Id;

/// An event.
#[derive(Clone, Debug)]
pub struct Event {
    /// Its expanded label.
    pub name: String,
    /// What makes it happen.
    pub trigger: Trigger,
    /// Zero when it happens; 1 where something else makes it happen.
    pub when: Id,
    /// It counts only where this is > 0.
    pub condition: Option<Id>,
    /// −1 falling, 1 rising, 0 both.
    pub direction: i8,
    /// The phases in which it counts; absent: every.
    pub phases: Option<Vec<usize>>,
    /// What happens, in order.
    pub actions: Vec<EventAction>,
    /// Where it stands.
    pub place: Place,
}

/// What makes an event happen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Trigger {
    /// Its function passes through zero.
    Zero,
    /// A tick of a clock, by its place.
    Tick(usize),
    /// Any of these held values, by their places, has been set.
    Set(Vec<usize>),
}

/// When ticks come: at `from` + k `every`, k = 0, 1, …, both of parameters.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// The first tick, s.
    pub from: Id,
    /// The period, s.
    pub every: Id,
}

/// What an event does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventAction {
    /// Ends the run.
    Stop,
    /// Notes time and state.
    Record,
    /// Goes on in this phase.
    Phase(usize),
    /// Sets held values, or states of first order; by the place of the set.
    Set(usize),
    /// Decides anew what all contacts do; by the place of the one that changes.
    Contact(usize),
    /// An impulse along a constraint that is not active.
    Impact {
        /// The coefficient of restitution e, of parameters: the constraint's rate becomes −e times what it was.
        restitution: Id,
        /// The constraint's place.
        along: usize,
    },
}

/// What one `set` sets, all of it at once.
#[derive(Clone, Debug, Default)]
pub struct Set {
    /// What is set, and the value, which is that before.
    pub values: Vec<(Target, Id)>,
}

/// What an event can set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A held value, by its place.
    Memory(usize),
    /// A state of first order, by its place.
    State(usize),
}

/// Held noise: a value that ticks set to normally distributed numbers.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Its expanded name.
    pub name: String,
    /// The free parameter that is its seed, by its place, where it is one.
    pub seed: Option<u32>,
    /// The event that sets it, by its place.
    pub event: usize,
    /// What it holds, by places among held values: its number at the last tick; where it is straight between ticks also its slope, and when that tick
    /// was.
    pub held: Vec<usize>,
    /// Its value, of what it holds and time.
    pub value: Id,
}

/// A held value: what `memory` declares, or what noise holds.  It changes by events alone.
#[derive(Clone, Debug)]
pub struct HeldValue {
    /// Its expanded name.
    pub name: String,
    /// Its unit as written.
    pub unit: Option<String>,
    /// What it is where a run starts, of parameters.
    pub start: Id,
    /// Where it is declared.
    pub place: Place,
}
