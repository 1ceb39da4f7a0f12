//! Running a mechanism.
//!
//! 1. [`Settings`] say where to start, how far to go and how: look in `settings.rs`.
//! 2. [`simulate`] runs any [`System`], in one call; [`simulate_with`] says how far it is.
//! 3. [`Simulation`] is the same, word by word: look in `builder.rs`; [`Simulate`] gives it to every mechanism
//!    that `model!` makes: look in `typed.rs`.
//! 4. Decoupled subsystems are run each by itself: look in `decoupled.rs`.
//! 5. [`Stepping`] goes step by step, for control loops: look in `by_hand.rs`.

mod auto;
mod builder;
mod by_hand;
mod cancelling_forces;
mod close_calls;
mod comparison;
mod decoupled;
mod flat;
mod interruption;
mod rounded_parameters;
mod settings;
mod steps_over;
#[cfg(test)]
mod tests;
mod typed;

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::Arc;

pub use builder::Simulation;
pub(crate) use builder::{Described, Origin};
#[cfg(feature = "cli")]
pub(crate) use builder::{LAGRANGE, derivation};
pub use by_hand::{StateMut, Stepping};
pub(crate) use comparison::estimate_global_error;
pub(crate) use interruption::Interruption;
#[cfg(feature = "cli")]
pub(crate) use settings::Resumed;
pub use settings::Settings;
use settings::{MOST_STEPS, WhereStiff};
use steps_over::{apart, over_contacts};
pub use typed::Simulate;

use crate::cause::{Cause, NoSeries};
use crate::constrain::{self, Change, Elsewhere, Moment, consistent, other_branch, settle};
use crate::driver::{Integration, StepPolicy, StopReason};
use crate::error::Error;
use crate::events::{Ticks, begin_at, begin_at_state};
use crate::integrate::Tolerance;
use crate::mechanism::{Action, Enforcement, Method, RowHistory, Stabilisation, System};
use crate::run::{Failure, Names, Plan, Recorder, Run, State};
use crate::stopwatch::Stopwatch;
use crate::trust::{Warning, check_step, explain_lock, not_unique, positive_inertia};

/// Runs a mechanism.
///
/// # Errors
/// A setting without meaning, or [`Error::Run`] with the time, the state and what was computed until then.
pub fn simulate(system: &mut dyn System, settings: &Settings) -> Result<Run, Error> {
    simulate_with(system, settings, &mut |_| ControlFlow::Continue(()))
}

/// The part of a run that is done to know its start.
const BEGINNING: f64 = 1e-6;

/// The state in which a run begins: on the constraints in force, before any event.
///
/// # Errors
/// As [`simulate`].
///
/// # Example
/// A bob on a rod of 5 m that is held 3 m to the side is 4 m deep:
/// ```
/// use dalembert::mechanism::Dynamic;
/// use dalembert::{Settings, initial_state};
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Hung
/// parameters: {m: 1 kg, l: 5 m, g: 10 m/s^2}
/// coordinates: {x: m, y: m}
/// bodies: {bob: {mass: m, position: "[x, y]"}}
/// gravity: [0, -g]
/// constraints: {rod: x^2 + y^2 - l^2}
/// scene: {start: {x: 3}, guess: {y: -1}, until: 1}
/// "#);
/// # }
/// # use example::Hung;
/// let mut system = Dynamic::new(Hung::default());
/// let settings = Settings::of_scene(&system, 0);
/// let start = initial_state(&mut system, &settings)?;
/// assert!((start["y"] + 4.0).abs() < 1e-12);
/// # Ok::<(), dalembert::Error>(())
/// ```
pub fn initial_state(system: &mut dyn System, settings: &Settings) -> Result<State, Error> {
    let beginning = Settings {
        until: settings.from + BEGINNING * (settings.until - settings.from),
        ignored_events: (0..system.description().events.len()).collect(),
        ..settings.clone()
    };
    Ok(simulate(system, &beginning)?.first())
}

