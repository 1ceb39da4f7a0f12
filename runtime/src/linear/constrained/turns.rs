//! Turns of the plane along which nothing changes: directions in which lengths turn and angles are shifted with them.
//!
//! A field ξ(q) = A (q − q₀) + b turns pairs of lengths, each by the block [0 −1; 1 0] of A, and shifts angles by b.  It changes
//! nothing where equations and constraints at any state (q, v, a, λ) that meets these go over into themselves along it, but for
//! forces that the constraints carry:
//!
//! Zᵀ (∂F/∂q ξ + ∂F/∂q' A v + M A a + Aᵀ F) = 0 with Zᵀ (Jᵀ + B) = 0, and ∂c'/∂q ξ + J A v = 0 where J v + ∂c/∂t = 0.
//!
//! All this is linear in A and b, so that the turns are a null space at drawn states, as shifts are (`steady.rs`).  A motion with
//! v = ξ(q) and a = A v is steady as it is seen from axes that turn with it (a relative equilibrium: Marsden and Ratiu,
//! Introduction to Mechanics and Symmetry, 1999).

use nalgebra::{DMatrix, DVector};

use super::state::{ConstrainedState, State, Turning};
use super::steady::{DEFINED, Draw, NULL, STATES, Shifts, reduced_by};
use crate::constrain::{Start, consistent};
use crate::linear::LinearError;
use crate::linear::matrices::{expm, natural_sizes};
use crate::matrix::{solve_least, svd};
use crate::mechanism::System;

/// With more lengths turns are not searched for: a pair of each two of them is asked.
const MOST_LENGTHS: usize = 12;
/// A multiple this near to a whole number is that number: wheels and headings turn by whole multiples of one angle.
const WHOLE: f64 = 1e-9;

/// A turn.
#[derive(Clone)]
pub(super) struct Turn {
    /// A.
    matrix: DMatrix<f64>,
    /// b.
    shift: DVector<f64>,
    /// q₀.
    about: DVector<f64>,
}

/// The directions in which nothing changes: shifts and turns.
#[derive(Clone)]
pub(super) struct Symmetries {
    pub shifts: Shifts,
    pub turns: Vec<Turn>,
}

impl Symmetries {
    /// No turns.
    pub fn of_shifts(shifts: Shifts) -> Self {
        Symmetries { shifts, turns: Vec::new() }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.shifts.0.ncols() + self.turns.len()
    }

    /// Shifts, and turns at a place, in columns.
    pub fn at(&self, q: &[f64]) -> DMatrix<f64> {
        let (first, q) = (self.shifts.0.ncols(), DVector::from_column_slice(q));
        let mut all = self.shifts.0.clone().resize_horizontally(self.len(), 0.0);
        for (k, turn) in self.turns.iter().enumerate() {
            all.set_column(first + k, &(&turn.matrix * (&q - &turn.about) + &turn.shift));
        }
        all
    }

    /// The coordinates that some of them move.
    pub fn coordinates(&self) -> Vec<usize> {
        let turned = |i: usize| self.turns.iter().any(|turn| turn.moves(i));
        let shifted = self.shifts.coordinates();
        (0..self.shifts.0.nrows()).filter(|i| shifted.contains(i) || turned(*i)).collect()
    }

    /// Σ w_k A_k; `None` where there are no turns.
    pub fn turning(&self, weights: &[f64]) -> Option<Turning> {
        let n = self.shifts.0.nrows();
        let of_turns = self.turns.iter().zip(&weights[self.shifts.0.ncols()..]);
        let matrix = of_turns.fold(DMatrix::zeros(n, n), |sum, (turn, w)| sum + &turn.matrix * *w);
        let turned = |shift: &usize| (&matrix * self.shifts.0.column(*shift)).amax() > 0.0;
        let shifts: Vec<usize> = (0..self.shifts.0.ncols()).filter(turned).collect();
        let shifts = self.shifts.0.select_columns(&shifts);
        (!self.turns.is_empty()).then_some(Turning { matrix, shifts })
    }

    /// A_k v in columns, 0 of shifts.
    pub fn turned(&self, v: &[f64]) -> DMatrix<f64> {
        let (first, v) = (self.shifts.0.ncols(), DVector::from_column_slice(v));
        let mut all = DMatrix::zeros(v.len(), self.len());
        for (k, turn) in self.turns.iter().enumerate() {
            all.set_column(first + k, &(&turn.matrix * &v));
        }
        all
    }
}

impl Turn {
    fn moves(&self, i: usize) -> bool {
        self.shift[i] != 0.0 || self.matrix.row(i).iter().any(|x| *x != 0.0)
    }
}

/// What may be part of a turn: a pair of lengths, or a shift of a coordinate.
#[derive(Clone, Copy)]
enum Candidate {
    Pair(usize, usize),
    Shift(usize),
}

