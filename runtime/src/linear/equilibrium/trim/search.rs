//! The search: unknowns, equations, and exact slopes of these.

use nalgebra::{DMatrix, DVector};

use super::super::least_steps::Rest;
use super::super::{Guess, LinearisationPoint};
use super::{Trimmed, TrimmedValue, Unknown};
use crate::linear::LinearError;
use crate::linear::matrices::natural_sizes;
use crate::matrix::solve_least;
use crate::mechanism::dense::{
    constraint_matrix, constraint_rates_by_inputs, constraint_triples, force_slopes, input_matrix, multiplier_effects,
};
use crate::mechanism::{Along, At, Function, System, rows_in_force};

/// What is sought, where the search is.
pub(super) struct Search {
    pub(super) base: LinearisationPoint,
    pub(super) q: Vec<f64>,
    /// Values of inputs.
    pub(super) inputs: Vec<f64>,
    /// Multipliers of all rows.
    pub(super) lambda: Vec<f64>,
    /// Coordinates, or states by their hidden coordinates, that are held.
    pub(super) held: Vec<usize>,
    /// All others.
    pub(super) free: Vec<usize>,
    /// How many coordinates are not hidden.
    pub(super) mechanical: usize,
    /// Rows of constraints in force, and those of them that hold a place, with what they hold it at.
    pub(super) rows: Vec<usize>,
    pub(super) closed: Vec<(usize, f64)>,
    pub(super) unknowns: Vec<Unknown>,
    pub(super) values: Vec<f64>,
    /// The scene, and the coordinates whose speeds are those of its start, whatever parameters that contains.
    pub(super) follow: (usize, Vec<usize>),
}

impl Search {
    pub(super) fn new<S: System + ?Sized>(
        system: &S,
        guess: &Guess,
        (held, unknowns): (&[usize], &[Unknown]),
        (scene, speeds): (usize, &[usize]),
    ) -> Result<Search, LinearError> {
        let (n, mechanical) = (system.len(), system.description().mechanical());
        for (what, given) in [("the point", guess.q.len()), ("the list of speeds", guess.v.len())] {
            if given != n {
                return Err(LinearError::WrongSize { what, given, expected: n });
            }
        }
        if let Some(given) = held.iter().find(|i| **i >= n) {
            return Err(LinearError::WrongSize { what: "the coordinate's index", given: *given, expected: n });
        }
        let mut inputs = guess.inputs.clone();
        inputs.resize(system.description().inputs.len(), 0.0);
        let (parameters, memory) = (system.parameters(), system.memory());
        let value = |unknown: &Unknown| {
            let (what, list, index) = match unknown {
                Unknown::Input(index) => ("the input's index", inputs.as_slice(), *index),
                Unknown::Parameter(index) => ("the parameter's index", parameters.as_slice(), *index),
                Unknown::Memory(index) => ("the held value's index", memory, *index),
            };
            list.get(index).copied().ok_or(LinearError::WrongSize { what, given: index, expected: list.len() })
        };
        let values = unknowns.iter().map(value).collect::<Result<Vec<f64>, LinearError>>()?;
        let mut q = guess.q.clone();
        q.iter_mut().skip(mechanical).for_each(|hidden| *hidden = 0.0);
        let rows: Vec<usize> = rows_in_force(system).collect();
        let described = &system.description().rows;
        let there = constraint_triples(system, At::new(0.0, &q, &vec![0.0; n]));
        let closes = rows.iter().filter(|row| described[**row].holonomic || described[**row].integral);
        let closed = closes.map(|row| (*row, if described[*row].integral { there[*row][0] } else { 0.0 })).collect();
        let mut search = Search {
            base: LinearisationPoint::new(system, guess),
            q,
            inputs,
            lambda: vec![0.0; described.len()],
            held: held.to_vec(),
            free: (0..n).filter(|i| !held.contains(i)).collect(),
            mechanical,
            rows,
            closed,
            unknowns: unknowns.to_vec(),
            values,
            follow: (scene, speeds.to_vec()),
        };
        search.speeds_follow();
        Ok(search)
    }

