//! Named reactions have all digits at every scale.

use dalembert::{Enforcement, Warning};

use super::{case, program, simulation, text_of};

/// The outputs at the end of a run.
fn outputs(arguments: &[&str]) -> serde_json::Value {
    let text = program(&[&["simulate"], arguments, &["--json"]].concat()).unwrap_or_else(|error| panic!("{error}"));
    serde_json::from_str::<serde_json::Value>(&text).expect("JSON")["outputs"].take()
}

/// What two outputs differ by, in parts of the larger one.
fn difference(outputs: &serde_json::Value, names: [&str; 2]) -> f64 {
    let numbers = |value: &serde_json::Value| match value.as_array() {
        Some(components) => components.iter().filter_map(serde_json::Value::as_f64).collect(),
        None => vec![value.as_f64().expect("a number")],
    };
    let [x, y]: [Vec<f64>; 2] = names.map(|name| numbers(&outputs[name]));
    assert_eq!(x.len(), y.len());
    let size = x.iter().chain(&y).fold(0.0, |size: f64, x| size.max(x.abs()));
    x.iter().zip(&y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / size
}

#[test]
fn a_pins_force_is_its_constraints_multiplier_whatever_the_lengths() {
    let path = format!("{}/../models/four_bar.yaml", env!("CARGO_MANIFEST_DIR"));
    for scale in [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6_f64] {
        // The same motion, with times as the root of the lengths.
        let set = |name: &str, factor: f64| format!("{name}={}", factor * scale);
        let lengths = [set("ground_length", 4.0), set("crank", 1.0), set("coupler", 4.0), set("rocker", 3.0)];
        let (speed, until) = (format!("crank_angle'={}", 2.0 / scale.sqrt()), scale.sqrt().to_string());
        let mut arguments = vec![path.as_str(), "--until", &until, "--start", &speed];
        arguments.extend(lengths.iter().flat_map(|length| ["--set", length]));
        let found = difference(&outputs(&arguments), ["pin", "at_C"]);
        assert!(found < 1e-13, "{scale}: {found}");
    }
}

#[test]
fn a_fixed_end_holds_force_and_moment_whatever_the_lengths() {
    // A bar on a slide, clamped to a frame that turns: F = m a, M = F × arm, of a file in its own lengths.
    let text = text_of("clamped_bar");
    for scale in ["1e-6", "1e-3", "1e3", "1e6"] {
        let file = super::folder("clamped").join(format!("clamped_{scale}.yaml"));
        std::fs::write(&file, text.replace("1e0", scale)).expect("written");
        let outputs = outputs(&[file.to_str().expect("a path")]);
        assert!(difference(&outputs, ["holding", "force"]) < 1e-13, "{scale}: {outputs}");
        assert!(difference(&outputs, ["clamp", "moment"]) < 1e-13, "{scale}: {outputs}");
    }
}

/// A door on two hinges: how they share its weight and its swing is not determined, what they hold together is.
#[test]
fn reactions_that_only_a_sum_determines_are_warned_of() {
    let door = |second: &str, outputs: &str| {
        format!(
            "name: Door\nparameters: {{m: 20 kg, w: 0.8 m, h: 1 m, g: 9.81 m/s^2}}\ncoordinates: {{x: m, y: m, z: m, A: rotation}}
frames: {{F: {{rotate: A}}}}\npoints: {{C: \"[x, y, z]\"}}\nbodies: {{door: {{mass: m, inertia: [1.7, 1.1, 2.8], frame: F, position: C}}}}
gravity: [0, 0, -g]\njoints: {{up: {{hinge: [door, ground], at: [C - w/2*F.x + h*F.z, \"[0, 0, h]\"], axis: [F.z, ground.z]}}{second}}}
outputs: {{U: reaction(up){outputs}}}\nscene: {{start: {{A': [0, 0, 2]}}, guess: {{x: 0.4}}, until: 0.5}}\n"
        )
    };
    let told = |text: &str| {
        let run = case(text).run();
        let told = run.warnings.iter().find_map(|warning| match warning {
            Warning::ReactionsNotUnique { outputs } => Some(outputs.clone()),
            _ => None,
        });
        told.unwrap_or_default()
    };
    let second = ", lo: {hinge: [door, ground], at: [C - w/2*F.x - h*F.z, \"[0, 0, -h]\"], axis: [F.z, ground.z]}";
    let both = told(&door(second, ", S: reaction(up) + reaction(lo)"));
    assert_eq!(both, ["U.x", "U.y", "U.z"]);
    assert_eq!(told(&door("", "")), [""; 0]);
}

/// A block between guides that press twice: what friction takes depends on which of both presses where their coefficients differ.
#[test]
fn a_motion_that_a_share_decides_is_one_of_several() {
    let block = |rough: [f64; 2], twice: &str| {
        format!(
            "name: Guided\nparameters: {{m: 2 kg, mu1: {}, mu2: {}, g: 9.81 m/s^2}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{b: {{mass: m, position: '[x, y]'}}}}\ngravity: [0, -g]\nconstraints: {{c1: y{twice}}}\n\
             forces:\n  f1: {{on: b, force: '[-mu1*reaction(c1), 0]'}}\n  f2: {{on: b, force: '[-mu2*2*reaction({}), 0]'}}\n\
             scene: {{start: {{x': 3}}, until: 0.4}}\n",
            rough[0],
            rough[1],
            if twice.is_empty() { "c1" } else { "c2" }
        )
    };
    let told = |text: &str| {
        let run = case(text).run();
        let told = run.warnings.iter().find_map(|warning| match warning {
            Warning::MotionNotUnique { constraints, .. } => Some(constraints.clone()),
            _ => None,
        });
        told.unwrap_or_default()
    };
    assert_eq!(told(&block([0.1, 0.5], ", c2: 2*y")), ["c1", "c2"]);
    // Alike, or alone, they leave the motion as it is.
    assert_eq!(told(&block([0.3, 0.3], ", c2: 2*y")), [""; 0]);
    assert_eq!(told(&block([0.1, 0.5], "")), [""; 0]);
}

/// How guides of which there are too many share a weight is a rule: what the slope of a share is no equation says, and none is told.
#[test]
fn shares_have_no_slopes() {
    let slopes = simulation(&text_of("tray")).slopes(&["g"]).expect("slopes");
    assert!(slopes.get("one", "g").is_some_and(|slope| slope.value.is_nan()));
    // The guides carry m g together.
    assert!(
        slopes.get("all", "g").is_some_and(|slope| (slope.value - 2.0).abs() < 1e-9),
        "{:?}",
        slopes.get("all", "g")
    );
}

/// Rows that depend on each other share a force by one rule, whichever way the accelerations come.
#[test]
fn shares_by_the_null_space_are_those_by_multipliers() {
    let by = |enforcement: Enforcement| {
        let mut case = case(&text_of("tray"));
        case.settings.enforcement = enforcement;
        let run = case.run();
        run.last()["one"]
    };
    let (by_multipliers, by_null_space) = (by(Enforcement::Multipliers), by(Enforcement::NullSpace));
    assert!(by_multipliers.abs() > 0.1, "{by_multipliers}");
    assert!((by_null_space - by_multipliers).abs() < 1e-9 * by_multipliers.abs(), "{by_null_space} {by_multipliers}");
}
