//! How far two runs are apart.

use super::extremes::extremes;
use super::{Continuous, Run};

/// Beside an event is what is this part of the run from it.
const INSTANT: f64 = 1e-9;
/// Discontinuities of two runs that are no more than this part of the run apart are the same one.
const PAIRED: f64 = 1e-3;
/// What moves less beside its size stands still.
const STILL: f64 = 1e-9;

impl Run {
    /// The largest deviation of another run from this one in a coordinate, rate or output, over all the time that both have, in parts of
    /// the range that it goes through here (of its size where it stands still); infinite where other events happen, or in another
    /// order, or where only one is a number.  `None` where one of them has no such column.
    ///
    /// It comes from the dense output of both, or, where one kept none, from the times that both report.  Around each event and
    /// discontinuity, where what jumps does so a little earlier or later, nothing is compared.
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
    /// let run = |k| Spring { k, ..Default::default() }.simulate().run();
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
        let event_times = |run: &Run| -> Vec<f64> { run.events.iter().map(|event| event.state.t).collect() };
        let skipped = self.skipped(other, &event_times(self), &event_times(other));
        let shared = self.times.iter().zip(&other.times).take_while(|(a, b)| a == b).map(|(t, _)| *t);
        let at_reports = shared.enumerate().filter(|(_, t)| !beside(&skipped, *t));
        let at_reports = at_reports.map(|(row, _)| signed(mine[row], theirs[row]).abs()).fold(0.0, f64::max);
        let dense = self.differences(other, &[name.to_owned()], &skipped);
        Some(dense.map_or(at_reports, |dense| dense[0].max(at_reports)))
    }

    /// Times [from, to] around events and discontinuities of two runs, where what jumps does so earlier in one of them.
    pub(crate) fn skipped(&self, other: &Run, own_events: &[f64], other_events: &[f64]) -> Vec<[f64; 2]> {
        let span = self.times.last().zip(self.times.first()).map_or(0.0, |(last, first)| last - first);
        let events = own_events.iter().zip(other_events).map(|(a, b)| (*a, *b));
        let (own, others) = (self.trajectory.restarts(), other.trajectory.restarts());
        let paired = own.iter().filter_map(|t| {
            let nearest = nearest(&others, *t)?;
            ((t - nearest).abs() <= PAIRED * span).then_some((*t, nearest))
        });
        let around = |(a, b): (f64, f64)| [a.min(b) - INSTANT * span, a.max(b) + INSTANT * span];
        events.chain(paired).map(around).collect()
    }

    /// The largest differences of columns of two runs over the time that both have, but for what is skipped; infinite where only one is
    /// a number.  `None` where one kept no dense output or has no such column.
    pub(crate) fn differences(&self, other: &Run, names: &[String], skipped: &[[f64; 2]]) -> Option<Vec<f64>> {
        let (mut own, mut others) = (Continuous::new(self, names)?, Continuous::new(other, names)?);
        let skipped = merged(skipped);
        let pieces = common(own.steps(), others.steps(), &skipped);
        let places: Vec<[usize; 2]> = pieces
            .iter()
            .map(|[a, b]| {
                let middle = a + 0.5 * (b - a);
                [own.step_at(middle, false), others.step_at(middle, false)]
            })
            .collect();
        let mut theirs = vec![0.0; names.len()];
        let found = extremes(&pieces, names.len(), &mut |piece, t, values| {
            own.values(places[piece][0], t, values);
            others.values(places[piece][1], t, &mut theirs);
            values.iter_mut().zip(&theirs).for_each(|(mine, theirs)| *mine = signed(*mine, *theirs));
        });
        Some(found.into_iter().map(|(low, high)| if low <= high { (-low).max(high) } else { 0.0 }).collect())
    }
}

/// A difference; none where both are no numbers, without bound where one is.
fn signed(mine: f64, theirs: f64) -> f64 {
    match (mine, theirs) {
        (a, b) if a == b || !a.is_finite() && !b.is_finite() => 0.0,
        (a, b) if !a.is_finite() || !b.is_finite() => f64::INFINITY,
        (a, b) => b - a,
    }
}

/// The nearest of ordered times.
fn nearest(times: &[f64], t: f64) -> Option<f64> {
    let next = times.partition_point(|time| *time < t);
    let around = times[next.saturating_sub(1)..].iter().take(2).copied();
    around.min_by(|a, b| (a - t).abs().total_cmp(&(b - t).abs()))
}

/// Whether a time is in one of these.
fn beside(skipped: &[[f64; 2]], t: f64) -> bool {
    skipped.iter().any(|[from, to]| (*from..=*to).contains(&t))
}

/// The same times as intervals in order that do not meet.
fn merged(intervals: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut intervals = intervals.to_vec();
    intervals.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut found: Vec<[f64; 2]> = Vec::with_capacity(intervals.len());
    for [from, to] in intervals {
        match found.last_mut() {
            Some(last) if from <= last[1] => last[1] = last[1].max(to),
            _ => found.push([from, to]),
        }
    }
    found
}

/// The pieces in which neither of two lists of steps has an end, without what is skipped.
fn common(one: &[[f64; 2]], other: &[[f64; 2]], skipped: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let ends = |steps: &[[f64; 2]]| steps.first().zip(steps.last()).map(|(first, last)| [first[0], last[1]]);
    let Some(([a, b], [c, d])) = ends(one).zip(ends(other)) else { return Vec::new() };
    let (from, to) = (a.max(c), b.min(d));
    let mut times: Vec<f64> = one.iter().chain(other).chain(skipped).flatten().copied().collect();
    times.retain(|t| (from..=to).contains(t));
    times.sort_unstable_by(f64::total_cmp);
    times.dedup();
    let is_kept = |[a, b]: &[f64; 2]| {
        let middle = a + 0.5 * (b - a);
        let before = skipped.partition_point(|[start, _]| *start <= middle);
        before == 0 || skipped[before - 1][1] < middle
    };
    times.windows(2).map(|pair| [pair[0], pair[1]]).filter(is_kept).collect()
}
