//! Pseudo-arclength continuation (Keller 1977): predict along the tangent, correct across it.

use nalgebra::{DMatrix, DVector};

use super::{Change, State, Turn};
use crate::linear::equilibrium::{Guess, Probe, equilibrium_near, linearised_at};
use crate::linear::matrices::{Scaled, Singular};
use crate::linear::{LinearError, Linearised};
use crate::matrix::equilibrated;
use crate::mechanism::System;

/// The longest step, as a part of the range (and of the coordinates' extents).
const LONGEST: f64 = 1.0 / 64.0;
/// Steps below this end the branch.
const SHORTEST: f64 = 1e-9;
/// Newton steps of one correction.
const CORRECTIONS: usize = 12;
/// States of one path.
const MOST_STATES: usize = 3000;
/// The greatest change of the tangent in one step (the cosine of it).
const TURN: f64 = 0.97;
/// Residual forces of a state of the branch, as parts of their own row's terms.
const BALANCED: f64 = 1e-11;

/// Follows equilibria of one system while one parameter changes.
pub(super) struct Walker<'a> {
    probe: Probe,
    system: Box<dyn System>,
    guess: &'a Guess,
    parameter: usize,
    pub range: (f64, f64),
}

/// What a walk ends with.
pub(super) enum End {
    /// It has left the range.
    Range,
    /// The branch could not be followed any further.
    Lost,
}

/// States in the order in which they were reached.
pub(super) struct Path {
    pub points: Vec<State>,
    pub turns: Vec<Turn>,
    pub end: End,
}

impl<'a> Walker<'a> {
    pub fn new<S: System + ?Sized>(
        system: &S,
        parameter: usize,
        range: (f64, f64),
        guess: &'a Guess,
    ) -> Result<Self, LinearError> {
        let count = system.parameters().len();
        if parameter >= count {
            return Err(LinearError::WrongSize { what: "the parameter's index", given: parameter, expected: count });
        }
        if !(range.0.is_finite() && range.1.is_finite() && range.0 < range.1) {
            return Err(LinearError::NonFinite { what: "the range of the parameter".to_owned() });
        }
        Ok(Walker { probe: Probe::new(system, guess), system: system.boxed_clone(), guess, parameter, range })
    }

    pub fn size(&self) -> usize {
        self.probe.n
    }

    pub fn width(&self) -> f64 {
        self.range.1 - self.range.0
    }

    /// M, C and K at a state.
    pub fn linearise(&self, state: &State) -> Result<Linearised, LinearError> {
        self.probe.set_parameter(self.parameter, state.value);
        self.probe.check(&state.q)?;
        linearised_at(&*self.system, &self.probe, &Guess { q: state.q.clone(), ..self.guess.clone() })
    }

    /// From one value to another, outside of the range, by equilibria that belong together.
    pub fn towards(
        &self,
        from: f64,
        to: f64,
        mut q: Vec<f64>,
        changes: &mut Vec<Change>,
    ) -> Result<Vec<f64>, LinearError> {
        let mut value = from;
        let mut step = (to - from) / 20.0;
        while value != to {
            let next = if (to - value).abs() <= step.abs() { to } else { value + step };
            match self.at(next, &q) {
                Some(found) => (value, q) = (next, found),
                None if step.abs() > 1e-6 * (to - from).abs() => step *= 0.5,
                None => {
                    // The branch ends on the way.
                    let found = self.search(to, &q)?;
                    changes.push(Change { value, from: q, to: found.clone() });
                    return Ok(found);
                }
            }
        }
        Ok(q)
    }

    /// The equilibrium at a value that belongs to a state near by: by Newton steps that stay near.
    fn at(&self, value: f64, q: &[f64]) -> Option<Vec<f64>> {
        let mut direction = vec![0.0; q.len() + 1];
        direction[q.len()] = 1.0;
        let state = State { q: q.to_vec(), value };
        self.correct(&state, &direction).map(|found| found.q)
    }

    fn search(&self, value: f64, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let mut system = self.system.boxed_clone();
        system.set_parameter(self.parameter, value);
        Ok(equilibrium_near(&*system, &Guess { q: q.to_vec(), ..self.guess.clone() })?.q)
    }

    /// Another branch, a little beyond the end of one.
    pub fn another(&self, end: &State, direction: f64) -> Result<(f64, Vec<f64>), LinearError> {
        let (low, high) = self.range;
        let value = (end.value + 1e-6 * direction * self.width()).clamp(low, high);
        Ok((value, self.search(value, &end.q)?))
    }

