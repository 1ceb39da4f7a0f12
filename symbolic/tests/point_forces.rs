//! Where forces act that a file declares, and how large they are: the outputs that a model has when it is loaded with them.

use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::model::{Files, Model, load_with_forces};

const SLED: &str = "name: Sled
parameters: {m: 1 kg, I: 1 kg*m^2, d: 0.5 m, p: 1 m, r: 2 m}
coordinates: {x: m, y: m, theta: rad}
points: {skate: '[x, y]'}
bodies: {sled: {mass: m, inertia: I, angle: theta, position: skate + d*sled.x}}
";

fn loaded(text: &str) -> Model {
    load_with_forces(&Files::default(), text, &[]).unwrap()
}

/// The numbers of all forces where coordinate i is `q[i]`, each speed 0 and each multiplier 1: where each acts, then its components.
fn forces(model: &Model, q: &[f64]) -> Vec<Vec<f64>> {
    let last = model.outputs.len() - model.point_forces.names.len();
    let value = |symbol| match symbol {
        Symbol::Coordinate(i) => q[i as usize],
        Symbol::Parameter(i) => model.parameters[i as usize].default,
        Symbol::Multiplier(_) => 1.0,
        _ => 0.0,
    };
    model.outputs[last..].iter().map(|output| Tape::new(&model.graph, &output.value).evaluate(value)).collect()
}

fn near(found: &[f64], wanted: &[f64]) {
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
    assert!(found.len() == wanted.len() && found.iter().zip(wanted).all(is_near), "{found:?}, not {wanted:?}");
}

#[test]
fn a_constraint_on_velocities_acts_across_at_the_point_that_it_names() {
    let text = format!("{SLED}constraints: {{edge: 'dot(velocity(skate), sled.y)'}}\n");
    let model = loaded(&text);
    assert_eq!(model.point_forces.names, ["edge"]);
    let (s, c) = 0.4_f64.sin_cos();
    near(&forces(&model, &[2.0, 3.0, 0.4])[0], &[2.0, 3.0, -s, c]);
}

#[test]
fn the_material_of_a_body_is_held_where_it_is_not_in_its_middle() {
    let text = format!("{SLED}constraints: {{grip: 'dot(velocity(sled, skate), ground.x)'}}\n");
    near(&forces(&loaded(&text), &[2.0, 3.0, 0.4])[0], &[2.0, 3.0, 1.0, 0.0]);
}

/// P + L e − Q = 0: the force on what P is of, at Q.
#[test]
fn points_that_meet_have_one_force() {
    let text = format!("{SLED}constraints: {{pin: 'skate - [p, r]'}}\n");
    let model = loaded(&text);
    near(&forces(&model, &[2.0, 3.0, 0.4])[0], &[2.0, 3.0, 1.0, 1.0]);
    let text = format!("{SLED}constraints: {{pin: '[p, r] - skate'}}\n");
    near(&forces(&loaded(&text), &[2.0, 3.0, 0.4])[0], &[2.0, 3.0, -1.0, -1.0]);
    let two = SLED.replace("theta: rad}", "theta: rad, u: m, v: m}").replace("'[x, y]'}", "'[x, y]', other: '[u, v]'}");
    let text = format!("{two}constraints: {{pin: 'skate + d*sled.x - other'}}\n");
    let text = text.replace("bodies: {", "bodies: {bob: {mass: m, position: other}, ");
    let found = forces(&loaded(&text), &[2.0, 3.0, 0.4, 5.0, 6.0]);
    assert_eq!(found.len(), 1);
    near(&found[0], &[5.0, 6.0, 1.0, 1.0]);
}

#[test]
fn a_distance_pulls_at_both_of_its_ends() {
    let text = "name: Pair
parameters: {m: 1 kg, l: 5 m}
coordinates: {x: m, y: m, u: m, v: m}
bodies: {a: {mass: m, position: '[x, y]'}, b: {mass: m, position: '[u, v]'}}
";
    for rod in ["norm(position(a) - position(b)) - l", "sqrt((x - u)^2 + (y - v)^2) - l"] {
        let model = loaded(&format!("{text}constraints: {{rod: '{rod}'}}\n"));
        let found = forces(&model, &[4.0, 0.0, 1.0, 4.0]);
        assert_eq!(model.point_forces.names, ["rod", "rod"]);
        near(&found[0], &[4.0, 0.0, 0.6, -0.8]);
        near(&found[1], &[1.0, 4.0, -0.6, 0.8]);
    }
}

#[test]
fn what_acts_at_no_point_is_named() {
    let text =
        format!("{SLED}constraints: {{aim: theta - x/m0}}\ntorques: {{turn: {{on: sled, torque: -c*theta'}}}}\n");
    let text = text.replace("p: 1 m,", "m0: 1 m, c: 1 N*m*s,");
    let model = loaded(&text);
    assert!(model.point_forces.names.is_empty());
    assert_eq!(model.point_forces.elsewhere, ["aim", "turn"]);
}
