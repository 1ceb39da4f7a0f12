//! Frames, bodies and loads as written.

use super::{accepted, codes, problems, with};

const TOP: &str = "name: Top
parameters: {m: 1 kg, l: 0.5 m, I1: 0.15 kg*m^2, I2: 0.2 kg*m^2, I3: 0.1 kg*m^2, g: 9.81 m/s^2, k: 2 N*m/rad, c: 0.1 N*m*s/rad}
coordinates: {psi: rad, theta: rad, phi: rad}
frames:
  B: {rotate: [[z, psi], [x, theta], [z, phi]]}
points: {foot: [0, 0, 0]}
bodies:
  top: {mass: m, inertia: [I1, I2, I3], frame: B, position: l*B.z}
gravity: [0, 0, -g]
balances:
  equations:
    - moment: {about: foot, of: [top]}
conserved: {energy: energy}
";

#[test]
fn turns_are_written_in_several_ways() {
    accepted(TOP);
    let same = [
        "B: {from: A, rotate: [z, phi]}\n  A: {rotate: [[z, psi], [x, theta]]}",
        "B: {rotate: [[[0, 0, 2], psi], [[1, 0, 0], theta], [\"[0, 0, 1]\", phi]]}",
        "A: {rotate: [[0, 0, 1], psi]}\n  B: {from: A, rotate: [[x, theta], [z, phi]]}",
    ];
    for frames in same {
        let text = with(TOP, "B: {rotate: [[z, psi], [x, theta], [z, phi]]}", frames);
        accepted(&format!(
            "{text}checks: {{T: \"kinetic_energy = (I1*(theta'*cos(phi) + psi'*sin(theta)*sin(phi))^2 + \
             I2*(psi'*sin(theta)*cos(phi) - theta'*sin(phi))^2 + I3*(phi' + psi'*cos(theta))^2 + \
             m*l^2*(theta'^2 + (psi'*sin(theta))^2))/2\"}}\n"
        ));
    }
}

/// By Rodrigues' formula: about (1, 1, 1) by 120 degrees x → y → z → x.
#[test]
fn a_turn_about_a_direction_is_right_handed() {
    let text = with(
        TOP,
        "conserved: {energy: energy}",
        "checks:
  y: \"dot(C.x, ground.y) = 1\"
  z: \"dot(C.y, ground.z) = 1\"
  x: \"dot(C.z, ground.x) = 1\"
  spin: \"angular_velocity(D) = psi'/sqrt(3)*[1, 1, 1]\"
  own: \"components(angular_velocity(D), D) = psi'/sqrt(3)*[1, 1, 1]\"",
    );
    let text =
        with(&text, "frames:\n", "frames:\n  C: {rotate: [[1, 1, 1], 2*pi/3]}\n  D: {rotate: [[1, 1, 1], psi]}\n");
    accepted(&text);
    let wrong = with(&text, "dot(C.x, ground.y) = 1", "dot(C.x, ground.z) = 1");
    assert_eq!(codes(&wrong), ["E502"]);
}

#[test]
fn frames_that_turn_about_nothing_are_refused() {
    for (turn, code) in [
        ("{rotate: [z]}", "E436"),
        ("{rotate: z}", "E201"),
        ("{rotate: []}", "E436"),
        ("{rotate: [[z, psi, phi]]}", "E436"),
        ("{rotate: [[0, 0, 0], psi]}", "E441"),
        ("{rotate: [[psi, 0, 1], psi]}", "E215"),
        ("{rotate: [[z, psi']]}", "E213"),
        ("{rotate: [[z, psi]], from: B}", "E217"),
        ("{rotate: [[z, psi]], from: foot}", "E224"),
        ("{angle: psi}", "E435"),
        ("{from: ground}", "E302"),
        ("{rotate: [w, psi]}", "E201"),
    ] {
        let text = with(TOP, "{rotate: [[z, psi], [x, theta], [z, phi]]}", turn);
        let found = codes(&text);
        assert_eq!(found.first(), Some(&code), "{turn}: {found:?}");
    }
}

