//! Taylor's method, of files that nobody compiled: against closed forms, and against Runge–Kutta's at the tightest tolerance.
#![cfg(feature = "interpret")]

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Error, Method, NoSeries, Run, Settings, simulate};
use dalembert_symbolic::lower::compile;

fn mechanism(text: &str) -> Interpreted {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    Interpreted::new(program, text)
}

fn tried(text: &str, method: Method, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut system = mechanism(text);
    let mut settings = Settings::new(&system.scene(0));
    settings.method = method;
    change(&mut settings);
    simulate(&mut system, &settings)
}

fn run(text: &str, method: Method, change: impl FnOnce(&mut Settings)) -> Run {
    tried(text, method, change).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The largest difference between the columns of two runs, in parts of how far each goes.
fn apart(a: &Run, b: &Run) -> f64 {
    assert_eq!(a.len(), b.len());
    let column = |run: &Run, i: usize| -> Vec<f64> {
        run.states().map(|state| [state.q.as_slice(), &state.v].concat()[i]).collect()
    };
    let differs = |i: usize| {
        let (a, b) = (column(a, i), column(b, i));
        let range = b.iter().fold(0.0_f64, |most, x| most.max((x - b[0]).abs())).max(b[0].abs());
        a.iter().zip(&b).map(|(a, b)| (a - b).abs() / range.max(f64::MIN_POSITIVE)).fold(0.0, f64::max)
    };
    (0..2 * a.first().q.len()).map(differs).fold(0.0, f64::max)
}

/// Both methods, at so many times between the ends.
fn agree(text: &str, within: f64) {
    let change = |settings: &mut Settings| {
        settings.tolerance = 1e-13;
        settings.every = Some(settings.until / 40.0);
    };
    let (taylor, other) = (run(text, Method::Taylor, change), run(text, Method::Dop853, change));
    let difference = apart(&taylor, &other);
    assert!(difference <= within, "{text}\ndiffers by {difference:e}");
    assert!(taylor.work.steps < other.work.steps, "{text}: {} and {}", taylor.work.steps, other.work.steps);
}

/// Every function of the language that has a series.
#[test]
fn every_function_is_expanded() {
    for force in [
        "-sin(x) - cos(x)*v",
        "-tan(x/2)",
        "-asin(x/2) + acos(x/3)*v/5",
        "-atan(2*x) - v^3",
        "-sinh(x) + 0.1*cosh(v)",
        "-tanh(3*x) - 0.1*tanh(v)",
        "-exp(x) + 1",
        "-ln(2 + x)",
        "-x/sqrt(1 + x^2)",
        "-x*(1 + x^2)^(-0.3)",
        "-x*(2 + x)^(x + v)",
        "-x*2^x",
        "-atan2(x, 1 + v^2)",
        "-x/(1 + x^4) + 1/(2 + v)",
        "-x + 0.3*sin(t)*x - 0.1*exp(-t)*v",
        "-x^3 + 0.2*shake",
        "-3*x + x^2 - 4*v^5/7",
    ] {
        let force = force.replace('v', "x'");
        agree(
            &format!(
                "name: F\ncoordinates: {{x: 1}}\ninputs: {{shake: cos(2*t) + t/9}}\nkinetic_energy: x'^2/2\n\
                 generalized_forces: {{x: \"{force}\"}}\nscene: {{start: {{x: 0.4, x': 0.3}}, until: 5}}"
            ),
            1e-11,
        );
    }
}

const POINTS: &str = "name: P\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {x: m, y: m}\n\
    bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {rod: x^2 + y^2 - l^2}\n\
    scene: {start: {x: 1, y: 0}, until: 3}";

/// A body on a circle, by constraint and by angle: places, speeds and what holds it.
#[test]
fn constraints_are_expanded_with_their_multipliers() {
    agree(POINTS, 1e-11);
    let angle = "name: A\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {theta: rad}\n\
        bodies: {b: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}\ngravity: [0, -g]\n\
        scene: {start: {theta: pi/2}, until: 3, tolerance: 1e-13}";
    let change = |settings: &mut Settings| settings.tolerance = 1e-13;
    let (points, angle) = (run(POINTS, Method::Taylor, change), run(angle, Method::Taylor, change));
    let theta = angle.last()["theta"];
    assert!((points.last()["x"] - theta.sin()).abs() + (points.last()["y"] + theta.cos()).abs() < 2e-12);
    assert!(points.work.steps < 60, "{:?}", points.work);
}

/// Coefficients that vanish in a pattern do not make steps endless: a chain let go from the horizontal has speeds of odd orders only.
#[test]
fn coefficients_that_vanish_do_not_lengthen_steps() {
    let chain = "name: C\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {a: rad, b: rad, c: rad}\n\
        points: {p: \"l*[cos(a), sin(a)]\", q: \"p + l*[cos(b), sin(b)]\", r: \"q + l*[cos(c), sin(c)]\"}\n\
        bodies: {one: {mass: m, position: p}, two: {mass: m, position: q}, three: {mass: m, position: r}}\n\
        gravity: [0, -g]\nscene: {start: {a: 0, b: 0, c: 0}, until: 1}";
    agree(chain, 1e-11);
}

/// A vibration is known: at every scale of time, at one long step, and in its energy over many periods.
#[test]
fn vibrations_are_those_of_closed_forms() {
    for (frequency, size) in [(1.0, 1.0), (1e12, 1e-9), (1e-12, 1e9)] {
        let text = format!(
            "name: V\nparameters: {{w: {frequency:e}}}\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\npotential_energy: w^2*x^2/2\n\
             scene: {{start: {{x: {size:e}}}, until: {:e}}}",
            100.0 / frequency
        );
        let found = run(&text, Method::Taylor, |settings| settings.tolerance = 1e-13);
        let error = (found.last()["x"] / size - 100.0_f64.cos()).abs();
        assert!(error < 1e-11, "{frequency}: {error:e}");
        assert!(found.work.steps < 80, "{frequency}: {:?}", found.work);
        let one = run(&text, Method::Taylor, |settings| {
            (settings.step, settings.until) = (Some(0.5 / frequency), 0.5 / frequency);
        });
        assert_eq!(one.work.steps, 1);
        assert!((one.last()["x"] / size - 0.5_f64.cos()).abs() < 1e-15);
    }
}

/// Work of what has no potential, and events between the ends of long steps.
#[test]
fn work_and_events_are_those_of_the_polynomial() {
    let damped = "name: D\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2\ndissipation: 0.1*x'^2\n\
        events: {pass: {when: x, then: record}}\nscene: {start: {x: 1}, until: 20}";
    let found = run(damped, Method::Taylor, |settings| settings.tolerance = 1e-12);
    assert!(found.energy_balance.is_some_and(|drift| drift < 1e-11), "{:?}", found.energy_balance);
    // x = e^(−δt) (cos ωt + δ/ω sin ωt), zero where tan ωt = −ω/δ.
    let (delta, omega) = (0.1, (1.0_f64 - 0.01).sqrt());
    for (k, event) in found.events.iter().enumerate() {
        let expected = ((k as f64 + 1.0) * std::f64::consts::PI - (omega / delta).atan()) / omega;
        assert!((event.state.t - expected).abs() < 1e-11, "{k}: {} and {expected}", event.state.t);
    }
    assert_eq!(found.events.len(), 6);
}

#[test]
fn what_has_no_series_is_refused_with_the_reason() {
    let reason = |text: &str, change: &dyn Fn(&mut Interpreted)| {
        let mut system = mechanism(text);
        change(&mut system);
        let mut settings = Settings::new(&system.scene(0));
        settings.method = Method::Taylor;
        match simulate(&mut system, &settings) {
            Err(Error::NoSeries { reason }) => Some(reason),
            other => other.map(|_| None).unwrap_or_else(|error| panic!("{error}")),
        }
    };
    let table = "name: T\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\ntables: {f: {points: [[-9, 0], [0, 1], [9, 0]]}}\n\
        generalized_forces: {x: f(x)}\nscene: {until: 1}";
    assert_eq!(reason(table, &|_| ()), Some(NoSeries::Functions));
    let driven = "name: U\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\ninputs: {u: 1}\ngeneralized_forces: {x: u}\nscene: {until: 1}";
    assert_eq!(reason(driven, &|_| ()), None);
    for given in [true, false] {
        let by_program = |system: &mut Interpreted| match given {
            true => system.set_input(0, std::sync::Arc::new(|t| [t, 1.0, 0.0])),
            false => system.hold_input(0, 2.0),
        };
        assert_eq!(reason(driven, &by_program), Some(NoSeries::Inputs));
    }
    // An input that is held later ends the motion there, and is no step that is too long.
    let mut hand = dalembert::Simulation::new(mechanism(driven)).method(Method::Taylor).by_hand().unwrap();
    hand.advance(0.1).unwrap();
    hand.set_input("u", 2.0).unwrap();
    let error = hand.advance(0.1).unwrap_err();
    assert_eq!(error.cause(), Some(&dalembert::Cause::NoSeries { reason: NoSeries::Inputs }), "{error}");
}

/// What is left out of steps at a tolerance of rounding goes with the time; roundings go with its root.
#[test]
fn the_energy_of_keplers_problem_wanders_as_rounding_does() {
    let text = "name: Kepler\ncoordinates: {x: 1, y: 1}\nkinetic_energy: (x'^2+y'^2)/2\npotential_energy: -1/sqrt(x^2+y^2)\n\
                scene: {start: {x: 0.4, y': 2}, until: 2*pi*300, tolerance: 1e-14}\n";
    let drift = run(text, Method::Taylor, |_| ()).energy_balance.expect("a drift");
    assert!(drift < 3e-15, "{drift:e}");
}
