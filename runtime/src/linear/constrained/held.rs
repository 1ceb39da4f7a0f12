//! What constraints and rotations add to the search for a rest with states of first order or held values: multipliers, the constraints' own equations,
//! and independent coordinates.

use nalgebra::DMatrix;

use super::driven::{Whole, not_unique, observed};
use super::rest::at_rest;
use super::state::{ConstrainedState, State};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::{Guess, LinearError, Observed, has_dependent_coordinates};
use crate::matrix::solve_least;
use crate::mechanism::{Description, System, rows_in_force};

/// The rows in force of a mechanism whose coordinates depend on each other, and what they hold.
pub(in crate::linear) struct Held {
    pub rows: Vec<usize>,
    /// The values at which integrals of constraints that contain speeds are held; 0 of all other rows.
    levels: Vec<f64>,
    /// A place at which rotations have the lengths that they keep.
    like: Vec<f64>,
}

/// What inputs do.
pub(in crate::linear) struct Inputs {
    /// Those that can move, by their places.
    pub moving: Vec<usize>,
    /// What (u, u', u'') of each of these do to all coordinates.
    pub forces: DMatrix<f64>,
    /// All others, by name, and why they cannot.
    pub immovable: Vec<(String, LinearError)>,
}

impl Held {
    /// Moves a place to the nearest one that meets the constraints, with the multipliers that leave the least of its forces; `None` where coordinates
    /// are independent.
    ///
    /// # Errors
    /// [`LinearError::VelocityConstraint`], [`LinearError::MovingConstraint`], [`LinearError::FrictionOfReactions`]; [`LinearError::NoEquilibrium`]
    /// where the constraints cannot be met.
    pub fn at(probe: &mut LinearisationPoint, q: &mut Vec<f64>) -> Result<Option<Held>, LinearError> {
        let found = {
            let system = probe.system.borrow();
            if !has_dependent_coordinates(&**system) {
                return Ok(None);
            }
            super::refuse_sliding(&**system)?;
            let rows: Vec<usize> = rows_in_force(&**system).collect();
            let mut held = at_rest(&**system, &rows, &Guess::at(q))?;
            let closed = held.closed_near(q)?;
            let state = held.state(&closed, &probe.v);
            (Held { rows, levels: held.levels, like: closed.clone() }, closed, state.lambda)
        };
        let (held, closed, lambda) = found;
        (*q, probe.lambda) = (closed, lambda);
        Ok(Some(held))
    }