    /// Speeds of the scene's start, with the present parameters.
    fn speeds_follow(&mut self) {
        let (scene, speeds) = &self.follow;
        if !speeds.is_empty() {
            let start = self.base.system.borrow().scene(*scene).v;
            speeds.iter().for_each(|i| self.base.v[*i] = start[*i]);
        }
    }

    /// Their slopes by a parameter; 0 of all others.
    fn speeds_by(&self, parameter: usize) -> Vec<f64> {
        let (n, (scene, speeds)) = (self.base.n, &self.follow);
        let mut slopes = vec![0.0; n];
        if !speeds.is_empty() {
            // The scene's end, tolerance and spacing, and places, stand before.
            let mut numbers = vec![0.0; 3 + 2 * n];
            let along = Along { parameter: Some(parameter), ..Along::default() };
            self.base.system.borrow().slopes(Function::Scene(*scene), At::default(), &along, &mut numbers);
            speeds.iter().for_each(|i| slopes[*i] = numbers[3 + n + i]);
        }
        slopes
    }

    pub(super) fn at(&self) -> At<'_> {
        self.base.at(0.0, &self.q, &self.base.v).constrained(&self.lambda)
    }

    /// The multipliers that leave the least of the forces, to begin with.
    pub(super) fn multipliers_from_forces(&mut self) {
        let n = self.base.n;
        self.base.sides_at(&self.q);
        let solved = {
            let system = self.base.system.borrow();
            let mut force = DMatrix::zeros(n, 1);
            system.residual(self.at(), force.as_mut_slice());
            solve_least(&multiplier_effects(&**system, self.at(), &self.rows), &force)
        };
        if let Some(solved) = solved {
            self.rows.iter().zip(solved.iter()).for_each(|(row, x)| self.lambda[*row] += x);
        }
    }

    /// Slopes of F and of c by something that is sought; NaN where they are not known.
    pub(super) fn slope(&self, unknown: Unknown) -> DVector<f64> {
        let n = self.base.n;
        let mut slope = DVector::from_element(n + self.closed.len(), f64::NAN);
        let speeds = if let Unknown::Parameter(index) = unknown { self.speeds_by(index) } else { Vec::new() };
        let system = &**self.base.system.borrow();
        let along = match unknown {
            Unknown::Input(k) => {
                slope.rows_mut(0, n).copy_from(&input_matrix(system, self.at()).column(3 * k));
                let rows: Vec<usize> = self.closed.iter().map(|(row, _)| *row).collect();
                // ∂c/∂u = ∂c'/∂u'.
                let by_rate = constraint_rates_by_inputs(system, self.at(), &rows);
                let column = by_rate.map_or_else(|| DVector::zeros(rows.len()), |[_, by]| by.column(k).into_owned());
                slope.rows_mut(n, rows.len()).copy_from(&column);
                return slope;
            }
            Unknown::Parameter(index) => Along { parameter: Some(index), v: &speeds, ..Along::default() },
            Unknown::Memory(index) => Along { memory: Some(index), ..Along::default() },
        };
        let mut triples = vec![0.0; 3 * self.lambda.len()];
        let known = system.slopes(Function::Residual, self.at(), &along, &mut slope.as_mut_slice()[..n])
            && (triples.is_empty() || system.slopes(Function::Constraints, self.at(), &along, &mut triples));
        if known {
            (self.closed.iter().enumerate()).for_each(|(k, (row, _))| slope[n + k] = triples[3 * row]);
        }
        slope
    }

    /// Refuses what has no slopes.
    pub(super) fn slopes_are_known(&self) -> Result<(), LinearError> {
        let unknown = |unknown: &&Unknown| self.slope(**unknown).iter().any(|x| !x.is_finite());
        match self.unknowns.iter().find(unknown) {
            Some(unknown) => {
                Err(LinearError::NonFinite { what: format!("the slope of the forces by `{}`", self.name(*unknown)) })
            }
            None => Ok(()),
        }
    }

    pub(super) fn name(&self, unknown: Unknown) -> String {
        let system = self.base.system.borrow();
        match unknown {
            Unknown::Input(index) => system.description().inputs[index].to_string(),
            Unknown::Parameter(index) => system.description().parameters[index].name.to_string(),
            Unknown::Memory(index) => system.sampling().memory[index].name.to_string(),
        }
    }

    pub(super) fn coordinate(&self, index: usize) -> String {
        let system = self.base.system.borrow();
        let coordinate = &system.description().coordinates[index];
        coordinate.state().unwrap_or(&coordinate.name).to_owned()
    }

    pub(super) fn equation(&self, index: usize) -> String {
        match index.checked_sub(self.base.n) {
            None => format!("the force on `{}`", self.coordinate(index)),
            Some(k) => format!("`{}`", self.base.system.borrow().description().rows[self.closed[k].0].name),
        }
    }

    /// What each coordinate or state is large beside.
    pub(super) fn sizes(&self) -> Vec<f64> {
        natural_sizes(&self.base.units(), &[&self.q[..self.mechanical], &self.base.v[self.mechanical..]].concat())
    }

    /// Where the quaternions of rotations begin that nothing holds: only their directions matter, their lengths stay 1.
    fn turning(&self) -> Vec<usize> {
        let system = self.base.system.borrow();
        let rotations = system.description().rotations.iter().map(|first| *first as usize);
        rotations.filter(|first| !self.held.iter().any(|i| (*first..first + 4).contains(i))).collect()
    }

    /// ∂(F, c)/∂(q or z), a column for each coordinate, held or not; without what the length of a quaternion does.
    pub(super) fn by_place(&self) -> DMatrix<f64> {
        let (n, system) = (self.base.n, self.base.system.borrow());
        let [by_place, by_speed] = force_slopes(&**system, self.at());
        let rows: Vec<usize> = self.closed.iter().map(|(row, _)| *row).collect();
        let mut slopes = DMatrix::zeros(n + rows.len(), n);
        for i in 0..n {
            let of = if i < self.mechanical { &by_place } else { &by_speed };
            slopes.view_mut((0, i), (n, 1)).copy_from(&of.column(i));
        }
        slopes.rows_mut(n, rows.len()).copy_from(&constraint_matrix(&**system, self.at(), &rows));
        for first in self.turning() {
            let quaternion = DVector::from_column_slice(&self.q[first..first + 4]);
            let along = slopes.columns(first, 4) * &quaternion * quaternion.transpose();
            let mut columns = slopes.columns_mut(first, 4);
            columns -= along;
        }
        slopes
    }

    pub(super) fn place(&self) -> Vec<(String, f64)> {
        let value = |i: usize| if i < self.mechanical { self.q[i] } else { self.base.v[i] };
        let places = (0..self.base.n).map(|i| (self.coordinate(i), value(i)));
        places.chain(self.unknowns.iter().zip(&self.values).map(|(unknown, x)| (self.name(*unknown), *x))).collect()
    }

    pub(super) fn trimmed(self, (from, uncertainties): (&[f64], &[f64]), iterations: usize) -> Trimmed {
        let found = |(k, unknown): (usize, &Unknown)| TrimmedValue {
            unknown: *unknown,
            name: self.name(*unknown),
            from: from[k],
            value: self.values[k],
            uncertainty: uncertainties[k],
        };
        Trimmed {
            found: self.unknowns.iter().enumerate().map(found).collect(),
            residual: self.residual(),
            iterations,
            guess: Guess { q: self.q, v: self.base.v, inputs: self.inputs },
        }
    }
}

