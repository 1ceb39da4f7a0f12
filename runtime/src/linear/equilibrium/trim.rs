//! Trim: a rest with some coordinates held where they are said to be, and inputs, parameters or held values found that make it one.
//!
//! With some of the coordinates q held, and s the values that are sought, the unknowns are the coordinates x that are free, states of
//! first order z, multipliers λ and s, all in one search by Newton's method with least steps:
//!
//! F(q, z, λ; s) = 0, c(q; s) = 0.
//!
//! Its slopes are exact, those by s too.  The search begins with the values that the system has; of several solutions it finds the one
//! that least steps from there lead to.  Where it ends, the singular values of the slopes, rows and columns brought to one size, tell
//! what is not determined: directions in which nothing changes to first order.
//!
//! Source: Stevens, Lewis and Johnson, Aircraft Control and Simulation, 2016, 3.6 (steady-state trim), by equations in place of a cost.

use nalgebra::{DMatrix, DVector};

use super::least_steps::{BALANCED, Rest};
use super::{Guess, LinearisationPoint};
use crate::linear::{LinearError, Residual};
use crate::matrix::{equilibrated, solve_least};
use crate::mechanism::dense::{
    constraint_matrix, constraint_rates_by_inputs, constraint_triples, force_slopes, input_matrix, multiplier_effects,
};
use crate::mechanism::{Along, At, Function, System};

/// Directions in which slopes, brought to one size, are below this part of the largest change nothing: nine digits of the slopes are
/// lost there, and of what they give some six would be left.
const UNDETERMINED: f64 = 1e-9;
/// A value that rounding of forces leaves no three digits of, beside the larger of itself and of where its search began, changes
/// nothing but rounding.
const UNKNOWN: f64 = 1e-3;
/// What has less than this part of such a direction, or of what is left, takes no part in it.
const TAKES_PART: f64 = 1e-6;
/// So many roundings of its terms are left of an equation.
const ROUNDINGS: f64 = 4.0;

/// Something whose value is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// An input, by its index; the search begins with the value at which the guess holds it.
    Input(usize),
    /// A free parameter, by its index; the search begins with its present value.
    Parameter(usize),
    /// A held value (`memory`), by its index; the search begins with its present value.
    Memory(usize),
}

/// A value that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedValue {
    /// What has it.
    pub unknown: Unknown,
    /// Its name.
    pub name: String,
    /// Where the search began, SI.
    pub from: f64,
    /// SI.
    pub value: f64,
    /// What rounding of forces and constraints makes of it, SI.
    pub uncertainty: f64,
}

/// A rest with coordinates held, and what makes it one.
#[derive(Clone, Debug, PartialEq)]
pub struct Trimmed {
    /// The state, and the values at which inputs are held: those that were found, too.
    pub guess: Guess,
    /// What was found, in the order in which it was asked for.
    pub found: Vec<TrimmedValue>,
    /// Steps of Newton's method.
    pub iterations: usize,
    /// What is left of each equation, of its terms: the largest.
    pub residual: f64,
}

impl Trimmed {
    /// Gives a system the parameters and held values that were found; inputs are those of the guess.
    pub fn apply<S: System + ?Sized>(&self, system: &mut S) {
        self.found.iter().for_each(|found| put(system, found.unknown, found.value));
    }
}

