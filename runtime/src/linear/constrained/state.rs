//! A mechanism that constraints hold, its matrices at a state, and whether it stays there.

use nalgebra::{DMatrix, DVector};

use crate::linear::equilibrium::force_unit;
use crate::linear::matrices::natural_sizes;
use crate::linear::{Guess, LinearError, Residual};
#[cfg(feature = "modal")]
use crate::matrix::solve_least;
use crate::matrix::{solve_least_as_measured, solve_least_of_rank};
use crate::mechanism::dense::{
    constraint_matrix, constraint_rate_jacobian, constraint_slopes, constraint_triples, force_slopes, mass_matrix,
    multiplier_effects, sizes_alike,
};
use crate::mechanism::{At, System};
use crate::trust::lock_here;

/// What is left in a state that holds is below this part of its terms.
const BALANCED: f64 = 1e-9;
/// What a search for a rest at 0 comes to, each step a rounding of the one before, has no terms left to be measured by.
const NOTHING: f64 = 1e-120;
/// So many roundings of the state are nothing.
const ROUNDINGS: f64 = 16.0;
/// Coordinates that have shrunk to this part of what they were are tried at 0.
const GONE: f64 = 1e-9;
/// Steps of differences of terms, as parts of a coordinate's size.
const BESIDE: f64 = 1e-7;
/// Times at which a state of rest is looked at again, s.
const TIMES: [f64; 4] = [0.37, 1.9, 53.0, 1234.5];
/// What changes by less than this part of itself is the same.
const SAME: f64 = 1e-12;

/// Slopes below this part of the terms of their equation are rounding.
pub(super) const CANCELLED: f64 = 64.0 * f64::EPSILON;

/// A mechanism and its rows of constraints in force.
pub(super) struct ConstrainedState<'a, S: System + ?Sized> {
    pub system: &'a S,
    pub n: usize,
    pub rows: Vec<usize>,
    /// The values at which integrals of constraints that contain speeds are held; 0 of all other rows.
    pub levels: Vec<f64>,
}

/// What equations of a state are judged by: sums of their terms, and what the sizes of the state's numbers make of slopes.
pub(super) struct Terms {
    /// Σ |terms| of forces.
    pub forces: DVector<f64>,
    /// Of places, speeds and multipliers, through the slopes of forces, and what multipliers pass on of these and of forces.
    pub by_state: DVector<f64>,
    /// Of c.
    pub places: DVector<f64>,
    /// Of c'.
    pub rates: DVector<f64>,
    /// Of γ.
    pub biases: DVector<f64>,
}

/// A state that goes on steadily, and the multipliers (of all rows) that let it.
#[derive(Clone)]
pub(super) struct State {
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// Its accelerations.
    pub a: Vec<f64>,
    pub lambda: Vec<f64>,
    /// How it turns as a whole; `None` where nothing accelerates.
    #[cfg(feature = "modal")]
    pub turn: Option<Turning>,
}

/// How a motion turns as a whole.
#[derive(Clone)]
pub(super) struct Turning {
    /// A: a = A v.
    pub matrix: DMatrix<f64>,
    /// Shifts that change nothing and turn along, in columns.
    #[cfg(feature = "modal")]
    pub shifts: DMatrix<f64>,
}

impl State {
    /// The state later on, of one coordinate or of all.
    pub fn later(&self, time: f64, only: Option<usize>) -> Self {
        let moves = |i: usize| only.is_none_or(|k| k == i);
        let q = (0..self.q.len()).map(|i| if moves(i) { self.q[i] + time * self.v[i] } else { self.q[i] });
        let t = if only.is_none() { self.t + time } else { self.t };
        State { t, q: q.collect(), ..self.clone() }
    }

    pub fn at(&self) -> At<'_> {
        At::new(self.t, &self.q, &self.v).accelerated(&self.a).constrained(&self.lambda)
    }
}

impl<'a, S: System + ?Sized> ConstrainedState<'a, S> {
    /// A mechanism, its rows in force, and their known integrals as they are at a place.
    pub fn new(system: &'a S, rows: &[usize], q: &[f64]) -> Self {
        let mut held = ConstrainedState { system, n: system.len(), rows: rows.to_vec(), levels: vec![0.0; rows.len()] };
        held.hold(q);
        held
    }

