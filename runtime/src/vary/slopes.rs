//! A run with its slopes.

use std::collections::BTreeMap;

use super::flow::{Flow, Moment, Way, at_event, follow, range};
use super::junction::{Column, put, slides};
use super::response::Response;
use super::second::{Second, second};
use super::start::{self, Start};
use super::{NoSlopes, Unknown};
use crate::error::Error;
use crate::events::{switch_mode, switch_text};
use crate::mechanism::{Along, At, Enforcement, Function, Method, Stabilisation, System};
use crate::run::{Names, Run, Side};
use crate::simulate::{Origin, Settings, Simulation, settled, simulate};
use crate::trust::not_unique;

/// A run, and how its numbers change with its start and with parameters.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Slopes {
    /// The motion.
    pub run: Run,
    /// What slopes are by: coordinates and rates at the start (`theta`, `theta'`), parameters.
    pub unknowns: Vec<String>,
    /// By how much the end of the run moves, s in each unknown's unit, where an event ends it; else 0.
    pub end_time: Vec<Slope>,
    times: Vec<f64>,
    names: Vec<String>,
    /// For each time and unknown, the slopes of all columns.
    values: Vec<Vec<Vec<Slope>>>,
}

/// A derivative, SI, and how far it may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slope {
    /// ∂x/∂p.
    pub value: f64,
    /// The difference to the value of a run at sixteen times the tolerance, or, where that has the same steps, twice that to a run with half the
    /// steps; at least rounding; NaN where there was no second run.
    pub error: f64,
}

/// So much of a number p ∂x/∂p, beside the largest x, may be rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Less than this part of the largest slope with the same unit is rounding of rounding, in which two runs may agree and both be wrong.
const NOTHING: f64 = 1e-20;

impl Slopes {
    /// The times at which there are slopes, s; the last is the run's end.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// What there are slopes of: coordinates, rates, outputs component by component.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// The slope of a coordinate, a rate or an output at the end of the run by an unknown; where an event ends the run, of its value when
    /// the event happens.  `None` if there are none of these names.
    pub fn get(&self, name: &str, unknown: &str) -> Option<Slope> {
        self.at(self.times.len().checked_sub(1)?, name, unknown)
    }

    /// The same at another of [`Slopes::times`].
    pub fn at(&self, time: usize, name: &str, unknown: &str) -> Option<Slope> {
        let unknown = self.unknowns.iter().position(|known| known == unknown)?;
        let column = self.names.iter().position(|known| known == name)?;
        self.values.get(time)?.get(unknown)?.get(column).copied()
    }

    /// How rows that depend on each other share a force is a rule, and not an equation whose slope is known.
    fn forget_shares(&mut self, system: &dyn System) {
        let n = system.len();
        let Some(last) = self.run.len().checked_sub(1) else { return };
        let shared = not_unique(system, self.run.times[last], &self.run.rows[2 * n * last..][..2 * n]);
        for values in self.values.iter_mut().flatten() {
            shared.iter().for_each(|output| values[2 * n + output] = Slope { value: f64::NAN, error: f64::NAN });
        }
    }
}

impl<S: System> Simulation<S> {
    /// Runs, and tells how the motion changes with its start and with parameters: ∂x/∂p of all coordinates, rates and outputs x at the end
    /// (where `every` was given, at all reported times), by the variational equations, through events, impacts, switches and on constraints.
    ///
    /// Unknowns p are named as `theta`, `theta'` (at the start) or by a parameter's name.  Derived parameters follow the parameters that they
    /// are made of, and so does a scene's start.  Where an event ends the run, slopes are those of the state in which it happens.
    ///
    /// # Errors
    /// Those of [`Simulation::run`]; a name that is neither a coordinate's nor a parameter's; [`Error::NoSlopes`].
    pub fn slopes(self, unknowns: &[&str]) -> Result<Slopes, Error> {
        let (mut system, settings, origin) = self.described()?;
        let named = unknowns.iter().map(|name| Ok(((*name).to_owned(), unknown(&system, name)?)));
        let named: Vec<(String, Unknown)> = named.collect::<Result<_, Error>>()?;
        run_with_slopes(&mut system, &settings, &origin, &named)
    }
}