impl Rest for Search {
    /// Free coordinates and states, multipliers of rows in force, and what is sought.
    fn unknowns(&self) -> Vec<f64> {
        let places = self.free.iter().map(|i| if *i < self.mechanical { self.q[*i] } else { self.base.v[*i] });
        let multipliers = self.rows.iter().map(|row| self.lambda[*row]);
        places.chain(multipliers).chain(self.values.iter().copied()).collect()
    }

    fn units(&self) -> Vec<String> {
        let units = self.base.units();
        self.free.iter().map(|i| units[*i].clone()).collect()
    }

    fn set(&mut self, unknowns: &[f64]) {
        let (places, rest) = unknowns.split_at(self.free.len());
        let (multipliers, values) = rest.split_at(self.rows.len());
        for (i, x) in self.free.iter().zip(places) {
            (if *i < self.mechanical { &mut self.q } else { &mut self.base.v })[*i] = *x;
        }
        self.rows.iter().zip(multipliers).for_each(|(row, x)| self.lambda[*row] = *x);
        self.values.copy_from_slice(values);
        for first in self.turning() {
            let length = self.q[first..first + 4].iter().map(|x| x * x).sum::<f64>().sqrt();
            self.q[first..first + 4].iter_mut().for_each(|x| *x /= length);
        }
        let mut system = self.base.system.borrow_mut();
        for (unknown, value) in self.unknowns.iter().zip(values) {
            if let Unknown::Input(index) = unknown {
                self.inputs[*index] = *value;
            }
            unknown.give(&mut **system, *value);
        }
        drop(system);
        self.speeds_follow();
    }

