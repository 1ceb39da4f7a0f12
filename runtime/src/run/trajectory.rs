//! Dense output of a whole run.

use super::hermite::{Knot, hermite};
use super::parts::scatter;
use crate::integrate::Segment;

/// More numbers of dense output than this (400 MB) are not kept.
const MOST_NUMBERS: usize = 50_000_000;
/// Ends of steps closer than this part of the step looked at tell rounding rather than the motion, and the motion may be smooth on no longer scale.
const APART: f64 = 0.4;
/// Four ends that are farther from each other than so many times the step looked at are far: of three steps the others are more than twice as long.
const FAR: f64 = 5.0;
/// The polynomial through the two ends of a step misses a motion that is smooth on a longer scale by less than this part of what it changes by: by
/// 1/46080 of its sixth derivative.
const SMOOTH: f64 = 1e-3;

/// The motion at any time: (q, q', q'') at the ends of steps, which cost no evaluation, with a polynomial through the
/// four nearest; at a start, where steps become longer or shorter, and where it is free, the method's own dense output.
///
/// At a tolerance of 10⁻¹⁰ the polynomial is ten times closer to the motion in q than the dense output of `dop853`, and
/// up to three times farther in q'; at 10⁻⁶ three to six times farther in q'.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trajectory {
    n: usize,
    times: Vec<f64>,
    /// q, q', q'' of each time.
    knots: Vec<f64>,
    /// Places in `times` where the equations changed; the time before is the same.
    starts: Vec<usize>,
    /// (place of the step's end in `times`, where its pieces begin, its start, its length).
    own: Vec<Own>,
    pieces: Vec<f64>,
    /// Parts of the mechanism with their coordinates, each of which has its own; then nothing stands here but where it starts and ends.
    parts: Vec<(Vec<usize>, Trajectory)>,
}

#[derive(Clone, Copy, Debug)]
struct Own {
    end: usize,
    first: usize,
    t: f64,
    h: f64,
}

impl Trajectory {
    /// An empty one, for n coordinates.
    pub fn new(n: usize) -> Self {
        Trajectory { n, ..Trajectory::default() }
    }

    /// That of a mechanism whose parts have their own, as far as until t.
    pub fn of_parts(n: usize, parts: Vec<(Vec<usize>, Trajectory)>, t: f64) -> Self {
        let start = parts.first().and_then(|(_, own)| own.start());
        let times = start.map_or_else(Vec::new, |start| vec![start, t]);
        Trajectory { n, times, parts, ..Trajectory::default() }
    }

    /// True when it has grown beyond what is kept.
    pub fn is_full(&self) -> bool {
        self.knots.len() + self.pieces.len() > MOST_NUMBERS
    }

    /// True when a step that ends at t must come with the method's own dense output: one of the two steps before it is much shorter, so that the motion
    /// there is smooth on no such scale, or there are none.
    pub fn wants_own(&self, t: f64) -> bool {
        let Some(last) = self.times.len().checked_sub(1) else { return true };
        let piece = *self.starts.last().unwrap_or(&0);
        let least = APART * (t - self.times[last]);
        last < piece + 2 || (last - 1..=last).any(|end| self.times[end] - self.times[end - 1] < least)
    }

    /// Where it starts, s.
    pub fn start(&self) -> Option<f64> {
        self.times.first().copied()
    }

    /// Where it ends, s.
    pub fn end(&self) -> Option<f64> {
        self.times.last().copied()
    }

    /// Begins, or begins anew, at a state with its rate.
    pub fn begin(&mut self, t: f64, y: &[f64], rate: &[f64]) {
        self.starts.push(self.times.len());
        self.knot(t, y, rate);
    }

    /// Appends a step that ends in a state with its rate.
    pub fn push(&mut self, t: f64, y: &[f64], rate: &[f64], own: Option<&Segment<'_>>) {
        if let Some(segment) = own {
            let (end, first) = (self.times.len(), self.pieces.len());
            self.own.push(Own { end, first, t: segment.t, h: segment.h });
            self.pieces.extend_from_slice(segment.pieces);
        }
        self.knot(t, y, rate);
    }

    fn knot(&mut self, t: f64, y: &[f64], rate: &[f64]) {
        self.times.push(t);
        self.knots.extend_from_slice(y);
        self.knots.extend_from_slice(&rate[self.n..]);
    }

