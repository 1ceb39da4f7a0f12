//! States that are known to so many digits, and claims at the edge of what can be said: each beside a neighbour that is wrong.

use super::energies::warned;
use super::{accepted, refused};

#[test]
fn what_constraints_keep_at_zero_may_be_claimed() {
    let bar = |check: &str| {
        format!(
            "name: Bar
parameters: {{m: 1 kg, l: 0.5 m, d: 1 m, J: 0.1 kg*m^2, g: 9.81 m/s^2}}
coordinates: {{p: rad, x: m, y: m, th: rad}}
points: {{A: \"[x, y] - d/2*[cos(th), sin(th)]\", B: \"[x, y] + d/2*[cos(th), sin(th)]\", P: \"l*[sin(p), cos(p)]\"}}
bodies: {{bar: {{mass: m, inertia: J, angle: th, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{a: A - P, level: \"B.y - A.y\"}}
checks: {{c: \"{check}\"}}
scene: {{start: {{p: 0.3}}, guess: {{th: 0, x: 0.5, y: 0.5}}, until: 1}}
"
        )
    };
    for check in ["sin(th) = 0", "th' = 0", "th'' = 0", "B.y = l*cos(p)"] {
        accepted(&bar(check));
    }
    for check in ["sin(th) = 1e-9", "th' = 1e-9*p'", "th'' = 1e-9*p''", "B.y = (1 + 1e-9)*l*cos(p)"] {
        refused(&bar(check), "E502");
    }
    let door = |check: &str| {
        format!(
            "name: Door
parameters: {{m: 3 kg, A: 0.2 kg*m^2, B: 0.3 kg*m^2, C: 0.4 kg*m^2, l: 0.5 m, g: 9.81 m/s^2}}
coordinates: {{at: rotation, x: m, y: m, z: m}}
frames: {{F: {{rotate: at}}}}
points: {{O: [0, 0, 0], P: \"[x, y, z] - l*F.x\"}}
bodies: {{door: {{mass: m, inertia: [A, B, C], frame: F, position: \"[x, y, z]\"}}}}
gravity: [0, -g, 0]
joints: {{h: {{hinge: [door, ground], at: [P, O], axis: [F.z, ground.z]}}}}
checks: {{c: \"{check}\"}}
scene: {{start: {{at: {{vector: [0, 0, 0.3]}}}}, until: 2}}
"
        )
    };
    for check in ["moment(h) = [0, 0, 0]", "reaction(h).z = 0", "z = 0"] {
        accepted(&door(check));
    }
    for check in ["moment(h) = [0, 0, 1e-9*m*g*l]", "reaction(h).z = 1e-9*m*g", "z = 1e-9*x"] {
        refused(&door(check), "E502");
    }
}

#[test]
fn reactions_that_are_zero_are_equal() {
    let rod = |check: &str, sign: &str| {
        format!(
            "name: Guided
parameters: {{m: 1 kg, l: 0.5 m, g: 9.81 m/s^2, M: 2 kg}}
coordinates: {{a: rad, x: m, y: m}}
points: {{O: [0, 0], tip: \"l*[sin(a), -cos(a)]\"}}
bodies:
  rod: {{mass: M, inertia: M*l^2/12, angle: a, position: tip/2}}
  bob: {{mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {{joint: \"tip - [x, y]\", rail: x}}
balances:
  equations:
    - equation: \"[m*x'', m*y''] = [0, -m*g] {sign} F + [N, 0]\"
    - moment: {{about: O, of: [rod]}}
  reactions:
    F: {{on: bob, from: rod}}
    N: {{on: bob, along: ground.x}}
checks: {{F: \"{check}\"}}
scene: {{start: {{a: 0}}, guess: {{y: -0.5}}, until: 1}}
"
        )
    };
    accepted(&rod("F = -reaction(joint)", "+"));
    refused(&rod("F = -reaction(joint)", "-"), "E");
    refused(&rod("F = -(1 + 1e-9)*reaction(joint)", "+"), "E502");
}

#[test]
fn what_friction_holds_still_leaves_reactions_alone() {
    let brake = |equation: &str| {
        format!(
            "name: Brake
parameters: {{m: 1 kg, M: 2 kg, F: 20 N}}
coordinates: {{x: m, q: m}}
bodies:
  a: {{mass: M, position: \"[x, 0]\"}}
  b: {{mass: m, position: \"[q, 0]\"}}
forces: {{push: {{on: b, force: \"[F, 0]\"}}}}
constraints: {{pad: q}}
friction: {{rub: {{rate: q' - x', on: b, from: a, along: ground.x, limit: 5 N}}}}
balances:
  equations: [{{force: {{of: [a], along: ground.x}}}}, {{force: {{of: [b], along: ground.x}}}}, {{equation: \"{equation}\"}}]
  reactions: {{N: {{on: b, along: ground.x}}}}
scene: {{start: {{x': 1}}, until: 1}}
"
        )
    };
    accepted(&brake("N = reaction(pad)"));
    refused(&brake("N = -reaction(pad)"), "E517");
}

#[test]
fn a_heavy_body_does_not_hide_what_moves_a_light_one() {
    let equations = |mass: &str, force: &str| {
        format!(
            "name: T
parameters: {{m: 1 kg, M: {mass} kg, g: 9.81 m/s^2, k: 1 N/m}}
coordinates: {{x: m, y: m}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: M, position: \"[0, y]\"}}}}
gravity: [0, -g]
springs: {{s: {{stretch: x, stiffness: k, on: a, along: \"[1, 0]\"}}}}
balances: {{equations: [{{equation: \"m*x'' + M*y'' = {force} - M*g\"}}, {{equation: \"M*y'' = -M*g\"}}]}}
scene: {{start: {{x: 1}}, until: 1}}
"
        )
    };
    for mass in ["1", "1e16", "1e22"] {
        accepted(&equations(mass, "-k*x"));
        refused(&equations(mass, "-2*k*x"), "E506");
    }
    refused(&equations("1e16", "-(1 + 1e-6)*k*x"), "E506");
}

#[test]
fn edges_of_functions_are_met_by_rounding() {
    let pendulum = |check: &str| {
        format!(
            "name: T
parameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2}}
coordinates: {{th: rad}}
bodies: {{b: {{mass: m, inertia: m*l^2/12, angle: th, position: \"l*[sin(th), -cos(th)]\"}}}}
gravity: [0, -g]
checks: {{c: \"{check}\"}}
scene: {{start: {{th: 1}}, until: 1}}
"
        )
    };
    for check in [
        "acos(dot(unit(position(b)), -b.y)) = 0",
        "sqrt(sin(th)^2 + cos(th)^2 - 1) = 0",
        "asin(norm([sin(th), cos(th)])) = pi/2",
        "sin(1000*pi) = 0",
        "cos(100001*pi/2) = 0",
        "tan(1e6*pi) = 0",
    ] {
        accepted(&pendulum(check));
    }
    for check in [
        "acos(dot(unit(position(b)), -b.y)) = 1e-3",
        "sqrt(sin(th)^2 + cos(th)^2 - 1.001) = 0",
        "asin(norm([sin(th), cos(th)])) = pi/2 + 1e-3",
        "sin(1000*pi) = 1e-9",
        "sin(1000*pi + 1e-9) = 0",
    ] {
        refused(&pendulum(check), "E502");
    }
}

#[test]
fn every_coordinate_is_tried_at_zero_and_where_a_high_power_is_of_order_one() {
    let two = |check: &str| {
        format!(
            "name: T
parameters: {{m: 1 kg, k: 3 N/m, E: 1 J}}
coordinates: {{x: m, th: rad}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: m, inertia: 1 kg*m^2, angle: th, position: [0, 0]}}}}
springs: {{s: {{stretch: x, stiffness: k, on: a, along: \"[1, 0]\"}}}}
checks: {{c: \"{check}\"}}
scene: {{start: {{x: 0.1, th: 0.2}}, until: 2}}
"
        )
    };
    for q in ["x", "th"] {
        refused(&two(&format!("step({q})*step(-{q}) = 0")), "E502");
        refused(&two(&format!("sign({q})^2 = 1")), "E502");
        accepted(&two(&format!("step({q})*step(-{q}) + sign({q})^2 = 1")));
    }
    refused(&two("potential_energy = k*x^2/2 + E*(th/300)^12"), "E502");
    accepted(&two("potential_energy + E*(th/300)^12 = k*x^2/2 + E*(th^3/2.7e7)^4"));
}

/// A bob that is pulled to the origin, with a claim.
fn bob(spring: &str, more: &str) -> String {
    format!(
        "name: Bob
parameters: {{m: 1 kg, k: 1 N/m, g: 2 m/s^2, mu: 1 m^3/s^2}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
springs: {{s: {{between: [\"[0, 0]\", b], {spring}}}}}
{more}
scene: {{start: {{x: 1, y': 1.2}}, until: 10}}
"
    )
}

#[test]
fn nothing_jumps_where_no_motion_crosses() {
    let way = "conserved: {way: \"sign(x*y' - y*x')\"}";
    accepted(&bob("stiffness: k", way));
    refused(&bob("stiffness: k", &format!("gravity: [0, -g]\n{way}")), "E513");
    let periapsis = |claim: &str| {
        let h = "(x*y' - y*x')";
        let define = format!("define: {{ex: \"y'*{h}/mu - x/norm(b)\", ey: \"-x'*{h}/mu - y/norm(b)\"}}");
        bob("energy: -m*mu/length", &format!("{define}\nconserved: {{p: \"{claim}\"}}"))
    };
    accepted(&periapsis("atan2(ey, ex)"));
    refused(&periapsis("atan2(y, x)"), "E501");
    // One argument rises while the other falls.
    refused(&bob("stiffness: k", "conserved: {c: \"sign(x) + sign(y)\"}"), "E513");
}

#[test]
fn generalized_forces_that_repeat_gravity_or_a_spring_are_warned_of() {
    let ball = |force: &str| {
        format!(
            "name: Ball
parameters: {{m: 2 kg, g: 9.81 m/s^2, k: 20 N/m}}
coordinates: {{y: m}}
bodies: {{ball: {{mass: m, position: \"[0, y]\"}}}}
gravity: [0, -g]
springs: {{s: {{stretch: y, stiffness: k, along: ground.y, on: ball}}}}
generalized_forces: {{y: {force}}}
scene: {{start: {{y: 0.1 m}}, until: 3}}
"
        )
    };
    assert_eq!(warned(&ball("-m*g")), ["W419"]);
    assert_eq!(warned(&ball("-k*y")), ["W419"]);
    assert!(warned(&ball("-2*k*y")).is_empty());
}
