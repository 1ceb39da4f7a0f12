//! What is written along the axes of frames is derived along them: fewer operations, and the same motion.

use std::fmt::Write as _;

use dalembert_symbolic::derive::derive;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::lower::lower;
use dalembert_symbolic::model::load;

use super::{accepted, with};

/// n bodies on hinges about z and y in turn, each with an offset of three components.
fn hinges(n: usize) -> String {
    let mut text = String::from(
        "name: Hinges\nparameters: {a: 1 m, b: 0.2 m, c: 0.3 m, d: 0.5 m, e: 0.1 m, f: 0.4 m, m: 1 kg, I: 2 kg*m^2, J: 3 kg*m^2, K: 4 kg*m^2, g: 9.81 m/s^2}\n",
    );
    let members = |of: &dyn Fn(usize) -> String| (1..=n).map(of).collect::<Vec<_>>().join(", ");
    let from = |k: usize| if k == 1 { String::new() } else { format!("from: A{}, ", k - 1) };
    let axis = |k: usize| if k % 2 == 1 { "z" } else { "y" };
    let way = |k: usize, [a, b, c]: [&str; 3]| format!("{a}*A{k}.x + {b}*A{k}.y + {c}*A{k}.z");
    let joint = |k: usize| if k == 0 { "[0*a, 0*a, 0*a]".to_owned() } else { format!("P{k}") };
    let mut line = |key: &str, members: String| writeln!(text, "{key}: {{{members}}}").expect("a string");
    line("coordinates", members(&|k| format!("q{k}: rad")));
    line("frames", members(&|k| format!("A{k}: {{{}rotate: [{}, q{k}]}}", from(k), axis(k))));
    line("points", members(&|k| format!("P{k}: \"{} + {}\"", joint(k - 1), way(k, ["a", "b", "c"]))));
    let position = |k: usize| format!("\"{} + {}\"", joint(k - 1), way(k, ["d", "e", "f"]));
    line(
        "bodies",
        members(&|k| format!("B{k}: {{mass: m, inertia: [I, J, K], frame: A{k}, position: {}}}", position(k))),
    );
    text + "gravity: [0, 0, -g]\nconserved: {E: energy}\n"
}

fn operations(text: &str) -> [usize; 2] {
    let program = lower(judged(load(text, &[]).expect("a model")).expect("equations")).expect("a program");
    [program.counts.mass_and_bias, program.counts.bias]
}

/// M and h together, and h alone: the counts of the same route in the study of bodies in space (260 and 142, 1466 and 665, 3406 and 1293, 9216 and
/// 2553 in ground axes).
#[test]
fn hinges_take_fewer_operations_along_their_own_axes() {
    for (n, whole, bias) in [(2, 154, 102), (4, 834, 453), (6, 1863, 810)] {
        let [found, of_bias] = operations(&hinges(n));
        assert!(found <= whole && of_bias <= bias, "{n}: {found}, {of_bias}");
    }
}

/// A chain of ten takes no more for its accelerations than the articulated-body recursion by hand, 429 n − 507 or 3783 as it is usually counted
/// (by the study, not looked up: Featherstone, Rigid Body Dynamics Algorithms, 2008, ch. 10), which elimination finds by itself.
#[test]
fn elimination_finds_the_recursion_along_the_axes_of_links() {
    let [six, ten] = [6, 10].map(|n| {
        let judged = judged(load(&hinges(n), &[]).expect("a model")).expect("equations");
        lower(judged).expect("a program").counts.accelerations
    });
    assert!(six <= 1701 && ten <= 3450 && (ten - six) / 4 < 440, "{six} {ten}");
}

/// A top that is kept as a quaternion: its angular velocity is what is solved for (the study of bodies in space asks for 200; M and LDLᵀ take 359).
#[test]
fn a_top_by_rotation_takes_two_hundred_operations() {
    let text = "name: Top\nparameters: {m: 1 kg, A: 0.3 kg*m^2, C: 0.2 kg*m^2, l: 0.5 m, g: 9.81 m/s^2}\ncoordinates: {turn: rotation}\nframes: {T: {rotate: turn}}\npoints: {P: l*T.z}\nbodies: {top: {mass: m, inertia: [A, A, C], frame: T, position: P}}\ngravity: [0, 0, -g]\n";
    let judged = judged(load(text, &[]).expect("a model")).expect("equations");
    let counts = lower(judged).expect("a program").counts;
    assert!(counts.accelerations <= 200, "{}", counts.accelerations);
}

/// A sled on a rail in a frame that turns, with an arm: ways that move, a point that is written along two frames of which neither is turned
/// from the other, differences, products and sums.
const SLED: &str = r#"
name: Sled
parameters: {m: 1 kg, a: 0.4 m, b: 0.3 m, I: 0.02 kg*m^2, J: 0.03 kg*m^2, k: 5 N/m, g: 9.81 m/s^2, w: 2 rad/s}
coordinates: {q: rad, s: m, p: rad, r: rad}
inputs: {u: 0.1 m}
frames:
  rail: {rotate: [[z, q], [x, 0.3*sin(w*t)]]}
  arm: {from: rail, rotate: [[y, p], [x, r]]}
  mast: {rotate: [y, r]}
points:
  seat: "(s + u)*rail.x + sum(j*a/2*rail.y, j in 1..2) - -(b*rail.z)"
  tip: seat + 2*a*arm.x/4 - (s^2/b)*arm.y
  flag: tip + b*mast.z
bodies:
  sled: {mass: m, inertia: [I, I, J], frame: rail, position: seat}
  beam: {mass: 2*m, inertia: [I, J, J], frame: arm, position: tip}
  light: {mass: m, position: flag}
  free: {mass: m, position: "[s, a, b]"}
springs: {hold: {between: [tip, ground], stiffness: k}}
forces: {push: {on: beam, at: flag, force: "k*a*arm.z"}}
torques: {turn: {on: sled, from: beam, torque: "k*a*a*rail.z"}}
gravity: [0, 0, -g]
scene: {start: {q: 0.2, s: 0.3, p: 0.4, r: 0.5}, until: 1}
"#;

#[test]
fn ways_that_move_and_branch_give_the_same_motion() {
    accepted(SLED);
    accepted(&with(SLED, "b*mast.z", "b*mast.z + a*rail.x"));
}

/// Where only particles move there is nothing that turns, and nothing is derived again.
#[test]
fn particles_are_left_alone() {
    let derivations = |text: &str| derive(load(text, &[]).expect("a model")).expect("equations").equations.len();
    assert_eq!(derivations(&hinges(2)), 3);
    assert_eq!(
        derivations(
            &hinges(2).replace("inertia: [I, J, K], frame: A1, ", "").replace("inertia: [I, J, K], frame: A2, ", "")
        ),
        2
    );
}
