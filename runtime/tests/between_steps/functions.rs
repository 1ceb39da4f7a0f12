//! Events are zeros of continuous functions, all of them.

use dalembert::Warning;

use crate::{coasting, file};

const ENCODER: &str = "name: Enc
parameters: {m: 1 kg, l: 1 m, g: 9.81 m/s^2, n: 360 1}
coordinates: {theta: rad}
bodies:
  bob: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}
gravity: [0, -g]
events: {tick: {when: sin(n*theta), then: record}}
conserved: {energy: energy}
scene: {start: {theta: 1.0001}, until: 20, tolerance: 1e-9}";

#[test]
fn an_encoder_counts_every_tick() {
    for (n, ticks) in [(20.0, 244), (100.0, 1184), (360.0, 4305), (1000.0, 11973)] {
        let run = file(ENCODER).set("n", n).run();
        assert_eq!(run.events.len(), ticks, "{n}");
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
    assert_eq!(file(ENCODER).set("n", 1000.0).tolerance(1e-6).run().events.len(), 11973);
}

fn moving(when: &str, start: &str, until: &str) -> dalembert::Run {
    coasting(&format!(
        "events: {{e: {{when: \"{when}\", then: stop}}}}
scene: {{start: {{{start}}}, until: {until}, tolerance: 1e-10}}"
    ))
    .run()
}

#[test]
fn where_a_function_is_undefined_there_is_no_event() {
    let run = moving("sqrt(x-1) - 0.5", "x: 0, x': 1", "3");
    assert!((run.last().t - 1.25).abs() < 1e-12, "{}", run.last());
    assert!(matches!(&run.warnings[..], [Warning::Undefined { .. }]), "{:?}", run.warnings);
    let run = moving("ln(x)", "x: -1, x': 1", "3");
    assert!((run.last()["x"] - 1.0).abs() < 1e-12, "{}", run.last());
}

#[test]
fn jumps_and_poles_are_no_events_and_said() {
    let run = moving("sign(x-77)", "x: 0, x': 1", "1000");
    assert!(run.events.is_empty());
    assert!(matches!(&run.warnings[..], [Warning::NoCrossing { .. }]), "{:?}", run.warnings);
    let run = moving("1/(x-1)", "x: 0, x': 1", "3");
    assert!(run.events.is_empty());
    assert!(matches!(&run.warnings[..], [Warning::NoCrossing { .. } | Warning::Undefined { .. }]), "{:?}", run.warnings);
    // A steep but continuous one is an event.
    let run = moving("tanh(1e6*(x-77))", "x: 0, x': 1", "1000");
    assert!((run.last().t - 77.0).abs() < 1e-9, "{}", run.last());
}

#[test]
fn near_roots_are_found_and_touches_said() {
    let roots = |d: &str| {
        coasting(&format!(
            "events: {{e: {{when: (x - 5.1234)*(x - 5.1234 - {d}), then: record}}}}
scene: {{start: {{x: 0, x': 1}}, until: 10, tolerance: 1e-10}}"
        ))
        .run()
    };
    for d in ["1e-2", "1e-4", "1e-6"] {
        let run = roots(d);
        assert_eq!(run.events.len(), 2, "{d}");
    }
    for d in ["1e-8", "1e-10", "0"] {
        let run = roots(d);
        let said = run.warnings.iter().any(|warning| matches!(warning, Warning::Touch { .. }));
        assert!(run.events.len() == 2 || said, "{d}: {:?}", run.events);
    }
}

#[test]
fn a_pulse_inside_an_event_is_met_by_its_argument() {
    for when in ["exp(-((x-50)/1e-4)^2) - 0.5", "max(0, 1e-4 - abs(x-50)) - 0.5e-4", "tanh(1e5*(x-50)) - tanh(1e5*(x-50.001)) - 1"] {
        let run = coasting(&format!(
            "events: {{e: {{when: \"{when}\", then: record}}}}
scene: {{start: {{x: 0, x': 1}}, until: 100, tolerance: 1e-10}}"
        ))
        .run();
        assert_eq!(run.events.len(), 2, "{when}");
    }
}