    /// Follows the branch from a state until it leaves the range.
    pub fn walk(&self, value: f64, q: &[f64], direction: f64) -> Result<Path, LinearError> {
        let n = q.len();
        let start = State { q: q.to_vec(), value };
        let mut reach: Vec<f64> = q.iter().map(|q| q.abs()).collect();
        let mut along = vec![0.0; n + 1];
        along[n] = direction;
        let mut tangent = self.tangent(&start, &along, &self.units(&reach)).unwrap_or(along);
        for (reach, slope) in reach.iter_mut().zip(&tangent) {
            // What the coordinate is going to do belongs to its size.
            let whole = slope.abs() / tangent[n].abs().max(1e-9) * self.width();
            *reach = reach.max(whole.min(1e3 * *reach + whole));
        }
        let mut units = self.units(&reach);
        tangent = self.tangent(&start, &tangent, &units).unwrap_or(tangent);
        let mut path = Path { points: vec![start], turns: Vec::new(), end: End::Lost };
        let mut step = LONGEST;
        while path.points.len() < MOST_STATES && path.turns.len() < 8 {
            let here = &path.points[path.points.len() - 1];
            let tried = self.step(here, &tangent, &units, step);
            let Some((next, next_tangent)) = tried else {
                step *= 0.5;
                if step < SHORTEST {
                    return Ok(path);
                }
                continue;
            };
            if !(self.range.0..=self.range.1).contains(&next.value) {
                let bound = if next.value > self.range.1 { self.range.1 } else { self.range.0 };
                let part =
                    if next.value == here.value { 0.0 } else { (bound - here.value) / (next.value - here.value) };
                let guess: Vec<f64> = here.q.iter().zip(&next.q).map(|(a, b)| a + part * (b - a)).collect();
                let Some(q) = self.at(bound, &guess) else {
                    step *= 0.5;
                    if step < SHORTEST {
                        return Ok(path);
                    }
                    continue;
                };
                path.points.push(State { q, value: bound });
                path.end = End::Range;
                return Ok(path);
            }
            if tangent[n] * next_tangent[n] < 0.0
                && let Some(at) = self.fold(here, &next, tangent[n], &units)
            {
                let mirrored = self.is_bifurcation(&at, tangent[n], &units);
                path.turns.push(Turn { at, index: path.points.len(), mirrored });
            }
            reach.iter_mut().zip(&next.q).for_each(|(reach, q)| *reach = reach.max(q.abs()));
            units = self.units(&reach);
            path.points.push(next);
            let last = &path.points[path.points.len() - 1];
            tangent = self.tangent(last, &next_tangent, &units).unwrap_or(next_tangent);
            step = (1.5 * step).min(LONGEST);
        }
        Ok(path)
    }

    /// What each coordinate, and the parameter, is measured in.
    fn units(&self, reach: &[f64]) -> Vec<f64> {
        let largest = reach.iter().fold(0.0_f64, |most, reach| most.max(*reach));
        let whole = if largest > 0.0 { largest } else { 1.0 };
        let each = |reach: &f64| if *reach > 1e-6 * whole { *reach } else { whole };
        reach.iter().map(each).chain([self.width()]).collect()
    }

    fn step(&self, here: &State, tangent: &[f64], units: &[f64], step: f64) -> Option<(State, Vec<f64>)> {
        let n = here.q.len();
        let guess = State {
            q: here.q.iter().zip(tangent).map(|(q, t)| q + step * t).collect(),
            value: here.value + step * tangent[n],
        };
        let across: Vec<f64> = tangent.iter().zip(units).map(|(t, unit)| t / (unit * unit)).collect();
        let next = self.correct(&guess, &across)?;
        // A correction as long as the step leads to another branch.
        let apart = |a: &State, b: &State| -> f64 {
            let q = a.q.iter().zip(&b.q).zip(units).map(|((a, b), unit)| ((a - b) / unit).powi(2)).sum::<f64>();
            (q + ((a.value - b.value) / units[n]).powi(2)).sqrt()
        };
        if apart(&guess, &next) > 0.3 * step {
            return None;
        }
        let next_tangent = self.tangent(&next, tangent, units)?;
        let cosine: f64 =
            tangent.iter().zip(&next_tangent).zip(units).map(|((a, b), unit)| a * b / (unit * unit)).sum();
        (cosine > TURN).then_some((next, next_tangent))
    }

