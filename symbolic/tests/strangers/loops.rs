//! Rows of loops, some of which are drawn flat: there the constraints depend on each other.

use super::{accepted, refused};

/// So many rhombi in a row on posts of this length, with a claim that its energy and this are conserved.
fn row_of_loops(loops: usize, length: &str, more: &str) -> String {
    format!(
        "name: RowOfLoops
sizes: {{n: {loops}}}
parameters: {{m: 1.5 kg, l: {length} m, g: 9.81 m/s^2}}
coordinates: {{\"p[i in 0..n]\": rad, \"w[i in 1..n]\": rad}}
points:
  \"foot[i in 0..n]\": \"[i*l, 0]\"
  \"head[i in 0..n]\": foot[i] + l*[sin(p[i]), cos(p[i])]
bodies:
  \"post[i in 0..n]\": {{mass: m, inertia: m*l^2/12, angle: \"-p[i]\", position: \"(foot[i] + head[i])/2\"}}
  \"deck[i in 1..n]\": {{mass: m, inertia: m*l^2/12, angle: \"w[i]\", position: \"head[i-1] + l/2*[cos(w[i]), sin(w[i])]\"}}
gravity: \"[0, -g]\"
constraints: {{\"pin[i in 1..n]\": \"head[i-1] + l*[cos(w[i]), sin(w[i])] - head[i]\"}}
conserved: {{energy: \"energy + {more}\"}}
scene: {{start: {{\"p[0]\": 0, \"p[0]'\": 1.5}}, until: 0.9}}
"
    )
}

#[test]
fn loops_that_are_drawn_flat_are_no_reason_to_refuse_what_is_conserved() {
    for (loops, length) in [(2, "0.8"), (3, "0.8"), (4, "0.5"), (4, "0.8"), (4, "1"), (4, "1.3")] {
        accepted(&row_of_loops(loops, length, "0*m*g*l"));
        refused(&row_of_loops(loops, length, "1e-9*m*g*l*cos(p[0])"), "is not conserved");
    }
}
