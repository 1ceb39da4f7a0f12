//! Motions under constant forces, which `auto` follows from one event to the next in a step.

use dalembert::Method;

use super::{Case, coasting, file};

/// A ball over a floor, with these further lines.
fn ball(lines: &str) -> Case {
    file(&format!(
        "name: Ball
parameters: {{m: 1, g: 10, e: 0.5, H: 0.8}}
coordinates: {{x: 1, y: 1}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
{lines}"
    ))
}

const FLOOR: &str = "constraints: {floor: y}
phases: {flight: [], resting: [floor]}
events: {bounce: {phase: flight, when: y, direction: falling, then: {impact: e, along: floor}}}
scene: {start: {y: H, x': 0.3}, until: 4, tolerance: 1e-6}";

#[test]
fn flights_between_impacts_take_one_step_each() {
    for scale in [1e-12, 1.0, 1e12] {
        let mut case = ball(FLOOR).set("g", 10.0 * scale).set("H", 0.8 * scale);
        case.settings.q[1] = 0.8 * scale;
        let run = case.run();
        assert_eq!(run.method, Method::Verlet, "{scale:e}");
        // It falls for 0.4 s and rests after 0.4 (1 + e)/(1 − e) s.
        assert!((run.events[0].state.t - 0.4).abs() < 1e-12, "{scale:e}: {}", run.events[0].state.t);
        assert!(run.events.windows(2).take(20).enumerate().all(|(k, pair)| {
            let flight = pair[1].state.t - pair[0].state.t;
            (flight / (0.4 * 0.5_f64.powi(k as i32)) - 1.0).abs() < 1e-6
        }));
        let last = run.last();
        assert!((last["x"] - 1.2).abs() < 1e-12 && last["y"].abs() < 1e-12 * scale, "{scale:e}: {last}");
        assert!(run.work.evaluations < 5 * run.work.steps, "{scale:e}: {:?}", run.work);
    }
}

#[test]
fn steps_of_any_length_come_to_rest_on_the_floor() {
    for step in [0.1, 0.5, 0.75, 4.0] {
        let mut case = ball(FLOOR);
        (case.settings.method, case.settings.step) = (Method::Verlet, Some(step));
        let last = case.run().last();
        assert!((last["x"] - 1.2).abs() < 1e-12 && last["y"].abs() < 1e-12, "{step}: {last}");
    }
}

#[test]
fn what_oscillates_along_a_parabola_is_counted() {
    // x = 0.3 t: sin(400 x) vanishes 152 times after the start.
    let scene = "scene: {start: {y: H, x': 0.3}, until: 4, tolerance: 1e-6}";
    let mut case = ball(&format!("events: {{ripple: {{when: sin(400*x), then: record}}}}\n{scene}"));
    let run = case.run();
    assert_eq!((run.method, run.events.len()), (Method::Verlet, 152));
    // Beyond what a step may hold it is cut.
    let mut case = ball(&format!("events: {{ripple: {{when: sin(1e5*x), then: record}}}}\n{scene}"));
    case.settings.method = Method::Dop853;
    let adaptive = case.run().events.len();
    case.settings.method = Method::Auto;
    assert_eq!((case.run().events.len(), adaptive), (38_197, 38_197));
}

#[test]
fn a_force_that_turns_at_a_place_makes_arcs_of_parabolas() {
    // x'' = −sign x from 0.5 at rest: a quarter takes 1 s.
    let mut case = coasting(
        "forces: {f: {on: b, force: \"[-F*sign(x), 0]\"}}\nscene: {start: {x: 0.5}, until: 8, tolerance: 1e-6}",
    );
    let run = case.run();
    assert_eq!(run.method, Method::Verlet);
    assert!((run.last()["x"] - 0.5).abs() < 1e-12 && run.work.evaluations < 60, "{}, {:?}", run.last(), run.work);
}

#[test]
fn what_is_no_parabola_is_left_to_others() {
    let moving = "constraints: {floor: y - sin(t)}
phases: {flight: [floor]}
scene: {start: {x': 0.3}, until: 4, tolerance: 1e-9}";
    let curved = moving.replace("y - sin(t)", "y - x^2");
    for lines in [moving, &curved] {
        let run = ball(lines).run();
        assert_ne!(run.method, Method::Verlet, "{lines}");
    }
    assert!((ball(moving).run().last()["y"] - 4.0_f64.sin()).abs() < 1e-9);
    for force in ["-F*x", "-F*x'", "F*t", "F*sin(t)"] {
        let scene = "scene: {start: {x: 0.5, x': 1}, until: 2, tolerance: 1e-6}";
        let run = coasting(&format!("forces: {{f: {{on: b, force: \"[{force}, 0]\"}}}}\n{scene}")).run();
        assert_ne!(run.method, Method::Verlet, "{force}");
    }
    // A longest step is kept.
    let mut case = ball(FLOOR);
    case.settings.longest_step = Some(0.01);
    assert!(case.run().work.steps > 400);
}
