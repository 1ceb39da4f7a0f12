//! Joints by name: each kind is the rows that a person writes, and its force and couple do the work of their multipliers.

use dalembert_symbolic::expr::{DoubleDouble, Id, Symbol, Tape};
use dalembert_symbolic::lower::{Program, compile};

use super::{accepted, codes, problems, with};

/// Two bodies, the first on a ball joint by its angles, the second free; `JOINT` is the place of what joins them.
const PAIR: &str = "name: Pair
parameters: {m: 1 kg, I: 0.2 kg*m^2, l: 0.5 m, h: 0.1 m, g: 9.81 m/s^2}
coordinates: {a: rad, b: rad, c: rad, x: m, y: m, z: m, d: rad, e: rad, f: rad}
frames:
  A: {rotate: [[z, a], [y, b], [x, c]]}
  B: {rotate: [[z, d], [y, e], [x, f]]}
points:
  P: l*A.x
  mid: \"[x, y, z]\"
  Q: mid - l*B.x
bodies:
  first:  {mass: m, inertia: [I, 2*I, 2.5*I], frame: A, position: l/2*A.x}
  second: {mass: m, inertia: [I, 2*I, 2.5*I], frame: B, position: mid}
gravity: [0, 0, -g]
JOINT
scene: {guess: {x: 1, y: 0.02}}
";