impl Candidate {
    /// ξ at a departure from the centre, in sizes.
    fn field(self, far: &DVector<f64>, sizes: &[f64]) -> DVector<f64> {
        let mut field = DVector::zeros(far.len());
        match self {
            Candidate::Pair(i, j) => (field[i], field[j]) = (-far[j], far[i]),
            Candidate::Shift(i) => field[i] = sizes[i],
        }
        field
    }

    /// A x.
    fn turned(self, x: &DVector<f64>) -> DVector<f64> {
        match self {
            Candidate::Pair(..) => self.field(x, &[]),
            Candidate::Shift(_) => DVector::zeros(x.len()),
        }
    }
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// Shifts near a place, and turns where no shift has the speeds that are kept (not 0) and meets the constraints there, as the place of a
    /// bicycle that leans and steers allows no other motion than along a circle.
    ///
    /// # Errors
    /// As [`ConstrainedState::shifts`].
    pub fn symmetries(&self, q: &[f64], kept: &[f64]) -> Result<Symmetries, LinearError> {
        let shifts = self.shifts(q)?;
        let turns = match self.speeds(&shifts, q, kept) {
            Ok(_) => Vec::new(),
            Err(_) => self.turns(q, &shifts)?,
        };
        Ok(Symmetries { shifts, turns })
    }

    /// The turns about a place, of lengths with at least one angle, beside shifts.
    ///
    /// # Errors
    /// Those of a singular value decomposition.
    pub fn turns(&self, q: &[f64], shifts: &Shifts) -> Result<Vec<Turn>, LinearError> {
        let (units, sizes) = (self.units(), natural_sizes(&self.units(), q));
        let lengths: Vec<usize> = (0..self.n).filter(|i| units[*i] == "m").collect();
        let angles: Vec<usize> = (0..self.n).filter(|i| units[*i] == "rad").collect();
        let alone = shifts.alone();
        let open: Vec<usize> = angles.iter().chain(&lengths).copied().filter(|i| !alone.contains(i)).collect();
        if lengths.len() < 2 || lengths.len() > MOST_LENGTHS || !open.iter().any(|i| angles.contains(i)) {
            return Ok(Vec::new());
        }
        let pairs =
            lengths.iter().enumerate().flat_map(|(k, i)| lengths[k + 1..].iter().map(|j| Candidate::Pair(*i, *j)));
        let pairs: Vec<Candidate> = pairs.collect();
        let count = pairs.len();
        let candidates: Vec<Candidate> = pairs.into_iter().chain(open.into_iter().map(Candidate::Shift)).collect();
        let states = (0..2 * STATES).filter_map(|k| self.changes(q, &sizes, &candidates, k)).take(STATES);
        let states: Vec<DMatrix<f64>> = states.collect();
        if states.len() < DEFINED {
            return Ok(Vec::new());
        }
        let mut all = DMatrix::zeros(states.iter().map(DMatrix::nrows).sum(), candidates.len());
        let mut filled = 0;
        for rows in &states {
            all.rows_mut(filled, rows.nrows()).copy_from(rows);
            filled += rows.nrows();
        }
        let failed = LinearError::NoConvergence { what: "the search for turns that change nothing" };
        let rows = all.nrows().max(all.ncols());
        let svd = svd(all.resize_vertically(rows, 0.0).qr().r(), false, true).ok_or(failed.clone())?;
        let largest = svd.singular_values.max();
        let null: Vec<usize> = (0..candidates.len()).filter(|k| svd.singular_values[*k] <= NULL * largest).collect();
        let (rows, pivots) = reduced_by(svd.v_t.ok_or(failed)?.select_rows(&null), count);
        let about = DVector::from_column_slice(q);
        let turn = |row: usize| Turn::of(&candidates, rows.row(row).iter().copied(), &sizes, about.clone());
        let turns_an_angle = |turn: &Turn| angles.iter().any(|i| turn.shift[*i] != 0.0);
        Ok(pivots.into_iter().map(turn).filter(turns_an_angle).collect())
    }

