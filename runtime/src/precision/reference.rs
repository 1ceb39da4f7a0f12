//! What errors are measured from.

use std::sync::Arc;

use super::{Arithmetic, Candidate, DoubleOnly};
use crate::error::Error;
use crate::mechanism::{HIDDEN, Method};
use crate::run::{Run, uneven};
use crate::simulate::{Settings, simulate};

/// A motion that two different methods agree on, by multipliers and projection where there are constraints.
///
/// Where a model can be interpreted and its motion is smooth, [`WorkPrecision::measure_extended`](super::WorkPrecision) computes it in double-double: errors then reach
/// down to the methods' own rounding.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Reference {
    /// Two methods in `f64` that agree on it.
    pub methods: [Method; 2],
    /// The largest difference of the two, in parts of ranges.
    pub agreement: f64,
    /// What its values were computed in.
    pub arithmetic: Arithmetic,
    /// True where the scene goes on, and two methods agree on fewer than eight digits of it.
    pub is_cut: bool,
    /// What is compared.
    pub columns: Vec<String>,
    pub(crate) times: Vec<f64>,
    /// One list for each column, what these numbers leave out, and what errors of it are measured by.
    pub(crate) values: Vec<Vec<f64>>,
    pub(crate) rests: Vec<Vec<f64>>,
    pub(crate) ranges: Vec<f64>,
    /// [q; q'] where the motion starts, and the largest range of anything that has a component's unit.
    pub(crate) start: Vec<f64>,
    pub(crate) sizes: Vec<f64>,
    /// At what distances, s, and at which other times runs that are compared report.
    pub(crate) reports: (Option<f64>, Arc<[f64]>),
    /// When an event ends the motion, s.
    pub(crate) end: Option<f64>,
    pub(crate) evaluations: u64,
    pub(crate) steps: u64,
}

/// Errors are looked at so many times at equal distances, and as many in between.
pub(crate) const TIMES: f64 = 200.0;
/// So many digits must hold until the end of a scene.
pub(crate) const AGREED: f64 = 1e-8;
/// What moves less beside the most that has its unit is measured by so much of that, or by all of it where that is rounding.
pub(crate) const SMALL: f64 = 1e-6;
const ROUNDED: f64 = 1e-12;
/// The first two of these that go through the motion; a third beside them where they do not agree until its end, as where a long step of one
/// leaves fewer digits between its ends to what is stiff.
const METHODS: [(Method, f64); 4] =
    [(Method::Dop853, 1e-14), (Method::Dopri5, 1e-13), (Method::Radau5, 1e-12), (Method::Rodas5P, 1e-11)];
/// No run of a reference takes more steps.
const MOST_STEPS: u64 = 1_000_000;
/// What is known to fewer digits than this times their agreement is no error of a method.
const CERTAIN: f64 = 3.0;
/// Two runs in double-double that agree have rounded alike: 2⁻¹⁰⁴ at the least.
const ROUNDING: f64 = 4.9e-32;
/// A method may take so many evaluations for each one of the reference, and so many more; where these are many, twice as
/// many and so many more.
const DEARER: u64 = 40;
const LEAST_EVALUATIONS: u64 = 20_000;
const MANY_EVALUATIONS: u64 = 200_000;

impl Reference {
    /// The reference of a candidate's scene, for these columns; none: its coordinates.
    pub(crate) fn find(candidate: &Candidate, columns: &[String]) -> Result<Reference, Error> {
        let mut system = candidate.system.boxed_clone();
        let of = |first: &Run, second: &Run| Reference::of(first, second, (&candidate.settings, columns));
        let mut runs: Vec<Run> = Vec::new();
        let (mut failure, mut cut) = (None, None);
        for (method, tolerance) in METHODS {
            match simulate(&mut *system, &exact(&candidate.settings, method, tolerance)) {
                Ok(run) => runs.push(run),
                Err(error @ Error::Run(_)) if !error.is_interruption() => failure = Some(error),
                Err(error) => return Err(error),
            }
            match runs.as_slice() {
                [first, second] => match of(first, second) {
                    Ok(whole) if !whole.is_cut => return Ok(whole),
                    found => cut = Some(found),
                },
                [first, second, third] => {
                    let mut found = [first, second].into_iter().filter_map(|other| of(other, third).ok());
                    if let Some(whole) = found.find(|found| !found.is_cut) {
                        return Ok(whole);
                    }
                    break;
                }
                _ => {}
            }
        }
        if let Some(cut) = cut {
            return cut;
        }
        let why = failure.map_or_else(String::new, |error| format!(": {error}"));
        Err(Error::NoReference { why: format!("no two methods go through the motion{why}") })
    }

