//! Small departures from steady motions of mechanisms with constraints.
//!
//! Departures (δq, δq') obey δ' = F δ with F = ∂(q', a)/∂(q, q'), the accelerations a from the whole system
//!
//! K [∂a; ∂λ] = −[∂F/∂·; ∂(J a + γ)/∂·],  K = [M −(Jᵀ + B); J 0],
//!
//! derivatives at these a and λ (of a motion that turns as a whole F less diag(A, A), `turns.rs`), so that the geometric stiffness of the constraints is in it.  Those that the constraints
//! allow are spanned by W, a basis of the null space of [J_h 0; ∂c'/∂q J], which F leaves invariant: F_W = Wᵀ F W.  J_h are
//! the rows that hold a place, by themselves or by a known integral.
//! There are no other zeros in it than those of the motion, which F alone has (Neimark and Fufaev,
//! Dynamics of Nonholonomic Systems, 1972, IV).

use nalgebra::{Complex, DMatrix, DVector};

use super::on_its_sides;
use super::relative::{Small, analysed};
use super::state::{ConstrainedState, State, telling};
use crate::linear::matrices::{first_part, is_lost, natural_sizes};
use crate::linear::{Equilibrium, FirstOrder, Guess, LinearError, ZeroStiffness};
use crate::matrix::{solve_least, svd};
use crate::mechanism::{System, rows_in_force};

/// A steady motion with constraints, and what becomes of small departures from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent {
    /// The state; its coordinates are all of the file's.
    pub equilibrium: Equilibrium,
    /// Multipliers of the rows that are active.
    pub multipliers: Vec<f64>,
    /// W: departures [δq; δq'] that the constraints allow, in columns.
    pub departures: DMatrix<f64>,
    /// F_W, 1/s.
    pub matrix: DMatrix<f64>,
    /// Coordinates that turn as a whole: departures, and 1/s of their matrix, are those seen from axes that turn along.
    pub turning: Vec<String>,
    /// Its eigenvalues and eigenvectors.
    pub analysis: FirstOrder,
    /// The size, 1/s, below which eigenvalues are not told from 0, for rounding of what constraints eliminate hides them; `None` where all are, and
    /// about motions.
    pub blurred: Option<f64>,
}

/// Rows of what departures must meet, below this part of the largest, depend on others.
const DEPENDENT: f64 = 1e-9;
/// Speeds below this, SI, or this part of the others, that a search leaves are rounding.
const REST: f64 = 1e-13;
/// Gauss's and Newton's iteration gives up after so many steps.
pub(super) const ITERATIONS: usize = 100;
/// Nothing is further away, or changes faster.
pub(super) const FAR: f64 = 1e30;
/// Times after which a steady motion is looked at again, s.
pub(super) const LATER: [f64; 3] = [0.37, 1.9, 13.0];
/// What changes by less than this part of itself is the same.
pub(super) const SAME: f64 = 1e-8;

