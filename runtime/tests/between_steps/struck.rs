//! Events at which something is struck, and what is said of those that turn back near zero.

use dalembert::Warning;

use super::{file, sprung};

fn floor(e: f64, amplitude: f64) -> String {
    format!(
        "name: Bounce
parameters: {{m: 1 kg, g: 10 m/s^2, e: {e} 1, A: {amplitude} m, w: 30 1/s}}
coordinates: {{y: m}}
inputs: {{f: A*sin(w*t)}}
bodies: {{b: {{mass: m, position: \"[0, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: y - f}}
phases: {{free: [], rest: [floor]}}
events:
  hit: {{phase: free, when: y - f, direction: falling, then: {{impact: e, along: floor}}}}
  off: {{phase: rest, when: reaction(floor), direction: falling, then: free}}
scene: {{start: {{y: 1}}, until: 3}}"
    )
}

/// Rounding about the zero at which a step ends is no other event: every impact has an impulse, and each entry of a phase one more.
#[test]
fn a_moving_floor_is_hit_as_often_as_it_pushes() {
    for (e, amplitude) in [(0.5, 0.01), (0.3, 0.02), (0.5, 0.0)] {
        let run = file(&floor(e, amplitude)).run();
        let named =
            |name: &str| run.events.iter().filter(|event| event.name == name).map(|event| event.state.t).collect();
        let hits: Vec<f64> = named("hit");
        assert!(hits.len() > 8 && hits.len() <= run.impulses.len(), "{e}: {} {}", hits.len(), run.impulses.len());
        assert!(hits.windows(2).all(|pair| pair[1] - pair[0] > 1e-12), "{e}: {hits:?}");
    }
}

fn grazes(warnings: &[Warning]) -> bool {
    warnings.iter().any(|warning| matches!(warning, Warning::EventGrazes { .. }))
}

#[test]
fn events_on_accelerations_and_impacts_do_not_graze() {
    let mut case = sprung("events: {a: {when: \"x''\", then: record}}\nscene: {start: {x: 1}, until: 20}");
    case.settings.digits = true;
    let run = case.run();
    assert_eq!(run.events.len(), 6);
    assert!(!grazes(&run.warnings), "{:?}", run.warnings);
    let mut ball = file(&floor(0.9, 0.01));
    ball.settings.digits = true;
    assert!(!grazes(&ball.run().warnings));
    // What turns back at its zero without being struck does.
    let mut near = sprung("events: {a: {when: \"x + 1\", then: record}}\nscene: {start: {x: 1}, until: 5}");
    near.settings.digits = true;
    let warnings = near.run().warnings;
    assert!(warnings.iter().any(|w| matches!(w, Warning::EventGrazes { .. } | Warning::Touch { .. })), "{warnings:?}");
}

/// A pulse so narrow, so late, that times are rounded to a good part of it is continuous all the same; a jump is none.
#[test]
fn a_narrow_input_crosses_and_does_not_jump() {
    let text = |input: &str, when: &str| {
        format!(
            "parameters: {{m: 1 kg, F: 1 N, T: 1 s, k: 0.1 N/m}}
name: Narrow
coordinates: {{x: m}}
inputs: {{u: {input}}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
springs: {{s: {{stretch: x, stiffness: k, on: b, along: \"[1, 0]\"}}}}
events: {{a: {{when: {when}, then: record}}}}
scene: {{start: {{x: 1}}, until: 30}}"
        )
    };
    let run = file(&text("\"F*exp(-((t - 20*T)/T*1e6)^2)\"", "u - F/2")).run();
    let times: Vec<f64> = run.events.iter().map(|event| 1e6 * (event.state.t - 20.0)).collect();
    let half = std::f64::consts::LN_2.sqrt();
    assert!(times.len() == 2 && (times[0] + half).abs() + (times[1] - half).abs() < 1e-6, "{times:?}");
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    let jumps = file(&text("\"F*t/T\"", "\"atan(T/(t - 20.3*T)) - 1/2\"")).run();
    assert!(jumps.events.len() == 1 && jumps.warnings.iter().any(|w| matches!(w, Warning::NoCrossing { .. })));
}
