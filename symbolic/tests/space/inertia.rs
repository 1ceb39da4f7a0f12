//! Inertia about another point than the centre of mass, and fixed turns by a quaternion.

use dalembert_symbolic::expr::{DoubleDouble, Symbol, Tape};
use dalembert_symbolic::lower::compile;

use super::{accepted, codes, problems, with};

/// A top on its point: moments about the foot.
const TOP: &str = "name: Top
parameters: {k: 1 1, d: 0.5 m, m: 1.3 kg, l: 0.5 m, I1: 0.5 kg*m^2, I2: 0.6 kg*m^2, I3: 0.25 kg*m^2, g: 9.81 m/s^2}
coordinates: {psi: rad, theta: rad, phi: rad}
frames: {B: {rotate: [[z, psi], [x, theta], [z, phi]]}}
points: {foot: [0, 0, 0]}
bodies: {top: {mass: m, inertia: [I1, I2, I3], about: foot, frame: B, position: l*B.z}}
gravity: [0, 0, -g]
balances: {about_the_foot: {equations: [{moment: {about: foot, of: [top]}}]}}
conserved: {energy: energy}
scene: {start: {theta: 0.6, phi': 8, psi': 1}, until: 1}
";

/// M and h at a state, of whatever is in the file's order.
fn equations(text: &str) -> Vec<f64> {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let roots: Vec<_> = program.mass.iter().map(|entry| entry.2).chain(program.bias.iter().copied()).collect();
    let value = |symbol| {
        DoubleDouble::from(match symbol {
            Symbol::Parameter(k) => program.model.parameters[k as usize].default,
            Symbol::Coordinate(k) => 0.4 + 0.3 * f64::from(k),
            Symbol::Speed(k) => 1.1 - 0.7 * f64::from(k),
            _ => 0.0,
        })
    };
    Tape::new(&program.model.graph, &roots).evaluate(value).iter().map(|x| x.to_f64()).collect()
}

#[track_caller]
fn equal(text: &str, other: &str) {
    let (found, expected) = (equations(text), equations(other));
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() <= 1e-14 * (1.0 + b.abs()), "{found:?}\n{expected:?}");
    }
}

#[test]
fn moments_about_the_foot_are_those_about_the_centre_and_m_l_squared() {
    accepted(TOP);
    let about_centre = with(TOP, "inertia: [I1, I2, I3], about: foot", "inertia: [I1 - m*l^2, I2 - m*l^2, I3]");
    equal(TOP, &about_centre);
    // A point beside all axes: its tensor by hand, m (d² 1 - d dᵀ) with d = [0.1, -0.2, 0.3] along the body's axes.
    let beside = with(TOP, "about: foot", "about: \"top + d*(0.1*B.x - 0.2*B.y + 0.3*B.z)\"");
    let tensor = "inertia: [[I1 - m*d^2*0.13, -(m*d^2*0.02), m*d^2*0.03], [-(m*d^2*0.02), I2 - m*d^2*0.10, -(m*d^2*0.06)], [m*d^2*0.03, -(m*d^2*0.06), I3 - m*d^2*0.05]]";
    let by_hand = with(TOP, "inertia: [I1, I2, I3], about: foot", tensor);
    accepted(&beside);
    equal(&beside, &by_hand);
    // Turned by a rotation it is the same shift.
    let rotation = with(TOP, "{psi: rad, theta: rad, phi: rad}", "{attitude: rotation}");
    let rotation = with(&rotation, "[[z, psi], [x, theta], [z, phi]]", "attitude");
    let rotation = with(&rotation, "{theta: 0.6, phi': 8, psi': 1}", "{attitude: [x, 0.6], attitude': [0, 1, 8]}");
    equal(&rotation, &with(&rotation, "inertia: [I1, I2, I3], about: foot", "inertia: [I1 - m*l^2, I2 - m*l^2, I3]"));
}

