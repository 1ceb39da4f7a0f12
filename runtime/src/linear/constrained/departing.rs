//! Steady motions along constraints that leave no independent coordinates, as a parameter or speed changes.
//!
//! A steady motion goes along directions ξ_k in which nothing changes, shifts and turns (`turns.rs`): v = Σ w_k ξ_k(q) and
//! a = A v with A = Σ w_k A_k.  Its equations are
//!
//! F(q, v, a, λ) = 0, c(q) = 0 of the rows that hold a place, c'(q, v) = 0 of all, and v_i as given,
//!
//! in q, λ and w; by q they have the slopes ∂F/∂q + (∂F/∂q' + M A) A and ∂c'/∂q + J A, by w_k those along ξ_k and A_k v.  The small motions about it are the departures of `tangent.rs`.  Those of the motion itself, along its
//! directions and to neighbouring steady motions, have eigenvalues 0 at every state of a branch: `modes/deflation.rs` leaves
//! them out.

use nalgebra::{DMatrix, DVector};

use super::relative::Small;
use super::state::{ConstrainedState, State, telling};
use super::steady::Shifts;
use super::tangent::linearise_tangent;
use super::turns::Symmetries;
use crate::linear::branch::{Balance, Slopes, Spectrum, Varied};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::matrices::natural_sizes;
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
    // The speed that is varied may be 0 at present.
    let mut kept = varied.speeds(present, guess);
    if let Varied::Speed(index) = varied
        && kept[*index] == 0.0
    {
        kept[*index] = 1.0;
    }
    let (levels, symmetries) = {
        let system = probe.system.borrow();
        super::refuse_sliding(&**system)?;
        let held = ConstrainedState::new(&**system, &rows, &guess.q);
        let symmetries =
            if moves { held.symmetries(&guess.q, &kept)? } else { Symmetries::of_shifts(Shifts::none(held.n)) };
        (held.levels, symmetries)
    };
    let (given, varied, guess) = (varied.speeds(present, guess), varied.clone(), guess.clone());
    Ok(Box::new(Departing { probe, rows, levels, symmetries, given, varied, guess, zeros: None }))
}

/// The equations of steady motions along constraints.
struct Departing {
    probe: LinearisationPoint,
    rows: Vec<usize>,
    /// The values at which known integrals are held.
    levels: Vec<f64>,
    symmetries: Symmetries,
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
        Ok(question(&held, &held.along(&self.symmetries, q, &self.given)?))
    }

    /// As many numbers as there are equations, none of which is known where there are no speeds.
    fn unknown(&self) -> DVector<f64> {
        let system = self.probe.system.borrow();
        let held = ConstrainedState::at_levels(&**system, &self.rows, &self.levels);
        DVector::from_element(held.equations(&self.symmetries, &self.given), f64::NAN)
    }

    /// Small departures from a solution.
    fn departures(&self, q: &[f64]) -> Result<Small, LinearError> {
        self.look(q, |held, state| {
            if !held.stays(state) {
                return Err(LinearError::NotAnEquilibrium { residual: held.left(state) });
            }
            held.on_the_tangent_space(state)
        })?
    }
}

/// What is left of the equations, and what it is judged by.
pub(super) struct Equations {
    pub left: DVector<f64>,
    measure: DVector<f64>,
}

