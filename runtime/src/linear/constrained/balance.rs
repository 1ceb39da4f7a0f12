//! A mechanism with constraints as a parameter changes: the equations that the states of a branch satisfy.
//!
//! At rest F(q, 0, 0, λ) = 0 and c(q) = 0, with the multipliers λ that leave the least of F at every place; Newton's steps
//! have the slopes [∂F/∂q −Jᵀ; J 0], so that they converge as if λ were unknowns.

use nalgebra::{DMatrix, DVector};

use super::held::{Held, State};
use super::rest::{Bordered, at_rest, linearise_constrained, linearised_at};
use crate::linear::branch::{Balance, Slopes, Spectrum};
use crate::linear::equilibrium::Probe;
use crate::linear::{Guess, LinearError};
use crate::mechanism::System;

/// The equations of a mechanism with constraints while a parameter changes.
///
/// # Errors
/// [`LinearError::MovingBranch`]; as [`linearise_constrained`]: constraints that contain speeds and have no known integrals, forces made of reactions.
pub(in crate::linear) fn balance<S: System + ?Sized>(
    system: &S,
    parameter: usize,
    guess: &Guess,
) -> Result<Box<dyn Balance>, LinearError> {
    let probe = Probe::new(system, guess);
    if let Some(moving) = guess.v.iter().position(|v| *v != 0.0) {
        return Err(LinearError::MovingBranch { coordinate: probe.names().swap_remove(moving) });
    }
    let rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
    let levels = {
        let system = probe.system.borrow();
        at_rest(&**system, &rows, guess)?.levels
    };
    Ok(Box::new(AtRest { probe, rows, levels, parameter, inputs: guess.inputs.clone() }))
}

/// F = 0 and c = 0 at rest.
struct AtRest {
    probe: Probe,
    rows: Vec<usize>,
    /// The values at which known integrals are held.
    levels: Vec<f64>,
    parameter: usize,
    inputs: Vec<f64>,
}

impl AtRest {
    /// Looks at a place, discontinuities on its sides.
    fn look<T>(&self, q: &[f64], question: impl FnOnce(&Held<'_, dyn System>, &State) -> T) -> T {
        self.probe.sides_at(q);
        let system = self.probe.system.borrow();
        let held = Held::at_levels(&**system, &self.rows, &self.levels);
        question(&held, &held.state(q, &vec![0.0; held.n]))
    }

    fn guess(&self, q: &[f64]) -> Guess {
        Guess { inputs: self.inputs.clone(), ..Guess::at(q) }
    }
}

impl Balance for AtRest {
    fn set_parameter(&mut self, value: f64) {
        self.probe.set_parameter(self.parameter, value);
    }

    fn units(&self) -> Vec<String> {
        self.probe.units()
    }

    fn left(&self, q: &[f64]) -> [DVector<f64>; 2] {
        self.look(q, |held, state| {
            let (terms, triples) = (held.terms(state), held.triples(state));
            let left = held.force(state).iter().copied().chain(triples.iter().map(|triple| triple[0])).collect();
            let forces = &terms.forces + &terms.by_state;
            [
                DVector::from_vec(left),
                DVector::from_iterator(state.q.len() + triples.len(), forces.iter().chain(&terms.places).copied()),
            ]
        })
    }

    fn slopes(&self, q: &[f64]) -> Slopes {
        let Bordered { matrix, rows, .. } = self.look(q, |held, state| held.at_rest_slopes(state));
        Slopes { matrix, rows }
    }

    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError> {
        let system = self.probe.system.borrow().boxed_clone();
        Spectrum::of(&linearised_at(&*system, &self.guess(q))?)
    }

    fn search(&self, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let system = self.probe.system.borrow().boxed_clone();
        Ok(linearise_constrained(&*system, &self.guess(q), false)?.linear.equilibrium.q)
    }

    fn jacobian(&self, q: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.look(q, |held, state| held.jacobian(state)))
    }

    fn row(&self, index: usize) -> Option<String> {
        let row = *self.rows.get(index)?;
        Some(self.probe.system.borrow().description().rows[row].name.to_string())
    }
}
