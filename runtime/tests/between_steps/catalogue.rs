//! Cases of the catalogue of failures that need no constraints, phases or impacts, by their numbers.

use dalembert::{Cause, Error, Method, Warning};

use super::{Case, coasting, file, sprung};

/// Why a run ended, and when.
fn ends(case: &mut Case) -> (Cause, f64) {
    match case.try_run() {
        Err(Error::Run(failure)) => (failure.cause, failure.state.t),
        other => panic!("{other:?}"),
    }
}

/// A pendulum of 1 m, g = 9.81 m/s², by one Cartesian coordinate: its place is `place`.
fn cartesian(coordinate: &str, place: &str, start: &str) -> Case {
    file(&format!(
        "name: P
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{{coordinate}: m}}
gravity: [0, -g]
bodies: {{bob: {{mass: m, position: \"{place}\"}}}}
scene: {{start: {{{start}}}, until: 5, tolerance: 1e-8}}"
    ))
}

/// C1: thrown to 120°, the horizontal coordinate fails where the rod is horizontal, at 0.344261 s; to 57° it does not.
#[test]
fn c1_a_coordinate_that_fails_is_named_with_the_time() {
    let thrown = |degrees: f64| {
        let speed = (2.0 * 9.81 * (1.0 - degrees.to_radians().cos())).sqrt();
        cartesian("s", "[s, -sqrt(l^2 - s^2)]", &format!("s: 0, s': {speed}"))
    };
    let (cause, t) = ends(&mut thrown(120.0));
    assert!(matches!(&cause, Cause::CoordinateSingularity { coordinate, .. } if coordinate == "s"), "{cause:?}");
    assert!((t - 0.344261).abs() < 1e-3, "{t}");
    assert_eq!(thrown(57.0).run().warnings, []);
}

/// C2: the vertical coordinate fails at the bottom, 0.53478 s after a release from 1 rad.
#[test]
fn c2_the_vertical_coordinate_fails_at_the_bottom() {
    let start = format!("y: {}", -(1.0_f64.cos()));
    let (cause, t) = ends(&mut cartesian("y", "[sqrt(l^2 - y^2), y]", &start));
    assert!(matches!(&cause, Cause::CoordinateSingularity { coordinate, .. } if coordinate == "y"), "{cause:?}");
    assert!((t - 0.53478).abs() < 1e-3, "{t}");
}

/// E3, E4: x = sin t rises above 1 − d ten times; the pairs of crossings are d = 1e-2 … 1e-6 apart by 2√(2d), and their
/// times are known to the tolerance over √(2d).
#[test]
fn e3_e4_pairs_of_crossings_within_a_step_are_all_found() {
    for d in [1e-2_f64, 1e-4, 1e-6] {
        let mut case = sprung(&format!(
            "events: {{e: {{when: \"x - {}\", then: record}}}}
scene: {{start: {{x: 0, x': 1}}, until: 62.8, tolerance: 1e-10}}",
            1.0 - d
        ));
        let run = case.run();
        assert_eq!(run.events.len(), 20, "{d}");
        let half = (1.0 - d).asin();
        for (i, event) in run.events.iter().enumerate() {
            let turn = std::f64::consts::TAU * (i / 2) as f64;
            let exact = turn + if i % 2 == 0 { half } else { std::f64::consts::PI - half };
            let error = (event.state.t - exact).abs();
            assert!(error < 1e-8 / (2.0 * d).sqrt(), "{d}: {i} off by {error:e}");
        }
    }
}

/// E5: a force that steps on within a step costs a method its order; at stop times RK4 keeps it.
#[test]
fn e5_a_force_that_steps_on_costs_no_order() {
    let error = |n: f64| {
        let mut case =
            sprung("forces: {f: {on: b, force: \"[F*step(t - 0.7391), 0]\"}}\nscene: {start: {x: 0}, until: 2}");
        case.settings.method = Method::Rk4;
        case.settings.step = Some(2.0 / n);
        (case.run().last()["x"] - (1.0 - (2.0_f64 - 0.7391).cos())).abs()
    };
    let slope = (error(50.0) / error(200.0)).log2() / 2.0;
    assert!((3.7..4.4).contains(&slope), "{slope}");
}

/// E6: a force from t = 50 s to 53 s on what is at rest is not stepped over: |x| reaches 1.994990.
#[test]
fn e6_a_pulse_at_rest_is_met() {
    let mut case = sprung(
        "forces: {f: {on: b, force: \"[F*(step(t - 50) - step(t - 53)), 0]\"}}
scene: {start: {x: 0}, until: 70, every: 0.005, tolerance: 1e-8}",
    );
    let largest = case.run().column("x").unwrap().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    assert!((largest - 1.994_990).abs() < 1e-4, "{largest}");
}

/// E7: the time of an event is that of the method, not of its dense output.
#[test]
fn e7_events_are_as_accurate_as_the_method() {
    let mut case = sprung("events: {e: {when: x, then: record}}\nscene: {start: {x: 1}, until: 2}");
    case.settings.method = Method::Dopri5;
    case.settings.step = Some(0.1);
    let t = case.run().events[0].state.t;
    assert!((t - std::f64::consts::FRAC_PI_2).abs() < 1e-8, "{t}");
}

/// E11: what sign friction brings to rest stays there from the time v/(μg) on, at a fixed step too; before, it slides.
#[test]
fn e11_friction_by_a_sign_holds_what_it_stopped() {
    let slides = |until: &str| {
        coasting(&format!(
            "forces: {{f: {{on: b, force: \"[-0.5*F*sign(x'), 0]\"}}}}
scene: {{start: {{x: 0, x': 1}}, until: {until}, tolerance: 1e-8}}"
        ))
    };
    for step in [None, Some(0.07)] {
        let mut case = slides("3");
        (case.settings.method, case.settings.step) = (Method::Dopri5, step);
        let end = case.run().last();
        assert!((end["x"] - 1.0).abs() < 1e-7 && end["x'"] == 0.0, "{end:?}");
    }
    let end = slides("1.9").run().last();
    assert!((end["x'"] - 0.05).abs() < 1e-9, "{end:?}");
}

/// E12: friction as tanh(v/v_s) lets a block creep down a slope of 20° (μ = 0.5) at 0.9243 v_s; a fixed step beyond
/// 2 v_s/(μg cos) buzzes and is warned of, one within is not.
#[test]
fn e12_smoothed_friction_creeps_and_a_step_beyond_its_limit_is_warned_of() {
    let slope = || {
        file(
            "name: Slope
parameters: {m: 1 kg, g: 9.81 m/s^2, alpha: 20 deg, mu: 0.5, vs: 0.01 m/s}
coordinates: {x: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
forces: {f: {on: b, force: \"[m*g*(sin(alpha) - mu*cos(alpha)*tanh(x'/vs)), 0]\"}}
scene: {start: {x: 0}, until: 2, tolerance: 1e-8}",
        )
    };
    let speed = slope().run().last()["x'"];
    let exact = 0.01 * (20.0_f64.to_radians().tan() / 0.5).atanh();
    assert!((speed - exact).abs() < 1e-8 && (exact / 0.01 - 0.9243).abs() < 1e-4, "{speed} {exact}");
    let warned = |step: f64| {
        let mut case = slope();
        (case.settings.method, case.settings.step) = (Method::Rk4, Some(step));
        case.run().warnings.iter().any(|warning| matches!(warning, Warning::StepExceedsStability { .. }))
    };
    // λ = μ g cos α/v_s = 461/s at rest; RK4's real limit is 2.785.
    assert!(warned(1.1 * 2.785 / 461.0) && !warned(0.5 * 2.785 / 461.0));
}

/// E15: x'' = 2x³ with x = x' = 1 is x = 1/(1 − t).
#[test]
fn e15_a_pole_ends_the_run_where_it_is() {
    let pole = |until: &str| {
        coasting(&format!(
            "generalized_forces: {{x: 2*F*x^3}}
scene: {{start: {{x: 1, x': 1}}, until: {until}, tolerance: 1e-10}}"
        ))
    };
    let (cause, t) = ends(&mut pole("2"));
    assert!(matches!(cause, Cause::StepTooSmall { .. } | Cause::NonFinite { .. }), "{cause:?}");
    assert!((t - 1.0).abs() < 1e-6, "{t}");
    let x = pole("0.9").run().last()["x"];
    assert!((x - 10.0).abs() < 1e-6, "{x}");
}

/// E17: abs, sign, min and max are events of the motion: a kinked spring keeps the order, and the root of zero is no NaN.
#[test]
fn e17_kinks_cost_no_order_and_roots_at_their_edge_run() {
    // Half a period of π/√1 on one side, π/2 on the other, where the stiffness is four times as large.
    let mut kinked = coasting(
        "generalized_forces: {x: \"-F*(2.5*x + 1.5*abs(x))\"}\nscene: {start: {x: 1}, until: 30, tolerance: 1e-10}",
    );
    let run = kinked.run();
    let period = std::f64::consts::PI * 1.5;
    let rest = 30.0_f64.rem_euclid(period);
    let quarter = std::f64::consts::FRAC_PI_4;
    // 4 for x > 0: a quarter period of π/4, then half a period of π at 1, and back.
    let exact = match rest {
        t if t < quarter => (2.0 * t).cos(),
        t if t < quarter + std::f64::consts::PI => -2.0 * (t - quarter).sin(),
        t => (2.0 * (period - t)).cos(),
    };
    assert!((run.last()["x"] - exact).abs() < 1e-7, "{} {exact}", run.last()["x"]);
    let mut root =
        coasting("generalized_forces: {x: \"-F*sqrt(max(0, x))\"}\nscene: {start: {x: 1}, until: 3, tolerance: 1e-8}");
    assert!(root.run().last()["x"].is_finite());
}

/// R11: accelerations under a mass matrix of condition 1e12 have an error below 10 ε cond(M).
#[test]
fn r11_accelerations_under_an_ill_conditioned_mass_matrix() {
    for ratio in [1e-3, 1e-6, 1e-9, 1e-12] {
        let case = file(&format!(
            "name: R
parameters: {{m: 1, mu: {ratio:e}, F: 1}}
coordinates: {{x: 1, u: 1}}
bodies: {{big: {{mass: m, position: \"[x, 0]\"}}, small: {{mass: mu, position: \"[x + u, 0]\"}}}}
generalized_forces: {{x: -F*x, u: -F*mu*u}}
scene: {{start: {{x: 0.7, u: 0.3}}, until: 1}}"
        ));
        let mut a = [0.0; 2];
        let (q, v) = (&case.settings.q, &case.settings.v);
        dalembert::mechanism::System::accelerations(&case.system, dalembert::mechanism::At::new(0.0, q, v), &mut a)
            .unwrap();
        // m x'' = −x + μu, x'' + u'' = −u.
        let x = -0.7 + ratio * 0.3;
        let u = -0.3 - x;
        let bound = 10.0 * f64::EPSILON * 4.0 / ratio;
        assert!((a[0] - x).abs() < bound && (a[1] - u).abs() < bound, "{ratio:e}: {a:?} {x} {u}");
    }
}
