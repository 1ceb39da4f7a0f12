//! Closed forms of driven linear motions.

use std::sync::Arc;

use crate::integrate::test_problems::fixed;
use crate::mechanism::{Action, Direction, Event, Method, Rated, Switch, SwitchKind};
use crate::run::Work;
use crate::simulate::simulate;
use crate::testing::Toy;
use crate::{Run, Settings};

/// x'' + d x' + ω² x = f(t) from x₀, v₀.
fn driven(
    (omega, d): (f64, f64),
    (x, v): (f64, f64),
    until: f64,
    f: impl Fn(f64) -> f64 + Send + Sync + 'static,
) -> Toy {
    let mut toy = Toy::new(&["x"], (&[x], &[v]), until, move |t, q, v, _, a| {
        a[0] = f(t) - d * v[0] - omega * omega * q[0];
    });
    toy.jacobian = Arc::new(move |_, _, _, dq, dv| (dq[0], dv[0]) = (omega * omega, d));
    (toy.description.structure.linear, toy.description.structure.time_dependent) = (true, true);
    toy
}

fn exact(toy: &Toy, change: impl Fn(&mut Settings)) -> Run {
    let mut settings = Settings::new(&toy.scene);
    settings.method = Method::Exact;
    change(&mut settings);
    simulate(&mut toy.clone(), &settings).unwrap_or_else(|error| panic!("{error}"))
}

/// The largest error of the reported places, in parts of the largest of these.
fn error(run: &Run, x: impl Fn(f64) -> f64) -> f64 {
    let largest = run.states().map(|state| x(state.t).abs()).fold(0.0, f64::max);
    run.states().map(|state| (state.q[0] - x(state.t)).abs()).fold(0.0, f64::max) / largest
}

/// The error at a tolerance, and the work.
fn at(toy: &Toy, method: Method, tolerance: f64, x: impl Fn(f64) -> f64) -> (f64, Work) {
    let run = exact(toy, |settings| (settings.method, settings.tolerance) = (method, tolerance));
    (error(&run, x), run.work)
}

/// x'' + d x' + ω² x for x = sin t².
fn chirp((omega, d): (f64, f64), t: f64) -> f64 {
    let (s, c) = (t * t).sin_cos();
    2.0 * c - 4.0 * t * t * s + 2.0 * d * t * c + omega * omega * s
}

#[test]
fn motions_are_those_of_closed_forms_to_the_tolerance() {
    type Motion = fn(f64) -> f64;
    let cases: [(&str, Toy, Motion); 5] = [
        ("resonance", driven((2.0, 0.0), (0.0, 0.0), 60.0, |t| (2.0 * t).sin()), |t| {
            ((2.0 * t).sin() - 2.0 * t * (2.0 * t).cos()) / 8.0
        }),
        ("beating", driven((2.0, 0.0), (0.0, 0.0), 100.0, |t| (1.9 * t).sin()), |t| {
            ((1.9 * t).sin() - 0.95 * (2.0 * t).sin()) / 0.39
        }),
        ("ramp", driven((2.0, 0.0), (0.0, 0.0), 40.0, |t| t), |t| t / 4.0 - (2.0 * t).sin() / 8.0),
        ("decay", driven((2.0, 0.0), (0.2, -0.2), 20.0, |t| (-t).exp()), |t| (-t).exp() / 5.0),
        // What drives it swings faster and faster.
        ("chirp", driven((2.0, 0.5), (0.0, 0.0), 12.0, |t| chirp((2.0, 0.5), t)), |t| (t * t).sin()),
    ];
    for (name, toy, x) in &cases {
        for tolerance in [1e-3, 1e-6, 1e-9, 1e-12] {
            let ((error, work), (_, other)) =
                (at(toy, Method::Exact, tolerance, x), at(toy, Method::Dop853, tolerance, x));
            assert!(error < 3.0 * tolerance, "{name} at {tolerance:e}: {error:e}");
            // Matrices are made for few lengths, whatever the force does.
            assert!(work.factorizations < 12 && 2 * work.evaluations < other.evaluations, "{name}: {work:?}");
        }
    }
}

#[test]
fn errors_are_proportional_to_the_tolerance() {
    let toy = driven((2.0, 0.5), (0.0, 0.0), 12.0, |t| chirp((2.0, 0.5), t));
    let resonance = driven((2.0, 0.0), (0.0, 0.0), 60.0, |t| (2.0 * t).sin());
    let swelling = |t: f64| ((2.0 * t).sin() - 2.0 * t * (2.0 * t).cos()) / 8.0;
    for (name, slope) in [("chirp", slope(&toy, |t| (t * t).sin())), ("resonance", slope(&resonance, swelling))] {
        assert!((0.7..1.3).contains(&slope), "{name}: {slope}");
    }
}

