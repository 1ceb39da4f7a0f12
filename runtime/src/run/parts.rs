//! Runs of decoupled subsystems, put together to one of the whole.

use super::record::usual_drift;
use super::{Occurrence, Plan, Recorder, Run, Trajectory, Work};
use crate::integrate::Endpoint;
use crate::mechanism::{Method, System};
use crate::trust::Monitor;

/// A part of a mechanism that was run by itself.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RunPart {
    /// Its coordinates.
    pub coordinates: Vec<String>,
    /// The method that was used.
    pub method: Method,
    /// Why it was chosen.
    pub why: Option<&'static str>,
    /// The step, s, of a method that keeps one.
    pub step: Option<f64>,
    /// Work done; evaluations are of the accelerations of this part alone.
    pub work: Work,
}

/// The run of a part.
pub(crate) struct PartRun {
    /// Its coordinates among those of the whole.
    pub coordinates: Vec<usize>,
    /// Its events among those of the whole.
    pub events: Vec<usize>,
    /// The run.
    pub run: Run,
}

/// What the whole run is to hold.
pub(crate) struct Together {
    /// Where it was to end, s.
    pub until: f64,
    /// The tolerance.
    pub tolerance: f64,
    /// Whether to keep dense output.
    pub dense: bool,
    /// Whether to watch invariants.
    pub watch: bool,
    /// Time it took, s.
    pub seconds: f64,
}

/// Within what time events of parts happen at one instant, s: 1e-11 of the run, as within a step of the whole.
pub(crate) fn instant(from: f64, until: f64) -> f64 {
    const PART: f64 = 1e-11;
    // A step may end a rounding after the time to which it brings the clock.
    PART * (until - from).abs() + 4.0 * f64::EPSILON * until.abs()
}

/// Puts the runs of all parts together, as far as the one that came least far.
///
/// Where the others go farther their states at its end come from their dense output.  What the file says is conserved is looked at in
/// the reported states; the drift of the energy balance is the largest of the parts'.
pub(crate) fn put_together(system: &dyn System, parts: Vec<PartRun>, how: &Together) -> Run {
    let n = system.len();
    let last = |run: &Run| run.times.last().copied().unwrap_or(f64::NEG_INFINITY);
    let runs = || parts.iter().map(|part| &part.run);
    let least = runs().min_by(|a, b| last(a).total_cmp(&last(b)));
    let mut rows = least.map_or_else(Vec::new, |run| run.times.clone()).into_iter().enumerate();
    let mut rows = std::iter::from_fn(|| {
        let (row, t) = rows.next()?;
        Some((t, state(&parts, n, (row, t))?))
    });
    let (from, start) = rows.next().unwrap_or((0.0, vec![0.0; 2 * n]));
    let dearest = runs().max_by_key(|run| run.work.evaluations);
    let plan = Plan {
        why: dearest.and_then(|run| run.why),
        tolerance: Some(how.tolerance),
        ..Plan::quiet(how.until, how.until - from, dearest.map_or(Method::Auto, |run| run.method))
    };
    let mut recorder = Recorder::new(&plan, system, from, Endpoint { y: &start, rate: &[], work: 0.0 });
    let mut monitor = how.watch.then(|| Monitor::new(system, from, &start, 0.0));
    let (mut t, mut y) = (from, start);
    for (next, state) in rows {
        (t, y) = (next, state);
        recorder.report(system, t, &y);
        if let Some(monitor) = &mut monitor {
            monitor.observe(system, t, &y, 0.0);
        }
    }
    let work = runs().fold(Work::default(), |sum, run| sum.plus(&run.work));
    let (events, ended_by) = occurrences(system, &parts, (t, instant(from, how.until)), &mut recorder);
    let mut run = recorder.finish(system, t, Endpoint { y: &y, rate: &[], work: 0.0 }, work, how.seconds);
    (run.events, run.ended_by) = (events, ended_by);
    if let Some(monitor) = monitor {
        run.drift = monitor.drifts(system.description());
        run.warn_of_drift(usual_drift(run.tolerance, work.steps));
        let balances = runs().map(|part| part.energy_balance);
        run.energy_balance = balances.reduce(|a, b| a.zip(b).map(|(a, b)| a.max(b))).flatten();
    }
    run.swept = vec![0.0; 2 * n];
    for PartRun { coordinates, run: part, .. } in &parts {
        for warning in &part.warnings {
            if !run.warnings.iter().any(|known| known.same_kind(warning)) {
                run.warnings.push(warning.clone());
            }
        }
        scatter(coordinates, &part.swept, &mut run.swept);
        run.parts.push(RunPart {
            coordinates: part.names.coordinates.clone(),
            method: part.method,
            why: part.why,
            step: part.step,
            work: part.work,
        });
    }
    if how.dense {
        let parts = parts.into_iter().map(|part| (part.coordinates, part.run.trajectory)).collect();
        run.trajectory = Trajectory::of_parts(n, parts, t);
        run.scenery.keep(system, run.trajectory.end());
    }
    run
}

