//! The equations that states of a branch satisfy.

use nalgebra::{DMatrix, DVector};

use super::spectrum::Spectrum;
use super::varied::Varied;
use crate::linear::LinearError;
use crate::linear::equilibrium::{Guess, LinearisationPoint, equilibrium_near, linearised_at};
use crate::mechanism::System;

/// Equations in the coordinates q at a value of one parameter or speed, and the small motions about their solutions.
pub(in crate::linear) trait Balance {
    /// Another value of what changes.
    fn set(&mut self, value: f64);

    /// Units of the coordinates: those with the same unit are measured by the largest of them.
    fn units(&self) -> Vec<String>;

    /// What is left of every equation, and what it is judged by.
    fn left(&self, q: &[f64]) -> [DVector<f64>; 2];

    /// The equations' slopes.
    fn slopes(&self, q: &[f64]) -> Slopes;

    /// Small motions about a solution.
    ///
    /// # Errors
    /// Those of linearising there.
    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError>;

    /// Counts the eigenvalues that are 0 at a solution: what is 0 at all of those that it is shown is left out of spectra.
    fn note_zeros(&mut self, _: &[f64]) {}

    /// The solution that a search from here finds, near or not.
    ///
    /// # Errors
    /// That there is none.
    fn search(&self, q: &[f64]) -> Result<Vec<f64>, LinearError>;

    /// J, the slopes of constraints by coordinates; `None` without any.
    fn jacobian(&self, _: &[f64]) -> Option<DMatrix<f64>> {
        None
    }

    /// The name of a row of it.
    fn row(&self, _: usize) -> Option<String> {
        None
    }
}

/// Slopes of equations, by the coordinates and behind them by multipliers in any unit.
pub(in crate::linear) struct Slopes {
    /// Each row multiplied by its factor.
    pub matrix: DMatrix<f64>,
    /// The factors.
    pub rows: DVector<f64>,
}

/// F(q, v, 0) = 0 of a mechanism without constraints.
pub(super) struct Free {
    probe: LinearisationPoint,
    system: Box<dyn System>,
    guess: Guess,
    varied: Varied,
    value: f64,
}

impl Free {
    pub fn new<S: System + ?Sized>(system: &S, varied: &Varied, value: f64, guess: &Guess) -> Free {
        let (probe, system) = (LinearisationPoint::new(system, guess), system.boxed_clone());
        Free { probe, system, guess: guess.clone(), varied: varied.clone(), value }
    }

    fn at(&self, q: &[f64]) -> Guess {
        Guess { q: q.to_vec(), v: self.probe.v.clone(), inputs: self.guess.inputs.clone() }
    }
}

impl Balance for Free {
    fn set(&mut self, value: f64) {
        if let Some(index) = self.varied.parameter() {
            self.probe.set_parameter(index, value);
        }
        self.probe.v = self.varied.speeds(value, &self.guess);
        self.value = value;
    }

    fn units(&self) -> Vec<String> {
        self.probe.units()
    }

    fn left(&self, q: &[f64]) -> [DVector<f64>; 2] {
        [self.probe.force(q), self.probe.measure(q)].map(DVector::from_vec)
    }

    fn slopes(&self, q: &[f64]) -> Slopes {
        Slopes { matrix: self.probe.stiffness(q), rows: DVector::from_element(q.len(), 1.0) }
    }

    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError> {
        self.probe.check(q)?;
        Spectrum::of(&linearised_at(&*self.system, &self.probe, &self.at(q))?)
    }

    fn search(&self, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let mut system = self.system.boxed_clone();
        if let Some(index) = self.varied.parameter() {
            system.set_parameter(index, self.value);
        }
        Ok(equilibrium_near(&*system, &self.at(q))?.q)
    }
}
