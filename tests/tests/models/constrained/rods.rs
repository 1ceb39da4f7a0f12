//! Particles and rods; bodies whose joints are driven.

use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use crate::near;

#[test]
fn two_masses_and_a_rod_thrown_in_the_plane_follow_the_reference() {
    let reference = Reference::load("B06");
    let mut case = Case::new("two_masses_rod").scene("thrown").tolerance(1e-13);
    case.compare(&reference, &[], |_| 1e-11);
    for state in case.run().states() {
        near(state["tension"], reference.scalar("rod_tension"), 1e-11);
        near(state["by_multiplier"], reference.scalar("rod_tension"), 1e-11);
    }
}

/// Problem 10: F = (m₁ + m₂) a, and the rod carries what moves the first.
#[test]
fn two_masses_and_a_rod_on_a_line_move_as_one() {
    for (scene, t0) in [("scene", 0.0), ("later", 0.7)] {
        let last = Case::new("two_masses_rod").scene(scene).run().last();
        near(last["x1"], (3.0_f64 - t0).powi(2) / 2.0, 1e-12);
        near(last["x2"], last["x1"] + 1.5, 1e-12);
        near(last["tension"], 1.0, 1e-12);
    }
}

/// Problem 14: the rod turns with 2 v/l, the tension is 2 m v²/l, and none of the errors that it asks for is large.
#[test]
fn a_dumbbell_turns_at_a_constant_rate_and_every_error_is_small() {
    for (scene, [vx, vy]) in [("scene", [0.0, 0.0]), ("moving", [0.3, 0.2])] {
        let run = Case::new("dumbbell").scene(scene).tolerance(1e-13).run();
        for state in run.states() {
            let (sin, cos) = (2.0 * state.t).sin_cos();
            near(state["x2"], vx * state.t + cos / 2.0, 1e-11);
            near(state["y2"], vy * state.t + sin / 2.0, 1e-11);
            near(state["turning"], 2.0, 1e-11);
            near(state["tension"], 2.0, 1e-11);
            near(state["by_multiplier"], 2.0, 1e-11);
        }
        assert_eq!(run.drift.len(), 8);
        for drift in &run.drift {
            assert!(drift.value.is_some_and(|value| value < 1e-12), "{drift:?}");
        }
    }
}

/// Lecture 11: three particles and three rods move as a rigid body; its centre flies on a parabola, and the tension between
/// two of the masses is mᵢ mⱼ ω² l/Σm.
#[test]
fn a_triangle_of_rods_is_a_rigid_body() {
    let run = Case::new("rigid_triangle").tolerance(1e-13).run();
    let first = run.first();
    let rate = [1.0 - 3.0 * 1.5 * first["y[3]"] / 4.5, 5.0 + 3.0 * (2.0 * 0.9 + 1.5 * first["x[3]"]) / 4.5];
    for state in run.states() {
        near(state["centre.x"], first["centre.x"] + rate[0] * state.t, 1e-11);
        near(state["centre.y"], first["centre.y"] + rate[1] * state.t - 5.0 * state.t * state.t, 1e-11);
        near(state["turning"], 3.0, 1e-11);
        for (rod, masses_times_length) in [("T_a", 2.0 * 1.5 * 1.0), ("T_b", 1.5 * 1.2), ("T_c", 2.0 * 0.9)] {
            near(state[rod], masses_times_length * 9.0 / 4.5, 1e-10);
        }
    }
}

/// Problem 12: over 100 s, angles and tensions.
#[test]
fn a_cartesian_pendulum_moves_as_a_simple_pendulum() {
    let mut simple = Case::new("simple_pendulum").tolerance(1e-14).until(100.0);
    let mut cartesian = Case::new("pendulum_cartesian").scene("high").tolerance(1e-14).until(100.0);
    let residuals = cartesian.run().residuals.expect("constraints");
    assert!(residuals.position < 1e-13 && residuals.velocity < 1e-13, "{residuals:?}");
    for t in [1.0, 10.0, 100.0] {
        let (angle, place) = (simple.state_at(t), cartesian.state_at(t));
        near(place["x"], angle["theta"].sin(), 1e-9);
        near(place["y"], -angle["theta"].cos(), 1e-9);
        near(place["tension"], angle["tension"], 1e-7);
        near(place["pull"], place["tension"], 1e-11);
    }
}

