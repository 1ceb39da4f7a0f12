//! Reactions as results; what a claim is tested with.

use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::load;

use super::{accepted, refused};

/// What is said of reactions that nothing confirms.
fn alone(text: &str) -> Vec<String> {
    load(text, &[]).and_then(judged).unwrap().report.alone
}

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
fn a_tension_that_nothing_else_tells_is_named() {
    // The lower rod is not named: it might pull anyhow.
    let along = "dot([sin(a), -cos(a)]";
    for bodies in ["m*acceleration(one) + n*acceleration(two)", "m*acceleration(one)"] {
        assert_eq!(
            alone(&chain(&format!("-{along}, {bodies} - (m + n)*[0, -g])"))),
            ["`tension` rests on balance 3 (equation) alone"]
        );
    }
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

/// A trolley on a rail that nobody named, driven, with a load on a rope of given length.
fn crane(tension: &str) -> String {
    format!(
        "name: Crane
parameters: {{m: 3 kg, M: 8 kg, L: 2 m, g: 9.81 m/s^2, w: 1.3 1/s, A: 0.4 m}}
coordinates: {{s: m, x: m, y: m}}
inputs: {{drive: A*(1 - cos(w*t))}}
points: {{block: \"[s, 0]\"}}
bodies: {{trolley: {{mass: M, position: \"[s, 0]\"}}, load: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{motor: s - drive, hoist: norm(load - block) - L}}
balances:
  equations:
    - force: {{of: [load]}}
    - equation: tension = {tension}
    - force: {{of: [trolley], along: [1, 0]}}
  reactions:
    tension: {{on: load, along: unit(block - load), from: trolley}}
    thrust: {{on: trolley, along: [1, 0]}}
scene: {{start: {{x: 0.3}}, guess: {{y: -2}}}}
"
    )
}

#[test]
fn a_guide_that_is_not_named_makes_nothing_wrong() {
    accepted(&crane("-reaction(hoist)"));
    assert_eq!(alone(&crane("-reaction(hoist)")), [""; 0]);
    refused(&crane("-1.000000001*reaction(hoist)"), "does not hold");
}

/// A block on a table, pulled by one that hangs over the edge: what the table pushes is said, and the pulley is left out.
fn pulley(normal: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, n: 2 kg, g: 10 m/s^2}}
coordinates: {{x: m}}
bodies: {{hanging: {{mass: m, position: \"[0, -x]\"}}, block: {{mass: n, position: \"[x, 0]\"}}}}
gravity: [0, -g]
balances: {{equations: [{{equation: \"(m + n)*x'' = m*g\"}}, {{equation: \"normal = {normal}\"}}], reactions: {{normal: {{on: block, along: \"[0, 1]\"}}}}}}
"
    )
}

#[test]
fn a_table_is_told_though_the_rope_over_the_pulley_is_not_named() {
    accepted(&pulley("n*g"));
    assert_eq!(alone(&pulley("n*g")), [""; 0]);
    refused(&pulley("(m + n)*g"), "`normal` is");
}

/// A block that is held down by two struts of which one is named; either half is as true.
const STRUTS: &str = "
name: T
parameters: {m: 1 kg, g: 10 m/s^2}
coordinates: {x: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
gravity: [0, -g]
balances: {equations: [{equation: \"m*x'' = 0\"}, {equation: \"first = m*g/2\"}, {equation: \"second = m*g/2\"}], reactions: {first: {on: b, along: \"[0, 1]\"}, second: {on: b, along: \"[0, 1]\"}}}
";

/// Friction that the file has as a force, with names for it and for the normal force.
const RUBS: &str = "
name: T
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.3 1, F: 9 N}
coordinates: {x: m, y: m}
bodies: {b: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {floor: y}
forces: {pull: {on: b, force: \"[F, 0]\"}, rubs: {on: b, force: \"[-mu*reaction(floor), 0]\"}}
balances: {equations: [{equation: \"m*x'' = F - friction\"}, {equation: \"normal = m*g\"}, {equation: \"friction = mu*normal\"}], reactions: {normal: {on: b, along: \"[0, 1]\"}, friction: {on: b, along: \"[-1, 0]\"}}}
scene: {start: {x': 1}, until: 1}
";

#[test]
fn reactions_that_share_a_direction_and_names_of_given_forces_are_accepted() {
    accepted(STRUTS);
    assert_eq!(alone(STRUTS).len(), 2);
    accepted(RUBS);
    refused(&RUBS.replace("normal = m*g", "normal = 2*m*g").replace("mu*normal", "mu*normal/2"), "`normal` is");
}

/// A bar that turns about a pin, the pin's force as a vector.
fn bar(force: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2}}
coordinates: {{th: rad}}
bodies: {{bar: {{mass: m, inertia: m*l^2/12, angle: th, position: l/2*bar.x}}}}
gravity: [0, -g]
balances: {{equations: [{{equation: \"m*l^2/3*th'' = -m*g*l/2*cos(th)\"}}, {{equation: \"pin = {force}\"}}], reactions: {{pin: {{on: bar, at: \"[0, 0]\"}}}}}}
"
    )
}

#[test]
fn the_force_of_a_pin_is_told_by_its_bar() {
    accepted(&bar("m*acceleration(bar) - m*[0, -g]"));
    refused(&bar("m*acceleration(bar) + m*[0, -g]"), "`pin.y` is");
    refused(&bar("m*acceleration(bar)*1.000000001 - m*[0, -g]"), "`pin.x` is");
}

/// Rows of constraints that always hold stand beside those of friction and contacts in a system of balances: only the latter are judged with it.
#[test]
fn a_reaction_that_an_equation_names_may_stand_beside_friction_and_contacts() {
    let file = |beside: &str, equation: &str| {
        format!(
            "name: P\nparameters: {{m: 2 kg, g: 9.81 m/s^2, mu: 0.3, L: 1 m}}\ncoordinates: {{x: m, y: m, z: m}}\n\
             bodies: {{b: {{mass: m, position: \"[x, y]\"}}, c: {{mass: m, position: \"[z, 0]\"}}}}\ngravity: [0, -g]\n\
             constraints: {{floor: y}}\n{beside}\nbalances:\n  equations:\n    - force: {{of: [b]}}\n    - force: {{of: [c], along: ground.x}}\n    \
             - equation: \"N = {equation}\"\n  reactions: {{N: {{on: b, along: \"[0,1]\"}}}}\nscene: {{start: {{x': 2, z: 2}}, until: 0.1}}\n"
        )
    };
    let friction = "friction: {rub: {rate: x', on: b, along: \"[1,0]\", limit: mu*m*g}}";
    let contact = "contacts: {wall: {gap: z - x - L, on: c, from: b, normal: \"[1,0]\"}}";
    for beside in [friction, contact] {
        accepted(&file(beside, "reaction(floor)"));
        refused(&file(beside, "1.000001*reaction(floor)"), "E517 balance 3");
    }
}

/// Atwood's machine: the forces at both ends of its rope.
fn atwood(ends: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, n: 2 kg, g: 10 m/s^2, L: 3 m}}
coordinates: {{y: m}}
bodies: {{a: {{mass: m, position: \"[0, y]\"}}, b: {{mass: n, position: \"[1, L - y]\"}}}}
gravity: [0, -g]
balances: {{equations: [{{equation: \"(m + n)*y'' = (n - m)*g\"}}, {ends}], reactions: {{S: {{on: a, along: \"[0, 1]\"}}, R: {{on: b, along: \"[0, 1]\"}}}}}}
"
    )
}

#[test]
fn the_force_of_a_rope_is_told_by_both_of_its_ends() {
    let ends = |s: &str, r: &str| atwood(&format!("{{equation: \"S = {s}\"}}, {{equation: \"R = {r}\"}}"));
    accepted(&ends("2*m*n/(m + n)*g", "S"));
    assert_eq!(alone(&ends("2*m*n/(m + n)*g", "S")), [""; 0]);
    refused(&ends("m*n/(m + n)*g", "S"), "`S` is");
    refused(&ends("2*m*n/(m + n)*g", "n*g"), "`R` is");
    // Where a spring acts, a name may be that of its force, and the rod between the blocks is named at one end only.
    let spring = "
name: T
parameters: {m: 1 kg, n: 2 kg, k: 3 N/m, d: 1 m}
coordinates: {x: m}
bodies: {a: {mass: m, position: \"[x, 0]\"}, b: {mass: n, position: \"[x + d, 0]\"}}
springs: {s: {between: [ground, a], stiffness: k}}
balances: {equations: [{equation: \"(m + n)*x'' = S\"}, {equation: \"S = -k*x\"}, {equation: \"R = n*x''\"}], reactions: {S: {on: a, along: \"[1, 0]\"}, R: {on: b, along: \"[1, 0]\"}}}
";
    accepted(spring);
}

/// A bead on an arm that turns about a pin which nobody names.
fn bead(normal: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, g: 10 m/s^2, l: 1 m}}
coordinates: {{th: rad, s: m}}
bodies: {{arm: {{mass: m, inertia: m*l^2/12, angle: th, position: \"l/2*arm.x\"}}, bead: {{mass: m, position: \"s*arm.x\"}}}}
gravity: [0, -g]
balances:
  equations:
    - moment: {{about: \"[0, 0]\", of: [arm, bead]}}
    - force: {{of: bead, along: arm.x}}
    - equation: \"N = {normal}\"
  reactions: {{N: {{on: bead, from: arm, along: arm.y}}}}
"
    )
}

#[test]
fn what_a_pin_that_is_not_named_may_take_is_named() {
    for normal in ["m*(s*th'' + 2*s'*th') + m*g*cos(th)", "m*(s*th'' + s'*th') + m*g*cos(th)"] {
        assert_eq!(alone(&bead(normal)), ["`N` rests on balance 3 (equation) alone"]);
    }
}

/// What pins, rods and other bodies that nobody named push across the way is in no force balance that could be formed.
#[test]
fn guides_that_bear_more_than_their_own_body_are_accepted() {
    let crank = "
name: T
parameters: {m: 1 kg, r: 0.3 m, L: 1 m, g: 10 m/s^2, T: 2 N*m}
coordinates: {a: rad}
define: {b: asin(r*sin(a)/L), W: \"[0, -m*g]\"}
points: {A: \"r*[cos(a), sin(a)]\", B: \"[r*cos(a) + L*cos(b), 0]\"}
bodies:
  crank: {mass: m, inertia: m*r^2/12, angle: a, position: A/2}
  rod: {mass: m, inertia: m*L^2/12, angle: -b, position: (A + B)/2}
  slider: {mass: m, position: B}
gravity: [0, -g]
torques: {t: {on: crank, torque: T}}
balances:
  equations:
    - power: {of: all}
    - equation: \"N*(r*cos(a) + L*cos(b)) = cross(A/2, m*acceleration(crank) - W) + m*r^2/12*a'' + cross((A + B)/2, m*acceleration(rod) - W) - m*L^2/12*rate(rate(b)) + cross(B, m*acceleration(slider) - W) - T\"
  reactions: {N: {on: slider, along: \"[0, 1]\"}}
scene: {start: {a: 0.3, a': 1}, until: 1}
";
    let cart = "
name: T
parameters: {M: 2 kg, m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {x: m, th: rad}
bodies: {cart: {mass: M, position: \"[x, 0]\"}, bob: {mass: m, position: \"[x + l*sin(th), -l*cos(th)]\"}}
gravity: [0, -g]
balances:
  equations:
    - force: {of: all, along: \"[1, 0]\"}
    - equation: \"l*th'' + x''*cos(th) + g*sin(th) = 0\"
    - equation: \"N = (M + m)*g + m*dot(acceleration(bob), [0, 1])\"
  reactions: {N: {on: cart, along: \"[0, 1]\"}}
";
    let stack = "
name: T
parameters: {M: 2 kg, m: 1 kg, h: 1 m, g: 10 m/s^2}
coordinates: {x: m, z: m}
bodies: {low: {mass: M, position: \"[x, 0]\"}, high: {mass: m, position: \"[z, h]\"}}
gravity: [0, -g]
balances: {equations: [{equation: \"M*x'' = 0\"}, {equation: \"m*z'' = 0\"}, {equation: \"N = (M + m)*g\"}], reactions: {N: {on: low, along: \"[0, 1]\"}}}
";
    for text in [crank, cart, stack] {
        accepted(text);
        assert_eq!(alone(text).len(), 1, "{text}");
    }
}

/// Two wheels on fixed axles that nobody names, with what the force between their teeth is said to be.
fn gear(teeth: &str) -> String {
    format!(
        "name: T
parameters: {{J: 1 kg*m^2, I: 2 kg*m^2, r: 0.5 m, R: 1 m, T: 3 N*m}}
coordinates: {{a: rad}}
points: {{P: \"[r, 0]\"}}
bodies: {{one: {{mass: 0, inertia: J, angle: a, position: \"[0, 0]\"}}, two: {{mass: 0, inertia: I, angle: -a*r/R, position: \"[r + R, 0]\"}}}}
torques: {{t: {{on: one, torque: T}}}}
balances: {{equations: [{{equation: \"(J + I*(r/R)^2)*a'' = T\"}}, {{equation: \"W = {teeth}\"}}], reactions: {{W: {{on: two, from: one, at: P, along: \"[0, 1]\"}}}}}}
"
    )
}

#[test]
fn axles_that_do_not_move_need_not_be_named() {
    accepted(&gear("I*a''*r/R/R"));
    assert_eq!(alone(&gear("I*a''*r/R/R")), [""; 0]);
    refused(&gear("-I*a''*r/R/R"), "`W` is");
    refused(&gear("T/r"), "`W` is");
}
