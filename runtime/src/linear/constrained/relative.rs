//! Motions that turn as a whole, seen from axes that turn along: relative equilibria, v = ξ(q) and a = A v (`turns.rs`).
//!
//! From these axes departures obey δ' = (F − diag(A, A)) δ.  Shifts of the plane stay where they are and are seen to turn
//! backwards, at the rate of the motion: their part of the matrix is known by itself, and their eigenvalues are given as seen
//! from the ground, 0.

use nalgebra::{Complex, DMatrix, DVector};

use super::state::{ConstrainedState, State, Turning};
use super::tangent::{FAR, ITERATIONS, LATER, SAME, null_space};
use super::turns::{Symmetries, later};
use crate::linear::matrices::{expm, natural_sizes, tried_parts};
use crate::linear::{FirstOrder, Guess, LinearError, Stability, first_order_modes};
use crate::matrix::solve_least;
use crate::mechanism::System;
#[cfg(feature = "cli")]
use crate::mechanism::rows_in_force;

/// Shifts that constraints do not allow miss them by more than this part of themselves.
const MISSED: f64 = 1e-9;

/// Small departures on the states that the constraints leave.
pub(super) struct Small {
    /// F_W, 1/s.
    pub matrix: DMatrix<f64>,
    /// W.
    pub departures: DMatrix<f64>,
    /// How many of its first columns are shifts that are seen to turn.
    pub shifted: usize,
}

impl Small {
    /// F_W of all but the shifts.
    pub fn without_shifts(&self) -> DMatrix<f64> {
        let left = self.matrix.nrows() - self.shifted;
        self.matrix.view((self.shifted, self.shifted), (left, left)).into_owned()
    }
}

impl Turning {
    /// A basis of departures, in these units, with the shifts that turn along as its first columns; how many they are.
    ///
    /// # Errors
    /// [`LinearError::NoConvergence`].
    pub fn shifts_first(
        &self,
        basis: DMatrix<f64>,
        units: &DVector<f64>,
    ) -> Result<(DMatrix<f64>, usize), LinearError> {
        let n = units.len() / 2;
        let mut parts: Vec<DVector<f64>> = Vec::new();
        for shift in self.shifts.column_iter() {
            let whole = DVector::from_fn(2 * n, |i, _| if i < n { shift[i] / units[i] } else { 0.0 });
            let part = basis.tr_mul(&whole);
            if (&basis * &part - &whole).norm() <= MISSED * whole.norm() {
                parts.push(part);
            }
        }
        if parts.is_empty() {
            return Ok((basis, 0));
        }
        let shifts = DMatrix::from_columns(&parts);
        let failed = LinearError::NoConvergence { what: "departures beside shifts" };
        let others = null_space(shifts.transpose()).ok_or(failed)?;
        let own = shifts.qr().q();
        let columns: Vec<DVector<f64>> =
            own.column_iter().chain(others.column_iter()).map(|column| &basis * column).collect();
        Ok((DMatrix::from_columns(&columns), parts.len()))
    }
}

/// The analysis of a matrix of which the first departures are shifts that are seen to turn.
///
/// # Errors
/// As [`first_order_modes`].
pub(super) fn analysed(matrix: &DMatrix<f64>, shifted: usize) -> Result<FirstOrder, LinearError> {
    if shifted == 0 {
        return first_order_modes(matrix);
    }
    let n = matrix.nrows();
    let found = first_order_modes(&matrix.view((shifted, shifted), (n - shifted, n - shifted)).into_owned())?;
    let complex = |rows: usize, columns: usize| matrix.view((0, rows), (shifted, columns)).map(Complex::from);
    let (own, coupling) = (complex(0, shifted), complex(shifted, n - shifted));
    // (G_rr r, G_uu u + G_ur r) = λ (r, u).
    let whole = |value: Complex<f64>, shape: &DVector<Complex<f64>>| {
        let seen = DMatrix::from_diagonal_element(shifted, shifted, value) - &own;
        let along = seen.lu().solve(&(&coupling * shape)).unwrap_or_else(|| DVector::zeros(shifted));
        DVector::from_iterator(n, along.iter().chain(shape.iter()).copied()).normalize()
    };
    let shifts = (0..shifted).map(|k| DVector::from_fn(n, |i, _| f64::from(u8::from(i == k))));
    let still = |shape: &DVector<f64>| whole(Complex::from(0.0), &shape.map(Complex::from)).map(|x| x.re);
    let neutral: Vec<DVector<f64>> = shifts.chain(found.neutral.iter().map(still)).collect();
    let pairs = found.eigenvalues.iter().skip(found.zeros).zip(&found.shapes);
    let zero = std::iter::repeat_n(Complex::from(0.0), shifted);
    Ok(FirstOrder {
        shapes: pairs.map(|(value, shape)| whole(*value, shape)).collect(),
        eigenvalues: zero.chain(found.eigenvalues.iter().copied()).collect(),
        rank: n - neutral.len(),
        zeros: found.zeros + shifted,
        neutral,
        stability: if found.stability == Stability::Asymptotic { Stability::Neutral } else { found.stability },
        ..found
    })
}

