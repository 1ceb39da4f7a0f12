//! A motion that is to close, piece by piece.

use nalgebra::{DMatrix, DVector};

use super::acting;
use super::closing::{By, Closing};
use super::drive::{self, Drive};
use crate::error::{Error, NoOrbit};
use crate::find::Linearised;
use crate::mechanism::System;
use crate::simulate::Settings;
use crate::vary::{Leg, finer, leg};

/// A step is shortened by halves at most so often, and so many steps are taken.
const HALVES: usize = 10;
const STEPS: usize = 40;
/// Steps of this size, in parts of what they change, are rounding of runs at the tightest tolerance.
const LEAST: f64 = 1e-14;
/// Pieces of this many times the steps of the longest one of a motion so far, and so many more, go somewhere else.
const MORE_STEPS: u64 = 20;
const STEPS_ANYHOW: u64 = 1000;

/// How long a lap takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Time {
    /// It is unknown.
    Free,
    /// A part of the period of what depends on time.
    Driven,
    /// Until an event.
    Event,
}

/// Scales that differ from how far motions go by more than this factor are chosen anew.
const OTHER: f64 = 2.0;

/// So far from a point along a direction of unit length, in units of the scales.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Away {
    pub from: Point,
    pub along: DVector<f64>,
    pub by: f64,
}

/// A motion of some laps, each of which ends in the image of its start.
pub(super) struct Laps {
    pub system: Box<dyn System>,
    pub settings: Settings,
    pub closing: Closing,
    pub time: Time,
    pub drive: Drive,
    /// Laps after which the motion is as it was.
    pub laps: usize,
    /// Pieces a lap.
    pub legs: usize,
    /// A parameter that is unknown too.
    pub parameter: Option<usize>,
    /// Parameters, by their places, that vary among motions that are looked for.
    pub varies: Vec<usize>,
    /// The least size beside which changes of it are small: 0 is passed as any other value.
    pub parameter_size: f64,
    /// The Jacobi integral that is wanted at the start, J.
    pub energy: Option<f64>,
    /// What a point is to be away from.
    pub away: Option<Away>,
    /// Shifts by any amount, with the momenta along them, which are conserved: they stay those of the guess, or motions that drift ever
    /// faster would be found beside those that are looked for.
    pub momenta: Vec<(DVector<f64>, f64)>,
    /// The size of each number of [q; q'].
    pub scales: Vec<f64>,
    /// Pieces of motions with slopes that were made.
    pub runs: usize,
    /// Steps of the longest piece of the first trial and of the motions that closed so far; 0 before there is one.
    pub steps: u64,
}

/// The unknowns at some values: the pieces, what does not close, and how it changes, in units of the scales.
pub(super) struct Trial {
    pub pieces: Vec<Leg>,
    pub r: DVector<f64>,
    pub j: DMatrix<f64>,
}

/// Starts of all pieces, and what else is unknown.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point {
    pub starts: Vec<Vec<f64>>,
    /// How long a lap takes, s; not used where an event ends it.
    pub lap: f64,
    pub parameter: f64,
}

/// Where Newton's steps ended.
pub(super) struct Solution {
    pub point: Point,
    pub trial: Trial,
    pub linear: Linearised,
    pub steps: usize,
    /// The size of the last step.
    pub last: f64,
}

impl Solution {
    /// The state after a part of the way, of one lap in pieces of one length.
    pub fn at(&self, part: f64) -> Option<Vec<f64>> {
        let pieces = &self.trial.pieces;
        let place = part * pieces.len() as f64;
        let piece = pieces.get(place as usize)?;
        let state = piece.run.at(piece.start.t + place.fract() * (piece.end.t - piece.start.t))?;
        Some([state.q, state.v].concat())
    }
}

impl Laps {
    pub fn n(&self) -> usize {
        self.system.len()
    }

    /// The state after a part of a lap, or before: what is before its start is an image of what is before its end.
    pub fn state(&self, solution: &Solution, part: f64) -> Option<Vec<f64>> {
        let whole = part.floor();
        let y = solution.at(part - whole)?;
        Some(match whole {
            0.0 => y,
            -1.0 => self.closing.image(&y),
            1.0 => self.closing.inverse(&y),
            _ => return None,
        })
    }