#[test]
fn bodies_have_moments_that_a_body_can_have() {
    let inertia = |value: &str| with(TOP, "[I1, I2, I3]", value);
    for possible in [
        "[1, 2, 3]",
        "[0.2 kg*m^2, 0.3 kg*m^2, 0.5000000001 kg*m^2]",
        "[0, 1, 1]",
        "[[4, 0.5, 0], [0.5, 5, 0], [0, 0, 6]]",
        "[[9.2, 0, 2.4], [0, 11, 0], [2.4, 0, 2.8]]",
    ] {
        accepted(&inertia(possible));
    }
    for (impossible, code, said) in [
        ("[0.2, 0.3, 0.6]", "E439", "0.2 + 0.3 is less than 0.6"),
        ("[1.486e-6, 2e-7, 8.31e-7]", "E439", "0.0000002 + 0.000000831 is less than 0.000001486"),
        ("[[1, 0, 3], [0, 5, 0], [3, 0, 4]]", "E439", "is negative"),
        ("[[4, 0.5, 0], [0.4, 5, 0], [0, 0, 6]]", "E438", "Ixy = 0.5 and Iyx = 0.4"),
        ("0.2", "E437", ""),
        ("[0.2, 0.3]", "E437", ""),
        ("[[1, 0], [0, 1]]", "E437", ""),
        ("[-0.2, 0.3, 0.3]", "E411", ""),
    ] {
        let found = problems(&inertia(impossible));
        let all = || found.iter().map(|p| format!("{} {}", p.code, p.message)).collect::<Vec<_>>().join("\n");
        assert!(found.iter().any(|p| p.code == code && p.message.contains(said)), "{impossible}\n{}", all());
    }
}

#[test]
fn the_gate_of_inertia_forgives_few_digits_with_a_warning() {
    let text = with(TOP, "[I1, I2, I3]", "[0.2, 0.3, 0.503]");
    let model = dalembert_symbolic::model::load(&text, &[]).unwrap();
    let told: Vec<&str> = model.warnings.iter().map(|w| w.code).collect();
    assert_eq!(told, ["W440"]);
}

#[test]
fn incomplete_bodies_are_refused() {
    for (body, code) in [
        ("{mass: m, inertia: [I1, I2, I3], position: l*B.z}", "E407"),
        ("{mass: m, inertia: [I1, I2, I3], angle: psi, position: l*B.z}", "E435"),
        ("{mass: m, inertia: [I1, I2, I3], frame: foot, position: l*B.z}", "E224"),
        ("{mass: m, inertia: [I1, I2, I3], frame: C, position: l*B.z}", "E201"),
        ("{mass: m, inertia: [psi, I2, I3], frame: B, position: l*B.z}", "E242"),
    ] {
        let text = with(TOP, "{mass: m, inertia: [I1, I2, I3], frame: B, position: l*B.z}", body);
        let found = codes(&text);
        assert_eq!(found.first(), Some(&code), "{body}: {found:?}");
    }
}

#[test]
fn torsional_springs_have_an_axis() {
    // A spring against theta about the line of nodes, and a damper of the spin about the top's own axis.
    let loads = "springs: {s: {stretch: theta - 0.3, stiffness: k, on: top, axis: \"[cos(psi), sin(psi), 0]\"}}
dampers: {d: {rate: phi' + psi'*cos(theta), damping: c, on: top, axis: top.z}}
";
    let text = with(TOP, "conserved: {energy: energy}\n", loads);
    accepted(&text);
    for wrong in ["\"[sin(psi), cos(psi), 0]\"", "top.x", "\"-[cos(psi), sin(psi), 0]\""] {
        let found = codes(&with(&text, "\"[cos(psi), sin(psi), 0]\"", wrong));
        assert_eq!(found, ["E506"], "{wrong}");
    }
    assert_eq!(codes(&with(&text, ", axis: top.z", "")), ["E442"]);
    let both = with(&text, ", axis: top.z", ", axis: top.z, along: top.z");
    assert_eq!(codes(&both), ["E305"]);
}

#[test]
fn couples_are_vectors() {
    let text = with(
        TOP,
        "conserved: {energy: energy}\n",
        "torques: {m: {on: top, torque: k*theta*top.z - c*angular_velocity(top)}}\n",
    );
    accepted(&text);
    let text = with(
        TOP,
        "conserved: {energy: energy}\n",
        "forces: {f: {on: top, at: foot + l*top.x, force: \"[0.2, 0.1, 0.3]\"}}\n",
    );
    accepted(&text);
}

#[test]
fn names_of_new_functions_stay_free() {
    let text = with(TOP, "c: 0.1 N*m*s/rad", "components: 3, momentum: 2 kg*m/s, angular_momentum: 1");
    accepted(&text);
}

/// The angle of a frame in the plane is that of the body that has it.
#[test]
fn a_planar_body_may_have_a_frame() {
    let text = "name: Bar
parameters: {m: 1 kg, l: 1 m, I: 0.1 kg*m^2, g: 9.81 m/s^2}
coordinates: {a: rad, b: rad}
frames: {A: {angle: a}, B: {from: A, angle: b}}
bodies:
  upper: {mass: m, inertia: I, frame: A, position: -l/2*A.y}
  lower: {mass: m, inertia: I, frame: B, position: -l*A.y - l/2*B.y}
gravity: [0, -g]
balances: {equations: [{moment: {about: ground, of: all}}, {moment: {about: -l*upper.y, of: [lower]}}]}
checks: {turns: \"angular_velocity(lower) = a' + b'\"}
";
    accepted(text);
    assert_eq!(codes(&with(text, "frame: A, position", "frame: A, angle: a, position")), ["E305"]);
}
