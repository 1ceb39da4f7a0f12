//! Mistakes that people make in space, each in one derivation: found, and where it stands.

use super::{accepted, codes, problems, with};

fn library(name: &str) -> String {
    let path = format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A rotor on a shaft that a platform carries, driven by a motor; its equations written out.
const ROTOR: &str = "name: Rotor
parameters: {A: 0.03 kg*m^2, C: 0.05 kg*m^2, J: 0.2 kg*m^2, m: 2 kg, h: 0.1 m, M: 0.4 N*m, k: 3 N*m/rad, g: 9.81 m/s^2}
coordinates: {psi: rad, tilt: rad, spin: rad}
frames:
  P: {rotate: [z, psi]}
  Q: {from: P, rotate: [x, tilt]}
  R: {from: Q, rotate: [z, spin]}
points: {centre: [0, 0, 0], hub: h*Q.z}
bodies:
  platform: {mass: 0, inertia: [J/2, J/2, J], frame: P, position: centre}
  fork: {mass: 0, inertia: [0, 0, 0], frame: Q, position: hub}
  rotor: {mass: m, inertia: [A, A, C], frame: R, position: hub}
gravity: [0, 0, -g]
torques: {motor: {on: rotor, from: fork, torque: M*Q.z}}
springs: {hinge: {stretch: tilt - 0.4, stiffness: k, on: fork, from: platform, axis: P.x}}
balances:
  written:
    equations:
      - moment: {about: centre, of: all, along: ground.z}
      - equation: \"(A + m*h^2)*tilt'' - (A + m*h^2)*psi'^2*sin(tilt)*cos(tilt) + C*(spin' + psi'*cos(tilt))*psi'*sin(tilt) = m*g*h*sin(tilt) - k*(tilt - 0.4)\"
      - moment: {about: hub, of: [rotor], along: Q.z}
  bearings:
    equations:
      - force: {of: [fork, rotor]}
      - moment: {about: centre, of: [fork, rotor]}
      - moment: {about: hub, of: [rotor]}
      - moment: {about: centre, of: all, along: ground.z}
    reactions:
      hinge_force: {on: fork, from: platform, at: centre}
      hinge_moment: {on: fork, from: platform, couple: true, free: P.x}
      shaft_moment: {on: rotor, from: fork, couple: true, free: Q.z}
conserved: {vertical: \"dot(angular_momentum(centre), ground.z)\"}
checks: {z: \"dot(shaft_moment, Q.z) = 0\"}
scene: {start: {tilt: 0.5, spin': 20, psi': 1}, until: 2}
";

#[test]
fn mistakes_in_balances_are_found() {
    accepted(ROTOR);
    for (old, new, code) in [
        // The gyroscopic moment left out, and with the other sign.
        (" + C*(spin' + psi'*cos(tilt))*psi'*sin(tilt) =", " =", "E506"),
        ("+ C*(spin' + psi'*cos(tilt))*psi'", "- C*(spin' + psi'*cos(tilt))*psi'", "E506"),
        // A pendulum's weight with z down.
        ("= m*g*h*sin(tilt)", "= -m*g*h*sin(tilt)", "E506"),
        // The centrifugal moment of the inertia about the hub alone.
        ("- (A + m*h^2)*psi'^2", "- A*psi'^2", "E506"),
        // A bearing free about the wrong axis.
        ("free: P.x", "free: P.y", "E512"),
        ("free: Q.z", "free: Q.x", "E512"),
        // A bearing that passes everything leaves one unknown too many; one that passes a single direction lacks one.
        (", free: Q.z", "", "E414"),
        ("free: Q.z", "free: [Q.z, Q.x]", "E414"),
        // A moment along the axis of the wrong frame.
        ("of: [rotor], along: Q.z", "of: [rotor], along: P.z", "E506"),
        // The arm in the body's components, used as ground components.
        ("hub: h*Q.z", "hub: \"h*[0, 0, 1]\"", "E506"),
    ] {
        let found = codes(&with(ROTOR, old, new));
        assert_eq!(found.first(), Some(&code), "{old} → {new}: {found:?}");
    }
    let told = problems(&with(ROTOR, "+ C*(spin' + psi'*cos(tilt))*psi'", "- C*(spin' + psi'*cos(tilt))*psi'"));
    assert!(told[0].help.contains("balance 2 (equation)"), "{}", told[0].help);
}

#[test]
fn mistakes_in_loads_are_found() {
    for (old, new, code) in [
        // A couple on one body only is another motor.
        ("on: rotor, from: fork, torque", "on: rotor, torque", "E509"),
        // A spring about the wrong axis.
        ("axis: P.x", "axis: P.y", "E506"),
        ("axis: P.x", "axis: ground.x", "E506"),
        ("stretch: tilt - 0.4", "stretch: 0.4 - tilt", "E506"),
    ] {
        let found = codes(&with(ROTOR, old, new));
        assert_eq!(found.first(), Some(&code), "{old} → {new}: {found:?}");
    }
}

/// The point of contact travels; the coin's material there is at rest.
#[test]
fn the_speed_of_a_travelling_contact_is_not_that_of_the_material() {
    let coin = library("rolling_disc");
    let wrong = with(&coin, "dot(velocity(coin, touch), ground.x)", "dot(velocity(touch), ground.x)");
    let wrong =
        with(&wrong, "conserved: {energy: energy}", "checks: {grip: \"dot(velocity(coin, touch), ground.x) = 0\"}");
    assert_eq!(codes(&wrong).first(), Some(&"E506"));
    // The thin coin's inertia about the wrong axis.
    let wrong = with(
        &coin,
        "conserved: {energy: energy}",
        "checks: {T: \"dot(angular_momentum(coin), lean.y) = It*(phi' + psi'*sin(theta))\"}",
    );
    assert_eq!(codes(&wrong).first(), Some(&"E502"));
    accepted(&with(&wrong, "It*(phi'", "Ia*(phi'"));
}

/// All derivations share how a frame is turned: claims about it are what catches two turns exchanged, a sign of a product of inertia,
/// and moments about another point than the centre of mass.
#[test]
fn claims_catch_what_all_derivations_share() {
    let top = library("heavy_top");
    accepted(&top);
    for (old, new) in [
        ("[[z, psi], [x, theta]]", "[[x, theta], [z, psi]]"),
        ("[x, theta]]}", "[x, 2*theta]]}"),
        ("rotate: [z, phi]", "rotate: [x, phi]"),
        ("inertia: [I1, I1, I3]", "inertia: [I1 + m*l^2, I1 + m*l^2, I3]"),
        ("inertia: [I1, I1, I3]", "inertia: [I3, I1, I1]"),
        ("gravity: [0, 0, -g]", "gravity: [0, -g, 0]"),
    ] {
        let found = codes(&with(&top, old, new));
        assert!(found.iter().any(|code| ["E501", "E502", "E505", "E509"].contains(code)), "{old} → {new}: {found:?}");
    }
}

/// What holds at a contact: Jellett's integral with a sign changed, and contacts that are not where the shape touches.
#[test]
fn mistakes_at_a_contact_are_found() {
    let top = library("tippe_top");
    let celt = library("rattleback");
    accepted(&top);
    accepted(&celt);
    for (text, old, new, code) in [
        (&top, "angular_momentum(top), touch - centre", "angular_momentum(top), touch + centre", "E501"),
        (&top, "at: touch, along: ground.z", "at: centre, along: ground.z", "E506"),
        (&celt, "centre - (a^2", "centre + (a^2", "E502"),
        (&celt, "push: {on: celt, at: touch}", "push: {on: celt, at: centre}", "E506"),
        (&celt, "\"dot(velocity(celt, touch), ground.y)\"", "\"dot(velocity(touch), ground.y)\"", "E506"),
    ] {
        let found = codes(&with(text, old, new));
        assert!(found.contains(&code), "{old} → {new}: {found:?}");
    }
}
