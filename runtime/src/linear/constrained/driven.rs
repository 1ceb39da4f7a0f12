//! What drives a mechanism with constraints at rest, and what answers.
//!
//! All coordinates depart by x, M x'' + C x' + K x − Jᵀ δλ = B (u, u', u'') + f, and the constraints by J x + b u = 0, where
//! b = ∂c'/∂u' of those that move with inputs.  With J Z = 0, and J P = −b with P = 0 in the independent coordinates, x =
//! Z y + P u and
//!
//! M_z y'' + C_z y' + K_z y = Zᵀ (B (u, u', u'') − K P u − C P u' − M P u'' + f).
//!
//! The first equation then gives what the constraints carry, δλ.

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix, DVector};

use super::rest::Constrained;
use super::state::{CANCELLED, ConstrainedState, State};
use crate::linear::equilibrium::LinearisationPoint;
use crate::linear::forced::slopes_of;
use crate::linear::{Drive, LinearError, Observed, Source, SparseMatrix, Steady};
use crate::matrix::solve_least;
use crate::mechanism::dense::{SECOND_ROUNDING, constraint_rates_by_inputs, force_slopes, input_matrix};
use crate::mechanism::{Description, Solutions, System, rows_in_force};

/// Rows that inputs move may be missed by this part of their terms.
const MISSED: f64 = 1e-9;
/// Reactions that are not unique are asked for by more than this part of what asks for them.
const ROUNDING: f64 = 1e-9;

/// The linear model in all coordinates, and how these follow independent ones and inputs.
pub(in crate::linear) struct Whole {
    mass: DMatrix<f64>,
    damping: DMatrix<f64>,
    stiffness: DMatrix<f64>,
    /// How fast the terms of F grow with q and q'.
    terms: [DMatrix<f64>; 2],
    /// The terms of ∂F/∂q that are those of reactions.
    #[cfg(feature = "modal")]
    of_reactions: DMatrix<f64>,
    /// The first coordinate with the unit of each.
    alike: Vec<usize>,
    /// B, n × 3m.
    input: DMatrix<f64>,
    /// J.
    jacobian: DMatrix<f64>,
    /// Z.
    pub motions: DMatrix<f64>,
    /// P.
    pub carried: DMatrix<f64>,
    /// The coordinates that are independent.
    pub independent: Vec<usize>,
    /// The inputs that can move.
    pub moving: Vec<usize>,
    /// All others, by name, and why they cannot.
    pub immovable: Vec<(String, LinearError)>,
}

impl Whole {
    /// At a state of rest.
    ///
    /// # Errors
    /// [`LinearError::DependentHere`].
    pub(super) fn of<S: System + ?Sized>(held: &ConstrainedState<'_, S>, state: &State) -> Result<Whole, LinearError> {
        let [stiffness, damping] = force_slopes(held.system, state.at());
        let jacobian = held.jacobian(state);
        let Solutions { basis: motions, independent, .. } = Solutions::of(&held.holding(state), &[]);
        let inputs = &held.system.description().inputs;
        let units = held.units();
        let mut whole = Whole {
            mass: held.mass(state),
            damping,
            stiffness,
            terms: held.slopes_of_terms(state),
            #[cfg(feature = "modal")]
            of_reactions: held.terms_of_multipliers(state),
            alike: units.iter().map(|unit| units.iter().position(|other| other == unit).unwrap_or(0)).collect(),
            input: -input_matrix(held.system, state.at()),
            jacobian,
            motions,
            carried: DMatrix::zeros(held.n, inputs.len()),
            independent,
            moving: Vec::new(),
            immovable: Vec::new(),
        };
        let rates = constraint_rates_by_inputs(held.system, state.at(), &held.rows);
        for (k, name) in inputs.iter().enumerate() {
            match held.carried(&whole.jacobian, rates.as_ref(), k) {
                Ok(column) => {
                    whole.carried.set_column(k, &column);
                    whole.moving.push(k);
                }
                Err(why) => whole.immovable.push((name.to_string(), why)),
            }
        }
        if let Some((constraint, inputs)) = whole.undecided(held, state) {
            let why = LinearError::DependentHere { constraint };
            // Inputs alone may be what rows disagree about.
            if inputs.is_empty() {
                return Err(why);
            }
            whole.moving.retain(|k| !inputs.contains(k));
            let description = held.system.description();
            whole.immovable.extend(inputs.iter().map(|k| (description.inputs[*k].to_string(), why.clone())));
        }
        whole.carried = whole.carried.select_columns(&whole.moving);
        whole.input = whole.input.select_columns(&triples(&whole.moving));
        Ok(whole)
    }

