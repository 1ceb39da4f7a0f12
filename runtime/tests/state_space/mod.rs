//! x' = A x + B u, y = C x + D u as files: against frequency responses, and motions that inputs do not reach.

use std::fs;

use nalgebra::{Complex, DMatrix};
use serde_json::Value;

use super::program::{File, json, near, run};

/// A mass on a base that moves: x', and x'', of the base act through damper and accelerometer.
const BASE: &str = "name: Base\nparameters: {m: 2 kg, c: 3 N*s/m, k: 50 N/m, Y: 0.1 m, w: 4 rad/s}\n\
                    coordinates: {x: m}\ninputs: {base: Y*cos(w*t)}\nbodies: {b: {mass: m, position: \"[x + base, 0]\"}}\n\
                    springs: {s: {stretch: x, stiffness: k}}\ndampers: {d: {rate: x' + base'/2, damping: c}}\n\
                    outputs: {seen: \"x'' + base''\", place: x + base}\nscene: {start: {x: 0}, until: 1}\n";

/// The file that `modes --state-space` writes.
fn written(name: &str, file: &str, more: &[&str]) -> Value {
    let path = std::env::temp_dir().join(format!("dalembert-{}-{name}.json", std::process::id()));
    let path = path.to_string_lossy().into_owned();
    let arguments = [&["modes", file, "--state-space", &path], more].concat();
    run(&arguments).unwrap_or_else(|error| panic!("{error}"));
    let text = fs::read_to_string(&path).expect("a file");
    fs::remove_file(&path).expect("a file that goes");
    serde_json::from_str(&text).expect("JSON")
}

fn matrix(list: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = serde_json::from_value(list.clone()).expect("rows");
    DMatrix::from_fn(rows.len(), rows.first().map_or(0, Vec::len), |i, j| rows[i][j])
}

/// Of each answer C (iΩ − A)⁻¹ B + D, where inputs after the first are its rates.
fn transfer(found: &Value, omega: f64) -> Vec<Complex<f64>> {
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|name| matrix(&found[name]).map(Complex::from));
    let s = Complex::new(0.0, omega);
    let resolvent = (DMatrix::identity(a.nrows(), a.nrows()) * s - a).lu();
    let gains = c * resolvent.solve(&b).expect("no resonance") + d;
    (0..gains.nrows()).map(|i| (0..gains.ncols()).map(|k| gains[(i, k)] * s.powu(k as u32)).sum()).collect()
}

#[test]
fn transfer_functions_are_frequency_responses() {
    let base = File::new("base", BASE);
    let four_bar = format!("{}/../models/four_bar.yaml", env!("CARGO_MANIFEST_DIR"));
    for (name, file, drive, answers) in [
        ("base", base.0.as_str(), "base", "x,x',seen,place"),
        ("four_bar", &four_bar, "crank_angle", "crank_angle,rocker_angle'"),
    ] {
        let found = written(name, file, &["--in", drive, "--out", answers]);
        let response = json(&["modes", file, "--drive", drive, "--response", answers, "--range", "0.5..9"]);
        let omegas = response["response"]["omega"].as_array().expect("frequencies");
        for k in (0..omegas.len()).step_by(37) {
            let expected = transfer(&found, omegas[k].as_f64().expect("a frequency"));
            for (answer, expected) in answers.split(',').zip(expected) {
                let pair = &response["response"]["amplitude"][answer][k];
                near(&pair[0], expected.re, 1e-11 * (1.0 + expected.norm()));
                near(&pair[1], expected.im, 1e-11 * (1.0 + expected.norm()));
            }
        }
    }
}

#[test]
fn names_and_units_stand_beside_the_matrices() {
    let base = File::new("base_names", BASE);
    let found = written("names", &base.0, &["--out", "seen"]);
    assert_eq!(found["states"], serde_json::json!(["x", "x'"]));
    assert_eq!(found["state_units"], serde_json::json!(["m", "m/s"]));
    assert_eq!(found["inputs"], serde_json::json!(["base", "base'", "base''"]));
    assert_eq!(found["input_units"], serde_json::json!(["m", "m/s", "m/s^2"]));
    assert_eq!(found["output_units"], serde_json::json!(["m/s^2"]));
    // 2 (x'' + base'') = −50 x − 3 (x' + base'/2): what the base's acceleration does to x'' and what it adds cancel.
    for (name, expected) in [("A", &[0.0, -25.0, 1.0, -1.5][..]), ("C", &[-25.0, -1.5]), ("D", &[0.0, -0.75, 0.0])] {
        for (found, expected) in matrix(&found[name]).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-13, "{name}: {found}");
        }
    }
}