/// Puts a mechanism in the phase in which a run begins, with what is held there: contacts and friction decide it by the start, before any event.
/// Returns the place of the phase.
///
/// # Errors
/// As [`simulate`], where the start decides none.
///
/// # Example
/// A block that slides backwards is rubbed forwards:
/// ```
/// use dalembert::mechanism::{Dynamic, System};
/// use dalembert::{Settings, enter_initial_phase};
/// # mod example {
/// dalembert::model!(yaml = r#"
/// name: Slide
/// parameters: {m: 1 kg, F: 3 N}
/// coordinates: {x: m}
/// bodies: {b: {mass: m, position: "[x, 0]"}}
/// friction: {rub: {rate: x', on: b, along: ground.x, limit: F}}
/// scene: {start: {x': -2}, until: 1}
/// "#);
/// # }
/// # use example::Slide;
/// let mut system = Dynamic::new(Slide::default());
/// let settings = Settings::of_scene(&system, 0);
/// let phase = enter_initial_phase(&mut system, &settings)?;
/// assert_eq!(&*system.description().phases[phase].name, "rub slips backwards");
/// # Ok::<(), dalembert::Error>(())
/// ```
pub fn enter_initial_phase(system: &mut dyn System, settings: &Settings) -> Result<usize, Error> {
    check(system, settings)?;
    set_up(system, settings);
    // Why there is none is told by the run.
    first_phase(system, settings).or_else(|_| initial_state(system, settings).map(|_| system.phase()))
}

/// Runs a mechanism, and tells `progress` the time that was reached after every step, until it breaks off.
///
/// # Errors
/// As [`simulate`]; [`Cause::Interrupted`], with what was computed, where `progress` broke off.
pub fn simulate_with(
    system: &mut dyn System,
    settings: &Settings,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, Error> {
    let settings = &*settled(system, settings);
    let progress = &mut |t| if settings.interruption.is_asked() { ControlFlow::Break(()) } else { progress(t) };
    let parts = decoupled::parts(system, settings)?;
    let outcome = if parts.is_empty() {
        together(system, settings, progress)
    } else {
        decoupled::simulate(system, parts, settings, progress)
    };
    // Where nobody said which states to report, those of a run that ended early lie within it.
    let fill = |run: &mut Run| {
        if settings.every.is_none() {
            run.fill(settings.spacing())
        }
    };
    let mut run = match outcome {
        Ok(run) => run,
        Err(Error::Run(mut failure)) => {
            fill(&mut failure.run);
            return Err(Error::Run(failure));
        }
        Err(error) => return Err(error),
    };
    fill(&mut run);
    run.warn_of_integrals(system);
    run.warn_of_tables(system);
    if settings.digits {
        estimate_global_error(system, settings, &mut run, progress);
    }
    Ok(run)
}

/// Runs all coordinates with the same steps.
fn together(
    system: &mut dyn System,
    settings: &Settings,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Run, Error> {
    let clock = Stopwatch::start();
    let Start { mut integration, mut recorder, outcome } = start(system, settings, settings.spacing())?;
    integration.leave_where_stiff(auto::steps_where_stiff(system, settings));
    let mut outcome = outcome.and_then(|()| integration.advance(system, settings.until, &mut recorder, progress));
    while matches!(outcome, Ok(StopReason::Stiff)) {
        if auto::turns(system, integration.time(), integration.state().y) {
            let begun_again = |where_stiff| Settings { where_stiff, ..settings.clone() };
            return match together(system, &begun_again(WhereStiff::Turned), progress) {
                Err(error @ Error::Run(_)) if !error.is_interruption() => {
                    together(system, &begun_again(WhereStiff::Stays), progress)
                }
                outcome => outcome,
            };
        }
        // What vibrates now may decay later.
        integration.stay_where_stiff();
        outcome = integration.advance(system, settings.until, &mut recorder, progress);
    }
    match outcome {
        Ok(_) => Ok(finish(system, &integration, recorder, clock)),
        Err(cause) => Err(fail(*cause, system, &integration, recorder, clock)),
    }
}

/// Ticks that are nearer to each other than this part of their time are not told apart (`events/sides.rs`: what is one instant), and would never end.
const CLOSEST_TICKS: f64 = 1e-14;

/// What keeps a motion from having a power series.
fn no_series(system: &dyn System, settings: &Settings) -> Option<NoSeries> {
    let description = system.description();
    let multipliers = settings.enforcement == Enforcement::Multipliers && settings.alpha() == 0.0;
    if system.derivation().is_some() || !multipliers {
        Some(NoSeries::Accelerations)
    } else if !description.friction_pattern.is_empty() {
        Some(NoSeries::Friction)
    } else {
        system.series().err()
    }
}

/// Settings with the phase in which contacts begin; as they are where that is not to be decided, or cannot be: why will be told when the run
/// begins.
pub(crate) fn settled<'a>(system: &mut dyn System, settings: &'a Settings) -> Cow<'a, Settings> {
    if system.contacts().all.is_empty() || check(system, settings).is_err() {
        return Cow::Borrowed(settings);
    }
    if settings.method == Method::Moreau {
        return over_contacts(system, settings);
    }
    let first = first_phase(system, settings);
    in_phase(system, settings, first.as_ref().ok())
}