    /// A row that depends on others at this state only: how they share a load, which nothing tells, makes a difference to small
    /// motions; with the inputs for which it does, none where it does without.
    fn undecided<S: System + ?Sized>(
        &self,
        held: &ConstrainedState<'_, S>,
        state: &State,
    ) -> Option<(String, Vec<usize>)> {
        let size = state.lambda.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let size = if size > 0.0 { size } else { 1.0 };
        let Solutions { basis: shares, .. } = Solutions::of(&self.jacobian.transpose(), &[]);
        // Forces by independent coordinates and by inputs, and the sums of their terms.
        let free = self.motions.ncols();
        let forces = |k: &DMatrix<f64>, b: &DMatrix<f64>, z: &DMatrix<f64>, p: &DMatrix<f64>| {
            let (by_places, by_inputs) = (k * z, k * p);
            DMatrix::from_fn(z.nrows(), free + p.ncols(), |i, j| match j.checked_sub(free) {
                None => by_places[(i, j)],
                Some(j) => b[(i, 3 * j)] - by_inputs[(i, j)],
            })
        };
        let both = |k: &DMatrix<f64>, b: &DMatrix<f64>| {
            let (z, p) = (&self.motions, &self.carried);
            (z.transpose() * forces(k, b, z, p), z.abs().transpose() * forces(&k.abs(), &b.abs(), &z.abs(), &-p.abs()))
        };
        let (now, terms) = both(&self.stiffness, &self.input);
        let mut found: Option<(String, Vec<usize>)> = None;
        for share in shares.column_iter() {
            let mut other = state.clone();
            held.rows.iter().zip(share.iter()).for_each(|(row, x)| other.lambda[*row] += size / share.amax() * x);
            let [stiffness, _] = force_slopes(held.system, other.at());
            let (then, terms_then) = both(&stiffness, &-input_matrix(held.system, other.at()));
            let (change, terms) = ((then - &now).abs(), (&terms + terms_then) * MISSED);
            let differs = |j: usize| change.column(j).iter().zip(terms.column(j).iter()).any(|(x, most)| x > most);
            let name = || held.system.description().rows[held.rows[share.iamax()]].name.to_string();
            if (0..free).any(differs) {
                return Some((name(), Vec::new()));
            }
            let inputs = (0..self.carried.ncols()).filter(|k| differs(free + k));
            for k in inputs {
                let (_, inputs) = found.get_or_insert_with(|| (name(), Vec::new()));
                if !inputs.contains(&k) {
                    inputs.push(k);
                }
            }
        }
        found
    }

    /// Zᵀ A Z, its symmetric part from that of A and its skew part from that of A, so that rounding makes nothing of one
    /// into the other.
    fn reduced(&self, matrix: &DMatrix<f64>) -> SparseMatrix {
        let (even, odd) = SparseMatrix::from_dense(matrix).split();
        let [even, odd] = [even, odd].map(|part| self.motions.transpose() * part.to_dense() * &self.motions);
        SparseMatrix::from_dense(&((&even + even.transpose()) * 0.5 + (&odd - odd.transpose()) * 0.5))
    }

    /// The sums of the terms of Zᵀ A Z.
    fn reduced_terms(&self, matrix: &DMatrix<f64>, terms: &DMatrix<f64>) -> DMatrix<f64> {
        let size = self.motions.abs();
        size.transpose() * (terms + matrix.abs()) * size
    }