    /// F, then c.
    fn left(&self) -> Vec<f64> {
        self.base.sides_at(&self.q);
        let system = self.base.system.borrow();
        let mut left = vec![0.0; self.base.n];
        system.residual(self.at(), &mut left);
        if !self.closed.is_empty() {
            let triples = constraint_triples(&**system, self.at());
            left.extend(self.closed.iter().map(|(row, level)| triples[*row][0] - level));
        }
        left
    }

    fn measures(&self) -> Vec<f64> {
        self.base.sides_at(&self.q);
        let mut sums = vec![0.0; self.base.n];
        self.base.system.borrow().magnitudes(self.at(), &mut sums);
        let triples = constraint_triples(&**self.base.system.borrow(), self.at());
        sums.extend(self.closed.iter().map(|(row, _)| triples[*row][2]));
        // What the size of each number makes of its slopes: of those that are held too, and of a turn that is 0 but for rounding beside
        // the length of its quaternion, or of a place beside others.
        let (slopes, numbers) = (self.slopes(), self.unknowns());
        let (places, all) = (self.by_place(), self.sizes());
        let made = |(row, sum): (usize, f64)| {
            let by = |slopes: &DMatrix<f64>, numbers: &[f64]| -> f64 {
                slopes.row(row).iter().zip(numbers).map(|(slope, x)| (slope * x).abs()).sum()
            };
            sum + by(&places, &all)
                + by(
                    &slopes.columns(self.free.len(), numbers.len() - self.free.len()).into_owned(),
                    &numbers[self.free.len()..],
                )
        };
        let mut measures: Vec<f64> = sums.into_iter().enumerate().map(made).collect();
        // The four equations of a rotation are three moments: what one of them is judged by, all are.
        for first in self.base.system.borrow().description().rotations.iter().map(|first| *first as usize) {
            let largest = measures[first..first + 4].iter().fold(0.0_f64, |most, x| most.max(*x));
            measures[first..first + 4].fill(largest);
        }
        self.pass_on(&mut measures);
        measures
    }

    fn slopes(&self) -> DMatrix<f64> {
        self.base.sides_at(&self.q);
        let (n, places) = (self.base.n, self.by_place());
        let first = self.free.len() + self.rows.len();
        let mut slopes = DMatrix::zeros(places.nrows(), first + self.unknowns.len());
        self.free.iter().enumerate().for_each(|(k, i)| slopes.set_column(k, &places.column(*i)));
        let effects = multiplier_effects(&**self.base.system.borrow(), self.at(), &self.rows);
        slopes.view_mut((0, self.free.len()), (n, self.rows.len())).copy_from(&-effects);
        for (k, unknown) in self.unknowns.iter().enumerate() {
            slopes.set_column(first + k, &self.slope(*unknown));
        }
        slopes
    }
}
