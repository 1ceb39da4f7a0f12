//! Events whose functions are flat about their zero: of high order, or a small difference of large terms.

use crate::constrain::with_shares;
use crate::mechanism::{Action, At, System};
use crate::run::{Digits, Run};

/// By so many roundings each number of the state is moved to see what the function's own rounding is.
const ROUNDINGS: [f64; 4] = [-12.0, -4.0, 4.0, 12.0];
/// A zero within so many roundings of its time is simple, and as exact as two runs say.
const SIMPLE: f64 = 1e4;
/// No more events are looked at, beside the one that ended the run: each costs some evaluations for each number of the state.
const MOST_LOOKED_AT: usize = 10_000;

/// Raises the bounds of the times of events by half of the stretch in which the function is below its own rounding; where such an event
/// ends the run, those of the last state by what happens meanwhile.
pub(super) fn widen_flat_events(system: &dyn System, run: &Run, digits: &mut Digits) {
    let (mut system, start) = (system.boxed_clone(), run.times.first().copied());
    let looked_at = |index: usize| index < MOST_LOOKED_AT || run.ended_by == Some(index);
    for (index, event) in run.events.iter().enumerate().filter(|(index, _)| looked_at(*index)) {
        let t = event.state.t;
        // The function is that of the phase which the event may end.
        let before = run.phases.iter().take_while(|(from, _)| *from < t).last().or(run.phases.first());
        before.into_iter().for_each(|(_, phase)| system.set_phase(*phase));
        // Behind it other equations are in force, or another state.
        let changes = |action: &Action| !matches!(action, Action::Record | Action::Stop);
        let acts = system.description().events[event.event].actions.iter().any(changes);
        let ends = acts || run.phases.iter().any(|(from, _)| *from == t);
        let width = if Some(t) == start { 0.0 } else { flat(&*system, run, event.event, (t, ends)) };
        if width > SIMPLE * f64::EPSILON * t.abs() {
            digits.widen_event(index, width);
            if run.ended_by == Some(index) {
                digits.widen_end(run, width, &rates(&*system, run));
            }
        }
    }
}

/// Half of the time in which an event's function is below its rounding about its zero at t, s; before it, where it `ends` something.
fn flat(system: &dyn System, run: &Run, event: usize, (t, ends): (f64, bool)) -> f64 {
    let Some(state) = run.at(t) else { return 0.0 };
    let y = [state.q, state.v].concat();
    let Some(here) = value(system, event, t, &y) else { return 0.0 };
    let mut moved = y.clone();
    let mut noise = 0.0_f64;
    for i in 0..y.len() {
        for by in ROUNDINGS {
            moved[i] = y[i] * (1.0 + by * f64::EPSILON);
            noise = noise.max(value(system, event, t, &moved).map_or(0.0, |there| (there - here).abs()));
        }
        moved[i] = y[i];
    }
    let silent =
        |t: f64| motion(system, run, t).and_then(|y| value(system, event, t, &y)).is_some_and(|f| f.abs() <= noise);
    let mut width = f64::EPSILON * t.abs().max(f64::MIN_POSITIVE);
    while silent(t - 2.0 * width) || !ends && silent(t + 2.0 * width) {
        width *= 2.0;
    }
    // What was at its zero from the start on happens where it leaves it, which other forces make.
    let rests = |start: &f64| t - 2.0 * width <= *start && silent(*start);
    if run.times.first().is_some_and(rests) { 0.0 } else { width }
}

/// The state of the run at a time, beyond its end by a parabola; `None` before its start, and further beyond than it took.
fn motion(system: &dyn System, run: &Run, t: f64) -> Option<Vec<f64>> {
    let (first, last) = (*run.times.first()?, *run.times.last()?);
    if t <= last {
        let state = run.at(t)?;
        return Some([state.q, state.v].concat());
    }
    let (n, h) = (system.len(), t - last);
    let end = &run.rows[2 * n * (run.len() - 1)..][..2 * n];
    let rates = rates(system, run);
    let (v, a) = rates.split_at(n);
    let moved = (0..2 * n).map(|i| if i < n { end[i] + h * (v[i] + 0.5 * h * a[i]) } else { end[i] + h * a[i - n] });
    (h <= last - first).then(|| moved.collect())
}

/// An event's function at a state, with the share of forces by which it was located.
fn value(system: &dyn System, event: usize, t: f64, y: &[f64]) -> Option<f64> {
    let (n, description) = (system.len(), system.description());
    let mut pairs = vec![f64::NAN; 2 * description.events.len()];
    let at = At::packed(t, y, n);
    let (a, lambda) = with_shares(system, at).ok()?;
    system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
    Some(pairs[2 * event]).filter(|value| value.is_finite())
}

/// Speeds and accelerations at the end of a run.
fn rates(system: &dyn System, run: &Run) -> Vec<f64> {
    let (n, row) = (system.len(), run.len().saturating_sub(1));
    let end = &run.rows[2 * n * row..][..2 * n];
    let mut a = vec![0.0; n];
    if system.accelerations(At::packed(run.times[row], end, n), &mut a).is_err() {
        a.fill(f64::INFINITY);
    }
    [&end[n..], &a].concat()
}