    /// Unknowns beside the starts.
    fn others(&self) -> usize {
        usize::from(self.time == Time::Free) + usize::from(self.parameter.is_some())
    }

    /// How many numbers are unknown.
    pub fn unknowns(&self) -> usize {
        2 * self.n() * self.laps * self.legs + self.others()
    }

    /// A point moved along a direction of unknowns in units of their scales.
    pub fn moved(&self, point: &Point, direction: &DVector<f64>, part: f64) -> Point {
        let width = 2 * self.n();
        let mut moved = point.clone();
        for (k, start) in moved.starts.iter_mut().enumerate() {
            start
                .iter_mut()
                .zip(&self.scales)
                .enumerate()
                .for_each(|(i, (x, scale))| *x += part * scale * direction[k * width + i]);
        }
        let mut next = width * point.starts.len();
        if self.time == Time::Free {
            moved.lap += part * point.lap * direction[next];
            next += 1;
        }
        if self.parameter.is_some() {
            moved.parameter += part * self.parameter_scale(point) * direction[next];
        }
        moved
    }

    /// A point less another one, in units of the scales.
    pub fn difference(&self, a: &Point, b: &Point) -> DVector<f64> {
        let pairs = a.starts.iter().flatten().zip(b.starts.iter().flatten());
        let starts = pairs.zip(self.scales.iter().cycle()).map(|((a, b), scale)| (a - b) / scale);
        let lap = (self.time == Time::Free).then(|| (a.lap - b.lap) / b.lap);
        let parameter = self.parameter.map(|_| (a.parameter - b.parameter) / self.parameter_scale(b));
        DVector::from_iterator(self.unknowns(), starts.chain(lap).chain(parameter))
    }

    pub fn parameter_scale(&self, point: &Point) -> f64 {
        parameter_scale(point, self.parameter_size)
    }

    /// How long a lap takes at a point, s, and how that changes with the parameter.
    ///
    /// # Errors
    /// What depends on time has no period.
    fn lap(&self, point: &Point) -> Result<(f64, f64), Error> {
        let (Time::Driven, By::Part(part)) = (self.time, self.closing.by) else { return Ok((point.lap, 0.0)) };
        let period = self.drive.period(&*self.system)?;
        let slope = match self.parameter {
            Some(k) => self.drive.slope(&*self.system, k)?,
            None => 0.0,
        };
        Ok((period / part as f64, slope / part as f64))
    }

    /// These scales, where they are others than those in use by more than a factor.
    pub fn unless_alike(&self, scales: Vec<f64>) -> Option<Vec<f64>> {
        let alike = |(new, old): (&f64, &f64)| (OTHER.recip()..OTHER).contains(&(new / old));
        (!scales.iter().zip(&self.scales).all(alike)).then_some(scales)
    }

    /// The row of the energy that is wanted: behind those of so many pieces, and of what is kept at the start.
    pub fn energy_row(&self, pieces: usize) -> usize {
        let kept = self.closing.reversals().len() + self.momenta.len() + 2 * self.system.description().rotations.len();
        pieces * 2 * self.n() + kept
    }

    /// Runs all pieces, and linearises what does not close.
    ///
    /// # Errors
    /// Those of runs with slopes; a lap that does not end.
    pub fn try_at(&mut self, point: &Point, tolerance: f64) -> Result<Trial, Error> {
        if let Some(k) = self.parameter {
            self.system.set_parameter(k, point.parameter);
        }
        let lap = self.lap(point)?;
        let pieces = self.run(point, lap.0, tolerance)?;
        let width = 2 * self.n();
        let closes = pieces.len() * width;
        let reversals = self.closing.reversals();
        let asked = self.energy_row(pieces.len());
        let size = asked + usize::from(self.energy.is_some()) + usize::from(self.away.is_some());
        let (mut r, mut j) = (DVector::zeros(size), DMatrix::zeros(size, self.unknowns()));
        for k in 0..pieces.len() {
            self.close(point, (&pieces, k), lap, (&mut r, &mut j));
        }
        for (k, slopes) in reversals.iter().enumerate() {
            let differs = slopes.iter().zip(&point.starts[0]).map(|(slope, x)| slope * x).sum();
            self.ask(closes + k, differs, (slopes, None), (&mut r, &mut j));
        }
        self.ask_kept(&pieces, closes + reversals.len(), (&mut r, &mut j));
        if let Some(wanted) = self.energy {
            self.ask_energy((asked, wanted), (point, &pieces), (&mut r, &mut j));
        }
        if let Some(Away { from, along, by }) = &self.away {
            r[size - 1] = along.dot(&self.difference(point, from)) - by;
            j.set_row(size - 1, &along.transpose());
        }
        Ok(Trial { pieces, r, j })
    }