/// DETEST's E, the slope of log(error) over log(tolerance), by least squares.
fn slope(toy: &Toy, x: impl Fn(f64) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = (4..=11)
        .map(|k| {
            let tolerance = 10.0_f64.powi(-k);
            (tolerance.ln(), at(toy, Method::Exact, tolerance, &x).0.ln())
        })
        .collect();
    let count = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / count, points.iter().map(|p| p.1).sum::<f64>() / count);
    let up: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    up / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn the_unit_of_time_makes_no_difference() {
    let toy = |unit: f64| {
        let f = move |t: f64| chirp((2.0, 0.5), t / unit) / (unit * unit);
        driven((2.0 / unit, 0.5 / unit), (0.0, 0.0), 8.0 * unit, f)
    };
    let (_, work) = at(&toy(1.0), Method::Exact, 1e-9, |t| (t * t).sin());
    for unit in [1e-12, 1e12] {
        let (error, other) = at(&toy(unit), Method::Exact, 1e-9, |t| (t / unit).powi(2).sin());
        assert!(error < 1e-9, "{unit:e}: {error:e}");
        assert!(
            other.steps.abs_diff(work.steps) <= 1 && other.factorizations == work.factorizations,
            "{other:?} {work:?}"
        );
    }
}

#[test]
fn steps_that_are_given_follow_the_force_by_a_polynomial() {
    let toy = driven((2.0, 0.5), (0.0, 0.0), 8.0, |t| chirp((2.0, 0.5), t));
    let error = |step: f64| error(&exact(&toy, fixed(Method::Exact, step)), |t| (t * t).sin());
    let (coarse, fine) = (error(0.2), error(0.1));
    assert!(coarse < 1e-4 && fine < coarse / 200.0, "{coarse:e} {fine:e}");
}

#[test]
fn systems_much_faster_than_the_force_are_integrated_exactly() {
    // x'' + 2e3 x' + 1e10 x: steps of 1000 rad of its own.
    let (omega, d) = (1e5_f64, 2e3_f64);
    let toy = driven((omega, d), (0.0, 0.0), 1.0, |t| 3.0 + t);
    let run = exact(&toy, |settings| (settings.step, settings.dense) = (Some(0.01), false));
    // The transient is gone: x = 3/ω² + (t − d/ω²)/ω².
    let last = run.last();
    let expected = (4.0 - d / (omega * omega)) / (omega * omega);
    assert!((last.q[0] / expected - 1.0).abs() < 1e-12, "{} {expected}", last.q[0]);
}

#[test]
fn switches_of_time_are_stops() {
    // A force of 1 from t = 1 on: x = 1 − cos(t − 1).
    let step = Switch { text: "t - 1".into(), kind: SwitchKind::Step, time_only: true, of_input: true };
    let mut toy = Toy::new(&["x"], (&[0.0], &[0.0]), 10.0, |_, q, _, modes, a| a[0] = modes[0] - q[0])
        .switch(step, |t, _, _, _, pairs| (pairs[0], pairs[1]) = (t - 1.0, 1.0));
    toy.jacobian = Arc::new(|_, _, _, dq, dv| (dq[0], dv[0]) = (1.0, 0.0));
    (toy.description.structure.linear, toy.description.structure.time_dependent) = (true, true);
    for tolerance in [1e-3, 1e-12] {
        let (error, _) = at(&toy, Method::Exact, tolerance, |t| 1.0 - (t - 1.0).max(0.0).cos());
        assert!(error < tolerance, "{tolerance:e}: {error:e}");
    }
}

#[test]
fn events_of_driven_motions_lie_where_they_do() {
    let zero = Event {
        name: "zero".into(),
        direction: Direction::Both,
        conditional: false,
        phases: None,
        actions: vec![Action::Record].into(),
        rated: Rated::Unknown,
    };
    // x = sin t² passes zero at √(kπ).
    let toy = driven((2.0, 0.5), (0.0, 0.0), 6.0, |t| chirp((2.0, 0.5), t))
        .event(zero, |_, q, _, _, pairs| (pairs[0], pairs[1]) = (q[0], 1.0));
    let run = exact(&toy, |settings| settings.tolerance = 1e-12);
    let zeros = (1..).map(|k| (f64::from(k) * std::f64::consts::PI).sqrt());
    for (event, zero) in run.events.iter().zip(zeros) {
        assert!((event.state.t - zero).abs() < 1e-11, "{} {zero}", event.state.t);
    }
    assert_eq!(run.events.len(), 11);
}

#[test]
fn the_work_of_what_drives_is_counted() {
    // Resonance: the energy is the work of the force.
    let mut toy = driven((2.0, 0.0), (0.0, 0.0), 30.0, |t| (2.0 * t).sin())
        .energy(|t, q, v| [0.5 * v[0] * v[0], 2.0 * q[0] * q[0], v[0] * (2.0 * t).sin()]);
    toy.description.structure.conservative = false;
    let run = exact(&toy, |settings| settings.tolerance = 1e-12);
    let drift = run.energy_balance.unwrap();
    assert!(drift < 1e-11, "{drift:e}");
}
