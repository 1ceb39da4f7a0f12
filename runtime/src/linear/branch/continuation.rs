//! Pseudo-arclength continuation (Keller 1977): predict along the tangent, correct across it.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};

use super::balance::{Balance, Slopes};
use super::sheets::Cover;
use super::spectrum::Spectrum;
use super::{State, TurningPoint};
use crate::linear::LinearError;
use crate::linear::matrices::{Scaled, Singular, natural_sizes};
use crate::matrix::equilibrated;

/// The longest step, as a part of the range (and of the coordinates' extents).
const LONGEST: f64 = 1.0 / 64.0;
/// A coordinate is measured by no less than this part of what it has been: beside less its slope, where it touches 0, is rounding.
const LEAST: f64 = 1e-4;
/// Steps below this end the branch.
const SHORTEST: f64 = 1e-9;
/// Newton steps of one correction.
const CORRECTIONS: usize = 12;
/// States of one path: some hundred folds, and poles whose coordinates grow by thirty powers of ten, take fewer.
const MOST_STATES: usize = 10_000;
/// A walk is lost where so many steps together are no longer than one may be.
const CRAWLS: usize = 300;
/// A branch goes to infinity where coordinates that have grown by a factor grow on by another, while the parameter moves by less
/// than a part of the range.
const GROWN: f64 = 4.0;
/// The factor by which they grow on in one step: beside a pole steps grow with the coordinates, at a fold these stay.
const GROWS_ON: f64 = 1.25;
/// The part of the range by which the parameter moves meanwhile: what it moves by rounding is far less, by a step far more.
const STANDS_STILL: f64 = 1e-10;
/// A closed branch is back at its start where it passes it by less than this part of its last step.
const BACK: f64 = 1e-3;
/// States between two beside a bifurcation through which the branch is laid.
const NODES: u32 = 8;
/// Coordinates there are known to this part of those beside it.
const INTERPOLATED: f64 = 1e-8;
/// The greatest change of the tangent in one step (the cosine of it).
const TURN: f64 = 0.97;
/// What is left of the equations at a state of the branch, as parts of their own row's terms.
const BALANCED: f64 = 1e-11;
/// How far apart, in the coordinates' extents and the range, states on both sides of a crossing of branches are looked at: nearer, what
/// rounding makes of them, ε by this, may lead from one branch to the other.
const BESIDE: f64 = 1e-6;
/// Differences of steps one of which is so many times the other are slopes where they agree but for this part: the error of a difference falls with
/// the square of its step, so that it is a fifteenth of that part, and a slope only steers.
const FINER: f64 = 4.0;
const AGREES: f64 = 0.125;
/// What the equations' own rounding may leave, as such parts.
const ROUNDED: f64 = 4.0 * f64::EPSILON;

/// Coordinates below this part of their natural size are rounding.
const ROUNDING: f64 = 1e-15;

/// Singular values below this part of the largest are those of directions in which all states are solutions.
const FREE: f64 = 1e-9;

/// Follows solutions of equations while one parameter changes.
pub(super) struct Continuation {
    balance: RefCell<Box<dyn Balance>>,
    family: RefCell<Option<Family>>,
    /// Units of the coordinates.
    names: Vec<String>,
    pub range: (f64, f64),
}

/// Solutions that come in families, as those of what may turn freely: a walk goes across the directions in which nothing changes,
/// though near a solution there is some stiffness in them, which the forces left over make.
struct Family {
    /// How many directions there are.
    count: usize,
    /// What coordinates and multipliers, and the parameter, are measured in.
    sizes: DVector<f64>,
}

/// What a walk ends with.
pub(super) enum End {
    /// It has left the range.
    Range,
    /// It is back at its start.
    Closed,
    /// It goes to infinity at a value, by a coordinate before all.
    Pole { value: f64, coordinate: usize },
    /// The branch could not be followed any further.
    Lost,
}

/// States in the order in which they were reached.
pub(super) struct Path {
    pub points: Vec<State>,
    pub turning_points: Vec<TurningPoint>,
    pub end: End,
    /// What the branch had reached before, for each sheet of it; those that are not in order yet have nothing.
    pub before: Vec<Cover>,
}

