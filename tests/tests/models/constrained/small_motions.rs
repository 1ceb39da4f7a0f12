//! Small motions with constraints: about equilibria in independent coordinates, about steady motions by eigenvalues.

use dalembert::linear::{Guess, LinearError, Stability, linearise_constrained, linearise_tangent};
use dalembert_tests::case::Case;

use crate::near;

/// The square of the only frequency about the equilibrium near a guess, and its place.
fn squared(case: &Case, guess: &[f64]) -> (f64, Vec<f64>) {
    let found =
        linearise_constrained(&*case.system, &Guess::at(guess), false).unwrap_or_else(|error| panic!("{error}"));
    let (k, m) = (found.linear.k(), found.linear.m());
    assert_eq!(k.nrows(), 1);
    (k[(0, 0)] / m[(0, 0)], found.linear.equilibrium.q)
}

/// Without the geometric stiffness of the rod's force K would be 0; whichever coordinate the rod leaves independent.
#[test]
fn a_pendulum_in_cartesian_coordinates_has_the_frequency_of_an_angle() {
    let down = Case::new("pendulum_cartesian");
    let (omega, q) = squared(&down, &[0.3, -0.8]);
    near(omega, 10.0, 1e-12);
    near(q[1], -1.0, 1e-12);
    // From where its weight has no part along the rod, Newton's method has nowhere to go: it falls first.
    near(squared(&down, &[1.0, 0.0]).0, 10.0, 1e-10);
    let sideways = "
name: Sideways
parameters: {m: 1 kg, l: 0.5 m, g: 10 m/s^2}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [-g, 0]
constraints: {rod: x^2 + y^2 - l^2}
scene: {start: {x: -0.3}, guess: {y: 0.4}, until: 1}
";
    near(squared(&Case::written(sideways), &[-0.3, 0.4]).0, 20.0, 1e-11);
}

/// The four-bar of the reference, hanging and upright; without geometric stiffness they would have 18.345 and -10.888.
#[test]
fn a_four_bar_has_the_frequencies_of_its_twin_in_one_angle() {
    let case = Case::new("four_bar");
    let (hanging, q) = squared(&case, &[-1.87, 0.94, 2.28]);
    near(q[0], -1.873975925, 1e-8);
    near(hanging, 18.970368258768, 1e-9);
    let (upright, q) = squared(&case, &[1.42, 0.52, 1.7]);
    near(q[0], 1.420309682, 1e-8);
    near(upright, -8.047804770638, 1e-9);
}

/// Lecture 16: four zeros, counted by ranks, and -m d v/(I + m d²).
#[test]
fn a_sleigh_going_straight_has_four_zeros_and_one_eigenvalue() {
    for (v, d) in [(1.0, 0.5), (-1.0, 0.5), (3.0, 0.2), (-0.7, 1.5)] {
        let case = Case::new("chaplygin_sleigh").set("d", d);
        let guess = Guess { v: vec![v, 0.0, 0.0], ..Guess::at(&[0.3, -2.0, 0.0]) };
        let found = linearise_tangent(&*case.system, &guess, true).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((found.matrix.nrows(), found.analysis.zeros), (5, 4));
        near(found.analysis.eigenvalues[4].re, -d * v / (0.25 + d * d), 1e-12);
        let stability = if v > 0.0 { Stability::Drifting } else { Stability::Unstable };
        assert_eq!(found.analysis.stability, stability);
        // A heading that changes, by the angle that the way turns by.
        let shape = &found.shapes()[0];
        assert!(shape[2].norm() > 0.0 && shape[0].norm() < 1e-12, "{shape:?}");
    }
    // Turning, it does not go on as it is.
    let case = Case::new("chaplygin_sleigh");
    let turning = Guess { v: vec![1.0, 0.0, 0.5], ..Guess::at(&[0.0; 3]) };
    let refused = linearise_tangent(&*case.system, &turning, true);
    assert!(matches!(refused, Err(LinearError::NotAnEquilibrium { .. })), "{refused:?}");
}