/// Parameters of the file `astronaut`: trunk, arm and leg.
const MASSES: [f64; 3] = [50.0, 8.0, 20.0];
const INERTIAS: [f64; 3] = [3.0, 0.3, 1.2];

/// Angular momentum about the centre of mass, per rate of the trunk's angle and of what the joints do, at the joints' angles.
fn angular_momentum(joints: [f64; 2], trunk_rate: f64, joint_rates: [f64; 2]) -> f64 {
    let angles = [0.0, joints[0], joints[1]];
    let rates = [trunk_rate, trunk_rate + joint_rates[0], trunk_rate + joint_rates[1]];
    // Places and velocities from the trunk's centre, with the trunk upright.
    let body = |k: usize| -> [[f64; 2]; 2] {
        let ([end, reach], (sin, cos)) = ([[0.0, 0.0], [0.6, 0.4], [-0.6, 0.5]][k], angles[k].sin_cos());
        [[reach * sin, end - reach * cos], [rates[k] * reach * cos - trunk_rate * end, rates[k] * reach * sin]]
    };
    let total: f64 = MASSES.iter().sum();
    let mean = |part: usize, axis: usize| (0..3).map(|k| MASSES[k] * body(k)[part][axis]).sum::<f64>() / total;
    let of = |k: usize| {
        let [x, y] = [0, 1].map(|axis| body(k)[0][axis] - mean(0, axis));
        let [vx, vy] = [0, 1].map(|axis| body(k)[1][axis] - mean(1, axis));
        MASSES[k] * (x * vy - y * vx) + INERTIAS[k] * rates[k]
    };
    (0..3).map(of).sum()
}

/// The trunk's turn in one gesture of the arm (1 − cos) and the leg (0.8 sin), from vanishing angular momentum alone.
fn turn() -> f64 {
    // The integrand is periodic: equal weights converge faster than any power.
    let points = 400;
    let rate = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / f64::from(points)).sin_cos();
        let (joints, rates) = ([1.0 - cos, 0.8 * sin], [sin, 0.8 * cos]);
        -angular_momentum(joints, 0.0, rates) / angular_momentum(joints, 1.0, [0.0, 0.0])
    };
    (0..points as usize).map(rate).sum::<f64>() * std::f64::consts::TAU / f64::from(points)
}

/// Lecture 8: with zero angular momentum a gesture turns the astronaut, but does not move the centre of mass.
#[test]
fn an_astronaut_turns_but_does_not_travel() {
    let once = turn();
    assert!(once.abs() > 0.05, "{once}");
    let run = Case::new("astronaut").scene("ten_gestures").tolerance(1e-13).run();
    let first = run.first();
    for state in run.states() {
        near(state["centre.x"], first["centre.x"], 1e-11);
        near(state["centre.y"], first["centre.y"], 1e-11);
        near(state["by_multiplier"], state["arm_couple"], 1e-9);
    }
    near(run.last()["heading"], 10.0 * once, 1e-10);
    near(Case::new("astronaut").tolerance(1e-13).run().last()["heading"], once, 1e-11);
}

/// With one joint moving, the heading is a function of the joint's angle and returns with it.
#[test]
fn an_astronaut_with_one_joint_returns() {
    let run = Case::new("astronaut").scene("one_joint").tolerance(1e-13).run();
    let farthest = run.states().map(|state| state["heading"].abs()).fold(0.0, f64::max);
    assert!(farthest > 0.02, "{farthest}");
    near(run.last()["heading"], 0.0, 1e-12);
}
