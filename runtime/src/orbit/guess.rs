//! Where to look for a motion that repeats.

use nalgebra::DVector;

use super::closing::{By, Closing};
use crate::error::{Error, NoOrbit};
use crate::linear::{
    Guess, Linearised, Reduction, equilibrium_near, guess_of_rest, has_dependent_coordinates, linearise,
    linearise_constrained, normal_modes,
};
use crate::mechanism::System;
use crate::run::Run;
use crate::simulate::{Settings, simulate};

/// States of a run that are compared.
const SAMPLES: usize = 4000;
/// A motion has left a state where it is farther from it than this part of the farthest.
const LEFT: f64 = 0.3;
/// And is back where it is nearer than this part.
const BACK: f64 = 0.1;

/// A state and after how long the motion comes near to it again.
pub(super) struct Return {
    /// s.
    pub t: f64,
    pub period: f64,
    /// How near, in parts of how far it goes.
    pub distance: f64,
}

/// Begins a run in a state [q; q'], all of which is held.
pub(super) fn begin_at(settings: &mut Settings, y: Vec<f64>) {
    settings.begin_in(&y);
}

/// Near returns of a run to its first state and to its last one, the nearest first.
pub(super) fn returns(run: &Run, scales: &[f64], free: &[usize]) -> Vec<Return> {
    let (first, last) = (run.first().t, run.last().t);
    let times: Vec<f64> = (0..=SAMPLES).map(|k| first + (last - first) * k as f64 / SAMPLES as f64).collect();
    let states: Vec<Vec<f64>> =
        times.iter().filter_map(|t| run.at(*t)).map(|state| [state.q, state.v].concat()).collect();
    let n = scales.len() / 2;
    let apart = |a: &[f64], b: &[f64]| -> f64 {
        let counted = (0..2 * n).filter(|i| !free.contains(i));
        counted.map(|i| ((a[i] - b[i]) / scales[i]).powi(2)).sum::<f64>().sqrt()
    };
    let mut found = Vec::new();
    for backwards in [false, true] {
        let order: Vec<usize> = if backwards { (0..states.len()).rev().collect() } else { (0..states.len()).collect() };
        let distances: Vec<f64> = order.iter().map(|k| apart(&states[*k], &states[order[0]])).collect();
        let farthest = distances.iter().fold(0.0_f64, |most, x| most.max(*x));
        let Some(left) = distances.iter().position(|x| *x > LEFT * farthest) else { continue };
        // The first minimum that is near, the end of a run for as long as the period included, else the nearest.
        let end = distances.len() - 1;
        let is_least = |k: &usize| {
            let falls = distances[*k] <= distances[k - 1];
            falls && if *k == end { distances[end] < BACK * farthest } else { distances[*k] <= distances[k + 1] }
        };
        let minima: Vec<usize> = (left.max(1)..=end).filter(is_least).collect();
        let near = minima.iter().find(|k| distances[**k] < BACK * farthest);
        let best = near.or_else(|| minima.iter().min_by(|a, b| distances[**a].total_cmp(&distances[**b])));
        if let Some(&k) = best {
            let around = (k < end).then(|| [k - 1, k, k + 1].map(|k| distances[k].powi(2)));
            let shift = around.map_or(0.0, vertex);
            let step = (last - first) / SAMPLES as f64;
            let period = (k as f64 + shift) * step;
            let t = if backwards { last - period } else { first };
            found.push(Return { t, period, distance: distances[k] / farthest });
        }
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    found
}

/// Where a parabola through three values at −1, 0, 1 has its vertex.
fn vertex([before, here, after]: [f64; 3]) -> f64 {
    let curvature = before - 2.0 * here + after;
    if curvature > 0.0 { (0.5 * (before - after) / curvature).clamp(-0.5, 0.5) } else { 0.0 }
}

/// A mode of small motions about the equilibrium near a start.
struct RestingMode {
    linear: Linearised,
    omega: f64,
    /// The shape in the independent coordinates, and in all.
    independent: Vec<f64>,
    shape: Vec<f64>,
    /// Rates there: 0 but for gyroscopic forces, under which coordinates turn round at different times.
    rates: Vec<f64>,
}

impl RestingMode {
    fn find(system: &dyn System, start: &[f64], number: usize) -> Result<RestingMode, Error> {
        let near = Guess::at(&guess_of_rest(system, start));
        let (linear, follow) = match has_dependent_coordinates(system) {
            true => {
                let found = linearise_constrained(system, &near, false).map_err(Error::from)?;
                (found.linear, Some(found.motions))
            }
            false => {
                let equilibrium = equilibrium_near(system, &near).map_err(Error::from)?;
                (linearise(system, &equilibrium).map_err(Error::from)?, None)
            }
        };
        let modes = match linear.gyroscopic().to_dense().iter().all(|x| *x == 0.0) {
            true => normal_modes(&linear, Reduction::default()),
            false => linear.modes(),
        };
        let modes = modes.map_err(Error::from)?;
        let mode = number.checked_sub(1).and_then(|k| modes.get(k)).filter(|mode| mode.omega > 0.0);
        let Some(mode) = mode else { return Err(NoOrbit::NoMode { mode: number, known: modes.len() }.into()) };
        let all = |part: &[f64]| match &follow {
            Some(motions) => (motions * DVector::from_column_slice(part)).as_slice().to_vec(),
            None => part.to_vec(),
        };
        // Turned so that what moves most is where it turns round.
        let most = mode.shape.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).copied().unwrap_or_default();
        let turned: Vec<_> = mode.shape.iter().map(|x| x * (most.conj() / most.norm())).collect();
        let independent: Vec<f64> = turned.iter().map(|x| x.re).collect();
        let rates = all(&turned.iter().map(|x| (x * mode.eigenvalue).re).collect::<Vec<_>>());
        let shape = all(&independent);
        Ok(RestingMode { omega: mode.omega, linear, independent, shape, rates })
    }

    /// The coordinate that moves most, by its place, and by how much in the shape.
    fn largest(&self) -> (usize, f64) {
        let most = |most: (usize, f64), (k, x): (usize, &f64)| if x.abs() > most.1.abs() { (k, *x) } else { most };
        self.shape.iter().enumerate().fold((0, 0.0), most)
    }
}