impl Path {
    /// States with the least and largest values are among these.
    pub fn ends(&self) -> impl Iterator<Item = State> {
        let pole = match self.end {
            End::Pole { value, .. } => self.points.last().map(|last| State { value, q: last.q.clone() }),
            _ => None,
        };
        let last = self.points.first().into_iter().chain(self.points.last());
        last.cloned().chain(self.turning_points.iter().map(|turn| turn.at.clone())).chain(pole)
    }
}

impl Continuation {
    pub fn new(balance: Box<dyn Balance>, range: (f64, f64)) -> Result<Self, LinearError> {
        if !(range.0.is_finite() && range.1.is_finite() && range.0 < range.1) {
            return Err(LinearError::NonFinite { what: "the range of the parameter".to_owned() });
        }
        let names = balance.units();
        Ok(Continuation { balance: RefCell::new(balance), family: RefCell::new(None), names, range })
    }

    pub fn size(&self) -> usize {
        self.names.len()
    }

    pub fn width(&self) -> f64 {
        self.range.1 - self.range.0
    }

    /// Asks the equations at a value of the parameter.
    fn ask<T>(&self, value: f64, question: impl FnOnce(&dyn Balance) -> T) -> T {
        let mut balance = self.balance.borrow_mut();
        balance.set(value);
        question(&**balance)
    }

    /// Small motions about a state.
    pub fn spectrum(&self, state: &State) -> Result<Spectrum, LinearError> {
        self.ask(state.value, |balance| balance.spectrum(&state.q))
    }

