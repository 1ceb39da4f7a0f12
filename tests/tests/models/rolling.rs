//! Rolling and sliding.

use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

#[test]
fn bead_on_a_parabola_follows_the_reference() {
    let reference = Reference::load("B09");
    let mut case = Case::new("bead_parabola").tolerance(1e-13);
    case.compare(&reference, &[], |_| 1e-11);
    let quarter = case.state_at(reference.scalar("period") / 4.0);
    near(quarter["x"], 0.0, 1e-11);
    near(quarter["normal"], reference.scalar("normal_force_at_bottom"), 1e-10);
}

#[test]
fn cylinder_rolling_in_a_cylinder_follows_the_reference() {
    let reference = Reference::load("B11");
    let mut case = Case::new("rolling_cylinder").tolerance(1e-13);
    // The reference counts the spin from the start.
    let spin_at_start = -3.0 * 1.2;
    for (t, values) in reference.states() {
        let state = case.state_at(t);
        for (name, expected) in values {
            match name.as_str() {
                "theta" => near(state["theta"], expected, 1e-11),
                "theta_dot" => near(state["theta'"], expected, 1e-11),
                "spin_phi" => near(state["spin_phi"] - spin_at_start, expected, 1e-10),
                name => panic!("{name}"),
            }
        }
        // From rest at θ₀, N = m g (7 cos θ − 4 cos θ₀)/3.
        near(state["normal"], 10.0 * (7.0 * state["theta"].cos() - 4.0 * 1.2_f64.cos()) / 3.0, 1e-10);
    }
    near(case.state_at(reference.scalar("period"))["theta"], 1.2, 1e-10);
    near(case.run().first()["friction_needed"], reference.scalar("min_friction_coefficient_this_case"), 1e-12);
}

#[test]
fn cart_and_pendulum_follow_the_reference() {
    Case::new("cart_pendulum").tolerance(1e-13).compare(&Reference::load("B10"), &[], |_| 1e-10);
}

/// Pulled by a very heavy cart or none, the limits are a pendulum from a fixed hinge and a bob under its rod's point.
#[test]
fn a_heavy_cart_stands_still() {
    let mut heavy = Case::new("cart_pendulum").set("M", 1e12).start("x'", 0.0).tolerance(1e-13);
    let mut fixed = Case::new("simple_pendulum").start("theta", 2.0).tolerance(1e-13);
    near(heavy.state_at(3.0)["theta"], fixed.state_at(3.0)["theta"], 1e-9);
    near(heavy.state_at(3.0)["tension"], fixed.state_at(3.0)["tension"], 1e-8);
}

#[test]
fn cylinder_in_a_rolling_pipe_follows_the_reference() {
    let mut case = Case::new("cylinder_in_pipe").tolerance(1e-13);
    let rotation_at_start = case.run().first()["disc_rotation"];
    for (t, values) in Reference::load("B12").states() {
        let state = case.state_at(t);
        for (name, expected) in values {
            match name.as_str() {
                "x" | "theta" => near(state[name.as_str()], expected, 1e-11),
                "x_dot" => near(state["x'"], expected, 1e-11),
                "theta_dot" => near(state["theta'"], expected, 1e-11),
                // The reference counts the rotation from the start.
                "disc_rotation" => near(state["disc_rotation"] - rotation_at_start, expected, 1e-10),
                name => panic!("{name}"),
            }
        }
    }
}
