//! How many digits of a run's numbers hold.

use std::collections::{HashMap, VecDeque};

#[cfg(feature = "cli")]
use super::State;
use super::state::plain;
use super::{Run, apart_by};
use crate::mechanism::HIDDEN;

/// What a second run, less accurate, start and parameters moved by rounding, says about the first.
///
/// The error of a value is bounded by 7/4 max |Δ| (by 21/8 max |Δ| where the second run follows the steps of the first), Δ being the difference of both runs, over the last tenth of the time
/// until then; the errors of a coordinate and of its rate bound each other, since errors oscillate between them.  How promises compare with true errors
/// over the library is measured in `docs/digits.md`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Digits {
    /// Bounds of the errors, column by column as [`Run::column_names`], at all reported times.
    pub(crate) rows: Vec<f64>,
    /// Of the time of the last state, and of those of events, s.
    pub(crate) end: f64,
    pub(crate) events: Vec<f64>,
    /// Until when digits are left, s, and of which column there are none then.
    pub(crate) lost: Option<(f64, usize)>,
    /// The tolerance of the second run, or its fixed step in s.
    pub companion: f64,
    /// Which of both it is.
    pub(crate) by_step: bool,
    /// Evaluations of the accelerations that the second run took.
    pub evaluations: u64,
    /// What moves by no more than this part of itself does not move.
    still: f64,
    /// How far the values of each column are apart.
    ranges: Vec<f64>,
    /// At which reported times one run is before an event and the other one behind it: what differs there is no error of the motion, and the bounds
    /// there say nothing of other times.
    straddles: Vec<bool>,
    /// What each output at the end may be off by where its terms cancel, the motion being known as it is; 0 where that is not known.
    cancelled: Vec<f64>,
}

/// Errors are bounded by this times the differences: those of the second run are some ten times as large as those of the first.
const MARGIN: f64 = 1.75;
/// The zero of a function is located to so many roundings of its time, by both runs alike: those of forces that cancel there.
const LOCATED: f64 = 64.0;
/// A time of no more decimal digits was known beforehand.
const DECIMAL: usize = 12;
/// A column has no digits left where its error is this part of the range that it goes through.
const LOST: f64 = 0.2;
/// What moves by no more than this part of what else has its unit does not move.
const STILL: f64 = 1e-10;
/// Less than this part of a range is rounding of rounding, in which two runs may agree and both be wrong.
const NOTHING: f64 = 1e-20;
/// Angles and other pure numbers below this are rounding of what has the size 1.
const ROUNDED: f64 = 1e3 * f64::EPSILON;
/// The part of the time until then over which differences are looked at.
const WINDOW: f64 = 0.1;
/// An output is off by so many times what the motion is, of its terms; a rate by so many roundings of the impulses' terms.
const TERMS: f64 = 4.0;
/// A motion is known where its errors are less than this part of what it goes through: three digits hold.
const KNOWN: f64 = 1e-3;
/// A state is moved in so many ways, and as far back.
const SHAKES: usize = 4;
/// Numbers are printed with so many significant digits at most.
const MOST: i32 = 15;

impl Digits {
    /// Compares a run with a second one.
    ///
    /// `tolerance` is what errors of the second may be beside the values, where it is known.
    pub(crate) fn compare(run: &Run, other: &Run, companion: f64, tolerance: Option<f64>) -> Self {
        let time_of = |run: &Run| run.times.last().copied().unwrap_or(0.0);
        // The other may have more events or fewer: each is compared with the nearest of its kind.
        let kinds = other.events.iter().map(|event| event.event + 1).max().unwrap_or(0);
        let mut times = vec![Vec::new(); kinds];
        other.events.iter().for_each(|event| times[event.event].push(event.state.t));
        let start = run.times.first().copied();
        let events = run.events.iter().map(|event| {
            // The second run starts behind what happened at the start.
            if Some(event.state.t) == start {
                return 0.0;
            }
            let alike = times.get(event.event).map_or(&[][..], Vec::as_slice);
            let next = alike.partition_point(|t| *t < event.state.t);
            let around = alike[next.saturating_sub(1)..].iter().take(2);
            let apart = around.map(|t| MARGIN * (t - event.state.t).abs()).fold(f64::INFINITY, f64::min);
            located(apart, event.state.t)
        });
        let still = STILL.max(tolerance.unwrap_or(0.0));
        let ranges = ranges(run, still);
        let straddles = straddles(run, other);
        let differences = differences(run, other, (&ranges, &straddles));
        let mut digits = Digits {
            rows: differences.into_iter().map(|difference| MARGIN * difference).collect(),
            end: match (run.ended_by(), MARGIN * (time_of(run) - time_of(other)).abs()) {
                (Some(_), apart) => located(apart, time_of(run)),
                (None, apart) => apart,
            },
            events: events.collect(),
            lost: None,
            companion,
            by_step: tolerance.is_none(),
            evaluations: other.work.evaluations,
            still,
            ranges,
            straddles,
            cancelled: Vec::new(),
        };
        digits.settle(run);
        digits
    }

