//! Closed loops of bars.

use dalembert::Warning;
use dalembert_tests::case::Case;
use dalembert_tests::reference::{Reference, numbers};

use crate::near;

#[test]
fn four_bar_follows_the_reference_at_both_speeds() {
    for (scene, id) in [("scene", "B04"), ("fast", "B04b")] {
        let reference = Reference::load(id);
        let mut case = Case::new("four_bar").scene(scene).tolerance(1e-13);
        case.compare(&reference, &[], |_| 1e-9);
        let first = case.run().first();
        for (name, body) in
            [("at_A", "A_on_crank"), ("at_B", "B_on_crank"), ("at_C", "C_on_coupler"), ("at_D", "D_on_rocker")]
        {
            let force = numbers(&reference.scalars()["initial_joint_forces"][body]);
            near(first[format!("{name}.x").as_str()], force[0], 1e-10);
            near(first[format!("{name}.y").as_str()], force[1], 1e-10);
        }
        near(first["pin.x"], first["at_C.x"], 1e-10);
        near(first["pin.y"], first["at_C.y"], 1e-10);
    }
}

#[test]
fn four_bar_keeps_its_loop_closed_and_its_energy_for_1000_seconds() {
    let run = Case::new("four_bar").tolerance(1e-9).until(1000.0).run();
    let residuals = run.residuals.expect("constraints");
    assert!(residuals.position < 1e-10 && residuals.velocity < 1e-10, "{residuals:?}");
    let energy = run.drift[0].value;
    assert!(energy.is_some_and(|drift| drift < 1e-7), "{energy:?}");
    for state in run.states() {
        // What is reported lies on the constraints too: |DC| by the coupler's end.
        let rocker = (state["C.x"] - 4.0).hypot(state["C.y"]);
        near(rocker, 3.0, 1e-10);
    }
}

/// The guess picks the way in which the loop closes; the motion keeps it.
#[test]
fn four_bar_closes_in_two_ways() {
    for (scene, side) in [("scene", 1.0), ("lower", -1.0)] {
        let run = Case::new("four_bar").scene(scene).run();
        for state in run.states() {
            // C lies left or right of the line from B to D.
            let (b, c) = (state["crank_angle"].sin_cos(), (state["C.x"], state["C.y"]));
            let across = (4.0 - b.1) * (c.1 - b.0) - (0.0 - b.0) * (c.0 - b.1);
            assert!(side * across > 0.0, "{scene}: {state:?}");
        }
    }
}

#[test]
fn slider_crank_follows_the_reference() {
    let reference = Reference::load("B04c");
    let mut case = Case::new("slider_crank").tolerance(1e-13);
    case.compare(&reference, &["piston_vx"], |_| 1e-9);
    for (t, values) in reference.states() {
        let speed = values.iter().find(|(name, _)| name == "piston_vx").expect("a speed").1;
        near(case.state_at(t)["piston_x'"], speed, 1e-9);
    }
    let first = case.run().first();
    near(first["guide"] - 20.0, first["pin.y"], 1e-10);
}

/// With equal halves, let go from a position that is its own mirror image, it stays so.
#[test]
fn a_symmetric_five_bar_moves_symmetrically() {
    let case = Case::new("five_bar").set("right", 0.6).set("right_coupler", 1.0).tolerance(1e-13);
    let run = case.start("left_angle", 2.2).start("right_angle", std::f64::consts::PI - 2.2).until(1.0).run();
    let fallen = run.first()["C.y"] - run.last()["C.y"];
    assert!(fallen.abs() > 0.1, "{fallen}");
    for state in run.states() {
        near(state["C.x"], 0.5, 1e-9);
        near(state["left_angle"] + state["right_angle"], std::f64::consts::PI, 1e-9);
        near(state["at_A.y"], state["at_E.y"], 1e-7);
        near(state["pin.y"], 0.0, 1e-7);
    }
}

/// C7: near its dead centre, with the crank's angle among the coordinates, nothing is special.
#[test]
fn c7_a_slider_crank_passes_its_dead_centres() {
    let run = Case::new("slider_crank").set("g", 0.0).tolerance(1e-12).run();
    let turned = run.last()["crank_angle"];
    assert!(turned > 4.0, "{turned}");
    for state in run.states() {
        // dx/dθ = −r sin θ (1 + r cos θ/√(l² − r² sin² θ)).
        let (sin, cos) = state["crank_angle"].sin_cos();
        let slope = -sin * (1.0 + cos / (9.0 - sin * sin).sqrt());
        near(state["piston_x'"], slope * state["crank_angle'"], 1e-11);
    }
}

