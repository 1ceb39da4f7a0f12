//! Joints of bodies of mass 0, and integrals of elliptic kind.

use super::{accepted, refused};

/// A body on springs that meet in a knot of mass `mass`.
fn knot(mass: &str, law: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, k: 10 N/m, k2: 5 N/m, l: 1 m, c: 2 N*s/m}}
coordinates: {{x: m, y: m, zx: m, zy: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}, Z: {{mass: {mass}, position: \"[zx, zy]\"}}}}
springs: {{s: {{between: [Z, b], stiffness: k}}, s1: {{between: [ground, Z], stiffness: k2, rest: l}}, s2: {{between: [A, Z], stiffness: k2, rest: l}}}}
points: {{A: \"[l, 0]\"}}
{law}
"
    )
}

#[test]
fn a_knot_of_mass_zero_is_accepted_and_one_without_a_body_is_not() {
    accepted(&knot("0", ""));
    accepted(&knot("m", ""));
    accepted(&knot("0", "conserved: {e: energy}"));
    refused(&knot("0", "conserved: {p: \"m*x'\"}"), "is not conserved");
    // A coordinate that no body has is a slip.
    refused(
        "name: T
parameters: {m: 1 kg, k: 10 N/m}
coordinates: {x: m, z: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x - z, stiffness: k}, r: {stretch: z, stiffness: k}}
",
        "the coordinate `z` carries no mass",
    );
    // Nothing holds the second coordinate of the point.
    refused(
        "name: T
parameters: {m: 1 kg, k: 10 N/m}
coordinates: {x: m, z: m, w: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}, Z: {mass: 0, position: \"[z, w]\"}}
springs: {s: {stretch: x - z, stiffness: k}, r: {stretch: z, stiffness: k}}
",
        "the coordinate `w` carries no mass",
    );
}

#[test]
fn a_spring_and_a_damper_in_series_are_accepted() {
    accepted(
        "name: Maxwell
parameters: {m: 1 kg, k: 10 N/m, c: 2 N*s/m}
coordinates: {x: m, z: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}, joint: {mass: 0, position: \"[z, 0]\"}}
springs: {s: {stretch: x - z, stiffness: k}}
dampers: {d: {rate: z', damping: c}}
",
    );
}

/// Between both springs the force is the same, k z = k (x - w): the sum of both rows of the damper, which contains no speed.
#[test]
fn a_damper_between_two_springs_is_accepted() {
    accepted(
        "name: Series
parameters: {m: 1 kg, k: 10 N/m, c: 3 N*s/m}
coordinates: {x: m, z: m, w: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}, Z: {mass: 0, position: \"[z, 0]\"}, W: {mass: 0, position: \"[w, 0]\"}}
springs: {s1: {stretch: z, stiffness: k, on: Z, along: \"[1, 0]\"}, s2: {stretch: x - w, stiffness: k, on: b, from: W, along: \"[1, 0]\"}}
dampers: {d: {rate: w' - z', damping: c, on: W, from: Z, along: \"[1, 0]\"}}
scene: {start: {x: 1, z: 0.3, w: 0.7}, until: 3}
",
    );
}

#[test]
fn a_knot_may_be_guessed() {
    let scene = |of: &str| {
        knot("MASS", &format!("gravity: [0, -9.81]\nscene: {{start: {{x: 0.7, y: -1.2}}, guess: {{{of}: 0.5}}}}"))
    };
    accepted(&scene("zx").replace("MASS", "0"));
    refused(&scene("zx").replace("MASS", "m"), "no constraint acts in the phase");
}

/// Slipping would begin with the speed of the block at once.
#[test]
fn friction_at_a_point_without_mass_is_refused() {
    let jenkins = |mass: &str| {
        format!(
            "name: Jenkins
parameters: {{m: 1 kg, k: 10 N/m, F: 1 N}}
coordinates: {{x: m, z: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}, Z: {{mass: {mass}, position: \"[z, 0]\"}}}}
springs: {{s: {{stretch: x - z, stiffness: k, on: b, from: Z, along: \"[1, 0]\"}}}}
friction: {{rub: {{rate: z', on: Z, along: \"[1, 0]\", limit: F}}}}
"
        )
    };
    refused(&jenkins("0"), "carries no mass, and `rub` touches what it moves");
    accepted(&jenkins("m"));
}

/// An energy that is an integral.
fn integral(of: &str, range: &str) -> String {
    format!(
        "name: T
parameters: {{T: 1 N, L: 1 m, m: 1 kg, a: 2 m, b: 1 m, e: 0.9 1}}
coordinates: {{q: m}}
kinetic_energy: m*q'^2/2
potential_energy: \"T*integral({of}, {range})\"
"
    )
}

#[test]
fn elliptic_integrals_are_resolved() {
    accepted(&integral("sqrt(1 + (q*pi/L*cos(pi*x/L))^2)", "x in 0..L"));
    accepted(&integral("sqrt(1 + (q*2*pi/L*cos(2*pi*x/L))^2)", "x in 0..L"));
    accepted(&integral("sqrt(a^2*cos(u)^2 + b^2*sin(u)^2)*(1 + q^2/L^2)", "u in 0..pi/2"));
    accepted(&integral("L/sqrt(1 + (q/L)^2*sin(u)^2)", "u in 0..pi/2"));
    accepted(&integral("sqrt(1 + 4*q^2*x^2/L^4)", "x in 0..L"));
    // Kinks at places that nothing tells stay what they are.
    refused(&integral("abs(sin(20*x/L))*q/L", "x in 0..L"), "is not resolved by any rule");
}