/// Likewise in the plane.
const FLAT: &str = "name: Flat
parameters: {m: 1 kg, I: 0.2 kg*m^2, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {a: rad, x: m, y: m, d: rad}
points: {P: l*first.x, mid: \"[x, y]\", Q: mid - l*second.x}
bodies:
  first:  {mass: m, inertia: I, angle: a, position: l/2*first.x}
  second: {mass: m, inertia: I, angle: d, position: mid}
gravity: [0, -g]
JOINT
scene: {guess: {x: 1, y: 0.02}}
";

/// Each kind, the constraints that a person writes for it, and the names of its rows.
const IN_SPACE: [(&str, &str, &str); 8] = [
    ("{ball: [first, second], at: [P, Q]}", "{r0: P - Q}", "x y z"),
    (
        "{hinge: [first, second], at: [P, Q], axis: [first.z, second.z]}",
        "{r0: P - Q, r1: \"dot(A.x, B.z)\", r2: \"dot(A.y, B.z)\"}",
        "x y z about_y about_x",
    ),
    ("{universal: [first, second], at: [P, Q], axis: [A.z, B.y]}", "{r0: P - Q, r1: \"dot(A.z, B.y)\"}", "x y z about"),
    (
        "{cylinder: [A, B], at: [P, Q], axis: [A.x, B.x]}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\"}",
        "along_y along_z about_z about_y",
    ),
    (
        "{slider: [first, second], at: [P, Q], axis: [A.x, B.x]}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\", r4: \"dot(A.y, B.z)\"}",
        "along_y along_z about_z about_y about_x",
    ),
    (
        "{screw: [first, second], at: [P, Q], axis: [A.x, B.x], pitch: h}",
        "{r0: \"dot(P - Q, A.y)\", r1: \"dot(P - Q, A.z)\", r2: \"dot(A.y, B.x)\", r3: \"dot(A.z, B.x)\", r4: \"rate(dot(Q - P, A.x)) - h*dot(angular_velocity(B) - angular_velocity(A), A.x)\"}",
        "along_y along_z about_z about_y advance",
    ),
    (
        "{plane: [first, second], at: [P, Q], axis: [A.z, B.z]}",
        "{r0: \"dot(P - Q, A.z)\", r1: \"dot(A.x, B.z)\", r2: \"dot(A.y, B.z)\"}",
        "along_z about_y about_x",
    ),
    (
        "{weld: [first, second], at: [P, Q]}",
        "{r0: P - Q, r1: \"dot(A.x, B.y)\", r2: \"dot(A.y, B.z)\", r3: \"dot(A.z, B.x)\"}",
        "x y z about_z about_x about_y",
    ),
];

const IN_PLANE: [(&str, &str, &str); 3] = [
    ("{hinge: [first, second], at: [P, Q]}", "{r0: P - Q}", "x y"),
    (
        "{slider: [first, second], at: [P, Q], axis: [first.x, second.x]}",
        "{r0: \"dot(P - Q, first.y)\", r1: \"dot(first.y, second.x)\"}",
        "along_y about_z",
    ),
    ("{weld: [first, second], at: [P, Q]}", "{r0: P - Q, r1: \"dot(first.x, second.y)\"}", "x y about_z"),
];

fn program(text: &str) -> Program {
    compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"))
}

/// At a state with all angles and speeds different; `aligned`: the second body is turned about the first's x alone.
fn numbers(program: &Program, roots: &[Id], aligned: bool) -> Vec<f64> {
    let value = |symbol| {
        DoubleDouble::from(match symbol {
            Symbol::Parameter(k) => program.model.parameters[k as usize].default,
            Symbol::Coordinate(8) => 0.9,
            Symbol::Coordinate(k) => 0.1 + 0.17 * f64::from(k % if aligned { 6 } else { 5 }),
            Symbol::Speed(k) => speed(k as usize),
            Symbol::Multiplier(k) => multiplier(k as usize),
            _ => 1.0,
        })
    };
    Tape::new(&program.model.graph, roots).evaluate(value).iter().map(|x| x.to_f64()).collect()
}

fn speed(k: usize) -> f64 {
    1.1 - 0.7 * (k % 4) as f64
}

fn multiplier(k: usize) -> f64 {
    2.0 + 0.3 * k as f64
}

/// The names of the rows, and the values of them, of J, M and h at a state.
fn equations(text: &str) -> (Vec<String>, Vec<f64>) {
    let program = program(text);
    let rows = &program.constraints;
    let matrix = rows.matrix.iter().map(|entry| entry.2);
    let mass = program.mass.iter().map(|entry| entry.2);
    let roots: Vec<Id> =
        rows.values.iter().copied().chain(matrix).chain(mass).chain(program.bias.iter().copied()).collect();
    (program.model.constraints.iter().flat_map(|c| c.row_names()).collect(), numbers(&program, &roots, false))
}

#[test]
fn each_kind_is_the_rows_that_a_person_writes() {
    let kinds = IN_SPACE.iter().map(|kind| (PAIR, kind)).chain(IN_PLANE.iter().map(|kind| (FLAT, kind)));
    for (pair, (joint, rows, names)) in kinds {
        let (found_names, found) = equations(&pair.replace("JOINT", &format!("joints: {{elbow: {joint}}}")));
        let (_, expected) = equations(&pair.replace("JOINT", &format!("constraints: {rows}")));
        assert_eq!(found, expected, "{joint}");
        let expected: Vec<String> = names.split(' ').map(|row| format!("elbow.{row}")).collect();
        assert_eq!(found_names, expected, "{joint}");
    }
}

/// The power of `reaction` on the material of both sides at Q, and of `moment`, is that of the multipliers, λ·J q', at any speeds.
#[test]
fn force_and_couple_do_the_work_of_the_multipliers() {
    let power = "dot(reaction(elbow), velocity(first, Q) - velocity(second, Q))";
    let kinds = IN_SPACE.iter().map(|kind| (PAIR, kind)).chain(IN_PLANE.iter().map(|kind| (FLAT, kind)));
    for (pair, (joint, ..)) in kinds {
        let turning = match pair == FLAT {
            true => "moment(elbow)*(angular_velocity(first) - angular_velocity(second))",
            false => "dot(moment(elbow), angular_velocity(A) - angular_velocity(B))",
        };
        // Where P and Q are one the force may be seen at either; here they are apart, and P − Q = 0 is of the material at P.
        let meets = ["ball", "hinge", "universal", "weld"].iter().any(|kind| joint.starts_with(&format!("{{{kind}")));
        let power = if meets { power.replace("(first, Q)", "(first, P)") } else { power.to_owned() };
        let text =
            pair.replace("JOINT", &format!("joints: {{elbow: {joint}}}\noutputs: {{power: \"{power} + {turning}\"}}"));
        let program = program(&text);
        // The angle of a screw is one about its axis where its other rows hold.
        let aligned = joint.starts_with("{screw");
        let matrix: Vec<Id> = program.constraints.matrix.iter().map(|entry| entry.2).collect();
        let entries = numbers(&program, &matrix, aligned);
        let rows = program.constraints.matrix.iter().zip(&entries);
        let expected: f64 = rows.map(|((row, i, _), j)| multiplier(*row) * j * speed(*i)).sum();
        let found = numbers(&program, &program.outputs, aligned)[0];
        assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{joint}: {found} is not {expected}");
    }
}

/// Where the coordinates let both sides meet in a point only the rows of the axes are left, and the force is no multiplier.
#[test]
fn one_point_leaves_the_rows_of_the_axes() {
    let pair = with(PAIR, "mid: \"[x, y, z]\"", "mid: P + l*B.x");
    let pair = with(&with(&pair, "x: m, y: m, z: m, ", ""), "{x: 1, y: 0.02}", "{a: 0.1}");
    for (joint, names) in [
        ("{hinge: [first, second], at: P, axis: [A.z, B.z]}", "about_y about_x"),
        ("{universal: [first, second], at: P, axis: [A.z, B.y]}", "about"),
        ("{weld: [first, second], at: P}", "about_z about_x about_y"),
    ] {
        let text = pair.replace("JOINT", &format!("joints: {{elbow: {joint}}}\noutputs: {{couple: moment(elbow)}}"));
        accepted(&text);
        let names: Vec<String> = names.split(' ').map(|row| format!("elbow.{row}")).collect();
        let constraints = program(&text).model.constraints;
        assert_eq!(constraints.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), names);
        assert_eq!(codes(&with(&text, "moment(elbow)", "reaction(elbow)")), ["E456"]);
    }
}

/// Families, phases that name joints as a whole, and what the rules of units say of a force and a couple.
#[test]
fn joints_stand_where_constraints_do() {
    let chain = "name: Chain
sizes: {n: 2}
parameters: {m: 1 kg, I: 0.2 kg*m^2, l: 0.5 m, g: 9.81 m/s^2, c: 2 N}
coordinates: {\"x[i in 1..n]\": m, \"y[i in 1..n]\": m, \"z[i in 1..n]\": m, \"r[i in 1..n]\": rotation}
frames: {\"F[i in 1..n]\": {rotate: \"r[i]\"}}
bodies: {\"rod[i in 1..n]\": {mass: m, inertia: [I, 2*I, 2.5*I], frame: \"F[i]\", position: \"[x[i], y[i], z[i]]\"}}
gravity: [0, 0, -g]
joints:
  root: {ball: [ground, \"rod[1]\"], at: [[0, 0, 0], \"rod[1] - l*F[1].x\"]}
  \"link[i in 2..n]\": {ball: [\"rod[i-1]\", \"rod[i]\"], at: [\"rod[i-1] + l*F[i-1].x\", \"rod[i] - l*F[i].x\"]}
  spare: {free: [\"rod[1]\", ground]}
outputs: {pull: \"norm(reaction(link[2])) - c\", couple: \"norm(moment(root)) - c*l\", none: reaction(spare)}
scene: {start: {}, guess: {\"x[1]\": 0.5, \"x[2]\": 1.5}}
";
    accepted(chain);
    assert_eq!(codes(&with(chain, "norm(moment(root)) - c*l", "norm(moment(root)) - c")), ["E241"]);
    let hinge = PAIR.replace(
        "JOINT",
        "joints: {elbow: {hinge: [A, B], at: [P, Q], axis: [A.z, B.z]}}\nphases: {held: [elbow], loose: []}",
    );
    assert_eq!(program(&hinge).model.phases.iter().map(|phase| phase.constraints.len()).collect::<Vec<_>>(), [3, 0]);
    assert_eq!(codes(&with(&hinge, "[elbow]", "[elbow, elbow]")), ["E316"]);
    // A model may have something of the name `moment`.
    accepted(&with(&with(chain, "c: 2 N", "c: 2 N, moment: 1 N*m"), "- c*l", "- moment"));
}

#[test]
fn mistakes_are_refused_at_their_place() {
    for (pair, entry, code) in [
        (PAIR, "{hinge: [A, B], at: [P, Q]}", "E302"),
        (PAIR, "{hinge: [A, B], axis: [A.z, B.z]}", "E302"),
        (PAIR, "{at: [P, Q]}", "E306"),
        (PAIR, "{ball: [A, B], hinge: [A, B], at: [P, Q]}", "E305"),
        (PAIR, "{ball: [A, B], at: [P, Q], axis: [A.z, B.z]}", "E305"),
        (PAIR, "{hing: [A, B], at: [P, Q]}", "E301"),
        (PAIR, "[A, B]", "E304"),
        (PAIR, "{ball: [A, B, A], at: [P, Q]}", "E457"),
        (PAIR, "{ball: A, at: [P, Q]}", "E457"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: A.z}", "E457"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [A.z]}", "E457"),
        (PAIR, "{ball: [first, first], at: [P, Q]}", "E458"),
        (PAIR, "{ball: [A, B], at: P}", "E455"),
        (PAIR, "{slider: [A, B], at: P, axis: [A.z, B.z]}", "E455"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [P - Q, B.z]}", "E452"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [P.x, B.z]}", "E224"),
        (PAIR, "{slider: [A, B], at: [P, Q], axis: [A.z, B.z + B.x]}", "E452"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [A.z, 3]}", "E211"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [A.z, B.z], pitch: h}", "E305"),
        (PAIR, "{screw: [A, B], at: [P, Q], axis: [A.z, B.z]}", "E302"),
        (PAIR, "{weld: [A, C], at: [P, Q]}", "E201"),
        (PAIR, "{weld: [A, P], at: [P, Q]}", "E224"),
        (PAIR, "{ball: [A, B], at: [P, R]}", "E201"),
        (PAIR, "{ball: [A, B], at: [P, h]}", "E211"),
        (PAIR, "{ball: [A, B], at: [P, A.x]}", "E242"),
        // Points and axes of the other side.
        (PAIR, "{ball: [second, first], at: [P, Q]}", "E453"),
        (PAIR, "{ball: [first, ground], at: [P, Q]}", "E453"),
        (PAIR, "{hinge: [A, B], at: [P, Q], axis: [B.z, A.z]}", "E453"),
        (PAIR, "{universal: [A, B], at: [P, Q], axis: [unit(P - Q), B.z]}", "E453"),
        (PAIR, "{weld: [first, second], at: P}", "E453"),
        (FLAT, "{ball: [first, second], at: [P, Q]}", "E454"),
        (FLAT, "{hinge: [first, second], at: P}", "E455"),
        (FLAT, "{hinge: [first, second], at: [P, Q], axis: [first.x, second.x]}", "E305"),
        (FLAT, "{slider: [first, second], at: [P, Q], axis: [first.z, second.x]}", "E227"),
    ] {
        let found = problems(&pair.replace("JOINT", &format!("joints: {{elbow: {entry}}}")));
        assert_eq!(found.first().map(|problem| problem.code), Some(code), "{entry}: {found:?}");
        assert!(found[0].place.path.len() > 1, "{entry}: {:?}", found[0].place);
    }
    let both = "{hinge: [A, C], at: [P, R], axis: [A.z, B.q]}";
    let found = codes(&PAIR.replace("JOINT", &format!("joints: {{elbow: {both}, knee: {{at: [P, Q]}}}}")));
    assert!(found.contains(&"E306") && found.len() > 1, "{found:?}");
    let ball = PAIR.replace("JOINT", "joints: {elbow: {ball: [A, B], at: [P, Q]}}");
    assert_eq!(codes(&with(&ball, "scene:", "constraints: {elbow: a}\nscene:")), ["E310"]);
    assert_eq!(codes(&with(&ball, "scene:", "constraints: {other: a}\noutputs: {m: moment(other)}\nscene:")), ["E224"]);
    assert_eq!(codes(&with(&ball, "scene:", "outputs: {m: moment(elbo)}\nscene:")), ["E235"]);
    let hinge = with(&ball, "{ball: [A, B], at: [P, Q]}", "{hinge: [A, B], at: [P, Q], axis: [A.z, B.z]}");
    assert_eq!(
        codes(&with(&hinge, "scene:", "forces: {f: {on: first, force: \"[norm(moment(elbow))/l, 0, 0]\"}}\nscene:")),
        ["E238"]
    );
}

/// A force at the joint that turns with an axis fixed in another body than the one named is no joint, but may be written in rows.
#[test]
fn a_particle_is_a_side_at_its_own_place_only() {
    let text = with(PAIR, "\ngravity", "\n  bob: {mass: m, position: Q}\ngravity");
    accepted(&text.replace("JOINT", "joints: {elbow: {ball: [first, bob], at: [P, bob]}}"));
    let off = text.replace("JOINT", "joints: {elbow: {ball: [first, bob], at: [P, Q - l*B.x]}}");
    assert_eq!(codes(&off), ["E453"]);
}
