//! Coordinates of kind `rotation`.

use super::{accepted, codes, problems, with};
use dalembert_symbolic::expr::Tape;
use dalembert_symbolic::model::load;

const BODY: &str = "name: Body
parameters: {m: 2 kg, I1: 2 kg*m^2, I2: 3 kg*m^2, I3: 4 kg*m^2, l: 0.3 m, g: 9.81 m/s^2, tau: 0.1 N*m}
coordinates: {attitude: rotation}
frames: {B: {rotate: attitude}}
points: {foot: [0, 0, 0]}
bodies: {body: {mass: m, inertia: [I1, I2, I3], frame: B, position: l*B.z}}
gravity: [0, 0, -g]
balances: {equations: [{moment: {about: foot, of: [body]}}]}
conserved: {energy: energy, vertical: \"dot(angular_momentum(foot), ground.z)\"}
scene: {start: {attitude: [[z, 0.3], [x, 0.5]], attitude': [1, 2, 3]}, until: 2}
";

#[test]
fn a_rotation_turns_bodies_without_a_constraint() {
    accepted(BODY);
    let model = load(BODY, &[]).unwrap();
    assert!(model.constraints.is_empty());
    let names: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["attitude.w", "attitude.x", "attitude.y", "attitude.z"]);
    assert_eq!(
        codes(&with(
            BODY,
            "conserved: {energy: energy,",
            "conserved: {energy: energy, wrong: \"dot(angular_momentum(foot), body.z)\","
        )),
        ["E501"]
    );
    // A couple about the body's own axis, and a frame that is turned further.
    let text = with(
        BODY,
        "conserved: {energy: energy, vertical: \"dot(angular_momentum(foot), ground.z)\"}",
        "torques: {t: {on: body, torque: tau*B.z}}",
    );
    let text = with(&text, "frames: {", "frames: {C: {from: B, rotate: [[x, pi/2], [z, 0.3]]}, ");
    accepted(&with(&text, "frame: B", "frame: C"));
}

/// The same rotation by a sequence of turns, a quaternion of any length, and an axis times an angle.
#[test]
fn starts_are_written_in_three_ways() {
    let start = |attitude: &str, rate: &str| {
        let text = with(
            BODY,
            "attitude: [[z, 0.3], [x, 0.5]], attitude': [1, 2, 3]",
            &format!("attitude: {attitude}, attitude': {rate}"),
        );
        let model = load(&text, &[]).unwrap_or_else(|problems| panic!("{attitude} {rate}: {problems:?}"));
        let scene = &model.scenes[0];
        let values: Vec<_> = scene.q.iter().chain(&scene.v).copied().collect();
        Tape::new(&model.graph, &values).evaluate(|_| 0.0)
    };
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15);
    let turned = start("[[z, 0.3], [x, 0.5]]", "[1, 2, 3]");
    let (z, x) = ((0.15_f64.sin(), 0.15_f64.cos()), (0.25_f64.sin(), 0.25_f64.cos()));
    assert!(near(&turned[..4], &[z.1 * x.1, z.1 * x.0, z.0 * x.0, z.0 * x.1]), "{turned:?}");
    let q: Vec<String> = turned[..4].iter().map(|x| format!("{:.17e}", 3.0 * x)).collect();
    assert!(near(&start(&format!("{{quaternion: [{}]}}", q.join(", ")), "[1, 2, 3]"), &turned));
    assert!(near(&start("[z, 0.7]", "[0, 0, 0]"), &start("{vector: [0, 0, 0.7]}", "[0, 0, 0]")));
    assert!(near(
        &start("{vector: [0, 0, 0]}", "[1, 2, 3]"),
        &start("{quaternion: [2, 0, 0, 0]}", "{ground: [1, 2, 3]}")
    ));
    // Along the ground's axes and along its own; by the rates of the angles: 2 about z, then 3 about the turned x.
    assert!(near(&start("[z, 0.7]", "{ground: [0, 0, 2]}"), &start("[z, 0.7]", "[0, 0, 2]")));
    let by_angles = start("[[z, 0.3], [x, 0.5]]", "{angles: [2, 3]}");
    assert!(near(
        &by_angles,
        &start("[[z, 0.3], [x, 0.5]]", &format!("[3, {}, {}]", 2.0 * 0.5_f64.sin(), 2.0 * 0.5_f64.cos()))
    ));
}

#[test]
fn mistakes_with_rotations_are_refused() {
    for (old, new, code) in [
        ("attitude: [[z, 0.3], [x, 0.5]]", "attitude: 0.3", "E436"),
        ("attitude: [[z, 0.3], [x, 0.5]]", "attitude: {quaternion: [0, 0, 0, 0]}", "E441"),
        ("attitude: [[z, 0.3], [x, 0.5]]", "attitude: {quaternion: [1, 0, 0]}", "E308"),
        ("attitude': [1, 2, 3]", "attitude': [1, 2]", "E308"),
        ("attitude': [1, 2, 3]", "attitude': 3", "E304"),
        ("attitude': [1, 2, 3]", "attitude': {angles: [1, 2, 3]}", "E308"),
        ("attitude': [1, 2, 3]", "attitude'': [1, 2, 3]", "E410"),
        ("rotate: attitude", "rotate: body", "E224"),
        ("rotate: attitude", "rotate: attitude + 1", "E224"),
        ("position: l*B.z", "position: attitude*B.z", "E224"),
        ("until: 2", "until: 2, guess: {attitude: 1}", "E426"),
    ] {
        let text = with(BODY, old, new);
        let found: Vec<String> = problems(&text).iter().map(|p| format!("{} {}", p.code, p.message)).collect();
        assert!(found.first().is_some_and(|first| first.starts_with(code)), "{new}: {found:?}");
    }
}

/// `angles` undoes a sequence of turns, for all twelve sequences.
#[test]
fn angles_are_those_of_the_sequence() {
    let axes = ["x", "y", "z"];
    let mut checks = String::new();
    let mut frames = String::new();
    for i in axes {
        for j in axes.iter().filter(|j| **j != i) {
            for k in axes.iter().filter(|k| *k != j) {
                frames += &format!("  F{i}{j}{k}: {{rotate: [[{i}, a], [{j}, b], [{k}, c]]}}\n");
                checks += &format!("  {i}{j}{k}: \"angles(F{i}{j}{k}, {i}{j}{k}) = [a, b, c]\"\n");
            }
        }
    }
    let text = format!(
        "name: Angles\nparameters: {{m: 1 kg, I: 1 kg*m^2}}\ncoordinates: {{a: rad, b: rad, c: rad}}\nframes:\n{frames}\
         bodies: {{body: {{mass: m, inertia: [I, 2*I, 2.5*I], frame: Fxyz, position: [0, 0, 0]}}}}\nchecks:\n{checks}\
         sample: {{a: [-3, 3], b: [0.1, 1.5], c: [-3, 3]}}\nscene: {{start: {{a: 0.3, b: 0.5, c: 0.7}}, until: 0.1}}\n"
    );
    accepted(&text);
    assert_eq!(codes(&with(&text, "angles(Fxyz, xyz)", "angles(Fxyz, xyy)")), ["E208"]);
    assert_eq!(codes(&with(&text, "angles(Fxyz, xyz)", "angles(Fxyz, xzy)")).first(), Some(&"E502"));
}

/// The product of half-angle quaternions, of length 1, turns the ground's axes to the frame's; it is -q, the same attitude, after a whole turn.
#[test]
fn quaternions_are_those_of_the_turns() {
    let text = with(
        BODY,
        "frames: {",
        "frames: {A: {rotate: [[z, phi], [x, 0.5]]}, C: {from: B, rotate: [[x, pi/2], [\"[0.6, 0, 0.8]\", phi]]}, ",
    );
    let text = with(&text, "coordinates: {", "coordinates: {phi: rad, ");
    let text =
        with(&text, "{body: {", "{wheel: {mass: m, inertia: [I1, I2, I3], frame: A, position: [0, 0, 0]}, body: {");
    let text = with(&text, "of: [body]}}", "of: [body]}}, {moment: {about: foot, of: [wheel], along: ground.z}}");
    let text = with(&text, "conserved: {energy: energy, vertical: \"dot(angular_momentum(foot), ground.z)\"}", "checks:
  length: \"dot(quaternion(C), quaternion(C)) = 1\"
  across: \"C.x = [1 - 2*(quaternion(C).y^2 + quaternion(C).z^2), 2*(quaternion(C).x*quaternion(C).y + quaternion(C).w*quaternion(C).z), 2*(quaternion(C).x*quaternion(C).z - quaternion(C).w*quaternion(C).y)]\"
  w: \"quaternion(A).w = cos(phi/2)*cos(0.25)\"
  x: \"quaternion(A).x = cos(phi/2)*sin(0.25)\"
  y: \"quaternion(A).y = sin(phi/2)*sin(0.25)\"
  z: \"quaternion(A).z = sin(phi/2)*cos(0.25)\"
  ground: \"quaternion(ground).w = 1\"");
    accepted(&text);
    let wrong = |check: &str| codes(&with(&text, "quaternion(ground).w = 1", check));
    assert_eq!(wrong("quaternion(wheel).w = cos(phi)*cos(0.25)"), ["E502"]);
    for mistake in ["quaternion(A) = [0, 0, 0]", "dot(quaternion(A), A.x) = 0", "cross(quaternion(A), A.x) = 0"] {
        assert_eq!(wrong(mistake), ["E209"], "{mistake}");
    }
    assert_eq!(codes(&with(BODY, "position: l*B.z", "position: quaternion(B)")), ["E228"]);
}
