//! Friction that drives, and files in which nothing has mass.

use super::energies::warned;
use super::{accepted, refused};

/// A block on a floor with a force that is made of the floor's reaction.
fn block(floor: &str, force: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, g: 10 m/s^2, mu: 0.3 1, w: 2 m/s, R: 1 m}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: {floor}}}
forces: {{f: {{on: b, force: \"{force}\"}}}}
scene: {{start: {{x': 1}}, until: 3}}
"
    )
}

#[test]
fn friction_whose_reaction_has_the_wrong_sign_is_warned_of() {
    for (floor, force) in [
        ("-y", "[-mu*reaction(floor)*sign(x'), 0]"),
        ("y", "[mu*reaction(floor)*sign(x'), 0]"),
        ("3*R - y", "[-mu*reaction(floor)*sign(x'), 0]"),
        ("-y", "[-mu*reaction(floor)*x'/abs(x'), 0]"),
        ("-y", "-mu*reaction(floor)*unit(velocity(b))"),
        ("-y", "[-mu*reaction(floor)*tanh(x'/w), 0]"),
        ("-y", "[-mu*reaction(floor)*sign(x' - w), 0]"),
    ] {
        assert_eq!(warned(&block(floor, force)), ["W434"], "{floor} {force}");
    }
}

#[test]
fn friction_that_opposes_sliding_is_left_alone_and_so_are_belts_that_pull() {
    for (floor, force) in [
        ("y", "[-mu*reaction(floor)*sign(x'), 0]"),
        ("-y", "[mu*reaction(floor)*sign(x'), 0]"),
        ("y", "-mu*reaction(floor)*unit(velocity(b))"),
        // A belt that is faster does positive work on the block.
        ("y", "[-mu*reaction(floor)*sign(x' - w), 0]"),
        ("y", "[-mu*reaction(floor)*tanh((x' - w)/w), 0]"),
        // Traction, with either sign of the power.
        ("y", "[mu*reaction(floor), 0]"),
        // A motor that pushes on is no friction.
        ("y", "[mu*m*g*sign(x'), 0]"),
    ] {
        assert!(warned(&block(floor, force)).is_empty(), "{floor} {force}");
    }
    assert!(warned(include_str!("../../../models/stick_slip.yaml")).is_empty());
}

#[test]
fn friction_of_a_guide_that_pushes_to_both_sides_drives_on_one_of_them() {
    let hoop = |force: &str| {
        let text = block("x^2 + y^2 - R^2", force).replace("start: {x': 1}", "start: {x: 0, y: -1, x': 3, y': 0}");
        warned(&text)
    };
    assert_eq!(hoop("-2*mu*reaction(floor)*sign(x*y' - y*x')*[-y, x]"), ["W434"]);
    // Near the bottom the hoop pushes inwards all the time.
    let text = block("x^2 + y^2 - R^2", "2*mu*reaction(floor)*sign(x*y' - y*x')*[-y, x]");
    assert!(warned(&text.replace("start: {x': 1}", "start: {x: 0, y: -1, x': 1, y': 0}")).is_empty());
}

#[test]
fn constraints_of_what_has_no_mass_are_refused_as_a_run_would() {
    let decay = |more: &str| {
        format!(
            "name: Decay
parameters: {{tau: 1 s}}
coordinates: {{x: 1}}
constraints: {{growth: x' = x/tau}}
{more}
scene: {{start: {{x: 1}}, until: 1}}
"
        )
    };
    refused(&decay(""), "E433");
    accepted(&decay("kinetic_energy: x'^2/2"));
    let point = |mass: &str, constraints: &str| {
        format!(
            "name: T
parameters: {{l: 1 m, m: 1 kg}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: {mass}, position: \"[x, 0]\"}}}}
constraints: {{{constraints}}}
"
        )
    };
    refused(&point("0", "a: x - l, b: y - x"), "E433");
    refused(&point("0", "a: x' - y'"), "E433");
    // What has no mass follows from what has some.
    accepted(&point("m", "a: y - x"));
    accepted(&point("m", "a: y' = x/tau").replace("l: 1 m", "tau: 1 s"));
}
