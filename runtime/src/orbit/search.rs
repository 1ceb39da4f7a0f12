//! A search for a motion that repeats, and the way to it.

use nalgebra::DVector;

use super::closing::{By, Closing};
use super::drive::Drive;
use super::found::Orbit;
use super::laps::{Condition, Laps, Point, Solution, Time, itinerary};
use super::stability::{Spectrum, beside, spectrum};
use super::{guess, smallest, structure};
use crate::error::{Error, NoOrbit};
use crate::find::Value;
use crate::mechanism::{Action, Description, System};
use crate::run::{Names, Run};
use crate::simulate::{Origin, Settings, Simulation, simulate};
use crate::vary::LOOSER;

/// A search that is being described: how a motion is to close, and where to look for one.
///
/// What is not said is found: the motion closes after a period, which comes from what depends on time, or from where the run comes near to
/// its own states again.
#[must_use = "nothing happens before `find`"]
pub struct OrbitSearch {
    described: Result<(Box<dyn System>, Settings, Origin), Error>,
    period: Option<f64>,
    part: usize,
    after: Option<(String, usize)>,
    images: Vec<(String, String)>,
    mirrored: Vec<String>,
    shifted: Vec<String>,
    turned: Vec<(String, f64)>,
    mode: Option<(usize, f64)>,
    energy: Option<f64>,
    legs: Option<usize>,
}

impl<S: System + 'static> Simulation<S> {
    /// Begins a search for a motion near this run that repeats itself.
    ///
    /// ```
    #[doc = include_str!("../../examples/orbit.rs")]
    /// ```
    pub fn orbit(self) -> OrbitSearch {
        let described = self.described();
        OrbitSearch::of(described.map(|(system, settings, origin)| (Box::new(system) as Box<dyn System>, settings, origin)))
    }
}

/// Pieces a period, unless events or the user say otherwise: single pieces are never better, and more cost linear algebra.
const LEGS: usize = 8;
/// No piece is to stretch a change by more than this: what is left of sixteen digits is that of its multipliers.
const STRETCH: f64 = 1e4;
/// Pieces at most.
const MOST_LEGS: usize = 512;
/// A motion that goes this part as far as the guess, or less, is none.
const SHRUNK: f64 = 1e-6;
/// A direction lies in a span up to this part of it.
const WITHIN: f64 = 1e-4;

impl OrbitSearch {
    /// Of a run that was described.
    pub(crate) fn of(described: Result<(Box<dyn System>, Settings, Origin), Error>) -> OrbitSearch {
        OrbitSearch {
            described,
            period: None,
            part: 1,
            after: None,
            images: Vec::new(),
            mirrored: Vec::new(),
            shifted: Vec::new(),
            turned: Vec::new(),
            mode: None,
            energy: None,
            legs: None,
        }
    }

