//! Decoupled subsystems, each run by itself.
//!
//! The part that has come least far takes the next step, so that all have gone about as far wherever a run ends.

use std::ops::ControlFlow;

use super::{Settings, Start, finish, start};
use crate::cause::Cause;
use crate::driver::{Integration, StopReason};
use crate::error::Error;
use crate::mechanism::{Method, OfPart, System, Trigger};
use crate::run::{Failure, PartRun, Recorder, Run, Together, instant, put_together};
use crate::stopwatch::Stopwatch;

/// A part with its settings.
pub(super) type Part = (OfPart, Settings);

/// The parts of a run that are to be run apart; none where all is run together.
///
/// # Errors
/// A setting without meaning.
pub(super) fn parts(system: &dyn System, settings: &Settings) -> Result<Vec<Part>, Error> {
    let description = system.description();
    settings.check(description)?;
    let replaced = (0..description.inputs.len()).any(|input| system.signal(input).is_some());
    let chosen = settings.method != Method::Auto || settings.step.is_some();
    // Parts count their own events only, and no clock is of one of them.
    let ticks = (0..description.events.len()).any(|event| *system.sampling().trigger(event) != Trigger::Zero);
    let whole = ticks || !settings.start_conditions.is_empty() || !settings.ignored_events.is_empty();
    if !settings.apart || chosen || replaced || system.derivation().is_some() || whole {
        return Ok(Vec::new());
    }
    let part = |index: usize| {
        let part = OfPart::new(system, index, &settings.q)?;
        let own = |all: &[f64]| part.coordinates().iter().map(|i| all[*i]).collect::<Vec<f64>>();
        let (q, v) = (own(&settings.q), own(&settings.v));
        let beside = settings.beside.as_ref().map(|all| {
            let (q, v) = all.split_at(settings.q.len());
            [own(q), own(v)].concat()
        });
        let (held_q, held_v, spins) = (Vec::new(), Vec::new(), Vec::new());
        // What the others do at its end is read from their dense output.
        let settings = Settings { q, v, beside, held_q, held_v, spins, digits: false, dense: true, ..settings.clone() };
        Some((part, settings))
    };
    Ok((0..description.parts.len()).filter_map(part).collect())
}

/// A part under way.
struct Way {
    part: OfPart,
    integration: Integration,
    recorder: Recorder,
    /// Whether an event of it has ended the run.
    stopped: bool,
}

/// Runs parts of a mechanism, and puts them together.
///
/// # Errors
/// As [`simulate_with`](super::simulate_with), with what all parts had come through by then.
pub(super) fn simulate(
    system: &mut dyn System,
    parts: Vec<Part>,
    settings: &Settings,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, Error> {
    let clock = Stopwatch::start();
    let mut ended = None;
    let mut ways = Vec::with_capacity(parts.len());
    // Where an event of a part ends the run, the others come to, and to events of theirs at the same instant.
    let (mut until, instant) = (settings.until, instant(settings.from, settings.until));
    for (mut part, own) in parts {
        let Start { mut integration, mut recorder, outcome } = start(&mut part, &own, settings.spacing())?;
        let begun = outcome.and_then(|()| match settings.from < settings.until {
            true => integration.act_at_start(&mut part, &mut recorder),
            false => Ok(StopReason::Arrived),
        });
        let stopped = matches!(begun, Ok(StopReason::Event));
        if stopped {
            until = until.min(integration.time() + instant);
        }
        if let (Err(cause), None) = (begun, &ended) {
            ended = Some(recorder.explain(&part, *cause));
        }
        ways.push(Way { part, integration, recorder, stopped });
    }
    while ended.is_none() {
        let steps: u64 = ways.iter().map(|way| way.integration.work().steps).sum();
        let going = ways.iter_mut().filter(|way| !way.stopped);
        let least = going.min_by(|a, b| a.integration.time().total_cmp(&b.integration.time()));
        let Some(Way { part, integration, recorder, stopped }) = least.filter(|way| way.integration.time() < until)
        else {
            break;
        };
        if steps >= settings.max_steps {
            ended = Some(Cause::TooManySteps { limit: settings.max_steps });
            break;
        }
        let from = integration.time();
        match integration.one(part, until, recorder) {
            Err(cause) => ended = Some(recorder.explain(part, *cause)),
            Ok(StopReason::Event) => {
                *stopped = true;
                until = until.min(integration.time() + instant);
            }
            Ok(StopReason::Arrived | StopReason::Stiff) => {}
        }
        if progress(from).is_break() {
            ended.get_or_insert(Cause::Interrupted);
        }
    }
    for Way { part, integration, recorder, stopped } in &mut ways {
        let arrived = ended.is_none() && !*stopped && settings.from < settings.until;
        if arrived && integration.time() >= settings.until {
            match integration.end_events(part, recorder) {
                Err(cause) => ended = Some(recorder.explain(part, *cause)),
                Ok(reason) => *stopped = reason == StopReason::Event,
            }
        }
    }
    let runs = ways.into_iter().map(|Way { part, integration, recorder, .. }| {
        let (coordinates, events) = (part.coordinates().to_vec(), part.events().to_vec());
        PartRun { coordinates, events, run: finish(&part, &integration, recorder, clock) }
    });
    let how = Together {
        until: settings.until,
        tolerance: settings.tolerance.max(Settings::TIGHTEST),
        dense: settings.dense,
        watch: settings.watch,
        seconds: clock.seconds(),
    };
    let run = put_together(system, runs.collect(), &how);
    match ended {
        None => Ok(run),
        Some(cause) => Err(Error::Run(Box::new(Failure { cause, state: run.last(), run }))),
    }
}