/// The coordinate that moves most in a mode about the equilibrium near a start, by its place.
///
/// # Errors
/// As [`mode`].
#[cfg(feature = "cli")]
pub(super) fn most_moved(system: &dyn System, start: &[f64], number: usize) -> Result<usize, Error> {
    Ok(RestingMode::find(system, start, number)?.largest().0)
}

/// An amplitude is shortened by this factor, at most so often (to a millionth), until its energy is no more than so many times the one that is wanted:
/// from there Newton's steps find the rest.
const SHORTER: f64 = 0.8;
const SHORTENED: usize = 60;
const NEAR_ENOUGH: f64 = 1.2;

/// A state displaced from the equilibrium along a mode, at rest but for gyroscopic forces, so that the coordinate that moves most moves by this
/// amplitude, or by as much as gives small motions an energy; the period of small motions, the coordinates of the equilibrium, and the coordinate that moves most.
/// With constraints it is displaced along a tangent of theirs, and the run that begins there closes them.
///
/// # Errors
/// No equilibrium, no such mode.
pub(super) fn mode(
    system: &dyn System,
    start: &[f64],
    (number, amplitude): (usize, f64),
    wanted: Option<f64>,
) -> Result<(Vec<f64>, f64, Vec<f64>, usize), Error> {
    let mode = RestingMode::find(system, start, number)?;
    let (moves, largest) = mode.largest();
    let RestingMode { linear, omega, independent, shape, rates } = mode;
    let rests = &linear.equilibrium.q;
    let displaced = |amplitude: f64| -> Vec<f64> {
        let mut q: Vec<f64> = rests.iter().zip(&shape).map(|(q, x)| q + amplitude * x / largest).collect();
        for first in system.description().rotations.iter() {
            let quaternion = &mut q[*first as usize..*first as usize + 4];
            let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
        q
    };
    let speeds = |amplitude: f64| rates.iter().map(|rate| amplitude * rate / largest).collect::<Vec<f64>>();
    let least = system.energy(crate::mechanism::At::new(0.0, rests, &speeds(0.0))).jacobi;
    // By the energy of small motions, which an amplitude that is large for the mechanism does not have.
    let small = DVector::from_column_slice(&independent) * (amplitude / largest);
    let risen = 0.5 * omega * omega * small.dot(&(linear.m() * &small));
    let grown = wanted.map(|wanted| (wanted / risen).sqrt());
    let mut factor = grown.filter(|factor| factor.is_finite() && *factor > 0.0).unwrap_or(1.0);
    if let Some(wanted) = wanted.filter(|_| !has_dependent_coordinates(system)) {
        // What gets stiffer has this energy sooner.
        let energy = |factor: f64| {
            let (q, v) = (displaced(factor * amplitude), speeds(factor * amplitude));
            system.energy(crate::mechanism::At::new(0.0, &q, &v)).jacobi - least
        };
        for _ in 0..SHORTENED {
            if energy(factor) <= wanted * NEAR_ENOUGH {
                break;
            }
            factor *= SHORTER;
        }
    }
    Ok((
        [displaced(factor * amplitude), speeds(factor * amplitude)].concat(),
        std::f64::consts::TAU / omega,
        rests.clone(),
        moves,
    ))
}

/// A run along the guess, the sizes of [q; q'], and how long a lap takes; the settings begin where it does.
pub(super) fn first_run(
    system: &mut dyn System,
    settings: &mut Settings,
    closing: &Closing,
    (period, may_settle): (Option<f64>, bool),
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
        if may_settle {
            settle(system, settings, (closing, lap))?;
        }
        let junctions = Settings { junctions: true, ..settings.clone() };
        let run = simulate(system, &Settings { until: settings.from + lap, ..junctions })?;
        let scales = sizes(&run);
        return Ok((run, scales, lap));
    }
    let run = simulate(system, &junctions)?;
    let scales = sizes(&run);
    let until = run.last().t - run.first().t;
    // A start that is said to be its own image with time reversed is one, and no state on the way is.
    let begins_here = |found: &Return| closing.reversed.is_empty() || found.t == run.first().t;
    let Some(found) = returns(&run, &scales, &closing.shifts).into_iter().find(begins_here) else {
        let why = if rests(&[&run]) { NoOrbit::Rest } else { NoOrbit::NoGuess { until } };
        return Err(why.into());
    };
    let from = run.at(found.t).ok_or(NoOrbit::NoGuess { until })?;
    begin_at(settings, [from.q, from.v].concat());
    let phase = run.phases.iter().rev().find(|(t, _)| *t <= found.t).map(|(_, phase)| *phase);
    settings.phase = phase.unwrap_or(settings.phase);
    let lap = found.period / part as f64;
    let junctions = Settings { junctions: true, ..settings.clone() };
    let run = simulate(system, &Settings { until: settings.from + lap, ..junctions })?;
    Ok((run, scales, lap))
}