    /// A guess of the period, s; of a mechanism that depends on time, the period.
    pub fn period(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// The motion closes after this part of the period, 1/`part`, exchanged and mirrored as is said.
    pub fn part(mut self, part: usize) -> Self {
        self.part = part.max(1);
        self
    }

    /// The motion closes when an event has happened so many times, in the state after it.
    pub fn after(mut self, event: &str, count: usize) -> Self {
        self.after = Some((event.to_owned(), count.max(1)));
        self
    }

    /// One coordinate, or phase, is at the end where the other was at the start, and the other way round unless the other is exchanged too.
    pub fn exchanged(mut self, a: &str, b: &str) -> Self {
        self.images.push((a.to_owned(), b.to_owned()));
        self
    }

    /// A coordinate has the opposite sign at the end.
    pub fn mirrored(mut self, coordinate: &str) -> Self {
        self.mirrored.push(coordinate.to_owned());
        self
    }

    /// A coordinate may be any amount more at the end; nothing may depend on it.
    pub fn shifted(mut self, coordinate: &str) -> Self {
        self.shifted.push(coordinate.to_owned());
        self
    }

    /// An angle is so many turns more at the end.
    pub fn turned(mut self, coordinate: &str, turns: f64) -> Self {
        self.turned.push((coordinate.to_owned(), turns));
        self
    }

    /// Begins at rest, displaced along a mode of the equilibrium, the first being 1, so that the coordinate that moves most moves by
    /// `amplitude`.
    pub fn from_mode(mut self, mode: usize, amplitude: f64) -> Self {
        self.mode = Some((mode, amplitude));
        self
    }

    /// The energy of the motion, J: the Jacobi integral, counted from the equilibrium where the search begins from a mode.
    pub fn energy(mut self, energy: f64) -> Self {
        self.energy = Some(energy);
        self
    }

    /// Pieces into which the map is cut.
    pub fn legs(mut self, legs: usize) -> Self {
        self.legs = Some(legs.max(1));
        self
    }

    /// Searches.
    ///
    /// # Errors
    /// [`Error::NoOrbit`]; names that are unknown; what ends the first run early; [`Error::NoSlopes`].
    pub fn find(self) -> Result<Orbit, Error> {
        let mut begun = self.begin()?;
        let solution = begun.laps.solve(begun.point.clone(), None)?;
        begun.finish(solution)
    }

    /// The laps and a guess.
    pub(super) fn begin(self) -> Result<Begun, Error> {
        let (mut system, mut settings, _) = self.described?;
        let description = system.description().clone();
        settings.every = None;
        settings.digits = false;
        settings.apart = false;
        let mut closing = Closing::period(&description);
        closing.by = By::Part(self.part);
        if let Some((event, count)) = &self.after {
            let event = event_index(&description, event)?;
            let acts = |action: &Action| !matches!(action, Action::Record);
            if !description.events[event].actions.iter().any(acts) {
                return Err(NoOrbit::OnlyNoted { event: description.events[event].name.to_string() }.into());
            }
            closing.by = By::After { event, count: *count };
        }
        exchange(&mut closing, &description, &self.images)?;
        for name in &self.mirrored {
            closing.images[coordinate_index(&description, name)?].1 ^= true;
        }
        for name in &self.shifted {
            closing.shifts.push(coordinate_index(&description, name)?);
        }
        for (name, turns) in &self.turned {
            closing.turns[coordinate_index(&description, name)?] = turns * std::f64::consts::TAU;
        }
        let timed = !description.inputs.is_empty() || !description.time_pattern.is_empty();
        let drive = match (timed, self.period) {
            (false, _) => Drive::None,
            (true, Some(period)) => Drive::Given(period),
            (true, None) => Drive::Frequencies,
        };
        let mut rest_energy = 0.0;
        let mut period = self.period;
        if let Some(mode) = self.mode {
            let (y, time, energy) = guess::mode(&*system, &system.equilibrium_guess(), mode)?;
            let (q, v) = y.split_at(system.len());
            (settings.q, settings.v) = (q.to_vec(), v.to_vec());
            (settings.held_q, settings.held_v) = (Vec::new(), Vec::new());
            period = period.or(Some(time));
            rest_energy = energy;
        }
        let time = match (closing.by, timed) {
            (By::After { .. }, _) => Time::Event,
            (By::Part(_), true) => Time::Driven(1.0),
            (By::Part(_), false) => Time::Free,
        };
        if time == Time::Driven(1.0) {
            period = Some(drive.period(&*system)?);
        }
        let (run, scales, lap) = first_run(&mut *system, &mut settings, &closing, period)?;
        for (name, shift) in self.shifted.iter().zip(&closing.shifts) {
            let sides: Vec<_> = run.junctions.iter().map(|junction| junction.after.clone()).collect();
            let first = run.first();
            let start = crate::run::Side {
                t: first.t,
                y: [first.q, first.v].concat(),
                modes: system.modes().to_vec(),
                phase: settings.phase,
            };
            let known = structure::shifts(&*system, &[vec![start], sides].concat());
            let mut rest = DVector::zeros(system.len());
            rest[*shift] = 1.0;
            let basis = structure::basis(&known.into_iter().map(|(_, shift)| shift).collect::<Vec<_>>(), system.len());
            let left = &rest - &basis * (basis.transpose() * &rest);
            if left.norm() > WITHIN {
                return Err(NoOrbit::ShiftMatters { coordinate: name.clone() }.into());
            }
        }
        let later = if timed { lap } else { 0.0 };
        if !closing.is_plain() || closing.turns.iter().any(|turn| *turn != 0.0) {
            let states = states_of(&run);
            if let Some(difference) = closing.differs(&*system, &states, later) {
                let super::closing::Difference { coordinate, here, there } = difference;
                return Err(NoOrbit::NoSymmetry { coordinate, here, there }.into());
            }
        }
        let acts = run.junctions.iter().any(|junction| !junction.events.is_empty());
        let legs = match closing.by {
            By::After { count, .. } => count,
            By::Part(_) if acts => 1,
            By::Part(part) => self.legs.unwrap_or((LEGS / part).max(2)),
        };
        let given = closing != Closing::period(&description);
        let condition = self.energy.map(|energy| Condition::Energy(energy + rest_energy));
        let laps = Laps {
            system,
            settings,
            closing,
            time,
            drive,
            laps: 1,
            legs,
            parameter: None,
            condition,
            scales,
            runs: 0,
            steps: 0,
        };
        let point = laps.along(&run, lap)?;
        Ok(Begun { laps, point, given, acts, rest_energy, repeats: 1, chosen: self.legs.is_some() })
    }
}

/// A search that has begun.
pub(super) struct Begun {
    pub laps: Laps,
    pub point: Point,
    /// Whether the user said how the motion closes.
    given: bool,
    /// Whether events change something on the way.
    acts: bool,
    /// The energy of the equilibrium from which energies are counted, J.
    pub rest_energy: f64,
    repeats: usize,
    /// Whether the user chose the number of pieces.
    chosen: bool,
}

impl Laps {
    /// Starts of all pieces on a run.
    fn along(&self, run: &Run, lap: f64) -> Result<Point, Error> {
        let parameter = self.parameter.and_then(|k| self.system.parameters().get(k).copied()).unwrap_or(0.0);
        let first = run.first();
        let mut starts = vec![[first.q, first.v].concat()];
        if self.time == Time::Event {
            // Each lap begins where the one before ends.
            let mut point = Point { starts, lap, parameter };
            let begun = run.last();
            let mut y = [begun.q, begun.v].concat();
            for k in 1..self.laps * self.legs {
                if self.closes(k - 1) {
                    y = self.closing.image(&y);
                }
                point.starts.push(y.clone());
            }
            return Ok(point);
        }
        for k in 1..self.legs {
            let t = first.t + lap * k as f64 / self.legs as f64;
            let state = run.at(t).ok_or(NoOrbit::NoGuess { until: run.last().t - first.t })?;
            starts.push([state.q, state.v].concat());
        }
        Ok(Point { starts, lap, parameter })
    }
}

impl Begun {
    /// What is told of a solution, by the smallest map that closes it.
    pub fn finish(&mut self, solution: Solution) -> Result<Orbit, Error> {
        let mut steps = solution.steps;
        let mut solution = solution;
        self.at_rest(&solution)?;
        if let Some(smaller) = self.reduce(&solution)? {
            steps += smaller.steps;
            solution = smaller;
        }
        let mut found = spectrum(&mut self.laps, &solution.trial);
        while found.largest > STRETCH && !self.chosen && !self.acts && self.laps.time != Time::Event && self.laps.legs < MOST_LEGS {
            self.laps.legs *= 2;
            let (run, lap) = self.plain(&solution, 1)?;
            let point = self.laps.along(&run, lap)?;
            solution = self.laps.solve(point, None)?;
            steps += solution.steps;
            found = spectrum(&mut self.laps, &solution.trial);
        }
        solution.steps = steps;
        self.told(solution, found)
    }