/// The coordinates whose speeds are kept.
fn kept(given: &[f64]) -> Vec<usize> {
    (0..given.len()).filter(|i| given[*i] != 0.0).collect()
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// The state of a steady motion at a place, given speeds (not 0) kept.
    ///
    /// # Errors
    /// Those of [`ConstrainedState::speeds`].
    pub fn along(&self, symmetries: &Symmetries, q: &[f64], given: &[f64]) -> Result<State, LinearError> {
        let (v, weights) = self.speeds_along((&symmetries.at(q), &symmetries.coordinates()), q, given)?;
        Ok(self.turning(q, &v, symmetries.turning(&weights)))
    }

    /// How many equations, or unknowns, there are.
    pub fn equations(&self, symmetries: &Symmetries, given: &[f64]) -> usize {
        let (n, m) = (self.n, self.rows.len());
        (n + 2 * m + kept(given).len()).max(n + m + symmetries.len())
    }

    /// What is left of the equations at a state, and what it is judged by; 0 of given speeds.
    pub fn equations_left(&self, state: &State, all: usize) -> Equations {
        let (n, m) = (self.n, self.rows.len());
        let (terms, triples) = (self.terms(state), self.triples(state));
        let (mut left, mut measure) = (DVector::zeros(all), DVector::zeros(all));
        left.rows_mut(0, n).copy_from(&self.force(state));
        measure.rows_mut(0, n).copy_from(&(terms.forces + terms.by_state));
        for k in self.closed() {
            left[n + k] = triples[k][0];
        }
        measure.rows_mut(n, m).copy_from(&terms.places);
        left.rows_mut(n + m, m).iter_mut().zip(&triples).for_each(|(left, triple)| *left = triple[1]);
        measure.rows_mut(n + m, m).copy_from(&terms.rates);
        Equations { left, measure }
    }

    /// Their slopes by q, λ and w, square with zeros where there are more equations than unknowns, or fewer.
    pub fn equations_slopes(&self, symmetries: &Symmetries, state: &State, given: &[f64]) -> DMatrix<f64> {
        let (n, m, ways, all) = (self.n, self.rows.len(), symmetries.len(), self.equations(symmetries, given));
        let (slopes, jacobian, mass) = (self.slopes(state), self.jacobian(state), self.mass(state));
        let (directions, turned, kept) = (symmetries.at(&state.q), symmetries.turned(&state.v), kept(given));
        let by_speed = slopes.view((0, n), (n, n));
        let (mut by_place, mut rate_jacobian) = (slopes.view((0, 0), (n, n)).into_owned(), self.rate_jacobian(state));
        let mut by_weight = by_speed * &directions;
        let mut kept_by_place = DMatrix::zeros(kept.len(), n);
        if let Some(turn) = &state.turn {
            let turn = &turn.matrix;
            by_place += (by_speed + &mass * turn) * turn;
            rate_jacobian += &jacobian * turn;
            by_weight += &mass * (turn * &directions + turned);
            kept_by_place = turn.select_rows(&kept);
        }
        let mut matrix = DMatrix::zeros(all, all);
        matrix.view_mut((0, 0), (n, n)).copy_from(&by_place);
        matrix.view_mut((0, n), (n, m)).copy_from(&(-self.effects(state)));
        matrix.view_mut((0, n + m), (n, ways)).copy_from(&by_weight);
        let closed = self.closed_jacobian(&jacobian);
        for (line, k) in self.closed().enumerate() {
            matrix.view_mut((n + k, 0), (1, n)).copy_from(&closed.row(line));
        }
        matrix.view_mut((n + m, 0), (m, n)).copy_from(&rate_jacobian);
        matrix.view_mut((n + m, n + m), (m, ways)).copy_from(&(jacobian * &directions));
        matrix.view_mut((n + 2 * m, 0), (kept.len(), n)).copy_from(&kept_by_place);
        matrix.view_mut((n + 2 * m, n + m), (kept.len(), ways)).copy_from(&directions.select_rows(&kept));
        self.without_rounding(matrix, state, &directions)
    }

    /// Slopes without what is rounding beside the terms of its equation: rows and columns of nothing else would be brought to the size
    /// of the others where they are solved.
    fn without_rounding(&self, matrix: DMatrix<f64>, state: &State, directions: &DMatrix<f64>) -> DMatrix<f64> {
        let (n, m) = (self.n, self.rows.len());
        let measure = self.equations_left(state, matrix.nrows()).measure;
        let places = natural_sizes(&self.units(), &state.q);
        let fastest = state.v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let rate = |direction: usize| fastest / directions.column(direction).amax();
        let ways = directions.ncols();
        let sizes = places.into_iter().enumerate().chain((0..ways).map(|k| (n + m + k, rate(k))));
        telling(matrix, &measure.as_slice()[..n + 2 * m], sizes)
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
        let found = self.look(q, |held, state| {
            let all = held.equations(&self.symmetries, &self.given);
            let Equations { left, measure } = held.equations_left(state, all);
            [left, measure]
        });
        found.unwrap_or_else(|_| [self.unknown(), self.unknown()])
    }

    fn slopes(&self, q: &[f64]) -> Slopes {
        let found = self.look(q, |held, state| held.equations_slopes(&self.symmetries, state, &self.given));
        let matrix = found.unwrap_or_else(|_| DMatrix::from_diagonal(&self.unknown()));
        let rows = DVector::from_element(matrix.nrows(), 1.0);
        Slopes { matrix, rows }
    }

    fn spectrum(&self, q: &[f64]) -> Result<Spectrum, LinearError> {
        let found = self.departures(q)?;
        let matrix = found.without_shifts();
        match &self.zeros {
            Some(zeros) => Spectrum::of_departures((&matrix, found.shifted), zeros),
            None => Spectrum::of_departures((&matrix, found.shifted), &nullities(&matrix)?),
        }
    }

    fn note_zeros(&mut self, q: &[f64]) {
        let Ok(found) = self.departures(q).and_then(|found| nullities(&found.without_shifts())) else { return };
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
