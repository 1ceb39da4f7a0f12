//! Rests of bodies in space by rotations, whose length says nothing: searches that let it grow found rests where there are none, or never ended.

use super::{close, run, words};

/// A bar on a ball hinge, which something turns about itself to one side.
const HINGED: &str = "\
name: Turned
parameters: {m: 2 kg, b: 0.2 m, I: 0.05 kg*m^2, g: 9.81 m/s^2, k: 1 N*m}
coordinates: {att: rotation}
frames: {B: {rotate: att}}
bodies: {bar: {mass: m, inertia: [I, I, I/2], frame: B, position: -b*B.z}}
gravity: [0, 0, -g]
potential_energy: -k*dot(B.x, ground.x)
";

/// A table on three of its legs, which springs hold, with a jug on it.
const TABLE: &str = "\
name: Turned
parameters: {m: 10 kg, M: 4 kg, a: 0.6 m, b: 0.4 m, h: 0.1 m, px: 0.2 m, py: 0.1 m, g: 9.81 m/s^2, ks: 100 N/m}
coordinates: {x: m, y: m, z: m, att: rotation}
frames: {B: {rotate: att}}
points:
  C: '[x, y, z]'
  P1: C + a*B.x + b*B.y - h*B.z
  P2: C - a*B.x + b*B.y - h*B.z
  P3: C - a*B.x - b*B.y - h*B.z
bodies:
  top: {mass: m, inertia: [0.6, 1.2, 1.7], frame: B, position: C}
  jug: {mass: M, inertia: [0, 0, 0], frame: B, position: C + px*B.x + py*B.y}
gravity: [0, 0, -g]
springs:
  centring: {between: [C, '[0, 0, h]'], stiffness: ks}
  back: {between: [P1, '[a, b, 0]'], stiffness: ks}
constraints: {l1: P1.z, l2: P2.z, l3: P3.z}
scene: {start: {x: 0.01, y: 0.02, z: 0.1, att: [[z, 0.1]]}}
";

/// A bar on two strings.
const BIFILAR: &str = "\
name: Turned
parameters: {m: 2 kg, a: 0.3 m, b: 0.2 m, L: 1 m, e: 0.05 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m, z: m, att: rotation}
frames: {B: {rotate: att}}
points: {C: '[x, y, z]'}
bodies: {bar: {mass: m, inertia: [0.03 kg*m^2, 0.055 kg*m^2, 0.05 kg*m^2], frame: B, position: C}}
gravity: [0, 0, -g]
constraints:
  s1: norm(C + b*B.x + e*B.z - [a, 0, 0]) - L
  s2: norm(C - b*B.x + e*B.z + [a, 0, 0]) - L
scene: {start: {z: -1}}
";

/// An arm that is welded to the ground.
const WELDED: &str = "\
name: Turned
parameters: {m: 2 kg, L: 0.5 m, g: 9.81 m/s^2, I: 0.05 kg*m^2}
coordinates: {x: m, y: m, z: m, r: rotation}
frames: {A: {rotate: r}}
points: {O: [0, 0, 0], P: '[x, y, z]'}
bodies: {arm: {mass: m, inertia: [I, I, I], frame: A, position: P}}
gravity: [0, 0, -g]
joints: {w: {weld: [arm, ground], at: ['P - L/2*A.x', O]}}
scene: {start: {}, guess: {x: 0.25}}
";

fn frequencies(text: &str, options: &[&str]) -> Vec<f64> {
    let found = run(text, options);
    found["modes"].as_array().unwrap().iter().map(|mode| mode["omega"].as_f64().unwrap()).collect()
}

/// √(m g b / J), with what turns it back, and about itself, from a place beside the rest.
#[test]
fn a_bar_on_a_ball_hinge_is_found_from_beside_its_rest() {
    for at in ["att.x=0", "att.x=0.01", "att.y=-0.3", "att.z=0.7"] {
        let found = frequencies(HINGED, &["--at", at]);
        let [(weight, k), (across, along)] = [(2.0 * 9.81 * 0.2, 1.0), (0.05 + 2.0 * 0.04, 0.025)];
        let wanted: [f64; 3] = [weight / across, (weight + k) / across, k / along];
        assert_eq!(found.len(), 3, "{at}: {found:?}");
        found.iter().zip(wanted).for_each(|(found, wanted)| close(*found, wanted.sqrt(), 1e-9));
    }
}