/// A spherical pendulum that goes round at Ω: cos θ = g/(l Ω²), and ω² = Ω² (1 + 3 cos² θ) (Landau and Lifshitz,
/// Mechanics, 1976, §14).
#[test]
fn a_conical_pendulum_is_steady_with_its_known_frequency() {
    let cone = "
name: Cone
parameters: {m: 2 kg, l: 1 m, g: 10 m/s^2}
coordinates: {r: m, phi: rad, z: m}
bodies: {bob: {mass: m, position: \"[r*cos(phi), r*sin(phi), z]\"}}
gravity: [0, 0, -g]
constraints: {rod: r^2 + z^2 - l^2}
scene: {start: {phi: 0, phi': 4, r': 0}, guess: {r: 0.8, z: -0.6}, until: 1}
";
    let (case, turning) = (Case::written(cone), 4.0);
    let guess = Guess { v: vec![0.0, turning, 0.0], ..Guess::at(&[0.8, 0.0, -0.6]) };
    let found = linearise_tangent(&*case.system, &guess, false).unwrap_or_else(|error| panic!("{error}"));
    let cos = 10.0 / (turning * turning);
    near(found.equilibrium.q[2], -cos, 1e-12);
    near(found.multipliers[0], -turning * turning, 1e-10);
    let last = found.analysis.eigenvalues.last().expect("eigenvalues");
    near(last.im.abs(), turning * (1.0 + 3.0 * cos * cos).sqrt(), 1e-10);
    near(last.re, 0.0, 1e-10);
    assert_eq!((found.matrix.nrows(), found.analysis.zeros), (4, 2));
    // With a speed in r it is not steady.
    let rising = Guess { v: vec![0.1, turning, 0.0], ..Guess::at(&found.equilibrium.q) };
    assert!(linearise_tangent(&*case.system, &rising, true).is_err());
}

/// A wheel on a spring, k/(m + I/R²), that rolls as a constraint says.
fn wheel(rolls: &str, more: &str) -> Case {
    Case::written(&format!(
        "
name: Wheel
parameters: {{m: 2 kg, R: 0.5 m, I: 0.25 kg*m^2, k: 12 N/m, d: 0.2 m}}
coordinates: {{x: m, phi: rad, a: m, b: m, theta: rad}}
points: {{skate: \"[a, b]\"}}
bodies:
  wheel: {{mass: m, inertia: I, angle: -phi, position: \"[x, R]\"}}
  sled: {{mass: m, inertia: I, angle: theta, position: skate + d*sled.x}}
springs: {{spring: {{stretch: x, stiffness: k}}}}
constraints: {{rolls: {rolls}, {more}}}
scene: {{start: {{x: 0.1, phi: 0.2, theta: 0}}, until: 1}}
"
    ))
}

/// The sledge beside it held by pins: one frequency whether it rolls by speeds or by places, and where it was put stays.
#[test]
fn a_rolling_wheel_on_a_spring_has_the_modes_of_its_holonomic_twin() {
    let pins = "pins: \"[a, b]\", still: theta";
    for rolls in ["x' - R*phi'", "3*R*phi' - 3*x'", "x - R*phi"] {
        let case = wheel(rolls, pins);
        let found = linearise_constrained(&*case.system, &Guess::at(&[0.3, 0.6, 0.0, 0.0, 0.0]), false);
        let found = found.unwrap_or_else(|error| panic!("{rolls}: {error}"));
        let squared: Vec<f64> = found.linear.modes().expect("modes").iter().map(|mode| mode.omega.powi(2)).collect();
        assert_eq!(squared.len(), 1, "{rolls}");
        near(squared[0], 4.0, 1e-12);
        near(found.linear.equilibrium.q[0], 0.0, 1e-12);
        near(found.linear.equilibrium.q[1], 0.0, 1e-12);
    }
    let put = wheel("x' - R*phi'", pins);
    let found = linearise_constrained(&*put.system, &Guess::at(&[0.3, 0.7, 0.0, 0.0, 0.0]), false).expect("a rest");
    near(found.linear.equilibrium.q[1], 0.1, 1e-12);
}

/// Beside a skate, which no integral holds: as many departures and zeros by speeds as by places.
#[test]
fn integrals_are_held_beside_what_has_none() {
    let edge = "edge: \"dot(velocity(skate), sled.y)\"";
    let counted = |rolls: &str| {
        let guess = Guess { v: vec![0.0, 0.0, 1.5, 0.0, 0.0], ..Guess::at(&[0.0, 0.0, 0.0, 0.0, 0.0]) };
        let found = linearise_tangent(&*wheel(rolls, edge).system, &guess, false);
        let found = found.unwrap_or_else(|error| panic!("{rolls}: {error}"));
        (found.matrix.nrows(), found.analysis.zeros)
    };
    // The sleigh's five departures with four zeros, and the wheel's two.
    assert_eq!(counted("x' - R*phi'"), (7, 4));
    assert_eq!(counted("x - R*phi"), (7, 4));
    let refused = linearise_constrained(&*wheel("x - R*phi", edge).system, &Guess::at(&[0.0; 5]), true);
    assert!(matches!(refused, Err(LinearError::VelocityConstraint { .. })), "{refused:?}");
}

/// Two rows whose sum is the rate of x − z: departures keep that, and have no zero for it.
#[test]
fn the_integral_of_a_combination_is_held_by_small_motions() {
    let pair = "
name: Pair
parameters: {k: 3 1}
coordinates: {x: 1, y: 1, z: 1, w: 1}
kinetic_energy: (x'^2 + 2*y'^2 + z'^2 + w'^2)/2
potential_energy: k*(x^2 + (y - 1)^2 + (w - 1)^2)/2
constraints: {one: x' - y*w', two: y*w' - z'}
scene: {start: {x: 0, y: 1, z: 0, w: 1}, until: 1}
";
    let counted = |text: &str| {
        let found = linearise_tangent(&*Case::written(text).system, &Guess::at(&[0.0, 1.0, 0.0, 1.0]), false);
        let found = found.unwrap_or_else(|error| panic!("{error}"));
        (found.matrix.nrows(), found.analysis.zeros)
    };
    let (held, left) = (counted(pair), counted(&pair.replace("two: y*w' - z'", "two: (y*w' - z')*(2 + sin(w))")));
    assert_eq!((held.0 + 1, held.1 + 1), left);
    assert_eq!(held, (5, 1));
}

/// A wheel that rolls steadily, by speeds or by places; on a belt that moves it has no rest.
#[test]
fn a_wheel_that_rolls_on_has_no_more_zeros_by_speeds_than_by_places() {
    let free = |rolls: &str| {
        Case::written(&format!(
            "
name: Wheel
parameters: {{m: 2 kg, R: 0.5 m, I: 0.25 kg*m^2, belt: 0.3 m/s}}
coordinates: {{x: m, phi: rad}}
bodies: {{wheel: {{mass: m, inertia: I, angle: -phi, position: \"[x, R]\"}}}}
constraints: {{rolls: {rolls}}}
scene: {{start: {{x: 0}}, until: 1}}
"
        ))
    };
    for rolls in ["x' - R*phi'", "x - R*phi"] {
        let guess = Guess { v: vec![1.0, 2.0], ..Guess::at(&[0.0; 2]) };
        let found = linearise_tangent(&*free(rolls).system, &guess, false);
        let found = found.unwrap_or_else(|error| panic!("{rolls}: {error}"));
        assert_eq!((found.matrix.nrows(), found.analysis.zeros), (2, 2), "{rolls}");
    }
    let belt = free("x' - R*phi' - belt");
    let refused = linearise_constrained(&*belt.system, &Guess::at(&[0.0; 2]), false);
    assert!(matches!(refused, Err(LinearError::VelocityConstraint { .. })), "{refused:?}");
    let found =
        linearise_tangent(&*belt.system, &Guess::at(&[0.0; 2]), false).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.matrix.nrows(), found.analysis.zeros), (2, 2));
}

/// What a phase leaves out has no part in its modes; friction of a reaction shifts where the block rests.
#[test]
fn a_slipping_block_rests_where_friction_holds_the_spring() {
    let mut case = Case::new("stick_slip");
    case.system.set_phase(1);
    let found =
        linearise_tangent(&*case.system, &Guess::at(&[0.0; 2]), false).unwrap_or_else(|error| panic!("{error}"));
    near(found.equilibrium.q[0], 3.0, 1e-12);
    near(found.analysis.eigenvalues.last().expect("eigenvalues").im.abs(), 1.0, 1e-12);
    let refused = linearise_constrained(&*case.system, &Guess::at(&[0.0; 2]), false);
    assert_eq!(refused, Err(LinearError::FrictionOfReactions));
}
