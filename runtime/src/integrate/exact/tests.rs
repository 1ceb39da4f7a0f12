//! Closed forms of linear motions.

use std::sync::Arc;

use crate::integrate::test_problems::fixed;
use crate::mechanism::{Action, Direction, Event, Method, Rated};
use crate::simulate::simulate;
use crate::testing::Toy;
use crate::{Error, Nonlinear, Run, Settings};

/// Two masses m q'' = −K q − d q' + f with K = k [2 −1; −1 2], whose modes are q₁ ± q₂.
fn pair(k: f64, d: f64, f: f64, until: f64) -> Toy {
    let mut toy = Toy::new(&["a", "b"], (&[1.0, 0.0], &[0.0, 0.5]), until, move |_, q, v, _, a| {
        a[0] = -k * (2.0 * q[0] - q[1]) - d * v[0] + f;
        a[1] = -k * (2.0 * q[1] - q[0]) - d * v[1] + f;
    });
    toy.jacobian = Arc::new(move |_, _, _, dq, dv| {
        dq.copy_from_slice(&[2.0 * k, -k, -k, 2.0 * k]);
        dv.copy_from_slice(&[d, 0.0, 0.0, d]);
    });
    toy.description.structure.linear = true;
    toy
}

/// x'' + d x' + ω² x = f from x₀, v₀, at t.
fn mode(omega: f64, d: f64, f: f64, (x, v): (f64, f64), t: f64) -> f64 {
    let rest = f / (omega * omega);
    let damped = (omega * omega - 0.25 * d * d).sqrt();
    let (c, s) = (x - rest, (v + 0.5 * d * (x - rest)) / damped);
    rest + (-0.5 * d * t).exp() * (c * (damped * t).cos() + s * (damped * t).sin())
}

fn exact(mut toy: Toy, change: impl Fn(&mut Settings)) -> Run {
    let mut settings = Settings::new(&toy.scene);
    settings.method = Method::Exact;
    change(&mut settings);
    simulate(&mut toy, &settings).unwrap()
}

/// The largest error of the reported places.
fn error(run: &Run, k: f64, d: f64, f: f64) -> f64 {
    let states = run.states().map(|state| {
        let sum = mode(k.sqrt(), d, 2.0 * f, (1.0, 0.5), state.t);
        let difference = mode((3.0 * k).sqrt(), d, 0.0, (1.0, -0.5), state.t);
        let (a, b) = (0.5 * (sum + difference), 0.5 * (sum - difference));
        (state.q[0] - a).abs().max((state.q[1] - b).abs())
    });
    states.fold(0.0, f64::max)
}

#[test]
fn linear_motions_are_exact_whatever_the_unit_of_time() {
    for (k, until) in [(1.0, 100.0), (1e8, 1e-2), (1e-10, 1e7)] {
        // The start's speed is as large beside the place as the rate is.
        for (d, f) in [(0.0, 0.0), (0.1 * f64::sqrt(k), 0.0), (0.3 * f64::sqrt(k), 2.0 * k)] {
            let run = exact(pair(k, d, f, until), |settings| settings.tolerance = 1e-12);
            let found = error(&run, k, d, f);
            // What a speed of 0.5 comes to in the slowest of these.
            let size = 1.0 + 0.5 / k.sqrt();
            assert!(found < 2e-11 * size, "{k} {d} {f}: {found:e}");
            assert!(run.work.evaluations <= 2 && run.work.factorizations <= 2, "{:?}", run.work);
        }
    }
}

#[test]
fn the_tolerance_is_that_between_the_ends_of_steps() {
    let mut before = f64::INFINITY;
    for tolerance in [1e-3, 1e-6, 1e-9] {
        let run = exact(pair(4.0, 0.2, 1.0, 20.0), |settings| settings.tolerance = tolerance);
        let found = error(&run, 4.0, 0.2, 1.0);
        assert!(found < 2.0 * tolerance && found < before, "{tolerance}: {found:e}");
        assert!((run.states().last().unwrap().q[0]).is_finite() && run.work.steps < 200);
        before = found;
    }
}

#[test]
fn what_is_stiff_costs_no_more() {
    let stiff = exact(pair(1e6, 50.0, 0.0, 1.0), |settings| settings.step = Some(0.01));
    assert!(stiff.work.steps == 100 && error_at_end(&stiff, 1e6, 50.0) < 1e-12);
}

fn error_at_end(run: &Run, k: f64, d: f64) -> f64 {
    let last = run.last();
    let sum = mode(k.sqrt(), d, 0.0, (1.0, 0.5), last.t);
    let difference = mode((3.0 * k).sqrt(), d, 0.0, (1.0, -0.5), last.t);
    (last.q[0] - 0.5 * (sum + difference)).abs()
}

#[test]
fn events_lie_where_they_do() {
    let zero = Event {
        name: "zero".into(),
        direction: Direction::Both,
        conditional: false,
        phases: None,
        actions: vec![Action::Record].into(),
        rated: Rated::Unknown,
    };
    let mut toy = Toy::oscillator(1.0, 10.0).event(zero, |_, q, _, _, pairs| (pairs[0], pairs[1]) = (q[0], 1.0));
    toy.description.structure.linear = true;
    let run = exact(toy, |settings| settings.tolerance = 1e-12);
    for (event, zero) in run.events.iter().zip((0..).map(|k| std::f64::consts::PI * (0.5 + f64::from(k)))) {
        assert!((event.state.t - zero).abs() < 1e-12, "{} {zero}", event.state.t);
    }
    assert_eq!(run.events.len(), 3);
}

#[test]
fn what_is_not_linear_is_refused_with_the_reason() {
    let mut toy = pair(1.0, 0.0, 0.0, 1.0);
    toy.description.structure.linear = false;
    let mut settings = Settings::new(&toy.scene);
    fixed(Method::Exact, 0.1)(&mut settings);
    let error = simulate(&mut toy, &settings).unwrap_err();
    assert!(matches!(error, Error::NotLinear { reason: Nonlinear::Coefficients }), "{error}");
}
