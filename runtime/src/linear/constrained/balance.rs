//! A mechanism with constraints as a parameter or speed changes: the equations that the states of a branch satisfy.
//!
//! At rest F(q, 0, 0, λ) = 0 and c(q) = 0, in steady motions F(q, v, 0, λ) = 0, with the multipliers λ that leave the least of F
//! at every place; Newton's steps have the slopes [∂F/∂q −Jᵀ; J 0], so that they converge as if λ were unknowns.

use nalgebra::{DMatrix, DVector};

use super::rest::{Bordered, at_rest, linearise_constrained, linearised_at};
use super::state::{ConstrainedState, State};
use super::steady::Shifts;
use crate::linear::branch::{Balance, Slopes, Spectrum, Varied};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::{Guess, LinearError};
use crate::mechanism::{System, rows_in_force};

/// The equations of a mechanism with constraints while something changes, which has this value at present.
///
/// Where constraints leave no independent coordinates (as [`linearise_constrained`] has it) they are those of `departing.rs`.
///
/// # Errors
/// Numbers that are not finite; those of a singular value decomposition.
pub(in crate::linear) fn balance<S: System + ?Sized>(
    system: &S,
    varied: &Varied,
    present: f64,
    guess: &Guess,
) -> Result<Box<dyn Balance>, LinearError> {
    let probe = LinearisationPoint::new(system, guess);
    probe.sides_at(&guess.q);
    let rows: Vec<usize> = rows_in_force(system).collect();
    let moves = !matches!(varied, Varied::Parameter(_)) || guess.v.iter().any(|v| *v != 0.0);
    let found = {
        let system = probe.system.borrow();
        match at_rest(&**system, &rows, guess) {
            // What turns as a whole is seen from axes that turn along.
            #[cfg(feature = "modal")]
            Ok(held) if held.turning_guess(guess).is_some() => None,
            Ok(held) => {
                let shifts = if moves { Some(held.shifts(&guess.q)?) } else { None };
                Some((held.levels, shifts))
            }
            #[cfg(feature = "modal")]
            Err(
                LinearError::VelocityConstraint { .. }
                | LinearError::MovingConstraint { .. }
                | LinearError::FrictionOfReactions,
            ) => None,
            Err(why) => return Err(why),
        }
    };
    let Some((levels, shifts)) = found else {
        #[cfg(feature = "modal")]
        return super::departing::balance(probe, rows, moves, (varied, present), guess);
        #[cfg(not(feature = "modal"))]
        return Err(LinearError::NeedsFeature { feature: "modal" });
    };
    let (given, varied, guess) = (varied.speeds(present, guess), varied.clone(), guess.clone());
    Ok(Box::new(Kept { probe, rows, levels, shifts, given, varied, guess }))
}

/// F = 0 and c = 0 at rest or in steady motion.
struct Kept {
    probe: LinearisationPoint,
    rows: Vec<usize>,
    /// The values at which known integrals are held.
    levels: Vec<f64>,
    /// What can go on steadily; `None` where nothing is to.
    shifts: Option<Shifts>,
    /// Speeds that are kept.
    given: Vec<f64>,
    varied: Varied,
    guess: Guess,
}

impl Kept {
    /// Looks at a place, discontinuities on its sides.
    ///
    /// # Errors
    /// Those of [`ConstrainedState::speeds`].
    fn try_look<T>(
        &self,
        q: &[f64],
        question: impl FnOnce(&ConstrainedState<'_, dyn System>, &State) -> T,
    ) -> Result<T, LinearError> {
        self.probe.sides_at(q);
        let system = self.probe.system.borrow();
        let held = ConstrainedState::at_levels(&**system, &self.rows, &self.levels);
        let v = match &self.shifts {
            Some(shifts) => held.speeds(shifts, q, &self.given)?,
            None => vec![0.0; held.n],
        };
        Ok(question(&held, &held.state(q, &v)))
    }

    fn at(&self, q: &[f64], v: &[f64]) -> Guess {
        Guess { q: q.to_vec(), v: v.to_vec(), inputs: self.guess.inputs.clone() }
    }

    /// As many numbers as there are equations, none of which is known where there are no speeds.
    fn unknown(&self, q: &[f64]) -> DVector<f64> {
        DVector::from_element(q.len() + self.rows.len(), f64::NAN)
    }
}

impl Balance for Kept {
    fn set(&mut self, value: f64) {
        if let Some(index) = self.varied.parameter() {
            self.probe.set_parameter(index, value);
        }
        self.given = self.varied.speeds(value, &self.guess);
        self.probe.v.clone_from(&self.given);
    }

    fn units(&self) -> Vec<String> {
        self.probe.units()
    }

    fn left(&self, q: &[f64]) -> [DVector<f64>; 2] {
        let found = self.try_look(q, |held, state| {
            let (terms, triples) = (held.terms(state), held.triples(state));
            let left = held.force(state).iter().copied().chain(triples.iter().map(|triple| triple[0])).collect();
            let forces = &terms.forces + &terms.by_state;
            [
                DVector::from_vec(left),
                DVector::from_iterator(state.q.len() + triples.len(), forces.iter().chain(&terms.places).copied()),
            ]
        });
        found.unwrap_or_else(|_| [self.unknown(q), self.unknown(q)])
    }

    fn slopes(&self, q: &[f64]) -> Slopes {
        match self.try_look(q, |held, state| held.at_rest_slopes(state)) {
            Ok(Bordered { matrix, rows, .. }) => Slopes { matrix, rows },
            Err(_) => Slopes { matrix: DMatrix::from_diagonal(&self.unknown(q)), rows: self.unknown(q) },
        }
    }

    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError> {
        let v = self.try_look(q, |_, state| state.v.clone())?;
        let system = self.probe.system.borrow().boxed_clone();
        Spectrum::of(&linearised_at(&*system, &self.at(q, &v))?)
    }

    fn search(&self, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let system = self.probe.system.borrow().boxed_clone();
        Ok(linearise_constrained(&*system, &self.at(q, &self.given), false)?.linear.equilibrium.q)
    }

    fn jacobian(&self, q: &[f64]) -> Option<DMatrix<f64>> {
        self.try_look(q, |held, state| held.jacobian(state)).ok()
    }

    fn row(&self, index: usize) -> Option<String> {
        let row = *self.rows.get(index)?;
        Some(self.probe.system.borrow().description().rows[row].name.to_string())
    }
}