    /// Raises bounds to a part of the differences from another run, no less than `least`.
    ///
    /// Where errors follow the tolerance its differences are as many times larger as its tolerance is; where they are
    /// not, each of the two runs may be close to the first one by chance, and both count in proportion to what they find.
    pub(crate) fn third_run(&mut self, run: &Run, other: &Run, least: f64) {
        let straddles = straddles(run, other);
        let differences = differences(run, other, (&self.ranges, &straddles));
        self.straddles.iter_mut().zip(straddles).for_each(|(here, there)| *here |= there);
        let (columns, n) = (run.names.len(), run.names.coordinates.len());
        let ranges = &self.ranges;
        let size =
            |row: &[f64]| row.iter().zip(ranges).take(2 * n).fold(0.0_f64, |most, (y, range)| most.max(y / range));
        for (bounds, differences) in self.rows.chunks_exact_mut(columns).zip(differences.chunks_exact(columns)) {
            let part = (size(bounds) / (MARGIN * size(differences))).clamp(least, 1.0);
            for (bound, difference) in bounds.iter_mut().zip(differences) {
                *bound = bound.max(part * difference);
            }
        }
        self.evaluations += other.work.evaluations;
        self.settle(run);
    }

    /// Raises all bounds by a factor.
    pub(crate) fn inflate(&mut self, factor: f64) {
        self.rows.iter_mut().for_each(|bound| *bound *= factor);
    }

    /// Raises bounds to this part of the way that each column has gone until then: what speeds are off by from some instant on, whatever the tolerance,
    /// places gather.
    pub(crate) fn way_floor(&mut self, run: &Run, part: f64) {
        let (columns, n) = (run.names.len(), run.names.coordinates.len());
        let mut ways = vec![0.0; 2 * n];
        for (row, bounds) in self.rows.chunks_exact_mut(columns).enumerate().skip(1) {
            let [from, to] = [row - 1, row].map(|row| &run.rows[2 * n * row..][..2 * n]);
            let time = run.times[row] - run.times[row - 1];
            for (k, way) in ways.iter_mut().enumerate() {
                // Between reports that are far apart it may go to and fro.
                let by_speeds = if k < n { 0.5 * time * (from[n + k].abs() + to[n + k].abs()) } else { 0.0 };
                *way += (to[k] - from[k]).abs().max(by_speeds);
                bounds[k] = bounds[k].max(part * *way);
            }
        }
    }

    /// Raises bounds to this part of what each column goes through, where none is known to be less.
    pub(crate) fn part_floor(&mut self, run: &Run, least: f64) {
        let mut ranges = self.ranges.clone();
        // That another output of its unit is large takes no digits from one.
        let outputs = 2 * run.names.coordinates.len()..;
        ranges[outputs.clone()].copy_from_slice(&own_ranges(run, &spans(run), self.still)[outputs]);
        ranges.iter_mut().zip(&run.swept).for_each(|(range, swept)| *range = range.max(*swept));
        for (bound, range) in self.rows.iter_mut().zip(ranges.iter().cycle()) {
            *bound = bound.max(least * range);
        }
    }

    /// An event may be earlier or later by so much, s.
    pub(crate) fn widen_event(&mut self, index: usize, width: f64) {
        if let Some(bound) = self.events.get_mut(index) {
            *bound = bound.max(width);
        }
    }