/// Begins a driven motion where its run has settled, if that closes better than its start does: after as many laps as the run has.
fn settle(system: &mut dyn System, settings: &mut Settings, (closing, lap): (&Closing, f64)) -> Result<(), Error> {
    let laps = ((settings.until - settings.from) / lap).floor();
    if laps < 2.0 {
        return Ok(());
    }
    let from = settings.from;
    let run = simulate(system, settings)?;
    let scales = sizes(&run);
    let state = |k: f64| run.at(from + k * lap).map(|state| [state.q, state.v].concat());
    let apart = |k: f64| {
        let (Some(before), Some(after)) = (state(k), state(k + 1.0)) else { return f64::INFINITY };
        let image = closing.image(&after);
        before.iter().zip(&image).zip(&scales).map(|((a, b), scale)| ((a - b) / scale).powi(2)).sum::<f64>()
    };
    let last = laps - 1.0;
    let phase = |t: f64| run.phases.iter().rev().find(|(begin, _)| *begin <= t).map(|(_, phase)| *phase);
    // A map that mirrors or exchanges brings back the start's own time only after as many laps as it has.
    let whole = last - last % closing.order() as f64;
    if apart(whole) < apart(0.0) {
        let at = run.at(from + whole * lap).ok_or(NoOrbit::NoGuess { until: run.last().t - from })?;
        settings.phase = phase(at.t).unwrap_or(settings.phase);
        begin_at(settings, [at.q, at.v].concat());
    }
    Ok(())
}