/// What a name stands for: a coordinate or a rate at the start, or a parameter.
///
/// # Errors
/// [`Error::UnknownName`].
pub(crate) fn unknown(system: &dyn System, name: &str) -> Result<Unknown, Error> {
    let description = system.description();
    if let Some(place) = description.place_of(name) {
        return Ok(Unknown::Start(place));
    }
    if let Some(place) = description.parameters.iter().position(|parameter| parameter.name == name) {
        return Ok(Unknown::Parameter(place));
    }
    let parameters = description.parameters.iter().map(|parameter| parameter.name.to_string());
    let known = description.start_names().into_iter().chain(parameters);
    Err(Error::unknown("coordinate, rate or parameter", name, known))
}

/// Runs a motion with the slopes by these unknowns, at its end and, where `every` is given, at the reported times.
///
/// # Errors
/// Those of [`simulate`]; [`Error::NoSlopes`].
pub(crate) fn run_with_slopes(
    system: &mut dyn System,
    settings: &Settings,
    origin: &Origin,
    unknowns: &[(String, Unknown)],
) -> Result<Slopes, Error> {
    let list: Vec<Unknown> = unknowns.iter().map(|(_, unknown)| *unknown).collect();
    let fine = varied(system, settings, origin, &list, None).map_err(|error| named(error, unknowns))?;
    let again = |other: &Settings| varied(system, other, origin, &list, None);
    let other = second(&fine, settings, again, |other| other).filter(|other| other.run.agrees(&fine));
    let mut slopes = fine.beside(other.as_ref(), unknowns, Names::of(system.description()).columns());
    slopes.forget_shares(system);
    Ok(slopes)
}

fn may_be_varied(system: &dyn System, settings: &Settings) -> Result<(), NoSlopes> {
    if settings.method == Method::Moreau {
        return Err(NoSlopes::StepsOver);
    }
    if !system.sampling().is_empty() {
        return Err(NoSlopes::Memory);
    }
    let mut numbers = vec![0.0; system.len()];
    let zero = vec![0.0; system.len()];
    let multipliers = vec![0.0; system.description().rows.len()];
    let at = At::new(settings.from, &zero, &zero).accelerated(&zero).constrained(&multipliers);
    if !system.slopes(Function::Residual, at, &Along::default(), &mut numbers) {
        return Err(NoSlopes::Unknown);
    }
    if system.derivation().is_some()
        || settings.enforcement != Enforcement::Multipliers
        || settings.stabilisation != Stabilisation::default()
    {
        return Err(NoSlopes::Accelerations);
    }
    if settings.start_conditions.is_empty() { Ok(()) } else { Err(NoSlopes::StartConditions) }
}

/// With the name of what varies in the place of its number.
pub(crate) fn named(error: Error, unknowns: &[(String, Unknown)]) -> Error {
    let Error::NoSlopes(why) = error else { return error };
    let why = match *why {
        NoSlopes::HeldStart { unknown, constraint } => {
            let name =
                unknown.parse().ok().and_then(|k: usize| unknowns.get(k)).map_or(unknown, |(name, _)| name.clone());
            NoSlopes::HeldStart { unknown: name, constraint }
        }
        why => why,
    };
    why.into()
}

/// A run with its slopes.
pub(crate) struct Varied {
    pub run: Run,
    pub points: Vec<Point>,
    /// By how much each unknown moves the end, s, where an event ends the run; else 0.
    pub end_time: Vec<f64>,
    /// The steps that slopes took.
    pub steps: u64,
    /// How large each unknown is.
    sizes: Vec<f64>,
}

/// What there is at a time.
pub(crate) struct Point {
    /// s.
    pub t: f64,
    /// [q; q'], then the outputs.
    pub values: Vec<f64>,
    /// Their slopes by each unknown.
    pub slopes: Vec<Vec<f64>>,
    /// Their rates.
    pub rates: Vec<f64>,
}