    /// The end may be, at which coordinates and speeds change at these rates.
    pub(crate) fn widen_end(&mut self, run: &Run, width: f64, rates: &[f64]) {
        self.end = self.end.max(width);
        let first = self.rows.len() - run.names.len();
        self.rows[first..].iter_mut().zip(rates).for_each(|(bound, rate)| *bound = bound.max(width * rate.abs()));
    }

    /// The state at the end is known to these errors at best.
    pub(crate) fn known_at_end(&mut self, run: &Run, errors: &[f64]) {
        let first = self.rows.len() - run.names.len();
        self.rows[first..].iter_mut().zip(errors).for_each(|(bound, error)| *bound = bound.max(*error));
    }

    /// Nothing is known from the start on.
    pub(crate) fn lose(&mut self, run: &Run) {
        self.rows.fill(f64::INFINITY);
        self.lost = run.times.first().map(|t| (*t, 0));
    }

    /// Promises none of the times of events either.
    pub(crate) fn lose_all(&mut self, run: &Run) {
        self.lose(run);
        self.events.fill(f64::INFINITY);
        self.end = f64::INFINITY;
    }

    /// A state [q; q'] at about the time of a row, and states about it moved as far as half the bounds there.
    pub(crate) fn around(&self, run: &Run, row: usize, state: &[f64]) -> Vec<Vec<f64>> {
        let columns = state.len() + run.names.outputs.len();
        let bounds = &self.rows[columns * row..][..state.len()];
        let moved = |pattern: usize| {
            // Walsh's patterns, so that no two neighbours always move alike.
            let back = pattern >= SHAKES;
            let sign = |i: usize| if ((i & (pattern % SHAKES)).count_ones() % 2 == 1) == back { 0.5 } else { -0.5 };
            state.iter().zip(bounds).enumerate().map(|(i, (y, bound))| y + sign(i) * bound).collect()
        };
        std::iter::once(state.to_vec()).chain((0..2 * SHAKES).map(moved)).collect()
    }

    /// Raises the bounds of the last outputs to what they differ by in these states, the last and others about it: both
    /// runs may find the same for a quotient by what vanishes there, and be wrong.
    pub(crate) fn output_conditioning(&mut self, outputs: &[Vec<f64>]) {
        let [usual, others @ ..] = outputs else { return };
        let first = self.rows.len() - usual.len();
        for moved in others {
            for ((bound, usual), moved) in self.rows[first..].iter_mut().zip(usual).zip(moved) {
                let change = (moved - usual).abs();
                // What is absent at the last state is absent, whatever it is beside it.
                if !usual.is_nan() {
                    *bound = bound.max(if change.is_nan() { f64::INFINITY } else { change });
                }
            }
        }
    }

    /// Raises the bounds of the last outputs to what rounding may have made of them: both runs lose the same digits where an output
    /// is a small difference of large terms.
    pub(crate) fn cancellation(&mut self, run: &Run, errors: &[f64]) {
        let first = self.rows.len() - errors.len();
        // Errors that are no numbers are those of outputs that are none.
        self.rows[first..].iter_mut().zip(errors).for_each(|(bound, error)| *bound = bound.max(*error));
        let worst = self.worst(run);
        // Of a motion that is not known terms that cancel are not known either.
        let motion = if worst < KNOWN { TERMS * worst.max(self.still) } else { 0.0 };
        self.cancelled = errors.iter().map(|error| motion * error / f64::EPSILON).collect();
    }

    /// For each coordinate the acceleration of a vibration that goes as far and as fast as one of its unit does, of those the largest; 0 where none moves.
    /// Infinite of one that stays where it is but for rounding: what is held there accelerates by rounding alone.
    pub(crate) fn usual_accelerations(&self, run: &Run) -> Vec<f64> {
        let n = run.names.coordinates.len();
        let units: Vec<String> = run.names.coordinates.iter().map(|name| run.unit(name)).collect();
        let mut of_unit: HashMap<&str, f64> = HashMap::new();
        for (k, unit) in units.iter().enumerate() {
            let (q, v) = (self.ranges[k], self.ranges[n + k]);
            let own = if q > 0.0 && v.is_finite() { v * v / q } else { 0.0 };
            let most = of_unit.entry(unit).or_default();
            *most = most.max(own);
        }
        let spans = spans(run);
        let rests = |i: usize| {
            let alike = (0..n).filter(|k| units[*k] == units[i]).map(|k| spans[k].size());
            let size = alike.fold(if matches!(&*units[i], "" | "1" | "rad") { 1.0 } else { 0.0 }, f64::max);
            size > 0.0 && spans[i].range <= ROUNDED * size
        };
        (0..n).map(|i| if rests(i) { f64::INFINITY } else { of_unit[units[i].as_str()] }).collect()
    }

