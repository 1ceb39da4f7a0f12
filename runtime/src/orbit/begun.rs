//! From a guess to what is told of a motion that repeats.

use nalgebra::{DMatrix, DVector};

use super::closing::{By, Closing, Difference};
#[cfg(feature = "interpret")]
use super::double_double::Wanted;
use super::family::BETWEEN;
use super::found::{ExtendedOrbit, Orbit};
use super::guess::{self, begin_at, sizes_of_pieces, states_of};
use super::laps::{Laps, Point, Solution, Time, Trial, itinerary, lcm};
use super::smallest::{self, WithPeriod, follows_to};
use super::stability::{Spectrum, spectrum};
use super::structure::{self, Known};
use crate::error::{Error, NoOrbit};
use crate::events::{Around, locate};
use crate::find::Value;
use crate::run::{Names, Run};
use crate::simulate::{Settings, simulate};
use crate::vary::{Leg, TOLD};

/// A motion does not close whose pieces miss each other by more than so many times the tolerance: those of one that closes do by rounding, a
/// thousandth of the least tolerance.
const OPEN: f64 = 10.0;
/// No piece is to stretch one change by more than this beside another: what is left of sixteen digits is that of its multipliers.
const SPREAD: f64 = 1e4;
/// No more than twice so many numbers are unknown: their matrices are full.
const MOST_UNKNOWNS: usize = 500;
/// A motion that goes this part as far as the guess, or less, is none.
const SHRUNK: f64 = 1e-6;
/// A lap is looked at in so many places for where a coordinate turns round.
const TURNS: usize = 128;
/// A direction lies in a span up to this part of it.
pub(super) const WITHIN: f64 = 1e-4;

/// A search that has begun.
pub(super) struct Begun {
    pub laps: Laps,
    pub point: Point,
    /// Whether the user said how the motion closes.
    pub given: bool,
    /// Whether events change something on the way.
    pub acts: bool,
    /// The energy of the equilibrium from which energies are counted, J.
    pub rest_energy: f64,
    /// So many times the motion was repeated within the period of the guess.
    pub repeats: usize,
    /// The coordinate that turns round where the motion is to begin, if that is told.
    pub turns: Option<usize>,
    /// Whether the user chose the number of pieces.
    pub chosen: bool,
    /// Other values of parameters, by their places, with which the motion is to close in the same way.
    pub elsewhere: Vec<Vec<(usize, f64)>>,
    /// What is asked for in double-double.
    #[cfg(feature = "interpret")]
    pub extended: Option<Wanted>,
}

impl Laps {
    /// Starts of all pieces on a run.
    pub fn along(&self, run: &Run, lap: f64) -> Result<Point, Error> {
        let parameter = self.parameter.and_then(|k| self.system.parameters().get(k).copied()).unwrap_or(0.0);
        let first = run.first();
        let mut starts = vec![[first.q, first.v].concat()];
        for k in 1..self.legs {
            let t = first.t + lap * k as f64 / self.legs as f64;
            let state = run.at(t).ok_or(NoOrbit::NoGuess { until: run.last().t - first.t })?;
            starts.push([state.q, state.v].concat());
        }
        Ok(Point { starts, lap, parameter })
    }

    /// Starts of twice as many pieces of a motion: where each piece began, and in its middle.
    pub fn halved(&self, solution: &Solution) -> Option<Point> {
        let mut starts = Vec::with_capacity(2 * solution.trial.pieces.len());
        for (piece, start) in solution.trial.pieces.iter().zip(&solution.point.starts) {
            let middle = piece.run.at(0.5 * (piece.start.t + piece.end.t))?;
            starts.extend([start.clone(), [middle.q, middle.v].concat()]);
        }
        Some(Point { starts, ..solution.point.clone() })
    }

