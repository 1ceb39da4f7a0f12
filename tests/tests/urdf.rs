//! Robots imported from URDF, against what `tests/urdf/reference.py` computes from the same files in 40 digits.

use dalembert::cli;
use dalembert::mechanism::{At, Interpreted, System};
use dalembert_symbolic::lower::compile;
use serde_json::Value;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf");

/// What `import` writes.
fn imported(robot: &str, options: &[&str]) -> String {
    let mut out = Vec::new();
    let path = format!("{FOLDER}/{robot}.urdf");
    let arguments = [&["dalembert", "import", &path, "-o", "-"], options].concat();
    cli::run(&[], arguments, &mut out).unwrap_or_else(|problem| panic!("{problem}"));
    String::from_utf8(out).expect("text")
}

/// The same as a system, which `check` accepts without a warning.
fn system(text: &str) -> Interpreted {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}\n{problems:?}"));
    assert!(program.model.warnings.is_empty(), "{:?}", program.model.warnings);
    Interpreted::new(program, text)
}

fn reference() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/reference/urdf.json");
    serde_json::from_str(&std::fs::read_to_string(path).expect("the reference")).expect("JSON")
}

fn numbers(list: &Value) -> Vec<f64> {
    let number = |x: &Value| x.as_str().expect("a number as text").parse().expect("a number");
    list.as_array().expect("a list").iter().map(number).collect()
}

fn number(value: &Value) -> f64 {
    value.as_str().expect("a number as text").parse().expect("a number")
}

#[track_caller]
fn near(found: f64, expected: f64, scale: f64, within: f64) {
    assert!((found - expected).abs() <= within * scale, "{found} is not {expected}, {:e} off", found - expected);
}

/// Energies are told to a constant: potential energy by the difference from where all is zero.
fn energies(system: &Interpreted, q: &[f64], v: &[f64]) -> [f64; 2] {
    let energy = system.energy(At::new(0.0, q, v));
    [energy.kinetic, energy.potential]
}

fn follows(robot: &str) {
    let system = system(&imported(robot, &[]));
    let description = system.description();
    let reference = reference();
    let n = reference[robot]["joints"].as_array().expect("joints").len();
    assert_eq!(system.len(), n);
    let states = reference[robot]["states"].as_array().expect("states");
    assert_eq!(states.len(), 2);
    for state in states {
        let (q, v) = (numbers(&state["q"]), numbers(&state["v"]));
        let mut values = vec![0.0; description.mass_pattern.len()];
        system.mass_matrix(At::place(0.0, &q), &mut values);
        let expected: Vec<Vec<f64>> = state["mass_matrix"].as_array().expect("rows").iter().map(numbers).collect();
        let mut found = vec![vec![0.0; n]; n];
        for (&(i, j), value) in description.mass_pattern.iter().zip(values) {
            (found[i as usize][j as usize], found[j as usize][i as usize]) = (value, value);
        }
        for i in 0..n {
            for j in 0..n {
                let scale = (expected[i][i] * expected[j][j]).sqrt();
                near(found[i][j], expected[i][j], scale, 1e-14);
            }
        }
        let mut a = vec![0.0; n];
        system.accelerations(At::new(0.0, &q, &v), &mut a).expect("a regular mass matrix");
        let expected = numbers(&state["accelerations"]);
        let scale = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        a.iter().zip(&expected).for_each(|(found, expected)| near(*found, *expected, scale, 1e-12));
        let [kinetic, potential] = energies(&system, &q, &v);
        let [expected, height] = [number(&state["kinetic_energy"]), number(&state["potential_energy"])];
        near(kinetic, expected, expected, 1e-14);
        near(potential, height, height.abs(), 1e-13);
    }
}

#[test]
fn an_arm_of_six_joints_has_the_mass_matrix_of_its_file() {
    follows("arm6");
}

/// Prismatic joints, axes that are none of the frame's, damping on a link without mass, joints that mimic.
#[test]
fn a_crane_with_a_gripper_has_the_mass_matrix_of_its_file() {
    follows("crane");
}

/// A floating joint with a planar one on it and a fixed body.
#[test]
fn a_raft_has_the_energies_of_its_file() {
    let system = system(&imported("buoys", &[]));
    let reference = reference();
    let (q, v) = (numbers(&reference["buoys"]["q"]), numbers(&reference["buoys"]["v"]));
    let [kinetic, potential] = energies(&system, &q, &v);
    let [expected, height] = ["kinetic_energy", "potential_energy"].map(|name| number(&reference["buoys"][name]));
    near(kinetic, expected, expected, 1e-13);
    near(potential, height, height.abs(), 1e-13);
}

/// What is imported runs at once, by both derivations.
#[test]
fn what_is_imported_runs_and_its_derivations_agree() {
    for robot in ["arm6", "crane", "buoys"] {
        let path = std::env::temp_dir().join(format!("dalembert-urdf-{}-{robot}.yaml", std::process::id()));
        std::fs::write(&path, imported(robot, &[])).expect("a file");
        let file = path.to_string_lossy();
        let mut out = Vec::new();
        let arguments = ["dalembert", "simulate", &file, "--until", "0.2", "--by", "all"];
        cli::run(&[], arguments, &mut out).unwrap_or_else(|problem| panic!("{robot}: {problem}"));
        let text = String::from_utf8(out).expect("text");
        let line = text.lines().find(|line| line.starts_with("balances")).unwrap_or_else(|| panic!("{text}"));
        let difference: f64 = line.split_whitespace().nth(2).and_then(|word| word.parse().ok()).expect("a difference");
        assert!(difference < 1e-9, "{robot}: {text}");
        std::fs::remove_file(&path).expect("removed");
    }
}

/// A robot that nothing holds: six degrees of freedom more, and the weight of its root.
#[test]
fn a_floating_root_moves() {
    let text = imported("arm6", &["--floating"]);
    assert!(text.contains("base_attitude: rotation") && text.contains("base_link: {mass: m_base_link"), "{text}");
    let system = system(&text);
    assert_eq!(system.len(), 6 + 3 + 4);
    let (mut q, v) = (vec![0.0; 13], vec![0.0; 13]);
    q[system.description().coordinates.iter().position(|one| one.name == "base_attitude.w").expect("w")] = 1.0;
    let mut a = vec![0.0; 13];
    system.accelerations(At::new(0.0, &q, &v), &mut a).expect("a regular mass matrix");
    // All falls alike.
    for (one, a) in system.description().coordinates.iter().zip(a) {
        near(a, if one.name == "base_z" { -9.81 } else { 0.0 }, 9.81, 1e-13);
    }
}

/// Names of the file that are none of the language are told in comments.
#[test]
fn names_that_are_changed_are_told() {
    let text = imported("crane", &[]);
    assert!(text.contains("swing_x: rad   # continuous, boom to cross; `swing x` in the URDF"), "{text}");
    assert!(text.contains("# link `left-finger`"), "{text}");
    assert!(text.contains("right: 1.5*left + right_offset   # mimics left"), "{text}");
    assert!(text.contains("scene: {start: {rail: 3}"), "its range leaves 0 out: {text}");
}
