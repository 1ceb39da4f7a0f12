//! Motions that a model file asks for.

use alloc::vec::Vec;

use super::{List, Text};

/// A motion that the file names in `motions`.
///
/// Its start, phase, end and tolerance, and the parameters that it sets, are those of `System::scene(k)` and
/// `System::scene_parameters(k)` with k = `description().scenes.len()` + its place; its other numbers are [`MotionNumbers`].
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Its name.
    pub name: Text,
    /// What is asked of it.
    pub goal: Goal,
    /// Parameters, coordinates and rates (`theta'`) at the start, and `until`, that are unknown.
    pub unknowns: List<Text>,
}

/// What is asked of a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Goal {
    /// That it repeats itself.
    Closes(Closes),
    /// Values of coordinates, rates and components of outputs at the end, and one of them that is largest or smallest there.
    Meets {
        /// What has a value.
        conditions: List<Text>,
        /// What is largest or smallest.
        extreme: Option<(Text, Extreme)>,
    },
    /// That it follows a record: the column `t`, s, and those of coordinates, rates and components of outputs, SI.
    Fits(List<(Text, List<f64>)>),
}

/// Which extreme value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The largest near by.
    Largest,
    /// The smallest near by.
    Smallest,
}

/// How a motion repeats itself: at the end each coordinate, and its rate, has the value, or the opposite, that the coordinate of its
/// image had at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Closes {
    /// When.
    pub by: ClosesBy,
    /// Whether [`MotionNumbers::period`] is given: a guess, or the period of what acts on a mechanism that depends on time.
    pub period: bool,
    /// Whether [`MotionNumbers::energy`] is given.
    pub energy: bool,
    /// For each coordinate the one whose value it has at the end, and whether with the opposite sign.
    pub images: List<(u32, bool)>,
    /// For each phase the one that it is at the end.
    pub phases: List<u32>,
    /// Coordinates that may differ by any amount.
    pub shifts: List<u32>,
    /// Coordinates that are so many turns, 2π each, more at the end.
    pub turns: List<(u32, i32)>,
    /// The start and the end are each its own image with all speeds reversed: where the motion turns round.  `images`, `shifts` and
    /// `turns` say nothing then.
    pub between: Option<[List<(u32, bool)>; 2]>,
}

/// When a motion closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosesBy {
    /// After the period divided by this.
    Part(u32),
    /// Just after an event has happened so many times.
    Event {
        /// Its index.
        event: u32,
        /// How many times.
        count: u32,
    },
}

/// The numbers of a motion with the present parameters, SI.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionNumbers {
    /// The period or a guess of it, s; 0 where none is given.
    pub period: f64,
    /// The energy, J (per kg or kg m² where the file's energies are); 0 where none is given.
    pub energy: f64,
    /// Guesses of the unknowns.
    pub guesses: Vec<f64>,
    /// Values that `conditions` have.
    pub conditions: Vec<f64>,
}

impl MotionNumbers {
    /// From the period, the energy, guesses and conditions, one after the other.
    pub fn new(motion: &Motion, numbers: &[f64]) -> MotionNumbers {
        let (first, rest) = numbers.split_at(numbers.len().min(2));
        let (guesses, conditions) = rest.split_at(rest.len().min(motion.unknowns.len()));
        let at = |k: usize| first.get(k).copied().unwrap_or(0.0);
        MotionNumbers { period: at(0), energy: at(1), guesses: guesses.to_vec(), conditions: conditions.to_vec() }
    }
}
