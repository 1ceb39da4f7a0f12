//! The equations that states of a branch satisfy.

use nalgebra::{DMatrix, DVector};

use super::spectrum::Spectrum;
use crate::linear::LinearError;
use crate::linear::equilibrium::{Guess, Probe, equilibrium_near, linearised_at};
use crate::mechanism::System;

/// Equations in the coordinates q at a value of one parameter, and the small motions about their solutions.
pub(in crate::linear) trait Balance {
    /// Another value of the parameter.
    fn set_parameter(&mut self, value: f64);

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

/// F(q) = 0 of a mechanism without constraints.
pub(super) struct Free {
    probe: Probe,
    system: Box<dyn System>,
    guess: Guess,
    parameter: usize,
    value: f64,
}

impl Free {
    pub fn new<S: System + ?Sized>(system: &S, parameter: usize, guess: &Guess) -> Free {
        let value = system.parameters()[parameter];
        Free { probe: Probe::new(system, guess), system: system.boxed_clone(), guess: guess.clone(), parameter, value }
    }

    fn at(&self, q: &[f64]) -> Guess {
        Guess { q: q.to_vec(), ..self.guess.clone() }
    }
}

impl Balance for Free {
    fn set_parameter(&mut self, value: f64) {
        self.probe.set_parameter(self.parameter, value);
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
        system.set_parameter(self.parameter, self.value);
        Ok(equilibrium_near(&*system, &self.at(q))?.q)
    }
}
