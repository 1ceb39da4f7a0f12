//! A run, and the run that judges it.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use dalembert::mechanism::{Interpreted, System};

use dalembert::{Cause, Error, Run, Settings, Stepping, simulate, simulate_with};
use dalembert_symbolic::lower::compile;

use super::file::Drawn;
use super::local::longest_step;

/// What came of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// All values hold what is promised, and all events are there.
    Right {
        /// The warnings that the run gave nevertheless.
        warnings: Vec<String>,
    },
    /// Something is wrong, and the run warns.
    Warned {
        /// What is wrong.
        fault: String,
        /// The warnings.
        warnings: Vec<String>,
    },
    /// Something is wrong, and nothing is said.
    Wrong {
        /// What.
        fault: String,
    },
    /// The run ended with an error, as does the one that judges it.
    Refused {
        /// The error.
        error: String,
    },
    /// The run ended with an error, and the one that judges it does not.
    Stopped {
        /// The error.
        error: String,
    },
    /// Nothing can be said: what judges the run disagrees with itself, or takes too long.
    LeftOut {
        /// Why.
        why: &'static str,
    },
}

/// A promise may be broken by half a digit.
const HALF_A_DIGIT: f64 = 3.2;
/// Tolerances of the two runs that judge.
const TIGHT: f64 = 1e-12;
const LESS_TIGHT: f64 = 1e-11;
/// Steps of the first are no longer than this part of the run.
const SHARE: f64 = 1.0 / 500.0;
/// What takes more is left out.
const MOST_STEPS: u64 = 30_000;
/// So is what takes longer, as do millions of events.
const LONGEST: Duration = Duration::from_secs(20);
/// Errors below this part of the largest value are rounding of the many short steps that judge.
const ROUNDING: f64 = 1e-12;

/// Runs a drawn file, and judges the run.
pub fn judge(drawn: &Drawn) -> Verdict {
    let program = match compile(&drawn.text, &[]) {
        Ok(program) => program,
        // exp(-(x - c)/w) may be too large for any number wherever the gate looks.
        Err(problems) if problems.iter().all(|problem| problem.code == "E504") => {
            return Verdict::Refused { error: problems[0].message.clone() };
        }
        Err(problems) => panic!("{}: {problems:?}", drawn.text),
    };
    let system = Interpreted::new(program, &drawn.text);
    let Ok(plain) = compile(&drawn.plain, &[]) else { return Verdict::LeftOut { why: "the run that judges fails" } };
    let plain = Interpreted::new(plain, &drawn.plain);
    let mut settings = Settings::new(&system.scene(0));
    settings.digits = true;
    settings.max_steps = MOST_STEPS;
    let begun = Instant::now();
    let outcome = simulate_with(&mut system.clone(), &settings, &mut |_| match begun.elapsed() < LONGEST {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    });
    if matches!(&outcome, Err(Error::Run(failure)) if matches!(failure.cause, Cause::Interrupted)) {
        return Verdict::LeftOut { why: "more than 20 s" };
    }
    let tight = bounded(&plain, drawn, TIGHT, SHARE);
    let (run, tight) = match (outcome, tight) {
        (_, Err(Unjudged::TooLong)) => return Verdict::LeftOut { why: "too many short steps" },
        (Err(error), Err(Unjudged::Failed)) => return Verdict::Refused { error: error.to_string() },
        (Err(Error::Run(failure)), Ok(_)) if matches!(failure.cause, Cause::TooManySteps { .. }) => {
            return Verdict::LeftOut { why: "too many steps" };
        }
        (Err(error), Ok(_)) => return Verdict::Stopped { error: error.to_string() },
        (Ok(_), Err(Unjudged::Failed)) => return Verdict::LeftOut { why: "the run that judges fails" },
        (Ok(run), Ok(tight)) => (run, tight),
    };
    let warnings: Vec<String> = run.warnings.iter().map(ToString::to_string).collect();
    if faults(&run, &tight, None).is_none() {
        return match drawn.cut.map_or(Ok(()), |part| cut(&system, &settings, &run, part)) {
            Ok(()) => Verdict::Right { warnings },
            Err(verdict) => verdict,
        };
    }
    let Ok(other) = bounded(&plain, drawn, LESS_TIGHT, 1.7 * SHARE) else {
        return Verdict::LeftOut { why: "too many short steps" };
    };
    let Some(fault) = faults(&run, &tight, Some(&other)) else {
        return Verdict::LeftOut { why: "the runs that judge disagree" };
    };
    if warnings.is_empty() { Verdict::Wrong { fault } } else { Verdict::Warned { fault, warnings } }
}

/// Why there is no run to judge by.
enum Unjudged {
    TooLong,
    Failed,
}

impl From<Error> for Unjudged {
    fn from(_: Error) -> Self {
        Unjudged::Failed
    }
}