/// Settings with another phase at the start, if any is given, and with the directions in which contacts slide there.
fn in_phase<'a>(system: &dyn System, settings: &'a Settings, phase: Option<&usize>) -> Cow<'a, Settings> {
    match phase {
        Some(phase) if system.contacts().all.iter().any(|contact| contact.direction.is_some()) => {
            Cow::Owned(Settings { phase: *phase, memory: Some(system.memory().to_vec()), ..settings.clone() })
        }
        Some(phase) if *phase != settings.phase => Cow::Owned(Settings { phase: *phase, ..settings.clone() }),
        _ => Cow::Borrowed(settings),
    }
}

/// The phase in which a motion begins: the one that its settings say, unless contacts decide it.
fn first_phase(system: &mut dyn System, settings: &Settings) -> Result<usize, Box<Cause>> {
    if system.contacts().all.is_empty() || settings.method == Method::Moreau {
        return Ok(settings.phase);
    }
    let guess = set_up(system, settings);
    let held = settings.held();
    let y = consistent(system, &start_of(settings, &guess, &held))?;
    let moment = Moment { t: settings.from, y: &y, scales: &[], fastest: &[], step: 0.0 };
    settle(system, &moment, Change::Start(begin_at_state))
}

/// The places [q] of a start that meets the constraints in force, held values kept; `None` where they cannot be met.
#[cfg(feature = "cli")]
pub(crate) fn closed(system: &dyn System, settings: &Settings) -> Option<Vec<f64>> {
    let (guess, held) = ([settings.q.as_slice(), settings.v.as_slice()].concat(), settings.held());
    let mut y = consistent(system, &start_of(settings, &guess, &held)).ok()?;
    y.truncate(settings.q.len());
    Some(y)
}

/// Makes a mechanism what it is where a run begins, in the state of the settings, which is returned: [q; q'].
fn set_up(system: &mut dyn System, settings: &Settings) -> Vec<f64> {
    system.set_phase(settings.phase);
    let memory = settings.memory.clone().unwrap_or_else(|| system.scene_memory(0));
    system.set_memory(&memory);
    if let Some(history) = system.row_history_mut() {
        *history = RowHistory::default();
    }
    system.enforce(settings.enforcement, settings.alpha());
    let guess = [settings.q.as_slice(), settings.v.as_slice()].concat();
    begin_at(system, settings.from, &guess);
    guess
}

/// What is known of a start at this guess, of which these values are held.
fn start_of<'a>(settings: &'a Settings, guess: &'a [f64], held: &'a [bool]) -> constrain::Start<'a> {
    let start_conditions = settings.start_conditions.clone();
    constrain::Start {
        t: settings.from,
        reached: settings.reached.max(settings.from.abs()),
        y: guess,
        held,
        spins: &settings.spins,
        start_conditions,
    }
}