    /// By how much rounding may have moved the elements of M_z, C_z and K_z.
    #[cfg(feature = "modal")]
    pub fn doubts(&self) -> [DMatrix<f64>; 3] {
        let [by_place, by_speed] = &self.terms;
        let by_place = by_place + &self.of_reactions;
        [(&self.mass, &self.mass), (&self.damping, by_speed), (&self.stiffness, &by_place)]
            .map(|(matrix, terms)| self.reduced_terms(matrix, &terms.abs()) * CANCELLED)
    }

    /// M_z, C_z and K_z, without what is rounding of the terms that they are the difference of.
    pub fn matrices(&self) -> [SparseMatrix; 3] {
        let cleaned = |matrix: &DMatrix<f64>, terms: &DMatrix<f64>| {
            let largest = self.reduced_terms(matrix, terms);
            let mut reduced = self.reduced(matrix);
            let kind = |(i, j, _): &(u32, u32, f64)| [i, j].map(|i| self.alike[self.independent[*i as usize]]);
            let mut most: BTreeMap<[usize; 2], f64> = BTreeMap::new();
            for entry in &reduced.entries {
                let most = most.entry(kind(entry)).or_default();
                *most = most.max(entry.2.abs());
            }
            // Beside those between coordinates of the same units, rounding of rounding is nothing, its own terms may be as small.
            let matters = |entry: &(u32, u32, f64)| {
                let (i, j, x) = (entry.0 as usize, entry.1 as usize, entry.2.abs());
                x > CANCELLED * largest[(i, j)] && x > SECOND_ROUNDING * most[&kind(entry)]
            };
            reduced.entries.retain(matters);
            reduced
        };
        let [by_place, by_speed] = &self.terms;
        [self.reduced(&self.mass), cleaned(&self.damping, by_speed), cleaned(&self.stiffness, by_place)]
    }

    /// B (u, u', u'') − K P u − C P u' − M P u'', in all coordinates.
    pub fn pushed(&self) -> DMatrix<f64> {
        let mut pushed = self.input.clone();
        for (order, matrix) in [&self.stiffness, &self.damping, &self.mass].into_iter().enumerate() {
            let back = matrix * &self.carried;
            for (k, column) in back.column_iter().enumerate() {
                let mut place = pushed.column_mut(3 * k + order);
                place -= column;
            }
        }
        pushed
    }

    /// The terms of what inputs push, by size.
    fn pushed_terms(&self) -> DMatrix<f64> {
        let [by_place, by_speed] = &self.terms;
        let (mut pushed, carried) = (self.input.abs(), self.carried.abs());
        let orders = [self.stiffness.abs() + by_place, self.damping.abs() + by_speed, self.mass.abs()];
        for (order, matrix) in orders.iter().enumerate() {
            let back = matrix * &carried;
            for (k, column) in back.column_iter().enumerate() {
                let mut place = pushed.column_mut(3 * k + order);
                place += column;
            }
        }
        pushed
    }

    /// What inputs do to the independent coordinates, without what is rounding of the terms that it is the difference of.
    pub fn input(&self) -> SparseMatrix {
        let (found, terms) =
            (self.motions.transpose() * self.pushed(), self.motions.abs().transpose() * self.pushed_terms());
        SparseMatrix::from_dense(&without_cancelled(found, &terms))
    }

    /// Zᵀ: what generalized forces do to them.
    pub fn forces(&self) -> SparseMatrix {
        SparseMatrix::from_dense(&self.motions.transpose())
    }
}

/// The first answer that depends on how constraints that say the same share a load, by the slopes of answers by multipliers, what multipliers do,
/// and its inverse.
pub(super) fn not_unique(
    by_multipliers: &DMatrix<f64>,
    inverse: &DMatrix<f64>,
    effects: &DMatrix<f64>,
) -> Option<usize> {
    let left = by_multipliers - by_multipliers * inverse * effects;
    (0..left.nrows()).find(|row| left.row(*row).amax() > ROUNDING * by_multipliers.row(*row).amax())
}