    /// As [`Balance::note_zeros`], of some states of the branch.
    pub fn note_zeros<'a>(&self, states: impl Iterator<Item = (f64, &'a [f64])>) {
        let mut balance = self.balance.borrow_mut();
        for (value, q) in states {
            balance.set(value);
            balance.note_zeros(q);
        }
    }

    /// As [`Balance::jacobian`].
    pub fn jacobian(&self, state: &State) -> Option<DMatrix<f64>> {
        self.ask(state.value, |balance| balance.jacobian(&state.q))
    }

    /// As [`Balance::row`].
    pub fn row(&self, index: usize) -> Option<String> {
        self.balance.borrow().row(index)
    }

    /// From one value to another, outside of the range, by solutions that belong together; and where the branch ends on the
    /// way, from where it had to be left.
    pub fn towards(&self, from: f64, to: f64, mut q: Vec<f64>) -> Result<(Vec<f64>, Option<State>), LinearError> {
        let mut value = from;
        let mut step = (to - from) / 20.0;
        while value != to {
            let next = if (to - value).abs() <= step.abs() { to } else { value + step };
            match self.at(next, &q) {
                Some(found) => (value, q) = (next, found),
                None if step.abs() > 1e-6 * (to - from).abs() => step *= 0.5,
                None => {
                    let found = self.search(to, &q)?;
                    return Ok((found, Some(State { q, value })));
                }
            }
        }
        Ok((q, None))
    }

    /// The solution at a value that belongs to a state near by: by Newton steps that stay near.
    fn at(&self, value: f64, q: &[f64]) -> Option<Vec<f64>> {
        let mut direction = vec![0.0; q.len() + 1];
        direction[q.len()] = 1.0;
        let state = State { q: q.to_vec(), value };
        self.correct(&state, &direction).map(|found| found.q)
    }

    /// The solution at a value that a search from a state finds, near or not.
    pub fn search(&self, value: f64, q: &[f64]) -> Result<Vec<f64>, LinearError> {
        let found = self.ask(value, |balance| balance.search(q))?;
        // As exact as the states that follow, what is 0 exactly so.
        Ok(self.at(value, &found).unwrap_or(found))
    }

    /// Another branch, a little beyond the end of one.
    pub fn another(&self, end: &State, direction: f64) -> Result<State, LinearError> {
        let (low, high) = self.range;
        let value = (end.value + 1e-6 * direction * self.width()).clamp(low, high);
        Ok(State { q: self.search(value, &end.q)?, value })
    }

    /// Follows the branch from a state until it leaves the range.
    pub fn walk(&self, start: &State, direction: f64) -> Path {
        self.walk_in(self.range, start, direction)
    }

    /// Where a path that has left the range comes back to it, at the same bound, if it does no farther outside than the range is wide.
    pub fn back_from_outside(&self, path: &Path) -> Option<State> {
        let last = path.points.last().filter(|_| matches!(path.end, End::Range))?;
        let (low, high) = self.range;
        let out = if last.value == high { 1.0 } else { -1.0 };
        let outside = if out > 0.0 { (high, high + self.width()) } else { (low - self.width(), low) };
        let there = self.walk_in(outside, last, out);
        let back = there.points.last().filter(|_| matches!(there.end, End::Range))?;
        (back.value == last.value).then(|| back.clone())
    }

    fn walk_in(&self, range: (f64, f64), start: &State, direction: f64) -> Path {
        let path = self.walk_on(range, start, direction);
        let Some(family) = self.family_of(start).filter(|_| matches!(path.end, End::Lost)) else { return path };
        self.family.replace(Some(family));
        let across = self.walk_on(range, start, direction);
        self.family.replace(None);
        // A start where branches cross is none of a family.
        let way = |path: &Path| path.points.last().map_or(0.0, |last| (last.value - start.value).abs());
        if way(&across) > way(&path) { across } else { path }
    }

    /// The family of solutions that a state belongs to.
    fn family_of(&self, state: &State) -> Option<Family> {
        let n = state.q.len();
        let units = self.units(&state.q.iter().map(|q| q.abs()).collect::<Vec<_>>());
        let Slopes { matrix, .. } = self.ask(state.value, |balance| balance.slopes(&state.q));
        let (scaled, _, by_column) = equilibrated(&matrix);
        let values = Singular::of(&scaled)?.values;
        let least = FREE * values.max();
        let count = values.iter().filter(|value| **value <= least).count();
        let all = matrix.ncols();
        let size = |k: usize| match k {
            _ if k < n => units[k],
            _ if k < all => by_column[k],
            _ => self.width(),
        };
        (count > 0).then(|| Family { count, sizes: DVector::from_fn(all + 1, |k, _| size(k)) })
    }

    fn walk_on(&self, range: (f64, f64), start: &State, direction: f64) -> Path {
        let n = start.q.len();
        let mut been: Vec<f64> = start.q.iter().map(|q| q.abs()).collect();
        let mut reach = been.clone();
        let (mut tangent, mut units) = self.first_tangent(start, direction, &mut reach);
        let first = (tangent.clone(), units.clone());
        let mut path =
            Path { points: vec![start.clone()], turning_points: Vec::new(), end: End::Lost, before: Vec::new() };
        let mut step = LONGEST;
        let mut way = vec![0.0];
        let crawls = |way: &[f64]| way.len() > CRAWLS && way[way.len() - 1] - way[way.len() - 1 - CRAWLS] < LONGEST;
        while path.points.len() < MOST_STATES && !crawls(&way) {
            let here = &path.points[path.points.len() - 1];
            let tried = self.step(here, &tangent, &units, step);
            let Some((mut next, mut next_tangent)) = tried else {
                step *= 0.5;
                if step < SHORTEST {
                    return path;
                }
                continue;
            };
            if self.is_back([start, here, &next], [&first.0, &next_tangent], &units) {
                (next, next_tangent) = (start.clone(), first.0.clone());
                path.end = End::Closed;
            }
            if !(range.0..=range.1).contains(&next.value) {
                let Some(last) = self.at_bound(range, here, &next) else {
                    step *= 0.5;
                    if step < SHORTEST {
                        return path;
                    }
                    continue;
                };
                path.points.push(last);
                path.end = End::Range;
                return path;
            }
            let turns = tangent[n] * next_tangent[n] < 0.0;
            if let Some((at, mirrored)) = turns.then(|| self.turning_point(here, &next, tangent[n], &units)).flatten() {
                path.turning_points.push(TurningPoint { at, index: path.points.len(), mirrored });
            }
            for most in [&mut reach, &mut been] {
                most.iter_mut().zip(&next.q).for_each(|(most, q)| *most = most.max(q.abs()));
            }
            units = self.units(&self.extents(&next, &next_tangent, [&reach, &been]));
            path.points.push(next);
            if let Some((value, coordinate)) = self.pole(&path.points, &first.1) {
                self.end_at_pole(&mut path, value, coordinate);
            }
            if !matches!(path.end, End::Lost) {
                return path;
            }
            let last = &path.points[path.points.len() - 1];
            tangent = self.tangent(last, &next_tangent, &units).unwrap_or(next_tangent);
            way.push(way[way.len() - 1] + step);
            step = (1.5 * step).min(LONGEST);
        }
        path
    }

    /// The tangent with which a path leaves its start, and the units in which it is measured there; how far each coordinate is going to go
    /// belongs to its `reach`.
    fn first_tangent(&self, start: &State, direction: f64, reach: &mut [f64]) -> (Vec<f64>, Vec<f64>) {
        let n = start.q.len();
        let mut along = vec![0.0; n + 1];
        along[n] = direction;
        let tangent = self.tangent(start, &along, &self.units(reach)).unwrap_or(along);
        for (reach, slope) in reach.iter_mut().zip(&tangent) {
            let whole = slope.abs() / tangent[n].abs().max(1e-9) * self.width();
            *reach = reach.max(whole);
        }
        let units = self.units(reach);
        (self.tangent(start, &tangent, &units).unwrap_or(tangent), units)
    }

    /// The state on the bound of a range of the parameter that a step leaves.
    fn at_bound(&self, range: (f64, f64), here: &State, next: &State) -> Option<State> {
        let bound = if next.value > range.1 { range.1 } else { range.0 };
        let part = if next.value == here.value { 0.0 } else { (bound - here.value) / (next.value - here.value) };
        let guess: Vec<f64> = here.q.iter().zip(&next.q).map(|(a, b)| a + part * (b - a)).collect();
        self.at(bound, &guess).map(|q| State { q, value: bound })
    }

    /// Where the parameter turns back between two states, and whether that is a bifurcation of a mirrored path.
    fn turning_point(&self, here: &State, next: &State, slope: f64, units: &[f64]) -> Option<(State, bool)> {
        let at = self.fold(here, next, slope, units)?;
        let mirrored = self.is_bifurcation(&at, slope, units);
        let at = if mirrored { self.standstill(here, next, slope).unwrap_or(at) } else { at };
        Some((at, mirrored))
    }

    /// Ends a path at a pole, before the states beside it: where the parameter stands still, what seems to change is rounding.
    fn end_at_pole(&self, path: &mut Path, value: f64, coordinate: usize) {
        path.end = End::Pole { value, coordinate };
        let near = |state: &State| (state.value - value).abs() <= STANDS_STILL * self.width();
        let all = path.points.len();
        let left = all - path.points[1..].iter().rev().take_while(|state| near(state)).count();
        path.points.truncate(left);
        path.turning_points.retain(|turn| turn.index < left);
    }

    /// How large each coordinate is: what it is, or what it goes through over the whole range at its present slope, at most its reach; at
    /// least a part of what it has been.  So what comes back from infinity is measured by what it has become, and no other pole is
    /// stepped over.
    fn extents(&self, state: &State, tangent: &[f64], [reach, been]: [&[f64]; 2]) -> Vec<f64> {
        let n = state.q.len();
        let extent = |i: usize| {
            let whole = (tangent[i] / tangent[n]).abs() * self.width();
            // At a fold the slope is infinite or no number.
            state.q[i].abs().max(whole.min(reach[i])).max(LEAST * been[i])
        };
        (0..n).map(extent).collect()
    }

    /// Whether a step passes the start of a path again, in the direction in which that went.
    fn is_back(&self, [start, here, next]: [&State; 3], [first, tangent]: [&[f64]; 2], units: &[f64]) -> bool {
        let from = |state: &State| -> Vec<f64> {
            let whole = |state: &State| state.q.iter().copied().chain([state.value]).collect::<Vec<f64>>();
            let parts = whole(state).into_iter().zip(whole(here)).zip(units);
            parts.map(|((a, b), unit)| (a - b) / unit).collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (chord, way) = (from(next), from(start));
        let square = dot(&chord, &chord);
        let part = dot(&way, &chord) / square;
        let same = first.iter().zip(tangent).zip(units).map(|((a, b), unit)| a * b / (unit * unit)).sum::<f64>() > 0.0;
        // No farther aside than a bend of the step.
        let near = dot(&way, &way) - part * part * square <= 0.04 * square;
        if !(same && near && part > 0.0 && part <= 1.0) {
            return false;
        }
        let Some(there) = self.between(here, next, part) else { return false };
        let apart: Vec<f64> = from(&there).iter().zip(&way).map(|(a, b)| a - b).collect();
        dot(&apart, &apart).sqrt() <= BACK * square.sqrt()
    }

    /// The value of the pole that a path comes near to, if it does, and the coordinate; `units` are those at its start.
    fn pole(&self, points: &[State], units: &[f64]) -> Option<(f64, usize)> {
        let part = |state: &State, i: usize| (state.q[i] / units[i]).abs();
        let size = |state: &State| (0..state.q.len()).map(|i| part(state, i)).fold(1.0, f64::max);
        let last = points.last()?;
        let largest = size(last);
        let before = points.iter().rposition(|state| size(state) * GROWS_ON <= largest)?;
        let back = points.len() - 1 - before;
        let (middle, still) = (&points[before], STANDS_STILL * self.width());
        let coordinate = (0..last.q.len()).max_by(|a, b| part(last, *a).total_cmp(&part(last, *b)))?;
        if largest < GROWN || (last.value - middle.value).abs() > still {
            return None;
        }
        // Where coordinates grow by equal factors, what is left of the way shrinks by equal factors (Aitken).
        let [there, on] = [middle.value - points[before.checked_sub(back)?].value, last.value - middle.value];
        let left = on * on / (there - on);
        let value = if left.abs() <= 1e3 * still { last.value + left } else { last.value };
        Some((value, coordinate))
    }

    /// How far two states are apart, in parts of their extents and of the range.
    pub fn distance(&self, a: &State, b: &State) -> f64 {
        let extent: Vec<f64> = a.q.iter().zip(&b.q).map(|(a, b)| a.abs().max(b.abs())).collect();
        let units = self.units(&extent);
        let q = a.q.iter().zip(&b.q).zip(&units).map(|((a, b), unit)| ((a - b) / unit).powi(2)).sum::<f64>();
        (q + ((a.value - b.value) / units[a.q.len()]).powi(2)).sqrt()
    }

    /// What each coordinate, and the parameter, is measured in.
    pub fn units(&self, reach: &[f64]) -> Vec<f64> {
        let each = |(reach, whole): (&f64, f64)| if *reach > 1e-6 * whole { *reach } else { whole };
        reach.iter().zip(natural_sizes(&self.names, reach)).map(each).chain([self.width()]).collect()
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
        (cosine > TURN && !self.leaps(here, &next, units)).then_some((next, next_tangent))
    }

    /// Whether two states lie on branches that pass each other: the determinant of the equations and of what is across the way keeps its sign
    /// along a branch, but for crossings, at which the states on both sides come together.
    fn leaps(&self, here: &State, next: &State, units: &[f64]) -> bool {
        let way = |a: &State, b: &State| -> Vec<f64> {
            let q = a.q.iter().zip(&b.q).map(|(a, b)| b - a);
            q.chain([b.value - a.value]).zip(units).map(|(way, unit)| way / unit).collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let chord = way(here, next);
        let length = dot(&chord, &chord).sqrt();
        let across: Vec<f64> = chord.iter().zip(units).map(|(chord, unit)| chord / unit).collect();
        let sense = |state: &State| self.sense(state, &across);
        let before = sense(here);
        if before * sense(next) >= 0.0 {
            return false;
        }
        let (mut low, mut high) = (here.clone(), next.clone());
        // No more halvings than a number has digits.
        for _ in 0..f64::MANTISSA_DIGITS {
            let apart = way(&low, &high);
            let along = dot(&apart, &chord) / length;
            if along <= TURN * dot(&apart, &apart).sqrt() {
                return true;
            }
            if along <= BESIDE {
                return false;
            }
            let q = low.q.iter().zip(&high.q).map(|(a, b)| 0.5 * (a + b)).collect();
            let halfway = State { q, value: 0.5 * (low.value + high.value) };
            // Where no state is between them the branch goes elsewhere.
            let Some(middle) = self.correct(&halfway, &across) else { return true };
            match sense(&middle) * before {
                sign if sign > 0.0 => low = middle,
                sign if sign < 0.0 => high = middle,
                _ => return false,
            }
        }
        false
    }

    /// The sign of the determinant of the equations' slopes with a direction below them; 0 where it is rounding.
    fn sense(&self, state: &State, across: &[f64]) -> f64 {
        let (scaled, ..) = equilibrated(&self.bordered(state, across).0);
        let size = scaled.nrows();
        let lu = scaled.lu();
        let pivots = lu.u().diagonal();
        if pivots.amin() > Scaled::threshold(size, pivots.amax()) {
            pivots.iter().map(|pivot| pivot.signum()).product::<f64>() * lu.p().determinant::<f64>()
        } else {
            0.0
        }
    }

    /// Newton's method for the equations on the plane through a guess, across a direction.
    fn correct(&self, guess: &State, across: &[f64]) -> Option<State> {
        let n = guess.q.len();
        let mut state = guess.clone();
        let mut earlier = guess.clone();
        let mut before = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            if let Some(clean) = self.without_rounding(&state).filter(|clean| self.left(clean).1 <= ROUNDED) {
                return Some(clean);
            }
            let (left, largest) = self.left(&state);
            if !largest.is_finite() {
                return None;
            }
            // To rounding, as far as steps still help; a step that only shakes what is rounding is not taken.
            if largest == 0.0 || (largest <= BALANCED && largest > 0.25 * before) {
                let found = if before <= ROUNDED { earlier } else { state };
                return Some(self.without_rounding(&found).unwrap_or(found));
            }
            if largest > 0.25 * before && self.is_as_exact_as_its_value(&state, &left) {
                return Some(state);
            }
            earlier.clone_from(&state);
            before = largest;
            let gone: f64 = across[..n].iter().zip(state.q.iter().zip(&guess.q)).map(|(a, (q, g))| a * (q - g)).sum();
            let change = self.solve(&state, across, &-left, -gone - across[n] * (state.value - guess.value))?;
            state.q.iter_mut().zip(&change).for_each(|(q, change)| *q += change);
            state.value += change[n];
        }
        (before <= BALANCED).then_some(state)
    }

    /// Whether no more is left of the equations than rounding of the parameter makes: beside a pole of what forces that is more than rounding of their
    /// terms.
    fn is_as_exact_as_its_value(&self, state: &State, left: &DVector<f64>) -> bool {
        let Ok(slope) = self.slope_or_jump(state) else { return false };
        let measure = self.ask(state.value, |balance| balance.left(&state.q))[1].clone();
        let enough = |k: usize| left[k].abs() <= BALANCED * measure[k] + ROUNDED * (slope[k] * state.value).abs();
        (0..left.len()).all(enough)
    }

    /// What is left of the equations, and the largest part of it in its own row's measure.
    fn left(&self, state: &State) -> (DVector<f64>, f64) {
        let [left, measure] = self.ask(state.value, |balance| balance.left(&state.q));
        let parts = left.iter().zip(measure.iter()).map(|(x, m)| if *x == 0.0 { 0.0 } else { x.abs() / m });
        let largest = parts.fold(0.0, |most, part| if part <= most { most } else { part });
        (left, largest)
    }

    /// The state with all coordinates at 0 that are rounding beside those with their unit, or beside all where these are, if the
    /// equations hold there too.
    fn without_rounding(&self, state: &State) -> Option<State> {
        let scales = natural_sizes(&self.names, &state.q);
        let gone = |q: f64, scale: f64| q != 0.0 && q.abs() <= ROUNDING * scale;
        if !state.q.iter().zip(&scales).any(|(q, scale)| gone(*q, *scale)) {
            return None;
        }
        let q = state.q.iter().zip(&scales).map(|(q, scale)| if gone(*q, *scale) { 0.0 } else { *q }).collect();
        let clean = State { q, value: state.value };
        (self.left(&clean).1 <= BALANCED).then_some(clean)
    }

    /// The direction of the branch, of unit length, that goes on from another one.
    fn tangent(&self, state: &State, along: &[f64], units: &[f64]) -> Option<Vec<f64>> {
        let across: Vec<f64> = along.iter().zip(units).map(|(t, unit)| t / (unit * unit)).collect();
        let level = self.ask(state.value, |balance| balance.left(&state.q)[0].map(|_| 0.0));
        let tangent = self.solve(state, &across, &level, 1.0)?;
        let length = tangent.iter().zip(units).map(|(t, unit)| (t / unit).powi(2)).sum::<f64>().sqrt();
        (length > 0.0 && length.is_finite()).then(|| tangent.iter().map(|t| t / length).collect())
    }

    /// The shortest (q, p) of [slopes, ∂/∂p; across] (q, …, p) = (wanted, along).
    fn solve(&self, state: &State, across: &[f64], wanted: &DVector<f64>, along: f64) -> Option<Vec<f64>> {
        let n = state.q.len();
        let (matrix, factors) = self.bordered(state, across);
        let all = factors.len();
        let mut right = wanted.component_mul(&factors).resize_vertically(all + 1, 0.0);
        right[all] = along;
        let found = match &*self.family.borrow() {
            Some(family) => family.across(matrix, right)?,
            None => {
                let (scaled, by_row, by_column) = equilibrated(&matrix);
                let singular = Singular::of(&scaled)?;
                let threshold = Scaled::threshold(all + 1, singular.values.max());
                singular.refined(&scaled, &right.component_mul(&by_row), threshold).component_mul(&by_column)
            }
        };
        let whole = found.iter().take(n).chain([&found[all]]).copied().collect::<Vec<f64>>();
        whole.iter().all(|x| x.is_finite()).then_some(whole)
    }

    /// [slopes, ∂/∂p; across], and the factors of the equations' rows.
    fn bordered(&self, state: &State, across: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
        let n = state.q.len();
        let Slopes { matrix, rows: factors } = self.ask(state.value, |balance| balance.slopes(&state.q));
        let all = factors.len();
        let mut matrix = matrix.resize(all + 1, all + 1, 0.0);
        matrix.view_mut((0, all), (all, 1)).copy_from(&self.slope(state).component_mul(&factors));
        // What no equation depends on stays: rounding of the direction would be all that it is asked for.
        let matters: Vec<usize> = (0..n).filter(|j| matrix.column(*j).iter().any(|x| *x != 0.0)).collect();
        matters.into_iter().for_each(|j| matrix[(all, j)] = across[j]);
        matrix[(all, all)] = across[n];
        (matrix, factors)
    }

    /// ∂/∂p of the equations by a central difference: it steers, and no result depends on it.  Its step is shorter where what forces changes
    /// within it, as beside a pole.
    fn slope(&self, state: &State) -> DVector<f64> {
        self.slope_or_jump(state).unwrap_or_else(|jump| jump)
    }

    /// The same; differences that agree at no step are of a jump.
    fn slope_or_jump(&self, state: &State) -> Result<DVector<f64>, DVector<f64>> {
        let size = state.value.abs().max(1e-3 * self.width());
        let mut step = 1e-6 * size;
        let (mut slope, _) = self.difference(state, step);
        while step > f64::EPSILON * size {
            step /= FINER;
            let (finer, rounding) = self.difference(state, step);
            let agrees = |k: usize| (finer[k] - slope[k]).abs() <= (AGREES * slope[k].abs()).max(rounding[k]);
            if (0..slope.len()).all(agrees) {
                return Ok(slope);
            }
            slope = finer;
        }
        Err(slope)
    }

    /// A central difference of the equations over twice a step of p, and how much of it is rounding.
    fn difference(&self, state: &State, step: f64) -> (DVector<f64>, DVector<f64>) {
        let [high, low] = [step, -step].map(|step| self.ask(state.value + step, |balance| balance.left(&state.q)));
        let rounding = high[1].zip_map(&low[1], |high, low| ROUNDED * high.max(low));
        let slope = |k: usize| {
            let change = high[0][k] - low[0][k];
            // What the equations' rounding makes is no slope.
            let known = change.is_finite() && change.abs() > rounding[k];
            if known { change * (0.5 / step) } else { 0.0 }
        };
        (DVector::from_fn(high[0].len(), |k, _| slope(k)), rounding * (0.5 / step))
    }

    /// The state of the branch between two of its states, at a part of the way.
    pub fn between(&self, a: &State, b: &State, part: f64) -> Option<State> {
        let mix = |a: f64, b: f64| a + part * (b - a);
        let guess = State { q: a.q.iter().zip(&b.q).map(|(a, b)| mix(*a, *b)).collect(), value: mix(a.value, b.value) };
        let chord: Vec<f64> = a.q.iter().zip(&b.q).map(|(a, b)| b - a).chain([b.value - a.value]).collect();
        let extent: Vec<f64> = a.q.iter().zip(&b.q).map(|(a, b)| a.abs().max(b.abs())).collect();
        let units = self.units(&extent);
        let across: Vec<f64> = chord.iter().zip(units).map(|(chord, unit)| chord / (unit * unit)).collect();
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

    /// The same where branches cross and no direction is left: the extreme of the polynomial through states on both sides of it.
    fn standstill(&self, a: &State, b: &State, sign: f64) -> Option<State> {
        let node = |k: u32| 0.5 - 0.5 * ((f64::from(k) + 0.5) * std::f64::consts::PI / f64::from(NODES)).cos();
        let states = (0..NODES).map(|k| Some((node(k), self.between(a, b, node(k))?)));
        let states: Vec<(f64, State)> = states.collect::<Option<_>>()?;
        let at = |part: f64, of: &dyn Fn(&State) -> f64| -> f64 {
            let weight = |k: usize| -> f64 {
                let others = states.iter().enumerate().filter(|(j, _)| *j != k);
                others.map(|(_, (other, _))| (part - other) / (states[k].0 - other)).product()
            };
            states.iter().enumerate().map(|(k, (_, state))| weight(k) * of(state)).sum()
        };
        let part = golden_section(|part| -sign.signum() * at(part, &|state| state.value));
        let clean = |i: usize| {
            let extent = a.q[i].abs().max(b.q[i].abs());
            Some(at(part, &|state| state.q[i])).filter(|q| q.abs() > INTERPOLATED * extent).unwrap_or(0.0)
        };
        let q = (0..a.q.len()).map(clean).collect();
        Some(State { q, value: at(part, &|state| state.value) })
    }

    /// True where a little beyond the fold there is an equilibrium near by: another branch passes through it.
    fn is_bifurcation(&self, at: &State, direction: f64, units: &[f64]) -> bool {
        let beyond = at.value + 1e-4 * direction.signum() * self.width();
        let Ok(found) = self.search(beyond, &at.q) else { return false };
        found.iter().zip(&at.q).zip(units).all(|((a, b), unit)| (a - b).abs() <= 0.01 * unit)
    }
}

/// Where a function of a part of the way is least.
fn golden_section(of: impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let width = high - low;
        let (left, right) = (high - GOLDEN * width, low + GOLDEN * width);
        if of(left) < of(right) { high = right } else { low = left }
    }
    0.5 * (low + high)
}