/// Finds values of inputs, free parameters and held values (`unknowns`) with which a mechanism rests with some coordinates (`held`, by
/// index; those of states of first order hold the state) where the guess has them; all others follow.  With constraints too.  Speeds of
/// the guess stay as they are.
///
/// ```
/// use dalembert::linear::{Guess, Unknown, equilibrium_here, linearise, trim};
/// use dalembert::mechanism::Dynamic;
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Arm
/// parameters: {m: 2 kg, l: 0.5 m, g: 10 m/s^2}
/// coordinates: {theta: rad}
/// inputs: {T: 0 N*m}
/// kinetic_energy: m*(l*theta')^2/2
/// potential_energy: m*g*l*sin(theta)
/// generalized_forces: {theta: T}
/// "#);
/// # }
/// # use example::Arm;
/// let arm = Dynamic::new(Arm::default());
/// let trimmed = trim(&arm, &Guess::at(&[0.3]), &[0], &[Unknown::Input(0)])?;
/// // The motor carries the weight, m g l cos θ, and the weight's stiffness is −m g l sin θ.
/// assert!((trimmed.found[0].value - 10.0 * 0.3_f64.cos()).abs() < 1e-14);
/// let linear = linearise(&arm, &equilibrium_here(&arm, &trimmed.guess)?)?;
/// assert!((linear.k()[(0, 0)] + 10.0 * 0.3_f64.sin()).abs() < 1e-14);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
///
/// # Errors
/// [`LinearError::CannotHold`] where no values were found with which it rests so; [`LinearError::Undetermined`] with the unknowns that
/// cannot be told apart, or change nothing; [`LinearError::DependsOnTime`]; [`LinearError::NoEquilibrium`]; indices that do not exist;
/// numbers that are not finite.
pub fn trim<S: System + ?Sized>(
    system: &S,
    guess: &Guess,
    held: &[usize],
    unknowns: &[Unknown],
) -> Result<Trimmed, LinearError> {
    let mut search = Search::new(system, guess, held, unknowns)?;
    search.base.check_time(&search.q)?;
    search.multipliers_from_forces();
    if let Some(i) = search.left().iter().position(|x| !x.is_finite()) {
        return Err(LinearError::NonFinite { what: search.equation(i) });
    }
    search.slopes_are_known()?;
    let from = search.values.clone();
    let iterations = search.newton().map_err(|iterations| search.nowhere(iterations))?;
    search.diagnosed(iterations)?;
    let uncertainties = search.uncertainties();
    let unknown =
        |k: &usize| from[*k] != 0.0 && uncertainties[*k] > UNKNOWN * from[*k].abs().max(search.values[*k].abs());
    if let Some(k) = (0..from.len()).find(unknown) {
        return Err(LinearError::Undetermined { unknowns: vec![search.name(unknowns[k])], along: Vec::new() });
    }
    Ok(search.trimmed((&from, &uncertainties), iterations))
}

fn put<S: System + ?Sized>(system: &mut S, unknown: Unknown, value: f64) {
    match unknown {
        Unknown::Input(index) => system.hold_input(index, value),
        Unknown::Parameter(index) => system.set_parameter(index, value),
        Unknown::Memory(index) => {
            let mut memory = system.memory().to_vec();
            memory[index] = value;
            system.set_memory(&memory);
        }
    }
}

struct Search {
    base: LinearisationPoint,
    q: Vec<f64>,
    /// Values of inputs.
    inputs: Vec<f64>,
    /// Multipliers of all rows.
    lambda: Vec<f64>,
    /// Coordinates, or states by their hidden coordinates, that are held.
    held: Vec<usize>,
    /// All others.
    free: Vec<usize>,
    /// How many coordinates are not hidden.
    mechanical: usize,
    /// Rows of constraints in force, and those of them that hold a place, with what they hold it at.
    rows: Vec<usize>,
    closed: Vec<(usize, f64)>,
    unknowns: Vec<Unknown>,
    values: Vec<f64>,
}

impl Search {
    fn new<S: System + ?Sized>(
        system: &S,
        guess: &Guess,
        held: &[usize],
        unknowns: &[Unknown],
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
        let rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
        let described = &system.description().rows;
        let there = constraint_triples(system, At::new(0.0, &q, &vec![0.0; n]));
        let closes = rows.iter().filter(|row| described[**row].holonomic || described[**row].integral);
        let closed = closes.map(|row| (*row, if described[*row].integral { there[*row][0] } else { 0.0 })).collect();
        Ok(Search {
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
        })
    }