    /// Raises bounds to what accelerations that are off by this part of themselves, always alike, make of a motion: it is faster or slower,
    /// so that each coordinate is off by that part of all its ways to and fro, and its rate by as much of its range.
    pub(crate) fn frequency_error(&mut self, run: &Run, relative: f64) {
        let (columns, n) = (run.names.len(), run.names.coordinates.len());
        let ranges = &self.ranges;
        for i in (0..n).filter(|i| relative > 0.0 && ranges[*i].is_finite()) {
            let mut way = 0.0;
            for row in 1..run.len() {
                let speed = |row: usize| run.rows[2 * n * row + n + i].abs();
                way += 0.5 * (speed(row - 1) + speed(row)) * (run.times[row] - run.times[row - 1]);
                let off = relative * way;
                let bounds = &mut self.rows[columns * row..][..2 * n];
                bounds[i] = bounds[i].max(off);
                bounds[n + i] = bounds[n + i].max(off * ranges[n + i] / ranges[i]);
            }
        }
    }

    /// The largest bound of a coordinate or rate, in parts of its range.
    pub(crate) fn worst(&self, run: &Run) -> f64 {
        let n = run.names.coordinates.len();
        let (ranges, straddles) = (&self.ranges, &self.straddles);
        let of = |(at, bound): (usize, &f64)| {
            let column = Some(at % ranges.len()).filter(|column| *column < 2 * n && !straddles[at / ranges.len()]);
            column.map(|column| bound / ranges[column])
        };
        self.rows.iter().enumerate().filter_map(of).fold(0.0, f64::max)
    }

    /// No bound is below rounding; the first time at which one is as large as a range.
    fn settle(&mut self, run: &Run) {
        let (columns, n) = (run.names.len(), run.names.coordinates.len());
        let ranges = &self.ranges;
        let mut impulses = ImpulseRounding::new(run);
        self.lost = None;
        for row in 0..run.len() {
            let bounds = &mut self.rows[columns * row..][..columns];
            for (column, ((bound, value), range)) in bounds.iter_mut().zip(row_of(run, row)).zip(ranges).enumerate() {
                // Of an output its own terms tell, however far it has come down.
                let nothing = column < 2 * n && value.abs() <= NOTHING * range;
                *bound = bound.max(if nothing { 1.0 } else { 2.0 * f64::EPSILON } * value.abs());
            }
            // What rounding explains is 0.
            for ((bound, value), off) in bounds.iter_mut().zip(row_of(run, row)).zip(impulses.until(row)) {
                if value.abs() <= off {
                    *bound = bound.max(off);
                }
            }
            let lost = (0..2 * n).find(|column| bounds[*column] > LOST * ranges[*column] && !self.straddles[row]);
            self.lost = self.lost.or(lost.map(|column| (run.times[row], column)));
        }
    }
}

/// What the rounding of impulses has made of places and rates, each of its own sign: where those that strike at one instant cancel each other, a
/// rate that stays 0 is off by their rounding, and its place by that times the time since.
struct ImpulseRounding<'a> {
    run: &'a Run,
    next: usize,
    /// Of each rate Σ a², Σ a² t and Σ a² t², a being the terms of an impulse and t its instant, s.
    sums: Vec<[f64; 3]>,
}

impl<'a> ImpulseRounding<'a> {
    fn new(run: &'a Run) -> Self {
        ImpulseRounding { run, next: 0, sums: vec![[0.0; 3]; run.names.coordinates.len()] }
    }

    /// Of the places, then of the rates, in a row no earlier than the last one.
    fn until(&mut self, row: usize) -> Vec<f64> {
        let t = self.run.times[row];
        while let Some(impulse) = self.run.impulses.get(self.next).filter(|impulse| impulse.t <= t) {
            for (sums, term) in self.sums.iter_mut().zip(&impulse.terms) {
                sums.iter_mut().zip([1.0, impulse.t, impulse.t.powi(2)]).for_each(|(sum, t)| *sum += t * term.powi(2));
            }
            self.next += 1;
        }
        let rounding = TERMS * f64::EPSILON;
        let places = self.sums.iter().map(|[a, b, c]| rounding * (t * t * a - 2.0 * t * b + c).max(0.0).sqrt());
        places.chain(self.sums.iter().map(|[a, ..]| rounding * a.sqrt())).collect()
    }
}

