//! Angles and values on the command line.

use super::{case, program};

/// What a run of the pendulum says with these options.
fn run(arguments: &[&str]) -> String {
    let path = format!("{}/../models/simple_pendulum.yaml", env!("CARGO_MANIFEST_DIR"));
    program(&[&["simulate", &path, "--no-digits", "--until", "0.1", "--json"], arguments].concat()).unwrap()
}

#[test]
fn degrees_on_the_command_line_are_warned_of() {
    let warns = |arguments: &[&str]| run(arguments).contains("looks like degrees; write `90 deg`, or `90 rad`");
    assert!(warns(&["--start", "theta=90"]));
    for start in ["theta=90 deg", "theta=90 rad", "theta=1.5", "theta'=90"] {
        assert!(!warns(&["--start", start]), "{start}");
    }
}

#[test]
fn a_parameter_may_be_set_by_an_expression_of_others() {
    let path = format!("{}/../models/two_masses_spring.yaml", env!("CARGO_MANIFEST_DIR"));
    let until = |set: &str| {
        let all = ["simulate", &path, "--no-digits", "--until", "1", "--csv", "-", "--set", "m1=3", "--set", set];
        program(&all).unwrap()
    };
    assert_eq!(until("m2=2*m1"), until("m2=6 kg"));
    assert_ne!(until("m2=2*m1"), until("m2=2"));
    let error = program(&["simulate", &path, "--set", "m2=2*k"]).unwrap_err();
    assert!(error.contains("E242"), "{error}");
}

/// What a start is to meet beside says nothing of the length of a rotation, which keeps its value: with a rate it grew until the run ended.
#[test]
fn a_searched_start_lets_lengths_of_rotations_be() {
    let text = |start: &str| {
        let body = "name: Thrown\nparameters: {m: 1 kg, l: 0.5 m}\ncoordinates: {turn: rotation}\nframes: {F: {rotate: turn}}\nbodies: {b: {mass: m, inertia: [0.1, 0.13, 0.15], frame: F, position: l/2*F.x}}\noutputs: {w: \"components(angular_velocity(b), F)\"}\n";
        format!("{body}scene: {{start: {{turn: [[y, 0.3]]{start}, until: 0.1}}\n")
    };
    let (searched, given) = (case(&text("}, also: {w: [1, 2, 3]}")).run(), case(&text(", turn': [1, 2, 3]}")).run());
    for run in [&searched, &given] {
        let start = run.first();
        let growth: f64 = start.q.iter().zip(&start.v).map(|(q, v)| q * v).sum();
        assert!(growth.abs() < 1e-12, "{growth:e}");
    }
    let apart = searched.last().v.iter().zip(&given.last().v).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-8, "{apart:e}");
}

/// Steps that overshoot find angles of many turns; the swing is the same some turns less, and is told so.
#[test]
fn an_unknown_angle_was_told_with_whole_turns_too_many() {
    let text = "name: P\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, u: 0 rad}\ncoordinates: {th: rad}\n\
        bodies: {b: {mass: m, position: \"l*[sin(th), -cos(th)]\"}}\ngravity: [0, -g]\n\
        outputs: {x: l*sin(th), y: -l*cos(th)}\nscene: {start: {th: 1 + u}, until: 1}\n";
    let file = super::folder("angles").join("turns.yaml");
    std::fs::write(&file, text).expect("a file");
    let solve = |unknown: &str, wanted: &str| -> serde_json::Value {
        let told = super::program(&[
            "solve",
            file.to_str().expect("a path"),
            "--unknown",
            unknown,
            "--such-that",
            wanted,
            "--json",
        ]);
        serde_json::from_str(&told.unwrap_or_else(|error| panic!("{unknown}: {error}"))).expect("JSON")
    };
    let value = |found: &serde_json::Value, name: &str| found["values"][name]["value"].as_f64().expect("a number");
    // Without its cure -94.55, -31.72, 87.66, 28.68 and -9.72.
    for guess in [1.5, 1.8, 1.9, 2.0, 2.1] {
        let found = solve(&format!("th={guess}"), "x=0.3");
        assert!((value(&found, "th") - guess).abs() <= std::f64::consts::PI, "{guess}: {found}");
        let found = solve(&format!("u={}", guess - 1.0), "x=0.3");
        assert!((value(&found, "u") - guess + 1.0).abs() <= std::f64::consts::PI, "{guess}: {found}");
    }
    // Where the angle itself is wanted at the end, its turns count.
    let found = solve("th=24.5", "th=25");
    assert!(value(&found, "th") > 18.0, "{found}");
}
