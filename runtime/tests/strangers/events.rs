//! Events early in long steps, accumulating impacts.

use super::case;

/// A relay's gap of 10 nm that closes under 1 m/s², asked for much longer than that takes.
const GAP: &str = r#"
name: Gap
parameters: {m: 1 kg, a: 1 m/s^2, gap: 10 nm}
coordinates: {x: m}
bodies: {b: {mass: m, position: "[x, 0]"}}
forces: {f: {on: b, force: "[-m*a, 0]"}}
events: {contact: {when: x, direction: falling, then: stop}}
scene: {start: {x: gap}, until: 1 h, tolerance: 1e-10}
"#;

#[test]
fn an_event_early_in_a_run_of_one_step_was_missed() {
    // t = sqrt(2 gap/a), whatever is asked for.
    for until in [1.0, 3600.0, 1e9, 1e12] {
        let mut gap = case(GAP);
        gap.settings.until = until;
        let run = gap.run();
        let [contact] = run.events.as_slice() else { panic!("until {until}: {:?}", run.events) };
        assert!((contact.state.t / 2e-8_f64.sqrt() - 1.0).abs() < 1e-10, "until {until}: {}", contact.state.t);
    }
}

#[test]
fn a_start_that_leaves_a_surface_meets_it_no_sooner_than_it_returns() {
    // Thrown up from the surface at 1e-4 m/s it is back after 2 v/a.
    for until in [1.0, 1e9] {
        let mut thrown = case(&GAP.replace("start: {x: gap}", "start: {x: 0, x': 1e-4}"));
        thrown.settings.until = until;
        let run = thrown.run();
        let [contact] = run.events.as_slice() else { panic!("until {until}: {:?}", run.events) };
        assert!((contact.state.t / 2e-4 - 1.0).abs() < 1e-10, "until {until}: {}", contact.state.t);
    }
}

const BALL: &str = r#"
name: Ball
parameters: {m: 1 kg, e: 0.5 1, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
constraints: {floor: y}
phases: {flight: [], resting: [floor]}
events: {bounce: {phase: flight, when: y, direction: falling, then: {impact: e, along: floor}}}
scene: {start: {x: 0, x': 1, y: 1}, until: 3, tolerance: 1e-12}
"#;

#[test]
fn a_ball_fell_through_the_floor_of_a_long_run() {
    // Infinitely many flights end at sqrt(2 H/g) (1 + e)/(1 - e).
    for (e, until) in [("0.5", 3.0), ("0.5", 1e7), ("0.8", 1e9)] {
        let mut ball = case(&BALL.replace("e: 0.5", &format!("e: {e}")));
        ball.settings.until = until;
        let run = ball.run();
        let e: f64 = e.parse().expect("a number");
        let ends = (2.0_f64 / 9.81).sqrt() * (1.0 + e) / (1.0 - e);
        let [_, (t, phase)] = run.phases.as_slice() else { panic!("{:?}", run.phases) };
        assert!(*phase == 1 && (t - ends).abs() < 1e-10 * ends, "e = {e} until {until}: {t}, not {ends}");
    }
}

#[test]
fn the_last_impulse_of_a_sequence_pulled() {
    let run = case(BALL).run();
    let impulses: Vec<f64> = run.impulses.iter().map(|impulse| impulse.constraints[0].1).collect();
    assert!(impulses.len() > 5 && impulses.iter().all(|impulse| *impulse > 0.0), "{impulses:?}");
    // All together carry the weight from the start until the ball lies: m g t.
    let (sum, t) = (impulses.iter().sum::<f64>(), run.phases[1].0);
    assert!((sum / (9.81 * t) - 1.0).abs() < 1e-9, "{sum} for {t} s");
}

/// Two elastic balls and a wall; the heavier one is turned back after 9934 impacts.
const ELASTIC: &str = r#"
name: Elastic
parameters: {m: 1 kg, M: 1e7 kg, e: 1 1}
coordinates: {x: m, y: m}
bodies: {a: {mass: m, position: "[x, 0]"}, b: {mass: M, position: "[y, 0]"}}
constraints: {w: x, c: y - x}
phases: {free: [], q: [c]}
events:
  wall: {when: x, direction: falling, then: {impact: e, along: w}}
  hit: {phase: free, when: y - x, direction: falling, then: {impact: e, along: c}}
scene: {start: {x: 1, y: 2, y': -1}, until: 10, tolerance: 1e-12}
"#;

#[test]
fn elastic_impacts_never_accumulate() {
    let run = case(ELASTIC).run();
    assert_eq!(run.events.len(), 9934);
    assert_eq!(run.phases.len(), 1, "{:?}", run.phases);
}
