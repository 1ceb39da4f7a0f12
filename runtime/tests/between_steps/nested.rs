//! Discontinuities nested in each other start, and stay, on the right side.

use dalembert::Cause;

use crate::{coasting, file, sprung};

#[test]
fn a_dead_zone_with_a_sign_runs() {
    let law = |force: &str, start: &str| {
        sprung(&format!(
            "forces: {{f: {{on: b, force: \"[{force}, 0]\"}}}}
scene: {{start: {{{start}}}, until: 6, tolerance: 1e-10}}"
        ))
        .run()
    };
    let two = "-F*(max(0, x-0.5) - max(0, -x-0.5))";
    for start in ["x: 2", "x: 0.5, x': -1", "x: 0, x': 1", "x: 0", "x: 5, x': -1"] {
        let one = law("-F*max(0, abs(x)-0.5)*sign(x)", start);
        let other = law(two, start);
        assert!((one.last()["x"] - other.last()["x"]).abs() < 1e-8, "{start}: {} {}", one.last(), other.last());
        assert!((one.last()["x'"] - other.last()["x'"]).abs() < 1e-8, "{start}");
    }
}

#[test]
fn what_decides_is_not_how_long_the_run_is_to_be() {
    for until in ["10", "1e7"] {
        for l in ["1", "1e-3"] {
            let run = coasting(&format!(
                "forces: {{f: {{on: b, force: \"[2*F - F*step(sin(x/{l})), 0]\"}}}}
events: {{far: {{when: \"x - 2*{l}\", then: stop}}}}
scene: {{start: {{x: 0}}, until: {until}, tolerance: 1e-10}}"
            ))
            .run();
            let l: f64 = l.parse().unwrap();
            assert!((run.last().t - (4.0 * l).sqrt()).abs() < 1e-9 * run.last().t, "{until} {l}: {}", run.last());
        }
    }
}

#[test]
fn a_zero_of_high_order_at_the_start_is_left_to_the_right_side() {
    for omega in ["1", "1e3", "1e6", "1e9"] {
        // x'' of sin³ωt; the switch reads x³, whose first eight rates vanish.
        let run = coasting(&format!(
            "inputs: {{u: \"sin({omega}*t)\"}}
forces: {{f: {{on: b, force: \"[F*step(u^3) - 0.5*F, 0]\"}}}}
scene: {{start: {{x: 0}}, until: 1/{omega}, tolerance: 1e-10}}"
        ))
        .run();
        assert!(run.last()["x'"] > 0.0, "{omega}: {}", run.last());
    }
}

#[test]
fn a_speed_to_which_both_sides_push_back_stays() {
    let run = coasting(
        "forces: {f: {on: b, force: \"[-F*sign(abs(x') - 1), 0]\"}}
scene: {start: {x: 1, x': 2}, until: 6, tolerance: 1e-10}",
    )
    .run();
    assert!((run.last()["x"] - 7.5).abs() < 1e-10 && (run.last()["x'"] - 1.0).abs() < 1e-12, "{}", run.last());
    // At rest where both sides push back nothing moves.
    let run = coasting(
        "forces: {f: {on: b, force: \"[-F*sign(abs(x) - 1), 0]\"}}
scene: {start: {x: 1, x': 0}, until: 6, tolerance: 1e-10}",
    )
    .run();
    assert_eq!((run.last()["x"], run.last()["x'"]), (1.0, 0.0));
}

#[test]
fn a_one_sided_power_stays_finite_beyond_its_surface() {
    let ball = |power: &str| {
        file(&format!(
            "name: Ball
parameters: {{m: 1, g: 9.81, K: 1e6}}
coordinates: {{y: 1}}
bodies: {{b: {{mass: m, position: \"[0, y]\"}}}}
gravity: [0, -g]
forces: {{f: {{on: b, force: \"[0, K*max(0, -y)^{power}]\"}}}}
scene: {{start: {{y: 1}}, until: 5, tolerance: 1e-10}}"
        ))
        .run()
    };
    for power in ["1.5", "1.3", "2.5", "1", "2"] {
        let run = ball(power);
        let highest = run.column("y").unwrap().into_iter().skip(60).fold(0.0, f64::max);
        assert!((highest - 1.0).abs() < 1e-2 && highest < 1.0 + 1e-6, "{power}: {highest}");
        let drift = run.energy_balance.unwrap();
        assert!(drift < 1e-6, "{power}: {drift:e}");
    }
}

#[test]
fn a_spring_whose_ends_meet_is_named_at_every_tolerance() {
    let text = "name: R
parameters: {m: 1 kg, k: 20 N/m, l: 1 m}
coordinates: {a: rad, d: rad}
points: {O: [0, 0]}
bodies:
  q: {mass: m, position: \"l*[sin(a), -cos(a)]\"}
  p: {mass: m, position: \"q + l*[sin(a + d), -cos(a + d)]\"}
springs: {s: {between: [O, p], stiffness: k, rest: l/2}}
scene: {start: {a: 0, d: 2, d': 5}, until: 5, tolerance: 1e-9}";
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12] {
        let error = file(text).tolerance(tolerance).try_run().unwrap_err();
        let Some(Cause::EndsMeet { load, .. }) = error.cause() else { panic!("{tolerance}: {error}") };
        assert_eq!(load, "s");
        assert!(error.to_string().contains("direction lost"), "{error}");
    }
    // Ends that pass each other at a distance.
    let apart = text.replace("[sin(a + d), -cos(a + d)]\"", "[sin(a + d), -1.01*cos(a + d)]\"");
    assert!(file(&apart.replace("a: 0,", "a: 0.3,")).try_run().is_ok());
}