    fn of(first: &Run, second: &Run, (settings, columns): (&Settings, &[String])) -> Result<Reference, Error> {
        let Settings { every, instants, .. } = reported(settings);
        let shown = first.names.coordinates.iter().map(|name| name.strip_prefix(HIDDEN).unwrap_or(name).to_owned());
        let columns = if columns.is_empty() { shown.collect() } else { columns.to_vec() };
        let values = columns.iter().map(|name| column(first, name)).collect::<Result<Vec<_>, Error>>()?;
        let end = |run: &Run| run.ended_by().map(|event| event.state.t);
        let start = first.first();
        let components: Vec<String> = first.column_names().into_iter().take(2 * start.q.len()).collect();
        let states = components.iter().map(|name| column(first, name)).collect::<Result<Vec<_>, Error>>()?;
        let mut found = Reference {
            methods: [first.method, second.method],
            agreement: 0.0,
            is_cut: false,
            arithmetic: Arithmetic::Double { why: DoubleOnly::NoModel },
            ranges: ranges(first, &columns, &values, SMALL),
            rests: values.iter().map(|values| vec![0.0; values.len()]).collect(),
            start: [start.q, start.v].concat(),
            sizes: ranges(first, &components, &states, 1.0),
            reports: (every, instants),
            columns,
            times: first.times.clone(),
            values,
            end: end(first),
            evaluations: first.work.evaluations,
            steps: first.work.steps,
        };
        let growth = found.errors(second);
        let agreed = growth.iter().take_while(|difference| **difference <= AGREED).count();
        if agreed < growth.len() {
            // Chaos, say: as far as they agree.
            if agreed < 2 {
                let why = format!("{} and {} differ from the start on", first.method, second.method);
                return Err(Error::NoReference { why });
            }
            found.is_cut = true;
            found.end = None;
            found.times.truncate(agreed);
        }
        found.agreement = growth[agreed - 1];
        Ok(found)
    }

    /// The largest error of a run until each of the reference's times.
    pub(super) fn errors(&self, run: &Run) -> Vec<f64> {
        let mut growth = self.differences(run);
        for row in 1..growth.len() {
            growth[row] = growth[row].max(growth[row - 1]);
        }
        growth
    }

    /// The error of a run at each of the reference's times.
    pub(super) fn differences(&self, run: &Run) -> Vec<f64> {
        let mut found = vec![0.0_f64; self.times.len()];
        // An event ends each run in its own time: what is compared is when.
        let shared = self.times.len() - usize::from(self.end.is_some());
        let ended = self.end.and(run.ended_by()).map_or(f64::INFINITY, |event| event.state.t);
        for (((name, values), rests), range) in self.columns.iter().zip(&self.values).zip(&self.rests).zip(&self.ranges)
        {
            let theirs = column(run, name).unwrap_or_default();
            for (row, error) in found.iter_mut().enumerate().take(shared) {
                let there = run.times.get(row) == Some(&self.times[row]);
                let value = theirs.get(row).filter(|_| there).copied();
                let difference = match value {
                    Some(value) if value.is_nan() && values[row].is_nan() => 0.0,
                    Some(value) => (value - values[row] - rests[row]).abs() / range,
                    None if ended <= self.times[row] => 0.0,
                    None => f64::INFINITY,
                };
                *error = if difference.is_nan() { f64::INFINITY } else { error.max(difference) };
            }
        }
        if let (Some(end), Some(last)) = (self.end, found.last_mut()) {
            let span = end - self.times[0];
            *last = run.ended_by().map_or(f64::INFINITY, |event| (event.state.t - end).abs() / span);
        }
        found
    }

    /// Every how many of its times are these instants, equally apart and before any event that ends the motion, and how far apart they
    /// are, s.  Every second time is one of those at equal distances.
    pub(super) fn instants(&self, count: usize) -> (usize, f64) {
        let shared = self.times.len() - usize::from(self.end.is_some());
        let every = 2 * (shared.saturating_sub(1) / (2 * count)).max(1);
        (every, self.times[every.min(self.times.len() - 1)] - self.times[0])
    }

    /// The times at which errors are looked at, s.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// Errors below this one are not known.
    pub fn floor(&self) -> f64 {
        // No number is nearer to its value than half a unit of its last place.
        self.uncertainty().max(0.5 * f64::EPSILON)
    }

    /// How many decimal digits of it are certain, in parts of ranges.
    pub fn digits(&self) -> u32 {
        -self.uncertainty().log10().min(0.0) as u32
    }

