//! Small departures from steady motions of mechanisms with constraints.
//!
//! Departures (δq, δq') obey δ' = F δ with F = ∂(q', a)/∂(q, q'), the accelerations a from the whole system
//!
//! K [∂a; ∂λ] = −[∂F/∂·; ∂(J a + γ)/∂·],  K = [M −(Jᵀ + B); J 0],
//!
//! derivatives at these a and λ, so that the geometric stiffness of the constraints is in it.  Those that the constraints
//! allow are spanned by W, a basis of the null space of [J_h 0; ∂c'/∂q J], which F leaves invariant: F_W = Wᵀ F W.
//! There are no other zeros in it than those of the motion, which F alone has (Neimark and Fufaev,
//! Dynamics of Nonholonomic Systems, 1972, IV).

use nalgebra::{Complex, DMatrix, DVector};

use super::{on_its_sides, sizes_alike};
use crate::linear::matrices::equilibrated;
use crate::linear::{Equilibrium, FirstOrder, Freedom, Guess, LinearError, Residual, first_order_modes};
use crate::mechanism::{At, System};

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
    /// Its eigenvalues and eigenvectors.
    pub analysis: FirstOrder,
}

/// Forces left in a steady state count as zero below this part of their terms.
const BALANCED: f64 = 1e-9;
/// Rows of what departures must meet, below this part of the largest, depend on others.
const DEPENDENT: f64 = 1e-9;
/// So many roundings of the place are nothing.
const ROUNDINGS: f64 = 16.0;
/// Speeds below this, SI, or this part of the others, that a search leaves are rounding.
const REST: f64 = 1e-13;
/// Gauss's and Newton's iteration gives up after so many steps.
const ITERATIONS: usize = 100;
/// Nothing is further away, or changes faster.
const FAR: f64 = 1e30;
/// Times after which a steady motion is looked at again, s.
const LATER: [f64; 3] = [0.37, 1.9, 13.0];
/// What changes by less than this part of itself is the same.
const SAME: f64 = 1e-8;