/// C5 of the catalogue: a parallelogram passes its change points, where the constraints depend on each other, on the branch
/// that its motion continues, whatever the speed and the tolerance.
#[test]
fn c5_a_parallelogram_passes_its_change_points() {
    for k in 0..8 {
        let speed = 2.0 + 0.37 * f64::from(k);
        for exponent in 5..=11 {
            let bars = Case::new("four_bar").set("ground_length", 2.0).set("coupler", 2.0).set("rocker", 1.0);
            let case = bars.set("g", if k % 2 == 0 { 0.0 } else { 0.1 });
            let tolerance = 10_f64.powi(-exponent);
            let run = case.start("crank_angle'", speed).tolerance(tolerance).until(5.0).run();
            for state in run.states() {
                near(state["rocker_angle"], state["crank_angle"], 1e-6);
                near(state["coupler_angle"], 0.0, 1e-6);
            }
            let mut warnings = run.warnings.iter();
            let passed = warnings.any(|warning| matches!(warning, Warning::SingularPassed { .. }));
            assert!(passed, "no word at {tolerance:e}");
            if k % 2 == 0 {
                // Translating in a circle: every point of the coupler with the same speed, at a constant rate.
                near(run.last()["crank_angle"], run.first()["crank_angle"] + 5.0 * speed, 1e3 * tolerance.max(1e-11));
            }
        }
    }
}

/// A parallelogram with three cranks: one constraint more than it needs, and singular where it lies flat.  It moves as its
/// twin in one angle does, 2 m a² p'' = -5/2 m g a cos p.
#[test]
fn c5_three_cranks_pass_their_flat_position_with_a_constraint_too_many() {
    let cranks = "
name: ThreeCranks
parameters: {m: 1 kg, a: 1 m, b: 2 m, g: 9.81 m/s^2}
coordinates: {p: rad, q: rad, r: rad, x: m, y: m, psi: rad}
points: {B: \"[b/2, 0]\", C: \"[b, 0]\"}
bodies:
  one: {mass: m, inertia: m*a^2/12, angle: p, position: a/2*one.x}
  two: {mass: m, inertia: m*a^2/12, angle: q, position: B + a/2*two.x}
  three: {mass: m, inertia: m*a^2/12, angle: r, position: C + a/2*three.x}
  bar: {mass: m, inertia: m*b^2/12, angle: psi, position: \"[x, y]\"}
gravity: [0, -g]
constraints:
  pin_1: \"a*one.x = position(bar) - b/2*bar.x\"
  pin_2: \"B + a*two.x = position(bar)\"
  pin_3: \"C + a*three.x = position(bar) + b/2*bar.x\"
scene: {start: {p: 1}, guess: {q: 1, r: 1, x: 1.5, y: 0.8}, until: 3, tolerance: 1e-11}
";
    let twin = "
name: Twin
parameters: {m: 1 kg, a: 1 m, g: 9.81 m/s^2}
coordinates: {p: rad}
kinetic_energy: m*a^2*p'^2
potential_energy: 5/2*m*g*a*sin(p)
scene: {start: {p: 1}, until: 3, tolerance: 1e-13}
";
    let exact = Case::written(twin).run().last()["p"];
    for exponent in 6..=12 {
        let tolerance = 10_f64.powi(-exponent);
        let run = Case::written(cranks).tolerance(tolerance).run();
        near(run.last()["p"], exact, 1e4 * tolerance);
        assert!(run.residuals.is_some_and(|residuals| residuals.position < 1e-11), "{:?}", run.residuals);
    }
}

/// C6: with a rod as long as the crank the slider stands at its dead centre, and could stay there while both bars turn.
#[test]
fn c6_a_slider_crank_of_equal_links_keeps_its_branch() {
    for exponent in 5..=11 {
        let case = Case::new("slider_crank").set("rod", 1.0).start("crank_angle", 0.3).start("crank_angle'", 9.0);
        let run = case.tolerance(10_f64.powi(-exponent)).until(5.0).run();
        assert!(run.last()["crank_angle"] > 25.0, "{:?}", run.last());
        for state in run.states() {
            near(state["piston_x"], 2.0 * state["crank_angle"].cos(), 1e-6);
        }
    }
}