/// Refuses settings that the mechanism itself refutes.
fn check(system: &dyn System, settings: &Settings) -> Result<(), Error> {
    settings.check(system.description())?;
    check_clocks(system, settings.from.abs().max(settings.until.abs()))?;
    let (given, expected) = (settings.memory.as_ref().map(Vec::len), system.memory().len());
    match given {
        Some(given) if given != expected => Err(Error::WrongLength { setting: "memory", given, expected }),
        _ => steps_over::check(system, settings),
    }
}

/// Refuses clocks whose ticks are not told apart until a time.
fn check_clocks(system: &dyn System, until: f64) -> Result<(), Error> {
    let wrong = |[from, every]: &[f64; 2]| {
        let latest = from.abs().max(until);
        !(from.is_finite() && *every > CLOSEST_TICKS * latest && every.is_finite())
    };
    match system.clocks().into_iter().find(wrong) {
        Some([_, every]) => {
            let expected = "a positive period of an event, long enough for its ticks to be told apart";
            Err(Error::BadSetting { setting: "every", value: every, expected })
        }
        None => Ok(()),
    }
}

/// A run that has begun, or could not.
struct Start {
    integration: Integration,
    recorder: Recorder,
    outcome: Result<(), Box<Cause>>,
}

/// Begins a run whose states are reported at this spacing.
fn start(system: &mut dyn System, settings: &Settings, every: f64) -> Result<Start, Error> {
    check(system, settings)?;
    let steps_over = settings.method == Method::Moreau;
    let settings = &*over_contacts(system, settings);
    let first = first_phase(system, settings);
    let settings = &*in_phase(system, settings, first.as_ref().ok());
    if settings.method == Method::Taylor
        && let Some(reason) = no_series(system, settings)
    {
        return Err(Error::NoSeries { reason });
    }
    let dampers = matches!(settings.enforcement, Enforcement::Springs { damping, .. } if damping > 0.0);
    let work = settings.watch && (dampers || steps_over || !system.description().structure.conservative);
    let guess = set_up(system, settings);
    let held = settings.held();
    let start = start_of(settings, &guess, &held);
    let met = first.and_then(|_| consistent(system, &start));
    let alone = settings.guessed || !settings.watch;
    let elsewhere = met.as_ref().ok().filter(|_| !alone).and_then(|y| other_branch(system, &start, y));
    let (y, met) = met.map_or_else(|cause| (guess, Err(cause)), |y| (y, Ok(())));
    let auto::Choice { method, why } = auto::choose(settings, system, &y);
    let tolerance = settings.tolerance.max(Settings::TIGHTEST);
    let units = Box::new(Tolerance::new(tolerance, system.description(), &y));
    let longest = settings.longest_step.unwrap_or(f64::INFINITY);
    let adapts = method.adapts_to(&system.description().structure);
    let finds_step = settings.step.is_none() && method.finds_step() && !adapts;
    let policy = match settings.step {
        Some(step) => StepPolicy::Fixed(step),
        // Until it is found.
        None if finds_step => StepPolicy::Fixed(1e-3 * (settings.until - settings.from)),
        None => StepPolicy::Adaptive { tolerance: units.clone(), longest },
    };
    let integration = Integration::new(method, policy, settings.from, &y, work).limit(settings.max_steps);
    let mut integration = integration
        .compensate(settings.compensated)
        .decorrelate_steps(settings.decorrelate_steps)
        .following(settings.followed.clone())
        .beginning_beside(settings.beside.clone())
        .having_seen(settings.resumed.as_ref().map(|resumed| resumed.seen.clone()))
        .ending_after(settings.ends_after)
        .ticking(Ticks::new(system, settings.from, settings.ticks.as_deref()))
        .ignoring(settings.ignored_events.clone())
        .projecting(settings.projects());
    if settings.stabilisation == (Stabilisation::Baumgarte { alpha: None }) && settings.step.is_none() {
        integration = integration.finding_gain();
    }
    // The modes of discontinuities come first: energies and outputs at the start depend on them.
    let outcome = met
        .and_then(|()| integration.begin(system, settings.until))
        .and(settings.attainable())
        .and_then(|()| if steps_over { apart(system, settings, &y) } else { Ok(()) })
        .and_then(|()| positive_inertia(system, settings.from, &y))
        .and_then(|()| constrain::possible_restitutions(system, &settings.ignored_events))
        .and_then(|()| constrain::possible_limits(system, settings.from, &y));
    if let (Some(resumed), Ok(())) = (&settings.resumed, &outcome) {
        integration.resume(resumed.step, &resumed.seen);
    }
    let step = match &outcome {
        Ok(()) if finds_step && settings.until > settings.from => {
            Some(integration.find_step(system, method, &units, longest))
        }
        _ => settings.step,
    };
    let outcome = outcome.and_then(|()| match step.filter(|_| finds_step) {
        Some(step) => enough_steps(system, settings, step),
        None => Ok(()),
    });
    let plan = Plan {
        until: settings.until,
        every,
        instants: Arc::clone(&settings.instants),
        dense: settings.dense,
        keeps_ends: settings.dense || settings.digits,
        watch: settings.watch,
        dense_is_free: integration.dense_is_free(),
        method,
        why,
        tolerance: settings.step.is_none().then_some(tolerance),
        step,
        projects: settings.projects(),
        junctions: settings.junctions,
        means: steps_over,
    };
    let mut recorder = Recorder::new(&plan, system, settings.from, integration.state());
    if let Some(Elsewhere { coordinate, here, there }) = elsewhere {
        let coordinate = system.description().coordinate_name(coordinate);
        recorder.warn(Warning::OtherBranch { coordinate, here, there });
    }
    // One step for all of the way is found where the motion tells nothing yet.
    let judged = step.filter(|step| settings.step.is_some() || *step < settings.until - settings.from);
    if let Some(step) = judged {
        let at = (settings.from, settings.q.as_slice(), settings.v.as_slice());
        let warning = check_step(system, at, method, step, settings.until - settings.from);
        warning.into_iter().for_each(|warning| recorder.warn(warning));
    } else if step.is_none() && tolerance > settings.tolerance && settings.attainable().is_ok() {
        recorder.warn(Warning::ToleranceTooTight { asked: settings.tolerance, used: tolerance });
    }
    Ok(Start { integration, recorder, outcome })
}

