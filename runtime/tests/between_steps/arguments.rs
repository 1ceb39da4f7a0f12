//! Features that are local through an argument.

use dalembert::Method;

use crate::{coasting, file, sprung};

#[test]
fn smooth_pulses_of_time_are_met_whatever_their_width() {
    // Of a pulse of tanh the oscillator sees the part a/sinh a, a = π/(2·rate), of the sharp one's.
    for rate in [10.0, 100.0, 1e4, 1e6] {
        let text = format!(
            "forces: {{f: {{on: b, force: \"[F*(tanh({rate}*(t-50))-tanh({rate}*(t-53)))/2, 0]\"}}}}
scene: {{start: {{x: 0}}, until: 100, tolerance: 1e-10}}"
        );
        let run = sprung(&text).run();
        let a = 0.5 * std::f64::consts::PI / rate;
        let expected = a / a.sinh() * (47.0_f64.cos() - 50.0_f64.cos());
        assert!((run.last()["x"] - expected).abs() < 1e-6, "{rate}: {} {expected}", run.last());
    }
}

/// In steps of some 1e-8 s the rounding of t changes the argument of the pulse by more than the cubic through it does: it
/// was followed through noise, and the run never ended.
#[test]
fn a_pulse_of_time_is_followed_no_closer_than_time_is_known() {
    let mut drawn = file(
        "name: Drawn
coordinates: {theta: 1}
gravity: [0, -9.81]
bodies: {bob: {mass: 0.13, position: \"[0.81*sin(theta), -0.81*cos(theta)]\"}}
generalized_forces:
  theta: \"0.99*sign(abs(theta - 0.835) - 0.0054) - 113*exp(-((t - 5.76245)/3.2e-5)^2)\"
scene: {start: {theta: 1.4, theta': -1.42}, until: 5.8, tolerance: 1e-10}",
    );
    let usual = drawn.run();
    let run = drawn.tolerance(1e-12).run();
    assert!((run.last()["theta"] - usual.last()["theta"]).abs() < 1e-6, "{} {}", run.last(), usual.last());
    assert!(run.work.samples < 40 * run.work.steps, "{:?}", run.work);
}

/// A blow of 1 N s within 1e-7 s after 100 s: of the argument of its exponential nothing would be left if it were multiplied
/// out, and the rounding of the time makes 1e-5 of the force.
#[test]
fn a_short_pulse_long_after_the_start_gives_its_impulse() {
    for (at, width) in [(100.0, 1e-7), (5.0, 1e-8), (1e4, 1e-3)] {
        let mut blow = file(&format!(
            "name: Kick
coordinates: {{x: 1}}
bodies: {{b: {{mass: 1, position: \"[x, 0]\"}}}}
generalized_forces: {{x: \"exp(-((t - {at:?})/{width:e})^2)/{width:e}\"}}
scene: {{start: {{x: 0}}, until: {}, tolerance: 1e-9}}",
            at + 1.0
        ));
        let run = blow.run();
        let impulse = std::f64::consts::PI.sqrt();
        assert!((run.last()["x'"] - impulse).abs() < 1e-6, "{at} {width}: {}", run.last());
        assert!(run.work.steps < 10_000, "{at} {width}: {:?}", run.work);
    }
}

/// x'' = u' begins at the top of a pulse, where u' vanishes, and one step reaches the top of the next: x' = u(t) - u(0).
#[test]
fn a_pulse_that_is_fallen_off_is_met_though_others_follow() {
    for (pulse, of) in [("exp(-P^2)", f64::exp as fn(f64) -> f64), ("1/(1 + P^2)", |square| 1.0 / (1.0 - square))] {
        for (rate, width, begun) in
            [(20.0, 2e-4, 0.0), (20.0, 2e-4, 0.3), (8.0, 1e-2, 0.0), (11.4, 1e-7, 0.0), (15.0, 2e-4, -1.5)]
        {
            let phase = begun * width;
            let u = |t: f64| of(-(((rate * t + phase).sin() / width).powi(2)));
            let input = pulse.replace('P', &format!("(sin({rate:?}*t + {phase:e})/{width:e})"));
            for method in [Method::Auto, Method::Rkn8, Method::Dop853, Method::Dopri5, Method::Radau5] {
                let mut falls = file(&format!(
                    "name: Falls
coordinates: {{x: 1}}
inputs: {{u: \"{input}\"}}
bodies: {{b: {{mass: 1, position: \"[x, 0]\"}}}}
generalized_forces: {{x: \"u'\"}}
scene: {{start: {{x: 0, x': 0.5}}, until: 1.9, tolerance: 1e-7}}"
                ));
                falls.settings.method = method;
                let (run, expected) = (falls.run(), 0.5 + u(1.9) - u(0.0));
                assert!((run.last()["x'"] - expected).abs() < 1e-3, "{input}, {method}: {} {expected}", run.last());
            }
        }
    }
}

#[test]
fn a_gaussian_zone_is_met_whatever_its_width() {
    for width in [1.0, 0.1, 1e-2, 1e-4, 1e-6] {
        let text = format!(
            "forces: {{f: {{on: b, force: \"[F*exp(-((x-50)/{width})^2), 0]\"}}}}
scene: {{start: {{x: 0, x': 1}}, until: 100, tolerance: 1e-10}}"
        );
        let run = coasting(&text).run();
        let expected = (1.0 + 2.0 * width * std::f64::consts::PI.sqrt()).sqrt();
        let error = (run.last()["x'"] - expected).abs();
        assert!(error < 1e-3 * (expected - 1.0) + 1e-9, "{width}: {} {expected}", run.last());
    }
}

#[test]
fn a_narrow_well_keeps_the_energy_at_a_loose_tolerance() {
    let mut case = sprung(
        "potential_energy: -30*exp(-((x-2)/0.1)^2)
scene: {start: {x: 0, x': 10}, until: 20, tolerance: 1e-6}",
    );
    let run = case.run();
    assert!((run.last()["x"] - 9.2488).abs() < 2e-3, "{}", run.last());
    let tight = case.tolerance(1e-12).run();
    assert!((run.last()["x"] - tight.last()["x"]).abs() < 2e-3, "{} {}", run.last(), tight.last());
}

#[test]
fn a_lorentz_zone_is_met() {
    for width in [1e-2, 1e-5] {
        let text = format!(
            "forces: {{f: {{on: b, force: \"[F/(1 + ((x-50)/{width})^2), 0]\"}}}}
scene: {{start: {{x: 0, x': 1}}, until: 100, tolerance: 1e-10}}"
        );
        let run = coasting(&text).run();
        let expected = (1.0 + 2.0 * std::f64::consts::PI * width).sqrt();
        let error = (run.last()["x'"] - expected).abs();
        assert!(error < 2e-3 * (expected - 1.0), "{width}: {} {expected}", run.last());
    }
}

/// Steps collapse before the kink of a cusp, beyond which its exponential would grow for ever, and the acceleration rises
/// within them: it does not jump, as where a direction is lost.
#[test]
fn a_cusp_is_met_whatever_its_width_and_is_no_lost_direction() {
    for width in [1e-2, 1e-4, 1e-6] {
        for (tolerance, part) in [(1e-6, 2e-2), (1e-8, 1e-2), (1e-10, 1e-3)] {
            let text = format!(
                "forces: {{f: {{on: b, force: \"[F/{width}*exp(-abs(x - 0.13)/{width}), 0]\"}}}}
scene: {{start: {{x: -0.36, x': 2}}, until: 1, tolerance: {tolerance}}}"
            );
            let run = coasting(&text).run();
            let error = (run.last()["x'"] - 8.0_f64.sqrt()).abs();
            assert!(error < part, "{width}, {tolerance:e}: {}", run.last());
        }
    }
}

#[test]
fn logistic_steps_are_met() {
    // A force of 1 between two of them.
    let run = coasting(
        "forces: {f: {on: b, force: \"[F/(1 + exp(-1e4*(x-50))) - F/(1 + exp(-1e4*(x-50.5))), 0]\"}}
scene: {start: {x: 0, x': 1}, until: 100, tolerance: 1e-10}",
    )
    .run();
    assert!((run.last()["x'"] - 2.0_f64.sqrt()).abs() < 1e-6, "{}", run.last());
}

#[test]
fn an_ordinary_force_is_not_cut() {
    let mut plain = sprung("scene: {start: {x: 1}, until: 20, tolerance: 1e-9}");
    plain.settings.method = Method::Dop853;
    let plain = plain.run();
    let mut watched = sprung(
        "forces: {f: {on: b, force: \"[0*F*x + 1e-300*exp(-x^2), 0]\"}}
scene: {start: {x: 1}, until: 20, tolerance: 1e-9}",
    );
    watched.settings.method = Method::Dop853;
    let watched = watched.run();
    assert_eq!(watched.work.retries, 0);
    assert_eq!(plain.work.steps, watched.work.steps);
}

/// Two masses pass through each other: a spring between them that has no stiffness does nothing, and cuts no steps where its ends
/// are near; nor does one that a factor of 0 leaves out.
#[test]
fn a_spring_without_stiffness_cuts_no_steps() {
    let passing = |stiffness: &str, lines: &str| {
        file(&format!(
            "name: Passing
parameters: {{m: 1 kg, k: {stiffness} N/m, part: 0, l: 1 m}}
coordinates: {{x: m, y: m, z: m}}
bodies: {{a: {{mass: m, position: \"[x, 1e-3*l]\"}}, b: {{mass: m, position: \"[y, z]\"}}}}
{lines}
scene: {{start: {{x: -1, x': 1, y: 1, y': -1, z: 0}}, until: 2, tolerance: 1e-9}}"
        ))
        .run()
    };
    let between = "springs: {s: {between: [a, b], stiffness: k, rest: l}}";
    let alone = passing("0", "");
    for (stiffness, lines) in [("0", between), ("5", "springs: {s: {between: [a, b], stiffness: part*k/2, rest: l}}")] {
        let run = passing(stiffness, lines);
        assert!(run.work.steps <= alone.work.steps + 2 && run.work.retries == 0, "{lines}: {:?}", run.work);
        assert!((run.last()["x"] - alone.last()["x"]).abs() < 1e-14);
    }
    let felt = passing("0.1", between);
    assert!(felt.work.steps > 4 * alone.work.steps, "{:?} {:?}", felt.work, alone.work);
}
