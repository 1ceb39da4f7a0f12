//! Steady motions along constraints that leave no independent coordinates, as a parameter or speed changes.
//!
//! A steady motion goes along directions ξ_k in which nothing changes, v = Σ w_k ξ_k.  Its equations are
//!
//! F(q, v, 0, λ) = 0, c(q) = 0 of the rows that hold a place, c'(q, v) = 0 of all, and v_i as given,
//!
//! in q, λ and w.  The small motions about it are the departures of `tangent.rs`.  Those of the motion itself, along its
//! directions and to neighbouring steady motions, have eigenvalues 0 at every state of a branch: `modes/deflation.rs` leaves
//! them out.

use nalgebra::{DMatrix, DVector};

use super::state::{ConstrainedState, State};
use super::steady::Shifts;
use super::tangent::linearise_tangent;
use crate::linear::branch::{Balance, Slopes, Spectrum, Varied};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::modes::nullities;
use crate::linear::{Guess, LinearError};
use crate::mechanism::System;

/// The equations while something changes, which has this value at present; `moves` where something goes on, or may.
///
/// # Errors
/// Those of a singular value decomposition; numbers that are not finite.
pub(super) fn balance(
    probe: LinearisationPoint,
    rows: Vec<usize>,
    moves: bool,
    (varied, present): (&Varied, f64),
    guess: &Guess,
) -> Result<Box<dyn Balance>, LinearError> {
    let (levels, shifts) = {
        let system = probe.system.borrow();
        let held = ConstrainedState::new(&**system, &rows, &guess.q);
        let shifts = if moves { held.shifts(&guess.q)? } else { Shifts::none(held.n) };
        (held.levels, shifts)
    };
    let (given, varied, guess) = (varied.speeds(present, guess), varied.clone(), guess.clone());
    Ok(Box::new(Departing { probe, rows, levels, shifts, given, varied, guess, zeros: None }))
}

/// The equations of steady motions along constraints.
struct Departing {
    probe: LinearisationPoint,
    rows: Vec<usize>,
    /// The values at which known integrals are held.
    levels: Vec<f64>,
    shifts: Shifts,
    /// Speeds that are kept.
    given: Vec<f64>,
    varied: Varied,
    guess: Guess,
    /// How many eigenvalues are 0 everywhere, as of [`nullities`].
    zeros: Option<Vec<usize>>,
}

impl Departing {
    /// Looks at a place, discontinuities on its sides.
    ///
    /// # Errors
    /// Those of [`ConstrainedState::speeds`].
    fn look<T>(
        &self,
        q: &[f64],
        question: impl FnOnce(&ConstrainedState<'_, dyn System>, &State) -> T,
    ) -> Result<T, LinearError> {
        self.probe.sides_at(q);
        let system = self.probe.system.borrow();
        let held = ConstrainedState::at_levels(&**system, &self.rows, &self.levels);
        let v = held.speeds(&self.shifts, q, &self.given)?;
        Ok(question(&held, &held.state(q, &v)))
    }

    /// F_W at a solution.
    fn matrix(&self, q: &[f64]) -> Result<DMatrix<f64>, LinearError> {
        self.look(q, |held, state| {
            if !held.stays(state) {
                return Err(LinearError::NotAnEquilibrium { residual: held.left(state) });
            }
            Ok(held.on_the_tangent_space(state)?.0)
        })?
    }

    /// The coordinates whose speeds are kept.
    fn kept(&self) -> Vec<usize> {
        (0..self.given.len()).filter(|i| self.given[*i] != 0.0).collect()
    }

    /// The size of the system of equations, square with zeros where there are more of one than of the other.
    fn size(&self) -> usize {
        let (n, m) = (self.given.len(), self.rows.len());
        (n + 2 * m + self.kept().len()).max(n + m + self.shifts.0.ncols())
    }
}

impl Balance for Departing {
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
        let (n, m, all) = (q.len(), self.rows.len(), self.size());
        let found = self.look(q, |held, state| {
            let (terms, triples) = (held.terms(state), held.triples(state));
            let (mut left, mut measure) = (DVector::zeros(all), DVector::zeros(all));
            left.rows_mut(0, n).copy_from(&held.force(state));
            measure.rows_mut(0, n).copy_from(&(terms.forces + terms.by_state));
            for k in held.closed() {
                left[n + k] = triples[k][0];
            }
            measure.rows_mut(n, m).copy_from(&terms.places);
            left.rows_mut(n + m, m).iter_mut().zip(&triples).for_each(|(left, triple)| *left = triple[1]);
            measure.rows_mut(n + m, m).copy_from(&terms.rates);
            [left, measure]
        });
        found.unwrap_or_else(|_| [DVector::from_element(all, f64::NAN), DVector::from_element(all, f64::NAN)])
    }

    fn slopes(&self, q: &[f64]) -> Slopes {
        let (n, m, all, kept) = (q.len(), self.rows.len(), self.size(), self.kept());
        let ways = self.shifts.0.ncols();
        let found = self.look(q, |held, state| {
            let slopes = held.slopes(state);
            let jacobian = held.jacobian(state);
            let mut matrix = DMatrix::zeros(all, all);
            matrix.view_mut((0, 0), (n, n)).copy_from(&slopes.view((0, 0), (n, n)));
            matrix.view_mut((0, n), (n, m)).copy_from(&(-held.effects(state)));
            matrix.view_mut((0, n + m), (n, ways)).copy_from(&(slopes.view((0, n), (n, n)) * &self.shifts.0));
            let closed = held.closed_jacobian(&jacobian);
            for (line, k) in held.closed().enumerate() {
                matrix.view_mut((n + k, 0), (1, n)).copy_from(&closed.row(line));
            }
            matrix.view_mut((n + m, 0), (m, n)).copy_from(&held.rate_jacobian(state));
            matrix.view_mut((n + m, n + m), (m, ways)).copy_from(&(jacobian * &self.shifts.0));
            matrix.view_mut((n + 2 * m, n + m), (kept.len(), ways)).copy_from(&self.shifts.0.select_rows(&kept));
            matrix
        });
        let matrix = found.unwrap_or_else(|_| DMatrix::from_element(all, all, f64::NAN));
        Slopes { matrix, rows: DVector::from_element(all, 1.0) }
    }

    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError> {
        let matrix = self.matrix(q)?;
        match &self.zeros {
            Some(zeros) => Spectrum::of_departures(&matrix, zeros),
            None => Spectrum::of_departures(&matrix, &nullities(&matrix)?),
        }
    }

    fn note_zeros(&mut self, q: &[f64]) {
        let Ok(found) = self.matrix(q).and_then(|matrix| nullities(&matrix)) else { return };
        let count = |zeros: &Vec<usize>| zeros.iter().sum::<usize>();
        if self.zeros.as_ref().is_none_or(|known| count(&found) < count(known)) {
            self.zeros = Some(found);
        }
    }

    fn search(&self, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let system = self.probe.system.borrow().boxed_clone();
        let guess = Guess { q: q.to_vec(), v: self.given.clone(), inputs: self.guess.inputs.clone() };
        Ok(linearise_tangent(&*system, &guess, false)?.equilibrium.q)
    }

    fn jacobian(&self, q: &[f64]) -> Option<DMatrix<f64>> {
        self.look(q, |held, state| held.jacobian(state)).ok()
    }

    fn row(&self, index: usize) -> Option<String> {
        let row = *self.rows.get(index)?;
        Some(self.probe.system.borrow().description().rows[row].name.to_string())
    }
}