    /// Starts of all pieces that events end, each where the one before ends, of which the first was run.
    pub fn in_turn(&mut self, run: &Run) -> Result<Point, Error> {
        let By::After { event, .. } = self.closing.by else { return self.along(run, 0.0) };
        let first = run.first();
        let mut point = Point { starts: vec![[first.q, first.v].concat()], lap: 0.0, parameter: 0.0 };
        let mut last = run.last();
        let mut phase = run.phases.last().map_or(self.settings.phase, |(_, phase)| *phase);
        for k in 1..self.laps * self.legs {
            let mut y = [last.q, last.v].concat();
            if self.closes(k - 1) {
                (y, phase) = (self.closing.image(&y), self.closing.phases[phase]);
            }
            point.starts.push(y.clone());
            let mut settings = Settings { phase, ends_after: Some(event), ..self.settings.clone() };
            begin_at(&mut settings, y);
            let next = simulate(&mut *self.system, &settings)?;
            phase = next.phases.last().map_or(phase, |(_, phase)| *phase);
            last = next.last();
        }
        Ok(point)
    }
}

/// Newton's steps from a guess end at this size, by which symmetries are seen, where the smallest map goes on from there.
const NEAR: f64 = 1e-7;

impl Begun {
    /// The motion near the guess, as exactly as its smallest map is looked for with.
    pub fn first(&mut self) -> Result<Solution, Error> {
        let point = self.point.clone();
        if self.may_shrink() { self.laps.solve_to(point, None, NEAR) } else { self.laps.solve(point, None) }
    }

    /// Whether the motion may close by a smaller map than the one at hand.
    fn may_shrink(&self) -> bool {
        !self.given && !self.acts && self.laps.closing.by == By::Part(1)
    }

    /// Lets all motions have the energy of this one, where it is conserved: of those with the same parameters there is one of each energy.
    pub fn hold_energy(&mut self, solution: &Solution, found: &Spectrum) {
        let laps = &mut self.laps;
        if laps.energy.is_none() && laps.keeps_energy() && found.known.iter().any(|name| name == structure::ENERGY) {
            let side = solution.trial.pieces[0].start.clone();
            crate::vary::put(&mut *laps.system, &side);
            laps.energy = Some(structure::energy(&*laps.system, &side).0);
        }
    }

    /// What is told of a solution, by the smallest map that closes it.
    pub fn finish(&mut self, solution: Solution) -> Result<Orbit, Error> {
        let (solution, found) = self.smallest(solution)?;
        self.only_rests(&solution)?;
        // Loose runs may close worse from where nothing moves.
        if let Some((turned, found)) = self.begun_at_its_turn(&solution)? {
            match self.told(turned, found) {
                Err(error) if !error.is_interruption() => {}
                outcome => return outcome,
            }
        }
        self.told(solution, found)
    }

    /// The same motion, begun where a coordinate turns round; `None` where that is not told, or not found.
    fn begun_at_its_turn(&mut self, solution: &Solution) -> Result<Option<(Solution, Spectrum)>, Error> {
        let Some(part) = self.turn(solution) else { return Ok(None) };
        let legs = solution.point.starts.len();
        let starts = (0..legs).map(|k| self.laps.state(solution, part + k as f64 / legs as f64)).collect::<Option<_>>();
        let Some(starts) = starts else { return Ok(None) };
        match self.laps.solve(Point { starts, ..solution.point.clone() }, None) {
            Ok(turned) => {
                let found = spectrum(&mut self.laps, &turned.trial);
                Ok(Some((Solution { steps: solution.steps + turned.steps, ..turned }, found)))
            }
            Err(error) if error.is_interruption() => Err(error),
            Err(_) => Ok(None),
        }
    }

