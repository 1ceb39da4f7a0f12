//! Joints by name (section 6): they move as their rows do, and their forces and couples are those that the bodies feel.

use dalembert::State;
use dalembert_tests::case::Case;

use super::near;

/// A body on a ball joint at the origin, and one that is joined to it; `JOINT` is the place of what joins them.
const PAIR: &str = "name: Pair
parameters: {m: 1 kg, I: 0.2 kg*m^2, l: 0.5 m, h: 0.1 m, g: 9.81 m/s^2}
coordinates: {a: rad, b: rad, c: rad, x: m, y: m, z: m, d: rad, e: rad, f: rad}
frames:
  A: {rotate: [[z, a], [y, b], [x, c]]}
  B: {rotate: [[z, d], [y, e], [x, f]]}
points: {P: l*A.x, mid: \"[x, y, z]\", Q: mid - l*B.x}
bodies:
  first:  {mass: m, inertia: [I, 2*I, 2.5*I], frame: A, position: l/2*A.x}
  second: {mass: m, inertia: [I, 2*I, 2.5*I], frame: B, position: mid}
gravity: [0, 0, -g]
JOINT
scene:
  start: {a: 0.1, b: 0.2, c: 0.3, a': 0.5, b': 0.4, c': -0.3}
  guess: {x: 1, y: 0.1, z: -0.2, d: 0.2, e: 0.3, f: 0.2}
  until: 0.4
  tolerance: 1e-12
";

/// Each kind, and the constraints that a person writes for it.
const KINDS: [(&str, &str); 8] = [
    ("{ball: [first, second], at: [P, Q]}", "{r0: P - Q}"),
    (
        "{hinge: [first, second], at: [P, Q], axis: [A.z, B.z]}",
        "{r0: P - Q, r1: \"dot(A.x, B.z)\", r2: \"dot(A.y, B.z)\"}",
    ),
    ("{universal: [first, second], at: [P, Q], axis: [A.z, B.y]}", "{r0: P - Q, r1: \"dot(A.z, B.y)\"}"),
    (
        "{cylinder: [first, second], at: [P, Q], axis: [A.x, B.x]}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\"}",
    ),
    (
        "{slider: [first, second], at: [P, Q], axis: [A.x, B.x]}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\", r4: \"dot(A.y, B.z)\"}",
    ),
    (
        "{screw: [first, second], at: [P, Q], axis: [A.x, B.x], pitch: h}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\", r4: \"rate(dot(Q - P, A.x)) - h*dot(angular_velocity(B) - angular_velocity(A), A.x)\"}",
    ),
    (
        "{plane: [first, second], at: [P, Q], axis: [A.z, B.z]}",
        "{r0: \"dot(P - Q, A.z)\", r1: \"dot(A.x, B.z)\", r2: \"dot(A.y, B.z)\"}",
    ),
    (
        "{weld: [first, second], at: [P, Q]}",
        "{r0: P - Q, r1: \"dot(A.x, B.y)\", r2: \"dot(A.y, B.z)\", r3: \"dot(A.z, B.x)\"}",
    ),
];

/// What is left of Newton's and Euler's equations of the second body under the opposite of the joint's force and couple.
const BALANCE: &str = "outputs:
  force: \"m*acceleration(second) - m*[0, 0, -g] + reaction(elbow)\"
  couple: \"rate(angular_momentum(second)) + moment(elbow) + cross(Q - mid, reaction(elbow))\"
  size: norm(reaction(elbow))
";

const COORDINATES: [&str; 9] = ["a", "b", "c", "x", "y", "z", "d", "e", "f"];

#[track_caller]
fn same(found: &State, expected: &State, names: &[&str], tolerance: f64) {
    for name in names {
        near(found[*name], expected[*name], tolerance * (1.0 + expected[*name].abs()));
    }
}

fn library(name: &str) -> String {
    let path = format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[track_caller]
fn with(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "`{old}` is not there");
    text.replacen(old, new, 1)
}

#[test]
fn each_kind_moves_as_its_rows_do_and_its_force_and_couple_are_felt() {
    for (joint, rows) in KINDS {
        let by_joint = PAIR.replace("JOINT", &format!("joints: {{elbow: {joint}}}\n{BALANCE}"));
        let by_rows = PAIR.replace("JOINT", &format!("constraints: {rows}"));
        let (mut by_joint, mut by_rows) = (Case::written(&by_joint), Case::written(&by_rows));
        for t in [0.0, 0.17, 0.4] {
            let (found, expected) = (by_joint.state_at(t), by_rows.state_at(t));
            same(&found, &expected, &COORDINATES, 1e-12);
            assert!(found["size"] > 0.1, "{joint}: {}", found["size"]);
            for axis in ["x", "y", "z"] {
                near(found[format!("force.{axis}").as_str()], 0.0, 1e-10);
                near(found[format!("couple.{axis}").as_str()], 0.0, 1e-10);
            }
        }
    }
}

/// A nut on a vertical screw falls with g/(1 + I/(m h²)), and its couple on the screw is I times its turning.
#[test]
fn a_nut_runs_down_a_screw_as_its_closed_form_says() {
    let text = "name: Nut
parameters: {m: 2 kg, I: 0.03 kg*m^2, h: 0.1 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m, z: m, a: rad, b: rad, c: rad}
frames: {B: {rotate: [[z, a], [y, b], [x, c]]}}
bodies: {nut: {mass: m, inertia: [I, I, I], frame: B, position: \"[x, y, z]\"}}
gravity: [0, 0, -g]
joints: {thread: {screw: [ground, nut], at: [[0, 0, 0], nut], axis: [ground.z, nut.z], pitch: h}}
outputs: {couple: moment(thread), force: reaction(thread)}
scene: {start: {}, guess: {}, until: 2, tolerance: 1e-12}
";
    let (m, inertia, h, g, t) = (2.0, 0.03, 0.1, 9.81, 2.0);
    let falls = g / (1.0 + inertia / (m * h * h));
    let last = Case::written(text).run().last();
    near(last["z"], -falls * t * t / 2.0, 1e-10);
    near(last["a"], last["z"] / h, 1e-10);
    // On the screw: the opposite of what turns and of what slows the nut.
    near(last["couple.z"], inertia * falls / h, 1e-9);
    near(last["force.z"], -m * (g - falls), 1e-9);
}

#[test]
fn joints_in_the_plane_move_as_their_rows_do() {
    let flat = "name: Flat
parameters: {m: 1 kg, I: 0.2 kg*m^2, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {a: rad, x: m, y: m, d: rad}
points: {P: l*first.x, mid: \"[x, y]\", Q: mid - l*second.x}
bodies:
  first:  {mass: m, inertia: I, angle: a, position: l/2*first.x}
  second: {mass: m, inertia: I, angle: d, position: mid}
gravity: [0, -g]
JOINT
scene: {start: {a: 0.3, a': 0.5}, guess: {x: 1, y: 0.2, d: 0.4}, until: 0.5, tolerance: 1e-12}
";
    let balance = "outputs:
  force: \"m*acceleration(second) - m*[0, -g] + reaction(elbow)\"
  couple: \"I*d'' + moment(elbow) + cross(Q - mid, reaction(elbow))\"
";
    for (joint, rows) in [
        ("{hinge: [first, second], at: [P, Q]}", "{r0: P - Q}"),
        (
            "{slider: [first, second], at: [P, Q], axis: [first.x, second.x]}",
            "{r0: \"dot(P - Q, first.y)\", r1: \"dot(first.y, second.x)\"}",
        ),
        ("{weld: [first, second], at: [P, Q]}", "{r0: P - Q, r1: \"dot(first.x, second.y)\"}"),
    ] {
        let by_joint = flat.replace("JOINT", &format!("joints: {{elbow: {joint}}}\n{balance}"));
        let found = Case::written(&by_joint).run().last();
        let expected = Case::written(&flat.replace("JOINT", &format!("constraints: {rows}"))).run().last();
        same(&found, &expected, &["a", "x", "y", "d"], 1e-12);
        for residual in ["force.x", "force.y", "couple"] {
            near(found[residual], 0.0, 1e-10);
        }
    }
}

/// A joint lets go as a whole: then both bodies turn about themselves, and the second falls freely.
#[test]
fn phases_name_joints() {
    let text = "joints: {elbow: {weld: [first, second], at: [P, Q]}}
phases: {held: [elbow], loose: []}
events: {snap: {when: t - 0.1 s, phase: held, then: loose}}
outputs: {w: reaction(elbow), v: velocity(second), s: angular_momentum(second)}";
    let text = PAIR.replace("JOINT", &text.replace("t - 0.1 s", "t - snap")).replace("h: 0.1 m", "snap: 0.1 s");
    let mut case = Case::written(&text);
    let (before, after) = (case.state_at(0.1), case.state_at(0.4));
    near(after["w.x"].abs() + after["w.z"].abs(), 0.0, 0.0);
    near(after["v.z"] - before["v.z"], -9.81 * 0.3, 1e-10);
    for component in ["v.x", "v.y", "s.x", "s.y", "s.z"] {
        near(after[component], before[component], 1e-10);
    }
}

#[test]
fn linkages_of_the_library_move_alike_by_joints() {
    let rssr = with(
        &library("rssr"),
        "constraints: {ball: P + L*K.x - Q}",
        "joints: {ball: {ball: [coupler, rocker_arm], at: [P + L*K.x, Q]}}",
    );
    let bennett = library("bennett");
    let rows = bennett.find("constraints:").expect("rows")..bennett.find("conserved:").expect("claims");
    let joint = "joints: {cut: {hinge: [ground, follower], at: [Q4, P4], axis: [base.z, last.z]}}\n";
    let bennett = bennett.replacen(&bennett[rows], joint, 1);
    for (name, text, until, outputs) in [
        ("rssr", rssr, 2.0, &["crank", "rocker", "alpha", "beta", "gamma", "at_Q.x", "at_Q.y", "at_Q.z"][..]),
        ("bennett", bennett, 2.0, &["th1", "th2", "th3", "th1'", "com2.x", "com2.z"][..]),
    ] {
        let (mut by_joint, mut by_rows) = (Case::written(&text), Case::new(name));
        for t in [0.5 * until, until] {
            // Which of Bennett's rows are kept differs, and with it rounding: his linkage follows its closed form to 1e-9.
            same(&by_joint.state_at(t), &by_rows.state_at(t), outputs, 1e-10);
        }
    }
}

/// The links of `four_bar` in space, with the moments that they have there.
fn links(frames: &str, positions: [&str; 3]) -> String {
    let link = |(name, length, frame, position): (&str, &str, &str, &str)| {
        format!(
            "  {name}: {{mass: rho*{length}, inertia: [rho*{length}^3/1000, rho*{length}^3/12, rho*{length}^3/12], frame: {frame}, position: \"{position}\"}}\n"
        )
    };
    let [ab, bc, dc] = positions;
    let bodies: String =
        [("AB", "crank", "U", ab), ("BC", "coupler", "V", bc), ("DC", "rocker", "W", dc)].map(link).concat();
    format!(
        "name: FourBarInSpace
parameters: {{ground_length: 4 m, crank: 1 m, coupler: 4 m, rocker: 3 m, rho: 1 kg/m, g: 10 m/s^2}}
{frames}
points: {{A: [0, 0, 0], D: \"[ground_length, 0, 0]\"}}
bodies:
{bodies}gravity: [0, -g, 0]
"
    )
}

/// A planar four-bar as hinges in space: all rows are written, and those that follow from others left out at every state.
/// Reference: `four_bar`, a planar model.
#[test]
fn a_planar_four_bar_may_be_hinges_in_space() {
    let scene = |start: &str, guess: &str| {
        format!(
            "outputs: {{pin: reaction(pin)}}\nscene: {{start: {{{start}}}, guess: {{{guess}}}, until: 5, tolerance: 1e-12}}\n"
        )
    };
    let tree = links(
        "coordinates: {crank_angle: rad, coupler_angle: rad, rocker_angle: rad}
frames: {U: {rotate: [z, crank_angle]}, V: {rotate: [z, coupler_angle]}, W: {rotate: [z, rocker_angle]}}
define: {B: crank*U.x, C: B + coupler*V.x, C2: D + rocker*W.x}",
        ["B/2", "(B + C)/2", "(D + C2)/2"],
    );
    let angles = scene("crank_angle: pi/2, crank_angle': 2", "rocker_angle: 1.8, coupler_angle: 0.5");
    // By hand, with a vector of which a component is 0, and axes that are parallel anyway.
    let by_hand = "constraints: {pin: C - C2, x: \"dot(V.x, W.z)\", y: \"dot(V.y, W.z)\"}\n";
    let by_joint = "joints: {pin: {hinge: [BC, DC], at: [C, C2], axis: [V.z, W.z]}}\n";
    let free = links(
        "coordinates: {x1: m, y1: m, z1: m, crank_angle: rad, b1: rad, c1: rad, x2: m, y2: m, z2: m, coupler_angle: rad, b2: rad, c2: rad, x3: m, y3: m, z3: m, rocker_angle: rad, b3: rad, c3: rad}
frames: {U: {rotate: [[z, crank_angle], [y, b1], [x, c1]]}, V: {rotate: [[z, coupler_angle], [y, b2], [x, c2]]}, W: {rotate: [[z, rocker_angle], [y, b3], [x, c3]]}}",
        ["[x1, y1, z1]", "[x2, y2, z2]", "[x3, y3, z3]"],
    );
    let hinges = "joints:
  left: {hinge: [ground, AB], at: [A, AB - crank/2*U.x], axis: [ground.z, U.z]}
  up: {hinge: [AB, BC], at: [AB + crank/2*U.x, BC - coupler/2*V.x], axis: [U.z, V.z]}
  pin: {hinge: [BC, DC], at: [BC + coupler/2*V.x, DC + rocker/2*W.x], axis: [V.z, W.z]}
  right: {hinge: [ground, DC], at: [D, DC - rocker/2*W.x], axis: [ground.z, W.z]}
";
    let places = scene(
        "crank_angle: pi/2, crank_angle': 2",
        "y1: 0.5, x2: 2, y2: 1.5, coupler_angle: 0.5, x3: 4, y3: 1.5, rocker_angle: 1.8",
    );
    let expected = Case::new("four_bar").run().last();
    for text in [tree.clone() + by_hand + &angles, tree + by_joint + &angles, free + hinges + &places] {
        let found = Case::written(&text).run().last();
        let names = ["crank_angle", "coupler_angle", "rocker_angle", "crank_angle'", "pin.x", "pin.y"];
        same(&found, &expected, &names, 1e-9);
    }
}
