//! Angles and values on the command line.

use super::program;

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