/// Answers by independent coordinates, inputs that move and forces, at a place with these multipliers and rows in force.
///
/// # Errors
/// As [`Constrained::observe`].
pub(super) fn observed(
    description: &Description,
    probe: &LinearisationPoint,
    (whole, lambda): (&Whole, &[f64]),
    (q, rows): (&[f64], &[usize]),
    names: &[&str],
) -> Result<Observed, LinearError> {
    let (mut seen, by_multipliers) = slopes_of(description, probe, q, lambda, names)?;
    seen.input = seen.input.select_columns(&triples(&whole.moving));
    whole.answers(seen, &by_multipliers.select_columns(rows))
}

/// The columns of u, u' and u'' of some inputs.
fn triples(inputs: &[usize]) -> Vec<usize> {
    inputs.iter().flat_map(|k| 3 * k..3 * k + 3).collect()
}

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// A column of P: how coordinates follow an input where the independent ones rest; `rates` are ∂c'/∂u and ∂c'/∂u'.
    ///
    /// # Errors
    /// [`LinearError::MovedBySpeed`], [`LinearError::MovesContradict`], numbers that are not finite.
    fn carried(
        &self,
        jacobian: &DMatrix<f64>,
        rates: Option<&[DMatrix<f64>; 2]>,
        k: usize,
    ) -> Result<DVector<f64>, LinearError> {
        let Some([by_value, by_rate]) = rates else { return Ok(DVector::zeros(self.n)) };
        let description = self.system.description();
        let input = description.inputs[k].to_string();
        let constraint = |row: usize| description.rows[self.rows[row]].name.to_string();
        let moved = by_rate.column(k);
        if moved.iter().chain(by_value.column(k).iter()).any(|b| !b.is_finite()) {
            return Err(LinearError::NonFinite { what: format!("how constraints move with `{input}`") });
        }
        if let Some(row) = by_value.column(k).iter().position(|b| *b != 0.0) {
            return Err(LinearError::MovedBySpeed { constraint: constraint(row), input });
        }
        let right: Vec<f64> = moved.iter().map(|b| -b).collect();
        let Solutions { particular, .. } = Solutions::of(jacobian, &right);
        let (left, terms) = (jacobian * &particular + moved, jacobian.abs() * particular.abs() + moved.abs());
        match (0..left.len()).find(|row| left[*row].abs() > MISSED * terms[*row]) {
            Some(row) => Err(LinearError::MovesContradict { constraint: constraint(row), input }),
            None => Ok(particular),
        }
    }
}

impl Constrained {
    /// The slopes of coordinates (`x`), rates (`x'`) and outputs, reactions in them too, by the independent coordinates, by
    /// inputs and by forces; the name of a vector stands for its components.
    ///
    /// # Errors
    /// As [`observe`](crate::linear::observe); [`LinearError::ReactionNotUnique`] for a reaction that depends on how constraints
    /// that say the same share a load.
    pub fn observe<S: System + ?Sized>(&self, system: &S, names: &[&str]) -> Result<Observed, LinearError> {
        let at = &self.linear.equilibrium;
        let probe = LinearisationPoint::new(system, &at.guess());
        probe.sides_at(&at.q);
        let rows: Vec<usize> = rows_in_force(system).collect();
        let (whole, lambda) = {
            let system = probe.system.borrow();
            let held = ConstrainedState::new(&**system, &rows, &at.q);
            let state = held.state(&at.q, &at.v);
            (Whole::of(&held, &state)?, state.lambda)
        };
        observed(system.description(), &probe, (&whole, &lambda), (&at.q, &rows), names)
    }