    /// Newton's method for F(q, p) = 0 on the plane through a guess, across a direction.
    fn correct(&self, guess: &State, across: &[f64]) -> Option<State> {
        let n = guess.q.len();
        let mut state = guess.clone();
        let mut before = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            self.probe.set_parameter(self.parameter, state.value);
            let force = self.probe.force(&state.q);
            if force.iter().any(|f| !f.is_finite()) {
                return None;
            }
            let measure = self.probe.measure(&state.q);
            let left = force.iter().zip(&measure).map(|(f, m)| if *f == 0.0 { 0.0 } else { f.abs() / m });
            let left = left.fold(0.0, f64::max);
            // To rounding, as far as steps still help.
            if left == 0.0 || (left <= BALANCED && left > 0.25 * before) {
                return Some(state);
            }
            before = left;
            let mut wanted: Vec<f64> = force.iter().map(|f| -f).collect();
            let gone: f64 = across[..n].iter().zip(state.q.iter().zip(&guess.q)).map(|(a, (q, g))| a * (q - g)).sum();
            wanted.push(-gone - across[n] * (state.value - guess.value));
            let change = self.solve(&state, across, &wanted)?;
            state.q.iter_mut().zip(&change).for_each(|(q, change)| *q += change);
            state.value += change[n];
        }
        (before <= BALANCED).then_some(state)
    }

    /// The direction of the branch, of unit length, that goes on from another one.
    fn tangent(&self, state: &State, along: &[f64], units: &[f64]) -> Option<Vec<f64>> {
        let n = state.q.len();
        let across: Vec<f64> = along.iter().zip(units).map(|(t, unit)| t / (unit * unit)).collect();
        let mut wanted = vec![0.0; n + 1];
        wanted[n] = 1.0;
        let tangent = self.solve(state, &across, &wanted)?;
        let length = tangent.iter().zip(units).map(|(t, unit)| (t / unit).powi(2)).sum::<f64>().sqrt();
        (length > 0.0 && length.is_finite()).then(|| tangent.iter().map(|t| t / length).collect())
    }

    /// x of [K, ∂F/∂p; across] x = wanted, the shortest where directions are free.
    fn solve(&self, state: &State, across: &[f64], wanted: &[f64]) -> Option<Vec<f64>> {
        let n = state.q.len();
        let slope = self.slope(state);
        self.probe.set_parameter(self.parameter, state.value);
        let stiffness = self.probe.stiffness(&state.q);
        let matrix = DMatrix::from_fn(n + 1, n + 1, |i, j| match (i < n, j < n) {
            (true, true) => stiffness[(i, j)],
            (true, false) => slope[i],
            (false, _) => across[j],
        });
        let (scaled, rows, columns) = equilibrated(&matrix);
        let right = DVector::from_column_slice(wanted).component_mul(&rows);
        let singular = Singular::of(&scaled)?;
        let found = singular.least_squares(&right, Scaled::threshold(n + 1, singular.values.max()));
        let found = found.component_mul(&columns);
        found.iter().all(|x| x.is_finite()).then(|| found.as_slice().to_vec())
    }

    /// ∂F/∂p by a central difference: it steers, and no result depends on it.
    fn slope(&self, state: &State) -> Vec<f64> {
        let step = 1e-6 * state.value.abs().max(1e-3 * self.width());
        let force = |value: f64| {
            self.probe.set_parameter(self.parameter, value);
            self.probe.force(&state.q)
        };
        let (high, low) = (force(state.value + step), force(state.value - step));
        high.iter().zip(&low).map(|(a, b)| 0.5 * (a - b) / step).map(|x| if x.is_finite() { x } else { 0.0 }).collect()
    }

    /// The state of the branch between two of its states, at a part of the way.
    pub fn between(&self, a: &State, b: &State, part: f64) -> Option<State> {
        let mix = |a: f64, b: f64| a + part * (b - a);
        let guess = State { q: a.q.iter().zip(&b.q).map(|(a, b)| mix(*a, *b)).collect(), value: mix(a.value, b.value) };
        let chord: Vec<f64> = a.q.iter().zip(&b.q).map(|(a, b)| b - a).chain([b.value - a.value]).collect();
        let unit = |x: f64, of: f64| if of > 0.0 { x / (of * of) } else { 0.0 };
        let extent = |a: f64, b: f64| a.abs().max(b.abs());
        let mut across: Vec<f64> =
            a.q.iter().zip(&b.q).zip(&chord).map(|((a, b), c)| unit(*c, extent(*a, *b))).collect();
        across.push(unit(b.value - a.value, self.width()));
        if across.iter().all(|x| *x == 0.0) {
            return None;
        }
        self.correct(&guess, &across)
    }

    /// The state where the parameter stands still between two states.
    fn fold(&self, a: &State, b: &State, sign: f64, units: &[f64]) -> Option<State> {
        let n = a.q.len();
        let chord: Vec<f64> = a.q.iter().zip(&b.q).map(|(a, b)| b - a).chain([b.value - a.value]).collect();
        let (mut low, mut high) = (0.0, 1.0);
        let mut at = None;
        for _ in 0..48 {
            let middle = 0.5 * (low + high);
            // Where branches cross, no direction is left in the end; by then the place is known.
            let Some(state) = self.between(a, b, middle) else { break };
            let Some(tangent) = self.tangent(&state, &chord, units) else { break };
            if tangent[n] * sign > 0.0 {
                low = middle
            } else {
                high = middle
            }
            at = Some(state);
        }
        at
    }

    /// True where a little beyond the fold there is an equilibrium near by: another branch passes through it.
    fn is_bifurcation(&self, at: &State, direction: f64, units: &[f64]) -> bool {
        let beyond = at.value + 1e-4 * direction.signum() * self.width();
        let Ok(found) = self.search(beyond, &at.q) else { return false };
        found.iter().zip(&at.q).zip(units).all(|((a, b), unit)| (a - b).abs() <= 0.01 * unit)
    }
}
