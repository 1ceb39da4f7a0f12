//! What depends on time alone is known beforehand.

use std::sync::Arc;

use dalembert::mechanism::System;
use dalembert::{Cause, Method, Warning};

use crate::{coasting, file, particle, sprung};

#[test]
fn an_input_that_is_a_pulse_is_not_stepped_over() {
    let mut run = sprung(
        "inputs: {u: step(t-50) - step(t-53)}
forces: {f: {on: b, force: \"[F*u, 0]\"}}
scene: {start: {x: 0}, until: 100, tolerance: 1e-10}",
    )
    .run();
    let expected = 47.0_f64.cos() - 50.0_f64.cos();
    assert!((run.last()["x"] - expected).abs() < 1e-8, "{}", run.last());
    // The same pulse as a piece of the force.
    run = sprung(
        "forces: {f: {on: b, force: \"[F*(step(t-50) - step(t-53)), 0]\"}}
scene: {start: {x: 0}, until: 100, tolerance: 1e-10}",
    )
    .run();
    assert!((run.last()["x"] - expected).abs() < 1e-8, "{}", run.last());
}

#[test]
fn an_input_that_acts_as_a_generalized_force_is_a_pulse_too() {
    let run = particle(
        "inputs: {u: F*(step(t - 5) - step(t - 6))}
kinetic_energy: m*x'^2/2
generalized_forces: {x: u}
scene: {until: 10}",
    )
    .run();
    assert!((run.last()["x"] - 4.5).abs() < 1e-8, "{}", run.last());
}

#[test]
fn a_blow_of_a_millisecond_is_met() {
    let run = file(
        "name: Pulse
parameters: {m: 1 kg, k: 4 N/m, F: 1000 N, t1: 1 s, t2: 1.001 s}
coordinates: {x: m}
inputs: {blow: F*(step(t - t1) - step(t - t2))}
bodies: {p: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, on: p, along: [1, 0]}}
forces: {f: {on: p, force: \"[blow, 0]\"}}
balances: {equations: [{force: {of: [p], along: [1, 0]}}]}
scene: {start: {x: 0.1}, until: 2}",
    )
    .run();
    let expected = 0.1 * 4.0_f64.cos() + 250.0 * ((2.0 * 0.999_f64).cos() - 2.0_f64.cos());
    assert!((run.last()["x"] - expected).abs() < 1e-7, "{} {expected}", run.last());
}

const CAR: &str = "name: Bump
parameters: {ms: 320 kg, mu: 45 kg, ks: 22 kN/m, kt: 190 kN/m, cs: 1.5 kN*s/m, h: 10 cm, t1: 5 s, t2: 5.2 s}
coordinates: {zs: m, zu: m}
inputs: {road: ROAD}
bodies:
  body: {mass: ms, position: [0, zs]}
  wheel: {mass: mu, position: [0, zu]}
springs:
  strut: {stretch: zs - zu, stiffness: ks, on: body, from: wheel, along: [0, 1]}
  tyre: {stretch: zu - GROUND, stiffness: kt, on: wheel, along: [0, 1]}
dampers: {shock: {rate: zs' - zu', damping: cs, on: body, from: wheel, along: [0, 1]}}
scene: {until: 6}";

#[test]
fn a_wheel_meets_a_bump_in_the_road() {
    let bump = "h*(step(t - t1) - step(t - t2))";
    let car = |ground: &str| file(&CAR.replace("ROAD", bump).replace("GROUND", ground)).run();
    let (input, written) = (car("road"), car(bump));
    assert!(input.last()["zu"].abs() > 1e-4);
    for name in ["zs", "zu", "zs'", "zu'"] {
        assert!((input.last()[name] - written.last()[name]).abs() < 1e-8, "{name} {}", input.last());
    }
}

#[test]
fn energy_is_no_alarm_where_a_potential_is_switched() {
    let run = file(&CAR.replace("ROAD", "h*(step(t - t1) - step(t - t2))").replace("GROUND", "road")).run();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    let smooth = file(&CAR.replace("ROAD", "h*exp(-((t - t1)/(t2 - t1))^2)").replace("GROUND", "road")).run();
    assert!(smooth.warnings.is_empty(), "{:?}", smooth.warnings);
    let sign = sprung(
        "inputs: {u: \"F*sign(t)\"}
forces: {f: {on: b, force: \"[u, 0]\"}}
scene: {start: {x: 0}, until: 10}",
    )
    .run();
    assert!(sign.warnings.is_empty(), "{:?}", sign.warnings);
    assert!((sign.last()["x"] - (1.0 - 10.0_f64.cos())).abs() < 1e-7, "{}", sign.last());
}

const BASE: &str = "inputs: {base: \"BASE\"}
bodies: {b: {mass: m, position: \"[base + x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}
scene: {start: {x: 0}, until: 4, tolerance: 1e-10}";

#[test]
fn a_base_that_jumps_is_refused_and_one_that_turns_kicks() {
    let base = |text: &str| particle(&BASE.replace("BASE", text));
    let error = base("step(t-1)").try_run().unwrap_err();
    let Some(Cause::InfiniteForce { input, t }) = error.cause() else { panic!("{error}") };
    assert_eq!((input.as_str(), *t), ("base", 1.0));
    for (text, kick) in [("abs(t-1)", 2.0), ("max(0, t-1)", 1.0)] {
        let run = base(text).run();
        assert!((run.last()["x"] + kick * 3.0_f64.sin()).abs() < 1e-9, "{text}: {}", run.last());
        assert_eq!(run.impulses.len(), 1);
        assert!((run.impulses[0].jump[0] + kick).abs() < 1e-12);
        assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    }
    // A smooth base does nothing of the kind: x'' + x = sin t from rest.
    let run = base("sin(t)").run();
    assert!((run.last()["x"] - 0.5 * (4.0_f64.sin() - 4.0 * 4.0_f64.cos())).abs() < 1e-8, "{}", run.last());
    assert!(run.impulses.is_empty());
}

#[test]
fn the_kick_of_a_pivot_is_the_limit_of_sharper_and_sharper_turns() {
    let pendulum = |base: &str, until: &str| {
        file(&format!(
            "name: P
parameters: {{m: 1, l: 1, g: 9.81, d: 1e-4}}
coordinates: {{theta: 1}}
inputs: {{base: \"{base}\"}}
bodies: {{b: {{mass: m, position: \"[base + l*sin(theta), -l*cos(theta)]\"}}}}
gravity: [0, -g]
scene: {{start: {{theta: 0.3}}, until: {until}, tolerance: 1e-11}}"
        ))
        .run()
    };
    let sharp = pendulum("abs(t - 1)", "4");
    let smooth = pendulum("sqrt((t - 1)^2 + d^2)", "4");
    let difference = (sharp.last()["theta"] - smooth.last()["theta"]).abs();
    assert!(difference < 1e-2 && difference > 1e-8, "{difference:e}");
    assert!(sharp.impulses.len() == 1 && smooth.impulses.is_empty());
}

#[test]
fn a_damper_on_a_step_gives_the_impulse_of_its_jump() {
    let run = particle(
        "inputs: {road: 0.1*step(t - 1)}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
dampers: {d: {rate: x' - road', damping: 0.5, on: b, along: \"[1, 0]\"}}
scene: {start: {x: 0}, until: 3, tolerance: 1e-11}",
    )
    .run();
    // x' = 0.05 e^(−(t−1)/2) since then.
    let expected = 0.1 * (1.0 - (-1.0_f64).exp());
    assert!((run.last()["x"] - expected).abs() < 1e-10, "{}", run.last());
    assert_eq!(run.impulses.len(), 1);
}

#[test]
fn a_square_wave_loses_none_of_forty_thousand_edges() {
    let run = coasting(
        "forces: {f: {on: b, force: \"[F*sign(sin(2*pi*21*t)), 0]\"}}
scene: {start: {x: 0}, until: 1000, tolerance: 1e-10}",
    )
    .run();
    assert!((run.last()["x"] - 1000.0 / 84.0).abs() < 1e-7, "{}", run.last());
    // One step from edge to edge: 12 evaluations, 4 for its dense output, one to begin anew.
    assert!(run.work.evaluations < 18 * 42_000, "{}", run.work.evaluations);
}

#[test]
fn time_stops_hold_for_fixed_steps_and_other_methods() {
    for method in [Method::Rk4, Method::Dopri5] {
        let mut case = sprung(
            "inputs: {u: step(t-5) - step(t-5.3)}
forces: {f: {on: b, force: \"[F*u, 0]\"}}
scene: {start: {x: 0}, until: 10, tolerance: 1e-10}",
        );
        case.settings.method = method;
        case.settings.step = (method == Method::Rk4).then_some(0.01);
        let expected = 4.7_f64.cos() - 5.0_f64.cos();
        assert!((case.run().last()["x"] - expected).abs() < 1e-7);
    }
}

#[test]
fn switches_of_time_nested_in_each_other_are_stop_times() {
    let run = sprung(
        "forces: {f: {on: b, force: \"[F*max(0, 1-abs(t-3)), 0]\"}}
scene: {start: {x: 0}, until: 6, tolerance: 1e-10}",
    )
    .run();
    let expected = -4.0_f64.sin() + 2.0 * 3.0_f64.sin() - 2.0_f64.sin();
    assert!((run.last()["x"] - expected).abs() < 1e-9, "{}", run.last());
    // sign(sign(t − 3) − ½) jumps without a zero.
    let run = coasting(
        "forces: {f: {on: b, force: \"[F*sign(sign(t-3) - 0.5), 0]\"}}
scene: {start: {x: 0}, until: 6, tolerance: 1e-10}",
    )
    .run();
    assert!(run.last()["x'"].abs() < 1e-10 && (run.last()["x"] + 9.0).abs() < 1e-9, "{}", run.last());
}

/// An input that steps kicks a body that slides to the other side, where friction pulls the other way; the last one to rest, nearly.
#[test]
fn kicks_turn_friction_around() {
    for (kick, expected) in [(-3.0, -2.0), (-0.1, 0.0), (2.0, 2.0), (-0.5 - 1e-9, 0.0)] {
        let mut case = file(
            "name: P\nparameters: {m: 1, F: 1, kick: 1}\ncoordinates: {x: 1}\ninputs: {u: kick*step(t - 0.5)}\n\
             kinetic_energy: m*x'^2/2\ngeneralized_forces: {x: \"m*u' - F*sign(x')\"}\n\
             scene: {start: {x': 1}, until: 1, tolerance: 1e-8}",
        )
        .set("kick", kick);
        // What comes to rest stays there.
        let found = case.run().last()["x'"];
        assert!((found - expected).abs() < 1e-9, "{kick}: {found} and not {expected}");
    }
}

#[test]
fn inputs_that_are_closures_are_scanned_for_jumps() {
    let text = "name: P
parameters: {m: 1, k: 1, F: 1}
coordinates: {x: 1}
inputs: {u: 0}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}
forces: {f: {on: b, force: \"[F*u, 0]\"}}
scene: {start: {x: 0}, until: 100, tolerance: 1e-10}";
    let mut case = file(text);
    case.system.set_input(0, Arc::new(|t| [f64::from(u8::from((50.0..53.0).contains(&t))), 0.0, 0.0]));
    let expected = 47.0_f64.cos() - 50.0_f64.cos();
    let run = case.run();
    assert!((run.last()["x"] - expected).abs() < 1e-8, "{}", run.last());
    // What may have been missed is said, unless a longest step is given.
    let simulation = dalembert::Simulation::new(file(text).system).until(10.0);
    let run = simulation.input("u", Arc::new(|t| [t.sin(), t.cos(), -t.sin()])).run().unwrap();
    assert!(matches!(&run.warnings[..], [Warning::InputScanned { .. }]), "{:?}", run.warnings);
}

/// What the program writes for a file, or its complaint.
#[cfg(feature = "cli")]
fn program(name: &str, text: &str, options: &[&str]) -> serde_json::Value {
    let path = std::env::temp_dir().join(format!("dalembert-{}-{name}.yaml", std::process::id()));
    std::fs::write(&path, text).unwrap();
    let mut arguments =
        vec!["dalembert".to_owned(), "simulate".to_owned(), path.display().to_string(), "--json".to_owned()];
    arguments.extend(options.iter().map(|o| (*o).to_owned()));
    let mut out = Vec::new();
    let outcome = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    outcome.unwrap_or_else(|problem| panic!("{problem}"));
    serde_json::from_slice(&out).unwrap()
}

#[cfg(feature = "cli")]
#[test]
fn inputs_on_the_command_line_go_the_same_way() {
    let text = "name: P
parameters: {m: 1, k: 1, F: 1}
coordinates: {x: 1}
inputs: {u: 0}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}
forces: {f: {on: b, force: \"[F*u, 0]\"}}
scene: {start: {x: 0}, until: 100, tolerance: 1e-10}";
    let sharp = 47.0_f64.cos() - 50.0_f64.cos();
    let a = 0.5 * std::f64::consts::PI / 1e4;
    let inputs =
        [("step(t-50) - step(t-53)", sharp), ("(tanh(1e4*(t-50)) - tanh(1e4*(t-53)))/2", a / a.sinh() * sharp)];
    for (input, expected) in inputs {
        let found = program("pulse", text, &["--input", &format!("u={input}")]);
        let x = found["q"]["x"].as_f64().unwrap();
        assert!((x - expected).abs() < 1e-6, "{input}: {x} {expected}");
    }
}
