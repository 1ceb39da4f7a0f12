//! How far two runs are apart in what is wanted.

use std::sync::Arc;

use nalgebra::DVector;

use crate::mechanism::{At, System};
use crate::numbers::counted;
use crate::precision::WorkUnits;
use crate::run::{Run, apart_by};
use crate::simulate::{Settings, simulate};

/// How far a run is from the full one.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Deviation {
    /// The largest over the scene, in parts of the range that each wanted quantity goes through (of one that is wanted to an amount, of that
    /// amount over `within`); of events, of the scene's length.
    pub largest: f64,
    /// Of which quantity or event.
    pub of: String,
    /// Of that, the phase error: the same motion, by this part faster (or, negative, slower).
    pub phase_error: f64,
    /// What is left of the deviation without the phase error, in the same measure.
    pub waveform_error: f64,
}

/// What is compared of a run.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    pub times: Vec<f64>,
    /// What is wanted, a list for each.
    pub values: Vec<Vec<f64>>,
    /// Instants that are not equally spaced, and what is wanted then, a list for each.
    pub instants: Arc<[f64]>,
    pub looks: Vec<Vec<f64>>,
    /// The range of each and its largest size.
    pub spreads: Vec<(f64, f64)>,
    /// Their units.
    pub units: Vec<String>,
    /// Names and times of events.
    pub events: Vec<(String, f64)>,
    /// Functions of events and discontinuities, by name; nothing with phases.
    pub guards: Vec<(String, Vec<f64>)>,
    /// Evaluations of the accelerations, and all else in their terms, times operations.
    pub operations: f64,
    /// Steps that it took.
    pub steps: u64,
    /// The range of each coordinate, then of each rate.
    pub ranges: Vec<f64>,
    /// Where each is on the average.
    pub means: Vec<f64>,
    /// Where each is at first, when the start has met its constraints.
    pub first: Vec<f64>,
    /// Where each is at a third of the run, and at two thirds.
    pub visited: [Vec<f64>; 2],
}

/// The runs are compared at so many times, or at so many for each step of the full model's, of which its fastest vibration takes some
/// three a period; and never at more.
pub(super) const TIMES: usize = 1000;
const A_STEP: usize = 3;
const MOST_TIMES: usize = 8000;
/// No reduction takes so many steps.
pub(super) const MOST_STEPS: u64 = 400_000;
/// Beside an event is what is this part of the scene from it.
const INSTANT: f64 = 1e-9;
/// What moves less beside its size stands still.
const STILL: f64 = 1e-9;
/// And what moves less than so many times by which two runs differ.
const SURE: f64 = 10.0;
/// What others explain all of but this part of is nothing of its own; a phase error by itself is this part of what is faster at the least.
const SEEN: f64 = 1e-6;
const TOLD: f64 = 0.3;
/// The phase error of a larger deviation is not one of first order.
const CLOCKED: f64 = 0.2;

impl Deviation {
    /// The phase error and the waveform error; `None` where the deviation is too large to say.
    pub fn parts(&self) -> Option<(f64, f64)> {
        (self.largest <= CLOCKED && self.phase_error.abs() <= CLOCKED)
            .then_some((self.phase_error, self.waveform_error))
    }
}

impl Motion {
    /// A run that reports what is wanted.
    ///
    /// # Errors
    /// What it is that failed, in words.
    pub fn of(
        (system, settings): (&dyn System, &Settings),
        (tolerance, times): (f64, usize),
        (columns, instants): (&[String], &Arc<[f64]>),
    ) -> Result<Motion, String> {
        let mut system = system.boxed_clone();
        let every = Some((settings.until - settings.from) / times as f64);
        let settings = Settings {
            every,
            tolerance,
            max_steps: MOST_STEPS,
            dense: false,
            watch: false,
            instants: Arc::clone(instants),
            ..settings.clone()
        };
        let run = simulate(&mut *system, &settings).map_err(|error| error.to_string())?;
        Motion::from_run(&*system, &run, (columns, instants))
    }

