//! Which body carries a point, in mechanisms of any size.

use super::{accepted, refused};

/// A rod of this length whose ends slide on two axes, pulled at its end A, with a claim about its energy.
fn rod(length: &str, start: &str, claim: &str) -> String {
    format!(
        "name: Rod
parameters: {{m: 1 kg, l: {length} m, g: 10 m/s^2, F: 1 N}}
coordinates: {{x: m}}
points: {{A: \"[x, 0]\", B: \"[0, sqrt(l^2 - x^2)]\"}}
bodies:
  rod: {{mass: m, inertia: m*l^2/12, angle: \"atan2(-sqrt(l^2 - x^2), x)\", position: (A + B)/2}}
gravity: [0, -g]
forces: {{pull: {{on: A, force: \"[F, 0]\"}}}}
conserved: {{energy_less_work: energy - {claim}*F*x}}
scene: {{start: {{x: {start}}}, until: 0.01}}
"
    )
}

#[test]
fn points_are_carried_whatever_the_size_of_the_mechanism() {
    for (length, start) in [("1e-9", "3e-10"), ("1e-5", "0"), ("1e-3", "0.0003"), ("1", "0.3"), ("1e6", "3e5")] {
        accepted(&rod(length, start, "1"));
        refused(&rod(length, start, "1.001"), "is not conserved");
    }
}
