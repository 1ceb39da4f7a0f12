//! Reactions as results; what a claim is tested with.

use super::{accepted, refused};

/// A pendulum whose tension is one written-out equation.
fn pendulum(tension: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, g: 10 m/s^2, l: 1 m}}
coordinates: {{th: rad}}
bodies: {{b: {{mass: m, position: \"l*[sin(th), -cos(th)]\"}}}}
gravity: [0, -g]
balances: {{equations: [{{equation: \"m*l*th'' = -m*g*sin(th)\"}}, {{equation: \"tension = {tension}\"}}], reactions: {{tension: {{on: b, along: \"-[sin(th), -cos(th)]\"}}}}}}
"
    )
}

#[test]
fn a_tension_without_its_centripetal_part_is_refused() {
    refused(&pendulum("m*g*cos(th)"), "`tension` is");
    refused(&pendulum("m*g*cos(th) + 1.000000001*m*l*th'^2"), "`tension` is");
    refused(&pendulum("-m*g*cos(th) - m*l*th'^2"), "`tension` is");
    accepted(&pendulum("m*g*cos(th) + m*l*th'^2"));
}

/// A block on a floor, with what its normal force is said to be.
fn block(normal: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, g: 10 m/s^2}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: y}}
balances: {{equations: [{{equation: \"m*x'' = 0\"}}, {{equation: \"normal = {normal}\"}}], reactions: {{normal: {{on: b, along: \"[0, 1]\"}}}}}}
"
    )
}

#[test]
fn a_normal_force_of_twice_the_weight_is_refused() {
    refused(&block("2*m*g"), "`normal` is");
    accepted(&block("m*g"));
}

/// A particle on a rod, whose tension is said by the multiplier.
fn rod(tension: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, g: 10 m/s^2, l: 1 m}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{rod: x^2 + y^2 - l^2}}
balances: {{equations: [{{force: {{of: [b]}}}}, {{equation: \"tension = {tension}\"}}], reactions: {{tension: {{on: b, along: \"-[x, y]\"}}}}}}
scene: {{start: {{x: 0.6}}}}
"
    )
}

#[test]
fn the_multiplier_of_a_rod_is_lagranges() {
    refused(&rod("-reaction(rod)*l"), "multiplier");
    refused(&rod("2*reaction(rod)*l"), "multiplier");
    accepted(&rod("-2*reaction(rod)*l"));
}

/// Two particles on rods, one below the other: only the upper tension is named.
fn chain(tension: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, n: 2 kg, g: 10 m/s^2, l: 1 m}}
coordinates: {{a: rad, b: rad}}
points: {{p: \"l*[sin(a), -cos(a)]\", r: \"p + l*[sin(b), -cos(b)]\"}}
bodies: {{one: {{mass: m, position: p}}, two: {{mass: n, position: r}}}}
gravity: [0, -g]
balances:
  equations:
    - moment: {{about: \"[0, 0]\", of: all}}
    - moment: {{about: p, of: [two]}}
    - equation: \"tension = {tension}\"
  reactions: {{tension: {{on: one, along: \"-[sin(a), -cos(a)]\"}}}}
"
    )
}

#[test]
fn a_system_that_leaves_a_rod_out_is_compared_with_both_bodies() {
    let along = "dot([sin(a), -cos(a)]";
    accepted(&chain(&format!("-{along}, m*acceleration(one) + n*acceleration(two) - (m + n)*[0, -g])")));
    refused(&chain(&format!("-{along}, m*acceleration(one) - (m + n)*[0, -g])")), "`tension` is");
}

/// Two blocks that push each other, with what the contact's force is said to be.
fn blocks(contact: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, n: 2 kg, F: 3 N, l: 1 m}}
coordinates: {{x: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}, c: {{mass: n, position: \"[x + l, 0]\"}}}}
forces: {{f: {{on: b, force: \"[F, 0]\"}}}}
balances: {{equations: [{{equation: \"(m + n)*x'' = F\"}}, {{equation: \"contact = {contact}\"}}], reactions: {{contact: {{on: c, along: \"[1, 0]\", from: b}}}}}}
"
    )
}

#[test]
fn the_force_between_two_blocks_is_that_of_either() {
    refused(&blocks("m*F/(m + n)"), "`contact` is");
    accepted(&blocks("n*F/(m + n)"));
}