/// At which times of the first run an event is between the two: its instant and the reported one are the same as far as the runs tell, and so many
/// events as at the times before and after were in neither.
fn straddles(run: &Run, other: &Run) -> Vec<bool> {
    let count = |run: &Run, t: f64| run.events.partition_point(|event| event.state.t <= t) as isize;
    let shared = run.times.iter().zip(&other.times).take_while(|(a, b)| a == b).count();
    let ahead: Vec<isize> = run.times[..shared].iter().map(|t| count(run, *t) - count(other, *t)).collect();
    let between = |row: usize| {
        let around = row.checked_sub(1).and_then(|before| ahead.get(before)).zip(ahead.get(row + 1));
        around.is_some_and(|(before, after)| before == after && ahead[row] != *before)
    };
    (0..run.len()).map(between).collect()
}

/// Differences of two runs, column by column at all times of the first one: the largest over the last tenth of the time
/// until then.
fn differences(run: &Run, other: &Run, (ranges, straddles): (&[f64], &[bool])) -> Vec<f64> {
    let columns = run.names.len();
    let shared = run.times.iter().zip(&other.times).take_while(|(a, b)| a == b).count();
    let ends_alike = ended_alike(run, other);
    let mut differences: Vec<f64> = Vec::with_capacity(columns * run.len());
    for row in 0..run.len() {
        let own = row_of(run, row);
        let theirs = if row < shared {
            row_of(other, row)
        } else if ends_alike && (row + 1 == run.len() || other.times.last().is_some_and(|end| run.times[row] >= *end)) {
            // An event that ends both may be just behind a reported time in one, and just before it in the other.
            row_of(other, other.len() - 1)
        } else {
            vec![f64::INFINITY; columns]
        };
        // What is absent in both has no error.
        differences.extend(own.iter().zip(&theirs).map(|(own, theirs)| apart_by(*own, *theirs)));
    }
    let mut own = vec![0.0; differences.len()];
    for row in (0..run.len()).filter(|row| straddles[*row]) {
        let here = columns * row..columns * (row + 1);
        own[here.clone()].swap_with_slice(&mut differences[here]);
    }
    couple_rates(&mut differences, &run.times, ranges, run.names.coordinates.len());
    let mut largest = own;
    for column in 0..columns {
        let sliding = sliding_maximum(&run.times, |row| differences[columns * row + column]);
        for (row, value) in sliding.into_iter().enumerate() {
            largest[columns * row + column] = value.max(largest[columns * row + column]);
        }
    }
    largest
}

impl Run {
    /// The bound of the error of a coordinate, rate or output at all reported times, SI; `None` if the run was not told
    /// to estimate it ([`Settings::digits`](crate::Settings::digits)), or if nothing has this name.
    pub fn errors(&self, name: &str) -> Option<Vec<f64>> {
        let digits = self.digits.as_ref()?;
        let column = self.names.place(name)?;
        Some(digits.rows.iter().skip(column).step_by(self.names.len()).copied().collect())
    }

    /// How many significant decimal digits of a value at the end can be promised, 0 to 15.
    ///
    /// `None` as in [`Run::errors`].
    pub fn digits(&self, name: &str) -> Option<u32> {
        let column = self.names.place(name)?;
        let error = self.last_error(column)?;
        Some(significant(*self.reported(column).next_back()?, error))
    }

    /// The bound on the error of a column's last value.
    fn last_error(&self, column: usize) -> Option<f64> {
        let rows = &self.digits.as_ref()?.rows;
        rows.get(rows.len().checked_sub(self.names.len())? + column).copied()
    }

