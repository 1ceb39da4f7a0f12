//! How far two runs are apart.

use super::Run;

/// Runs are compared at so many instants at the least.
const INSTANTS: usize = 1000;
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
}

/// How far two values are apart: what is nowhere, as a reaction in flight, is no difference where both are.
pub(crate) fn apart_by(a: f64, b: f64) -> f64 {
    match (a, b) {
        (a, b) if a == b || !a.is_finite() && !b.is_finite() => 0.0,
        (a, b) if !a.is_finite() || !b.is_finite() => f64::INFINITY,
        (a, b) => (a - b).abs(),
    }
}