    /// The point as more accurate runs have it, by whose differences errors are told: at a tolerance tighter by a factor, and with steps of no
    /// more than half the mean of those that were taken.  A tolerance alone would not do, where a piece is one step or two at any.
    ///
    /// # Errors
    /// As [`Laps::try_at`].
    pub fn try_finer(&mut self, solution: &Solution) -> Result<Trial, Error> {
        let before = self.refine(&solution.trial);
        let tried = self.try_at(&solution.point, self.settings.tolerance);
        self.settings = before;
        tried
    }

    /// Makes runs more accurate than those of a trial were; the settings before are returned.
    pub fn refine(&mut self, trial: &Trial) -> Settings {
        let before = self.settings.clone();
        let mean = |piece: &Leg| (piece.end.t - piece.start.t) / piece.run.work.steps.max(1) as f64;
        let least = trial.pieces.iter().map(mean).filter(|mean| *mean > 0.0).fold(f64::INFINITY, f64::min);
        self.settings = finer(&before, least);
        before
    }

    /// Runs all pieces of laps that take so long.
    fn run(&mut self, point: &Point, lap: f64, tolerance: f64) -> Result<Vec<Leg>, Error> {
        if !(lap > 0.0 || self.time == Time::Event) {
            return Err(NoOrbit::Rest.into());
        }
        let (n, length) = (self.n(), lap / self.legs as f64);
        let mut pieces: Vec<Leg> = Vec::with_capacity(point.starts.len());
        let mut phase = self.settings.phase;
        let parameters: Vec<usize> = self.parameter.into_iter().collect();
        let event = if let By::After { event, .. } = self.closing.by { Some(event) } else { None };
        let whole = self.settings.until - self.settings.from;
        for (k, start) in point.starts.iter().enumerate() {
            // What closes a lap is the image at the time with which laps begin.
            let later = if self.time == Time::Driven { (k % self.legs) as f64 * length } else { 0.0 };
            let from = self.settings.from + later;
            let until = from + if event.is_some() { whole } else { length };
            let (q, v) = (start[..n].to_vec(), start[n..].to_vec());
            let known = self.settings.clone();
            let mut settings = Settings { q, v, phase, from, until, ends_after: event, tolerance, ..known };
            let most = if self.steps > 0 { MORE_STEPS * self.steps + STEPS_ANYHOW } else { u64::MAX };
            settings.max_steps = settings.max_steps.min(most);
            self.runs += 1;
            let piece = leg(&mut *self.system, &settings, &parameters);
            let piece = piece.map_err(|error| match error.takes_more_steps_than(most) {
                true => NoOrbit::LeadsAway { steps: most }.into(),
                false => error,
            })?;
            if let Some(event) = event.filter(|event| !ends_with(&piece, *event)) {
                let name = self.system.description().events[event].name.to_string();
                return Err(NoOrbit::NoReturn { event: name, until: piece.end.t - from }.into());
            }
            phase = if self.closes(k) { self.closing.phases[piece.end.phase] } else { piece.end.phase };
            pieces.push(piece);
        }
        if phase != self.settings.phase {
            let name = |k: usize| self.system.description().phases[k].name.to_string();
            return Err(NoOrbit::OtherPhase { begins: name(self.settings.phase), ends: name(phase) }.into());
        }
        if self.steps == 0 {
            self.steps = most_steps(&pieces);
        }
        Ok(pieces)
    }