    /// What is compared of a run that reports states at these instants too.
    ///
    /// # Errors
    /// The name of what it has not.
    pub fn from_run(
        system: &dyn System,
        run: &Run,
        (columns, instants): (&[String], &Arc<[f64]>),
    ) -> Result<Motion, String> {
        let mut looked = instants.iter().peekable();
        let at_instant: Vec<bool> = run.times().iter().map(|t| looked.next_if_eq(&t).is_some()).collect();
        let of = |column: Vec<f64>, looked: bool| -> Vec<f64> {
            column.into_iter().zip(&at_instant).filter(|(_, at)| **at == looked).map(|(value, _)| value).collect()
        };
        let column = |name: &String| run.column(name).ok_or_else(|| format!("it has no `{name}`"));
        let all = columns.iter().map(column).collect::<Result<Vec<_>, String>>()?;
        let looks: Vec<Vec<f64>> = all.iter().map(|column| of(column.clone(), true)).collect();
        let values: Vec<Vec<f64>> = all.iter().map(|column| of(column.clone(), false)).collect();
        let state = |name: &String| of(run.column(name).unwrap_or_default(), false);
        let states: Vec<Vec<f64>> = run.column_names().iter().take(2 * system.len()).map(state).collect();
        Ok(Motion {
            times: of(run.times().to_vec(), false),
            spreads: all.iter().map(spread).collect(),
            instants: Arc::clone(instants),
            looks,
            values,
            units: columns.iter().map(|name| run.unit(name)).collect(),
            events: run.events.iter().map(|event| (event.name.clone(), event.state.t)).collect(),
            guards: guards(system, run, &at_instant),
            operations: WorkUnits::of(system, run.method).operations * WorkUnits::of_run(system, run),
            steps: run.work.steps,
            ranges: states.iter().map(|values| spread(values).0).collect(),
            first: states.iter().filter_map(|values| values.first().copied()).collect(),
            visited: [1, 2].map(|third| states.iter().map(|values| values[third * (values.len() - 1) / 3]).collect()),
            means: states.iter().map(|values| values.iter().sum::<f64>() / values.len() as f64).collect(),
        })
    }

    /// The same at [`TIMES`] times of so many, between which differences are not rough.
    pub fn coarse(&self, times: usize) -> Motion {
        let stride = (times / TIMES).max(1);
        let thinned = |values: &Vec<f64>| values.iter().step_by(stride).copied().collect();
        Motion { times: thinned(&self.times), values: self.values.iter().map(thinned).collect(), ..self.clone() }
    }

    /// The range of each wanted quantity, by which its deviations are measured, and its size where that stands still, or moves by
    /// less than another run of the same model is sure of; `None` for what does not move beside others of its unit, but by rounding.
    pub fn scales(&self, again: &Motion) -> Vec<Option<f64>> {
        let of = |(place, values): (usize, &Vec<f64>)| {
            let ((range, size), others) = (self.spreads[place], &again.values[place]);
            let apart = values.iter().zip(others).map(|(a, b)| (a - b).abs()).filter(|apart| apart.is_finite());
            let unsure = apart.fold(0.0_f64, f64::max);
            if range > STILL * size && range > SURE * unsure { range } else { size }
        };
        let scales: Vec<f64> = self.values.iter().enumerate().map(of).collect();
        let alike = |unit: &String| {
            let list = scales.iter().zip(&self.units).filter(|(_, other)| *other == unit);
            list.fold(0.0_f64, |most, (scale, _)| most.max(*scale))
        };
        let moves =
            |(scale, unit): (&f64, &String)| (*scale > STILL * alike(unit) && scale.is_finite()).then_some(*scale);
        scales.iter().zip(&self.units).map(moves).collect()
    }
}

/// At how many times runs that are compared with one of so many steps show what vibrates as fast.
pub(super) fn dense_enough(steps: u64) -> usize {
    (A_STEP * steps as usize).div_ceil(TIMES).saturating_mul(TIMES).clamp(TIMES, MOST_TIMES)
}

