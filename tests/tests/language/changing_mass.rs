//! Section 3: masses that change, and what leaves or comes.

use dalembert::Method;
use dalembert_symbolic::lower::compile;
use dalembert_tests::case::Case;

use crate::near;

/// A particle on a line whose mass is `mass`; `exchange` says what becomes of the rest.
fn particle(mass: &str, exchange: &str, more: &str) -> String {
    format!(
        "name: Particle
parameters: {{m0: 10 kg, r: 0.5 kg/s, c: 40 m/s, g: 9.8 m/s^2, line: 3 kg/m}}
coordinates: {{x: m}}
bodies: {{b: {{mass: {mass}, position: \"[x, 0]\"{exchange}}}}}
{more}"
    )
}

fn codes(text: &str) -> Vec<&'static str> {
    compile(text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect()
}

#[track_caller]
fn end_of(text: &str) -> Vec<f64> {
    let run = Case::written(text).tolerance(1e-12).run();
    assert!(run.warnings.is_empty(), "{:?}", run.warnings);
    let end = run.last();
    [end.q, end.v].concat()
}

#[test]
fn a_rocket_reaches_what_tsiolkovsky_says() {
    let text = particle(
        "m0 - r*t",
        ", loses: {velocity: \"[x' - c, 0]\"}",
        "gravity: [-g, 0]\nscene: {start: {x: 0}, until: 15}\n",
    );
    let end = end_of(&text);
    let (m0, r, c, g, t) = (10.0_f64, 0.5, 40.0, 9.8, 15.0);
    let ratio = (m0 / (m0 - r * t)).ln();
    near(end[1], c * ratio - g * t, 1e-10);
    near(end[0], c * t - c * (m0 - r * t) / r * ratio - g * t * t / 2.0, 1e-9);
}

/// Cayley, 1857: x'' = g/3.
#[test]
fn a_chain_that_is_pulled_from_a_heap_falls_with_a_third_of_gravity() {
    let text = particle(
        "line*x",
        ", gains: {velocity: [0, 0]}",
        "gravity: [g, 0]\nscene: {start: {x: 1, x': 0}, until: 2}\nchecks: {motion: \"x*x'' + x'^2 = g*x\"}\n",
    );
    assert_eq!(codes(&text), [""; 0]);
    // x² x'² = 2 g (x³ − 1)/3.
    let end = end_of(&text);
    near(end[0].powi(2) * end[1].powi(2), 2.0 * 9.8 * (end[0].powi(3) - 1.0) / 3.0, 1e-9 * end[0].powi(3));
}

#[test]
fn sand_that_falls_on_a_cart_slows_it_and_sand_that_leaves_with_it_does_not() {
    let scene = "scene: {start: {x: 0, x': 2}, until: 8}\n";
    let falls = end_of(&particle("m0 + r*t", ", gains: {velocity: [0, -3]}", scene));
    near(falls[1], 2.0 * 10.0 / 14.0, 1e-11);
    for exchange in ["", ", loses: {}"] {
        let leaves = end_of(&particle("m0 - r*t", exchange, scene));
        near(leaves[1], 2.0, 1e-12);
        near(leaves[0], 16.0, 1e-11);
    }
}

#[test]
fn fuel_may_be_a_state() {
    let lines = "gravity: [-g, 0]\nscene: {start: {x: 0, FUEL}, until: 9}\n";
    let exchange = ", loses: {velocity: \"[x' - c, 0]\"}";
    let of_time = particle("m0 - r*t*t/(2 s)", &exchange.replace("(2 s)", "2"), &lines.replace(", FUEL", ""));
    let of_time = of_time.replace("r*t*t/(2 s)", "q*t^2").replace("parameters: {", "parameters: {q: 0.05 kg/s^2, ");
    let states = "states: {fuel: {unit: kg, rate: \"-2*q*t\"}}\n";
    let of_state = particle("m0 + fuel", exchange, &(states.to_owned() + &lines.replace("FUEL", "fuel: 0")));
    let of_state = of_state.replace("parameters: {", "parameters: {q: 0.05 kg/s^2, ");
    let (a, b) = (end_of(&of_time), end_of(&of_state));
    // The state's integral is the second coordinate.
    near(a[0], b[0], 1e-9);
    near(a[1], b[2], 1e-10);
}

#[test]
fn along_a_constraint_it_is_the_motion_of_the_one_coordinate_that_is_left() {
    let slide = |coordinates: &str, place: &str, more: &str| {
        format!(
            "name: Slide
parameters: {{dry: 2 kg, r: 0.3 kg/s, c: 50 m/s, g: 9.8 m/s^2, s: 1 m}}
coordinates: {{{coordinates}}}
states: {{fuel: {{unit: kg, rate: -r}}}}
bodies: {{b: {{mass: dry + fuel, position: \"{place}\", loses: {{velocity: \"velocity(b) - [c, 0]\"}}}}}}
gravity: [0, -g]
scene: {{start: {{x: 1, fuel: 3 kg}}, until: 6}}
{more}"
        )
    };
    let held = slide("x: m, y: m", "[x, y]", "constraints: {ramp: y - x^2/(4*s)}\n");
    let free = slide("x: m", "[x, x^2/(4*s)]", "");
    for method in [Method::Dop853, Method::Gauss4, Method::Taylor] {
        let end = |text: &str| {
            let mut case = Case::written(text).tolerance(1e-11);
            case.settings.method = method;
            case.run().last()
        };
        let (held, free) = (end(&held), end(&free));
        near(held.q[0], free.q[0], 1e-8);
        near(held.v[2], free.v[1], 1e-11);
    }
}

/// The equations per unit of mass, with the thrust as a generalized force, by hand.
#[test]
fn a_nozzle_that_points_aside_turns_the_body() {
    let parameters = "parameters: {m0: 100 kg, r: 2 kg/s, c: 400 m/s, k: 0.7 m, b: 1.5 m, tilt: 0.02 rad, g: 2 m/s^2}
coordinates: {x: m, y: m, th: rad}
scene: {start: {th: 0.1}, until: 8}
";
    let bodies = format!(
        "name: Nozzle
{parameters}frames: {{B: {{angle: th}}}}
points: {{tail: \"[x, y] - b*B.y\"}}
bodies:
  hull:
    mass: m0 - r*t
    inertia: (m0 - r*t)*k^2
    position: [x, y]
    frame: B
    loses: {{velocity: velocity(tail) - c*(B.y*cos(tilt) - B.x*sin(tilt)), at: tail}}
gravity: [0, -g]
balances:
  by_moment:
    equations: [{{force: {{of: [hull]}}}}, {{moment: {{about: tail, of: [hull]}}}}]
  by_power:
    equations: [{{force: {{of: [hull]}}}}, {{power: {{of: [hull]}}}}]
"
    );
    let by_hand = format!(
        "name: Hand
{parameters}define: {{a: r*c/(m0 - r*t), along: sin(tilt)*cos(th) + cos(tilt)*sin(th), up: cos(tilt)*cos(th) - sin(tilt)*sin(th)}}
kinetic_energy: (x'^2 + y'^2 + k^2*th'^2)/2
generalized_forces: {{x: -a*along, y: a*up - g, th: -a*b*sin(tilt)}}
"
    );
    let (found, expected) = (end_of(&bodies), end_of(&by_hand));
    for (found, expected) in found.iter().zip(&expected) {
        near(*found, *expected, 1e-9 * expected.abs().max(1.0));
    }
}

#[test]
fn in_space_euler_s_equations_hold_with_moments_that_are_held() {
    let text = "name: Burning
parameters: {m: 5 kg, A: 1 kg*m^2, B: 2 kg*m^2, C: 2.5 kg*m^2, r: 0.05 kg/s, g: 9.8 m/s^2}
coordinates: {x: m, y: m, z: m, a: rad, b: rad, c: rad}
define: {mass: m - r*t, s: (m - r*t)/m}
frames: {F: {rotate: [[z, a], [x, b], [z, c]]}}
bodies:
  hull:
    mass: mass
    inertia: [A*s, B*s, C*s]
    frame: F
    position: [x, y, z]
    loses: {velocity: \"velocity(hull) - 50 m/s*F.z\"}
gravity: [0, 0, -g]
balances: {equations: [{force: {of: [hull]}}, {moment: {about: \"[x, y, z]\", of: [hull]}}]}
checks:
  p: \"dot(rate(angular_velocity(hull)), F.x)*A - (B - C)*dot(angular_velocity(hull), F.y)*dot(angular_velocity(hull), F.z) = 0\"
scene: {start: {b: 1, a': 1, b': 0.3, c': 2}, until: 3}
";
    let text = text.replace("50 m/s*F.z", "w*F.z").replace("parameters: {", "parameters: {w: 50 m/s, ");
    assert_eq!(codes(&text), [""; 0]);
    end_of(&text);
}

#[test]
fn an_independent_balance_sees_a_wrong_velocity() {
    let balance = |line: &str| format!("gravity: [-g, 0]\nbalances: {{equations: [{{equation: \"{line}\"}}]}}\n");
    let rocket = |velocity: &str, line: &str| {
        codes(&particle("m0 - r*t", &format!(", loses: {{velocity: \"[{velocity}, 0]\"}}"), &balance(line)))
    };
    assert_eq!(rocket("x' - c", "rate((m0 - r*t)*x') = -r*(x' - c) - (m0 - r*t)*g"), [""; 0]);
    for (velocity, line) in [
        ("x' + c", "rate((m0 - r*t)*x') = -r*(x' - c) - (m0 - r*t)*g"),
        ("x' - c", "rate((m0 - r*t)*x') = r*c - (m0 - r*t)*g"),
        ("-c", "rate((m0 - r*t)*x') = -r*(x' - c) - (m0 - r*t)*g"),
    ] {
        assert_eq!(rocket(velocity, line), ["E506"], "{velocity} and {line}");
    }
}

#[test]
fn momentum_is_conserved_where_what_comes_brings_none() {
    let claim = "conserved: {p: momentum(b).x}\nscene: {start: {x': 1}}\n";
    assert_eq!(codes(&particle("m0 + r*t", ", gains: {velocity: [0, 0]}", claim)), [""; 0]);
    for exchange in [", gains: {}", "", ", gains: {velocity: \"[c, 0]\"}"] {
        assert_eq!(codes(&particle("m0 + r*t", exchange, claim)), ["E501"], "{exchange}");
    }
}

#[test]
fn what_is_not_said_or_makes_no_sense_is_refused() {
    let of = |mass: &str, exchange: &str| codes(&particle(mass, exchange, ""));
    let own = ", loses: {velocity: [0, 0]}";
    for (mass, exchange, code) in [
        ("line*x", "", "E459"),
        ("m0", own, "E460"),
        ("m0*step(t/q)", own, "E461"),
        ("m0*(2 + sign(x/q2))", own, "E461"),
        ("m0 - r*x'/q3", own, "E213"),
    ] {
        let text = particle(mass, exchange, "").replace("parameters: {", "parameters: {q: 1 s, q2: 1 m, q3: 1 m/s^2, ");
        let found = codes(&text);
        assert!(found.contains(&code), "{mass}: {found:?}");
    }
    assert_eq!(of("m0 - r*t", ", loses: {}, gains: {}"), ["E305"]);
    assert_eq!(of("m0 - r*t", ", loses: {speed: 3}"), ["E301"]);
    assert_eq!(of("line*x", own), [""; 0]);
    let turning = "name: Skater
parameters: {J: 1 kg*m^2, r: 0.1 1/s, m: 60 kg, q: 1 kg/s}
coordinates: {phi: rad}
bodies: {skater: {mass: MASS, inertia: J*(1 - r*t), angle: phi, position: [0, 0]}}
";
    assert_eq!(codes(&turning.replace("MASS", "m")), ["E459"]);
    assert_eq!(codes(&turning.replace("MASS", "m - q*t")), ["E459"]);
    assert_eq!(codes(&turning.replace("MASS", "m - q*t, loses: {}")), [""; 0]);
    // What a constant mass is told does: the energy of the turning, without the inertia.
    let energy = "position: [0, 0]}}\nkinetic_energy: J*(1 - r*t)*phi'^2/2";
    let by_energy = turning.replace("inertia: J*(1 - r*t), angle: phi, position: [0, 0]}}", energy);
    assert_eq!(codes(&by_energy.replace("MASS", "m")), [""; 0]);
}

#[test]
fn an_energy_balance_does_not_see_what_mass_takes_along() {
    let balance = |kind: &str| format!("gravity: [g, 0]\nbalances: {{equations: [{kind}]}}\n");
    let chain = |kind: &str| codes(&particle("line*x", ", gains: {velocity: [0, 0]}", &balance(kind)));
    assert_eq!(chain("energy: {}"), ["E416"]);
    assert_eq!(chain("{power: {of: [b]}}"), [""; 0]);
}