    /// Refuses a motion that has shrunk to rest.
    fn at_rest(&self, solution: &Solution) -> Result<(), Error> {
        let width = 2 * self.laps.n();
        let goes = (0..width).map(|i| {
            let all = solution.trial.pieces.iter().flat_map(|piece| piece.run.rows.chunks_exact(width).map(move |row| row[i]));
            let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
            (high - low) / self.laps.scales[i]
        });
        if goes.fold(0.0, f64::max) <= SHRUNK { Err(NoOrbit::Rest.into()) } else { Ok(()) }
    }

    /// The plain run of some laps from a solution, and how long a lap takes.
    fn plain(&mut self, solution: &Solution, laps: usize) -> Result<(Run, f64), Error> {
        let n = self.laps.n();
        let y = &solution.trial.pieces[0].start.y;
        let all: f64 = solution.trial.pieces.iter().map(|piece| piece.end.t - piece.start.t).sum();
        let lap = all / self.laps.laps as f64;
        let from = self.laps.settings.from;
        let settings = Settings {
            q: y[..n].to_vec(),
            v: y[n..].to_vec(),
            held_q: Vec::new(),
            held_v: Vec::new(),
            start_conditions: 0..0,
            until: from + laps as f64 * lap,
            ..self.laps.settings.clone()
        };
        Ok((simulate(&mut *self.laps.system, &settings)?, lap))
    }

