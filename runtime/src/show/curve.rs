//! Columns of a run against time, so closely that nothing is left out that a picture can show.

use super::run::unknown_column;
use crate::error::Error;
use crate::run::{Continuous, Run};

/// Curves have about this many points.
pub(super) const POINTS: usize = 2000;
/// A straight line between two points of a curve is off by no more than this part of the curve's range: half of a pixel of a chart 500 pixels
/// high.
const STRAIGHT: f64 = 1e-3;
/// Within a step a curve is looked at at Lobatto's nodes of order 4, beside both ends.
const WITHIN: [f64; 4] = [0.0, 0.276_393_202_250_021, 0.723_606_797_749_979, 1.0];

/// So often is a piece of a step halved at most: a sixteenth of half a sine has its peak to 0.1 %.
const DEEPEST: usize = 4;

/// A time and a value.
type Point = (f64, f64);
/// A time, and a value of each curve.
type Look = (f64, Vec<f64>);

/// What lies between samples.
struct Between {
    /// The least and largest value of each curve so far.
    ranges: Vec<[f64; 2]>,
    /// Points of each curve, in order.
    points: Vec<Vec<Point>>,
}

impl Between {
    fn note(&mut self, (t, row): &Look) {
        for ((range, points), value) in self.ranges.iter_mut().zip(&mut self.points).zip(row) {
            points.push((*t, *value));
            if value.is_finite() {
                *range = [range[0].min(*value), range[1].max(*value)];
            }
        }
    }

    /// Notes what is wanted of a piece of a step after its beginning; the piece is halved where a straight line would not do.
    fn panel(&mut self, at: &mut dyn FnMut(f64) -> Look, [from, to]: [&Look; 2], depth: usize) {
        let t = 0.5 * (from.0 + to.0);
        if depth > 0 && from.0 < t && t < to.0 {
            let middle = at(t);
            let off = |k: usize| (0.5 * (from.1[k] + to.1[k]) - middle.1[k]).abs();
            let bends = (0..self.ranges.len()).any(|k| off(k) > STRAIGHT * (self.ranges[k][1] - self.ranges[k][0]));
            if bends {
                self.panel(at, [from, &middle], depth - 1);
                return self.panel(at, [&middle, to], depth - 1);
            }
            self.note(&middle);
        }
        self.note(to);
    }
}

/// The least and the largest finite value.
fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|value| value.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

impl Run {
    /// A column against time: coordinates and rates from dense output where there are few reported states.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub(super) fn samples(&self, name: &str) -> Result<Vec<Point>, Error> {
        let column = self.column(name).ok_or_else(|| unknown_column(self, name))?;
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let dense = (0..=POINTS).map(|i| first + (last - first) * i as f64 / POINTS as f64);
        let sampled: Option<Vec<_>> = dense.map(|t| Some((t, self.at(t)?.get(name)?))).collect();
        let reported = || self.times.iter().copied().zip(column).collect();
        Ok(sampled.filter(|_| self.times.len() < POINTS).unwrap_or_else(reported))
    }

    /// The same for several, each with what lies between the samples: pulses and jumps at the ends of steps, and inside of steps.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub(super) fn curves(&self, names: &[&str]) -> Result<Vec<Vec<Point>>, Error> {
        let samples = names.iter().map(|name| self.samples(name)).collect::<Result<Vec<_>, _>>()?;
        let owned: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        let Some(mut continuous) = Continuous::new(self, &owned) else { return Ok(samples) };
        let ranges = samples.iter().map(|points| range(points.iter().map(|point| point.1))).collect();
        let mut between = Between { ranges, points: vec![Vec::new(); names.len()] };
        let last = self.times[self.times.len() - 1];
        for (step, [from, to]) in
            continuous.steps().to_vec().into_iter().enumerate().filter(|(_, step)| step[0] <= last)
        {
            let mut at = |t: f64| {
                let mut row = vec![0.0; names.len()];
                continuous.values(step, t, &mut row);
                (t, row)
            };
            let places =
                WITHIN.map(|part| if part == 1.0 { to.min(last) } else { from + part * (to.min(last) - from) });
            let looks = places.map(&mut at);
            between.note(&looks[0]);
            for pair in looks.windows(2) {
                between.panel(&mut at, [&pair[0], &pair[1]], DEEPEST);
            }
        }
        let between = between.points;
        Ok(samples.into_iter().zip(between).map(|(samples, between)| with_all(&samples, &between)).collect())
    }
}

/// Samples of a curve with those points between them from which a straight line would be off.
fn with_all(samples: &[Point], between: &[Point]) -> Vec<Point> {
    let [low, high] = range(samples.iter().chain(between).map(|point| point.1));
    let slack = STRAIGHT * (high - low);
    let mut curve = Vec::with_capacity(samples.len());
    let mut rest = between;
    for pair in samples.windows(2) {
        let [before, after] = [pair[0], pair[1]];
        curve.push(before);
        let (_, later) = rest.split_at(rest.partition_point(|point| point.0 < before.0));
        let (inside, later) = later.split_at(later.partition_point(|point| point.0 <= after.0));
        rest = later;
        let off = |point: &Point| {
            let part = (point.0 - before.0) / (after.0 - before.0);
            let by = (before.1 + part * (after.1 - before.1) - point.1).abs();
            // Beside a gap all is off.
            point.1.is_finite() && (by.is_nan() || by > slack)
        };
        if inside.iter().any(off) {
            curve.extend(outline(inside));
        }
    }
    curve.extend(samples.last());
    curve
}

/// Of points at nearly the same place of a picture the first, the least, the largest and the last, in order.
fn outline(points: &[Point]) -> Vec<Point> {
    let finite: Vec<usize> = (0..points.len()).filter(|k| points[*k].1.is_finite()).collect();
    let by = |a: &&usize, b: &&usize| points[**a].1.total_cmp(&points[**b].1);
    let found = [finite.first(), finite.iter().min_by(by), finite.iter().max_by(by), finite.last()];
    let mut places: Vec<usize> = found.into_iter().flatten().copied().collect();
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|k| points[k]).collect()
}
