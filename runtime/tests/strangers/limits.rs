//! Limits of friction that are none: negative ones drove, and those of sticking below those of sliding were called a jam.

use dalembert::{Cause, Error, Run};

use super::{Case, case};

/// Why a run fails, and when.
fn cause(mut case: Case) -> (Cause, f64) {
    let Err(Error::Run(failure)) = case.try_run() else { panic!("an end") };
    (failure.cause.clone(), failure.state.t)
}

fn x(run: &Run) -> f64 {
    run.last()["x"]
}

/// A collar on a rod that is lifted: N = m g − F is negative.
const COLLAR: &str = r#"
name: Collar
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.2, F: 30 N}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {lift: {on: b, force: "[0, F]"}}
constraints: {rod: y}
friction: {rub: {rate: x', on: b, along: "[1, 0]", limit: mu*reaction(rod)}}
scene: {start: {x: 0, x': 1}, until: 2, tolerance: 1e-10}
"#;

#[test]
fn a_limit_that_is_negative_drove() {
    let (cause, t) = cause(case(COLLAR));
    let Cause::NegativeLimit { friction, limit, is_coefficient: false } = cause else { panic!("{cause}") };
    assert!(friction == "rub" && (limit + 4.0).abs() < 1e-12 && t == 0.0, "{friction} {limit} {t}");
    // x' = 1 m/s is stopped by μ |m g − F|: where the rod carries, as before; with the force across written out; with a contact for each side.
    assert!((x(&case(&COLLAR.replace("F: 30", "F: 5")).run()) - 0.5).abs() < 1e-9);
    assert!((x(&case(&COLLAR.replace("mu*reaction(rod)", "mu*abs(m*g - F)")).run()) - 0.125).abs() < 1e-9);
    let sides = COLLAR.replace("constraints: {rod: y}\n", "").replace(
        "friction: {rub: {rate: x', on: b, along: \"[1, 0]\", limit: mu*reaction(rod)}}",
        "contacts:\n  below: {gap: y, on: b, normal: \"[0, 1]\", friction: mu}\n  \
         above: {gap: -y, on: b, normal: \"[0, -1]\", friction: mu}",
    );
    assert!((x(&case(&sides).run()) - 0.125).abs() < 1e-9);
    assert!((x(&case(&sides.replace("F: 30", "F: 5")).run()) - 0.5).abs() < 1e-9);
}

/// A brake that is taken away.
const BRAKE: &str = r#"
name: Brake
parameters: {m: 1 kg, b: 2 N, w: 2 rad/s, v: 3 m/s}
coordinates: {x: m}
inputs: {p: cos(w*t)}
bodies: {b1: {mass: m, position: "[x, 0]"}}
friction: {rub: {rate: x', on: b1, along: "[1, 0]", limit: b*p}}
scene: {start: {x: 0, x': v}, until: 1.5, tolerance: 1e-10}
"#;

#[test]
fn a_limit_that_becomes_negative_ends_the_run() {
    let quarter = std::f64::consts::FRAC_PI_4;
    let (cause, t) = cause(case(BRAKE));
    assert!(
        matches!(cause, Cause::NegativeLimit { limit, .. } if limit < 0.0) && t > quarter && t < 1.5,
        "{cause} {t}"
    );
    // Until there b/w sin(w t) is taken of v; with `max` nothing from there on.
    let run = case(&BRAKE.replace("until: 1.5", &format!("until: {}", quarter - 1e-3))).run();
    assert!((run.last()["x'"] - (3.0 - (2.0 * (quarter - 1e-3)).sin())).abs() < 1e-9);
    let run = case(&BRAKE.replace("b*p", "\"b*max(0, p)\"")).run();
    assert!((run.last()["x'"] - 2.0).abs() < 1e-9, "{}", run.last()["x'"]);
}

/// A block on rough ground.
const BLOCK: &str = r#"
name: Block
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.2, mus: 0.2, F: 1.5 N}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {f: {on: b, force: "[F, 0]"}}
contacts: {floor: {gap: y, on: b, normal: "[0, 1]", friction: mu, static: mus}}
scene: {start: {x: 0, y: 0}, until: 1, tolerance: 1e-10}
"#;

#[test]
fn a_coefficient_that_is_negative_is_refused() {
    let (cause, _) = cause(case(&BLOCK.replace("mu: 0.2", "mu: -0.1")));
    assert!(
        matches!(cause, Cause::NegativeLimit { limit, is_coefficient: true, .. } if (limit + 0.1).abs() < 1e-12),
        "{cause}"
    );
    // Where nothing touches none is asked for.
    assert!(case(&BLOCK.replace("mu: 0.2", "mu: -0.1").replace("y: 0}", "y: 100}")).try_run().is_ok());
}

#[test]
fn sticking_below_sliding_was_called_a_jam() {
    let low = BLOCK.replace("mus: 0.2", "mus: 0.1");
    for text in [low.clone(), low.replace("y: 0}", "y: 1}"), low.replace("x: 0,", "x: 0, x': 3,")] {
        let (cause, t) = cause(case(&text.replace("until: 1,", "until: 2,")));
        let Cause::StaticBelowLimit { friction, sticking, sliding, is_coefficient: true } = cause else {
            panic!("{cause}")
        };
        assert!(friction == "floor" && (sticking - 0.1).abs() < 1e-12 && (sliding - 0.2).abs() < 1e-12 && t < 1.0);
    }
    let rub = "friction: {rub: {rate: x', on: b, along: \"[1, 0]\", limit: 2 N, static: 1 N}}\nconstraints: {rod: y}";
    let text =
        BLOCK.lines().map(|line| if line.starts_with("contacts") { rub } else { line }).collect::<Vec<_>>().join("\n");
    let (cause, _) = cause(case(&text));
    assert!(matches!(cause, Cause::StaticBelowLimit { sliding: 2.0, is_coefficient: false, .. }), "{cause}");
    // Equal ones, and a larger one, hold 1.5 N of 2 N.
    for mus in ["0.2", "0.3"] {
        assert_eq!(x(&case(&BLOCK.replace("mus: 0.2", &format!("mus: {mus}"))).run()), 0.0);
    }
}