/// The state of the whole in a row at this time; `None` where the dense output of a part does not reach it.
fn state(parts: &[PartRun], n: usize, (row, t): (usize, f64)) -> Option<Vec<f64>> {
    let mut y = vec![0.0; 2 * n];
    for PartRun { coordinates, run, .. } in parts {
        let size = 2 * coordinates.len();
        if run.times.get(row) == Some(&t) {
            scatter(coordinates, &run.rows[size * row..][..size], &mut y);
        } else {
            beside(coordinates, run, t, &mut y)?;
        }
    }
    Some(y)
}

/// Writes the state of a part at any time into that of the whole.
fn beside(coordinates: &[usize], run: &Run, t: f64, y: &mut [f64]) -> Option<()> {
    let mut own = vec![0.0; 2 * coordinates.len()];
    run.trajectory.evaluate(t, &mut own).then(|| scatter(coordinates, &own, y))
}

/// The events of all parts until t, in order, with the states of the whole, and the place of the one that ended it; those at the
/// instant at which the run ends are in the file's order.
fn occurrences(
    system: &dyn System,
    parts: &[PartRun],
    (until, instant): (f64, f64),
    recorder: &mut Recorder,
) -> (Vec<Occurrence>, Option<usize>) {
    let mut found = Vec::new();
    for (k, PartRun { coordinates, events, run }) in parts.iter().enumerate() {
        for (place, event) in run.events.iter().enumerate().filter(|(_, event)| event.state.t <= until + instant) {
            let t = if event.state.t < until - instant { event.state.t } else { until };
            let mut y = vec![0.0; 2 * system.len()];
            scatter(coordinates, &[event.state.q.as_slice(), &event.state.v].concat(), &mut y);
            let others = parts.iter().enumerate().filter(|(other, _)| *other != k);
            let reached = others.map(|(_, other)| beside(&other.coordinates, &other.run, t, &mut y));
            if reached.collect::<Option<()>>().is_some() {
                let state = recorder.state_with_outputs(system, t, &y);
                let ends = run.ended_by == Some(place);
                found.push((Occurrence { name: event.name.clone(), event: events[event.event], state }, ends));
            }
        }
    }
    found.sort_by(|(a, _), (b, _)| a.state.t.total_cmp(&b.state.t).then(a.event.cmp(&b.event)));
    // As of events within one step, the last of several that stop.
    let ended_by = found.iter().rposition(|(_, ends)| *ends);
    (found.into_iter().map(|(event, _)| event).collect(), ended_by)
}

/// Writes [q; q'] of a part into that of the whole.
pub(super) fn scatter(coordinates: &[usize], own: &[f64], y: &mut [f64]) {
    let n = y.len() / 2;
    let (q, v) = own.split_at(own.len() / 2);
    for ((i, q), v) in coordinates.iter().zip(q).zip(v) {
        (y[*i], y[n + i]) = (*q, *v);
    }
}