    /// As [`ConstrainedState::new`], known integrals held at these values.
    pub fn at_levels(system: &'a S, rows: &[usize], levels: &[f64]) -> Self {
        ConstrainedState { system, n: system.len(), rows: rows.to_vec(), levels: levels.to_vec() }
    }

    /// From here on known integrals have the values that they have at this place.
    pub fn hold(&mut self, q: &[f64]) {
        let all = constraint_triples(self.system, At::new(0.0, q, &vec![0.0; self.n]));
        let rows = &self.system.description().rows;
        let levels = self.rows.iter().map(|row| if rows[*row].integral { all[*row][0] } else { 0.0 });
        self.levels = levels.collect();
    }

    /// A state without accelerations, with the multipliers that leave the least of its forces.
    pub fn state(&self, q: &[f64], v: &[f64]) -> State {
        self.turning(q, v, None)
    }

    /// A state without accelerations and multipliers.
    pub fn without_multipliers(&self, q: &[f64], v: &[f64]) -> State {
        State {
            t: 0.0,
            q: q.to_vec(),
            v: v.to_vec(),
            a: vec![0.0; self.n],
            lambda: vec![0.0; self.system.description().rows.len()],
            #[cfg(feature = "modal")]
            turn: None,
        }
    }

    /// A state that turns as a whole, a = A v, and the multipliers that leave the least of its forces.
    pub fn turning(&self, q: &[f64], v: &[f64], turn: Option<Turning>) -> State {
        let mut state = self.without_multipliers(q, v);
        if let Some(turn) = &turn {
            state.a.copy_from_slice((&turn.matrix * DVector::from_column_slice(v)).as_slice());
        }
        #[cfg(feature = "modal")]
        {
            state.turn = turn;
        }
        let (effects, rank) = (self.telling_effects(&state), self.rank());
        // What rounding leaves of the first is as small as its terms only after a second time.
        for _ in 0..2 {
            let force = DMatrix::from_column_slice(self.n, 1, self.force(&state).as_slice());
            let Some(lambda) = self.balancing(&effects, q, &force, rank) else { break };
            self.rows.iter().zip(lambda.iter()).for_each(|(row, x)| state.lambda[*row] += x);
        }
        state
    }

    /// How many rows are independent in general.  Beside places that meet the constraints more may be, as little as these are missed by: multipliers of
    /// the difference would be as large as one likes.  Rows that contain speeds are not missed by a place.
    pub fn rank(&self) -> usize {
        let phase = self.system.description().phases.get(self.system.phase());
        let own = |rows: &[u32]| rows.iter().map(|row| *row as usize).eq(self.rows.iter().copied());
        let all_closed = self.closed().count() == self.rows.len();
        phase.filter(|phase| all_closed && own(&phase.rows)).map_or(self.rows.len(), |phase| phase.rank as usize)
    }

    /// The same state with the multipliers that a run has there: where rows depend on each other they share forces by one rule.
    pub fn shared(&self, state: &State) -> State {
        let mut shared = state.clone();
        let dependent = self.rank() < self.rows.len();
        let mut a = vec![0.0; self.n];
        let at = At::new(state.t, &state.q, &state.v);
        if dependent
            && self.system.accelerations_and_multipliers(at, &mut a, &mut shared.lambda).is_ok()
            && self.stays(&shared)
        {
            return shared;
        }
        state.clone()
    }

    /// Refuses a state in which three angles lock.
    ///
    /// # Errors
    /// [`LinearError::GimbalLock`].
    pub fn unlocked(&self, state: &State) -> Result<(), LinearError> {
        lock_here(self.system, state.at()).map_or(Ok(()), |lock| Err(LinearError::GimbalLock(lock)))
    }

    /// F, multipliers' forces included.
    pub fn force(&self, state: &State) -> DVector<f64> {
        let mut force = DVector::zeros(self.n);
        self.system.residual(state.at(), force.as_mut_slice());
        force
    }

    /// M.
    pub fn mass(&self, state: &State) -> DMatrix<f64> {
        mass_matrix(self.system, state.at())
    }

    /// J.
    pub fn jacobian(&self, state: &State) -> DMatrix<f64> {
        constraint_matrix(self.system, state.at(), &self.rows)
    }