    /// Where the coordinate that is told turns round, the nearest to the start, in parts of a lap from there.
    fn turn(&self, solution: &Solution) -> Option<f64> {
        let i = self.laps.n() + self.turns.filter(|_| self.laps.laps == 1)?;
        let rate = |part: f64| Some(self.laps.state(solution, part)?[i]);
        let place = |k: usize| (k as f64 / TURNS as f64 - 0.5).clamp(-0.5, 0.5);
        let crosses = |k: usize| Some(rate(place(k))? * rate(place(k + 1))? <= 0.0);
        let turns = (0..TURNS).filter(|k| crosses(*k) == Some(true)).map(|k| {
            let (a, b) = (place(k), place(k + 1));
            let of = |part: f64| rate(part).unwrap_or(f64::NAN);
            locate(of, (a, of(a)), (b, of(b)), Around::bracket(a, b)).0
        });
        turns.min_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// Where a motion begins that is told: where its coordinate turns round, if that is asked and known.
    pub fn start_of(&self, solution: &Solution) -> Vec<f64> {
        let turned = self.turn(solution).and_then(|part| self.laps.state(solution, part));
        turned.unwrap_or_else(|| solution.trial.pieces[0].start.y.clone())
    }

    /// A solution in scales of its own motion: a guess that runs away is far larger, and beside it anything closes.
    fn in_own_scales(&mut self, mut solution: Solution) -> Result<Solution, Error> {
        /// Each time they shrink by some ten decades, or are settled.
        const TIMES: usize = 40;
        for _ in 0..TIMES {
            let pieces: Vec<&Run> = solution.trial.pieces.iter().map(|piece| &piece.run).collect();
            let Some(scales) = self.laps.unless_alike(sizes_of_pieces(&pieces)) else { break };
            self.laps.scales = scales;
            let before = solution.steps;
            solution = self.laps.solve(solution.point, None)?;
            solution.steps += before;
        }
        Ok(solution)
    }

    /// A solution by the smallest map that closes it, in pieces short enough for its multipliers.
    pub fn smallest(&mut self, solution: Solution) -> Result<(Solution, Spectrum), Error> {
        self.at_rest(&solution)?;
        let mut solution = match self.rest_near(&solution)? {
            Some(rest) => rest,
            None => self.in_own_scales(solution)?,
        };
        let mut steps = solution.steps;
        if let Some(smaller) = self.reduce(&solution)? {
            steps += smaller.steps;
            solution = smaller;
        }
        solution.steps = steps;
        self.cut(solution)
    }

    /// A solution in pieces short enough for its multipliers.
    pub fn cut(&mut self, mut solution: Solution) -> Result<(Solution, Spectrum), Error> {
        let mut found = spectrum(&mut self.laps, &solution.trial);
        while self.is_coarse(&found)
            && let Some(point) = self.laps.halved(&solution)
        {
            let before = solution.steps;
            solution = self.laps.solve(point, None)?;
            solution.steps += before;
            found = spectrum(&mut self.laps, &solution.trial);
        }
        Ok((solution, found))
    }

    /// The rest to which a driven motion has shrunk, if the mechanism does rest there: beside nothing but itself any motion is large.
    fn rest_near(&mut self, solution: &Solution) -> Result<Option<Solution>, Error> {
        if self.laps.time != Time::Driven || self.goes(solution) > SHRUNK {
            return Ok(None);
        }
        let n = self.laps.n();
        let near = &solution.point.starts[0];
        let place = |i: usize| if near[i].abs() <= SHRUNK * self.laps.scales[i] { 0.0 } else { near[i] };
        let start: Vec<f64> = (0..2 * n).map(|i| if i < n { place(i) } else { 0.0 }).collect();
        let point = Point { starts: vec![start; solution.point.starts.len()], ..solution.point.clone() };
        let Ok(trial) = self.laps.try_at(&point, self.laps.settings.tolerance) else { return Ok(None) };
        let pieces: Vec<&Run> = trial.pieces.iter().map(|piece| &piece.run).collect();
        if !guess::rests(&pieces) {
            return Ok(None);
        }
        self.laps.scales = sizes_of_pieces(&pieces);
        let rest = self.laps.solve(point, None)?;
        Ok(Some(Solution { steps: solution.steps + rest.steps, ..rest }))
    }

    /// Whether pieces are too long for the multipliers of a motion, and may be cut.
    pub fn is_coarse(&self, found: &Spectrum) -> bool {
        let may_be_cut = !self.chosen && !self.acts && self.laps.time != Time::Event;
        may_be_cut && found.spread > SPREAD && self.laps.unknowns() < MOST_UNKNOWNS
    }

    /// Refuses a motion that has shrunk to rest, where nothing drives it: rest under a drive may be stable or not.
    pub fn at_rest(&self, solution: &Solution) -> Result<(), Error> {
        match self.laps.time != Time::Driven && self.goes(solution) <= SHRUNK {
            true => Err(NoOrbit::Rest.into()),
            false => Ok(()),
        }
    }

    /// Refuses rest where what is said to drive does not, as a force F cos w t with F = 0.
    fn only_rests(&self, solution: &Solution) -> Result<(), Error> {
        if self.goes(solution) > SHRUNK {
            return Ok(());
        }
        let states: Vec<_> = solution.trial.pieces.iter().flat_map(|piece| states_of(&piece.run)).collect();
        let later = BETWEEN * duration_of_lap(solution);
        match Closing::period(self.laps.system.description()).differs(&*self.laps.system, &states, later) {
            Some(_) => Ok(()),
            None => Err(NoOrbit::Rest.into()),
        }
    }

    /// How far a motion goes at most, in units of the scales.
    fn goes(&self, solution: &Solution) -> f64 {
        let width = 2 * self.laps.n();
        let goes = (0..width).map(|i| {
            let all = solution
                .trial
                .pieces
                .iter()
                .flat_map(|piece| piece.run.rows.chunks_exact(width).map(move |row| row[i]));
            let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            (high - low) / self.laps.scales[i]
        });
        goes.fold(0.0, f64::max)
    }

    /// The plain run of some laps from a solution, and how long a lap takes.
    fn plain(&mut self, solution: &Solution, laps: usize) -> Result<(Run, f64), Error> {
        let y = &solution.trial.pieces[0].start.y;
        let all: f64 = solution.trial.pieces.iter().map(|piece| piece.end.t - piece.start.t).sum();
        let lap = all / self.laps.laps as f64;
        let from = self.laps.settings.from;
        let mut settings = Settings { until: from + laps as f64 * lap, ..self.laps.settings.clone() };
        begin_at(&mut settings, y.clone());
        Ok((simulate(&mut *self.laps.system, &settings)?, lap))
    }

    /// After how many pieces a motion that events end closes already, to a part of the scales, where those are fewer than was asked for.
    fn closes_after(&self, solution: &Solution, to: f64) -> Option<(usize, usize)> {
        let laps = &self.laps;
        let By::After { event, count } = laps.closing.by else { return None };
        let start = &solution.point.starts[0];
        let closed = |piece: &Leg| {
            let image = laps.closing.image(&piece.end.y);
            let apart = |i: usize| (image[i] - start[i]).abs() / laps.scales[i];
            let counted = (0..start.len()).filter(|i| !laps.closing.shifts.contains(i));
            laps.closing.phases[piece.end.phase] == laps.settings.phase && counted.map(apart).fold(0.0, f64::max) <= to
        };
        let pieces = solution.trial.pieces.iter().take(count.saturating_sub(1));
        pieces.enumerate().find(|(_, piece)| closed(piece)).map(|(k, _)| (event, k + 1))
    }

    /// The solution by the smallest map that closes it, to all digits; `None` where that is the one at hand.
    fn reduce(&mut self, solution: &Solution) -> Result<Option<Solution>, Error> {
        let to = follows_to(self.known(solution));
        if let Some((event, count)) = self.closes_after(solution, to) {
            let before = self.laps.duration(&solution.trial);
            self.laps.closing.by = By::After { event, count };
            self.laps.legs = count;
            let starts = solution.point.starts[..count].to_vec();
            let smaller = self.laps.solve(Point { starts, ..solution.point.clone() }, None)?;
            self.repeats = (before / self.laps.duration(&smaller.trial)).round() as usize;
            return Ok(Some(smaller));
        }
        if !self.may_shrink() {
            return Ok(None);
        }
        if let Some(laps) = self.laps_of_the_guess(solution, to) {
            self.repeats *= laps;
            let Some(point) = self.part_of(solution, laps) else { return Ok(None) };
            let lap = self.laps.solve(point, None)?;
            return self.reduce(&lap).map(|smaller| smaller.or(Some(lap)));
        }
        let systems = self.systems(duration_of_lap(solution))?;
        let Some(closing) = smallest::smallest(&systems, &self.laps, solution, to) else {
            return self.laps.solve(solution.point.clone(), None).map(Some);
        };
        let By::Part(part) = closing.by else { return Ok(None) };
        self.repeats *= part / closing.order().min(part);
        let reversed = std::mem::take(&mut self.laps.closing.reversed);
        self.laps.closing = Closing { reversed, ..closing };
        let Some(point) = self.part_of(solution, part) else { return Ok(None) };
        self.laps.solve(point, None).map(Some)
    }

    /// After how many parts of its period a motion that no time drives is as it was, if more than one; the most of them.
    fn laps_of_the_guess(&self, solution: &Solution, to: f64) -> Option<usize> {
        let free = self.laps.time != Time::Driven;
        free.then(|| smallest::laps(solution, (&self.laps.scales, to))).flatten()
    }

    /// Starts of the pieces of this part of a period.
    fn part_of(&mut self, solution: &Solution, part: usize) -> Option<Point> {
        self.laps.legs = if self.chosen { self.laps.legs } else { self.laps.legs.div_ceil(part).max(2) };
        let (legs, point) = (self.laps.legs, &solution.point);
        let starts = (0..legs).map(|k| solution.at(k as f64 / (legs * part) as f64)).collect::<Option<Vec<_>>>()?;
        Some(Point { starts, lap: point.lap / part as f64, ..*point })
    }

    /// How well a motion is known, in units of the scales: what more accurate runs make of it, and Newton's last step.
    fn known(&mut self, solution: &Solution) -> f64 {
        let finer = self.laps.try_finer(solution);
        finer.map_or(0.0, |finer| moved(solution, &finer).norm()) + solution.last
    }

    /// The mechanism with its present parameters and with all others, each with its period.
    fn systems(&self, period: f64) -> Result<Vec<WithPeriod>, Error> {
        let laps = &self.laps;
        let of = |changes: &[(usize, f64)]| {
            let mut system = laps.system.boxed_clone();
            changes.iter().for_each(|(place, value)| system.set_parameter(*place, *value));
            let period = if laps.time == Time::Driven { laps.drive.period(&*system)? } else { period };
            Ok((system, period))
        };
        std::iter::once(&Vec::new()).chain(&self.elsewhere).map(|changes| of(changes)).collect()
    }

    /// Refuses a closing that was asked for, where the mechanism does not allow it with other parameters.
    ///
    /// # Errors
    /// [`NoOrbit::NoSymmetry`].
    pub fn closes_elsewhere(&self) -> Result<(), Error> {
        let laps = &self.laps;
        if laps.closing.is_plain() {
            return Ok(());
        }
        let phase = laps.settings.phase;
        let states: Vec<_> = self.point.starts.iter().map(|y| (laps.settings.from, y.clone(), phase)).collect();
        for (system, period) in self.systems(self.point.lap)? {
            let later = match laps.closing.by {
                By::Part(part) if laps.time == Time::Driven => period / part as f64,
                _ => 0.0,
            };
            if let Some(Difference { coordinate, here, there }) = laps.closing.differs(&*system, &states, later) {
                return Err(NoOrbit::NoSymmetry { coordinate, here, there }.into());
            }
        }
        Ok(())
    }

    pub fn told(&mut self, solution: Solution, found: Spectrum) -> Result<Orbit, Error> {
        let extended = self.in_double_double(&solution)?;
        let laps = &mut self.laps;
        let finer = laps.try_finer(&solution).ok();
        let moved = finer.as_ref().map(|finer| moved(&solution, finer));
        let finer_found = finer.as_ref().map(|finer| spectrum(laps, finer));
        let mut multipliers = found.with_errors(finer_found.as_ref());
        if finer_found.is_none() {
            multipliers.iter_mut().for_each(|multiplier| multiplier.error = f64::NAN);
        }
        let width = 2 * laps.n();
        let error = |i: usize| moved.as_ref().map_or(f64::NAN, |moved| TOLD * moved[i].abs() + solution.last);
        let names = Names::of(laps.system.description()).columns();
        let start = solution.trial.pieces[0].start.y.iter().enumerate().map(|(i, value)| Value {
            name: names[i].clone(),
            value: *value,
            error: error(i) * laps.scales[i],
        });
        let start: Vec<Value> = start.collect();
        let duration = laps.duration(&solution.trial);
        let period_error = match laps.time {
            Time::Free => error(width * solution.point.starts.len()) * duration,
            Time::Driven => 4.0 * f64::EPSILON * duration,
            Time::Event => finer
                .as_ref()
                .map_or(f64::NAN, |finer| TOLD * (laps.duration(finer) - duration).abs() + solution.last * duration),
        };
        let free = self.free(&solution, &found.generators[0]);
        let laps = &mut self.laps;
        let conservative = laps.keeps_energy() && found.known.iter().any(|name| name == structure::ENERGY);
        let side = solution.trial.pieces[0].start.clone();
        crate::vary::put(&mut *laps.system, &side);
        let energy = conservative.then(|| structure::energy(&*laps.system, &side).0 - self.rest_energy);
        let events = itinerary(&solution.trial.pieces)
            .into_iter()
            .flat_map(|(events, _)| events)
            .map(|event| laps.system.description().events[event].name.to_string());
        let events: Vec<String> = events.collect();
        let part = lcm(laps.closing.order(), laps.laps) / laps.laps;
        let returns = self.returns(&solution, &found, moved.map_or(0.0, |moved| moved.norm()))?;
        let (run, _) = self.plain(&solution, part * self.laps.laps)?;
        let laps = &self.laps;
        Ok(Orbit {
            period: Value { name: "period".to_owned(), value: duration, error: period_error },
            returns,
            start,
            part,
            map: laps.map_in_words(),
            multipliers,
            known: found.known.clone(),
            superstable: found.lost,
            free,
            energy,
            events,
            extended,
            run,
            steps: solution.steps,
            runs: laps.runs,
            legs: laps.legs,
            repeats: self.repeats,
        })
    }

    /// A solution to more digits, where they are asked for.
    #[cfg(feature = "interpret")]
    fn in_double_double(&mut self, solution: &Solution) -> Result<Option<ExtendedOrbit>, Error> {
        let laps = &mut self.laps;
        self.extended.as_ref().map(|wanted| wanted.of(laps, solution)).transpose()
    }

    #[cfg(not(feature = "interpret"))]
    fn in_double_double(&mut self, _: &Solution) -> Result<Option<ExtendedOrbit>, Error> {
        Ok(None)
    }

    /// How far plain runs of a motion that is known to a part of the scales miss their starts at most; refuses one that does not close.
    fn returns(&mut self, solution: &Solution, found: &Spectrum, known: f64) -> Result<f64, Error> {
        let missed = self.misses(solution)?;
        let returns = missed.iter().map(|(_, part)| *part).fold(0.0, f64::max);
        // What a plain run is off by grows as small changes do.
        let grows = found.multipliers.iter().map(|polar| polar.log).fold(0.0, f64::max);
        let laps = &self.laps;
        // Where damping is all but none every motion all but closes, and what is left of it is as small as steps can make it.
        let open = solution.trial.r.norm() > OPEN * laps.settings.tolerance;
        if !open && returns <= follows_to(known) * (grows * laps.laps as f64).exp() {
            return Ok(returns);
        }
        let start = laps.start_of(&solution.point);
        let off = |(i, part): (usize, f64)| (start[i].0.clone(), part * laps.scales[i]);
        Err(NoOrbit::Stuck {
            residuals: missed.into_iter().map(off).collect(),
            start: start.clone(),
            returns: Vec::new(),
        }
        .into())
    }

    /// How far plain runs of all laps miss their starts, but for shifts, in parts of how far each number goes.
    fn misses(&mut self, solution: &Solution) -> Result<Vec<(usize, f64)>, Error> {
        let laps = &mut self.laps;
        let (n, count) = (laps.n(), laps.laps);
        let lap = duration_of_lap(solution) / count as f64;
        let mut y = solution.trial.pieces[0].start.y.clone();
        let from = laps.settings.from;
        for _ in 0..count {
            let event = if let By::After { event, .. } = laps.closing.by { Some(event) } else { None };
            // With an event the lap ends where it happens, somewhat later or earlier.
            let until = from + if event.is_some() { 2.0 * lap } else { lap };
            let mut settings = Settings { from, until, ends_after: event, ..laps.settings.clone() };
            begin_at(&mut settings, y);
            let run = simulate(&mut *laps.system, &settings)?;
            let last = run.last();
            y = laps.closing.image(&[last.q, last.v].concat());
        }
        let start = &solution.trial.pieces[0].start.y;
        let apart = |i: usize| (i, (y[i] - start[i]).abs() / laps.scales[i]);
        Ok((0..2 * n).filter(|i| !laps.closing.shifts.contains(i)).map(apart).collect())
    }

    /// Names of directions in which there are other such motions.
    fn free(&self, solution: &Solution, generators: &[Known]) -> Vec<String> {
        let width = 2 * self.laps.n();
        let list = solution.linear.free();
        let firsts: Vec<DVector<f64>> = list.iter().map(|direction| direction.rows(0, width).into_owned()).collect();
        let span = structure::basis(&firsts, width);
        let mut named: Vec<String> = Vec::new();
        let mut known: Vec<DVector<f64>> = Vec::new();
        for generator in generators {
            let inside = &span * (span.transpose() * &generator.direction);
            let size = generator.direction.norm();
            let contained = structure::basis(&known, width);
            let new = &generator.direction - &contained * (contained.transpose() * &generator.direction);
            if size > 0.0 && (&inside - &generator.direction).norm() <= WITHIN * size && new.norm() > WITHIN * size {
                named.push(structure::motion_name(&generator.name));
                known.push(generator.direction.clone());
            }
        }
        for _ in named.len()..list.len() {
            named.push(if self.scales(solution, &span, &known) { "scale" } else { "family" }.to_owned());
        }
        named
    }

    /// Whether places all grow alike, and speeds alike, within a span and up to known directions.
    fn scales(&self, solution: &Solution, span: &DMatrix<f64>, known: &[DVector<f64>]) -> bool {
        let (n, width) = (self.laps.n(), 2 * self.laps.n());
        let y = &solution.trial.pieces[0].start.y;
        let part = |from: usize, to: usize| {
            let each = (0..width).map(|i| if (from..to).contains(&i) { y[i] / self.laps.scales[i] } else { 0.0 });
            DVector::from_iterator(width, each)
        };
        let mut list = known.to_vec();
        list.extend([part(0, n), part(n, width)]);
        let grown = structure::basis(&list, width);
        let outside = span - &grown * (grown.transpose() * span);
        outside.norm() <= WITHIN
    }
}

/// By how much more accurate runs move a motion, in units of the scales.
fn moved(solution: &Solution, finer: &Trial) -> DVector<f64> {
    solution.linear.step(&finer.r) - solution.linear.step(&solution.trial.r)
}

fn duration_of_lap(solution: &Solution) -> f64 {
    solution.trial.pieces.iter().map(|piece| piece.end.t - piece.start.t).sum()
}