    /// The steady state at a frequency Ω, rad/s, in all coordinates; what inputs move along through constraints stands
    /// beside the modes.
    ///
    /// # Errors
    /// As [`Linearised::steady`](crate::linear::Linearised::steady).
    pub fn steady(&self, drive: &Drive, omega: f64) -> Result<Steady, LinearError> {
        let reduced = self.linear.steady(drive, omega)?;
        let whole = |y: &Vec<Complex<f64>>| -> Vec<Complex<f64>> {
            let row = |i: usize| y.iter().enumerate().map(|(k, y)| y * self.motions[(i, k)]).sum();
            (0..self.motions.nrows()).map(row).collect()
        };
        let mut carried = vec![Complex::ZERO; self.motions.nrows()];
        for (source, amplitude) in &drive.parts {
            if let Source::Input(k) = source {
                carried.iter_mut().zip(self.carried.column(*k).iter()).for_each(|(sum, p)| *sum += amplitude * *p);
            }
        }
        let total = whole(&reduced.total).iter().zip(&carried).map(|(x, p)| x + p).collect();
        Ok(Steady {
            total,
            carried: carried.iter().any(|x| *x != Complex::ZERO).then_some(carried),
            modes: reduced.modes.iter().map(whole).collect(),
            growth: reduced.growth.as_ref().map(whole),
            ..reduced
        })
    }
}

impl Whole {
    /// Answers by all coordinates, inputs and multipliers as answers by independent coordinates, inputs and forces.
    fn answers(&self, seen: Observed, by_multipliers: &DMatrix<f64>) -> Result<Observed, LinearError> {
        let n = self.mass.nrows();
        // What the constraints carry: δλ = L (M x'' + C x' + K x − B (u, u', u'') − f), of which the least is one.
        let effects = self.jacobian.transpose();
        let inverse = solve_least(&effects, &DMatrix::identity(n, n))
            .ok_or(LinearError::NoConvergence { what: "the reactions of small motions" })?;
        if let Some(row) = not_unique(by_multipliers, &inverse, &effects) {
            return Err(LinearError::ReactionNotUnique { answer: seen.names[row].clone() });
        }
        let force = self.without_rounding(-(by_multipliers * inverse));
        let [by_place, by_speed] = &self.terms;
        let slopes = |seen: &DMatrix<f64>, matrix: &DMatrix<f64>, terms: &DMatrix<f64>| {
            without_cancelled(seen - &force * matrix, &(seen.abs() + force.abs() * (matrix.abs() + terms)))
        };
        let place = slopes(&seen.place, &self.stiffness, by_place);
        let rate = slopes(&seen.rate, &self.damping, by_speed);
        let acceleration = slopes(&seen.acceleration, &self.mass, &self.mass.abs());
        let mut input = &seen.input + &force * &self.input;
        for (order, slopes) in [&place, &rate, &acceleration].into_iter().enumerate() {
            let moved = slopes * &self.carried;
            for (k, column) in moved.column_iter().enumerate() {
                let mut place = input.column_mut(3 * k + order);
                place += column;
            }
        }
        let moved =
            |slopes: DMatrix<f64>| without_cancelled(&slopes * &self.motions, &(slopes.abs() * self.motions.abs()));
        Ok(Observed { place: moved(place), rate: moved(rate), acceleration: moved(acceleration), input, force, ..seen })
    }

    /// Slopes of answers by forces without those that are rounding of rounding beside those on coordinates of the same unit.
    fn without_rounding(&self, mut force: DMatrix<f64>) -> DMatrix<f64> {
        for mut row in force.row_iter_mut() {
            let mut largest = vec![0.0_f64; self.alike.len()];
            self.alike.iter().zip(row.iter()).for_each(|(kind, x)| largest[*kind] = largest[*kind].max(x.abs()));
            let alike = self.alike.iter().zip(row.iter_mut());
            alike.filter(|(kind, x)| x.abs() <= SECOND_ROUNDING * largest[**kind]).for_each(|(_, x)| *x = 0.0);
        }
        force
    }
}

/// A matrix without elements that are rounding of the terms that they are sums of.
fn without_cancelled(mut matrix: DMatrix<f64>, terms: &DMatrix<f64>) -> DMatrix<f64> {
    let both = matrix.iter_mut().zip(terms.iter());
    both.filter(|(x, terms)| x.abs() <= CANCELLED * **terms).for_each(|(x, _)| *x = 0.0);
    matrix
}