    /// J, and for each rotation a row that leaves its length as it is, q·δq = 0: what motions that matter must meet.
    pub fn holding(&self, state: &State) -> DMatrix<f64> {
        let jacobian = self.jacobian(state);
        let rotations = &self.system.description().rotations;
        let rows = jacobian.nrows();
        let mut all = jacobian.resize_vertically(rows + rotations.len(), 0.0);
        for (k, first) in rotations.iter().enumerate() {
            let places = *first as usize..*first as usize + 4;
            places.for_each(|i| all[(rows + k, i)] = state.q[i]);
        }
        all
    }

    /// Jᵀ + B: what multipliers do.
    pub fn effects(&self, state: &State) -> DMatrix<f64> {
        multiplier_effects(self.system, state.at(), &self.rows)
    }

    /// ∂c'/∂q.
    pub fn rate_jacobian(&self, state: &State) -> DMatrix<f64> {
        constraint_rate_jacobian(self.system, state.at(), &self.rows)
    }

    /// [∂F/∂q ∂F/∂q'; ∂(J a + γ)/∂q ∂(J a + γ)/∂q'].
    pub fn slopes(&self, state: &State) -> DMatrix<f64> {
        let (n, m) = (self.n, self.rows.len());
        let mut slopes = DMatrix::zeros(n + m, 2 * n);
        for (k, block) in force_slopes(self.system, state.at()).iter().enumerate() {
            slopes.view_mut((0, k * n), (n, n)).copy_from(block);
        }
        for (k, block) in constraint_slopes(self.system, state.at(), &self.rows).iter().enumerate() {
            slopes.view_mut((n, k * n), (m, n)).copy_from(block);
        }
        slopes
    }

    /// How fast the terms of F grow with q and with q': what rounding of ∂F/∂q and ∂F/∂q' is judged by.
    pub fn slopes_of_terms(&self, state: &State) -> [DMatrix<f64>; 2] {
        let magnitudes = |state: &State| {
            let mut sums = DVector::zeros(self.n);
            self.system.magnitudes(state.at(), sums.as_mut_slice());
            sums
        };
        let here = magnitudes(state);
        [false, true].map(|of_speed| {
            let sizes = natural_sizes(&self.units(), if of_speed { &state.v } else { &state.q });
            let mut slopes = DMatrix::zeros(self.n, self.n);
            for (j, size) in sizes.iter().enumerate() {
                let mut beside = state.clone();
                let step = BESIDE * size;
                (if of_speed { &mut beside.v } else { &mut beside.q })[j] += step;
                slopes.set_column(j, &((magnitudes(&beside) - &here).abs() / step));
            }
            slopes
        })
    }

    /// What multipliers add to the terms of ∂F/∂q, each as large as the terms are of the forces that it balances: by so much, times rounding, it
    /// may be off.
    #[cfg(feature = "modal")]
    pub fn terms_of_multipliers(&self, state: &State) -> DMatrix<f64> {
        let n = self.n;
        let mut sums = DVector::zeros(n);
        self.system.magnitudes(state.at(), sums.as_mut_slice());
        let effects = self.jacobian(state).transpose();
        let mut terms = DMatrix::zeros(n, n);
        let Some(inverse) = solve_least(&effects, &DMatrix::identity(n, n)) else { return terms };
        let [here, _] = force_slopes(self.system, state.at());
        for (row, size) in self.rows.iter().zip((inverse.abs() * sums).iter()) {
            let mut other = state.clone();
            other.lambda[*row] += size;
            let [there, _] = force_slopes(self.system, other.at());
            terms += (there - &here).abs();
        }
        terms
    }

    /// (c, c', Σ |terms| of c) of each row, c of one that contains speeds being the change of its integral.
    pub fn triples(&self, state: &State) -> Vec<[f64; 3]> {
        let all = constraint_triples(self.system, state.at());
        let of = |(row, level): (&usize, &f64)| [all[*row][0] - level, all[*row][1], all[*row][2]];
        self.rows.iter().zip(&self.levels).map(of).collect()
    }

    /// ∂c/∂q of the rows that hold a place.
    #[cfg(feature = "modal")]
    pub fn closed_jacobian(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let closed: Vec<usize> = self.closed().collect();
        let mut lines = jacobian.select_rows(&closed);
        for (mut line, k) in lines.row_iter_mut().zip(closed) {
            for (row, factor) in self.system.description().rows[self.rows[k]].with.iter() {
                let other = self.rows.iter().position(|active| *active == *row as usize);
                other.into_iter().for_each(|other| line += *factor * jacobian.row(other));
            }
        }
        lines
    }

