//! What changes along a branch.

use std::fmt;
use std::rc::Rc;

use crate::linear::{Guess, LinearError};
use crate::mechanism::System;

/// Speeds that are kept in a steady motion, as functions of a parameter.
type Speeds = Rc<dyn Fn(f64) -> Vec<f64>>;

/// What goes through a range along a branch.
#[derive(Clone)]
pub enum Varied {
    /// A parameter, by its index; speeds of a steady motion stay those of the guess.
    Parameter(usize),
    /// A parameter, and speeds (SI, 0 of what does not go on) that depend on it: `start: {phi': W}`.
    WithSpeeds(usize, Speeds),
    /// The speed of a coordinate, by its index, that goes on steadily; others stay those of the guess.
    Speed(usize),
}

impl Varied {
    /// A parameter with speeds that depend on it.
    pub fn with_speeds(parameter: usize, speeds: impl Fn(f64) -> Vec<f64> + 'static) -> Self {
        Varied::WithSpeeds(parameter, Rc::new(speeds))
    }

    /// The parameter.
    pub(in crate::linear) fn parameter(&self) -> Option<usize> {
        match self {
            Varied::Parameter(index) | Varied::WithSpeeds(index, _) => Some(*index),
            Varied::Speed(_) => None,
        }
    }

    /// The value at which a system and a guess are.
    ///
    /// # Errors
    /// [`LinearError::WrongSize`] for an index that does not exist.
    pub(super) fn present<S: System + ?Sized>(&self, system: &S, guess: &Guess) -> Result<f64, LinearError> {
        let (what, index, values) = match self {
            Varied::Parameter(index) | Varied::WithSpeeds(index, _) => {
                ("the parameter's index", *index, system.parameters())
            }
            Varied::Speed(index) => ("the index of the speed", *index, guess.v.clone()),
        };
        values.get(index).copied().ok_or(LinearError::WrongSize { what, given: index, expected: values.len() })
    }

    /// The speeds that are kept at a value.
    pub(in crate::linear) fn speeds(&self, value: f64, guess: &Guess) -> Vec<f64> {
        match self {
            Varied::Parameter(_) => guess.v.clone(),
            Varied::WithSpeeds(_, speeds) => speeds(value),
            Varied::Speed(index) => {
                guess.v.iter().enumerate().map(|(i, v)| if i == *index { value } else { *v }).collect()
            }
        }
    }
}

impl fmt::Debug for Varied {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Varied::Parameter(index) => write!(f, "Parameter({index})"),
            Varied::WithSpeeds(index, _) => write!(f, "WithSpeeds({index})"),
            Varied::Speed(index) => write!(f, "Speed({index})"),
        }
    }
}
