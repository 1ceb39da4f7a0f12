//! Pendulums of one bar or many.

use std::f64::consts::{FRAC_PI_2, PI};

use dalembert::{Cause, Error};
use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

/// Arithmetic–geometric mean.
fn agm(mut a: f64, mut b: f64) -> f64 {
    for _ in 0..8 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    a
}

#[test]
fn simple_pendulum_follows_the_reference() {
    let reference = Reference::load("B01");
    let mut case = Case::new("simple_pendulum").tolerance(1e-13);
    for (t, values) in reference.states() {
        let state = case.state_at(t);
        for (name, expected) in values {
            let name = match name.as_str() {
                "theta" => "theta",
                "theta_dot" => "theta'",
                "x" => "bob.x",
                "y" => "bob.y",
                // The bob's velocity follows from the angle and its rate.
                "vx" | "vy" => continue,
                name => panic!("{name}"),
            };
            near(state[name], expected, 1e-10);
        }
    }
    // A quarter of a period after release it hangs, fastest and with the rod pulling most.
    let bottom = case.state_at(reference.scalar("period") / 4.0);
    near(bottom["theta"], 0.0, 1e-10);
    near(-bottom["theta'"], reference.scalar("max_abs_theta_dot"), 1e-10);
    near(bottom["tension"], reference.scalar("rod_tension_at_bottom"), 1e-9);
}

#[test]
fn the_awkward_pendulum_is_the_same_pendulum() {
    let angle = Case::new("simple_pendulum").start("theta", 0.8_f64.asin()).tolerance(1e-13).state_at(10.0);
    let position = Case::new("pendulum_awkward").tolerance(1e-13).state_at(10.0);
    near(position["y"], angle["theta"].sin(), 1e-10);
    near(position["theta"], angle["theta"], 1e-10);
}

/// From hanging with 5 m/s, m v²/2 exceeds m g l: after ∫ dθ/θ' with θ'² = 25 − 20 (1 − cos θ) the rod is horizontal.
#[test]
fn the_awkward_pendulum_stops_honestly_at_the_horizontal() {
    let steps = 100_000;
    let width = FRAC_PI_2 / f64::from(steps);
    let rate = |k: i32| (25.0 - 20.0 * (1.0 - ((f64::from(k) + 0.5) * width).cos())).sqrt();
    let arrival: f64 = (0..steps).map(|k| width / rate(k)).sum();
    let error = Case::new("pendulum_awkward").scene("horizontal").try_run().expect_err("no coordinate there");
    let Error::Run(failure) = error else { panic!("{error}") };
    let Cause::CoordinateSingularity { coordinate, t } = &failure.cause else { panic!("{}", failure.cause) };
    assert_eq!(coordinate, "y");
    near(*t, arrival, 1e-7);
    assert!(failure.state["y"] < 1.0 && failure.state["y"] > 0.999);
    assert!(failure.run.len() > 1, "what was computed is there");
}

/// The period is 2π/(ω₀ agm(1, cos(θ₀/2))) with ω₀² = M g d/(I + M d²).
#[test]
fn compound_pendulum_has_the_elliptic_period() {
    for (scene, mass) in [("scene", 1.0), ("lump", 2.0)] {
        let omega = (mass * 10.0 * 0.5 / (1.0 / 12.0 + mass * 0.25_f64)).sqrt();
        let period = 2.0 * PI / (omega * agm(1.0, (PI / 4.0).cos()));
        let run = Case::new("compound_pendulum").scene(scene).tolerance(1e-13).run();
        let turns: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        assert!(turns.len() >= 4);
        for (index, turn) in turns.iter().enumerate() {
            near(*turn, period / 2.0 * (index + 1) as f64, 1e-9);
        }
    }
    // Let go from the horizontal, a uniform bar is held with a quarter of its weight, across the bar.
    let start = Case::new("compound_pendulum").run().first();
    near(start["along"], 0.0, 1e-12);
    near(start["across"].abs(), 2.5, 1e-12);
    near(start["hinge_force.y"], 2.5, 1e-12);
}

