//! Charts, axes, pictures, the command line.

use super::{folder, program};

/// The path of a model of the library.
fn model(name: &str) -> String {
    format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn quantities_of_several_units_have_an_axis_each() {
    let path = folder("axes").join("axes.svg");
    let file = path.to_str().unwrap();
    let arguments = ["simulate", &model("cart_pendulum"), "--no-digits", "--until", "1", "--plot", file];
    program(&[&arguments[..], &["--show", "x,theta,theta',x'"]].concat()).unwrap();
    let svg = std::fs::read_to_string(&path).unwrap();
    for label in ["x (m)", "theta (rad)", "theta' (rad/s)", "x' (m/s)"] {
        assert!(svg.contains(label) || svg.contains(&label.replace('\'', "&apos;")), "{label}");
    }
}

#[test]
fn a_table_goes_to_standard_output_alone() {
    let arguments =
        ["simulate", &model("simple_pendulum"), "--no-digits", "--until", "1", "--every", "0.5", "--csv", "-"];
    let table = program(&arguments).unwrap();
    assert!(table.starts_with("t,theta,theta'"), "{table}");
    assert_eq!(table.lines().count(), 4, "{table}");
    assert!(!std::path::Path::new("-").exists());
}

#[test]
fn several_files_are_checked_and_all_are_looked_at() {
    let (good, other) = (model("simple_pendulum"), model("bead_parabola"));
    let text = program(&["check", &good, &other]).unwrap();
    assert!(text.contains("simple_pendulum: 1 coordinate") && text.contains("bead_parabola: 1 coordinate"), "{text}");
    let error = program(&["check", "nowhere.yaml", &good]).unwrap_err();
    assert!(error.contains("nowhere.yaml"), "{error}");
}

#[test]
fn several_drives_may_stand_in_one_option() {
    let of = |drives: &[&str]| program(&[&["modes", &model("forced_chain"), "--omega", "3"], drives].concat()).unwrap();
    assert_eq!(of(&["--drive", "push1,push2=2"]), of(&["--drive", "push1", "--drive", "push2=2"]));
}