/// Runs with the slopes by unknowns at some times, in order; `None`: where states are reported if `every` is given, else at the end.
///
/// # Errors
/// As [`run_with_slopes`].
pub(crate) fn varied(
    system: &mut dyn System,
    settings: &Settings,
    origin: &Origin,
    unknowns: &[Unknown],
    times: Option<&[f64]>,
) -> Result<Varied, Error> {
    let settings = &Settings { junctions: true, apart: false, ..settings.clone() };
    may_be_varied(system, settings)?;
    let settings = &*settled(system, settings);
    let run = simulate(system, settings)?;
    let n = system.len();
    let y = run.rows[..2 * n].to_vec();
    system.set_phase(settings.phase);
    let first = run.junctions.first().map_or_else(|| system.modes().to_vec(), |junction| junction.before.modes.clone());
    let side = Side { t: settings.from, y, modes: first, phase: settings.phase };
    put(system, &side);
    slides(system, side.t)?;
    let columns = starts(system, (settings, origin), (&run, &side), unknowns)?;
    let sizes = columns.iter().map(|column| column.size).collect();
    let end = run.times.last().copied().unwrap_or(settings.from);
    let times = match (times, settings.every) {
        (Some(times), _) => times.to_vec(),
        (None, Some(_)) => run.times.clone(),
        (None, None) => vec![end],
    };
    let tolerance = settings.tolerance.max(Settings::TIGHTEST);
    let way = Way { tolerance, max_steps: settings.max_steps, interruption: &settings.interruption, times: &times };
    let Flow { mut moments, steps, .. } = follow(system, &run, (side, columns), &way)?;
    let at_end = moments.last_mut().filter(|moment| moment.t == end);
    let shifts = at_the_end(system, &run, unknowns, at_end)?;
    let (last, still) = (moments.len().saturating_sub(1), vec![0.0; unknowns.len()]);
    let mut points = Vec::with_capacity(moments.len());
    for (k, moment) in moments.into_iter().enumerate() {
        points.push(with_outputs(system, moment, unknowns, if k == last { &shifts } else { &still })?);
    }
    Ok(Varied { run, points, end_time: shifts, steps, sizes })
}

/// The columns at the start.
fn starts(
    system: &dyn System,
    (settings, origin): (&Settings, &Origin),
    (run, side): (&Run, &Side),
    unknowns: &[Unknown],
) -> Result<Vec<Column>, NoSlopes> {
    let guess = [settings.q.as_slice(), settings.v.as_slice()].concat();
    let (held, given) = (settings.held(), &origin.given);
    let start =
        Start { t: side.t, guess: &guess, held: &held, spins: &settings.spins, y: &side.y, scene: origin.scene, given };
    let column = |(k, unknown): (usize, &Unknown)| {
        let y = start::column(system, &start, *unknown).map_err(|why| match why {
            NoSlopes::HeldStart { constraint, .. } => NoSlopes::HeldStart { unknown: k.to_string(), constraint },
            why => why,
        })?;
        leaves_no_surface(system, side, &y, unknown.parameter())?;
        Ok(Column { y, parameter: unknown.parameter(), size: size(system, run, *unknown) })
    };
    unknowns.iter().enumerate().map(column).collect()
}

/// Refuses a start on a surface where forces jump that what is unknown moves off it: the motions on the two sides change otherwise.
fn leaves_no_surface(
    system: &dyn System,
    side: &Side,
    column: &[f64],
    parameter: Option<usize>,
) -> Result<(), NoSlopes> {
    let (n, count) = (system.len(), system.description().switches.len());
    let still = vec![0.0; n];
    let at = At::packed(side.t, &side.y, n).accelerated(&still);
    let (mut pairs, mut moved) = (vec![0.0; 2 * count], vec![0.0; 2 * count]);
    system.switches(at, &mut pairs);
    let along = Along { q: &column[..n], v: &column[n..], parameter, ..Along::default() };
    system.slopes(Function::Switches, at, &along, &mut moved);
    let mut flipped = system.boxed_clone();
    let mut forces = |modes: &[f64]| {
        let mut forces = still.clone();
        flipped.set_modes(modes);
        flipped.residual(at, &mut forces);
        forces
    };
    for switch in (0..count).filter(|k| pairs[2 * k] == 0.0 && moved[2 * k] != 0.0) {
        let mut modes = side.modes.clone();
        let sides = [1.0, -1.0].map(|to| {
            modes[switch] = switch_mode(system, switch, to);
            forces(&modes)
        });
        if sides[0] != sides[1] {
            return Err(NoSlopes::Touches { t: side.t, event: switch_text(system, switch) });
        }
    }
    Ok(())
}