    /// J a + γ of each row.
    pub fn bias(&self, state: &State) -> Vec<f64> {
        let mut gamma = vec![0.0; self.system.description().rows.len()];
        self.system.constraint_bias(state.at(), &mut gamma);
        let gamma = self.rows.iter().map(|row| gamma[*row]);
        if state.a.iter().all(|a| *a == 0.0) {
            return gamma.collect();
        }
        let accelerated = self.jacobian(state) * DVector::from_column_slice(&state.a);
        gamma.zip(accelerated.iter()).map(|(gamma, accelerated)| gamma + accelerated).collect()
    }

    /// Places, among the rows in force, of those that hold a place: holonomic ones, and those with known integrals.
    pub fn closed(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = &self.system.description().rows;
        (0..self.rows.len()).filter(move |k| rows[self.rows[*k]].holonomic || rows[self.rows[*k]].integral)
    }

    /// Whether nothing accelerates in this state and no constraint is missed, but for rounding of its terms, its place and
    /// its multipliers: the terms of a weight's moment vanish with it.
    pub fn stays(&self, state: &State) -> bool {
        self.unbalanced(state, BALANCED).is_none()
    }

    /// Whether what is left of its equations is rounding of their terms, so that no step of a search can better it.
    pub fn is_exact(&self, state: &State) -> bool {
        self.unbalanced(state, ROUNDINGS * f64::EPSILON).is_none()
    }

    /// What the equations of a state are judged by.
    pub fn terms(&self, state: &State) -> Terms {
        let (n, m) = (self.n, self.rows.len());
        let mut forces = DVector::zeros(n);
        self.system.magnitudes(state.at(), forces.as_mut_slice());
        let description = self.system.description();
        let sizes =
            DVector::from_vec([sizes_alike(description, &state.q), sizes_alike(description, &state.v)].concat());
        let by_state = self.slopes(state).abs() * &sizes;
        let carried = state.lambda.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let effects = self.effects(state);
        // Of rows that depend on each other multipliers, and with them terms, may be as large as one likes.
        let own = if self.rank() < self.rows.len() { DVector::zeros(n) } else { forces.clone() };
        let passed_on = self.passed_on(state) * (by_state.rows(0, n) + own);
        let jacobian = self.jacobian(state).abs();
        let triples = self.triples(state);
        let by_place = &jacobian * sizes.rows(0, n);
        Terms {
            forces,
            by_state: DVector::from_fn(n, |i, _| by_state[i] + passed_on[i] + carried * effects.row(i).lp_norm(1)),
            places: DVector::from_fn(m, |k, _| triples[k][2].max(by_place[k])),
            rates: self.rate_jacobian(state).abs() * sizes.rows(0, n) + jacobian * sizes.rows(n, n),
            biases: by_state.rows(n, m).into_owned(),
        }
    }

    /// What multipliers do, without what is rounding beside all that the same one does, coordinates measured by their sizes: an equation of nothing
    /// but rounding would count like any other where they are solved for.
    fn telling_effects(&self, state: &State) -> DMatrix<f64> {
        let mut effects = self.without_lengths(self.effects(state), state);
        let sizes = DVector::from_vec(natural_sizes(&self.units(), &state.q));
        for mut column in effects.column_iter_mut() {
            let most = column.component_mul(&sizes).amax();
            for (x, size) in column.iter_mut().zip(&sizes) {
                if x.abs() * size <= ROUNDINGS * f64::EPSILON * most {
                    *x = 0.0;
                }
            }
        }
        effects
    }

    /// Rows, one a coordinate, without what they say along the four numbers of a rotation together: nothing but rounding, since their length does not
    /// matter.
    pub fn without_lengths(&self, mut rows: DMatrix<f64>, state: &State) -> DMatrix<f64> {
        for (first, axis) in self.rotations(state) {
            let mut turns = rows.rows_mut(first, 4);
            let along = axis.transpose() * &turns;
            turns -= axis * along;
        }
        rows
    }

    /// The first place of each rotation, and its four numbers with length 1.
    pub fn rotations(&self, state: &State) -> Vec<(usize, DVector<f64>)> {
        let firsts = self.system.description().rotations.iter().map(|first| *first as usize);
        let axis = |first: usize| DVector::from_column_slice(&state.q[first..first + 4]).try_normalize(0.0);
        firsts.filter_map(|first| Some((first, axis(first)?))).collect()
    }

