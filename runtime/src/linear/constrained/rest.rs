//! Small motions of mechanisms with holonomic constraints, in coordinates that the constraints leave independent.  One
//! that contains speeds counts as holonomic where its integral is known and held.
//!
//! At rest F(q, 0, 0, λ) = 0 and c(q) = 0, in steady motions F(q, v, 0, λ) = 0 (`steady.rs`).  With Z a basis of the motions that the constraints allow, J Z = 0,
//! M_z = Zᵀ M Z, C_z = Zᵀ (∂F/∂q') Z and K_z = Zᵀ (∂F/∂q) Z at these λ, so that Σ λ_k ∇²c_k, the geometric stiffness of the
//! constraints, is in it.

use nalgebra::{Complex, DMatrix, DVector};

use super::driven::Whole;
use super::on_its_sides;
use super::state::{ConstrainedState, State};
use crate::constrain::{Projection, Start, consistent};
use crate::linear::equilibrium::{ConvergenceHistory, RELAXATIONS, beside};
use crate::linear::matrices::{is_lost, natural_sizes, tried_parts};
use crate::linear::{Equilibrium, Guess, LinearError, Linearised, Mode, ZeroStiffness};
use crate::matrix::{solve_least, solve_least_of_rank};
use crate::mechanism::dense::{constraint_triples, mass_matrix};
use crate::mechanism::{At, System, rows_in_force};

/// M, C and K of a constrained mechanism in independent coordinates, and how all others follow.
#[derive(Clone, Debug, PartialEq)]
pub struct Constrained {
    /// The model in independent coordinates, with the inputs that can move.
    pub linear: Linearised,
    /// Names of all coordinates.
    pub coordinates: Vec<String>,
    /// Z: how all coordinates follow the independent ones.
    pub motions: DMatrix<f64>,
    /// P, a column for each input: how all coordinates follow inputs with which constraints move, beside the independent
    /// ones.
    pub carried: DMatrix<f64>,
    /// The multipliers at rest, of the rows that are active.
    pub multipliers: Vec<f64>,
    /// Inputs that cannot move by themselves, and why: constraints would contradict each other, or follow an input and not its
    /// rate.
    pub immovable: Vec<(String, LinearError)>,
}

/// Newton's method gives up after so many iterations.
const ITERATIONS: usize = 200;
/// A fall ends after so many steps, or when the square of the acceleration is this part of the first.
const FALLS: usize = 400;
const STILL: f64 = 1e-8;

/// Linearises a mechanism with holonomic constraints at an equilibrium near a guess, or at the guess itself where `here` is
/// set.  Known integrals of constraints that contain speeds keep the values that they have at the guess, or at the place
/// nearest to it that closes.
///
/// Speeds of the guess that are not 0 are kept: it is then a steady motion, in which others that can go on steadily follow as
/// the constraints want it, and all else rests.
///
/// # Errors
/// [`LinearError::NotSteady`] where a value matters that would change, [`LinearError::SpeedsContradict`],
/// [`LinearError::MovingConstraint`];
/// [`LinearError::NoEquilibrium`], [`LinearError::NotAnEquilibrium`], [`LinearError::DependsOnTime`];
/// [`LinearError::VelocityConstraint`]: a constraint that contains speeds and has no known integral, or moves by itself, leaves
/// no M, C and K in independent coordinates; [`LinearError::FrictionOfReactions`]: nor do forces made of reactions;
/// [`LinearError::DependentHere`]; numbers that are not finite.
pub fn linearise_constrained<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    here: bool,
) -> Result<Constrained, LinearError> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    on_its_sides(system, guess, |system, guess| {
        let mut held = at_rest(system, &rows, guess)?;
        let found = match here {
            true => {
                let v = held.moving(&guess.q, &guess.v)?;
                Found { state: held.state(&guess.q, &v), iterations: 0, slow: None }
            }
            false => held.rest(guess).map_err(|why| held.driven_by_time(guess).unwrap_or(why))?,
        };
        let (mut small, there) = held.in_independent_coordinates(&found.state, found.iterations, &guess.inputs)?;
        small.linear.equilibrium.freedom = held.freedom(&found.state, &small)?;
        small.linear.equilibrium.slow = found.slow;
        Ok((small, there))
    })
}

