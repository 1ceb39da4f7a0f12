//! Equilibria and steady motions by Newton's method.

use std::fmt;

use nalgebra::{DMatrix, DVector};

use super::discontinuity::{Jump, held};
use super::family::ZeroStiffness;
use super::point::LinearisationPoint;
use crate::linear::matrices::{Scaled, Singular, first_part, is_lost};
use crate::linear::{LinearError, SparseMatrix, short, short_beside};
use crate::matrix::equilibrated;
use crate::mechanism::System;
use crate::numbers::spaced;

/// Residual forces of a given state below this part of their own row's terms count as zero.
const GIVEN: f64 = 1e-9;
/// Those of a state that was found: what rounding leaves.
const FOUND: f64 = 1e-11;
/// Coordinates that have shrunk to this part of what they were are tried at 0.
const GONE: f64 = 1e-9;
/// Newton's method gives up after so many iterations.
const MOST_ITERATIONS: usize = 200;
/// Steps that keep shrinking no faster than this point to a multiple root (catalogue C15: 1/2 for a double
/// root, 2/3 for a triple one).
const SLOW: f64 = 0.45;
/// Matrices of more rows are factored first, and judged by singular values only where that fails.
const LARGE: usize = 60;

/// Where a search for an equilibrium starts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Guess {
    /// Generalized coordinates, SI.
    pub q: Vec<f64>,
    /// Speeds of cyclic coordinates in a steady motion, SI; 0 for all others.  They are kept.
    pub v: Vec<f64>,
    /// Values at which inputs are held; those that are not listed are 0.
    pub inputs: Vec<f64>,
}

impl Guess {
    /// At rest, with all inputs 0.
    pub fn at(q: &[f64]) -> Self {
        Guess { q: q.to_vec(), v: vec![0.0; q.len()], inputs: Vec::new() }
    }
}

/// A state that persists: F(q, q', 0) = 0 with no speed but those of cyclic coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Names of the coordinates.
    pub coordinates: Vec<String>,
    /// Their units, SI; empty where the model file has none.
    pub units: Vec<String>,
    /// Generalized coordinates, SI.
    pub q: Vec<f64>,
    /// Their speeds, SI: 0 except for cyclic coordinates in a steady motion.
    pub v: Vec<f64>,
    /// Values at which inputs are held; those that are not listed are 0.
    pub inputs: Vec<f64>,
    /// Dry friction that acts here: the equilibrium is one of a set, and has no linear model.
    pub friction: Vec<Jump>,
    /// The generalized forces left (without dry friction), SI.
    pub residual: Vec<f64>,
    /// Iterations of Newton's method.
    pub iterations: usize,
    /// The ratio of the last steps where convergence was only linear: the equilibrium is degenerate.
    pub slow: Option<f64>,
    /// Directions without stiffness.
    pub freedom: ZeroStiffness,
}

impl Equilibrium {
    /// The state, to be looked at or to begin from.
    #[cfg(feature = "cli")]
    pub(crate) fn as_guess(&self) -> Guess {
        Guess { q: self.q.clone(), v: self.v.clone(), inputs: self.inputs.clone() }
    }

    /// A state that is known to be one.
    pub(super) fn at(base: &LinearisationPoint, state: &Guess) -> Equilibrium {
        Equilibrium {
            coordinates: base.names(),
            units: base.units(),
            q: state.q.clone(),
            v: state.v.clone(),
            inputs: state.inputs.clone(),
            friction: Vec::new(),
            residual: base.force(&state.q),
            iterations: 0,
            slow: None,
            freedom: ZeroStiffness::default(),
        }
    }

    /// The state, to start from.
    pub fn guess(&self) -> Guess {
        Guess { q: self.q.clone(), v: self.v.clone(), inputs: self.inputs.clone() }
    }

    /// The largest residual force.
    pub fn largest_residual(&self) -> f64 {
        self.residual.iter().fold(0.0, |most, f| f.abs().max(most))
    }

    /// True where the stiffness vanishes in a direction along which there is no other equilibrium: the linear
    /// model does not tell what happens there.
    pub fn is_degenerate(&self) -> bool {
        self.slow.is_some() || !self.freedom.degenerate.is_empty()
    }
}

