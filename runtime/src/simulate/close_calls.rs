//! Events that an error as large as the run's may add or take away.

use crate::mechanism::{At, System, Trigger};
use crate::run::{Digits, Occurrence, Run};
use crate::trust::Warning;

/// An event's function is looked at so many times between two of its crossings, beside all reported times.
const LOOKS: usize = 8;
/// No event is looked at more often.
const MOST_LOOKS: usize = 200_000;
/// So often is the place found better where it turns back.
const REFINEMENTS: usize = 40;

/// What an event of a run says of itself.
struct Look<'a> {
    system: &'a dyn System,
    run: &'a Run,
    digits: &'a Digits,
    event: usize,
}

/// Warnings of events that are nearer to the end than the error of the last state, or turn back nearer to zero than theirs.
pub(super) fn close_calls(system: &dyn System, run: &Run, digits: &Digits, ignored: &[usize]) -> Vec<Warning> {
    let events = system.description().events.iter().enumerate().filter(|(index, _)| !ignored.contains(index));
    let told = events.flat_map(|(index, event)| {
        let look = Look { system, run, digits, event: index };
        let near_end = look.is_near_end().then(|| Warning::EventNearEnd { event: event.name.to_string() });
        let grazes = look.grazes().map(|t| Warning::EventGrazes { event: event.name.to_string(), t });
        [near_end, grazes]
    });
    told.flatten().collect()
}

impl Look<'_> {
    /// The event's function at a state, where it counts.
    fn value(&self, t: f64, y: &[f64]) -> Option<f64> {
        let mut pairs = vec![f64::NAN; 2 * self.system.description().events.len()];
        let (at, mut a) = (At::packed(t, y, self.system.len()), vec![0.0; self.system.len()]);
        self.system.accelerations(at, &mut a).ok()?;
        self.system.events(at.accelerated(&a), &mut pairs);
        let counts = self.counts_in(self.phase(t)) && pairs[2 * self.event + 1] > 0.0;
        Some(pairs[2 * self.event]).filter(|value| counts && value.is_finite())
    }

    /// The same on the motion.
    fn on_motion(&self, t: f64) -> Option<f64> {
        let state = self.run.at(t)?;
        self.value(t, &[state.q, state.v].concat())
    }

    fn phase(&self, t: f64) -> usize {
        let later = self.run.phases.partition_point(|(begin, _)| *begin <= t);
        self.run.phases.get(later.saturating_sub(1)).map_or(0, |(_, phase)| *phase)
    }

    fn counts_in(&self, phase: usize) -> bool {
        let phases = &self.system.description().events[self.event].phases;
        phases.as_ref().is_none_or(|phases| phases.contains(&(phase as u32)))
    }

    /// The function at a state, and what it may be there as well: at states as near to this one as its error.
    fn may_be(&self, t: f64, y: &[f64]) -> Option<(f64, Vec<f64>)> {
        let row = self.run.times.partition_point(|time| *time < t).min(self.run.len() - 1);
        let usual = self.value(t, y)?;
        let others = self.digits.around(self.run, row, y);
        Some((usual, others.iter().filter_map(|y| self.value(t, y)).collect()))
    }

    fn is_near_end(&self) -> bool {
        let n = self.system.len();
        let Some(before) = self.run.len().checked_sub(2) else { return false };
        let row = |row: usize| (self.run.times[row], &self.run.rows[2 * n * row..][..2 * n]);
        let (t, y) = row(before + 1);
        let Some((end, others)) = self.may_be(t, y) else { return false };
        let moved = others.iter().fold(0.0_f64, |most, other| most.max((other - end).abs()));
        let (t, y) = row(before);
        // What rests at zero was there before, and what ended the run is told.
        let comes = self.value(t, y).is_some_and(|value| value.abs() > moved);
        let ended = self.run.ended_by().is_some_and(|ending| self.brings(ending));
        comes && !ended && others.iter().any(|other| other * end < 0.0)
    }

    /// Whether it is the event that ended the run, or set at that instant what one followed that did.
    fn brings(&self, ending: &Occurrence) -> bool {
        let follows = matches!(self.system.sampling().trigger(ending.event), Trigger::Set(_));
        ending.event == self.event || follows && self.crossings().contains(&ending.state.t)
    }

    /// When it first turns back nearer to zero than it is known.
    fn grazes(&self) -> Option<f64> {
        let (times, crossings) = (self.times(), self.crossings());
        let values: Vec<Option<f64>> = times.iter().map(|t| self.on_motion(*t)).collect();
        for k in 1..times.len().saturating_sub(1) {
            let (before, after) = (times[k - 1], times[k + 1]);
            let [Some(a), Some(b), Some(c)] = values[k - 1..k + 2] else { continue };
            // What is struck at its zero turns back there, and was counted.
            let hit = || crossings.iter().any(|t| (before..=after).contains(t));
            if a * b > 0.0 && b * c > 0.0 && b.abs() < a.abs() && b.abs() < c.abs() && !hit() {
                let t = self.turn(before, after);
                let last = crossings.iter().rfind(|crossing| **crossing < t).copied().unwrap_or(f64::NEG_INFINITY);
                if self.is_zero_at(t) && !self.rests(&times, k, last) {
                    return Some(t);
                }
            }
        }
        // Two crossings with nothing but an error between them; of one direction there is one of the other between.
        let mut pairs = crossings.windows(2);
        let grazed = pairs.find(|pair| between(pair[0], pair[1]).all(|t| self.is_zero_at(t)));
        grazed.map(|pair| 0.5 * (pair[0] + pair[1]))
    }

    /// Whether it is as near to zero as it is known from its last crossing until a time, or from then on: it has come to rest there, and does
    /// not turn back.
    fn rests(&self, times: &[f64], k: usize, last: f64) -> bool {
        let leaves = |t: &f64| !self.is_zero_at(*t);
        let since = times[..k].iter().rev().take_while(|t| **t > last);
        !since.into_iter().any(leaves) || !times[k + 1..].iter().any(leaves)
    }

    fn is_zero_at(&self, t: f64) -> bool {
        let Some(state) = self.run.at(t) else { return false };
        let known = self.may_be(t, &[state.q, state.v].concat());
        known.is_some_and(|(usual, others)| others.iter().any(|other| other * usual <= 0.0))
    }

    fn crossings(&self) -> Vec<f64> {
        let own = self.run.events.iter().filter(|event| event.event == self.event);
        own.map(|event| event.state.t).collect()
    }

    /// The times at which it is looked at.
    fn times(&self) -> Vec<f64> {
        let crossings = self.crossings();
        let mut times = self.run.times.clone();
        for pair in crossings.windows(2).take(MOST_LOOKS / LOOKS) {
            times.extend(between(pair[0], pair[1]));
        }
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// Where its size is least between two times, by the golden section.
    fn turn(&self, mut from: f64, mut until: f64) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let size = |t: f64| self.on_motion(t).map_or(f64::INFINITY, f64::abs);
        for _ in 0..REFINEMENTS {
            let (left, right) = (until - GOLDEN * (until - from), from + GOLDEN * (until - from));
            if size(left) < size(right) { until = right } else { from = left }
        }
        0.5 * (from + until)
    }
}

/// Times between two others at which a function is looked at.
fn between(from: f64, until: f64) -> impl Iterator<Item = f64> {
    (1..LOOKS).map(move |k| from + (until - from) * k as f64 / LOOKS as f64)
}