/// Finds the steady motion nearest to a guess, the speeds that the guess names kept, or takes the guess itself where `here`
/// is set; linearises there on the states that the constraints leave.
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`]; [`LinearError::NotSteady`] and
/// [`LinearError::DependsOnTime`] where the linear model changes as the motion goes on; numbers that are not finite.
pub fn linearise_tangent<S: System + ?Sized>(system: &S, guess: &Guess, here: bool) -> Result<Tangent, LinearError> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    on_its_sides(system, guess, |system, guess| {
        let held = ConstrainedState::new(system, &rows, &guess.q);
        let (state, iterations) = match held.turning_guess(guess) {
            Some(symmetries) => {
                let turning = held.nearest_turning(&symmetries, guess, here);
                let found = turning.as_ref().is_ok_and(|(state, _)| held.stays(state));
                // What need not turn may go straight on.
                if here || found || !symmetries.shifts.reach(&guess.v) { turning? } else { held.nearest(guess)? }
            }
            None if here => (held.state(&guess.q, &guess.v), 0),
            None => held.nearest(guess)?,
        };
        if !held.stays(&state) {
            return Err(match here {
                true => LinearError::NotAnEquilibrium { residual: held.left(&state) },
                false => held.nowhere(&state, iterations),
            });
        }
        held.is_steady(&state)?;
        let mut found = held.small_departures(&state, iterations)?;
        found.equilibrium.inputs.clone_from(&guess.inputs);
        Ok((found, Guess { q: state.q, v: state.v, inputs: guess.inputs.clone() }))
    })
}

impl Tangent {
    /// The shapes of the analysis in the file's coordinates: [δq; δq'], largest δq (or δq' where no coordinate departs)
    /// 1.
    pub fn shapes(&self) -> Vec<Vec<Complex<f64>>> {
        let n = self.equilibrium.q.len();
        let whole = |shape: &DVector<Complex<f64>>| {
            let rows = 0..self.departures.nrows();
            let mut all: Vec<Complex<f64>> =
                rows.map(|i| (0..shape.len()).map(|k| shape[k] * self.departures[(i, k)]).sum()).collect();
            let largest = |part: &[Complex<f64>]| {
                part.iter().copied().max_by(|a, b| a.norm().total_cmp(&b.norm())).filter(|x| x.norm() > 0.0)
            };
            if let Some(scale) = largest(&all[..n]).or_else(|| largest(&all[n..])) {
                all.iter_mut().for_each(|x| *x /= scale);
            }
            all
        };
        self.analysis.shapes.iter().map(whole).collect()
    }
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// [J_h 0; ∂c'/∂q J]: what departures must meet.
    fn allowed(&self, state: &State) -> DMatrix<f64> {
        let (n, m) = (self.n, self.rows.len());
        let jacobian = self.jacobian(state);
        let closed = self.closed_jacobian(&jacobian);
        let mut all = DMatrix::zeros(closed.nrows() + m, 2 * n);
        all.view_mut((0, 0), (closed.nrows(), n)).copy_from(&closed);
        all.view_mut((closed.nrows(), 0), (m, n)).copy_from(&self.rate_jacobian(state));
        all.view_mut((closed.nrows(), n), (m, n)).copy_from(&jacobian);
        all
    }

    /// What keeps the lengths of rotations' four numbers, and the rates of these, by [δq; δq']: forces are homogeneous in the four, so that a step along
    /// them would balance any.
    fn lengths(&self, state: &State) -> DMatrix<f64> {
        let (n, rotations) = (self.n, self.rotations(state));
        let mut rows = DMatrix::zeros(2 * rotations.len(), 2 * n);
        for (k, (first, axis)) in rotations.iter().enumerate() {
            for (i, x) in axis.iter().enumerate() {
                rows[(2 * k, first + i)] = *x;
                rows[(2 * k + 1, n + first + i)] = *x;
            }
        }
        rows
    }

    /// The rest nearest to the guess; where there is none, or speeds are given, the steady motion, and how many iterations led there.
    ///
    /// At rest a constraint such as `e' = r - x` asks for x = r: with speeds open it would ask for nothing.
    fn nearest(&self, guess: &Guess) -> Result<(State, usize), LinearError> {
        let open = |moves: bool| (0..2 * self.n).filter(move |i| *i < self.n || moves && guess.v[i - self.n] == 0.0);
        if guess.v.iter().all(|v| *v == 0.0) {
            let mut state = self.state(&guess.q, &guess.v);
            if let Ok(iterations) = self.steady(&open(false).collect::<Vec<_>>(), &mut state) {
                state = self.settled(state, &guess.q);
                if self.stays(&state) {
                    return Ok((state, iterations));
                }
            }
        }
        let mut state = self.state(&guess.q, &guess.v);
        let iterations = self.steady(&open(true).collect::<Vec<_>>(), &mut state)?;
        Ok((self.settled(state, &guess.q), iterations))
    }

    /// Gauss's and Newton's iteration by least steps of λ and of the coordinates and speeds that are open (q, then q'); how many there
    /// were.
    fn steady(&self, open: &[usize], state: &mut State) -> Result<usize, LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let mut iterations = 0;
        // A column of nothing but rounding would be brought to the size of the others, and its unknown far away.
        let sizes = |state: &State| {
            let places = natural_sizes(&self.units(), &state.q);
            let rate = places.iter().zip(&state.v).fold(0.0_f64, |most, (size, v)| most.max(v.abs() / size));
            let rate = if rate > 0.0 { rate } else { 1.0 };
            let all: Vec<f64> = places.iter().copied().chain(places.iter().map(|size| rate * size)).collect();
            open.iter().map(|i| all[*i]).collect::<Vec<f64>>().into_iter().enumerate()
        };
        // A step from an exact state would follow rounding, far along directions in which nothing changes.
        while iterations < ITERATIONS && !self.is_exact(state) {
            let left = self.whole(state);
            let slopes = self.slopes(state);
            let allowed = self.allowed(state);
            let extra = allowed.nrows();
            let lengths = self.lengths(state).select_columns(open);
            let mut matrix = DMatrix::zeros(n + extra + m + lengths.nrows(), open.len() + m);
            matrix.view_mut((0, 0), (n, open.len())).copy_from(&slopes.rows(0, n).select_columns(open));
            matrix.view_mut((0, open.len()), (n, m)).copy_from(&(-self.effects(state)));
            matrix.view_mut((n, 0), (extra, open.len())).copy_from(&allowed.select_columns(open));
            matrix.view_mut((n + extra, 0), (m, open.len())).copy_from(&slopes.rows(n, m).select_columns(open));
            matrix.view_mut((n + extra + m, 0), lengths.shape()).copy_from(&lengths);
            if is_lost(&self.units(), &state.q) || matrix.iter().chain(left.iter()).any(|x| !x.is_finite()) {
                return Err(self.nowhere(state, iterations));
            }
            let matrix = telling(matrix, &self.measures(state), sizes(state));
            let right = DMatrix::from_fn(matrix.nrows(), 1, |i, _| left.get(i).copied().unwrap_or(0.0));
            let Some(step) = solve_least(&matrix, &right) else { return Err(self.nowhere(state, iterations)) };
            let mut turns = vec![0.0; n];
            open.iter().zip(step.iter()).filter(|(i, _)| **i < n).for_each(|(i, step)| turns[*i] = *step);
            let first = first_part(&self.units(), &state.q, &turns);
            let mut part = first;
            let better = loop {
                let mut tried = state.clone();
                for (k, i) in open.iter().enumerate() {
                    let number = if *i < n { &mut tried.q[*i] } else { &mut tried.v[i - n] };
                    *number -= part * step[k];
                }
                for (k, row) in self.rows.iter().enumerate() {
                    tried.lambda[*row] -= part * step[open.len() + k];
                }
                if self.whole(&tried).norm() < left.norm() {
                    break Some(tried);
                }
                part *= 0.5;
                if part < 1e-6 * first {
                    break None;
                }
            };
            match better {
                Some(next) => *state = next,
                None => break,
            }
            iterations += 1;
        }
        // What rounding left of multipliers beside larger equations goes.
        *state = self.state(&state.q, &state.v);
        let fast = state.v.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
        state.v.iter_mut().filter(|v| v.abs() <= REST * fast).for_each(|v| *v = 0.0);
        Ok(iterations)
    }

    /// What the equations of [`ConstrainedState::whole`] are judged by.
    fn measures(&self, state: &State) -> Vec<f64> {
        let terms = self.terms(state);
        let forces = terms.forces + terms.by_state;
        let places = self.closed().map(|k| terms.places[k]);
        forces
            .iter()
            .copied()
            .chain(places)
            .chain(terms.rates.iter().copied())
            .chain(terms.biases.iter().copied())
            .collect()
    }

    /// F, c of the rows that hold a place, c' and γ of all: what must vanish.
    fn whole(&self, state: &State) -> DVector<f64> {
        let (force, triples, gamma) = (self.force(state), self.triples(state), self.bias(state));
        let place = self.closed().map(|k| triples[k][0]);
        let rate = triples.iter().map(|triple| triple[1]);
        DVector::from_vec(force.iter().copied().chain(place).chain(rate).chain(gamma).collect())
    }

    /// Refuses a state whose linear model changes as the motion goes on.
    ///
    /// # Errors
    /// [`LinearError::NotSteady`], [`LinearError::DependsOnTime`].
    pub fn is_steady(&self, state: &State) -> Result<(), LinearError> {
        if self.has_no_time() && state.v.iter().all(|v| *v == 0.0) {
            return Ok(());
        }
        let now = self.field(state)?;
        let size = now.amax().max(f64::MIN_POSITIVE);
        let name = |k: usize| self.system.description().coordinates[k].name.to_string();
        if let Some(turn) = &state.turn {
            return self.keeps_turning(state, turn, &now);
        }
        let changes = |later: State| -> Result<bool, LinearError> {
            Ok(!self.stays(&later) || (self.field(&later)? - &now).amax() > SAME * size)
        };
        for time in LATER {
            if !changes(state.later(time, None))? {
                continue;
            }
            for k in (0..self.n).filter(|k| state.v[*k] != 0.0) {
                if changes(state.later(time, Some(k)))? {
                    return Err(LinearError::NotSteady { coordinate: name(k) });
                }
            }
            return Err(LinearError::DependsOnTime { coordinate: name(0) });
        }
        Ok(())
    }

    /// F.
    pub fn field(&self, state: &State) -> Result<DMatrix<f64>, LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let mut k = DMatrix::zeros(n + m, n + m);
        k.view_mut((0, 0), (n, n)).copy_from(&self.mass(state));
        k.view_mut((0, n), (n, m)).copy_from(&(-self.effects(state)));
        k.view_mut((n, 0), (m, n)).copy_from(&self.jacobian(state));
        let slopes = self.slopes(state);
        if k.iter().chain(slopes.iter()).any(|x| x.is_nan() || x.abs() > FAR) {
            return Err(LinearError::NonFinite { what: "the linear model".to_owned() });
        }
        let changes =
            solve_least(&k, &slopes).ok_or(LinearError::NoConvergence { what: "the accelerations' derivatives" })?;
        let mut field = DMatrix::zeros(2 * n, 2 * n);
        field.view_mut((0, n), (n, n)).fill_with_identity();
        field.view_mut((n, 0), (n, 2 * n)).copy_from(&(-changes.rows(0, n)));
        Ok(field)
    }

    /// F_W in units of √M, and W.
    ///
    /// # Errors
    /// [`LinearError::NonFinite`], [`LinearError::NoConvergence`].
    pub fn on_the_tangent_space(&self, state: &State) -> Result<Small, LinearError> {
        let n = self.n;
        self.unlocked(state)?;
        let mut field = self.field(state)?;
        if let Some(turn) = &state.turn {
            // As it is seen from axes that turn along.
            for k in [0, n] {
                let mut block = field.view_mut((k, k), (n, n));
                block -= &turn.matrix;
            }
        }
        // In units of √M a departure's size says what energy it has.
        let mass = self.mass(state);
        let unit = |i: usize| if mass[(i, i)] > 0.0 { 1.0 / mass[(i, i)].sqrt() } else { 1.0 };
        let units = DVector::from_fn(2 * n, |i, _| unit(i % n));
        let scaled = DMatrix::from_fn(2 * n, 2 * n, |i, j| field[(i, j)] * units[j] / units[i]);
        let (allowed, lengths) = (self.allowed(state), self.lengths(state));
        let mut allowed = DMatrix::from_fn(allowed.nrows() + lengths.nrows(), 2 * n, |i, j| {
            if i < allowed.nrows() { allowed[(i, j)] } else { lengths[(i - allowed.nrows(), j)] }
        });
        allowed.column_iter_mut().enumerate().for_each(|(j, mut column)| column.scale_mut(units[j]));
        let basis = null_space(allowed).ok_or(LinearError::NoConvergence { what: "the states that are left" })?;
        let (basis, shifted) = match &state.turn {
            Some(turn) => turn.shifts_first(basis, &units)?,
            None => (basis, 0),
        };
        let matrix = basis.transpose() * scaled * &basis;
        let departures = DMatrix::from_fn(2 * n, basis.ncols(), |i, k| basis[(i, k)] * units[i]);
        Ok(Small { matrix, departures, shifted })
    }

    fn small_departures(&self, state: &State, iterations: usize) -> Result<Tangent, LinearError> {
        let n = self.n;
        let Small { matrix, departures, shifted } = self.on_the_tangent_space(state)?;
        let (told, blurred) = self.slow_and_fast(state, &departures)?;
        let analysis = told.map_or_else(|| analysed(&matrix, shifted), Ok)?;
        let equilibrium = Equilibrium {
            coordinates: self.names(),
            units: self.units(),
            q: state.q.clone(),
            v: state.v.clone(),
            inputs: Vec::new(),
            friction: Vec::new(),
            residual: self.force(state).iter().copied().collect(),
            iterations,
            slow: None,
            freedom: ZeroStiffness::default(),
        };
        let multipliers = self.multipliers(state);
        let turns = |i: &usize| state.turn.as_ref().is_some_and(|turn| turn.matrix.row(*i).iter().any(|x| *x != 0.0));
        let names = &equilibrium.coordinates;
        let turning = (0..n).filter(turns).map(|i| names[i].clone()).collect();
        Ok(Tangent { equilibrium, multipliers, departures, matrix, turning, analysis, blurred })
    }
}