/// Solves F(q, q', 0) = 0 by Newton's method from a guess.
///
/// Discontinuities are on the side where a point lies.  Dry friction (`sign` of a speed) counts as 0 in the search,
/// so what is found is the middle of the set of equilibria that it makes; only where nothing else balances is the
/// guess itself one, if friction can hold it.  [`Equilibrium::friction`] tells.
///
/// Steps solve K Δq = −F with the exact K = ∂F/∂q, of least norm (in the metric of M's diagonal) where K is
/// singular, and are halved until F decreases.  It goes on until rounding stops it.
///
/// # Errors
/// [`LinearError::NoEquilibrium`] with where it stood and the forces left; [`LinearError::DependsOnTime`], [`LinearError::VariesWithTime`],
/// [`LinearError::NotSteady`], wrong sizes and numbers that are not finite.
pub fn equilibrium_near<S: System + ?Sized>(system: &S, guess: &Guess) -> Result<Equilibrium, LinearError> {
    let base = LinearisationPoint::new(system, guess);
    if let Err(error) = base.check(&guess.q) {
        // Whether the rest itself moves, or only what is beside it changes, shows there.
        if error.is_of_time()
            && let Ok(found) = newton(&base, guess.q.clone())
        {
            base.check(&found.q)?;
        }
        return Err(error.without_rest());
    }
    match newton(&base, guess.q.clone()) {
        Ok(found) => {
            base.check(&found.q)?;
            finish(system, &base, found, guess)
        }
        // A block that dry friction holds on a slope is at rest wherever it is put.
        Err(LinearError::NoEquilibrium { iterations, .. }) if holds(&base, &guess.q) => {
            finish(system, &base, Found { q: guess.q.clone(), iterations, slow: None }, guess)
        }
        Err(other) => Err(other),
    }
}

/// Takes a state as it is, if it is an equilibrium.
///
/// # Errors
/// [`LinearError::NotAnEquilibrium`] with the residual force by coordinate, and as [`equilibrium_near`].
pub fn equilibrium_here<S: System + ?Sized>(system: &S, state: &Guess) -> Result<Equilibrium, LinearError> {
    let base = LinearisationPoint::new(system, state);
    base.check(&state.q)?;
    let force = base.force(&state.q);
    if !balanced(&force, &base.measure(&state.q), GIVEN) && !holds(&base, &state.q) {
        return Err(LinearError::NotAnEquilibrium { residual: base.forces(&force) });
    }
    finish(system, &base, Found { q: state.q.clone(), iterations: 0, slow: None }, state)
}

/// True where dry friction can balance what is left at rest.
fn holds(base: &LinearisationPoint, q: &[f64]) -> bool {
    let jumps = base.jumps(q);
    let mut measure = base.measure(q);
    for jump in &jumps {
        measure.iter_mut().zip(&jump.force).for_each(|(sum, f)| *sum += f.abs());
    }
    held(&base.force(q), &jumps, &|left: &[f64]| balanced(left, &measure, GIVEN))
}

/// The different equilibria that are found from several guesses; guesses that lead nowhere are left out.
///
/// # Errors
/// Those of [`equilibrium_near`], other than [`LinearError::NoEquilibrium`].
pub fn equilibria<S: System + ?Sized>(system: &S, guesses: &[Guess]) -> Result<Vec<Equilibrium>, LinearError> {
    let mut list: Vec<Equilibrium> = Vec::new();
    for guess in guesses {
        let found = match equilibrium_near(system, guess) {
            Err(LinearError::NoEquilibrium { .. }) => continue,
            other => other?,
        };
        let near = |a: &f64, b: &f64| (a - b).abs() <= 1e-6 * (1.0 + a.abs());
        let known = |e: &Equilibrium| e.q.iter().zip(&found.q).chain(e.v.iter().zip(&found.v)).all(|(a, b)| near(a, b));
        if !list.iter().any(known) {
            list.push(found);
        }
    }
    Ok(list)
}

/// What Newton's method ends with.
struct Found {
    q: Vec<f64>,
    iterations: usize,
    slow: Option<f64>,
}

fn finish<S: System + ?Sized>(
    system: &S,
    base: &LinearisationPoint,
    found: Found,
    guess: &Guess,
) -> Result<Equilibrium, LinearError> {
    let freedom = ZeroStiffness::of(base, &found.q, system.description().structure.linear)?;
    Ok(Equilibrium {
        coordinates: base.names(),
        units: base.units(),
        residual: base.force(&found.q),
        v: base.v.clone(),
        inputs: guess.inputs.clone(),
        friction: base.jumps(&found.q),
        q: found.q,
        iterations: found.iterations,
        slow: found.slow,
        freedom,
    })
}

/// True where every force is small in its own row's measure.
fn balanced(force: &[f64], measure: &[f64], part: f64) -> bool {
    force.iter().zip(measure).all(|(f, measure)| f.abs() <= part * measure)
}