/// For each number the largest component of the vector to which it belongs; 0 of what belongs to none.
fn largest_of_vectors(run: &Run, numbers: &[f64]) -> Vec<f64> {
    let mut largest = vec![0.0; numbers.len()];
    let mut first = 2 * run.description.coordinates.len();
    for output in run.description.outputs.iter() {
        let own = first..first + output.components as usize;
        if own.len() > 1 {
            let most = numbers[own.clone()].iter().fold(0.0, |most, x| f64::max(most, x.abs()));
            largest[own.clone()].fill(most);
        }
        first = own.end;
    }
    largest
}

/// For each number the largest of those with its unit.
fn largest_alike(units: &[String], numbers: &[f64]) -> Vec<f64> {
    let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
    for (unit, x) in units.iter().zip(numbers).filter(|(_, x)| x.is_finite()) {
        let most = largest.entry(unit).or_default();
        *most = most.max(x.abs());
    }
    units.iter().map(|unit| largest.get(unit.as_str()).copied().unwrap_or(0.0)).collect()
}

/// How large something unknown is; of what is 0 at the start, how large it becomes; 1 of what stays 0.
fn size(system: &dyn System, run: &Run, unknown: Unknown) -> f64 {
    let found = match unknown {
        Unknown::Parameter(k) => system.parameters().get(k).copied().unwrap_or(0.0).abs(),
        Unknown::Start(k) => Some(run.rows[k].abs()).filter(|x| *x > 0.0).unwrap_or(range(run, 2 * system.len(), k)),
    };
    Some(found).filter(|size| *size > 0.0 && size.is_finite()).unwrap_or(1.0)
}

/// Where an event ended the run, takes the columns there to where it happens, and tells how far that is, s.
fn at_the_end(
    system: &dyn System,
    run: &Run,
    unknowns: &[Unknown],
    moment: Option<&mut Moment>,
) -> Result<Vec<f64>, NoSlopes> {
    let still = vec![0.0; unknowns.len()];
    let (Some(event), Some(moment)) = (run.ended_by, moment) else { return Ok(still) };
    let side = Side { t: moment.t, y: moment.columns[0].clone(), modes: Vec::new(), phase: 0 };
    let list = moment.columns.drain(1..).zip(unknowns);
    let mut columns: Vec<Column> =
        list.map(|(y, unknown)| Column { y, parameter: unknown.parameter(), size: 1.0 }).collect();
    let shifts = at_event(system, (&side, run), event, &mut columns)?;
    moment.columns.extend(columns.into_iter().map(|column| column.y));
    Ok(shifts)
}

/// The values of [q; q'] and of the outputs, with their slopes by each unknown and their rates.
fn with_outputs(system: &dyn System, moment: Moment, unknowns: &[Unknown], shifts: &[f64]) -> Result<Point, NoSlopes> {
    let n = system.len();
    let size = system.description().output_len();
    let mut columns = moment.columns.into_iter();
    let mut values = columns.next().unwrap_or_default();
    let y = values.clone();
    let at = At::packed(moment.t, &y, n);
    let mut response = Response::default();
    let fault =
        |fault: crate::mechanism::Singular| NoSlopes::Fault { t: moment.t, cause: fault.cause(system.description()) };
    response.stand(system, at).map_err(fault)?;
    let a = response.a.clone();
    let lambda = response.lambda.clone();
    let full = at.accelerated(&a).constrained(&lambda);
    let mut outputs = vec![0.0; size];
    system.outputs(full, &mut outputs);
    values.extend(outputs);
    let mut outputs_along = |along: Along<'_>| -> Result<Vec<f64>, NoSlopes> {
        let mut slopes = vec![0.0; size];
        if size > 0 {
            response.along(system, at, &along).map_err(fault)?;
            let along = Along { a: &response.da, lambda: &response.dlambda, ..along };
            system.slopes(Function::Outputs, full, &along, &mut slopes);
        }
        Ok(slopes)
    };
    let mut slopes = Vec::with_capacity(unknowns.len());
    for ((mut column, unknown), shift) in columns.zip(unknowns).zip(shifts) {
        let (q, v) = column.split_at(n);
        let along = Along { t: *shift, q, v, parameter: unknown.parameter(), ..Along::default() };
        let of_outputs = outputs_along(along)?;
        column.extend(of_outputs);
        slopes.push(column);
    }
    let of_outputs = outputs_along(Along { t: 1.0, q: &y[n..], v: &a, ..Along::default() })?;
    let rates = [&y[n..], &a, &of_outputs].concat();
    Ok(Point { t: moment.t, values, slopes, rates })
}