    /// Bounds on the errors of the last state, by the names of coordinates and rates; none where they were not estimated.  What is known of nothing is as
    /// far off as its column goes.
    #[cfg(feature = "cli")]
    pub(crate) fn last_errors(&self) -> Vec<(String, f64)> {
        let Some(digits) = &self.digits else { return Vec::new() };
        let moving = self.column_names().into_iter().take(2 * self.names.coordinates.len()).enumerate();
        let known =
            moving.filter_map(|(column, name)| Some((name, self.last_error(column)?.min(digits.ranges[column]))));
        known.filter(|(name, error)| *error > 0.0 && !name.starts_with(HIDDEN)).collect()
    }

    /// The time until which digits of all coordinates can be promised, s: the end of the run if there is none without.
    ///
    /// `None` if the run was not told to estimate them.
    pub fn digits_until(&self) -> Option<f64> {
        let digits = self.digits.as_ref()?;
        Some(digits.lost.map_or_else(|| self.times.last().copied().unwrap_or(0.0), |(t, _)| t))
    }

    /// A value of the last state as text with the digits that hold, all of them where nothing is known of them; `?` where
    /// its error, or it itself, is no small part of all that the column goes through.
    pub(crate) fn written(&self, name: &str, value: f64) -> String {
        let column = self.names.place(name);
        let error = column.and_then(|column| self.last_error(column));
        let (Some(digits), Some(column), Some(error)) = (&self.digits, column, error) else { return plain(value) };
        let output = column.checked_sub(2 * self.names.coordinates.len());
        let cancelled = output.and_then(|output| digits.cancelled.get(output)).copied().unwrap_or(0.0);
        // What does not begin to move is not lost.
        let moves = self.times.first() != self.times.last();
        // An output of a unit that nothing moving has is 0 or not as the motion is: of that which holds, what is 0 all the time is 0.
        let moves = moves && !(output.is_some() && self.rests(column) && digits.worst(self) < KNOWN);
        let range = digits.ranges[column];
        let unknown = error > LOST * range || value.abs() > KNOWN * range;
        let lost = moves && error >= value.abs() && error > cancelled && unknown;
        written(value, if lost { f64::INFINITY } else { error })
    }

    /// Whether a column is exactly 0 at all reported times.
    fn rests(&self, column: usize) -> bool {
        self.reported(column).all(|value| *value == 0.0)
    }

    /// The time at which the run ended as text: known beforehand, unless an event ended it.
    #[cfg(feature = "cli")]
    pub(crate) fn written_end(&self, state: &State) -> String {
        let digits = self.digits.as_ref().filter(|_| self.ended_by().is_some());
        digits.map_or_else(|| plain(state.t), |digits| written_time(state.t, digits.end))
    }

    /// The time of an event as text.
    #[cfg(feature = "cli")]
    pub(crate) fn written_event(&self, index: usize) -> String {
        let t = self.events[index].state.t;
        match &self.digits {
            None => plain(t),
            Some(digits) => written_time(t, digits.events.get(index).copied().unwrap_or(f64::INFINITY)),
        }
    }
}

/// The bound on the error of an event's time, at which two runs are so far apart.
fn located(apart: f64, t: f64) -> f64 {
    if apart == 0.0 && is_decimal(t) { 0.0 } else { apart.max(LOCATED * f64::EPSILON * t.abs()) }
}

/// Whether a number has few decimal digits.
fn is_decimal(number: f64) -> bool {
    let text = format!("{number:e}");
    let digits = text.split('e').next().unwrap_or(&text);
    digits.bytes().filter(u8::is_ascii_digit).count() <= DECIMAL
}

/// A time without error was known beforehand: it is written as it is.  One that is smaller than its error is not 0, but unknown.
#[cfg(feature = "cli")]
fn written_time(t: f64, error: f64) -> String {
    match error {
        0.0 => plain(t),
        error if error >= t.abs() => "?".to_owned(),
        error => written(t, error),
    }
}

/// Significant decimal digits of a value with this error, 0 to 15.
fn significant(value: f64, error: f64) -> u32 {
    if error == 0.0 || value.is_nan() {
        return MOST as u32;
    }
    (value.abs() / error).log10().floor().clamp(0.0, f64::from(MOST)) as u32
}