    /// The solution by the smallest map that closes it, where that is smaller than the one at hand.
    fn reduce(&mut self, solution: &Solution) -> Result<Option<Solution>, Error> {
        if self.given || self.acts || self.laps.closing.by != By::Part(1) {
            return Ok(None);
        }
        let (run, lap) = self.plain(solution, 1)?;
        let from = self.laps.settings.from;
        let Some(closing) = smallest::smallest(&*self.laps.system, &run, (from, lap), &self.laps.scales) else {
            return Ok(None);
        };
        let By::Part(part) = closing.by else { return Ok(None) };
        self.repeats = part / closing.order().min(part);
        self.laps.closing = closing;
        self.laps.legs = if self.chosen { self.laps.legs } else { self.laps.legs.div_ceil(part).max(2) };
        let point = self.laps.along(&run, lap / part as f64)?;
        self.laps.solve(point, None).map(Some)
    }

    fn told(&mut self, solution: Solution, found: Spectrum) -> Result<Orbit, Error> {
        let laps = &mut self.laps;
        let looser = LOOSER * laps.settings.tolerance;
        let rough = laps.try_at(&solution.point, looser).ok();
        let moved = rough.as_ref().map(|rough| solution.linear.step(&rough.r) - solution.linear.step(&solution.trial.r));
        let rough_found = rough.as_ref().map(|rough| spectrum(laps, rough));
        let width = 2 * laps.n();
        let error = |i: usize| moved.as_ref().map_or(f64::NAN, |moved| moved[i].abs() + solution.last);
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
            Time::Driven(_) => 4.0 * f64::EPSILON * duration,
            Time::Event => rough.as_ref().map_or(f64::NAN, |rough| (laps.duration(rough) - duration).abs() + solution.last * duration),
        };
        let free = self.free(&solution, &found.generators);
        let laps = &mut self.laps;
        let conservative = laps.system.description().structure.conservative;
        let side = solution.trial.pieces[0].start.clone();
        crate::vary::put(&mut *laps.system, &side);
        let energy = conservative.then(|| structure::energy(&*laps.system, &side) - self.rest_energy);
        let events = itinerary(&solution.trial.pieces)
            .into_iter()
            .flat_map(|(events, _)| events)
            .map(|event| laps.system.description().events[event].name.to_string());
        let events: Vec<String> = events.collect();
        let total = (duration / (duration_of_lap(&solution) / laps.laps as f64)).round() as usize;
        let (run, _) = self.plain(&solution, total.max(1))?;
        let laps = &self.laps;
        let part = total.max(1) / laps.laps.max(1);
        Ok(Orbit {
            period: Value { name: "period".to_owned(), value: duration, error: period_error },
            returns: self.misses(&run),
            start,
            part: part.max(1),
            map: laps.closing.words(laps.system.description()),
            multipliers: beside(&found.multipliers, rough_found.as_ref().map(|found| found.multipliers.as_slice())),
            known: found.known,
            superstable: found.lost,
            free,
            energy,
            events,
            run,
            steps: solution.steps,
            runs: laps.runs,
            legs: laps.legs,
            repeats: self.repeats,
        })
    }

    /// How far a run misses its start, but for shifts and turns.
    fn misses(&self, run: &Run) -> f64 {
        let (first, last) = (run.first(), run.last());
        let laps = &self.laps;
        let n = laps.n();
        let apart = |i: usize| {
            let (a, b) = if i < n { (first.q[i], last.q[i]) } else { (first.v[i - n], last.v[i - n]) };
            let free = i < n && (laps.closing.shifts.contains(&i) || laps.closing.turns[i] != 0.0);
            if free { 0.0 } else { (a - b).abs() / laps.scales[i] }
        };
        (0..2 * n).map(apart).fold(0.0, f64::max)
    }