    /// Does something with the mechanism in a state.
    fn with<T>(
        &self,
        probe: &LinearisationPoint,
        q: &[f64],
        find: impl FnOnce(&ConstrainedState<'_, dyn System>, &State) -> T,
    ) -> T {
        probe.sides_at(q);
        let system = probe.system.borrow();
        let held = ConstrainedState::at_levels(&**system, &self.rows, &self.levels);
        let state = State { lambda: probe.lambda.clone(), ..held.without_multipliers(q, &probe.v) };
        find(&held, &state)
    }

    /// Refuses speeds, and numbers that are not finite.
    pub fn check(&self, probe: &LinearisationPoint, q: &[f64]) -> Result<(), LinearError> {
        let coordinates = probe.system.borrow().description().mechanical();
        if let Some(i) = (0..q.len()).find(|i| !(q[*i].is_finite() && probe.v[*i].is_finite())) {
            return Err(LinearError::NonFinite { what: format!("`{}`", probe.names()[i]) });
        }
        match probe.v[..coordinates].iter().all(|v| *v == 0.0) {
            true => Ok(()),
            false => Err(LinearError::SteadyWithStates),
        }
    }

    /// Refuses a rest that changes with time though inputs are held, and one at which angles lock.
    pub fn check_rest(&self, probe: &LinearisationPoint, q: &[f64]) -> Result<(), LinearError> {
        self.with(probe, q, |held, state| {
            held.unlocked(state)?;
            held.check_time(state)
        })
    }

    /// λ of the rows in force.
    pub fn multipliers(&self, probe: &LinearisationPoint) -> Vec<f64> {
        self.rows.iter().map(|row| probe.lambda[*row]).collect()
    }

    /// Other ones.
    pub fn set_multipliers(&self, probe: &mut LinearisationPoint, values: &[f64]) {
        self.rows.iter().zip(values).for_each(|(row, value)| probe.lambda[*row] = *value);
    }

    /// Gives rotations the lengths that they had at first.
    pub fn keep_lengths(&self, probe: &LinearisationPoint, q: &mut [f64]) {
        let system = probe.system.borrow();
        ConstrainedState::at_levels(&**system, &self.rows, &self.levels).keep_lengths(q, &self.like);
    }

    /// c of each row in force.
    pub fn missed(&self, probe: &LinearisationPoint, q: &[f64]) -> Vec<f64> {
        self.with(probe, q, |held, state| held.triples(state).iter().map(|triple| triple[0]).collect())
    }

    /// The sizes of the terms of F and of c.
    pub fn measures(&self, probe: &LinearisationPoint, q: &[f64]) -> Vec<f64> {
        self.with(probe, q, |held, state| {
            let terms = held.terms(state);
            (terms.forces + terms.by_state).iter().chain(terms.places.iter()).copied().collect()
        })
    }

    /// The slopes of F and c by coordinates and states, and by multipliers; along the length of a rotation, of which F says nothing, its own.
    pub fn bordered(&self, probe: &LinearisationPoint, q: &[f64], slopes: DMatrix<f64>) -> DMatrix<f64> {
        self.with(probe, q, |held, state| {
            let (n, m) = (slopes.nrows(), self.rows.len());
            let most = slopes.amax();
            let size = if most > 0.0 { most } else { 1.0 };
            let mut all = DMatrix::zeros(n + m, n + m);
            all.view_mut((0, 0), (n, n)).copy_from(&held.with_lengths_held(slopes, state, |_| size));
            all.view_mut((0, n), (n, m)).copy_from(&-held.effects(state));
            // Columns of states are those of hidden coordinates, on which no constraint depends.
            all.view_mut((n, 0), (m, n)).copy_from(&held.jacobian(state));
            all
        })
    }

    /// The linear model in all coordinates, and which are independent.
    ///
    /// # Errors
    /// [`LinearError::DependentHere`].
    pub fn whole(&self, probe: &LinearisationPoint, q: &[f64]) -> Result<Whole, LinearError> {
        self.with(probe, q, Whole::of)
    }

    /// What inputs do.
    ///
    /// # Errors
    /// [`LinearError::DependentHere`].
    pub fn inputs(&self, probe: &LinearisationPoint, q: &[f64]) -> Result<Inputs, LinearError> {
        let whole = self.whole(probe, q)?;
        Ok(Inputs { forces: whole.pushed(), moving: whole.moving, immovable: whole.immovable })
    }

    /// Answers by independent coordinates and by the inputs that move.
    ///
    /// # Errors
    /// As [`observe`](crate::linear::observe); [`LinearError::ReactionNotUnique`], [`LinearError::DependentHere`].
    pub fn observe(
        &self,
        description: &Description,
        probe: &LinearisationPoint,
        q: &[f64],
        names: &[&str],
    ) -> Result<Observed, LinearError> {
        let whole = self.whole(probe, q)?;
        observed(description, probe, (&whole, &probe.lambda), (q, &self.rows), names)
    }

    /// How the multipliers of all rows change with forces on all coordinates that they answer: δλ = L (M δa + C δv + K δq + δf).  `by_multipliers`
    /// are the slopes of something by the multipliers of the rows in force.
    ///
    /// # Errors
    /// The row of these that depends on how constraints that say the same share a load.
    pub fn answering(
        &self,
        probe: &LinearisationPoint,
        q: &[f64],
        by_multipliers: &DMatrix<f64>,
    ) -> Result<DMatrix<f64>, Option<usize>> {
        self.with(probe, q, |held, state| {
            let effects = held.effects(state);
            let inverse = solve_least(&effects, &DMatrix::identity(effects.nrows(), effects.nrows())).ok_or(None)?;
            match not_unique(by_multipliers, &inverse, &effects) {
                Some(row) => Err(Some(row)),
                None => {
                    let mut all = DMatrix::zeros(probe.lambda.len(), effects.nrows());
                    self.rows.iter().zip(inverse.row_iter()).for_each(|(row, line)| all.set_row(*row, &line));
                    Ok(all)
                }
            }
        })
    }

    /// The multipliers of the rows in force by name, 0 where no more is left than rounding.
    pub fn reactions(&self, probe: &LinearisationPoint, q: &[f64]) -> Vec<(String, f64)> {
        self.with(probe, q, |held, state| {
            let names = self.rows.iter().map(|row| held.system.description().rows[*row].name.to_string());
            names.zip(held.multipliers(state)).collect()
        })
    }
}