fn newton(base: &LinearisationPoint, mut q: Vec<f64>) -> Result<Found, LinearError> {
    let mut force = base.force(&q);
    let mut history = ConvergenceHistory::default();
    let mut reach: Vec<f64> = q.iter().map(|q| q.abs()).collect();
    for iterations in 0..MOST_ITERATIONS {
        if is_lost(&base.units(), &q) {
            return Err(failed(base, iterations, &q, &force));
        }
        if force.iter().all(|f| *f == 0.0) {
            return Ok(Found { q, iterations, slow: history.slow });
        }
        // A row of nothing but rounding would count like any other where rows are brought to one size.
        let [mass, _, stiffness] = base.cleaned(&q);
        let here = balanced(&force, &base.measure(&q), FOUND);
        let rows = Rows::new(&mass, &stiffness.to_dense());
        let step = rows.step(&force)?;
        let (next, next_force, factor) = shorten(base, &rows, &q, &step, &force);
        let (before, after) = (rows.size(&force), rows.size(&next_force));
        reach.iter_mut().zip(&next).for_each(|(reach, q)| *reach = reach.max(q.abs()));
        let part = |(step, reach): (&f64, &f64)| if *step == 0.0 { 0.0 } else { step.abs() / reach };
        let largest = step.iter().zip(&reach).map(part).fold(0.0, f64::max);
        history.note(rows.scaled.norm(&step), factor, largest);
        if after < before {
            (q, force) = (next, next_force);
        }
        if let Some(q) = without_rounding(base, &q, &reach) {
            return Ok(Found { q, iterations: iterations + 1, slow: history.slow });
        }
        // Rounding, or a multiple root that is near enough.
        let enough = if history.slow.is_some() { 1e-10 } else { f64::EPSILON };
        if here && (after > 0.5 * before || largest <= enough) {
            return Ok(Found { q, iterations: iterations + 1, slow: history.slow });
        }
        if after >= before {
            return Err(failed(base, iterations + 1, &q, &force));
        }
    }
    Err(failed(base, MOST_ITERATIONS, &q, &force))
}

/// The point with all coordinates that have all but vanished at 0, if it is an equilibrium.
fn without_rounding(base: &LinearisationPoint, q: &[f64], reach: &[f64]) -> Option<Vec<f64>> {
    let gone = |(q, reach): (&f64, &f64)| *q != 0.0 && q.abs() <= GONE * reach;
    if !q.iter().zip(reach).any(gone) {
        return None;
    }
    let clean: Vec<f64> = q.iter().zip(reach).map(|(q, reach)| if gone((q, reach)) { 0.0 } else { *q }).collect();
    balanced(&base.force(&clean), &base.measure(&clean), FOUND).then_some(clean)
}

/// How the lengths of steps follow each other.
#[derive(Default)]
pub(in crate::linear) struct ConvergenceHistory {
    earlier: Option<f64>,
    /// Steps in a row that shrank slowly, and steps since that shrank fast.
    slowly: u32,
    fast: u32,
    /// The ratio of slowly shrinking steps, if the search has not become fast since.
    pub slow: Option<f64>,
}

impl ConvergenceHistory {
    /// Notes a step's length, the factor by which it was shortened, and its largest part relative to its coordinate.
    pub fn note(&mut self, length: f64, factor: f64, largest: f64) {
        let ratio = self.earlier.filter(|before| *before > 0.0 && factor == 1.0).map(|before| length / before);
        self.earlier = Some(length);
        // Steps at the level of rounding tell nothing.
        let Some(ratio) = ratio.filter(|_| largest > 1e-6) else { return };
        self.slowly = if (SLOW..0.95).contains(&ratio) { self.slowly + 1 } else { 0 };
        self.fast = if ratio < 0.3 { self.fast + 1 } else { 0 };
        if self.slowly >= 5 {
            self.slow = Some(ratio);
        } else if self.fast >= 2 {
            self.slow = None;
        }
    }
}

fn failed(base: &LinearisationPoint, iterations: usize, q: &[f64], force: &[f64]) -> LinearError {
    LinearError::NoEquilibrium { iterations, point: base.named(q), residual: base.forces(force) }
}

/// K in the units of M's diagonal, its rows and columns brought to one size: so that a row of 1e-3 N/m counts beside one
/// of 1e12 N/m.
struct Rows {
    scaled: Scaled,
    matrix: DMatrix<f64>,
    rows: DVector<f64>,
    columns: DVector<f64>,
}

impl Rows {
    fn new(mass: &SparseMatrix, stiffness: &DMatrix<f64>) -> Rows {
        let scaled = Scaled::new(mass);
        let (matrix, rows, columns) = equilibrated(&scaled.stiffness(stiffness));
        Rows { scaled, matrix, rows, columns }
    }

