//! Integrals of motions in space that are known, and the same with a wrong sign.

use super::{accepted, codes, with};

/// Kovalevskaya's top: A = B = 2 C, the centre of mass in the plane of A and B (Kowalevski, Acta Math. 12, 1889).
const KOVALEVSKAYA: &str = "name: Kovalevskaya
parameters: {m: 1 kg, l: 0.3 m, C: 0.4 kg*m^2, g: 9.81 m/s^2}
coordinates: {psi: rad, theta: rad, phi: rad}
frames: {B: {rotate: [[z, psi], [x, theta], [z, phi]]}}
points: {foot: [0, 0, 0]}
bodies: {top: {mass: m, inertia: [2*C, 2*C - m*l^2, C - m*l^2], frame: B, position: l*B.x}}
gravity: [0, 0, -g]
define: {w: \"[dot(angular_velocity(B), B.x), dot(angular_velocity(B), B.y)]\", k: m*g*l/C, g1: \"dot(B.x, ground.z)\", g2: \"dot(B.y, ground.z)\"}
balances: {equations: [{moment: {about: foot, of: [top]}}]}
conserved:
  energy: energy
  vertical: \"dot(angular_momentum(foot), ground.z)\"
  fourth: (w1^2 - w2^2 - k*g1)^2 + (2*w1*w2 - k*g2)^2
scene: {start: {theta: 1, phi: 0.2, psi': 0.5, phi': 2}, until: 3}
";

#[test]
fn kovalevskayas_integral_is_conserved() {
    let text = with(
        KOVALEVSKAYA,
        "w: \"[dot(angular_velocity(B), B.x), dot(angular_velocity(B), B.y)]\"",
        "w1: \"dot(angular_velocity(B), B.x)\", w2: \"dot(angular_velocity(B), B.y)\"",
    );
    accepted(&text);
    assert_eq!(codes(&with(&text, "w2^2 - k*g1", "w2^2 + k*g1")), ["E501"]);
    assert_eq!(codes(&with(&text, "inertia: [2*C, ", "inertia: [2.001*C, ")), ["E501"]);
}

/// The angular momentum of a free body is a vector at rest.
#[test]
fn the_angular_momentum_of_a_free_body_is_conserved() {
    let text = "name: Free
parameters: {m: 2 kg, I1: 2 kg*m^2, I2: 3 kg*m^2, I3: 4 kg*m^2, p: 0.2 kg*m^2}
coordinates: {x: m, y: m, z: m, psi: rad, theta: rad, phi: rad}
frames: {B: {rotate: [[z, psi], [x, theta], [z, phi]]}}
bodies: {nut: {mass: m, inertia: [[I1, p, 0], [p, I2, 0], [0, 0, I3]], frame: B, position: \"[x, y, z]\"}}
balances: {equations: [{force: {of: all}}, {moment: {about: nut, of: all}}]}
conserved: {momentum: momentum, spin: angular_momentum(nut), all: \"angular_momentum([0, 0, 0])\", of_it: \"angular_momentum(nut, [1, 2, 3])\"}
checks:
  momentum: \"momentum(nut) = m*velocity(nut)\"
  parts: \"angular_momentum(all, [0, 0, 0]) = angular_momentum(nut) + m*cross(position(nut), velocity(nut))\"
sample: {theta: [0.3, 2.8]}
scene: {start: {theta: 1.5, psi': 3, theta': 0.01, x': 1}, until: 5}
";
    accepted(text);
    let text = with(text, "spin: angular_momentum(nut)", "spin: \"components(angular_momentum(nut), nut)\"");
    assert_eq!(codes(&text), ["E501"]);
}

/// Jellett's integral of a tippe top: its angular momentum along the line to the point of contact, whatever the friction there
/// (Jellett, A Treatise on the Theory of Friction, 1872).
#[test]
fn jelletts_integral_holds_with_friction() {
    let text = "name: Tippe
parameters: {m: 0.02 kg, R: 0.02 m, a: 0.003 m, I1: 3e-6 kg*m^2, I3: 2.8e-6 kg*m^2, g: 9.81 m/s^2, c: 0.05 N*s/m}
coordinates: {x: m, y: m, psi: rad, theta: rad, phi: rad}
frames: {B: {rotate: [[z, psi], [x, theta], [z, phi]]}}
points: {touch: \"[x, y, 0]\", middle: touch + R*ground.z, centre: middle - a*B.z}
bodies: {top: {mass: m, inertia: [I1, I1, I3], frame: B, position: centre}}
gravity: [0, 0, -g]
define: {slide: \"velocity(top, touch)\"}
forces: {friction: {on: top, at: touch, force: \"-c*[slide.x, slide.y, 0]\"}}
balances:
  equations: [{force: {of: all}}, {moment: {about: top, of: all}}]
  reactions: {normal: {on: top, at: touch, along: ground.z}}
conserved: {jellett: \"dot(angular_momentum(top), touch - centre)\"}
sample: {theta: [0.1, 3]}
scene: {start: {theta: 0.2, phi': 100}, until: 0.5}
";
    accepted(text);
    assert_eq!(
        codes(&with(text, "dot(angular_momentum(top), touch - centre)", "dot(angular_momentum(top), touch - middle)")),
        ["E509"]
    );
    assert_eq!(codes(&with(text, "at: touch, force", "at: touch + R/20*B.x, force")).first(), Some(&"E509"));
}

/// Two wheels whose shafts are not parallel: a gear passes a couple to each, and takes no power.
const GEARS: &str = "
name: Gears
parameters: {J: 0.1 kg*m^2, k: 2 1, tau: 1 N*m}
coordinates: {a: rad}
define: {b: k*a}
frames: {A: {rotate: [z, a]}, B: {rotate: [[x, 0.3], [z, b]]}}
bodies:
  one: {mass: 1 kg, inertia: [J, J, J], frame: A, position: [0, 0, 0]}
  two: {mass: 1 kg, inertia: [J, J, J], frame: B, position: [0, 0, 0]}
torques: {motor: {on: one, torque: tau*A.z}}
balances:
  equations:
    - moment: {about: one, of: [one], along: A.z}
    - moment: {about: two, of: [two], along: B.z}
    - equation: \"first + k*second = 0\"
  reactions:
    first: {on: one, couple: true, along: A.z}
    second: {on: two, couple: true, along: B.z}
scene: {until: 1}
";

#[test]
fn reactions_of_written_equations_are_held_against_bodies_in_space() {
    accepted(GEARS);
    assert_eq!(codes(&with(GEARS, "first + k*second", "first + second")), ["E512"]);
}
