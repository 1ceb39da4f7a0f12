//! How far two runs are apart.

use super::{Continuous, Run};

/// Runs are compared at so many instants at the least.
const INSTANTS: usize = 1000;
/// And at two instants of so many of one run's steps, where nothing begins or ends: Lobatto's nodes of order 4, at which no report is.
const STEPS: usize = 4000;
const WITHIN: [f64; 2] = [0.276_393_202_250_021, 0.723_606_797_749_979];
/// Beside an event is what is this part of the run from it.
const INSTANT: f64 = 1e-9;
/// What moves less beside its size stands still.
const STILL: f64 = 1e-9;

impl Run {
    /// The largest deviation of another run from this one in a coordinate, rate or output, in parts of the range that it goes through
    /// here (of its size where it stands still); infinite where other events happen, or in another order, or where only one is a
    /// number.  `None` where one of them has no such column.
    ///
    /// The runs are compared at the times that both report, and from the dense output of both at a thousand instants and more that no
    /// vibration keeps step with, and within this run's steps.  Around each event, where what jumps does so a little earlier or later,
    /// nothing is compared.
    ///
    /// # Example
    /// ```
    /// use dalembert::prelude::*;
    /// # dalembert::model!(yaml = r#"
    /// # name: Spring
    /// # parameters: {m: 1 kg, k: 4 N/m}
    /// # coordinates: {x: m}
    /// # bodies: {b: {mass: m, position: "[x, 0]"}}
    /// # springs: {s: {stretch: x, stiffness: k, along: "[1, 0]", on: b}}
    /// # scene: {start: {x: 1}, until: 3}
    /// # "#);
    /// let run = |k| Spring { k, ..Default::default() }.simulate().every(0.01).run();
    /// let (soft, stiff) = (run(4.0)?, run(4.04)?);
    /// // Half a percent faster: ahead by 0.03 rad after 6 rad.
    /// let off = soft.deviation(&stiff, "x").unwrap();
    /// assert!(off > 0.008 && off < 0.015, "{off}");
    /// # Ok::<(), dalembert::Error>(())
    /// ```
    pub fn deviation(&self, other: &Run, name: &str) -> Option<f64> {
        let difference = self.difference(other, name)?;
        let (low, high) = self.extremes(name).unwrap_or((0.0, 0.0));
        let size = low.abs().max(high.abs());
        let scale = if high - low > STILL * size { high - low } else { size };
        Some(if difference == 0.0 { 0.0 } else { difference / scale })
    }

    /// The same as an amount in SI units.
    pub fn difference(&self, other: &Run, name: &str) -> Option<f64> {
        let (mine, theirs) = (self.column(name)?, other.column(name)?);
        let names = |run: &Run| run.events.iter().map(|event| event.name.clone()).collect::<Vec<_>>();
        if names(self) != names(other) {
            return Some(f64::INFINITY);
        }
        let span = self.times().last().zip(self.times().first()).map_or(0.0, |(last, first)| last - first);
        let moved = self.events.iter().zip(&other.events).map(|(a, b)| (a.state.t, (a.state.t - b.state.t).abs()));
        let moved: Vec<(f64, f64)> = moved.collect();
        let beside = |t: f64| moved.iter().any(|(at, apart)| (t - at).abs() <= apart + INSTANT * span);
        let largest = |times: &[f64], mine: &[f64], theirs: &[f64]| {
            let apart = times.iter().zip(mine.iter().zip(theirs)).filter(|(t, _)| !beside(**t));
            apart.map(|(_, (a, b))| apart_by(*a, *b)).fold(0.0, f64::max)
        };
        let shared = self.times().iter().zip(other.times()).take_while(|(a, b)| a == b).count();
        let reported = largest(&self.times[..shared], &mine, &theirs);
        let instants = self.instants(INSTANTS);
        let column = [name.to_owned()];
        let (Some(own), Some(others)) = (self.values_at(&column, &instants), other.values_at(&column, &instants))
        else {
            return Some(reported);
        };
        let both = own[0].len().min(others[0].len());
        Some(largest(&instants[..both], &own[0], &others[0]).max(reported))
    }

    /// At least so many instants of the run, one in each of as many equal intervals at a place that no vibration keeps step with, and
    /// others within its steps, which are short where much happens.
    pub(crate) fn instants(&self, count: usize) -> Vec<f64> {
        let Some((from, to)) = self.times.first().zip(self.times.last()) else { return Vec::new() };
        let mut instants = uneven(*from, *to, count);
        let steps = self.trajectory.steps();
        let some = steps.iter().step_by(steps.len().div_ceil(STEPS).max(1));
        instants.extend(some.flat_map(|[a, b]| WITHIN.map(|part| a + part * (b - a))));
        instants.sort_unstable_by(f64::total_cmp);
        instants
    }

    /// Columns at ordered times, as far as the run goes; `None` where it kept no dense output.
    pub(crate) fn values_at(&self, names: &[String], times: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut continuous = Continuous::new(self, names)?;
        let last = self.times.last().copied()?;
        let mut columns = vec![Vec::with_capacity(times.len()); names.len()];
        let mut row = vec![0.0; names.len()];
        for t in times.iter().copied().take_while(|t| *t <= last) {
            continuous.values(continuous.step_at(t, true), t, &mut row);
            columns.iter_mut().zip(&row).for_each(|(column, value)| column.push(*value));
        }
        Some(columns)
    }
}

/// An instant in each of so many equal intervals, at a place with which no vibration keeps step.
pub(crate) fn uneven(from: f64, to: f64, count: usize) -> Vec<f64> {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let place = |k: usize| (k as f64 + ((k + 1) as f64 * GOLDEN).fract()) / count as f64;
    (0..count).map(|k| from + place(k) * (to - from)).collect()
}

/// How far two values are apart: what is nowhere, as a reaction in flight, is no difference where both are.
pub(crate) fn apart_by(a: f64, b: f64) -> f64 {
    match (a, b) {
        (a, b) if a == b || !a.is_finite() && !b.is_finite() => 0.0,
        (a, b) if !a.is_finite() || !b.is_finite() => f64::INFINITY,
        (a, b) => (a - b).abs(),
    }
}