    /// By what it may be wrong, in parts of ranges.
    pub(super) fn uncertainty(&self) -> f64 {
        CERTAIN
            * match self.arithmetic {
                Arithmetic::Double { .. } | Arithmetic::Returns { .. } => self.agreement.max(f64::EPSILON),
                Arithmetic::DoubleDouble { agreement, .. } => agreement.max(ROUNDING),
            }
    }

    /// What its values are, in short: `double-double`, the method, or `its start`.
    pub fn by(&self) -> &'static str {
        match self.arithmetic {
            Arithmetic::Double { .. } => self.methods[0].name(),
            Arithmetic::Returns { .. } => "its start",
            Arithmetic::DoubleDouble { .. } => "double-double",
        }
    }

    /// What errors are measured from, and what agrees with it.
    pub fn sentence(&self) -> String {
        let ([first, second], digits) = (self.methods, self.digits());
        match self.arithmetic {
            Arithmetic::Double { why } => format!(
                "measured from {first}, with which {second} agrees to {:.0e}: {digits} digits (no more by double-double: {why})",
                self.agreement
            ),
            Arithmetic::Returns { period, periods } => format!(
                "measured from the start of the motion, to which it comes back after each of {periods} periods of {period} s: {digits} digits"
            ),
            Arithmetic::DoubleDouble { agreement, from_double } => format!(
                "measured from extrapolation in double-double, of which two runs agree to {agreement:.0e}, {first} to \
                 {from_double:.0e}: {digits} digits"
            ),
        }
    }

    /// The settings of a run that is compared with it.
    pub(super) fn compared(&self, settings: &Settings) -> Settings {
        let until = if self.is_cut { self.times[self.times.len() - 1] } else { settings.until };
        let (every, instants) = self.reports.clone();
        Settings { until, every, instants, dense: false, digits: false, ..settings.clone() }
    }

    /// The step at which those begin that keep it, s: that of the reference's method at a tolerance of 1e-1 or so.
    pub(super) fn longest_step(&self) -> f64 {
        const COARSER: f64 = 30.0;
        let span = self.times[self.times.len() - 1] - self.times[0];
        span / (self.steps as f64 / COARSER).ceil().max(4.0)
    }

    /// A curve ends where it takes more evaluations.
    pub(super) fn most_evaluations(&self) -> u64 {
        (DEARER * self.evaluations + LEAST_EVALUATIONS).min(2 * self.evaluations + MANY_EVALUATIONS)
    }
}

/// The same scene, reported at the times at which errors are looked at.
fn reported(settings: &Settings) -> Settings {
    let every = Some((settings.until - settings.from).max(f64::MIN_POSITIVE) / TIMES);
    let instants = uneven(settings.from, settings.until, TIMES as usize).into();
    Settings { every, instants, dense: false, digits: false, ..settings.clone() }
}

/// As exact as a method can.
fn exact(settings: &Settings, method: Method, tolerance: f64) -> Settings {
    let (enforcement, stabilisation) = Default::default();
    let settings = reported(settings);
    Settings { method, tolerance, step: None, enforcement, stabilisation, max_steps: MOST_STEPS, ..settings }
}

pub(crate) fn column(run: &Run, name: &str) -> Result<Vec<f64>, Error> {
    run.column(name).ok_or_else(|| Error::unknown("coordinate, rate or output", name, run.shown_names()))
}

/// How far values are apart, or a coordinate or rate has gone between them, `least` of the largest that has their unit at the least; what
/// does not move is measured by its size.
pub(crate) fn ranges(run: &Run, columns: &[String], values: &[Vec<f64>], least: f64) -> Vec<f64> {
    let all = run.column_names();
    let swept =
        |name: &String| all.iter().position(|known| known == name).and_then(|place| run.swept.get(place)).copied();
    let spans = columns.iter().zip(values).map(|(name, values)| {
        let finite = || values.iter().copied().filter(|value| value.is_finite());
        let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        let size = low.abs().max(high.abs());
        let gone = (high - low).max(swept(name).unwrap_or(0.0));
        if gone > SMALL * size {
            gone
        } else if size.is_finite() {
            size
        } else {
            0.0
        }
    });
    let spans: Vec<f64> = spans.collect();
    let units: Vec<String> = columns.iter().map(|name| run.unit(name)).collect();
    let largest = |unit: &String| {
        let alike = spans.iter().zip(&units).filter(|(_, other)| *other == unit).map(|(span, _)| *span);
        alike.fold(0.0, f64::max)
    };
    let of = |(span, unit): (&f64, &String)| {
        let largest = largest(unit);
        let range = if *span > ROUNDED * largest { span.max(least * largest) } else { largest };
        if range > 0.0 { range } else { 1.0 }
    };
    spans.iter().zip(&units).map(of).collect()
}