    /// Multipliers of the rows in force, 0 where no more is left than rounding of forces makes.
    pub fn multipliers(&self, state: &State) -> Vec<f64> {
        let effects = self.telling_effects(state);
        let inverse = self.balancing(&effects, &state.q, &DMatrix::identity(self.n, self.n), usize::MAX);
        let rounding = inverse.map(|inverse| inverse.abs() * self.terms(state).by_state * ROUNDINGS * f64::EPSILON);
        let of = |(k, row): (usize, &usize)| {
            let lambda = state.lambda[*row];
            if rounding.as_ref().is_some_and(|rounding| lambda.abs() <= rounding[k]) { 0.0 } else { lambda }
        };
        self.rows.iter().enumerate().map(of).collect()
    }

    /// |E E⁺|: what multipliers, which balance as much as they can, make of the rounding of one force in others.
    fn passed_on(&self, state: &State) -> DMatrix<f64> {
        let effects = self.telling_effects(state);
        let inverse = self.balancing(&effects, &state.q, &DMatrix::identity(self.n, self.n), usize::MAX);
        inverse.map_or_else(|| DMatrix::zeros(self.n, self.n), |inverse| (effects * inverse).abs())
    }

    /// Multipliers of no more independent rows than this that leave the least of forces, as these act along their coordinates' sizes: what
    /// a row that a multiplier hardly enters is wrong by would otherwise be as much as all that the multiplier balances.  Of rows that depend on
    /// each other, multipliers of which may be as large as one likes, each force counts for itself.
    fn balancing(&self, effects: &DMatrix<f64>, q: &[f64], forces: &DMatrix<f64>, rank: usize) -> Option<DMatrix<f64>> {
        if self.rank() < self.rows.len() {
            return solve_least_of_rank(effects, forces, rank);
        }
        let sizes = DMatrix::from_diagonal(&DVector::from_vec(natural_sizes(&self.units(), q)));
        solve_least_as_measured(&(&sizes * effects), &(&sizes * forces), rank)
    }

    /// The first equation that a state does not satisfy to this part of its terms: a coordinate's, or behind those a row's.
    fn unbalanced(&self, state: &State, part: f64) -> Option<usize> {
        let terms = self.terms(state);
        let force = self.force(state);
        let balanced = |i: usize| {
            let rounding = ROUNDINGS * f64::EPSILON * terms.by_state[i];
            force[i].abs() <= (part * terms.forces[i]).max(rounding).max(NOTHING)
        };
        let (triples, bias) = (self.triples(state), self.bias(state));
        // c' is known to roundings of its terms, which change as fast as the motion: where what γ is made of vanishes, as it does of a
        // distance that stays, this is all there is to judge it by.
        let sizes = natural_sizes(&self.units(), &state.q);
        let pace = state.v.iter().zip(&sizes).fold(0.0_f64, |most, (v, size)| most.max(v.abs() / size));
        let changed = ROUNDINGS * f64::EPSILON * pace;
        let closed: Vec<usize> = self.closed().collect();
        let at_ease = |k: usize| {
            triples[k][1].abs() <= (part * terms.rates[k]).max(NOTHING)
                && bias[k].abs() <= (part * terms.biases[k]).max(changed * terms.rates[k]).max(NOTHING)
                && (!closed.contains(&k) || triples[k][0].abs() <= (part * terms.places[k]).max(NOTHING))
        };
        let rows = (0..self.rows.len()).find(|k| !at_ease(*k)).map(|k| self.n + k);
        (0..self.n).find(|i| !balanced(*i)).or(rows)
    }

    /// A state that a search from another place found, with coordinates at 0 that are nothing beside those with their unit,
    /// beside what they were, or in forces and constraints beside those at that place, if it stays so.
    pub fn settled(&self, state: State, from: &[f64]) -> State {
        let sizes = natural_sizes(&self.units(), &state.q);
        let before = self.terms(&self.state(from, &state.v));
        let forces = before.forces + before.by_state;
        let (slopes, jacobian) = (self.slopes(&state), self.jacobian(&state));
        let mut tried = state.clone();
        for (i, q) in tried.q.iter_mut().enumerate() {
            let slope = slopes.view((0, i), (self.n, 1)).abs();
            let is_rounding = |(x, terms): (&f64, &f64)| (x * *q).abs() <= ROUNDINGS * f64::EPSILON * terms;
            let unnoticed = slope.amax() > 0.0
                && slope.iter().zip(&forces).all(is_rounding)
                && jacobian.column(i).iter().zip(&before.places).all(is_rounding);
            if unnoticed || q.abs() <= (ROUNDINGS * f64::EPSILON * sizes[i]).max(GONE * from[i].abs()) {
                *q = 0.0;
            }
        }
        let tried = State { t: state.t, ..self.state(&tried.q, &tried.v) };
        if tried.q != state.q && self.stays(&tried) { tried } else { state }
    }