    /// Names of directions in which there are other such motions.
    fn free(&self, solution: &Solution, generators: &[super::structure::Known]) -> Vec<String> {
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
                named.push(match generator.name.as_str() {
                    name if name == "time" || name.starts_with("shift") => name.to_owned(),
                    name => format!("what `{name}` generates"),
                });
                known.push(generator.direction.clone());
            }
        }
        for _ in named.len()..list.len() {
            named.push(if self.scales(solution, &span, &known) { "scale" } else { "family" }.to_owned());
        }
        named
    }

    /// Whether places all grow alike, and speeds alike, within a span and up to known directions.
    fn scales(&self, solution: &Solution, span: &nalgebra::DMatrix<f64>, known: &[DVector<f64>]) -> bool {
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

fn duration_of_lap(solution: &Solution) -> f64 {
    solution.trial.pieces.iter().map(|piece| piece.end.t - piece.start.t).sum()
}

/// A run along the guess, the sizes of [q; q'], and how long a lap takes; the settings begin where it does.
fn first_run(
    system: &mut dyn System,
    settings: &mut Settings,
    closing: &Closing,
    period: Option<f64>,
) -> Result<(Run, Vec<f64>, f64), Error> {
    let junctions = Settings { junctions: true, ..settings.clone() };
    if let By::After { event, .. } = closing.by {
        let run = simulate(system, &Settings { ends_after: Some(event), ..junctions })?;
        let lap = run.last().t - run.first().t;
        let scales = sizes(&run);
        return Ok((run, scales, lap));
    }
    let By::Part(part) = closing.by else { return Err(NoOrbit::Rest.into()) };
    if let Some(period) = period {
        let lap = period / part as f64;
        let run = simulate(system, &Settings { until: settings.from + lap, ..junctions })?;
        let scales = sizes(&run);
        return Ok((run, scales, lap));
    }
    let run = simulate(system, &junctions)?;
    let scales = sizes(&run);
    let until = run.last().t - run.first().t;
    let Some(found) = guess::returns(&run, &scales, &closing.shifts).into_iter().next() else {
        return Err(NoOrbit::NoGuess { until }.into());
    };
    let from = run.at(found.t).ok_or(NoOrbit::NoGuess { until })?;
    (settings.q, settings.v) = (from.q, from.v);
    (settings.held_q, settings.held_v) = (Vec::new(), Vec::new());
    let phase = run.phases.iter().rev().find(|(t, _)| *t <= found.t).map(|(_, phase)| *phase);
    settings.phase = phase.unwrap_or(settings.phase);
    let lap = found.period / part as f64;
    let junctions = Settings { junctions: true, ..settings.clone() };
    let run = simulate(system, &Settings { until: settings.from + lap, ..junctions })?;
    Ok((run, scales, lap))
}

/// How far coordinates of one unit go, and rates.
fn sizes(run: &Run) -> Vec<f64> {
    let coordinates = &run.description.coordinates;
    let n = coordinates.len();
    let range = |i: usize| {
        let values = run.rows.chunks_exact(2 * n).map(|row| row[i]);
        let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        high - low
    };
    let of = |i: usize| {
        let half = if i < n { 0 } else { n };
        let alike = (0..n).filter(|k| coordinates[*k].unit == coordinates[i - half].unit);
        Some(alike.map(|k| range(half + k)).fold(0.0, f64::max)).filter(|size| *size > 0.0).unwrap_or(1.0)
    };
    (0..2 * n).map(of).collect()
}

/// States along a run, with their phases.
fn states_of(run: &Run) -> Vec<(f64, Vec<f64>, usize)> {
    let phase = |t: f64| run.phases.iter().rev().find(|(begin, _)| *begin <= t).map_or(0, |(_, phase)| *phase);
    run.states().map(|state| (state.t, [state.q, state.v].concat(), phase(state.t))).collect()
}

fn event_index(description: &Description, name: &str) -> Result<usize, Error> {
    description.events.iter().position(|event| event.name == name).ok_or_else(|| Error::UnknownName {
        kind: "event",
        name: name.to_owned(),
        known: description.events.iter().map(|event| event.name.to_string()).collect(),
    })
}

fn coordinate_index(description: &Description, name: &str) -> Result<usize, Error> {
    description.coordinates.iter().position(|coordinate| coordinate.name == name).ok_or_else(|| Error::UnknownName {
        kind: "coordinate",
        name: name.to_owned(),
        known: description.coordinates.iter().map(|coordinate| coordinate.name.to_string()).collect(),
    })
}

/// Exchanges coordinates and phases: at the end the first is where the second was.
fn exchange(closing: &mut Closing, description: &Description, pairs: &[(String, String)]) -> Result<(), Error> {
    let phase = |name: &str| description.phases.iter().position(|phase| phase.name == name);
    let coordinate = |name: &str| description.coordinates.iter().position(|coordinate| coordinate.name == name);
    for (a, b) in pairs {
        let also = |name: &str| pairs.iter().any(|(other, _)| other == name);
        if let (Some(a), Some(k)) = (phase(a), phase(b)) {
            closing.phases[a] = k;
            if !also(b) {
                closing.phases[k] = a;
            }
            continue;
        }
        let (Some(i), Some(k)) = (coordinate(a), coordinate(b)) else {
            let name = if coordinate(a).is_some() { b } else { a };
            coordinate_index(description, name)?;
            continue;
        };
        closing.images[k].0 = i;
        if !also(b) {
            closing.images[i].0 = k;
        }
    }
    Ok(())
}
