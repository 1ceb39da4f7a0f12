//! Fixed steps that are found for a tolerance: what happens only later, and within a part of a step, is not passed over in silence.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;

use program::{File, json};
use serde_json::Value;

/// A run of a file by a method, with these options: its last x, how many digits of it are promised, and all of it.
fn run(text: &str, options: &[&str]) -> (f64, u64, Value) {
    let file = File::new("found-steps", text);
    let found = json(&[&["simulate", &file.0], options].concat());
    (found["q"]["x"].as_f64().unwrap(), found["digits"]["x"].as_u64().unwrap(), found)
}

const BARRIER: &str = "name: Barrier\nparameters: {m: 1 kg, A: 0.2 J, w: 0.01 m, x1: 50 m}\ncoordinates: {x: m}\n\
    bodies: {b: {mass: m, position: \"[x, 0]\"}}\npotential_energy: A*exp(-((x - x1)/w)^2)\nscene: {start: {x: 0, x': 0.5}, until: 150}\n";

/// Half a joule's eighth does not climb a barrier of 0.2 J, a ten-thousandth of the way wide: the particle comes back to 25.00233 m.
#[test]
fn a_narrow_barrier_turns_a_particle_back_or_no_digit_is_promised() {
    for method in ["verlet", "gauss6", "kahanli8", "srkn4"] {
        let (x, digits, _) = run(BARRIER, &["--method", method]);
        let holds = (x - 25.0023315).abs() <= 25.0 * 10.0_f64.powi(1 - digits as i32);
        assert!(digits == 0 || holds, "{method}: {x} with {digits} digits");
    }
    // A step that was given is taken, and what it passes over is told.
    let (_, digits, given) = run(BARRIER, &["--method", "verlet", "--step", "0.3"]);
    assert!(digits == 0 && given["warnings"][0].as_str().unwrap().contains("passes over"), "{given}");
    let (_, digits, free) = run(BARRIER, &["--method", "gauss6", "--until", "60"]);
    assert!(digits > 10 && free["warnings"].as_array().unwrap().is_empty(), "{free}");
}

/// Where a motion begins by standing still, the step that suits it is found when it is pushed.
#[test]
fn a_motion_that_begins_later_has_a_step_of_its_own() {
    let text = "name: Late\nparameters: {m: 1 kg, k: 100 N/m, F: 3 N}\ncoordinates: {x: m}\ninputs: {u: F*step(t - 40 s)}\n\
        bodies: {b: {mass: m, position: \"[x, 0]\"}}\ngeneralized_forces: {x: -k*x + u}\nscene: {start: {x: 0}, until: 60}\n";
    for method in ["gauss4", "gauss6", "kahanli8"] {
        let (x, digits, found) = run(text, &["--method", method]);
        let exact = 0.03 * (1.0 - 200.0_f64.cos());
        assert!((x - exact).abs() < 1e-7 && digits >= 5, "{method}: {found}");
        assert!(found["work"]["steps"].as_u64().unwrap() > 400, "{method}: {found}");
    }
}