/// As [`linearise_constrained`] at a state that is known to be an equilibrium, whose freedom nobody asks for.
pub(super) fn linearised_at(system: &dyn System, guess: &Guess) -> Result<Linearised, LinearError> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    on_its_sides(system, guess, |system, guess| {
        let held = at_rest(system, &rows, guess)?;
        let state = held.state(&guess.q, &guess.v);
        let (small, there) = held.in_independent_coordinates(&state, 0, &guess.inputs)?;
        Ok((small.linear, there))
    })
}

/// R [∂F/∂q −Jᵀ; J 0] C with diagonals R, and 1 and then S in C, such that no block is small beside the others.
pub(super) struct Bordered {
    pub matrix: DMatrix<f64>,
    /// R.
    pub rows: DVector<f64>,
    /// S: multipliers in units of what is solved for.
    pub multipliers: DVector<f64>,
}

/// What a search ends with.
struct Found {
    state: State,
    iterations: usize,
    /// As [`Equilibrium::slow`].
    slow: Option<f64>,
}

/// A mechanism whose rows leave independent coordinates.
///
/// # Errors
/// [`LinearError::VelocityConstraint`], [`LinearError::MovingConstraint`] in a steady motion,
/// [`LinearError::FrictionOfReactions`].
pub(super) fn at_rest<'a, S: System + ?Sized>(
    system: &'a S,
    rows: &[usize],
    guess: &Guess,
) -> Result<ConstrainedState<'a, S>, LinearError> {
    let (description, zero) = (system.description(), vec![0.0; system.len()]);
    // A constraint that moves by itself has no rest.
    let rates = constraint_triples(system, At::new(0.0, &guess.q, &zero));
    let open = |row: &&usize| {
        !(description.rows[**row].integral && rates[**row][1] == 0.0 || description.rows[**row].holonomic)
    };
    if let Some(row) = rows.iter().find(open) {
        return Err(LinearError::VelocityConstraint { constraint: description.rows[*row].name.to_string() });
    }
    let moves = guess.v.iter().any(|v| *v != 0.0);
    if let Some(row) = rows.iter().find(|row| moves && rates[**row][1] != 0.0) {
        return Err(LinearError::MovingConstraint { constraint: description.rows[*row].name.to_string() });
    }
    let held = ConstrainedState::new(system, rows, &guess.q);
    held.without_friction(&held.state(&guess.q, &zero))?;
    Ok(held)
}

/// As [`linearise_constrained`] at the guess itself, for motions that begin there at rest when something drives: constraints
/// that contain speeds then hold J x = 0 from the beginning on, integrals or not.
///
/// Departures that such constraints let stand as they are have no part in its modes.
///
/// # Errors
/// As [`linearise_constrained`].
pub fn linearise_driven<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Constrained, LinearError> {
    let rows: Vec<usize> = rows_in_force(system).collect();
    on_its_sides(system, guess, |system, guess| {
        let held = ConstrainedState::new(system, &rows, &guess.q);
        held.in_independent_coordinates(&held.state(&guess.q, &vec![0.0; held.n]), 0, &guess.inputs)
    })
}

impl Constrained {
    /// Shapes of modes in all coordinates of the file.
    pub fn in_all_coordinates(&self, modes: &[Mode]) -> Vec<Mode> {
        let whole = |mode: &Mode| {
            let shape = (0..self.motions.nrows())
                .map(|i| (0..mode.shape.len()).map(|k| mode.shape[k] * self.motions[(i, k)]).sum::<Complex<f64>>());
            Mode { shape: shape.collect(), ..mode.clone() }
        };
        modes.iter().map(whole).collect()
    }
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// The speeds of a steady motion at a place, of which some are given; none of a rest.
    fn moving(&self, q: &[f64], given: &[f64]) -> Result<Vec<f64>, LinearError> {
        match given.iter().all(|v| *v == 0.0) {
            true => Ok(vec![0.0; self.n]),
            false => self.speeds(&self.shifts(q)?, q, given),
        }
    }