/// Refuses a step that was found and will not come to the end within the usual limit, if no event can end the run before.  What is computed
/// within a limit that was asked for is returned.
fn enough_steps(system: &dyn System, settings: &Settings, step: f64) -> Result<(), Box<Cause>> {
    let needed = (settings.until - settings.from) / step;
    let events = &system.description().events;
    let stops = events.iter().any(|event| event.actions.contains(&Action::Stop)) || settings.ends_after.is_some();
    match needed > settings.max_steps as f64 && settings.max_steps == MOST_STEPS && !stops {
        true => Err(Cause::NeedsMoreSteps { step, needed: needed.ceil(), limit: settings.max_steps }.into()),
        false => Ok(()),
    }
}

fn finish(system: &dyn System, integration: &Integration, mut recorder: Recorder, clock: Stopwatch) -> Run {
    integration.warnings(system).into_iter().for_each(|warning| recorder.warn(warning));
    let outputs = not_unique(system, integration.time(), integration.state().y);
    if !outputs.is_empty() {
        let names = Names::of(system.description()).outputs;
        let outputs = outputs.into_iter().map(|place| names[place].clone()).collect();
        recorder.warn(Warning::ReactionsNotUnique { outputs });
    }
    recorder.stepped_over(integration.tally());
    recorder.constrained(integration.residuals());
    recorder.swept(integration.swept());
    recorder.took(integration.found_step());
    recorder.ticked(integration.next_ticks(), integration.resumed());
    recorder.finish(system, integration.time(), integration.state(), integration.work(), clock.seconds())
}

fn fail(cause: Cause, system: &dyn System, integration: &Integration, recorder: Recorder, clock: Stopwatch) -> Error {
    let cause = recorder.explain(system, cause);
    let cause = explain_lock(system, integration.time(), integration.state().y, cause);
    let state = recorder.state(integration.time(), integration.state().y, Vec::new());
    Error::Run(Box::new(Failure { cause, state, run: finish(system, integration, recorder, clock) }))
}