    /// What each candidate changes at a drawn state that meets the constraints, as parts of the terms that it is the sum of; `None`
    /// where something is not defined.
    fn changes(&self, q: &[f64], sizes: &[f64], candidates: &[Candidate], k: usize) -> Option<DMatrix<f64>> {
        let state = self.drawn_on_constraints(q, sizes, k)?;
        let (n, m) = (self.n, self.rows.len());
        let far = DVector::from_fn(n, |i, _| state.q[i] - q[i]);
        let (v, a) = (DVector::from_column_slice(&state.v), DVector::from_column_slice(&state.a));
        let (slopes, mass) = (self.slopes(&state), self.mass(&state));
        let (by_place, by_speed) = (slopes.view((0, 0), (n, n)), slopes.view((0, n), (n, n)));
        let (jacobian, rate_jacobian, force) = (self.jacobian(&state), self.rate_jacobian(&state), self.force(&state));
        let sized = DVector::from_column_slice(sizes);
        let mut effects = self.effects(&state);
        effects.column_iter_mut().for_each(|mut column| column.component_mul_assign(&sized));
        let mut all = DMatrix::zeros(n + m, candidates.len());
        let mut terms = DVector::<f64>::zeros(n + m);
        for (column, candidate) in candidates.iter().enumerate() {
            let (xi, speed, rate) = (candidate.field(&far, sizes), candidate.turned(&v), candidate.turned(&a));
            // Aᵀ = −A.
            let parts = [by_place * &xi, by_speed * &speed, &mass * rate, -candidate.turned(&force)];
            let rows = [&rate_jacobian * &xi, &jacobian * &speed];
            for i in 0..n {
                all[(i, column)] = sizes[i] * parts.iter().map(|part| part[i]).sum::<f64>();
                let largest = parts.iter().fold(0.0_f64, |most, part| most.max((sizes[i] * part[i]).abs()));
                terms[i] = terms[i].max(largest);
            }
            for j in 0..m {
                all[(n + j, column)] = rows[0][j] + rows[1][j];
                terms[n + j] = terms[n + j].max(rows[0][j].abs()).max(rows[1][j].abs());
            }
        }
        let largest = terms.rows(0, n).amax();
        let carried = solve_least(&effects, &all.rows(0, n).into_owned())?;
        let left = all.rows(0, n) - effects * carried;
        all.rows_mut(0, n).copy_from(&left);
        for i in 0..n + m {
            let size = if i < n { largest } else { terms[i] };
            all.row_mut(i).scale_mut(if size > 0.0 { 1.0 / size } else { 0.0 });
        }
        all.iter().all(|x| x.is_finite()).then_some(all)
    }

    /// A state near a place at which all terms matter, with speeds and accelerations that the constraints allow.
    fn drawn_on_constraints(&self, q: &[f64], sizes: &[f64], k: usize) -> Option<State> {
        let n = self.n;
        let Draw { place, v, a, lambda } = self.draw(q, sizes, k)?;
        let still = vec![0.0; n];
        let start = [place.as_slice(), &still].concat();
        let held = vec![false; 2 * n];
        let closed = consistent(
            self.system,
            &Start { t: 0.0, reached: 0.0, y: &start, held: &held, spins: &[], start_conditions: 0..0 },
        )
        .ok()?;
        let mut state = State { t: 0.0, q: closed[..n].to_vec(), v, a: still, lambda, turn: None };
        let jacobian = self.jacobian(&state);
        let without = |x: &mut Vec<f64>, missed: Vec<f64>| -> Option<()> {
            let back = solve_least(&jacobian, &DMatrix::from_column_slice(missed.len(), 1, &missed))?;
            x.iter_mut().zip(back.iter()).for_each(|(x, back)| *x -= back);
            Some(())
        };
        let rates = self.triples(&state).iter().map(|triple| triple[1]).collect();
        without(&mut state.v, rates)?;
        state.a = a;
        let biases = self.bias(&state);
        without(&mut state.a, biases)?;
        Some(state)
    }
}

impl Turn {
    /// From multiples of candidates, shifts in sizes.
    fn of(candidates: &[Candidate], multiples: impl Iterator<Item = f64>, sizes: &[f64], about: DVector<f64>) -> Turn {
        let n = about.len();
        let mut turn = Turn { matrix: DMatrix::zeros(n, n), shift: DVector::zeros(n), about };
        for (candidate, multiple) in candidates.iter().zip(multiples) {
            match *candidate {
                Candidate::Pair(i, j) => {
                    let multiple = whole(multiple);
                    (turn.matrix[(i, j)], turn.matrix[(j, i)]) = (-multiple, multiple);
                }
                Candidate::Shift(i) => turn.shift[i] = whole(multiple * sizes[i]),
            }
        }
        turn
    }
}

/// A multiple, a whole number where it is one but for rounding.
fn whole(multiple: f64) -> f64 {
    if (multiple - multiple.round()).abs() <= WHOLE { multiple.round() } else { multiple }
}

/// A state that turns, later: q and v.
pub(super) fn later(q: &[f64], v: &[f64], turn: &DMatrix<f64>, time: f64) -> (Vec<f64>, Vec<f64>) {
    let n = q.len();
    // d/dt (q, v) = (v, A v).
    let mut flow = DMatrix::zeros(2 * n, 2 * n);
    flow.view_mut((0, n), (n, n)).fill_with_identity();
    flow.view_mut((n, n), (n, n)).copy_from(turn);
    let moved = expm(&(flow * time)) * DVector::from_iterator(2 * n, q.iter().chain(v).copied());
    (moved.rows(0, n).iter().copied().collect(), moved.rows(n, n).iter().copied().collect())
}
