//! What `modes` warns of, in JSON as on a terminal.

use std::fs;

use serde_json::Value;

use super::{folder, program};

/// The warnings of `modes` for a model file's text, with further options.
fn warned(name: &str, text: &str, options: &[&str]) -> Vec<String> {
    let path = folder(name).join("model.yaml");
    fs::write(&path, text).expect("a file");
    let arguments = [&["modes", path.to_str().expect("a path"), "--json"], options].concat();
    let printed = program(&arguments).unwrap_or_else(|error| panic!("{error}"));
    let found: Value = serde_json::from_str(&printed).expect("JSON");
    let list = found["warnings"].as_array();
    list.into_iter().flatten().map(|warning| warning.as_str().expect("text").to_owned()).collect()
}

/// A stiffness by an integral whose peak narrows with w.
const PEAK: &str = r#"
name: Peak
parameters: {w: 0.1, a: 0.5}
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: "x^2/2*integral(exp(-((s - a)/w)^2), s in 0..1)"
scene: {start: {x: 1}, until: 10}
"#;

#[test]
fn an_integral_beyond_the_range_of_its_rule_was_not_told() {
    let told =
        |options: &[&str]| warned("integral", PEAK, options).iter().any(|text| text.contains("computed by a rule"));
    assert!(told(&["--set", "w=1e-3"]));
    assert!(told(&["--vary", "w=1e-3..1"]));
    assert!(!told(&[]));
    assert!(!told(&["--set", "w=0.12"]));
}

/// A pendulum on a cart that a force pushes.
const CART: &str = r#"
name: Cart
parameters: {M: 1 kg, m: 0.2 kg, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {x: m, a: rad}
inputs: {u: 0 N}
bodies: {cart: {mass: M, position: "[x, 0]"}, bob: {mass: m, position: "[x, 0] + l*[sin(a), cos(a)]"}}
gravity: [0, -g]
forces: {motor: {on: cart, force: "[u, 0]"}}
equilibrium: {a: 0}
"#;

#[test]
fn a_steady_answer_about_an_unstable_equilibrium_was_not_told() {
    let told = |start: &str| {
        let warnings = warned("drive", CART, &["--at", start, "--drive", "u", "--omega", "3"]);
        warnings.iter().any(|text| text.contains("unstable"))
    };
    assert!(told("a=0"));
    assert!(!told("a=180 deg"));
}

/// Mathieu's equation with the parametric term as an input.
fn mathieu(force: &str) -> String {
    format!(
        "name: Mathieu
parameters: {{m: 1 kg, k: 1 N/m, c: 0.1 N*s/m, w: 2 rad/s, l: 0.1 m}}
coordinates: {{x: m}}
inputs: {{u: cos(w*t)}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
generalized_forces: {{x: \"{force} - c*x'\"}}
scene: {{start: {{x: 0.01}}, until: 100}}
"
    )
}

#[test]
fn a_stiffness_that_an_input_varies_was_held_without_a_word() {
    let told = |force: &str| {
        warned("mathieu", &mathieu(force), &[])
            .iter()
            .any(|text| text.contains("parametric excitation") && text.contains("`u`"))
    };
    assert!(told("-k*(1 + 0.5*u)*x"));
    assert!(told("-k*(1 + u)*x"));
    // An input that only pushes varies no matrix.
    assert!(!told("-k*x + k*l*u"));
}