/// The range of values and their largest size; what is no number is left aside.
pub(super) fn spread<'a>(values: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let finite = values.into_iter().copied().filter(|value| value.is_finite());
    let (low, high) =
        finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    ((high - low).max(0.0), low.abs().max(high.abs()))
}

/// Functions of events and discontinuities along a run.
fn guards(system: &dyn System, run: &Run, at_instant: &[bool]) -> Vec<(String, Vec<f64>)> {
    let description = system.description();
    if description.phases.len() > 1 {
        return Vec::new();
    }
    // With constraints only those are told that read neither accelerations nor reactions.
    let (free, unknown) = (description.rows.is_empty(), vec![f64::NAN; description.rows.len()]);
    let (events, switches) = (description.events.len(), description.switches.len());
    let switch = |index: usize| format!("`{}` = 0", crate::events::switch_text(system, index));
    let names = description.events.iter().map(|event| event.name.to_string()).chain((0..switches).map(switch));
    let mut found: Vec<(String, Vec<f64>)> = names.map(|name| (name, Vec::new())).collect();
    let (mut pairs, mut switched) = (vec![0.0; 2 * events], vec![0.0; 2 * switches]);
    let mut a = vec![0.0; system.len()];
    for (state, _) in run.states().zip(at_instant).filter(|(_, at)| !**at) {
        let at = At { lambda: &unknown, ..At::new(state.t, &state.q, &state.v) };
        if !free || system.accelerations(at, &mut a).is_err() {
            a.fill(f64::NAN);
        }
        system.events(at.accelerated(&a), &mut pairs);
        system.switches(at.accelerated(&a), &mut switched);
        for (k, pair) in pairs.chunks(2).chain(switched.chunks(2)).enumerate() {
            found[k].1.push(pair[0]);
        }
    }
    found
}

/// How far `other` is from `full`, with signed differences of each quantity in parts of its scale.
///
/// # Errors
/// What happens otherwise: other events, or in another order.
pub(super) fn between(
    full: &Motion,
    other: &Motion,
    (columns, scales): (&[String], &[f64]),
) -> Result<(Deviation, Vec<Vec<f64>>), String> {
    let names = |motion: &Motion| motion.events.iter().map(|event| event.0.clone()).collect::<Vec<_>>();
    if names(full) != names(other) {
        return Err(differs(&names(full), &names(other)));
    }
    let span = full.times.last().copied().unwrap_or(0.0) - full.times.first().copied().unwrap_or(0.0);
    let moved: Vec<(f64, f64)> = full.events.iter().zip(&other.events).map(|(a, b)| (a.1, (a.1 - b.1).abs())).collect();
    // Beside an event that both have, each at its own time, all that jumps there would count.
    let beside = |t: f64| moved.iter().any(|(at, apart)| (t - at).abs() <= apart + INSTANT * span);
    let shared = full.times.iter().zip(&other.times).take_while(|(a, b)| a == b).count();
    if shared + 1 < full.times.len() && moved.is_empty() {
        return Err("it ends earlier".to_owned());
    }
    let mut worst = Deviation {
        largest: 0.0,
        of: columns.first().cloned().unwrap_or_default(),
        phase_error: 0.0,
        waveform_error: 0.0,
    };
    let mut differences = Vec::with_capacity(columns.len());
    let instants: &[f64] = if full.instants == other.instants { &full.instants } else { &[] };
    let looks = full.looks.iter().zip(&other.looks);
    for ((((name, scale), mine), theirs), looks) in
        columns.iter().zip(scales).zip(&full.values).zip(&other.values).zip(looks)
    {
        let difference = |row: usize| match (mine[row], theirs[row]) {
            _ if beside(full.times[row]) => 0.0,
            // What is nowhere, as a reaction in flight, is no difference where both are.
            (a, b) if !a.is_finite() && !b.is_finite() => 0.0,
            (a, b) if !a.is_finite() || !b.is_finite() => f64::INFINITY,
            (a, b) => (b - a) / scale,
        };
        let signed: Vec<f64> = (0..shared).map(difference).collect();
        let seen = instants.iter().zip(looks.0.iter().zip(looks.1)).filter(|(t, _)| !beside(**t));
        let seen = seen.map(|(_, (a, b))| apart_by(*a, *b) / scale).fold(0.0, f64::max);
        let reported = largest(&signed);
        let largest = reported.max(seen);
        if largest > worst.largest {
            let (phase_error, waveform_error) = phase_error(&full.times[..shared], &mine[..shared], &signed, *scale);
            // What lies between the times of the comparison is none.
            worst = Deviation {
                largest,
                of: name.clone(),
                phase_error,
                waveform_error: waveform_error + (largest - reported),
            };
        }
        differences.push(signed);
    }
    for ((name, _), (_, apart)) in full.events.iter().zip(&moved) {
        if span > 0.0 && apart / span > worst.largest {
            worst = Deviation { largest: apart / span, of: name.clone(), phase_error: 0.0, waveform_error: 0.0 };
        }
    }
    Ok((worst, differences))
}