/// Moments about the legs: the jug's share of its weight and the table's.
#[test]
fn a_table_rests_on_three_legs() {
    let found = run(TABLE, &[]);
    for (leg, wanted) in [("l1", 75.21), ("l2", -1.635), ("l3", 63.765)] {
        close(found["reactions"][leg].as_f64().unwrap(), wanted, 1e-9);
    }
    assert_eq!(found["modes"].as_array().unwrap().len(), 3);
}

/// Half the weight each, along strings that lean by 0.1 in 1.
#[test]
fn a_bar_hangs_on_two_strings() {
    let found = run(BIFILAR, &[]);
    let wanted = -9.81 / (1.0_f64 - 0.01).sqrt();
    ["s1", "s2"].iter().for_each(|string| close(found["reactions"][string].as_f64().unwrap(), wanted, 1e-9));
    assert_eq!(found["modes"].as_array().unwrap().len(), 4);
}

#[test]
fn a_weld_carries_weight_and_moment() {
    let told = words(WELDED, &[]).unwrap();
    assert!(
        told.contains("reaction(w).z at rest = 19.62 N\n") && told.contains("about_y at rest = -4.905 N*m"),
        "{told}"
    );
}

/// A ball hinge rests hanging and standing; which of both is found the guess says, in the forms of a start.
#[test]
fn the_guess_of_a_rotation_has_the_forms_of_its_start() {
    let hinge = "name: Hinge\nparameters: {m: 2 kg, b: 0.2 m, I: 0.05 kg*m^2, g: 9.81 m/s^2, k: 1 N*m}\ncoordinates: {att: rotation}\n\
        frames: {B: {rotate: att}}\npoints: {O: [0, 0, 0]}\n\
        bodies: {bar: {mass: m, inertia: [I, I, I/2], frame: B, position: -b*B.z}}\ngravity: [0, 0, -g]\n\
        potential_energy: -k*dot(B.x, ground.x)\nequilibrium: {att: GUESS}\nscene: {start: {}, until: 5}\n";
    for guess in ["[[x, 3]]", "{vector: [3, 0, 0]}", "{quaternion: [0.1, 2, 0, 0]}"] {
        let found = super::run(&hinge.replace("GUESS", guess), &[]);
        assert_eq!(found["modes"][0]["kind"], "unstable", "{guess}: {found}");
        let turned = found["equilibrium"]["att.w"].as_f64().unwrap() / found["equilibrium"]["att.x"].as_f64().unwrap();
        assert!(turned.abs() < 1e-12, "{guess}: {found}");
    }
    let found = super::run(&hinge.replace("GUESS", "[[x, 0.3]]"), &[]);
    assert_eq!(found["modes"][0]["kind"], "oscillating", "{found}");
    assert!(super::try_run(&hinge.replace("GUESS", "0.3"), &[]).unwrap_err().contains("E436"));
    assert!(super::try_run(&hinge.replace("att: GUESS", "att: [[x, 3]], \"att\": 3"), &[]).is_err());
}

/// A rigid pendulum turns freely about the vertical: what rounding leaves of a stiffness there, 1e-38 N m beside 24, is none.
#[test]
fn a_free_turn_is_not_unstable_by_rounding_of_rounding() {
    let text = "name: P\nparameters: {m: 2 kg, a: 0.3 m, I1: 0.02 kg*m^2, I3: 0.03 kg*m^2, g: 9.81 m/s^2}\ncoordinates: {q: rotation}\n\
        frames: {B: {rotate: q}}\nbodies: {b: {mass: m, inertia: [I1, 1.2*I1, I3], frame: B, position: a*B.z}}\ngravity: [0, 0, -g]\n\
        scene: {start: {q: [[x, 2.9], [y, 0.3]]}, until: 2}\n";
    for start in ["[[x, 2.9], [y, 0.3]]", "[[x, 2.5], [z, 0.7]]", "[[y, 3]]"] {
        let told = words(&text.replace("[[x, 2.9], [y, 0.3]]", start), &[]).expect("modes");
        assert!(told.contains("1: rigid, no stiffness") && !told.contains("unstable"), "{told}");
    }
}