    fn in_rows(&self, force: &[f64]) -> DVector<f64> {
        self.scaled.force(force).component_mul(&self.rows)
    }

    /// ‖F‖, each row in its own measure.
    fn size(&self, force: &[f64]) -> f64 {
        let norm = self.in_rows(force).norm();
        if norm.is_finite() { norm } else { f64::INFINITY }
    }

    /// The shortest Δq that minimises ‖K Δq + F‖.
    fn step(&self, force: &[f64]) -> Result<Vec<f64>, LinearError> {
        let wanted = -self.in_rows(force);
        let n = force.len();
        if n > LARGE {
            let lu = self.matrix.clone().lu();
            let pivots = lu.u().diagonal().abs();
            if pivots.min() > 1e-10 * pivots.max()
                && let Some(step) = lu.solve(&wanted)
            {
                return Ok(self.scaled.step(&step.component_mul(&self.columns)));
            }
        }
        let failed = LinearError::NoConvergence { what: "the singular value decomposition of K" };
        let singular = Singular::of(&self.matrix).ok_or(failed)?;
        let step = singular.least_squares(&wanted, Scaled::threshold(n, singular.values.max()));
        Ok(self.scaled.step(&step.component_mul(&self.columns)))
    }
}

/// The shortest Δq that minimises ‖K Δq + F‖.
pub fn least_step(mass: &SparseMatrix, stiffness: &DMatrix<f64>, force: &[f64]) -> Result<Vec<f64>, LinearError> {
    Rows::new(mass, stiffness).step(force)
}

/// Halves a step until F decreases; the point reached, F there, and the factor.
fn shorten(
    base: &LinearisationPoint,
    rows: &Rows,
    q: &[f64],
    step: &[f64],
    force: &[f64],
) -> (Vec<f64>, Vec<f64>, f64) {
    let before = rows.size(force);
    let first = if base.is_linear() { 1.0 } else { first_part(&base.units(), q, step) };
    let mut factor = first;
    loop {
        let next: Vec<f64> = q.iter().zip(step).map(|(q, s)| q + factor * s).collect();
        let there = base.force(&next);
        let falls = rows.size(&there) < (1.0 - 1e-4 * factor) * before;
        if (falls && !crosses_a_pole(base, q, &next)) || factor < 1e-9 * first {
            return (next, there, factor);
        }
        factor *= 0.5;
    }
}

/// True where forces rise far above those at both ends on the way: what lies behind a pole is not for this search.
fn crosses_a_pole(base: &LinearisationPoint, from: &[f64], to: &[f64]) -> bool {
    const SAMPLES: u32 = 16;
    const RISE: f64 = 30.0;
    let long = from.iter().zip(to).any(|(a, b)| (a - b).abs() > 0.05 * a.abs().max(b.abs()));
    if !long || base.is_linear() {
        return false;
    }
    let ends: Vec<f64> = base.magnitudes(from).into_iter().zip(base.magnitudes(to)).map(|(a, b)| a.max(b)).collect();
    (1..SAMPLES).any(|k| {
        let part = f64::from(k) / f64::from(SAMPLES);
        let point: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + part * (b - a)).collect();
        base.magnitudes(&point).iter().zip(&ends).any(|(there, ends)| *ends > 0.0 && *there > RISE * ends)
    })
}

impl fmt::Display for Equilibrium {
    /// `x = 0 m, theta = 3.14159 rad`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = |i: usize| self.units.get(i).map_or("", String::as_str);
        // What is rounding beside those with the same unit is 0; angles and pure numbers are measured by themselves.
        let scale = |numbers: &[f64], i: usize| {
            let alike = numbers.iter().enumerate().filter(|(j, _)| unit(*j) == unit(i));
            let least = if matches!(unit(i), "" | "1" | "rad") { 1e-3 } else { 0.0 };
            alike.fold(least, |most, (_, x)| x.abs().max(most))
        };
        for (i, name) in self.coordinates.iter().enumerate() {
            let value = short_beside(self.q[i], scale(&self.q, i));
            write!(f, "{}{name} = {value}{}", if i == 0 { "" } else { ", " }, spaced(unit(i)))?;
        }
        for (i, name) in self.coordinates.iter().enumerate().filter(|(i, _)| self.v[*i] != 0.0) {
            let per = match unit(i) {
                "" => String::new(),
                "1" => " 1/s".to_owned(),
                unit => format!(" {unit}/s"),
            };
            write!(f, ", {name}' = {}{per}", short(self.v[i]))?;
        }
        Ok(())
    }
}
