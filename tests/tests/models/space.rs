//! Bodies in space, against references of 24 digits and more.

use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

/// Coordinates, rates and what else has the same name, at all times of the reference up to `until`, s.
fn follows(model: &str, reference: &str, until: f64, tolerance: f64) {
    runs_as(Case::new(model), reference, until, tolerance);
}

fn runs_as(case: Case, reference: &str, until: f64, tolerance: f64) {
    let mut case = case.tolerance(1e-12);
    let mut compared = 0;
    for (t, values) in Reference::in_space(reference).states().into_iter().filter(|(t, _)| *t <= until) {
        let state = case.state_at(t);
        for (name, expected) in values {
            let component =
                ["x", "y", "z"].iter().find_map(|axis| Some((name.strip_suffix(&format!("_{axis}"))?, *axis)));
            let name = match component {
                Some((vector, axis)) => format!("{}.{axis}", if vector == "omega_body" { "rates" } else { vector }),
                None => name,
            };
            if let Some(found) = state.get(&name) {
                near(found, expected, tolerance * (1.0 + expected.abs()));
                compared += 1;
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn a_heavy_top_follows_the_reference() {
    follows("heavy_top", "heavy_top", 5.0, 1e-11);
}

#[test]
fn a_free_body_follows_the_reference() {
    follows("free_body_angles", "free_top", 5.0, 1e-12);
    follows("free_body_angles", "free_top", 20.0, 1e-10);
}

#[test]
fn a_double_pendulum_on_universal_joints_follows_the_reference() {
    follows("double_pendulum_space", "double_pendulum_universal", 5.0, 1e-11);
}

#[test]
fn a_rolling_disc_follows_the_reference() {
    follows("rolling_disc", "rolling_disc", 5.0, 1e-10);
}

#[test]
fn a_spatial_four_bar_follows_the_reference() {
    follows("rssr", "rssr", 5.0, 1e-10);
}

/// The disc rolls along a circle at a steady lean; its acceleration and its weight make the force of the table.
#[test]
fn a_disc_rolls_along_a_circle() {
    let mut case = Case::new("rolling_disc").scene("circle").tolerance(1e-12);
    let run = case.run();
    let lean = run.column("theta").expect("the lean").iter().map(|theta| (theta - 0.3).abs()).fold(0.0, f64::max);
    assert!(lean < 1e-10, "{lean:e}");
}

/// Two nutations of the top against its elliptic integrals: the same lean, and the precession between.
#[test]
fn a_top_nutates_as_its_closed_form_says() {
    let reference = Reference::in_space("heavy_top");
    let closed =
        |name: &str| reference.entry("closed_form")[name].as_str().expect("a number").parse::<f64>().expect("a number");
    let mut case = Case::new("heavy_top").tolerance(1e-13);
    let after = case.state_at(2.0 * closed("nutation_period"));
    near(after["theta"], closed("theta_min"), 1e-10);
    near(after["psi"], 2.0 * closed("precession_per_nutation"), 1e-10);
    near(case.state_at(0.5 * closed("nutation_period"))["theta"], closed("theta_max"), 1e-10);
}

/// By its quaternion of any length: against the same reference, and through the position that angles do not pass.
#[test]
fn a_rotation_follows_the_references_without_a_singular_position() {
    let body = Reference::in_space("free_top");
    let mut case = Case::new("free_body").tolerance(1e-12);
    for (t, values) in body.states().into_iter().filter(|(t, _)| *t <= 20.0) {
        let state = case.state_at(t);
        let expected = |name: &str| values.iter().find(|(known, _)| known == name).expect("a value").1;
        for axis in ["x", "y", "z"] {
            near(state[format!("rates.{axis}").as_str()], expected(&format!("omega_body_{axis}")), 1e-8);
        }
        let turns = (state["angles.x"] - expected("psi")) / std::f64::consts::TAU;
        near(turns - turns.round(), 0.0, 1e-9);
    }
    let top = "name: Top
parameters: {m: 1 kg, l: 0.5 m, I1: 0.15 kg*m^2, I3: 0.1 kg*m^2, g: 9.81 m/s^2}
coordinates: {attitude: rotation}
frames: {turn: {rotate: attitude}}
points: {foot: [0, 0, 0]}
bodies: {top: {mass: m, inertia: [I1, I1, I3], frame: turn, position: l*turn.z}}
gravity: [0, 0, -g]
outputs: {com: position(top)}
scene: {start: {attitude: [[x, 0.8], [y, 0]], attitude': [0, 3.1709491405362132, 30]}, until: 5, tolerance: 1e-12}
";
    let mut case = Case::written(top);
    for (t, values) in Reference::in_space("top_through_pole").states().into_iter().filter(|(t, _)| *t <= 5.0) {
        let state = case.state_at(t);
        for (name, expected) in values.iter().filter(|(name, _)| name.starts_with("com_")) {
            near(state[name.replace('_', ".").as_str()], *expected, 1e-10);
        }
    }
}

/// Over-constrained: counting joints says -2, the rank of the rows says 1; the reference knows no row.
#[test]
fn a_bennett_linkage_follows_its_closed_form() {
    follows("bennett", "bennett", 2.0, 1e-9);
    // By the balances, with the forces and couples of its hinges or without.
    runs_as(Case::new("bennett").by("three_moments"), "bennett", 2.0, 1e-9);
    runs_as(Case::new("bennett").by("with_hinges"), "bennett", 2.0, 1e-9);
}

/// Against Newton's and Euler's equations in vectors, without angles (`tests/reference/space/tops.py`).
#[test]
fn a_rattleback_and_a_tippe_top_follow_the_references() {
    follows("rattleback", "rattleback", 1.0, 1e-9);
    follows("tippe_top", "tippe_top", 0.5, 1e-9);
}

/// Against Newton's and Euler's equations from link to link (`tests/reference/space/arm.py`).
#[test]
fn an_arm_follows_the_references_driven_and_limp() {
    follows("three_link_arm", "three_link_arm", 2.0, 1e-11);
    runs_as(Case::new("three_link_arm").scene("limp"), "three_link_arm_limp", 2.0, 1e-9);
}

/// What spins against its sense rattles and turns round; a fast tippe top stands on its head, and Jellett's constant says how fast
/// it spins there: less by (R − e)/(R + e). A slow one comes to stand upright.
#[test]
fn a_rattleback_turns_round_and_a_tippe_top_stands_on_its_head() {
    let back = Case::new("rattleback").run();
    assert!(back.last()["yaw'"] < -4.9, "{}", back.last()["yaw'"]);
    let head = Case::new("tippe_top").run();
    assert!((head.last()["theta"] - 3.1).abs() < 1e-8, "{}", head.last());
    assert!((head.last()["spin"] / (155.0 * 0.014 / 0.026) - 1.0).abs() < 0.01, "{}", head.last());
    let slow = Case::new("tippe_top").scene("slow").run();
    assert!(slow.last()["theta"].abs() < 1e-2 && (slow.last()["spin"] - 20.0).abs() < 0.2, "{}", slow.last());
}