/// L i' = u − R i − K ω, J ω' = K i − b ω.
#[test]
fn states_of_first_order_are_among_them() {
    let motor = File::new(
        "motor_states",
        "name: Motor\nparameters: {L: 0.5 H, R: 2 ohm, K: 0.1 V*s, J: 0.01 kg*m^2, b: 0.001 N*m*s}\n\
         coordinates: {phi: rad}\ninputs: {u: 0 V}\nstates: {i: {unit: A, rate: \"(u - R*i - K*phi')/L\"}}\n\
         kinetic_energy: J*phi'^2/2\ngeneralized_forces: {phi: \"K*i - b*phi'\"}\noutputs: {rate: \"phi''\", voltage: R*i}\n\
         scene: {start: {phi: 0}, until: 1}\n",
    );
    let found = written("motor", &motor.0, &["--out", "i,rate,voltage"]);
    assert_eq!(found["states"], serde_json::json!(["phi", "phi'", "i"]));
    assert_eq!(found["state_units"], serde_json::json!(["rad", "rad/s", "A"]));
    assert_eq!(found["input_units"], serde_json::json!(["V"]));
    let expected = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 1.0, 0.0, -0.1, 10.0, 0.0, 0.0, 2.0]);
    assert!((matrix(&found["C"]) - expected).amax() < 1e-14, "{}", found["C"]);
    assert_eq!(matrix(&found["D"]).amax(), 0.0);
    assert_eq!(matrix(&found["B"]).as_slice(), [0.0, 0.0, 2.0]);
}

/// Of two masses between three alike springs a force on both alike reaches one mode, and their distance shows the other.
#[test]
fn motions_that_are_not_reached_or_shown_are_named() {
    let masses = File::new(
        "masses",
        "name: Masses\nparameters: {m: 1 kg, k: 4 N/m}\ncoordinates: {x: m, y: m}\ninputs: {push: 0 N}\n\
         kinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*(x^2 + (y - x)^2 + y^2)/2\n\
         generalized_forces: {x: push, y: push}\noutputs: {apart: y - x}\nscene: {start: {x: 1}, until: 1}\n",
    );
    let path = std::env::temp_dir().join(format!("dalembert-{}-masses.csv", std::process::id()));
    let path = path.to_string_lossy().into_owned();
    let told = |more: &[&str]| run(&[&["modes", &masses.0, "--state-space", &path], more].concat()).expect("modes");
    let both = told(&["--out", "apart"]);
    assert!(both.contains("inputs do not reach 1 motion at 0 ± 3.4641i 1/s"), "{both}");
    assert!(both.contains("outputs do not show 1 motion at 0 ± 2i 1/s"), "{both}");
    let table = fs::read_to_string(&path).expect("a table");
    assert_eq!(table.lines().next(), Some("row,x,y,x',y',push"));
    assert_eq!(table.lines().count(), 6);
    // The same on standard output, in the place of the report.
    let printed = run(&["modes", &masses.0, "--state-space", "-", "--out", "apart"]).expect("matrices");
    let printed: serde_json::Value = serde_json::from_str(&printed).expect("JSON");
    assert_eq!(printed["A"].as_array().map(Vec::len), Some(4), "{printed}");
    let one = told(&["--in", "x"]);
    assert!(one.contains("inputs reach all motions") && one.contains("outputs show all motions"), "{one}");
    fs::remove_file(&path).expect("a file that goes");
    let script = run(&["modes", &masses.0, "--state-space", &path.replace(".csv", ".xls")]).expect_err("a refusal");
    assert!(script.contains("`.npz`"), "{script}");
}