impl Family {
    /// The shortest x of A x = b, in these sizes, across the directions in which the equations but the last do not change.
    fn across(&self, mut matrix: DMatrix<f64>, mut right: DVector<f64>) -> Option<DVector<f64>> {
        let all = self.sizes.len() - 1;
        matrix.column_iter_mut().zip(self.sizes.iter()).for_each(|(mut column, size)| column *= *size);
        for (mut row, right) in matrix.row_iter_mut().zip(right.iter_mut()) {
            let largest = row.amax();
            if largest > 0.0 {
                row /= largest;
                *right /= largest;
            }
        }
        let slopes = Singular::of(&matrix.view((0, 0), (all, all)).into_owned())?;
        let mut order: Vec<usize> = (0..all).collect();
        order.sort_by(|a, b| slopes.values[*a].total_cmp(&slopes.values[*b]));
        for k in order.into_iter().take(self.count) {
            let free = slopes.v.column(k).resize_vertically(all + 1, 0.0);
            let part = &matrix * &free;
            matrix -= part * free.transpose();
        }
        let singular = Singular::of(&matrix)?;
        let mut values: Vec<f64> = singular.values.iter().copied().collect();
        values.sort_by(f64::total_cmp);
        let rounding = Scaled::threshold(all + 1, singular.values.max());
        let threshold = rounding.max(values[(self.count - 1).min(all)]);
        Some(singular.refined(&matrix, &right, threshold).component_mul(&self.sizes))
    }
}