/// Whether the speeds of a guess are those of a motion that turns as a whole, as what rolls along a circle.
#[cfg(feature = "cli")]
pub(crate) fn turns_as_a_whole(system: &dyn System, guess: &Guess) -> bool {
    let rows: Vec<usize> = rows_in_force(system).collect();
    let turns = |system: &dyn System, guess: &Guess| {
        let turns = ConstrainedState::new(system, &rows, &guess.q).turning_guess(guess).is_some();
        Ok((turns, guess.clone()))
    };
    super::on_its_sides(system, guess, turns).unwrap_or(false)
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// The directions in which nothing changes, where the speeds of a guess need one that turns; `None` where shifts will do, or
    /// nothing.
    pub fn turning_guess(&self, guess: &Guess) -> Option<Symmetries> {
        if guess.v.iter().all(|v| *v == 0.0) {
            return None;
        }
        let symmetries = self.symmetries(&guess.q, &guess.v).ok()?;
        let free = symmetries.coordinates();
        let reached = (0..self.n).all(|i| guess.v[i] == 0.0 || free.contains(&i));
        (!symmetries.turns.is_empty() && reached).then_some(symmetries)
    }

    /// The steady motion along these directions nearest to a guess, whose speeds are kept, or at its place where `here` is set;
    /// and how many iterations led there.
    ///
    /// # Errors
    /// [`LinearError::NoEquilibrium`], [`LinearError::SpeedsContradict`].
    pub fn nearest_turning(
        &self,
        symmetries: &Symmetries,
        guess: &Guess,
        here: bool,
    ) -> Result<(State, usize), LinearError> {
        let all = self.equations(symmetries, &guess.v);
        let mut state = self.along(symmetries, &guess.q, &guess.v)?;
        let mut iterations = 0;
        while !here && iterations < ITERATIONS && !self.is_exact(&state) {
            let left = self.equations_left(&state, all).left;
            let slopes = self.equations_slopes(symmetries, &state, &guess.v);
            if slopes.iter().chain(left.iter()).any(|x| !x.is_finite() || x.abs() > FAR) {
                return Err(self.nowhere(&state, iterations));
            }
            let right = DMatrix::from_column_slice(all, 1, left.as_slice());
            let Some(step) = solve_least(&slopes, &right) else { return Err(self.nowhere(&state, iterations)) };
            let sizes = natural_sizes(&self.units(), &state.q);
            let moved = |part: f64| {
                // What rounding alone moves stays where it is.
                let next = |i: usize| match step[i].abs() <= f64::EPSILON * sizes[i] {
                    true => state.q[i],
                    false => state.q[i] - part * step[i],
                };
                let q: Vec<f64> = (0..self.n).map(next).collect();
                let tried = self.along(symmetries, &q, &guess.v).ok()?;
                (self.equations_left(&tried, all).left.norm() < left.norm()).then_some(tried)
            };
            let mut parts = tried_parts(&self.units(), &state.q, step.as_slice());
            let Some(better) = parts.find_map(moved) else { break };
            state = better;
            iterations += 1;
        }
        Ok((state, iterations))
    }

    /// Refuses a motion whose linear model, seen from axes that turn along, changes as it goes on: it is then no direction in which
    /// nothing changes.
    ///
    /// # Errors
    /// [`LinearError::NotSteady`]; those of [`ConstrainedState::field`].
    pub fn keeps_turning(&self, state: &State, turn: &Turning, now: &DMatrix<f64>) -> Result<(), LinearError> {
        let (n, size) = (self.n, now.amax().max(f64::MIN_POSITIVE));
        for time in LATER {
            let (q, v) = later(&state.q, &state.v, &turn.matrix, time);
            let there = self.turning(&q, &v, Some(turn.clone()));
            let turned = expm(&(&turn.matrix * time));
            let mut along = DMatrix::zeros(2 * n, 2 * n);
            along.view_mut((0, 0), (n, n)).copy_from(&turned);
            along.view_mut((n, n), (n, n)).copy_from(&turned);
            if !self.stays(&there) || (self.field(&there)? * &along - &along * now).amax() > SAME * size {
                let culprit = (0..n).find(|i| turn.matrix.row(*i).iter().any(|x| *x != 0.0)).unwrap_or(0);
                return Err(LinearError::NotSteady { coordinate: self.names().swap_remove(culprit) });
            }
        }
        Ok(())
    }
}