    /// The place nearest to a guess that meets the constraints; known integrals are held as they are there.
    ///
    /// # Errors
    /// [`LinearError::NoEquilibrium`].
    pub fn closed_near(&mut self, guess: &[f64]) -> Result<Vec<f64>, LinearError> {
        let (start, zero) = ([guess, &vec![0.0; self.n]].concat(), vec![0.0; self.n]);
        let held = vec![false; 2 * self.n];
        let closed = consistent(
            self.system,
            &Start { t: 0.0, reached: 0.0, y: &start, held: &held, spins: &[], start_conditions: 0..0 },
        );
        let q = closed.map(|y| y[..self.n].to_vec()).map_err(|_| self.nowhere(&self.state(guess, &zero), 0))?;
        self.hold(&q);
        Ok(q)
    }

    /// From the place nearest to the guess that meets the constraints; where that leads nowhere, from where a motion from
    /// rest would go from there.
    fn rest(&mut self, guess: &Guess) -> Result<Found, LinearError> {
        let (guess, given) = (guess.q.as_slice(), guess.v.as_slice());
        let q = self.closed_near(guess)?;
        let v = self.moving(&q, given)?;
        let found = self.newton(&q, &v).or_else(|nowhere| match v.iter().all(|v| *v == 0.0) {
            true => self.newton(&self.fallen(q).ok_or(nowhere)?, &v),
            false => Err(nowhere),
        })?;
        Ok(Found { state: self.settled(found.state, guess), ..found })
    }

    /// Follows the accelerations from rest, without speeds, until little is left of them: down the potential in the metric
    /// of M.
    fn fallen(&self, q: Vec<f64>) -> Option<Vec<f64>> {
        let n = self.n;
        let mut projection = Projection::new(self.system)?;
        projection.hold(self.system, 0.0, &[q.as_slice(), &vec![0.0; n]].concat());
        let mass = |y: &[f64]| mass_matrix(self.system, At::packed(0.0, y, n));
        let acceleration = |y: &[f64]| {
            let (zero, mut lambda) = (vec![0.0; n], vec![0.0; self.system.description().rows.len()]);
            let mut a = DVector::zeros(n);
            let solved =
                self.system.accelerations_and_multipliers(At::new(0.0, &y[..n], &zero), a.as_mut_slice(), &mut lambda);
            solved.is_ok().then_some(a).filter(|a| a.iter().all(|x| x.is_finite()))
        };
        let mut y = [q, vec![0.0; n]].concat();
        let mut a = acceleration(&y)?;
        let first = (a.transpose() * mass(&y) * &a)[0];
        let size = a.iter().zip(&y).fold(0.0_f64, |most, (a, q)| most.max(a.abs() / (1.0 + q.abs())));
        let mut h = 0.1 / size.max(f64::MIN_POSITIVE);
        for _ in 0..FALLS {
            let mut tried = y.clone();
            tried.iter_mut().zip(a.iter()).for_each(|(q, a)| *q += h * a);
            if is_lost(&self.units(), &tried[..n]) {
                return None;
            }
            projection.project(self.system, 0.0, &mut tried).ok()?;
            let (mass, there) = (mass(&tried), acceleration(&tried)?);
            // Past the lowest point it would be drawn back.
            if (a.transpose() * &mass * &there)[0] < 0.0 {
                h *= 0.5;
                continue;
            }
            (y, a, h) = (tried, there, 1.5 * h);
            if (a.transpose() * mass * &a)[0] <= STILL * first {
                break;
            }
        }
        y.truncate(n);
        Some(y)
    }