/// A value with the digits that an error leaves; 0 where it is smaller than its error, `?` where the error has no bound.
pub(crate) fn written(value: f64, error: f64) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if !error.is_finite() {
        return "?".to_owned();
    }
    if value.abs() <= error || value == 0.0 {
        return "0".to_owned();
    }
    let leading = value.abs().log10().floor() as i32;
    // The last digit stands for no less than the error.
    let last = if error == 0.0 { i32::MIN / 2 } else { error.log10().ceil() as i32 };
    let count = (leading - last + 1).clamp(1, MOST);
    let decimals = count - 1 - leading;
    if (-5..MOST).contains(&leading) && decimals >= 0 {
        format!("{value:.*}", decimals as usize)
    } else {
        format!("{value:.*e}", count as usize - 1)
    }
}

/// True where two runs ended for the same reason.
fn ended_alike(run: &Run, other: &Run) -> bool {
    let event = |run: &Run| run.ended_by().map(|event| event.event);
    event(run) == event(other) && (event(run).is_some() || run.times.last() == other.times.last())
}

fn row_of(run: &Run, row: usize) -> Vec<f64> {
    let (n, m) = (run.names.coordinates.len(), run.names.outputs.len());
    [&run.rows[2 * n * row..][..2 * n], &run.outputs[m * row..][..m]].concat()
}

/// The least and the largest value of a column, and how far it goes.
struct Span {
    low: f64,
    high: f64,
    range: f64,
}

