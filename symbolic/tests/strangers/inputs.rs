//! Inputs are taken as arbitrary where the file gives an example.

use dalembert_symbolic::gate::{Judged, Nature, judged};
use dalembert_symbolic::model::load;

/// A cart with a pendulum and a motor.
fn cart(input: &str, more: &str) -> Judged {
    let text = format!(
        "name: T
parameters: {{M: 1 kg, m: 0.2 kg, l: 0.5 m, g: 9.81 m/s^2}}
coordinates: {{x: m, a: rad}}
inputs: {{u: {input}}}
bodies:
  cart: {{mass: M, position: \"[x, 0]\"}}
  bob: {{mass: m, position: \"[x + l*sin(a), l*cos(a)]\"}}
gravity: [0, -g]
{more}
scene: {{start: {{a: 0.05}}, until: 2}}
"
    );
    load(&text, &[]).and_then(judged).unwrap_or_else(|problems| panic!("{problems:?}"))
}

#[test]
fn a_motor_whose_input_is_0_is_not_idle() {
    for input in ["0 N", "1 N", "0*t", "2 N"] {
        let judged = cart(input, "forces: {motor: {on: cart, force: \"[u, 0]\"}}");
        assert_eq!(judged.report.forces[0].nature, Nature::TimeDependent, "{input}");
        assert!(judged.cyclic.is_empty() && judged.directions.is_empty(), "{input}");
    }
    let gain = cart("0 1/s", "forces: {motor: {on: cart, force: \"[-u*M*x', 0]\"}}");
    assert_eq!(gain.report.forces[0].nature, Nature::Velocity { idle: false });
    let torque = cart("0 N*m", "generalized_forces: {a: u}");
    // The torque turns the bob and leaves x alone.
    assert_eq!(torque.cyclic.iter().map(|c| c.0).collect::<Vec<_>>(), [0]);
}

#[test]
fn what_no_input_moves_is_cyclic_as_before() {
    let unused = cart("0 N", "");
    assert_eq!(unused.cyclic.iter().map(|c| c.0).collect::<Vec<_>>(), [0]);
    // A claim is about the file's own input.
    let claimed = cart("0 N", "forces: {motor: {on: cart, force: \"[u, 0]\"}}\nconserved: {energy: energy}");
    assert_eq!(claimed.report.conserved[0].0, "energy");
}

#[test]
fn directions_that_an_input_pushes_along_are_none() {
    let pair = |force: &str| {
        let text = format!(
            "name: T
parameters: {{m: 1 kg, k: 10 N/m}}
coordinates: {{x: m, z: m}}
inputs: {{u: 0 N}}
bodies: {{a: {{mass: m, position: \"[x, 0]\"}}, b: {{mass: m, position: \"[z, 0]\"}}}}
springs: {{s: {{between: [a, b], stiffness: k}}}}
forces: {{{force}}}
"
        );
        load(&text, &[]).and_then(judged).unwrap_or_else(|problems| panic!("{problems:?}")).directions.len()
    };
    assert_eq!(pair("push: {on: a, force: \"[u, 0]\"}"), 0);
    assert_eq!(pair("push: {on: a, force: \"[u, 0]\", reaction: b}"), 1);
}