/// An orthonormal basis of what a matrix with scaled columns leaves, its rows judged each by itself.
pub(super) fn null_space(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let columns = matrix.ncols();
    for mut row in matrix.row_iter_mut() {
        let norm = row.norm();
        if norm > 0.0 {
            row.scale_mut(1.0 / norm);
        }
    }
    // With as many rows as columns all of V is computed.
    let rows = matrix.nrows().max(columns);
    let matrix = matrix.resize(rows, columns, 0.0);
    let svd = svd(matrix, false, true)?;
    let largest = svd.singular_values.amax();
    let left: Vec<usize> = (0..columns).filter(|k| svd.singular_values[*k] <= DEPENDENT * largest).collect();
    Some(svd.v_t?.select_rows(&left).transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rows_leave_is_orthonormal_and_meets_them() {
        let rows = DMatrix::from_row_slice(2, 4, &[1.0, 2.0, 0.0, -1.0, 2.0, 4.0, 0.0, -2.0]);
        let basis = null_space(rows.clone()).expect("a basis");
        assert_eq!(basis.shape(), (4, 3));
        assert!((rows * &basis).norm() < 1e-14);
        assert!((basis.transpose() * &basis - DMatrix::identity(3, 3)).norm() < 1e-14);
        assert!(null_space(DMatrix::from_element(3, 4, f64::NAN)).is_none());
    }
}