/// A coordinate that moves by this part of itself moves by rounding.
const RESTS: f64 = 64.0 * f64::EPSILON;

/// A rate that changes by no more than this part of itself is steady: what changes is what errors of a run make of it.
const STEADY: f64 = 1e-6;

/// How far coordinates of one unit go, and rates.
pub(super) fn sizes(run: &Run) -> Vec<f64> {
    sizes_of_pieces(&[run])
}

/// The range of a number of [q; q'] along a motion in pieces, and the size beside which it may be rounding.
fn range_of_pieces(pieces: &[&Run], i: usize) -> (f64, f64) {
    let Some(run) = pieces.first() else { return (0.0, 0.0) };
    let width = 2 * run.description.coordinates.len();
    let values = pieces.iter().flat_map(|run| run.rows.chunks_exact(width)).map(|row| row[i]);
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    // Rounding of a number of a quaternion is that of its length, which is 1.
    let is_of_rotation =
        run.description.rotations.iter().any(|first| (*first as usize..*first as usize + 4).contains(&i));
    (high - low, high.abs().max(low.abs()).max(f64::from(u8::from(is_of_rotation))))
}

/// Whether a coordinate moves by no more than rounding along a motion in pieces.
fn coordinate_rests(pieces: &[&Run], i: usize) -> bool {
    let (range, largest) = range_of_pieces(pieces, i);
    range <= RESTS * largest
}

/// Whether all coordinates do.
pub(super) fn rests(pieces: &[&Run]) -> bool {
    pieces.first().is_some_and(|run| (0..run.description.coordinates.len()).all(|i| coordinate_rests(pieces, i)))
}

/// How far coordinates of one unit go, and rates, in a motion in pieces.
pub(super) fn sizes_of_pieces(pieces: &[&Run]) -> Vec<f64> {
    let Some(run) = pieces.first() else { return Vec::new() };
    let coordinates = &run.description.coordinates;
    let n = coordinates.len();
    let range = |i: usize| {
        let (range, largest) = range_of_pieces(pieces, i);
        // What rests has a rate of rounding too.
        match coordinate_rests(pieces, i % n) {
            true => 0.0,
            // A rate that stays as it is has the size of itself.
            false if i >= n && range <= STEADY * largest => largest,
            false => range,
        }
    };
    let of = |i: usize| {
        let half = if i < n { 0 } else { n };
        let alike = (0..n).filter(|k| coordinates[*k].unit == coordinates[i - half].unit);
        Some(alike.map(|k| range(half + k)).fold(0.0, f64::max)).filter(|size| *size > 0.0).unwrap_or(1.0)
    };
    (0..2 * n).map(of).collect()
}

/// States along a run, with their phases.
pub(super) fn states_of(run: &Run) -> Vec<(f64, Vec<f64>, usize)> {
    let phase = |t: f64| run.phases.iter().rev().find(|(begin, _)| *begin <= t).map_or(0, |(_, phase)| *phase);
    run.states().map(|state| (state.t, [state.q, state.v].concat(), phase(state.t))).collect()
}