    /// Whether nothing depends on time as the equations are written, whatever rounding makes of it.
    pub fn has_no_time(&self) -> bool {
        let description = self.system.description();
        self.rows.is_empty() && description.time_pattern.is_empty() && description.timed_switches.is_empty()
    }

    /// Refuses equations and constraints that change with time though inputs are held.
    ///
    /// # Errors
    /// [`LinearError::DependsOnTime`] with the coordinate or the constraint.
    pub fn check_time(&self, state: &State) -> Result<(), LinearError> {
        if self.has_no_time() {
            return Ok(());
        }
        let all = |state: &State| (self.slopes(state), self.jacobian(state));
        let (slopes, jacobian) = all(state);
        for t in TIMES {
            let later = State { t, ..state.clone() };
            let (slopes_then, jacobian_then) = all(&later);
            let changed = |now: &DMatrix<f64>, then: &DMatrix<f64>, i: usize| {
                let size = now.row(i).amax().max(then.row(i).amax());
                (now.row(i) - then.row(i)).amax() > SAME * size
            };
            let n = self.n;
            let differs =
                |i: &usize| changed(&slopes, &slopes_then, *i) || *i >= n && changed(&jacobian, &jacobian_then, i - n);
            let name = |i: usize| match i.checked_sub(n) {
                None => self.names().swap_remove(i),
                Some(k) => self.system.description().rows[self.rows[k]].name.to_string(),
            };
            if let Some(i) = self.unbalanced(&later, BALANCED) {
                return Err(LinearError::DependsOnTime { coordinate: name(i) });
            }
            if let Some(i) = (0..slopes.nrows()).find(differs) {
                return Err(LinearError::VariesWithTime { coordinate: name(i) });
            }
        }
        Ok(())
    }

    /// That a constraint moves with time by itself, beyond the inputs, if one does: a search that found no rest could find none.
    pub fn driven_by_time(&self, guess: &Guess) -> Option<LinearError> {
        let still = vec![0.0; self.n];
        let moves = |row: &&usize| {
            TIMES.iter().any(|t| constraint_triples(self.system, At::new(*t, &guess.q, &still))[**row][1] != 0.0)
        };
        let row = self.rows.iter().find(moves)?;
        Some(LinearError::DependsOnTime { coordinate: self.system.description().rows[*row].name.to_string() })
    }

    /// What is left of the forces.
    pub fn left(&self, state: &State) -> Vec<Residual> {
        let force = self.force(state);
        let left = self.names().into_iter().zip(self.units()).zip(force.iter());
        left.map(|((coordinate, unit), force)| Residual { coordinate, force: *force, unit: force_unit(&unit) })
            .collect()
    }

    /// That a search ended here.
    pub fn nowhere(&self, state: &State, iterations: usize) -> LinearError {
        let point = self.names().into_iter().zip(state.q.iter().copied()).collect();
        LinearError::NoEquilibrium { iterations, point, residual: self.left(state) }
    }

    pub fn units(&self) -> Vec<String> {
        self.system.description().coordinates.iter().map(|coordinate| coordinate.unit.to_string()).collect()
    }

    pub fn names(&self) -> Vec<String> {
        self.system.description().coordinates.iter().map(|coordinate| coordinate.name.to_string()).collect()
    }
}

/// A matrix without elements that are rounding beside the terms of their rows, as a change of an unknown by its size makes them; the first rows have
/// these terms, and columns that are not named stay.
#[cfg(feature = "modal")]
pub(super) fn telling(
    mut matrix: DMatrix<f64>,
    terms: &[f64],
    sizes: impl Iterator<Item = (usize, f64)>,
) -> DMatrix<f64> {
    for (j, size) in sizes {
        for (i, terms) in terms.iter().enumerate() {
            if (matrix[(i, j)] * size).abs() <= CANCELLED * terms {
                matrix[(i, j)] = 0.0;
            }
        }
    }
    matrix
}