/// Finds the steady motion nearest to a guess, the speeds that the guess names kept, or takes the guess itself where `here`
/// is set; linearises there on the states that the constraints leave.
///
/// # Errors
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`]; [`LinearError::NotSteady`] and
/// [`LinearError::DependsOnTime`] where the linear model changes as the motion goes on; numbers that are not finite.
pub fn linearise_tangent<S: System + ?Sized>(system: &S, guess: &Guess, here: bool) -> Result<Tangent, LinearError> {
    let rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
    on_its_sides(system, guess, |system, guess| {
        let steady = Steady { system, n: system.len(), rows: rows.clone() };
        let mut state = State::new(guess, steady.n);
        state.lambda = steady.multipliers(&state);
        let iterations = if here { 0 } else { steady.search(guess, &mut state)? };
        if !steady.holds(&state) {
            return Err(match here {
                true => LinearError::NotAnEquilibrium { residual: steady.left(&state) },
                false => steady.nowhere(&state, iterations),
            });
        }
        steady.stays(&state)?;
        let found = steady.linearised(&state, iterations)?;
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

struct Steady<'a, S: System + ?Sized> {
    system: &'a S,
    n: usize,
    rows: Vec<usize>,
}

/// A state without accelerations, and the multipliers (of all rows) that leave it so.
#[derive(Clone)]
struct State {
    t: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    zero: Vec<f64>,
    lambda: Vec<f64>,
}

impl State {
    fn new(guess: &Guess, n: usize) -> Self {
        State { t: 0.0, q: guess.q.clone(), v: guess.v.clone(), zero: vec![0.0; n], lambda: Vec::new() }
    }

    fn at(&self) -> At<'_> {
        At::new(self.t, &self.q, &self.v).accelerated(&self.zero).constrained(&self.lambda)
    }

    /// The state later on, of one coordinate or of all.
    fn later(&self, time: f64, only: Option<usize>) -> Self {
        let moves = |i: usize| only.is_none_or(|k| k == i);
        let q = (0..self.q.len()).map(|i| if moves(i) { self.q[i] + time * self.v[i] } else { self.q[i] });
        let t = if only.is_none() { self.t + time } else { self.t };
        State { t, q: q.collect(), ..self.clone() }
    }
}

impl<S: System + ?Sized> Steady<'_, S> {
    fn dense(&self, pattern: &[(u32, u32)], values: &[f64], rows: Option<&[usize]>, columns: usize) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(rows.map_or(self.n, <[usize]>::len), columns);
        for ((row, column), value) in pattern.iter().zip(values) {
            let place = match rows {
                Some(rows) => rows.iter().position(|known| *known == *row as usize),
                None => Some(*row as usize),
            };
            if let Some(place) = place {
                matrix[(place, *column as usize)] += value;
            }
        }
        matrix
    }

    /// J of the rows in force.
    fn jacobian(&self, state: &State) -> DMatrix<f64> {
        let pattern = &self.system.description().constraint_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.constraint_matrix(state.at(), &mut values);
        self.dense(pattern, &values, Some(&self.rows), self.n)
    }

    /// Jᵀ + B of the rows in force: what multipliers do.
    fn effects(&self, state: &State) -> DMatrix<f64> {
        let pattern = &self.system.description().friction_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.friction(state.at(), &mut values);
        let all = self.dense(pattern, &values, None, self.system.description().rows.len());
        self.jacobian(state).transpose() + all.select_columns(&self.rows)
    }

    /// ∂c'/∂q of the rows in force.
    fn tilt(&self, state: &State) -> DMatrix<f64> {
        let pattern = &self.system.description().constraint_tilt_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.constraint_tilt(state.at(), &mut values);
        self.dense(pattern, &values, Some(&self.rows), self.n)
    }

    /// [∂F/∂q ∂F/∂q'; ∂(J a + γ)/∂q ∂(J a + γ)/∂q'].
    fn slopes(&self, state: &State) -> DMatrix<f64> {
        let description = self.system.description();
        let (n, m) = (self.n, self.rows.len());
        let patterns = [&description.stiffness_pattern, &description.damping_pattern];
        let [mut dq, mut dv] = patterns.map(|pattern| vec![0.0; pattern.len()]);
        self.system.jacobians(state.at(), &mut dq, &mut dv);
        let below = [&description.constraint_stiffness_pattern, &description.constraint_damping_pattern];
        let [mut cq, mut cv] = below.map(|pattern| vec![0.0; pattern.len()]);
        self.system.constraint_jacobians(state.at(), &mut cq, &mut cv);
        let mut slopes = DMatrix::zeros(n + m, 2 * n);
        for (k, values) in [dq, dv].iter().enumerate() {
            slopes.view_mut((0, k * n), (n, n)).copy_from(&self.dense(patterns[k], values, None, n));
        }
        for (k, values) in [cq, cv].iter().enumerate() {
            slopes.view_mut((n, k * n), (m, n)).copy_from(&self.dense(below[k], values, Some(&self.rows), n));
        }
        slopes
    }

    fn mass(&self, state: &State) -> DMatrix<f64> {
        let pattern = &self.system.description().mass_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system.mass_matrix(state.at(), &mut values);
        let lower = self.dense(pattern, &values, None, self.n);
        &lower + lower.transpose() - DMatrix::from_diagonal(&lower.diagonal())
    }

    fn force(&self, state: &State) -> DVector<f64> {
        let mut force = DVector::zeros(self.n);
        self.system.residual(state.at(), force.as_mut_slice());
        force
    }

    /// The multipliers, of all rows, that leave the least of the forces.
    fn multipliers(&self, state: &State) -> Vec<f64> {
        let mut all = vec![0.0; self.system.description().rows.len()];
        let force = self.force(&State { lambda: all.clone(), ..state.clone() });
        if let Some(lambda) = solved(self.effects(state), &DMatrix::from_column_slice(self.n, 1, force.as_slice())) {
            self.rows.iter().zip(lambda.iter()).for_each(|(row, x)| all[*row] = *x);
        }
        all
    }

    /// c of the holonomic rows, c' and γ of all: what must vanish beside the forces.
    fn conditions(&self, state: &State) -> DVector<f64> {
        let count = self.system.description().rows.len();
        let (mut triples, mut gamma) = (vec![0.0; 3 * count], vec![0.0; count]);
        self.system.constraints(state.at(), &mut triples);
        self.system.constraint_bias(state.at(), &mut gamma);
        let place = self.holonomic().map(|k| triples[3 * self.rows[k]]);
        let rate = self.rows.iter().map(|row| triples[3 * row + 1]);
        let rest = self.rows.iter().map(|row| gamma[*row]);
        DVector::from_vec(place.chain(rate).chain(rest).collect())
    }

    /// Places of the holonomic rows among those in force.
    fn holonomic(&self) -> impl Iterator<Item = usize> + '_ {
        let rows = &self.system.description().rows;
        (0..self.rows.len()).filter(move |k| rows[self.rows[*k]].holonomic)
    }

    /// [J_h 0; ∂c'/∂q J]: what departures must meet.
    fn allowed(&self, state: &State) -> DMatrix<f64> {
        let (n, m) = (self.n, self.rows.len());
        let holonomic: Vec<usize> = self.holonomic().collect();
        let jacobian = self.jacobian(state);
        let mut all = DMatrix::zeros(holonomic.len() + m, 2 * n);
        all.view_mut((0, 0), (holonomic.len(), n)).copy_from(&jacobian.select_rows(&holonomic));
        all.view_mut((holonomic.len(), 0), (m, n)).copy_from(&self.tilt(state));
        all.view_mut((holonomic.len(), n), (m, n)).copy_from(&jacobian);
        all
    }

    /// Gauss's and Newton's iteration by least steps of q, λ and the speeds that the guess leaves open; how many there
    /// were.
    fn search(&self, guess: &Guess, state: &mut State) -> Result<usize, LinearError> {
        let (n, m) = (self.n, self.rows.len());
        let open: Vec<usize> = (0..2 * n).filter(|i| *i < n || guess.v[i - n] == 0.0).collect();
        let mut iterations = 0;
        while iterations < ITERATIONS {
            let left = self.whole(state);
            let slopes = self.slopes(state);
            let allowed = self.allowed(state);
            let extra = allowed.nrows();
            let mut matrix = DMatrix::zeros(n + extra + m, open.len() + m);
            matrix.view_mut((0, 0), (n, open.len())).copy_from(&slopes.rows(0, n).select_columns(&open));
            matrix.view_mut((0, open.len()), (n, m)).copy_from(&(-self.effects(state)));
            matrix.view_mut((n, 0), (extra, open.len())).copy_from(&allowed.select_columns(&open));
            matrix.view_mut((n + extra, 0), (m, open.len())).copy_from(&slopes.rows(n, m).select_columns(&open));
            let lost = state.q.iter().any(|q| q.abs() > FAR);
            if lost || matrix.iter().chain(left.iter()).any(|x| !x.is_finite()) {
                return Err(self.nowhere(state, iterations));
            }
            let right = DMatrix::from_column_slice(left.len(), 1, left.as_slice());
            let Some(step) = solved(matrix, &right) else { return Err(self.nowhere(state, iterations)) };
            let mut part = 1.0;
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
                if part < 1e-6 {
                    break None;
                }
            };
            match better {
                Some(next) => *state = next,
                None => break,
            }
            iterations += 1;
        }
        let fast = state.v.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
        state.v.iter_mut().filter(|v| v.abs() <= REST * fast).for_each(|v| *v = 0.0);
        Ok(iterations)
    }

    fn whole(&self, state: &State) -> DVector<f64> {
        let (force, rest) = (self.force(state), self.conditions(state));
        DVector::from_iterator(force.len() + rest.len(), force.iter().chain(rest.iter()).copied())
    }

    /// Whether nothing accelerates in this state, but for rounding.
    fn holds(&self, state: &State) -> bool {
        let mut sums = vec![0.0; self.n];
        self.system.magnitudes(state.at(), &mut sums);
        // Rounding of the state and of multipliers counts too: the terms of a weight's moment vanish with it.
        let (slopes, effects) = (self.slopes(state), self.effects(state));
        let description = self.system.description();
        let (sizes, speeds) = (sizes_alike(description, &state.q), sizes_alike(description, &state.v));
        let carried = state.lambda.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let place = |i: usize| {
            let by_place: f64 = slopes.row(i).iter().zip(sizes.iter().chain(&speeds)).map(|(k, x)| (k * x).abs()).sum();
            (by_place + carried * effects.row(i).lp_norm(1)) * f64::EPSILON
        };
        let size = 1.0 + state.v.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let force = self.force(state);
        let mut forces = force.iter().zip(sums).enumerate();
        forces.all(|(i, (f, sum))| f.abs() <= (BALANCED * sum).max(ROUNDINGS * place(i)))
            && self.conditions(state).iter().all(|c| c.abs() <= BALANCED * size)
    }

    /// Refuses a state whose linear model changes as the motion goes on.
    fn stays(&self, state: &State) -> Result<(), LinearError> {
        let now = self.field(state)?;
        let size = now.amax().max(f64::MIN_POSITIVE);
        let name = |k: usize| self.system.description().coordinates[k].name.to_string();
        let changes = |later: State| -> Result<bool, LinearError> {
            Ok(!self.holds(&later) || (self.field(&later)? - &now).amax() > SAME * size)
        };
        for time in LATER {
            for k in (0..self.n).filter(|k| state.v[*k] != 0.0) {
                if changes(state.later(time, Some(k)))? {
                    return Err(LinearError::NotSteady { coordinate: name(k) });
                }
            }
            if changes(state.later(time, None))? {
                return Err(LinearError::DependsOnTime { coordinate: name(0) });
            }
        }
        Ok(())
    }

    /// F.
    fn field(&self, state: &State) -> Result<DMatrix<f64>, LinearError> {
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
            solved(k, &slopes).ok_or(LinearError::NoConvergence { what: "the accelerations' derivatives" })?;
        let mut field = DMatrix::zeros(2 * n, 2 * n);
        field.view_mut((0, n), (n, n)).fill_with_identity();
        field.view_mut((n, 0), (n, 2 * n)).copy_from(&(-changes.rows(0, n)));
        Ok(field)
    }

    fn linearised(&self, state: &State, iterations: usize) -> Result<Tangent, LinearError> {
        let n = self.n;
        let field = self.field(state)?;
        // In units of √M a departure's size says what energy it has.
        let mass = self.mass(state);
        let unit = |i: usize| if mass[(i, i)] > 0.0 { 1.0 / mass[(i, i)].sqrt() } else { 1.0 };
        let units = DVector::from_fn(2 * n, |i, _| unit(i % n));
        let scaled = DMatrix::from_fn(2 * n, 2 * n, |i, j| field[(i, j)] * units[j] / units[i]);
        let mut allowed = self.allowed(state);
        allowed.column_iter_mut().enumerate().for_each(|(j, mut column)| column.scale_mut(units[j]));
        let basis = null_space(allowed).ok_or(LinearError::NoConvergence { what: "the states that are left" })?;
        let matrix = basis.transpose() * scaled * &basis;
        let analysis = first_order_modes(&matrix)?;
        let departures = DMatrix::from_fn(2 * n, basis.ncols(), |i, k| basis[(i, k)] * units[i]);
        let equilibrium = Equilibrium {
            coordinates: self.names(),
            q: state.q.clone(),
            v: state.v.clone(),
            inputs: Vec::new(),
            friction: Vec::new(),
            residual: self.force(state).iter().copied().collect(),
            iterations,
            slow: None,
            freedom: Freedom::default(),
        };
        let multipliers = self.rows.iter().map(|row| state.lambda[*row]).collect();
        Ok(Tangent { equilibrium, multipliers, departures, matrix, analysis })
    }

    fn names(&self) -> Vec<String> {
        self.system.description().coordinates.iter().map(|coordinate| coordinate.name.to_string()).collect()
    }

    fn left(&self, state: &State) -> Vec<Residual> {
        let force = self.force(state);
        let left = self.names().into_iter().zip(force.iter());
        left.map(|(coordinate, force)| Residual { coordinate, force: *force, unit: String::new() }).collect()
    }

    fn nowhere(&self, state: &State, iterations: usize) -> LinearError {
        let point = self.names().into_iter().zip(state.q.iter().copied()).collect();
        LinearError::NoEquilibrium { iterations, point, residual: self.left(state) }
    }
}

/// The least x that leaves the least of A x − b, A equilibrated.
fn solved(matrix: DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (scaled, rows, columns) = equilibrated(&matrix);
    let mut b = right.clone();
    b.row_iter_mut().enumerate().for_each(|(i, mut row)| row.scale_mut(rows[i]));
    let size = scaled.amax().max(f64::MIN_POSITIVE) * scaled.nrows().max(scaled.ncols()) as f64;
    let mut x = scaled.svd(true, true).solve(&b, 1e-13 * size).ok()?;
    x.row_iter_mut().enumerate().for_each(|(i, mut row)| row.scale_mut(columns[i]));
    x.iter().all(|x| x.is_finite()).then_some(x)
}

/// An orthonormal basis of what a matrix with scaled columns leaves, its rows judged each by itself.
fn null_space(mut matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
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
    let svd = matrix.try_svd(false, true, f64::EPSILON, 0)?;
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
    }
}