    /// By how much a piece misses the start of the next one, and how that changes: rows of r and J, in units of the scales.
    fn close(
        &self,
        point: &Point,
        (pieces, k): (&[Leg], usize),
        (lap, lap_slope): (f64, f64),
        (r, j): (&mut DVector<f64>, &mut DMatrix<f64>),
    ) {
        let (count, width, legs) = (pieces.len(), self.scales.len(), self.legs as f64);
        let (piece, closes) = (&pieces[k], self.closes(k));
        let taken = |y: &[f64]| if closes { self.closing.turned(y) } else { y.to_vec() };
        let end = if closes { self.closing.image(&piece.end.y) } else { piece.end.y.clone() };
        let next = (k + 1) % count;
        // What may differ at the end of all laps does not count there.
        let counted = |i: &usize| !(closes && next == 0 && self.closing.shifts.contains(i));
        let rows: Vec<usize> = (0..width).filter(counted).collect();
        let mut add = |column: usize, slopes: &[f64], scale: f64| {
            rows.iter().for_each(|i| j[(k * width + i, column)] += slopes[*i] * scale / self.scales[*i]);
        };
        for (c, column) in piece.columns.iter().take(width).enumerate() {
            add(k * width + c, &taken(column), self.scales[c]);
        }
        let mut other = count * width;
        if self.time == Time::Free {
            add(other, &taken(&piece.end_rate), lap / legs);
            other += 1;
        }
        if self.parameter.is_some() {
            // The start's time moves with the parameter: so does the end's, but for what the start's rate makes of it.
            let later = (k % self.legs) as f64 / legs * lap_slope;
            let slope = |i: usize| {
                let carried: f64 =
                    piece.columns.iter().zip(&piece.start_rate).map(|(column, rate)| column[i] * rate).sum();
                piece.columns[width][i] + piece.end_rate[i] * lap_slope / legs + later * (piece.end_rate[i] - carried)
            };
            add(other, &taken(&(0..width).map(slope).collect::<Vec<_>>()), self.parameter_scale(point));
        }
        for i in &rows {
            r[k * width + i] = (end[*i] - point.starts[next][*i]) / self.scales[*i];
            j[(k * width + i, next * width + i)] -= 1.0;
        }
    }

    /// Whether the mechanism keeps its energy.
    pub fn keeps_energy(&self) -> bool {
        let start = [self.settings.q.as_slice(), &self.settings.v].concat();
        self.drive == Drive::None && acting::keeps_energy(&*self.system, &self.varies, &start)
    }

    /// That the energy at the start is the one that is wanted, in a row.
    fn ask_energy(
        &mut self,
        (row, wanted): (usize, f64),
        (point, pieces): (&Point, &[Leg]),
        (r, j): (&mut DVector<f64>, &mut DMatrix<f64>),
    ) {
        let side = &pieces[0].start;
        crate::vary::put(&mut *self.system, side);
        let (energy, mut slopes) = super::structure::energy(&*self.system, side);
        let by_parameter = self.parameter.map(|k| super::structure::energy_by_parameter(&*self.system, side, k));
        slopes.extend(by_parameter);
        self.ask(row, energy - wanted, (&slopes, Some(point)), (r, j));
    }

    /// That momenta at the start are those of the guess, and quaternions of unit length that stay so, from a row on.
    fn ask_kept(&mut self, pieces: &[Leg], from: usize, (r, j): (&mut DVector<f64>, &mut DMatrix<f64>)) {
        let side = &pieces[0].start;
        crate::vary::put(&mut *self.system, side);
        for (k, (shift, wanted)) in self.momenta.iter().enumerate() {
            let (momentum, slopes) = super::structure::momentum(&*self.system, side, shift);
            self.ask(from + k, momentum - wanted, (slopes.as_slice(), None), (r, j));
        }
        let (n, from) = (self.n(), from + self.momenta.len());
        for (k, first) in self.system.description().rotations.iter().enumerate() {
            let (mut length, mut rate) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
            for i in *first as usize..*first as usize + 4 {
                let (q, v) = (side.y[i], side.y[n + i]);
                (length[i], rate[i], rate[n + i]) = (q, v, q);
            }
            let dot = |slopes: &[f64]| slopes.iter().zip(&side.y).map(|(a, b)| a * b).sum::<f64>();
            self.ask(from + 2 * k, 0.5 * (dot(&length) - 1.0), (&length, None), (r, j));
            // Each product q v stands twice in what its slopes make of [q; q'].
            self.ask(from + 2 * k + 1, 0.5 * dot(&rate), (&rate, None), (r, j));
        }
    }