/// A run at a tolerance, whose steps stay short against the distances to all that happens.
fn bounded(system: &Interpreted, drawn: &Drawn, tolerance: f64, share: f64) -> Result<Run, Unjudged> {
    let mut settings = Settings::new(&system.scene(0));
    settings.max_steps = MOST_STEPS;
    let span = settings.until;
    (settings.digits, settings.watch, settings.dense) = (false, false, false);
    settings.tolerance = tolerance;
    settings.longest_step = Some(share * span);
    let mut stepping = Stepping::new(system.clone(), settings)?.recorded();
    let begun = Instant::now();
    for _ in 0..MOST_STEPS {
        if begun.elapsed() > LONGEST {
            break;
        }
        let left = span - stepping.time();
        if left <= 1e-15 * span {
            return Ok(stepping.finish());
        }
        let state = stepping.state();
        let h = longest_step(stepping.system(), &drawn.locals, (state.t, &state.q, &state.v));
        let h = h.min(share * span).max(1e-13 * span);
        stepping.advance(if left <= 1.5 * h { left } else { h })?;
    }
    Err(Unjudged::TooLong)
}

/// The verdict on a run that stops at an event of the run, or between its start and its end where there is none, and goes on from
/// there, unless it is right.
fn cut(system: &Interpreted, settings: &Settings, run: &Run, part: f64) -> Result<(), Verdict> {
    let inside = |t: &f64| *t > 0.0 && *t < run.last().t;
    let events: Vec<f64> = run.events.iter().map(|event| event.state.t).filter(inside).collect();
    let t = events.get((part * events.len() as f64) as usize).copied().unwrap_or(part * run.last().t);
    let mut beginning = settings.clone();
    (beginning.until, beginning.digits) = (t, false);
    let both = simulate(&mut system.clone(), &beginning).and_then(|first| {
        let (mut rest, saved) = (settings.clone(), first.last());
        (rest.from, rest.q, rest.v) = (saved.t, saved.q, saved.v);
        rest.phase = first.phases.last().map_or(0, |(_, phase)| *phase);
        Ok((first, simulate(&mut system.clone(), &rest)?))
    });
    let (first, second) = match both {
        Ok(both) => both,
        // A part may be better off by another method than the whole.
        Err(Error::Run(failure)) if matches!(failure.cause, Cause::TooManySteps { .. }) => {
            return Err(Verdict::LeftOut { why: "too many steps in a part" });
        }
        Err(error) => return Err(Verdict::Wrong { fault: format!("cut at t = {t:e}: {error}") }),
    };
    let seen = first.events.len() + second.events.len();
    // The first part counts too, whose digits nobody tells.
    let warnings: Vec<String> =
        [run, &first, &second].iter().flat_map(|run| &run.warnings).map(ToString::to_string).collect();
    let verdict = |fault: String| match warnings.is_empty() {
        true => Verdict::Wrong { fault },
        false => Verdict::Warned { fault, warnings },
    };
    if seen != run.events.len() {
        let fault = format!("cut at t = {t:e}: {seen} events instead of {}", run.events.len());
        return Err(verdict(fault));
    }
    let fault = run.column_names().into_iter().find_map(|name| {
        let last = |run: &Run| run.column(&name).and_then(|column| column.last().copied()).unwrap_or(f64::NAN);
        let bound = |run: &Run| run.errors(&name).and_then(|errors| errors.last().copied()).unwrap_or(f64::INFINITY);
        let (one, two) = (last(run), last(&second));
        let (apart, promised) = ((one - two).abs(), bound(run) + bound(&second));
        let broken = apart > HALF_A_DIGIT * promised;
        broken.then(|| format!("cut at t = {t:e}: {name} = {two:e} instead of {one:e}, {promised:.1e} is promised"))
    });
    fault.map_or(Ok(()), |fault| Err(verdict(fault)))
}

/// From when on two runs have different events.
fn parts(run: &Run, other: &Run) -> f64 {
    let near = 1e-4 * run.last().t;
    let mut pairs = run.events.iter().zip(&other.events).map(|(a, b)| (a.state.t, b.state.t));
    let both = pairs.find(|(a, b)| (a - b).abs() > near).map(|(a, b)| a.min(b));
    let more = if run.events.len() > other.events.len() { run } else { other };
    both.or_else(|| more.events.get(run.events.len().min(other.events.len())).map(|event| event.state.t)).unwrap_or(0.0)
}

/// What is wrong with a run, unless both that judge it disagree about it.
fn faults(run: &Run, tight: &Run, other: Option<&Run>) -> Option<String> {
    let disagree = other.is_some_and(|other| other.events.len() != tight.events.len());
    if run.events.len() != tight.events.len() && !disagree {
        let (here, there) = (run.events.len(), tight.events.len());
        return Some(format!("{here} events instead of {there}, apart from t = {:.6e} s on", parts(run, tight)));
    }
    run.column_names().into_iter().find_map(|name| {
        let last = |run: &Run| run.column(&name).and_then(|column| column.last().copied()).unwrap_or(f64::NAN);
        let largest = run.column(&name)?.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let (value, right) = (last(run), last(tight));
        let bound = run.errors(&name).and_then(|errors| errors.last().copied()).unwrap_or(f64::INFINITY);
        let error = (value - right).abs();
        let doubt = other.map_or(0.0, |other| 2.0 * (last(other) - right).abs());
        let broken = error > HALF_A_DIGIT * bound && error > doubt && error > ROUNDING * largest;
        broken.then(|| format!("{name} = {value:e} instead of {right:e}, of which {bound:.1e} is promised"))
    })
}