impl Varied {
    /// Whether another one went the same way.
    pub fn agrees(&self, other: &Varied) -> bool {
        let ways = [self, other].map(|varied| {
            let list = varied.run.junctions.iter();
            let passed: Vec<_> = list.map(|junction| (junction.events.clone(), junction.after.phase)).collect();
            (passed, varied.run.ended_by)
        });
        ways[0] == ways[1] && self.points.len() == other.points.len()
    }

    /// The first event of this run that another one does not have at its place, or else has instead of it.
    pub fn differs_by(&self, other: &Varied) -> Option<String> {
        let [own, others] = [self, other].map(|varied| {
            let passed = varied.run.junctions.iter().flat_map(|junction| &junction.events);
            passed.chain(&varied.run.ended_by).copied().collect::<Vec<usize>>()
        });
        let same = own.iter().zip(&others).take_while(|(own, other)| own == other).count();
        let event = own.get(same).or_else(|| others.get(same))?;
        self.run.description.events.get(*event).map(|event| event.name.to_string())
    }

    /// The largest sizes of [q; q'] and of the outputs, of those that are finite.
    fn largest(&self) -> Vec<f64> {
        let Some(point) = self.points.last() else { return Vec::new() };
        let (run, width) = (&self.run, 2 * self.run.description.coordinates.len());
        let outputs = point.values.len() - width;
        let of = |row: usize, i: usize| match i.checked_sub(width) {
            None => run.rows[width * row + i],
            Some(output) => run.outputs[outputs * row + output],
        };
        let most = |i: usize| (0..run.len()).map(|row| of(row, i).abs()).filter(|x| x.is_finite()).fold(0.0, f64::max);
        (0..point.values.len()).map(most).collect()
    }

    fn beside(self, second: Option<&Second<Varied>>, unknowns: &[(String, Unknown)], names: Vec<String>) -> Slopes {
        let (rough, told) = (second.map(|second| &second.run), second.map_or(1.0, |second| second.told));
        let largest = self.largest();
        let units: Vec<String> = names.iter().map(|name| self.run.unit(name)).collect();
        let slope = |value: f64, other: Option<f64>, rounding: f64| Slope {
            value,
            error: other.map_or(f64::NAN, |x| (told * (x - value).abs()).max(rounding)),
        };
        let values = self.points.iter().enumerate().map(|(t, point)| {
            let list = point.slopes.iter().enumerate().map(|(k, column)| {
                let other = rough.map(|rough| &rough.points[t].slopes[k]);
                let (alike, of_vector) = (largest_alike(&units, column), largest_of_vectors(&self.run, column));
                let of = |(i, value): (usize, &f64)| {
                    let rounding = ROUNDING * (largest[i] / self.sizes[k]).max(of_vector[i]);
                    slope(*value, other.map(|other| other[i]), rounding.max(NOTHING * alike[i]))
                };
                column.iter().enumerate().map(of).collect()
            });
            list.collect()
        });
        let end_time = self.end_time.iter().enumerate();
        Slopes {
            unknowns: unknowns.iter().map(|(name, _)| name.clone()).collect(),
            end_time: end_time.map(|(k, shift)| slope(*shift, rough.map(|rough| rough.end_time[k]), 0.0)).collect(),
            names,
            values: values.collect(),
            times: self.points.iter().map(|point| point.t).collect(),
            run: self.run,
        }
    }
}