    /// That something of the start which differs by so much does not, as a row of unit length: its slopes are those by the start and, with the point,
    /// by the parameter.
    fn ask(
        &self,
        row: usize,
        differs: f64,
        (slopes, point): (&[f64], Option<&Point>),
        (r, j): (&mut DVector<f64>, &mut DMatrix<f64>),
    ) {
        let scales = self.scales.iter().copied().chain(point.map(|point| self.parameter_scale(point)));
        let scaled: Vec<f64> = slopes.iter().zip(scales).map(|(slope, scale)| slope * scale).collect();
        let size = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
        if size > 0.0 {
            r[row] = differs / size;
            // The parameter is the last unknown.
            let place = |i: usize| if i < self.scales.len() { i } else { j.ncols() - 1 };
            let places: Vec<usize> = (0..scaled.len()).map(place).collect();
            places.into_iter().zip(scaled).for_each(|(i, x)| j[(row, i)] = x / size);
        }
    }

    /// Whether a lap ends with this piece.
    pub fn closes(&self, piece: usize) -> bool {
        let legs = match self.closing.by {
            By::After { count, .. } => count,
            By::Part(_) => self.legs,
        };
        (piece + 1).is_multiple_of(legs)
    }

    /// Newton's steps from a guess, which says into how many pieces laps are cut.
    ///
    /// # Errors
    /// [`NoOrbit`]; what ends the first run early.
    pub fn solve(&mut self, guess: Point, free: Option<usize>) -> Result<Solution, Error> {
        self.solve_to(guess, free, LEAST)
    }

    /// The same until steps are this small.
    ///
    /// # Errors
    /// As [`Laps::solve`].
    pub fn solve_to(&mut self, guess: Point, free: Option<usize>, least: f64) -> Result<Solution, Error> {
        let mut point = guess;
        self.legs = point.starts.len() / self.laps;
        let found = self.newton(&mut point, free, least);
        let solution = found.map_err(|error| match error.is_interruption() {
            true => NoOrbit::Interrupted { start: self.start_of(&point) }.into(),
            false => error,
        })?;
        self.steps = self.steps.max(most_steps(&solution.trial.pieces));
        if self.time == Time::Event && self.drive != Drive::None {
            let mut pieces = solution.trial.pieces.iter();
            pieces.try_for_each(|piece| {
                drive::repeats(&*self.system, self.closing.by, &piece.run, piece.end.t - piece.start.t)
            })?;
        }
        Ok(solution)
    }

    /// The same from a point, which is left where the steps end.
    fn newton(&mut self, point: &mut Point, free: Option<usize>, least: f64) -> Result<Solution, Error> {
        let tolerance = self.settings.tolerance;
        let mut trial = self.try_at(point, tolerance)?;
        let mut before = f64::INFINITY;
        let linearised = |trial: &Trial| {
            let linear = Linearised::new(&trial.j);
            match free {
                Some(count) => linear.with_free(count),
                // What slopes change by less than they are known to is no direction.
                None => {
                    let known = tolerance * linear.strongest();
                    linear.beyond(known)
                }
            }
        };
        let rounding = tolerance.sqrt();
        for steps in 0..STEPS {
            let mut linear = linearised(&trial);
            let mut step = linear.step(&trial.r);
            let is_last = |size: f64| size <= least || size < rounding && size > 0.5 * before;
            let mut taken = if is_last(step.norm()) { None } else { self.shortened(point, (&linear, &step), &trial)? };
            if taken.is_none() && step.norm() >= rounding && free.is_none() {
                // Directions in which nothing changes at the motion change by as little as the guess misses it.
                linear = linear.beyond(trial.r.norm());
                step = linear.step(&trial.r);
                taken = if is_last(step.norm()) { None } else { self.shortened(point, (&linear, &step), &trial)? };
            }
            let size = step.norm();
            match taken {
                Some((next, tried)) => (*point, trial, before) = (next, tried, size),
                None if size <= least || size < rounding => {
                    return Ok(Solution { point: point.clone(), trial, linear, steps, last: size });
                }
                None => return Err(self.stuck(point, &trial)),
            }
        }
        Err(self.stuck(point, &trial))
    }

