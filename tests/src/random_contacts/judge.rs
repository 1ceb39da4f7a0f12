//! A run, and what is wrong with it.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Cause, Error, Run, Settings, Warning, simulate_with};
use dalembert_symbolic::lower::compile;

use super::moreau;
use super::scene::{Law, Scene, Touch};

/// What came of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It moves as time stepping does, and contacts do nothing that they must not.
    Right,
    /// The same without time stepping, which does not settle (chaos) or has another law of impacts.
    Lawful,
    /// It is not.
    Wrong(String),
    /// It ended with an error.
    Refused(String),
    /// It took too long.
    TooLong,
}

/// A run takes no longer.
const LONGEST: Duration = Duration::from_secs(30);
/// Places that are compared, and steps of time stepping between them: coarse, twice and four times as many.
const PLACES: usize = 10;
const STEPS: usize = 2000;
/// Time stepping has settled where half a step changes a state by no more than this part of its size, and by less than before.
const SETTLED: f64 = 3e-3;
/// A motion differs from one that has settled by no more than so many of its last changes.
const CHANGES: f64 = 6.0;
/// Time stepping sees a change up to a step late, whatever its steps: of a state's size, a step of 5e-5 s at 20 m/s² for a second.
const LATE: f64 = 1e-3;
/// What is zero of gaps (m), forces (N) and energies (of the largest), beside a tolerance of 1e-9.
const ZERO: f64 = 1e-6;

/// Runs a drawn mechanism, and judges the run.
pub fn judge(scene: &Scene) -> Verdict {
    let text = scene.text();
    let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let mut system = Interpreted::new(program, &text);
    let mut settings = Settings::new(&system.scene(0));
    settings.digits = false;
    settings.every = Some(scene.until / (50 * PLACES) as f64);
    let begun = Instant::now();
    let outcome = simulate_with(&mut system, &settings, &mut |_| match begun.elapsed() < LONGEST {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    });
    let run = match outcome {
        Ok(run) => run,
        Err(Error::Run(failure)) if matches!(failure.cause, Cause::Interrupted) => return Verdict::TooLong,
        Err(error) => return Verdict::Refused(error.to_string()),
    };
    if let Some(fault) = unlawful(scene, &run) {
        return Verdict::Wrong(fault);
    }
    if scene.law != Law::Together && scene.contacts.len() > 1 && !is_pressed(scene) {
        return Verdict::Lawful;
    }
    let [coarse, middle, fine] = [1, 2, 4].map(|times| moreau::run(scene, PLACES, times * STEPS));
    let mut settled = 0;
    for place in 0..PLACES {
        let (a, b, c) = (&coarse[place].q, &middle[place].q, &fine[place].q);
        let size = c.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        let (first, last) = (apart(a, b), apart(b, c));
        if last > SETTLED * size || last > first && last > ZERO {
            break;
        }
        settled += 1;
        let ours = state(scene, &run, scene.until * (place + 1) as f64 / PLACES as f64);
        if apart(&ours, c) > CHANGES * (first + last) + LATE * size {
            let t = scene.until * (place + 1) as f64 / PLACES as f64;
            return Verdict::Wrong(format!("t = {t}: {ours:?} instead of {c:?} ± {:e}", first + last));
        }
    }
    if settled == PLACES { Verdict::Right } else { Verdict::Lawful }
}

fn is_pressed(scene: &Scene) -> bool {
    scene.contacts.iter().all(|contact| matches!(contact.touch, Touch::Pressed { .. }))
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The places of all bodies in the row that is nearest to a time.
fn state(scene: &Scene, run: &Run, t: f64) -> Vec<f64> {
    let times = run.column("t").expect("times");
    let near = |k: &usize| (times[*k] - t).abs();
    let row = (0..times.len()).min_by(|a, b| near(a).total_cmp(&near(b))).expect("a row");
    let names = (0..scene.bodies.len()).flat_map(|i| [format!("x{i}"), format!("y{i}"), format!("th{i}")]);
    names.map(|name| run.column(&name).expect("a coordinate")[row]).collect()
}

/// What contacts must never do: to penetrate, to pull, to hold more than friction can, to give energy.
fn unlawful(scene: &Scene, run: &Run) -> Option<String> {
    let column = |name: String| run.column(&name).expect("an output").to_vec();
    let least = |list: &[f64]| list.iter().fold(f64::INFINITY, |least, x| least.min(*x));
    // Where only sums of forces are determined, each by itself says nothing.
    let unique = !run.warnings.iter().any(|warning| matches!(warning, Warning::ReactionsNotUnique { .. }));
    for (k, contact) in scene.contacts.iter().enumerate() {
        let limits = match contact.touch {
            Touch::Pressed { limit, .. } => vec![limit; column("E".to_owned()).len()],
            _ => {
                let (gap, force) = (column(format!("g{k}")), column(format!("N{k}")));
                if least(&gap) < -ZERO || unique && least(&force) < -ZERO {
                    return Some(format!("contact {k}: gap {:e}, force {:e}", least(&gap), least(&force)));
                }
                force.iter().map(|force| contact.friction * force).collect()
            }
        };
        if unique && (contact.friction > 0.0 || matches!(contact.touch, Touch::Pressed { .. })) {
            let held = column(format!("T{k}"));
            let beyond = held.iter().zip(&limits).map(|(held, limit)| held.abs() - limit).fold(0.0, f64::max);
            if beyond > ZERO {
                return Some(format!("contact {k}: {beyond:e} N more than friction can hold"));
            }
        }
    }
    let energy = column("E".to_owned());
    let size = energy.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    let gained = energy.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    (scene.drive[0] == 0.0 && gained > ZERO * size).then(|| format!("energy grows by {gained:e} J"))
}