    /// Newton's method on F = 0, c = 0 in q and λ at these speeds, halved until both decrease.
    fn newton(&self, from: &[f64], v: &[f64]) -> Result<Found, LinearError> {
        let n = self.n;
        let mut state = self.state(from, v);
        if is_lost(&self.units(), &state.q) {
            return Err(self.nowhere(&state, 0));
        }
        // A rest at 0 has no sizes by which steps of rounding are told.
        if self.is_exact(&state) {
            return Ok(Found { state, iterations: 0, slow: None });
        }
        let mut history = ConvergenceHistory::default();
        for iterations in 0..ITERATIONS {
            let Some((step, rows)) = (if is_lost(&self.units(), &state.q) { None } else { self.step(&state) }) else {
                return Err(self.nowhere(&state, iterations));
            };
            let size = |state: &State| self.left_at_rest(state).component_mul(&rows).norm();
            let before = size(&state);
            let moved = |part: f64| {
                let mut next = state.clone();
                next.q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += part * step);
                self.rows.iter().enumerate().for_each(|(k, row)| next.lambda[*row] += part * step[n + k]);
                self.keep_lengths(&mut next.q, from);
                (part, next)
            };
            let parts = tried_parts(&self.units(), &state.q, step.as_slice());
            let better = parts.map(moved).find(|(_, next)| size(next) < before);
            let sizes = natural_sizes(&self.units(), &state.q);
            let largest = step.iter().zip(&sizes).fold(0.0_f64, |most, (step, size)| most.max(step.abs() / size));
            match better {
                Some((part, next)) if largest > f64::EPSILON => {
                    history.note(largest, part, largest);
                    state = next;
                }
                // As good as rounding lets it be, or nowhere.
                _ if self.stays(&state) => return Ok(Found { state, iterations, slow: history.slow }),
                Some((_, next)) => state = next,
                None => return self.ended(state, from, iterations, history.slow),
            }
        }
        self.ended(state, from, ITERATIONS, history.slow)
    }

    /// What a search ends with that finds nothing better: a rest, if it is one without coordinates that are rounding.
    fn ended(&self, state: State, from: &[f64], iterations: usize, slow: Option<f64>) -> Result<Found, LinearError> {
        let state = self.settled(state, from);
        if self.stays(&state) { Ok(Found { state, iterations, slow }) } else { Err(self.nowhere(&state, iterations)) }
    }

    /// Gives rotations the lengths that they have at another place.  Moments about them fall as their lengths grow, so a search that lets these
    /// grow finds rests where there is none.
    pub fn keep_lengths(&self, q: &mut [f64], like: &[f64]) {
        for first in self.system.description().rotations.iter() {
            let places = *first as usize..*first as usize + 4;
            let [length, wanted] = [&*q, like].map(|q| DVector::from_column_slice(&q[places.clone()]).norm());
            if length > 0.0 && length.is_finite() {
                q[places].iter_mut().for_each(|x| *x *= wanted / length);
            }
        }
    }

    /// F and c.
    fn left_at_rest(&self, state: &State) -> DVector<f64> {
        let (force, triples) = (self.force(state), self.triples(state));
        let left = force.iter().copied().chain(triples.iter().map(|triple| triple[0]));
        DVector::from_iterator(force.len() + triples.len(), left)
    }

    /// Newton's step of q and λ towards F = 0 and c = 0, the least where directions are free, and the factors that make these equations
    /// comparable; `None` where there is none.
    fn step(&self, state: &State) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let Bordered { matrix, rows, multipliers } = self.at_rest_slopes(state);
        let right = -self.left_at_rest(state).component_mul(&rows);
        let right = DMatrix::from_column_slice(rows.len(), 1, right.as_slice());
        if matrix.iter().chain(right.iter()).any(|x| !x.is_finite()) {
            return None;
        }
        let mut step = solve_least_of_rank(&matrix, &right, self.n + self.rank())?;
        step.rows_mut(self.n, multipliers.len()).component_mul_assign(&multipliers);
        Some((step, rows))
    }

    /// What becomes of the directions without stiffness.
    fn freedom(&self, state: &State, small: &Constrained) -> Result<ZeroStiffness, LinearError> {
        ZeroStiffness::along(&small.linear.mass, &small.linear.stiffness, |direction| {
            let whole = &small.motions * DVector::from_column_slice(direction);
            let (mut q, length) = beside(&state.q, whole.as_slice());
            for _ in 0..RELAXATIONS {
                let Some((step, _)) = self.step(&self.state(&q, &state.v)) else { break };
                q.iter_mut().zip(step.iter()).for_each(|(q, step)| *q += step);
                if step.rows(0, self.n).amax() <= 1e-12 * length * whole.amax() {
                    break;
                }
            }
            let moved = DMatrix::from_fn(self.n, 1, |i, _| (q[i] - state.q[i]) / length);
            let failed = LinearError::NoConvergence { what: "the departures of a family" };
            Ok(solve_least(&small.motions, &moved).ok_or(failed)?.as_slice().to_vec())
        })
    }

    /// Slopes of F and c by q and λ.
    pub fn at_rest_slopes(&self, state: &State) -> Bordered {
        let (n, m, jacobian) = (self.n, self.rows.len(), self.jacobian(state));
        let stiffness = self.slopes(state).view((0, 0), (n, n)).into_owned();
        // Without common units what is soft would be rounding beside the constraints.
        let units = DVector::from_vec(natural_sizes(&self.units(), &state.q));
        let or_one = |x: f64| if x > 0.0 && x.is_finite() { x.log2().round().exp2() } else { 1.0 };
        let energy = DMatrix::from_fn(n, n, |i, j| stiffness[(i, j)] * units[i] * units[j]);
        let energy = or_one(energy.amax());
        let stiffness = self.with_lengths_held(stiffness, state, |i| energy / (units[i] * units[i]));
        let reaches: Vec<f64> =
            (0..m).map(|k| or_one(jacobian.row(k).transpose().component_mul(&units).amax())).collect();
        let forces = units.map(|unit| or_one(unit) / energy);
        let rows = DVector::from_iterator(n + m, forces.iter().copied().chain(reaches.iter().map(|reach| 1.0 / reach)));
        let multipliers = DVector::from_iterator(m, reaches.iter().map(|reach| energy / reach));
        let mut matrix = DMatrix::zeros(n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&stiffness);
        matrix.view_mut((0, n), (n, m)).copy_from(&(-jacobian.transpose() * DMatrix::from_diagonal(&multipliers)));
        matrix.view_mut((n, 0), (m, n)).copy_from(&jacobian);
        matrix.row_iter_mut().zip(&rows).for_each(|(mut row, factor)| row *= *factor);
        Bordered { matrix, rows, multipliers }
    }

    /// ∂F/∂q with q·δq = 0 in the place of what F says along the four numbers q of a rotation, which is nothing: that they may be scaled makes
    /// q·F 0 everywhere, whose slope would forbid just the turns by which F changes.
    pub fn with_lengths_held(
        &self,
        stiffness: DMatrix<f64>,
        state: &State,
        size: impl Fn(usize) -> f64,
    ) -> DMatrix<f64> {
        let mut kept = self.without_lengths(stiffness, state);
        for (first, axis) in self.rotations(state) {
            let mut own = kept.view_mut((first, first), (4, 4));
            own += &axis * axis.transpose() * size(first);
        }
        kept
    }

    /// Refuses forces made of reactions: independent coordinates do not know what the constraints carry.
    fn without_friction(&self, state: &State) -> Result<(), LinearError> {
        match self.effects(state) == self.jacobian(state).transpose() {
            true => Ok(()),
            false => Err(LinearError::FrictionOfReactions),
        }
    }

    fn in_independent_coordinates(
        &self,
        state: &State,
        iterations: usize,
        inputs: &[f64],
    ) -> Result<(Constrained, Guess), LinearError> {
        self.without_friction(state)?;
        self.unlocked(state)?;
        if !self.stays(state) {
            return Err(LinearError::NotAnEquilibrium { residual: self.left(state) });
        }
        self.check_time(state)?;
        self.goes_on(state)?;
        let whole = Whole::of(self, state)?;
        let (units, names) = (self.units(), self.names());
        let [mass, damping, stiffness] = whole.matrices();
        let linear = Linearised {
            coordinates: whole.independent.iter().map(|i| names[*i].clone()).collect(),
            units: whole.independent.iter().map(|i| units[*i].clone()).collect(),
            inputs: whole.moving.iter().map(|k| self.system.description().inputs[*k].to_string()).collect(),
            equilibrium: Equilibrium {
                coordinates: names.clone(),
                units,
                q: state.q.clone(),
                v: state.v.clone(),
                inputs: inputs.to_vec(),
                friction: Vec::new(),
                residual: self.force(state).iter().copied().collect(),
                iterations,
                slow: None,
                freedom: ZeroStiffness::default(),
            },
            mass,
            damping,
            stiffness,
            input: whole.input(),
            forces: whole.forces(),
        };
        let multipliers = self.multipliers(&self.shared(state));
        let (Whole { motions, carried, immovable, .. }, there) = (whole, linear.equilibrium.guess());
        Ok((Constrained { linear, coordinates: names, motions, carried, multipliers, immovable }, there))
    }
}