    /// The state at the start of a point, by its names.
    pub fn start_of(&self, point: &Point) -> Vec<(String, f64)> {
        let names = crate::run::Names::of(self.system.description()).columns();
        names.into_iter().zip(point.starts[0].iter().copied()).collect()
    }

    fn stuck(&self, point: &Point, trial: &Trial) -> Error {
        let (n, description) = (self.n(), self.system.description());
        let missed = trial.r.iter().take(2 * n).zip(&self.scales).map(|(r, scale)| r * scale);
        let names = crate::run::Names::of(description).columns();
        let residuals = names.into_iter().zip(missed).collect();
        NoOrbit::Stuck { residuals, start: self.start_of(point), returns: Vec::new() }.into()
    }

    /// The first of a step's halves that passes the same events and makes the next step shorter, or else the first that does only that.
    ///
    /// Source: the natural monotonicity test, Deuflhard, Newton Methods for Nonlinear Problems (2004), section 3.1.
    fn shortened(
        &mut self,
        point: &Point,
        (linear, step): (&Linearised, &DVector<f64>),
        now: &Trial,
    ) -> Result<Option<(Point, Trial)>, Error> {
        let tolerance = self.settings.tolerance;
        let (mut part, mut otherwise) = (1.0, None);
        for _ in 0..HALVES {
            let next = self.moved(point, step, part);
            match self.try_at(&next, tolerance) {
                Ok(tried) if linear.step(&tried.r).norm() <= (1.0 - 0.5 * part) * step.norm() => {
                    if itinerary(&tried.pieces) == itinerary(&now.pieces) {
                        return Ok(Some((next, tried)));
                    }
                    otherwise.get_or_insert((next, tried));
                }
                Err(error) if error.is_interruption() => return Err(error),
                _ => (),
            }
            part *= 0.5;
        }
        Ok(otherwise)
    }

    /// What the map of all laps together exchanges, mirrors and shifts.
    pub fn map_in_words(&self) -> String {
        let all = (1..self.laps).fold(self.closing.clone(), |map, _| map.followed_by(&self.closing));
        all.words(self.system.description())
    }

    /// How long the motion takes until it is as it was, s.
    pub fn duration(&self, trial: &Trial) -> f64 {
        let all: f64 = trial.pieces.iter().map(|piece| piece.end.t - piece.start.t).sum();
        let order = self.closing.order();
        all / self.laps as f64 * lcm(order, self.laps) as f64
    }
}

/// The unit in which a point's parameter is counted, with the least size beside which changes of it are small.
pub(super) fn parameter_scale(point: &Point, least: f64) -> f64 {
    let size = point.parameter.abs().max(least);
    if size == 0.0 { 1.0 } else { size }
}

/// The steps of the longest piece.
fn most_steps(pieces: &[Leg]) -> u64 {
    pieces.iter().map(|piece| piece.run.work.steps).max().unwrap_or(0)
}

/// Whether a piece ends when an event happens.
fn ends_with(piece: &Leg, event: usize) -> bool {
    let last = piece.run.junctions.last();
    let acts = last.is_some_and(|junction| junction.events.contains(&event) && junction.after.t == piece.end.t);
    piece.run.ended_by == Some(event) || acts
}

/// The least common multiple.
pub(super) fn lcm(a: usize, b: usize) -> usize {
    let gcd = |mut a: usize, mut b: usize| {
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    };
    a / gcd(a, b).max(1) * b
}

/// The events that change something along pieces, and the phases that they lead to.
pub(super) fn itinerary(pieces: &[Leg]) -> Vec<(Vec<usize>, usize)> {
    let junctions = pieces.iter().flat_map(|piece| &piece.run.junctions);
    junctions.map(|junction| (junction.events.clone(), junction.after.phase)).collect()
}
