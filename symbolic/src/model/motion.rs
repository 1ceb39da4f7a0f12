//! What a file asks of motions: `motions`.

use super::resolved::{Model, Scene};
use crate::diagnose::Place;
use crate::expr::Id;

/// A motion that is asked for.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Its name.
    pub name: String,
    /// Start, phase, end, tolerance and parameters: those of a scene, with what the motion says otherwise.
    pub scene: Scene,
    /// What is asked of it.
    pub goal: Goal,
    /// What is unknown, as the program names it, and the guesses.
    pub unknowns: Vec<(String, Id)>,
    /// Where it stands.
    pub place: Place,
}

/// What is asked of a motion.
#[derive(Clone, Debug)]
pub enum Goal {
    /// That it repeats itself.
    Closes(Box<Closes>),
    /// Values at the end, and something that is largest (true) or smallest there.
    Meets {
        /// Coordinates, rates and components of outputs with their values.
        conditions: Vec<(String, Id)>,
        /// What is to be largest or smallest.
        extreme: Option<(String, bool)>,
    },
    /// That it follows a record: the column `t`, s, and columns with the names of coordinates, rates and outputs, SI.
    Fits(Vec<(String, Vec<f64>)>),
}

/// How a motion repeats itself.
#[derive(Clone, Debug)]
pub struct Closes {
    /// The event at which it closes, and at which of its occurrences; absent: after a part of the period.
    pub event: Option<(usize, u32)>,
    /// It closes, or reaches `to`, after the period divided by this.
    pub part: u32,
    /// The period, or a guess of it.
    pub period: Option<Id>,
    /// The energy that it has.
    pub energy: Option<Id>,
    /// What the end is of the start.
    pub image: Image,
    /// Coordinates that may differ by any amount.
    pub shifts: Vec<usize>,
    /// Coordinates that are so many turns more at the end.
    pub turns: Vec<(usize, i64)>,
    /// The start and the end are their own images with time reversed.
    pub between: Option<[Image; 2]>,
    /// Where `closes` stands.
    pub place: Place,
}

/// A linear map of the state, q → S q and v → S v, with a permutation of the phases.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// For each coordinate of the image the one whose value it has, and whether with the opposite sign.
    pub coordinates: Vec<(usize, bool)>,
    /// For each phase the one that it becomes.
    pub phases: Vec<usize>,
    /// Where it is written.
    pub place: Place,
}

impl Image {
    /// The map that changes nothing.
    pub fn identity(n: usize, phases: usize, place: Place) -> Image {
        Image { coordinates: (0..n).map(|i| (i, false)).collect(), phases: (0..phases).collect(), place }
    }

    /// Whether it changes nothing.
    pub fn is_identity(&self) -> bool {
        self.coordinates.iter().enumerate().all(|(i, image)| *image == (i, false))
            && self.phases.iter().enumerate().all(|(k, to)| k == *to)
    }

    /// This map after another.
    pub fn after(&self, other: &Image) -> Image {
        let coordinate = |&(i, opposite): &(usize, bool)| {
            let (from, before) = other.coordinates[i];
            (from, opposite != before)
        };
        Image {
            coordinates: self.coordinates.iter().map(coordinate).collect(),
            phases: other.phases.iter().map(|k| self.phases[*k]).collect(),
            place: self.place.clone(),
        }
    }

    /// After how many times it gives back what it was; at most so many.
    pub fn order(&self, most: u32) -> Option<u32> {
        let mut image = self.clone();
        for count in 1..=most {
            if image.is_identity() {
                return Some(count);
            }
            image = self.after(&image);
        }
        None
    }
}

impl Model {
    /// The scenes, then those of the motions, as runs number them.
    pub fn all_scenes(&self) -> impl Iterator<Item = &Scene> + Clone {
        self.scenes.iter().chain(self.motions.iter().map(|motion| &motion.scene))
    }
}