#[test]
fn a_bar_in_the_plane_has_moments_about_its_end() {
    let bar = "name: Bar
parameters: {m: 1.3 kg, l: 0.5 m, I: m*(2*l)^2/3, g: 9.81 m/s^2}
coordinates: {theta: rad}
points: {hinge: [0, 0]}
bodies: {bar: {mass: m, inertia: I, about: hinge, angle: theta, position: \"l*[sin(theta), -cos(theta)]\"}}
gravity: [0, -g]
";
    accepted(bar);
    equal(bar, &with(bar, "inertia: I, about: hinge", "inertia: I - m*l^2"));
    assert_eq!(codes(&with(bar, "m*(2*l)^2/3", "m*l^2/3")), ["E439"]);
    assert_eq!(codes(&with(bar, "about: hinge", "about: \"[1, 0]\"")), ["E444"]);
}

/// A shaft that only spins has moments about the other axes too.
#[test]
fn moments_about_one_axis_alone_are_told_what_lacks() {
    let shaft = "name: Shaft\nparameters: {J: 0.5 kg*m^2}\ncoordinates: {phi: rad}\nframes: {S: {rotate: [z, phi]}}\n\
                 bodies: {s: {mass: 1 kg, inertia: [0, 0, J], frame: S, position: [0, 0, 0]}}\n";
    let found = problems(shaft);
    assert!(found.len() == 1 && found[0].help.contains("half of this one at the least"), "{found:?}");
    accepted(&shaft.replace("[0, 0, J]", "[J/2, J/2, J]"));
}

#[test]
fn a_shift_that_leaves_no_body_is_refused_with_the_numbers() {
    let small = with(TOP, "I1: 0.5 kg*m^2", "I1: 0.3 kg*m^2");
    let found = problems(&small);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].code, "E439");
    assert!(found[0].message.contains("-0.025 is negative"), "{}", found[0].message);
    assert!(found[0].help.contains("[0.3, 0.6, 0.25] less m*d^2 = [0.325, 0.325, 0]"), "{}", found[0].help);
    // By a scene's parameters too.
    assert_eq!(codes(&with(TOP, "until: 1}", "until: 1, set: {m: 3 kg}}")), ["E439"]);
}

#[test]
fn a_point_that_moves_in_the_body_is_refused() {
    for point in ["\"[1, 0, 0]\"", "\"top + l*ground.x\"", "\"foot + [0, 0, l]\"", "\"top*(1 + 0.1*cos(phi))\""] {
        assert_eq!(codes(&with(TOP, "about: foot", &format!("about: {point}"))), ["E444"], "{point}");
    }
    assert_eq!(codes(&with(TOP, "inertia: [I1, I2, I3], about: foot, frame: B", "about: foot")), ["E311"]);
}

#[test]
fn a_quaternion_is_the_turn_that_it_stands_for() {
    let turned = with(TOP, "[z, phi]]}}", "[z, phi], [[1, 2, 3], 0.8]]}}");
    // cos 0.4 and sin 0.4 [1, 2, 3]/√14, at any length.
    for length in ["1", "3", "-0.01", "1e6"] {
        let q = format!(
            "{{quaternion: [{length}*cos(0.4), \"{length}*sin(0.4)/sqrt(14)\", \"{length}*2*sin(0.4)/sqrt(14)\", \"{length}*3*sin(0.4)/sqrt(14)\"]}}"
        );
        let by_quaternion = with(TOP, "[z, phi]]}}", &format!("[z, phi], {q}]}}}}"));
        accepted(&by_quaternion);
        equal(&turned, &by_quaternion);
    }
    let alone = with(TOP, "frames: {B: {", "frames: {A: {rotate: {quaternion: [1, 1, 0, 0]}}, B: {from: A, ");
    equal(&alone, &with(TOP, "frames: {B: {", "frames: {A: {rotate: [x, pi/2]}, B: {from: A, "));
}

#[test]
fn a_quaternion_of_length_0_or_of_another_shape_is_refused() {
    let by = |q: &str| with(TOP, "[z, phi]]}}", &format!("[z, phi], {{{q}}}]}}}}"));
    assert_eq!(codes(&by("quaternion: [0, 0, 0, 0]")), ["E441"]);
    assert_eq!(codes(&by("quaternion: [1 - 1, 0, 0, 0]")), ["E441"]);
    assert_eq!(codes(&by("quaternion: [1, 0, 0]")), ["E308"]);
    assert_eq!(codes(&by("quaternion: 1")), ["E304"]);
    assert_eq!(codes(&by("quaternion: [1, 0, 0, psi]")), ["E215"]);
    assert_eq!(codes(&by("quaternions: [1, 0, 0, 0]")), ["E301"]);
    let by_scene = with(&by("quaternion: [k - 0.2, 0, 0, 0]"), "until: 1}", "until: 1, set: {k: 0.2}}");
    assert_eq!(codes(&by_scene), ["E441"]);
}
