//! Friction that drives, and files in which nothing has mass.

use dalembert_symbolic::gate::shared_data;
use dalembert_symbolic::lower::compile;

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

/// A block on a spring that rubs on a belt, with a claim.
fn rubbing(more: &str) -> String {
    format!(
        "name: T
parameters: {{m: 1 kg, k: 20 N/m, g: 9.81 m/s^2, mu: 0.3 1, v: 0.2 m/s}}
coordinates: {{x: m}}
bodies: {{block: {{mass: m, position: \"[x, 0]\"}}}}
springs: {{s: {{stretch: x, stiffness: k, on: block, along: \"[1, 0]\"}}}}
friction: {{rub: {{rate: x' - v, on: block, along: \"[1, 0]\", limit: mu*m*g, static: 2*mu*m*g}}}}
{more}
scene: {{start: {{x: 1, x': 0}}, until: 8}}
"
    )
}

#[test]
fn what_slips_forwards_is_judged_where_it_slides_forwards() {
    let equation = |sign: &str| {
        let right = format!("-k*x + reaction(rub) {sign} mu*m*g*sign(x' - v)");
        rubbing(&format!("balances: {{equations: [{{equation: \"m*x'' = {right}\"}}]}}"))
    };
    accepted(&equation("-"));
    refused(&equation("+"), "E517");
    // The term that is wrong is named, though a reaction stands in the equation.
    let problems = compile(&equation("+"), &[]).err().unwrap_or_default();
    assert!(problems[0].help.contains("opposite sign of `mu*m*g*sign(x' - v)`"), "{problems:?}");
    let shared = shared_data(&compile(&equation("-"), &[]).expect("a model").model);
    assert_eq!(shared, ["masses", "positions", "springs", "friction"]);
    let loss = |right: &str| {
        rubbing(&format!("checks: {{loss: \"rate(energy) = {right}\"}}")).replace("rate: x' - v", "rate: x'")
    };
    accepted(&loss("-mu*m*g*abs(x')"));
    refused(&loss("mu*m*g*abs(x')"), "E502");
    refused(&loss("-mu*m*g*x'"), "E502");
}

#[test]
fn a_gap_that_is_open_is_judged_where_it_is() {
    let block = |more: &str| {
        format!(
            "name: T
parameters: {{m: 1 kg, g: 9.81 m/s^2, mu: 0.3 1, R: 1 m}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
{more}
"
        )
    };
    let on_the_floor = |check: &str| {
        let contact = "contacts: {floor: {gap: y, on: b, normal: \"[0, 1]\", friction: mu}}";
        block(&format!("{contact}\nchecks: {{c: \"{check}\"}}\nscene: {{start: {{y: 0, x': 1}}, until: 2}}"))
    };
    accepted(&on_the_floor("y = abs(y)"));
    refused(&on_the_floor("x = abs(x)"), "E502");
    accepted(&on_the_floor("rate(energy) = -mu*reaction(floor)*abs(x')"));
    refused(&on_the_floor("rate(energy) = -mu*reaction(floor)*x'"), "E502");
    // A gap that is no straight line's: inside of a hoop.
    let in_a_hoop = |check: &str| {
        let contact = "contacts: {hoop: {gap: R - norm(b), on: b, normal: \"-1*b\"}}";
        block(&format!("{contact}\nchecks: {{c: \"{check}\"}}\nscene: {{start: {{y: -0.5}}, until: 2}}"))
    };
    accepted(&in_a_hoop("max(norm(b), R) = R"));
    refused(&in_a_hoop("max(norm(b), R/2) = norm(b)"), "E502");
}

#[test]
fn claims_and_balances_may_name_what_contacts_do() {
    let claim = |holds: &str, phase: &str| rubbing(&format!("checks: {{c: {{holds: \"{holds}\", phase: {phase}}}}}"));
    accepted(&claim("reaction(rub) = k*x", "rub sticks"));
    accepted(&claim("m*x'' = -k*x - mu*m*g", "rub slips forwards"));
    refused(&claim("m*x'' = -k*x - mu*m*g", "rub slips backwards"), "E502");
    accepted(&claim("abs(m*x'' + k*x) = mu*m*g", "[rub slips forwards, rub slips backwards]"));
    refused(&claim("x = x", "rub stick"), "E236");
    refused(&claim("x = x", "[]"), "E317");
    refused(&claim("x = x", "'rub sticks, rub slips forwards'"), "E328");
    refused(&rubbing("forces: {f: {on: block, force: \"[-k*x, 0]\", phase: rub sticks}}"), "E327");
    let system = |force: &str, phase: &str| {
        rubbing(&format!("balances: {{phase: {phase}, equations: [{{equation: \"m*x'' = -k*x {force}\"}}]}}"))
    };
    accepted(&system("- mu*m*g", "rub slips forwards"));
    accepted(&system("+ mu*m*g", "rub slips backwards"));
    refused(&system("+ mu*m*g", "rub slips forwards"), "E506");
}

/// A family of frictions or contacts has base cases as all families have.
#[test]
fn families_of_contacts_have_base_cases() {
    let row = |friction: &str, contacts: &str| {
        format!(
            "name: Row\nsizes: {{n: 3}}\nparameters: {{m: 1 kg, g: 10 m/s^2, mu: 0.2 1}}\n\
             coordinates: {{\"x[i in 1..n]\": m, \"y[i in 1..n]\": m}}\n\
             bodies: {{\"b[i in 1..n]\": {{mass: m, position: '[x[i], y[i]]'}}}}\ngravity: [0, -g]\n\
             friction: {{\"f[1]\": {{rate: \"x[1]'\", on: 'b[1]', along: '[1, 0]', limit: 1 N}}, {friction}}}\n\
             contacts:\n  \"c[1]\": {{gap: 'y[1]', on: 'b[1]', normal: '[0, 1]'}}\n  \
             \"{contacts}\": {{gap: 'y[i]', on: 'b[i]', normal: '[0, 1]', friction: mu}}\n"
        )
    };
    let pushed =
        "\"f[i in 2..n]\": {rate: \"x[i]' - x[i-1]'\", on: 'b[i]', from: 'b[i-1]', along: '[1, 0]', limit: 1 N}";
    accepted(&row(pushed, "c[i in 2..n]"));
    refused(&row(pushed, "c[i in 1..n]"), "`c[1]` is given twice in `contacts`");
    refused(&row(pushed, "f[i in 4..n]"), "`f` is given twice in `constraints`, `joints`, `friction` and `contacts`");
}

/// In every motion in which the gap stays closed the force across is a multiplier of the balances, so that they agree whichever body it acts on.
#[test]
fn what_a_contact_touches_is_judged_where_balances_need_it() {
    let balls = |from: &str, balances: &str| {
        format!(
            "name: Balls
parameters: {{m: 3 kg, g: 9.81 m/s^2}}
coordinates: {{a: m, b: m, c: m}}
bodies: {{low: {{mass: m, position: \"[0, a]\"}}, mid: {{mass: m, position: \"[0, b]\"}}, top: {{mass: m, position: \"[0, c]\"}}}}
gravity: [0, -g]
contacts:
  floor: {{gap: a, on: low, normal: \"[0, 1]\"}}
  one: {{gap: b - a, on: mid, from: low, normal: \"[0, 1]\"}}
  two: {{gap: c - b, on: top, {from} normal: \"[0, 1]\"}}
impacts: sequential
{balances}
scene: {{start: {{a: 1, b: 2, c: 3}}}}
"
        )
    };
    let of = |name: &str| format!("{name}: {{force: {{of: {name}, along: \"[0, 1]\"}}}}");
    let each = format!("balances: {{equations: {{{}, {}, {}}}}}", of("low"), of("mid"), of("top"));
    accepted(&balls("from: mid,", &each));
    for from in ["from: low,", ""] {
        refused(&balls(from, &each), "does not open along its normal");
        accepted(&balls(from, ""));
    }
}