/// m x'' = p + push − k x − c x' beside a filter of p, and a jet along (cos, sin) of a state and a held value, which are 0 and 0.75 at rest.
#[test]
fn forces_and_coordinates_are_inputs_beside_states_too() {
    let pushed = File::new(
        "pushed_state",
        "name: Pushed\nparameters: {m: 2 kg, k: 8 N/m, c: 1 N*s/m, tau: 0.5 s, f: 3 N, g: 4 N}\n\
         coordinates: {x: m, y: m}\nstates: {p: {unit: N, rate: \"-p/tau\"}}\nmemory: {beta: 0.25 rad}\n\
         bodies: {b: {mass: m, position: \"[x, y]\"}}\npotential_energy: k*(x^2 + y^2)/2\ndampers: {d: {rate: x', damping: c}}\n\
         forces: {motor: {on: b, force: \"[p, 0]\"}, push: {on: b, force: \"[f, g]\"}, \
         jet: {on: b, force: \"[f*cos(beta), f*sin(beta)]\"}}\noutputs: {seen: x''}\nscene: {start: {x: 0}, until: 1}\n",
    );
    let found = written("pushed", &pushed.0, &["--in", "motor,push,jet,y", "--out", "seen,p", "--at", "beta=0.75"]);
    assert_eq!(found["inputs"], serde_json::json!(["motor", "push", "jet", "a force on y"]));
    assert_eq!(found["input_units"], serde_json::json!(["N", "N", "N", "N"]));
    let (sine, cosine) = 0.75_f64.sin_cos();
    let forces = [0.5, 0.0, 0.3, 0.4, 0.5 * cosine, 0.5 * sine, 0.0, 0.5];
    let b = matrix(&found["B"]);
    assert!((b.rows(2, 2) - DMatrix::from_column_slice(2, 4, &forces)).amax() < 1e-15, "{b}");
    assert_eq!((b.rows(0, 2).amax(), b.row(4).amax()), (0.0, 0.0));
    assert!((matrix(&found["D"]).row(0) - b.row(2)).amax() < 1e-15, "{}", found["D"]);
    let path = std::env::temp_dir().join(format!("dalembert-{}-state.json", std::process::id()));
    let refused = run(&["modes", &pushed.0, "--state-space", &path.to_string_lossy(), "--in", "p"]);
    let refused = refused.expect_err("a state is pushed by nothing");
    assert!(refused.contains("no input, force or coordinate is called `p`"), "{refused}");
}

/// A bob on a rod below a cart that rests at a right angle: (M, m) moved by forces along s and along x alone, M s'' = f + p and m l θ'' = f_x where
/// the rod hangs straight down, x = s + l θ.
#[test]
fn forces_are_inputs_beside_states_and_constraints() {
    let hanging = File::new(
        "hanging_state",
        "name: Hanging\nparameters: {m: 2 kg, M: 3 kg, l: 1 m, tau: 0.5 s, g: 10 m/s^2, k: 8 N/m, f: 0 N}\n\
         coordinates: {x: m, y: m, s: m}\nstates: {p: {unit: N, rate: -p/tau}}\n\
         bodies: {cart: {mass: M, position: \"[s, 0]\"}, bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\n\
         springs: {spring: {stretch: s, stiffness: k}}\nconstraints: {rod: (x - s)^2 + y^2 - l^2}\n\
         forces: {motor: {on: cart, force: \"[p, 0]\"}, push: {on: bob, force: \"[f, 0]\"}}\n\
         outputs: {pull: reaction(rod)}\nscene: {start: {x: 0, y: -1, s: 0}, until: 1}\n",
    );
    let found = written("hanging", &hanging.0, &["--in", "motor,push,s", "--out", "x,p"]);
    assert_eq!(found["states"], serde_json::json!(["x", "s", "x'", "s'", "p"]));
    // The rod's height changes by second order only: to first order each mass takes its own force.
    let expected = DMatrix::from_row_slice(2, 3, &[0.0, 0.5, 0.0, 1.0 / 3.0, 0.0, 1.0 / 3.0]);
    assert!((matrix(&found["B"]).rows(2, 2) - expected).amax() < 1e-14, "{}", found["B"]);
    // 2 y λ = m g − f_y at y = −1.
    let pulled = written("pulled", &hanging.0, &["--in", "y", "--out", "pull"]);
    assert!((matrix(&pulled["D"])[0] - 0.5).abs() < 1e-14, "{}", pulled["D"]);
}
