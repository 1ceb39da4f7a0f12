//! What was tested and held.

use super::freedoms::Freedoms;
use super::potential::Conservative;
use super::state::State;

/// How well two derivations agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The derivations.
    pub between: (String, String),
    /// At how many states.
    pub states: usize,
    /// The largest difference in an equation, relative to the magnitude of that equation's own terms.
    pub worst: f64,
}

/// Everything that was tested and held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Derivations against each other.
    pub agreements: Vec<Agreement>,
    /// Conserved quantities: name, largest relative rate.
    pub conserved: Vec<(String, f64)>,
    /// For each of these the events whose impacts change it.
    pub changed_by: Vec<Vec<String>>,
    /// Identities: name, largest relative difference.
    pub checks: Vec<(String, f64)>,
    /// Which forces have potentials.
    pub forces: Vec<Conservative>,
    /// The states at which derivations were compared.
    pub states: Vec<State>,
    /// How many rows of the constraints are independent in general, phase by phase, with the first scene's parameters.
    pub ranks: Vec<usize>,
    /// What kinds of constraints act in each phase, and what freedoms they leave; empty without constraints.
    pub freedoms: Vec<Freedoms>,
    /// Rotations, and the largest change of an acceleration by another length of their quaternion, as a part of its terms.
    pub lengths: Vec<(String, f64)>,
    /// Scenes whose motion was followed, until when, and until when they should go.
    pub followed: Vec<(String, f64, f64)>,
    /// What the states do not reach, in words: arguments that were not brought to where their function changes, and so on.
    pub unreached: Vec<String>,
    /// Reactions that nothing confirms, in words: the one equation that says what they are.
    pub alone: Vec<String>,
}