    /// The steps: times between which nothing restarts, of parts those of all.
    pub fn steps(&self) -> Vec<[f64; 2]> {
        let mut times = self.times.clone();
        for (_, own) in &self.parts {
            let inside = |t: &&f64| self.start() < Some(**t) && Some(**t) < self.end();
            times.extend(own.times.iter().filter(inside));
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times.windows(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// Writes the state at time t, before a restart at this instant; false outside of the run (by more than rounding).
    pub fn evaluate(&self, t: f64, y: &mut [f64]) -> bool {
        self.evaluate_on(t, false, y)
    }

    /// The same, before or after restarts at this instant.
    pub fn evaluate_on(&self, t: f64, after: bool, y: &mut [f64]) -> bool {
        let (Some(first), Some(last)) = (self.start(), self.end()) else { return false };
        let slack = 4.0 * f64::EPSILON * t.abs();
        if !(t >= first - slack && t <= last + slack) {
            return false;
        }
        let t = t.clamp(first, last);
        if !self.parts.is_empty() {
            return self.gather(t, after, y);
        }
        let end = self.times.partition_point(|time| *time < t);
        if self.times[end] == t {
            let end = if after { self.times.partition_point(|time| *time <= t) - 1 } else { end };
            y.copy_from_slice(&self.knots[3 * self.n * end..][..2 * self.n]);
            return true;
        }
        match self.own.binary_search_by_key(&end, |own| own.end) {
            Ok(place) => {
                let own = self.own[place];
                let until = self.own.get(place + 1).map_or(self.pieces.len(), |next| next.first);
                let segment = Segment { t: own.t, h: own.h, width: 2 * self.n, pieces: &self.pieces[own.first..until] };
                segment.evaluate((t - own.t) / own.h, y);
            }
            Err(_) => self.interpolate(t, end, y),
        }
        true
    }

    fn gather(&self, t: f64, after: bool, y: &mut [f64]) -> bool {
        self.parts.iter().all(|(coordinates, own)| {
            let mut state = vec![0.0; 2 * coordinates.len()];
            let known = own.evaluate_on(t, after, &mut state);
            scatter(coordinates, &state, y);
            known
        })
    }

    /// By the polynomial through four ends of steps, or by that through the two of the step with this end alone, where others are far off and the motion is
    /// not smooth on that scale.
    fn interpolate(&self, t: f64, end: usize, y: &mut [f64]) {
        let own = [end - 1, end];
        let scale = self.times[end] - self.times[end - 1];
        let four = self.neighbours(end);
        let is_near = four.is_some_and(|places| self.span(&places) <= FAR * scale);
        for i in 0..self.n {
            let through = |places: &[usize]| self.through(places, i, (t, scale));
            let (value, slope) = match four {
                Some(places) if is_near => through(&places),
                Some(places) => {
                    let (wide, narrow) = (through(&places), through(&own));
                    if self.is_smooth(own, (i, scale), (wide, narrow)) { wide } else { narrow }
                }
                None => through(&own),
            };
            (y[i], y[self.n + i]) = (value, slope / scale);
        }
    }

    /// Four ends of steps, the step with this end in the middle of them or, where these are far from each other, at the side on which they are nearer.
    fn neighbours(&self, end: usize) -> Option<[usize; 4]> {
        let next_piece = self.starts.partition_point(|start| *start < end);
        let piece = self.starts[next_piece - 1];
        let beyond = self.starts.get(next_piece).copied().unwrap_or(self.times.len());
        let start = end - 1;
        let scale = self.times[end] - self.times[start];
        let is_apart = |from: usize, to: usize| self.times[to] - self.times[from] >= APART * scale;
        let before = |place: usize| (piece..place).next_back().filter(|k| is_apart(*k, place));
        let after = |place: usize| (place + 1..beyond).next().filter(|k| is_apart(place, *k));
        let [earlier, later] = [before(start), after(end)];
        let around = earlier.zip(later).map(|(first, last)| [first, start, end, last]);
        let earliest = earlier.and_then(before).zip(earlier).map(|(first, second)| [first, second, start, end]);
        let latest = later.zip(later.and_then(after)).map(|(third, last)| [start, end, third, last]);
        let aside = earliest.into_iter().chain(latest).min_by(|a, b| self.span(a).total_cmp(&self.span(b)));
        around.filter(|places| self.span(places) <= FAR * scale).or(aside).or(around)
    }

    fn span(&self, places: &[usize; 4]) -> f64 {
        self.times[places[3]] - self.times[places[0]]
    }

    /// A coordinate and its rate, in a unit of time, by the polynomial through these ends of steps.
    fn through(&self, places: &[usize], i: usize, (t, unit): (f64, f64)) -> (f64, f64) {
        let mut knots = [Knot::default(); 4];
        for (knot, place) in knots.iter_mut().zip(places) {
            let [value, slope, bend] = [0, 1, 2].map(|order| self.number(*place, order, i));
            *knot = Knot { x: (self.times[*place] - t) / unit, value, slope: unit * slope, bend: unit * unit * bend };
        }
        hermite(&knots[..places.len()])
    }

    /// Whether what is far off tells the same of a coordinate within a step as its own ends do, beside what it changes by.
    fn is_smooth(&self, own: [usize; 2], (i, h): (usize, f64), (wide, narrow): ((f64, f64), (f64, f64))) -> bool {
        let most = |order: usize| own.map(|place| self.number(place, order, i).abs()).into_iter().fold(0.0, f64::max);
        let change = |order: usize| (self.number(own[1], order, i) - self.number(own[0], order, i)).abs();
        let (way, gained) = (change(0).max(h * most(1)), change(1).max(h * most(2)));
        (wide.0 - narrow.0).abs() <= SMOOTH * way && (wide.1 - narrow.1).abs() <= SMOOTH * h * gained
    }

    /// q, q' or q'' of a coordinate at an end of steps.
    fn number(&self, place: usize, order: usize, i: usize) -> f64 {
        self.knots[(3 * place + order) * self.n + i]
    }
}