impl Span {
    fn size(&self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// What does not move by more than this part of itself is constant: its size is its range.
    fn own(&self, still: f64) -> f64 {
        if self.range > still * self.size() { self.range } else { self.size() }
    }
}

fn spans(run: &Run) -> Vec<Span> {
    let mut ends = vec![(f64::INFINITY, f64::NEG_INFINITY); run.names.len()];
    for row in 0..run.len() {
        for ((low, high), value) in ends.iter_mut().zip(row_of(run, row)).filter(|(_, value)| value.is_finite()) {
            (*low, *high) = (low.min(value), high.max(value));
        }
    }
    // Where reports are few, most of a motion may lie between them.
    let gone = |column: usize| run.swept.get(column).copied().unwrap_or(0.0);
    let of = |(column, (low, high)): (usize, (f64, f64))| {
        let range = match (high - low).max(0.0) {
            // A state that does not move at all is beside its own size.
            _ if run.len() == 1 => low.abs().max(high.abs()),
            range if range < 0.5 * gone(column) => gone(column),
            range => range,
        };
        Span { low, high, range }
    };
    ends.into_iter().enumerate().map(of).collect()
}

/// How far the values of each column are apart, of a component of a vector beside the others.
fn own_ranges(run: &Run, spans: &[Span], still: f64) -> Vec<f64> {
    let mut ranges: Vec<f64> = spans.iter().map(|span| span.own(still)).collect();
    let mut first = 2 * run.names.coordinates.len();
    for output in run.description.outputs.iter() {
        let own = first..(first + output.components as usize).min(spans.len());
        let size = spans[own.clone()].iter().map(Span::size).fold(0.0, f64::max);
        ranges[own.clone()].iter_mut().for_each(|range| *range = range.max(STILL * size));
        first = own.end;
    }
    ranges
}

/// How far the values of each column are apart; at least so far as what else has its unit does not round away.
fn ranges(run: &Run, still: f64) -> Vec<f64> {
    let (names, spans) = (run.column_names(), spans(run));
    let units: Vec<String> = names.iter().map(|name| run.unit(name)).collect();
    // Outputs may be quotients by what vanishes: the motion says what is large, where it has the unit.
    let states = 2 * run.names.coordinates.len();
    let largest = |unit: &String| {
        let alike = || spans.iter().zip(&units).enumerate().filter(|(_, (_, other))| *other == unit);
        let moves = alike().any(|(column, _)| column < states);
        let counts = alike().filter(|(column, _)| !moves || *column < states);
        counts.fold(f64::MIN_POSITIVE, |most, (_, (span, _))| most.max(span.range))
    };
    let mut ranges = own_ranges(run, &spans, still);
    ranges.iter_mut().zip(&units).for_each(|(range, unit)| *range = range.max(STILL * largest(unit)));
    // Of what is hidden nothing is asked.
    let hidden = names.iter().map(|name| name.starts_with(HIDDEN));
    ranges.iter_mut().zip(hidden).filter(|(_, hidden)| *hidden).for_each(|(range, _)| *range = f64::INFINITY);
    // Where all rests, rates are what rounding makes of the places in all that time or in the time of a vibration, and an angle is one beside 1 rad.
    let span = run.times.last().zip(run.times.first()).map_or(0.0, |(last, first)| last - first);
    for i in (0..states / 2).filter(|i| !names[*i].starts_with(HIDDEN)) {
        if matches!(&*units[i], "" | "1" | "rad") {
            ranges[i] = ranges[i].max(ROUNDED);
        }
        // A place is beside the largest that has its unit.
        let alike = (0..states / 2).filter(|k| units[*k] == units[i]);
        let size = alike.fold(0.0_f64, |most, k| most.max(spans[k].size()));
        let nothing = if size.is_finite() { NOTHING * size } else { 0.0 };
        ranges[i] = ranges[i].max(nothing);
        if span > 0.0 {
            let fastest = run.fastest.max(1.0 / span);
            let struck: f64 = run.impulses.iter().filter_map(|impulse| impulse.terms.get(i)).sum();
            ranges[i] = ranges[i].max(STILL * struck * span);
            let rounded = (STILL * ranges[i] * fastest).max(STILL * struck).max(nothing * fastest);
            // Outputs that are speeds are told by the same size.
            let speeds = (states..names.len()).filter(|column| units[*column] == units[states / 2 + i]);
            for column in speeds.chain([states / 2 + i]) {
                ranges[column] = ranges[column].max(rounded);
            }
        }
    }
    ranges
}

/// Raises the difference of a coordinate to that of its rate in the same part of its range, and the other way round.
fn couple_rates(differences: &mut [f64], times: &[f64], ranges: &[f64], n: usize) {
    let columns = ranges.len();
    for (row, t) in times.iter().enumerate() {
        let elapsed = t - times[0];
        for i in (0..n).filter(|i| ranges[*i].is_finite()) {
            let (place, speed) = (columns * row + i, columns * row + n + i);
            let (dq, dv) = (differences[place], differences[speed]);
            // An error of a rate moves its coordinate no farther than in all the time there was.
            differences[place] = dq.max(dv * (ranges[i] / ranges[n + i]).min(elapsed));
            differences[speed] = dv.max(dq * ranges[n + i] / ranges[i]);
        }
    }
}

/// The largest value at each time over the last part of the time since the first.
fn sliding_maximum(times: &[f64], value: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut candidates: VecDeque<usize> = VecDeque::new();
    let mut largest = Vec::with_capacity(times.len());
    for (row, t) in times.iter().enumerate() {
        while candidates.back().is_some_and(|last| value(*last) <= value(row)) {
            candidates.pop_back();
        }
        candidates.push_back(row);
        let begin = t - WINDOW * (t - times[0]);
        while candidates.front().is_some_and(|first| times[*first] < begin) {
            candidates.pop_front();
        }
        largest.push(candidates.front().map_or(0.0, |first| value(*first)));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::{significant, sliding_maximum, written};

    #[test]
    fn numbers_have_the_digits_that_hold() {
        for (value, error, text) in [
            (1.234_567_890_1, 1e-6, "1.234568"),
            (0.5, 1e-10, "0.5000000000"),
            (-0.000_123_456, 2e-9, "-0.00012346"),
            (1e-17, 1e-15, "0"),
            (0.0, 0.0, "0"),
            (3.0, f64::INFINITY, "?"),
            (1.5e11, 1e3, "1.50000000e11"),
            (123.456, 3.0, "1.2e2"),
            (7.0, 5.0, "7"),
            (6.02e-23, 1e-27, "6.0200e-23"),
        ] {
            assert_eq!(written(value, error), text, "{value} {error}");
        }
    }

    #[test]
    fn digits_are_counted_from_the_first_that_is_not_zero() {
        assert_eq!(significant(1.0, 1e-6), 6);
        assert_eq!(significant(1e-9, 1e-6), 0);
        assert_eq!(significant(0.0, 0.0), 15);
        assert_eq!(significant(1.0, f64::INFINITY), 0);
    }

    #[test]
    fn the_largest_of_the_last_tenth_counts() {
        let times: Vec<f64> = (0..=100).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| if *t == 50.0 { 9.0 } else { 1.0 }).collect();
        let largest = sliding_maximum(&times, |row| values[row]);
        assert_eq!((largest[49], largest[50], largest[55], largest[56]), (1.0, 9.0, 9.0, 1.0));
    }
}
