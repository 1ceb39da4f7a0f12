//! The double pendulum, from its model to a run that says how far it can be trusted.

use dalembert::prelude::*;

// The whole model; a file does as well: `dalembert::model!("models/double_pendulum.yaml")`.
dalembert::model!(
    yaml = r#"
name: DoublePendulum
about: Two uniform bars, hinged at the origin and at the elbow.
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {theta1: rad, theta2: rad}          # both from the downward vertical
define: {I: m*l^2/12}
points:
  hinge: [0, 0]
  elbow: l*[sin(theta1), -cos(theta1)]
  hand:  elbow + l*[sin(theta2), -cos(theta2)]
bodies:
  upper: {mass: m, inertia: I, angle: theta1, position: elbow/2}
  fore:  {mass: m, inertia: I, angle: theta2, position: (elbow + hand)/2}
gravity: [0, -g]
conserved: {energy: energy}
outputs: {tip: hand}
draw: [{line: [hinge, elbow, hand]}, {trace: hand}]
scene: {start: {theta1: pi/2, theta2: pi}, until: 10, tolerance: 1e-10}
"#
);

fn main() -> Result<(), dalembert::Error> {
    let arm = DoublePendulum { l: 0.8, ..Default::default() }; // parameters are fields, in SI
    let run = arm.simulate().until(5.0).run()?;
    println!("{}", run.trust()); // drift of each invariant, work done, warnings
    println!("{}", run.last()["theta1"]); // access by name; `theta1'` is a rate, `tip.x` an output
    if let Some(state) = run.at(2.5) {
        println!("{state:?}"); // dense output
    }
    assert!(run.drift[0].value.is_some_and(|drift| drift < 1e-8));
    println!("{}", arm.mass_matrix_at(0.0, &[0.0, 0.0])); // M, h, F and Jacobians of any state
    Ok(())
}