    fn at(&self) -> At<'_> {
        At::new(0.0, &self.q, &self.base.v).accelerated(self.base.at_rest()).constrained(&self.lambda)
    }

    /// The multipliers that leave the least of the forces, to begin with.
    fn multipliers_from_forces(&mut self) {
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
    fn slope(&self, unknown: Unknown) -> DVector<f64> {
        let n = self.base.n;
        let mut slope = DVector::from_element(n + self.closed.len(), f64::NAN);
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
            Unknown::Parameter(index) => Along { parameter: Some(index), ..Along::default() },
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
    fn slopes_are_known(&self) -> Result<(), LinearError> {
        let unknown = |unknown: &&Unknown| self.slope(**unknown).iter().any(|x| !x.is_finite());
        match self.unknowns.iter().find(unknown) {
            Some(unknown) => {
                Err(LinearError::NonFinite { what: format!("the slope of the forces by `{}`", self.name(*unknown)) })
            }
            None => Ok(()),
        }
    }

    fn name(&self, unknown: Unknown) -> String {
        let system = self.base.system.borrow();
        match unknown {
            Unknown::Input(index) => system.description().inputs[index].to_string(),
            Unknown::Parameter(index) => system.description().parameters[index].name.to_string(),
            Unknown::Memory(index) => system.sampling().memory[index].name.to_string(),
        }
    }

    fn coordinate(&self, index: usize) -> String {
        let system = self.base.system.borrow();
        let coordinate = &system.description().coordinates[index];
        coordinate.state().unwrap_or(&coordinate.name).to_owned()
    }

    fn equation(&self, index: usize) -> String {
        match index.checked_sub(self.base.n) {
            None => format!("the force on `{}`", self.coordinate(index)),
            Some(k) => format!("`{}`", self.base.system.borrow().description().rows[self.closed[k].0].name),
        }
    }

    /// ∂(F, c)/∂(q or z), a column for each coordinate, held or not.
    fn by_place(&self) -> DMatrix<f64> {
        let (n, system) = (self.base.n, self.base.system.borrow());
        let [by_place, by_speed] = force_slopes(&**system, self.at());
        let rows: Vec<usize> = self.closed.iter().map(|(row, _)| *row).collect();
        let mut slopes = DMatrix::zeros(n + rows.len(), n);
        for i in 0..n {
            let of = if i < self.mechanical { &by_place } else { &by_speed };
            slopes.view_mut((0, i), (n, 1)).copy_from(&of.column(i));
        }
        slopes.rows_mut(n, rows.len()).copy_from(&constraint_matrix(&**system, self.at(), &rows));
        slopes
    }

    fn place(&self) -> Vec<(String, f64)> {
        let value = |i: usize| if i < self.mechanical { self.q[i] } else { self.base.v[i] };
        let places = (0..self.base.n).map(|i| (self.coordinate(i), value(i)));
        places.chain(self.unknowns.iter().zip(&self.values).map(|(unknown, x)| (self.name(*unknown), *x))).collect()
    }

    /// What is left of forces and, by the names of rows, of constraints.
    fn forces_left(&self) -> Vec<Residual> {
        let left = self.left();
        let mut residual = self.base.forces(&left[..self.base.n]);
        residual.retain(|left| left.force != 0.0);
        let system = self.base.system.borrow();
        let missed = self.closed.iter().zip(&left[self.base.n..]).filter(|(_, left)| **left != 0.0);
        residual.extend(missed.map(|((row, _), left)| Residual {
            coordinate: system.description().rows[*row].name.to_string(),
            force: *left,
            unit: String::new(),
        }));
        residual
    }

    fn nowhere(&self, iterations: usize) -> LinearError {
        LinearError::NoEquilibrium { iterations, point: self.place(), residual: self.forces_left() }
    }

    /// Refuses what is no rest, and values that nothing determines.
    fn diagnosed(&self, iterations: usize) -> Result<(), LinearError> {
        if !self.is_met(BALANCED) {
            let holds = self.in_the_way();
            let unknowns = self.unknowns.iter().map(|unknown| self.name(*unknown)).collect();
            return Err(match holds.is_empty() {
                true => self.nowhere(iterations),
                false => LinearError::CannotHold { holds, unknowns, point: self.place(), residual: self.forces_left() },
            });
        }
        let (scaled, _, _) = equilibrated(&self.slopes());
        let wide = scaled.ncols().saturating_sub(scaled.nrows());
        let rows = scaled.nrows() + wide;
        // Rows of zeros, so that all directions in which nothing changes are among those of the decomposition.
        let scaled = scaled.resize_vertically(rows, 0.0);
        let solved = scaled.try_svd(false, true, f64::EPSILON, 1000 * rows.max(10));
        let failed = LinearError::NoConvergence { what: "the singular value decomposition of the slopes" };
        let (values, directions) = solved.and_then(|svd| Some((svd.singular_values, svd.v_t?))).ok_or(failed)?;
        let (first, most) = (directions.ncols() - self.unknowns.len(), values.max());
        let free = (0..values.len()).filter(|k| values[*k] <= UNDETERMINED * most);
        let takes_part = |direction: usize, column: usize| directions[(direction, column)].abs() > TAKES_PART;
        for direction in free {
            let moving = (0..self.unknowns.len()).filter(|k| takes_part(direction, first + k));
            let unknowns: Vec<String> = moving.map(|k| self.name(self.unknowns[k])).collect();
            if !unknowns.is_empty() {
                let along = self.free.iter().enumerate().filter(|(column, _)| takes_part(direction, *column));
                return Err(LinearError::Undetermined {
                    unknowns,
                    along: along.map(|(_, i)| self.coordinate(*i)).collect(),
                });
            }
        }
        Ok(())
    }

    /// What is held, and would move if it were not, towards less of what is left.
    fn in_the_way(&self) -> Vec<String> {
        let weights = self.measures();
        let part = |(left, measure): (f64, &f64)| if left == 0.0 { 0.0 } else { left / measure };
        let left = DVector::from_vec(self.left().into_iter().zip(&weights).map(part).collect());
        let slopes = self.by_place();
        let eases = |i: &&usize| {
            let column =
                DVector::from_fn(left.len(), |row, _| slopes[(row, **i)] / weights[row].max(f64::MIN_POSITIVE));
            left.dot(&column).abs() > TAKES_PART * left.norm() * column.norm()
        };
        self.held.iter().filter(eases).map(|i| self.coordinate(*i)).collect()
    }

    /// Adds what multipliers, which balance as much as they can, make of the rounding of one force in others.
    fn pass_on(&self, measures: &mut [f64]) {
        let n = self.base.n;
        let effects = multiplier_effects(&**self.base.system.borrow(), self.at(), &self.rows);
        let Some(inverse) = solve_least(&effects, &DMatrix::identity(n, n)).filter(|_| !self.rows.is_empty()) else {
            return;
        };
        let passed = (&effects * inverse).abs() * DVector::from_column_slice(&measures[..n]);
        let carried = self.lambda.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let all = passed.iter().zip(effects.row_iter()).map(|(passed, row)| passed + carried * row.lp_norm(1));
        measures.iter_mut().zip(all).for_each(|(sum, passed)| *sum += passed);
    }

    /// What rounding of forces and constraints makes of each value.
    fn uncertainties(&self) -> Vec<f64> {
        let (slopes, measures) = (self.slopes(), self.measures());
        let inverse = solve_least(&slopes, &DMatrix::identity(slopes.nrows(), slopes.nrows()));
        let first = slopes.ncols() - self.unknowns.len();
        let rounding = |k: usize| {
            let of = |inverse: &DMatrix<f64>| {
                inverse.row(first + k).iter().zip(&measures).map(|(x, measure)| (x * measure).abs()).sum::<f64>()
            };
            ROUNDINGS * f64::EPSILON * inverse.as_ref().map_or(f64::INFINITY, of)
        };
        (0..self.unknowns.len()).map(rounding).collect()
    }

    fn trimmed(self, (from, uncertainties): (&[f64], &[f64]), iterations: usize) -> Trimmed {
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

    fn set(&mut self, unknowns: &[f64]) {
        let (places, rest) = unknowns.split_at(self.free.len());
        let (multipliers, values) = rest.split_at(self.rows.len());
        for (i, x) in self.free.iter().zip(places) {
            (if *i < self.mechanical { &mut self.q } else { &mut self.base.v })[*i] = *x;
        }
        self.rows.iter().zip(multipliers).for_each(|(row, x)| self.lambda[*row] = *x);
        self.values.copy_from_slice(values);
        let mut system = self.base.system.borrow_mut();
        for (unknown, value) in self.unknowns.iter().zip(values) {
            if let Unknown::Input(index) = unknown {
                self.inputs[*index] = *value;
            }
            put(&mut **system, *unknown, *value);
        }
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
        // What the size of each number makes of its slopes: of those that are held too.
        let (slopes, numbers) = (self.slopes(), self.unknowns());
        let (places, all) = (self.by_place(), [&self.q[..self.mechanical], &self.base.v[self.mechanical..]].concat());
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