/// Until t = 2 to 1e-10, then as errors grow in a chaotic motion (the reference says how fast).
fn chaotic(t: f64) -> f64 {
    if t <= 2.0 {
        1e-10
    } else if t <= 5.0 {
        1e-8
    } else {
        1e-6
    }
}

#[test]
fn double_pendulum_follows_the_reference() {
    let reference = Reference::load("B02");
    let mut case = Case::new("double_pendulum").tolerance(1e-13);
    case.compare(&reference, &["tip_vx", "tip_vy"], chaotic);
    for (found, expected) in case.accelerations().into_iter().zip(reference.list("initial_theta_ddot")) {
        near(found, expected, 1e-13);
    }
    let start = case.run().first();
    let force = reference.list("initial_ground_joint_force_on_bar1");
    near(start["hinge_force.x"], force[0], 1e-12);
    near(start["hinge_force.y"], force[1], 1e-12);
}

#[test]
fn triple_pendulum_follows_the_reference() {
    let reference = Reference::load("B03");
    let mut case = Case::new("triple_pendulum").tolerance(1e-13);
    case.compare(&reference, &["tip_vx", "tip_vy"], chaotic);
    for (found, expected) in case.accelerations().into_iter().zip(reference.list("initial_theta_ddot")) {
        near(found, expected, 1e-13);
    }
    let start = case.run().first();
    near(start["hinge_force.y"], reference.list("initial_ground_joint_force_on_bar1")[1], 1e-12);
}

dalembert::model!("../models/chain.yaml", n = 2, name = Chain2);
dalembert::model!("../models/chain.yaml", n = 20, name = Chain20);

/// A chain of two bars is the double pendulum.
#[test]
fn chain_of_two_is_the_double_pendulum() {
    let mut chain = Case::from_system(dalembert_tests::case::erase::<Chain2, _, _>()).until(5.0).tolerance(1e-12);
    let mut pendulum = Case::new("double_pendulum").until(5.0).tolerance(1e-12);
    for angle in ["theta[1]", "theta[2]"] {
        chain = chain.start(angle, 0.3);
    }
    for angle in ["theta1", "theta2"] {
        pendulum = pendulum.start(angle, 0.3);
    }
    let (chain, pendulum) = (chain.run().last(), pendulum.run().last());
    near(chain["theta[1]"], pendulum["theta1"], 1e-9);
    near(chain["theta[2]"], pendulum["theta2"], 1e-9);
    near(chain["hinge_force.y"], pendulum["hinge_force.y"], 1e-7);
}

#[test]
fn chain_of_twenty_swings_gently_without_drift() {
    let mut chain = Case::from_system(dalembert_tests::case::erase::<Chain20, _, _>()).until(2.0).tolerance(1e-12);
    let run = chain.run();
    let drift = run.drift[0].value.expect("a finite energy");
    assert!(drift < 1e-10, "{drift:e}");
}

#[test]
fn shaken_pendulum_follows_the_reference() {
    Case::new("shaken_pendulum").tolerance(1e-13).compare(&Reference::load("B17"), &[], |_| 1e-9);
}

/// For small angles the upright position is stable where Omega is above the reference's threshold.
#[test]
fn shaking_stands_a_pendulum_up_above_the_threshold() {
    let reference = Reference::load("B17");
    for row in reference.scalars()["stability_thresholds"].as_array().expect("a list") {
        let read = |name: &str| dalembert_tests::reference::number(&row[name]);
        let (amplitude, threshold) = (read("A"), read("Omega_min"));
        for (factor, stands) in [(1.03, true), (0.97, false)] {
            let case = Case::new("shaken_pendulum").set("A", amplitude).set("Omega", factor * threshold);
            let run = case.start("theta", 1e-6).until(40.0).run();
            let largest = run.column("theta").expect("a coordinate").into_iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            assert_eq!(largest < 1e-4, stands, "A = {amplitude}, Omega = {factor} of the threshold: {largest:e}");
        }
    }
}
