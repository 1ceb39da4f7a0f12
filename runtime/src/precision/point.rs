//! One run: its error, its cost, or why there is none.

use std::sync::Arc;

use super::{Candidate, Reference, WorkUnits};
use crate::cause::Cause;
use crate::error::Error;
use crate::mechanism::{Method, System};
use crate::run::{Run, Work};
use crate::simulate::{Settings, simulate};
use crate::stopwatch::Stopwatch;
use crate::trust::Warning;

/// How a run is told to be more accurate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AccuracyControl {
    /// A relative tolerance.
    Tolerance(f64),
    /// A fixed step, s.
    Step(f64),
}

/// One point of a curve.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Point {
    /// Its tolerance or step.
    pub control: AccuracyControl,
    /// What came out, or a word for why nothing did: `unstable`, or [`Cause::code`](crate::Cause::code).
    pub outcome: Result<Measured, &'static str>,
}

/// What a run came to.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Measured {
    /// The method, which `auto` may choose anew for each tolerance.
    pub method: Method,
    /// The largest error over the scene, in parts of the range of what is compared.
    pub error: f64,
    /// The largest error until each of the times of the reference.
    pub growth: Vec<f64>,
    /// Evaluations of the accelerations, with Jacobians and factorizations in units of these.
    pub cost: f64,
    /// What was counted.
    pub work: Work,
    /// Time it took on one thread, s; the least of several runs.
    pub seconds: f64,
    /// Drift of the energy balance.
    pub drift: Option<f64>,
    /// The largest residual of a constraint.
    pub residual: Option<f64>,
}

/// A run is repeated until all took so long, s.
const ENOUGH_TIME: f64 = 0.02;

/// What a step takes at the least, about; `euler` does not get far.
const EVALUATIONS_A_STEP: u64 = 4;

/// Errors above this part of a range are no errors any more.
const LOST: f64 = 1.0;

impl Point {
    /// Runs a candidate at a tolerance or step; `None` where it takes many more evaluations than the reference.
    ///
    /// # Errors
    /// The method does not suit the mechanism, or a setting has no meaning.
    pub(super) fn measure(
        system: &mut dyn System,
        candidate: &Candidate,
        control: AccuracyControl,
        reference: &Reference,
        repetitions: usize,
    ) -> Result<Option<Point>, Error> {
        let most = reference.most_evaluations();
        let max_steps = most / EVALUATIONS_A_STEP;
        let settings = Settings { max_steps, ..paced(&candidate.settings, control, reference) };
        let coded = |code| Ok(Some(Point { control, outcome: Err(code) }));
        let run = match simulate(system, &settings) {
            Ok(run) => run,
            Err(Error::Run(failure)) => {
                let long = matches!(failure.cause, Cause::TooManySteps { .. } | Cause::NeedsMoreSteps { .. });
                return if long { Ok(None) } else { coded(failure.cause.code()) };
            }
            Err(error) => return Err(error),
        };
        if run.work.evaluations > most {
            return Ok(None);
        }
        let growth = reference.errors(&run);
        // What is smaller is not known.
        let error = growth.last().map_or(f64::INFINITY, |error| error.max(reference.floor()));
        let unstable = run.warnings.iter().any(|warning| matches!(warning, Warning::StepExceedsStability { .. }));
        if error.is_nan() || error > LOST {
            return coded(if unstable { "unstable" } else { "lost" });
        }
        let (plain, seconds) = match plain(system, &settings, repetitions) {
            Ok(measured) => measured,
            Err(Error::Run(failure)) => return coded(failure.cause.code()),
            Err(error) => return Err(error),
        };
        let residual = run.residuals.map(|rows| rows.position.max(rows.velocity));
        let (cost, work) = (WorkUnits::of_run(system, &plain), plain.work);
        let (method, drift) = (run.method, run.energy_balance);
        let found = Measured { method, error, growth, cost, work, seconds, drift, residual };
        Ok(Some(Point { control, outcome: Ok(found) }))
    }
}

/// The settings of a run that is compared with the reference.
fn paced(settings: &Settings, control: AccuracyControl, reference: &Reference) -> Settings {
    let settings = reference.compared(settings);
    match control {
        AccuracyControl::Tolerance(tolerance) => Settings { tolerance, step: None, ..settings },
        AccuracyControl::Step(step) => Settings { step: Some(step), ..settings },
    }
}

/// What the motion alone costs: nothing is reported but the end, and nothing watched.
fn plain(system: &mut dyn System, settings: &Settings, repetitions: usize) -> Result<(Run, f64), Error> {
    let every = Some((settings.until - settings.from).max(f64::MIN_POSITIVE));
    let plain = Settings { every, instants: Arc::from([]), watch: false, ..settings.clone() };
    let clock = Stopwatch::start();
    let mut run = simulate(system, &plain)?;
    let mut least = run.seconds;
    for _ in 1..repetitions {
        if clock.seconds() > ENOUGH_TIME {
            break;
        }
        run = simulate(system, &plain)?;
        least = least.min(run.seconds);
    }
    Ok((run, least))
}