/// The largest size.
pub(super) fn largest(signed: &[f64]) -> f64 {
    signed.iter().fold(0.0, |most, value| if value.is_nan() { f64::INFINITY } else { most.max(value.abs()) })
}

/// The relative rate s by which e(t) ≈ s t y'(t), beside a shift in place or time and a size that is another or grows, explains most of a
/// deviation, and the largest of what s t y'(t) leaves.
fn phase_error(times: &[f64], values: &[f64], signed: &[f64], scale: f64) -> (f64, f64) {
    let rate = |row: usize| {
        let (before, after) = (row.saturating_sub(1), (row + 1).min(times.len() - 1));
        (values[after] - values[before]) / (times[after] - times[before]) / scale
    };
    let gone = |row: usize| times[row] - times[0];
    let pulls: Vec<f64> = (0..times.len()).map(|row| gone(row) * rate(row)).collect();
    let known: Vec<usize> =
        (0..times.len()).filter(|row| (pulls[*row] + signed[*row] + values[*row]).is_finite()).collect();
    let of = |value: &dyn Fn(usize) -> f64| DVector::from_iterator(known.len(), known.iter().map(|row| value(*row)));
    let (mut pull, mut error) = (of(&|row| pulls[row]), of(&|row| signed[row]));
    let whole = pull.norm();
    // What is larger, shifted or later is not faster: of the phase error is what these explain no part of, where they leave one.
    let value = |row: usize| values[row] / scale;
    let mut others = [of(&|_| 1.0), of(&value), of(&|row| gone(row) * value(row)), of(&rate)];
    let (mut own, mut rest) = (pull.clone(), error.clone());
    for k in 0..others.len() {
        let (before, after) = others.split_at_mut(k);
        let direction = &mut after[0];
        let size = direction.norm();
        for other in before.iter() {
            let along = other.dot(direction);
            direction.axpy(-along, other, 1.0);
        }
        if direction.norm() > SEEN * size {
            direction.normalize_mut();
            for explained in [&mut own, &mut rest] {
                let along = direction.dot(explained);
                explained.axpy(-along, direction, 1.0);
            }
        } else {
            direction.fill(0.0);
        }
    }
    if own.norm() > TOLD * whole {
        (pull, error) = (own, rest);
    }
    let square = pull.norm_squared();
    let s = if square > 0.0 { pull.dot(&error) / square } else { 0.0 };
    let left: Vec<f64> = pulls.iter().zip(signed).map(|(pull, error)| error - s * pull).collect();
    (s, largest(&left))
}

/// How two lists of events differ, in words.
fn differs(full: &[String], other: &[String]) -> String {
    let same = full.iter().zip(other).take_while(|(a, b)| a == b).count();
    let happens = |name: &String| {
        format!("`{name}` happens {} instead of {}", counted(count(other, name), "time"), count(full, name))
    };
    match (full.get(same), other.get(same)) {
        (Some(name), None) => happens(name),
        (None, Some(name)) => happens(name),
        (Some(name), Some(instead)) => format!("`{instead}` happens instead of `{name}`"),
        (None, None) => String::new(),
    }
}

fn count(names: &[String], name: &str) -> usize {
    names.iter().filter(|known| *known == name).count()
}
