//! More of what seems not to act, and does: by an event, a phase, a resonance, an instability, or with another.

use dalembert::needs::{Needs, Verdict};

use super::{change, chosen, found, holds, oscillator, reduction};

/// Whether an ingredient is found to act, by what is wanted or by what happens.
fn acts(needs: &Needs, ingredient: &str) {
    let verdict = &reduction(needs, ingredient).verdict;
    let acts = matches!(verdict, Verdict::Acts | Verdict::HappensOtherwise { .. } | Verdict::Near { .. });
    assert!(acts, "{ingredient}: {verdict}\n{}", needs.table());
    let left = needs.choice.as_ref().is_some_and(|choice| choice.members.iter().any(|name| name == ingredient));
    assert!(!left, "{}", needs.table());
}

fn goes(needs: &Needs, ingredient: &str) {
    assert_eq!(reduction(needs, ingredient).verdict, Verdict::Serves, "{ingredient}\n{}", needs.table());
}

#[test]
fn a_damper_that_keeps_a_late_instability_down_stays() {
    // A stiffness that swings at twice the frequency by a part p of itself makes a motion grow by p ω/4, slowly, from nothing.
    let shaken = |rate: &str| {
        format!(
            "name: Shaken
parameters: {{m: 1 kg, k: 1 N/m, c: 5e-3 N*s/m, K: 3 N/m, p: 0.12, w: {rate} 1/s, L: 1 m}}
coordinates: {{x: m, y: m}}
inputs: {{swing: p*cos(w*t)}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: m, position: \"[0, y]\"}}}}
springs: {{side: {{stretch: y, stiffness: K, along: \"[0, 1]\", on: b}}}}
dampers: {{brake: {{rate: \"x'\", damping: 26*c, along: \"[1, 0]\", on: a}}}}
generalized_forces: {{x: -k*(1 + swing)*x, y: -K*x^2*y/L^2}}
outputs: {{up: y}}
scene: {{start: {{x: 1e-3, y: 0.1}}, until: 180, tolerance: 1e-8}}
"
        )
    };
    let resonant = found(&shaken("2"), "up");
    acts(&resonant, "dampers.brake");
    goes(&resonant, "coordinates.x");
    goes(&found(&shaken("1.3"), "up"), "dampers.brake");
}

#[test]
fn a_force_that_acts_through_frictions_normal_reaction_stays() {
    let pressed = |force: &str| {
        format!(
            "name: Pressed
parameters: {{m: 1e6 kg, g: 10 m/s^2, mu: 0.3, P: {force} N, F: 6e6 N, T: 1 s}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: y}}
forces:
  press: {{on: b, force: \"[0, -P*exp(-((t - 2.2*T)/(0.2*T))^2)]\"}}
  pull: {{on: b, force: \"[F, 0]\"}}
  friction: {{on: b, force: \"[-mu*reaction(floor), 0]\"}}
scene: {{start: {{x: 0, y: 0, x': 0.5, y': 0}}, until: 3, tolerance: 1e-8}}
"
        )
    };
    acts(&found(&pressed("1e6"), "x"), "forces.press");
    goes(&found(&pressed("1e4"), "x"), "forces.press");
}

#[test]
fn a_mass_that_matters_only_in_an_impact_stays() {
    // The ballast rests, without a force on it, until it is hit; where it is out of reach it is nothing.
    let struck = |place: &str| {
        format!(
            "name: Struck
parameters: {{m: 1 kg, b: 1e-3 kg, k: 1 N/m, e: 0.8, A: 1 m}}
coordinates: {{x: m, y: m}}
bodies:
  hammer: {{mass: m, position: \"[x, 0]\"}}
  anvil: {{mass: 0.1*m, position: \"[y, 0]\"}}
  ballast: {{mass: 10*b, position: \"[y, 0]\"}}
springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: hammer}}}}
constraints: {{touch: x - y}}
phases: {{free: [], stuck: [touch]}}
events: {{hit: {{phase: free, when: y - x, direction: falling, then: {{impact: e, along: touch}}}}}}
outputs: {{place: x}}
scene: {{start: {{x: -1, y: {place}, x': 0, y': 0}}, until: 4, tolerance: 1e-9}}
"
        )
    };
    acts(&found(&struck("0.5"), "place"), "bodies.ballast");
    goes(&found(&struck("3"), "place"), "bodies.ballast");
}

#[test]
fn a_tiny_input_that_decides_which_event_comes_first_stays() {
    let race = |part: &str| {
        format!(
            "name: Race
parameters: {{m: 1e-6 kg, k: 1e-6 N/m, A: 1e-6 m, w: 3 1/s}}
coordinates: {{x: m, y: m}}
inputs: {{u: {part}*A*sin(w*t)}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: m, position: \"[0, y]\"}}}}
springs:
  s: {{stretch: x - u, stiffness: k, along: \"[1, 0]\", on: a}}
  r: {{stretch: y, stiffness: k, along: \"[0, 1]\", on: b}}
events:
  first: {{when: x - 1e-7*A, direction: falling, then: record}}
  second: {{when: y, direction: falling, then: record}}
scene: {{start: {{x: 1e-6, y: 1e-6}}, until: 4, tolerance: 1e-11}}
"
        )
    };
    let close = found(&race("1e-6"), "y");
    assert!(matches!(reduction(&close, "inputs.u").verdict, Verdict::HappensOtherwise { .. }), "{}", close.table());
    goes(&found(&race("1e-8"), "y"), "inputs.u");
}

#[test]
fn a_bias_that_breaks_a_symmetry_late_stays() {
    // The bead climbs a hill and stays on top for a while; a bias of a millionth decides to which side it leaves.
    let bead = |until: &str| {
        oscillator(&format!(
            "generalized_forces: {{x: 2*k*x + c*x' - k*x^3/A^2}}
forces: {{bias: {{on: b, force: \"[1e-6*F, 0]\"}}}}
scene: {{start: {{x: 0.01, x': -0.01}}, until: {until}, tolerance: 1e-10}}"
        ))
    };
    let late = found(&bead("8"), "x");
    acts(&late, "forces.bias");
    assert!(change(&late, "forces.bias") > 0.01, "{}", late.table());
    goes(&found(&bead("1.5"), "x"), "forces.bias");
}

#[test]
fn a_spring_that_is_there_only_after_an_event_of_another_part_stays() {
    let latched = |place: &str| {
        format!(
            "name: Latched
parameters: {{m: 1 kg, L: 1 m, K: 2 N*m, g: 10 m/s^2, v: 0.1 m/s}}
coordinates: {{theta: rad, s: m}}
bodies:
  bob: {{mass: m, angle: theta, position: \"L*[sin(theta), -cos(theta)]\"}}
  block: {{mass: m, position: \"[s, 0]\"}}
gravity: [0, -g]
phases: {{before: [], after: []}}
events: {{caught: {{when: s - {place}*L, direction: rising, phase: before, then: after}}}}
springs: {{back: {{stretch: theta, stiffness: K, on: bob, phase: after}}}}
forces: {{lift: {{on: block, force: \"[0, m*g]\"}}}}
outputs: {{angle: theta}}
scene: {{start: {{theta: 0.3, s': v}}, until: 10, tolerance: 1e-8}}
"
        )
    };
    let late = found(&latched("0.97"), "angle");
    acts(&late, "springs.back");
    // The block itself is felt by nothing but the event.
    // Without it the event that catches the bob would watch what never changes.
    assert!(matches!(reduction(&late, "coordinates.s").verdict, Verdict::Refused { .. }), "{}", late.table());
    goes(&found(&latched("1.5"), "angle"), "springs.back");
}

#[test]
fn a_narrow_kick_at_the_end_is_met_at_every_scale() {
    for scale in [1e-6, 1.0, 1e6] {
        let kicked = |part: f64| {
            format!(
                "name: Kicked
parameters: {{m: {scale} kg, k: {scale} N/m, A: {scale} m, F: {force} N, T: 1 s}}
coordinates: {{x: m}}
bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}
generalized_forces: {{x: -k*x - k*x^3/A^2}}
forces: {{kick: {{on: b, force: \"[F*exp(-((t - 39*T)/(1e-4*T))^2), 0]\"}}}}
scene: {{start: {{x: {scale}}}, until: 40, tolerance: 1e-8}}
",
                force = part * scale * scale
            )
        };
        // An impulse of 1.8e-4 F beside a momentum of 1.2 or so.
        acts(&found(&kicked(100.0), "x"), "forces.kick");
        goes(&found(&kicked(1.0), "x"), "forces.kick");
    }
}

#[test]
fn a_drag_that_ends_the_scene_earlier_stays() {
    // What is wanted, the distance, hardly feels the thread; when the ball lands does.
    let thrown = |part: &str| {
        format!(
            "name: Thrown
parameters: {{m: 1 kg, g: 10 m/s^2, H: 20 m, F: {part} N}}
coordinates: {{x: m, y: m}}
bodies: {{ball: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
forces: {{lift: {{on: ball, force: \"[0, F]\"}}}}
events: {{land: {{when: y, direction: falling, then: stop}}}}
scene: {{start: {{y: H, x': 1e-3}}, until: 4, tolerance: 1e-9}}
"
        )
    };
    acts(&found(&thrown("0.05"), "x"), "forces.lift");
    goes(&found(&thrown("1e-3"), "x"), "forces.lift");
}

#[test]
fn forces_that_cancel_do_not_go_together() {
    // Each acts; that both would hardly be missed is no reason to leave out two large forces.
    let cancelled = oscillator(
        "forces: {left: {on: b, force: \"[-0.05*F, 0]\"}, right: {on: b, force: \"[0.05001*F, 0]\"}, \
         soft: {on: b, force: \"[-2e-2*k*x^3/A^2, 0]\"}}
scene: {start: {x: 1}, until: 20, tolerance: 1e-8}",
    );
    let needs = found(&cancelled, "x");
    acts(&needs, "forces.left");
    acts(&needs, "forces.right");
    // Two that serve each by itself, on the same side, do not serve together.
    let added = oscillator(
        "forces: {one: {on: b, force: \"[1.3e-3*F*t/T/20, 0]\"}, other: {on: b, force: \"[1.3e-3*F*t/T/20, 0]\"}, \
         soft: {on: b, force: \"[-2e-2*k*x^3/A^2, 0]\"}}
scene: {start: {x: 1}, until: 20, tolerance: 1e-8}",
    );
    let needs = found(&added, "x");
    goes(&needs, "forces.one");
    goes(&needs, "forces.other");
    let choice = chosen(&needs);
    let both = ["forces.one", "forces.other"].iter().filter(|name| choice.members.iter().any(|m| m == *name)).count();
    assert!(both == 1 && choice.verified <= 1e-3, "{}", needs.table());
    holds(&added, &needs);
}

#[test]
fn a_press_that_decides_whether_a_block_sticks_stays() {
    let block = |press: &str| {
        format!(
            "name: Sticking
parameters: {{m: 1 kg, g: 10 m/s^2, mu: 0.2, k: 20 N/m, P: {press} N, x0: 0.29999 m}}
coordinates: {{x: m, y: m}}
bodies: {{b: {{mass: m, position: \"[x, y]\"}}}}
gravity: [0, -g]
constraints: {{floor: y, grip: x'}}
phases: {{right: [floor], left: [floor], stuck: [floor, grip]}}
events:
  stop: {{phase: right, when: x', direction: falling, then: stuck}}
  back: {{phase: stuck, when: \"mu*reaction(floor) + reaction(grip)\", direction: falling, then: left}}
  rest: {{phase: left, when: x', direction: rising, then: stuck}}
springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}}}
forces:
  press: {{on: b, force: \"[0, -P]\"}}
  rub_right: {{on: b, force: \"[-mu*reaction(floor), 0]\", phase: right}}
  rub_left: {{on: b, force: \"[mu*reaction(floor), 0]\", phase: left}}
scene: {{start: {{x: -x0, y: 0, x': 0, y': 0}}, phase: right, until: 3, tolerance: 1e-10}}
"
        )
    };
    // From −0.3 m it comes to rest at 0.1 m, where the spring pulls by all that friction has.
    acts(&found(&block("0.02"), "x"), "forces.press");
    goes(&found(&block("1e-7"), "x"), "forces.press");
}

#[test]
fn a_hum_that_acts_only_with_another_spring_stays() {
    // At three times the frequency of what swings only the cube can bring them together.
    let pair = |hum: &str| {
        format!(
            "name: Pair
parameters: {{m: 1 kg, k: 1 N/m, b: 0.4 N/m^3, F: {hum} N, w: 3.02 1/s, L: 1 m}}
coordinates: {{x: m, y: m}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, c: {{mass: m, position: \"[0, y]\"}}}}
springs:
  soft: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: a}}
  stiff: {{stretch: y, stiffness: 9*k, along: \"[0, 1]\", on: c}}
generalized_forces: {{x: -3*b*x^2*y, y: -b*x^3}}
forces: {{hum: {{on: c, force: \"[0, F*cos(w*t)]\"}}}}
outputs: {{swing: x}}
scene: {{start: {{x: 0.3}}, until: 60, tolerance: 1e-8}}
"
        )
    };
    let strong = found(&pair("3e-2"), "swing");
    acts(&strong, "forces.hum");
    goes(&found(&pair("3e-6"), "swing"), "forces.hum");
}

/// An input whose period divides the distances at which runs are reported.
fn in_step_with_reports(amplitude: &str) -> String {
    format!(
        "name: InStep
parameters: {{A: {amplitude}}}
coordinates: {{x: 1}}
inputs: {{u: \"A*sin(2*pi*400*t)\"}}
kinetic_energy: x'^2/2
potential_energy: (x - u)^2*100/2
outputs: {{pull: \"100*(x - u)\"}}
scene: {{start: {{x: 1}}, until: 1, tolerance: 1e-8}}
"
    )
}

#[test]
fn an_input_in_step_with_the_reports_was_not_needed() {
    // It changes the output by 100 A, of a range of 200 and a little.
    let needs = found(&in_step_with_reports("0.3"), "pull");
    acts(&needs, "inputs.u");
    assert!(change(&needs, "inputs.u") > 0.11, "{}", needs.table());
    goes(&found(&in_step_with_reports("1e-3"), "pull"), "inputs.u");
}
