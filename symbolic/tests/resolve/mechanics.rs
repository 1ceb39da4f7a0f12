//! Names and families, parameters, loads and their bodies, what is watched, scenes, drawings.

use dalembert_symbolic::model::{Condition, EventAction, Model, Shape, Work, load};

use crate::{At, close, model};

/// A rod of length 2 hinged at the origin, a bead on it, a cart on rails above.
const MECHANISM: &str = r#"
name: Mechanism
parameters: {m: 2 kg, k: 100 N/m, c: 3 kg/s, l: 2 m, a: 0.1 m, w: 1 rad/s, R: 0.5 m}
coordinates: {phi: rad, s: m, x: m}
inputs: {base: a*sin(w*t)}
points: {O: "[0, 0]", tip: l*rod.x, hook: "[x, 1]", shaker: "[base, 0]", wheel_contact: "[x, 0.5]"}
bodies:
  rod: {mass: m, inertia: m*l^2/12, angle: phi, position: tip/2}
  bead: {mass: m, position: s*rod.x}
  cart: {mass: m, inertia: 0, angle: 0, position: "[x, 1.2]"}
  wheel: {mass: m, inertia: m*R^2/2, angle: -x/R, position: "[x, 1]"}
"#;

fn with(more: &str) -> Model {
    model(&format!("{MECHANISM}{more}\n"))
}

fn at() -> At {
    At::new(&[
        ("phi", 0.5),
        ("s", 1.3),
        ("x", 0.4),
        ("phi'", 2.0),
        ("s'", 0.7),
        ("x'", -1.5),
        ("base", 0.1),
        ("base'", 0.2),
    ])
}

/// Bodies, places and forces of the first load's pushes.
fn pushes(model: &Model) -> Vec<(Option<&str>, Vec<f64>, Vec<f64>)> {
    let at = at();
    let load = &model.loads[0];
    load.pushes
        .iter()
        .map(|push| {
            let body = push.body.map(|body| model.bodies[body].name.as_str());
            (body, at.values(model, &push.at), at.values(model, &push.force))
        })
        .collect()
}

#[track_caller]
fn takes(more: &str, wanted: &[Option<&str>]) {
    let model = with(more);
    let bodies: Vec<Option<&str>> = pushes(&model).iter().map(|(body, ..)| *body).collect();
    assert_eq!(bodies, wanted, "{more}");
}

#[test]
fn carriers() {
    takes("forces: {f: {on: tip, force: [1, 0]}}", &[Some("rod")]);
    takes("forces: {f: {on: tip/3, force: [1, 0]}}", &[Some("rod")]);
    takes("forces: {f: {on: s*rod.x, force: [1, 0]}}", &[Some("bead")]);
    takes("forces: {f: {on: bead, force: [1, 0]}}", &[Some("bead")]);
    takes("forces: {f: {on: hook, force: [1, 0]}}", &[Some("cart")]);
    // The wheel rolls on y = 1/2: its material at the contact rests, the point of contact travels with the cart.
    takes("forces: {f: {on: wheel_contact, force: [1, 0]}}", &[Some("cart")]);
    takes("forces: {f: {on: wheel, at: wheel_contact, force: [1, 0]}}", &[Some("wheel")]);
    takes("forces: {f: {on: rod, at: s*rod.x, force: [1, 0], from: bead}}", &[Some("rod"), Some("bead")]);
    takes("forces: {f: {on: tip, force: [1, 0], reaction: hook}}", &[Some("rod"), Some("cart")]);
    takes("forces: {f: {on: tip, force: [1, 0], from: ground}}", &[Some("rod"), None]);
    takes("springs: {f: {between: [tip, O], stiffness: k}}", &[Some("rod"), None]);
    takes("springs: {f: {between: [tip, shaker], stiffness: k}}", &[Some("rod"), None]);
    takes("springs: {f: {between: [bead, {on: rod, at: tip}], stiffness: k}}", &[Some("bead"), Some("rod")]);
    takes("springs: {f: {between: [ground, cart], stiffness: k}}", &[None, Some("cart")]);
    takes("springs: {f: {stretch: phi, stiffness: k*l^2, on: rod}}", &[Some("rod")]);
    takes("springs: {f: {stretch: s, stiffness: k, on: bead, along: rod.x, from: rod}}", &[Some("bead"), Some("rod")]);
    takes("dampers: {f: {rate: phi', damping: c*l^2, on: rod, from: wheel}}", &[Some("rod"), Some("wheel")]);
    takes("torques: {f: {on: rod, torque: k*l^2*w*t, from: cart}}", &[Some("rod"), Some("cart")]);
}

#[test]
fn a_force_on_the_ground_is_a_warning() {
    let model = with("forces: {f: {on: O, force: [1, 0]}, g: {on: tip, force: [1, 0]}}");
    let codes: Vec<&str> = model.warnings.iter().map(|warning| warning.code).collect();
    assert_eq!(codes, ["W408"]);
}

#[test]
fn opposites() {
    let (c, s) = (0.5_f64.cos(), 0.5_f64.sin());
    let found = with("forces: {f: {on: rod, at: tip, force: \"[k*x/100, 2]\", from: bead}}");
    let pushes = pushes(&found);
    close(&pushes[0].1, &[2.0 * c, 2.0 * s]);
    close(&pushes[0].2, &[0.4, 2.0]);
    // The opposite acts on a particle at itself.
    close(&pushes[1].1, &[1.3 * c, 1.3 * s]);
    close(&pushes[1].2, &[-0.4, -2.0]);
    assert_eq!(found.loads[0].work, Work::Pushes);
}

#[test]
fn springs() {
    let potential = |more: &str| {
        let mut model = with(more);
        at().of(&mut model, "potential_energy")
    };
    close(&potential("springs: {f: {between: [tip, O], stiffness: k}}"), &[200.0]);
    close(&potential("springs: {f: {between: [tip, O], stiffness: k, rest: l/4}}"), &[112.5]);
    close(&potential("springs: {f: {between: [tip, O], energy: 4*k*length^4/l^2}}"), &[1600.0]);
    close(&potential("springs: {f: {between: [tip, O], tension: \"k*(length - l/4)\"}}"), &[100.0]);
    close(&potential("springs: {f: {between: [tip, O], tension: k*l^3/8/length^2}}"), &[-50.0]);
    close(&potential("springs: {f: {between: [tip, O], tension: \"k*max(0, length - l/4)\"}}"), &[112.5]);
    close(&potential("springs: {f: {between: [tip, O], tension: \"k*max(0, length - 1.5*l)\"}}"), &[0.0]);
    close(&potential("springs: {f: {stretch: phi - 1, stiffness: k*l^2/4, on: rod}}"), &[12.5]);
    let one = with("springs: {f: {between: [O, tip], stiffness: k, rest: l/4}}");
    let (c, s) = (0.5_f64.cos(), 0.5_f64.sin());
    // Stretched by 1.5: pulls the tip inwards with 150.
    close(&pushes(&one)[1].2, &[-150.0 * c, -150.0 * s]);
    let law = with("springs: {f: {between: [O, tip], energy: 4*k*length^4/l^2}}");
    close(&pushes(&law)[1].2, &[-3200.0 * c, -3200.0 * s]);
    // Without a rest length there is no square root.
    let free = with("springs: {f: {between: [O, tip], stiffness: k}}");
    assert!(!format!("{:?}", free.graph).contains("Sqrt"));
}

#[test]
fn the_dimension_is_what_most_vectors_have() {
    let found = model(
        "name: A\ncoordinates: {x: m, y: m, z: m}\nkinetic_energy: x'^2 + y'^2 + z'^2\noutputs: {p: [x, y, z]}\n",
    );
    assert_eq!((found.dimension, found.outputs[0].value.len()), (3, 3));
}

#[test]
fn tensions_without_a_closed_form_resist() {
    let found = with("springs: {f: {between: [O, hook], tension: k*l/2*tanh(length^2/l^2*4)}}");
    let Work::Resistance { rate, tension } = found.loads[0].work else { panic!("{:?}", found.loads[0].work) };
    let length = (0.16_f64 + 1.0).sqrt();
    close(&at().values(&found, &[rate, tension]), &[0.4 * -1.5 / length, 100.0 * (length * length).tanh()]);
}

#[test]
fn dampers() {
    let found = with("dampers: {d: {between: [O, hook], damping: c}}");
    let Work::Resistance { rate, tension } = found.loads[0].work else { panic!("{:?}", found.loads[0].work) };
    let length = (0.16_f64 + 1.0).sqrt();
    let closing = 0.4 * -1.5 / length;
    close(&at().values(&found, &[rate, tension]), &[closing, 3.0 * closing]);
    close(&pushes(&found)[1].2, &[-3.0 * closing * 0.4 / length, -3.0 * closing / length]);
    let turning = with("dampers: {d: {rate: phi' - x'/l*2, damping: c*l^2/4, on: rod}}");
    close(&at().values(&turning, &turning.loads[0].pushes[0].couple), &[-10.5]);
}

#[test]
fn families_of_everything() {
    let mut chain = model(
        r#"
name: Chain
sizes: {n: 3}
parameters: {"m[i in 1..n]": [1, 2, 3], "M[i in 1..n]": "m[i]*2", l: 1, "k[i in 1..n, j in 1..2]": [[1, 2], [3, 4], [5, 6]]}
coordinates: {"theta[i in 1..n]": rad}
define: {"c[0]": 0, "c[i in 1..n]": "c[i-1] + m[i]", "u[i in 1..n]": "u[i+1] + i", "u[n+1]": 0}
points: {"tip[0]": [0, 0], "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"}
bodies:
  "bar[i in 1..n]": {mass: "m[i]", inertia: "m[i]*l^2/12", angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
torques: {"motor[i in 2..n]": {on: "bar[i]", torque: "theta[i]'", from: "bar[i-1]"}}
springs: {"s[i in 1..n, j in i+1..n]": {between: ["tip[i]", "tip[j]"], stiffness: "k[i, 1]"}}
generalized_forces: {"theta[i in 1..n]": "-theta[i]'"}
conserved: {"E[i in 1..2]": energy*i}
checks: {"same[i in 1..n]": "tip[i] - tip[i-1] = l*[sin(theta[i]), -cos(theta[i])]"}
outputs: {"height[i in 1..n]": "tip[i].y"}
events: {"down[i in 1..n]": {when: "theta[i]", then: [record, stop]}}
draw: [{line: ["tip[i in 0..n]"]}, {circle: {at: "tip[i in 1..2]", radius: l/10}}, {trace: "tip[n]"},
  {spring: ["tip[i]", "tip[j]"], each: "i in 0..n, j in i+1..n"}, {curve: "tip[i] + [s, s^2]", s: 0..l, each: i in 1..n},
  {circle: {at: "bar[b]", radius: "m[b]/10"}, each: b in 1..n}]
scene: {start: {"theta[i in 1..n]": "i/10", "theta[2]'": 1}}
"#,
    );
    let at = At::new(&[("theta[1]", 0.1), ("theta[3]'", 2.0)]);
    close(&at.of(&mut chain, "[c[3], u[1]]"), &[6.0, 6.0]);
    close(&at.of(&mut chain, "k[3, 2] + M[3]"), &[12.0]);
    let family = chain.parameters[1].family.clone().unwrap();
    assert_eq!((family.name.as_str(), family.ranges, family.indices), ("m", vec![(1, 3)], vec![2]));
    let names: Vec<String> = chain.outputs.iter().map(|output| output.name.clone()).collect();
    assert_eq!(names, ["height[1]", "height[2]", "height[3]"]);
    assert_eq!(chain.derived.len(), 3);
    assert_eq!(chain.loads.len(), 5);
    assert_eq!(chain.generalized_forces.len(), 3);
    assert_eq!((chain.checks.len(), chain.conserved.len(), chain.draw.len()), (3, 2, 16));
    assert_eq!(chain.events[2].actions, [EventAction::Record, EventAction::Stop]);
    assert!(matches!(&chain.draw[0], Shape::Line(points) if points.len() == 4));
    assert!(matches!(&chain.draw[3], Shape::Trace(name, _) if name == "tip[n]"));
    assert_eq!(chain.draw.iter().filter(|shape| matches!(shape, Shape::Spring(..))).count(), 6);
    let radii: Vec<_> = chain
        .draw
        .iter()
        .filter_map(|s| if let Shape::Circle { radius, .. } = s { Some(*radius) } else { None })
        .collect();
    close(&at.values(&chain, &radii[2..]), &[0.1, 0.2, 0.3]);
    close(&at.values(&chain, &chain.scenes[0].q), &[0.1, 0.2, 0.3]);
    close(&at.values(&chain, &chain.scenes[0].v), &[0.0, 1.0, 0.0]);
}

#[test]
fn sizes_can_be_set_and_switch_entries_off() {
    let text = r#"
name: Chain
sizes: {n: 3, springs: 1}
coordinates: {"x[i in 1..n]": m}
bodies: {"bead[i in 1..n]": {mass: 1, position: "[x[i], 0]"}}
springs: {"s[i in 1..springs]": {between: [ground, "bead[i]"], stiffness: 1}}
outputs: {p: "sum(velocity(bead[i]), i in 1..n)"}
"#;
    let found = load(text, &[("n".to_owned(), 5), ("springs".to_owned(), 0)]).unwrap();
    assert_eq!((found.coordinates.len(), found.loads.len()), (5, 0));
    assert_eq!(found.sizes, [("n".to_owned(), 5), ("springs".to_owned(), 0)]);
    assert_eq!(found.outputs[0].value.len(), 2);
}

#[test]
fn parameters_and_units() {
    let mut found = model(
        "name: Units
parameters:
  m: 250 g
  angle: 30 deg
  slope: asin(0.6)
  twice: 2*angle
  turn: 3*2 deg
  third: n*10 deg
  I: m*l^2/12 kg*m^2
  l: 20 cm
  pressure: 2 kPa
  free: pi/4 rad
  stiffness: 1e3 N/m
sizes: {n: 3}
coordinates: {x: , y: m, z_: m/s}
kinetic_energy: x'^2 + y'^2 + z_'^2
scene: {start: {x: 30 cm, y: 2*l, z_: 2 km/s}, set: {m: 1 kg}, until: 2*0.25 s}
",
    );
    let value = |name: &str| found.parameters.iter().find(|p| p.name == name).unwrap().default;
    use std::f64::consts::PI;
    close(&[value("m"), value("angle"), value("slope")], &[0.25, PI / 6.0, 0.6_f64.asin()]);
    close(&[value("turn"), value("l"), value("pressure"), value("free")], &[PI / 30.0, 0.2, 2000.0, PI / 4.0]);
    let derived: Vec<&str> = found.derived.iter().map(|derived| derived.name.as_str()).collect();
    assert_eq!(derived, ["twice", "third", "I"]);
    let at = At::default();
    close(&at.of(&mut found, "twice"), &[PI / 3.0]);
    close(&at.of(&mut found, "third"), &[PI / 6.0]);
    close(&at.of(&mut found, "I"), &[0.25 * 0.04 / 12.0]);
    close(&at.values(&found, &found.scenes[0].q), &[0.3, 0.4, 2000.0]);
    close(&at.values(&found, &[found.scenes[0].until, found.scenes[0].set[0].1]), &[0.5, 1.0]);
    assert_eq!(found.coordinates[0].unit, None);
    assert_eq!(found.coordinates[2].unit.as_deref(), Some("m/s"));
}

#[test]
fn inputs_are_symbols_with_their_signals() {
    let mut found = model(
        "name: Inputs
coordinates: {x: 1}
inputs: {drive: 2*base + t, base: sin(3*t)}
kinetic_energy: (x' + drive')^2/2
outputs: {o: \"[drive'', base]\"}
",
    );
    let at = At::new(&[("t", 0.2), ("x'", 1.0), ("drive'", 2.0), ("drive''", 7.0), ("base", 5.0)]);
    let signal = at.values(&found, &found.inputs[0].signal);
    let (s, c) = (0.6_f64.sin(), 0.6_f64.cos());
    close(&signal, &[2.0 * s + 0.2, 6.0 * c + 1.0, -18.0 * s]);
    close(&at.of(&mut found, "kinetic_energy"), &[4.5]);
    close(&at.values(&found, &found.outputs[0].value), &[7.0, 5.0]);
}

#[test]
fn watched() {
    let mut found = with(
        "conserved:
  energy: energy
  part: {value: \"[x, phi*l] + position(bead)\", when: {c: 0, m: 1 g}}
  sum_: sum(i*x, i in 1..2) - s + 1.5*l
checks:
  zero: \"velocity(wheel, wheel_contact) = 0\"
  both: {holds: \"x = x\", when: {k: 2*c*w}}
  alone: x'' - x''
sample: {x: [-0.9*l, 0.9*l], phi': [0, 1]}
outputs: [tip, bead, x]
events: {e: {when: \"norm(velocity(tip)) - l*w\", direction: rising, if: x, then: stop}}",
    );
    let at = at();
    let part = &found.conserved[1];
    assert_eq!((part.value.len(), part.terms[0].len()), (2, 2));
    let values = |when: &[Condition]| -> Vec<(usize, f64)> {
        when.iter().map(|c| (c.parameter, at.values(&found, &[c.value])[0])).collect()
    };
    assert_eq!(values(&part.when), [(2, 0.0), (0, 0.001)]);
    close(&at.values(&found, &found.conserved[2].value), &[3.0 * 0.4 - 1.3 + 3.0]);
    close(&at.values(&found, &found.checks[0].left), &[0.0, 0.0]);
    assert_eq!(found.checks[0].right.len(), 2);
    assert_eq!(values(&found.checks[1].when), [(1, 6.0)]);
    assert_eq!(found.condition(&found.checks[1].when), " where k = 2*c*w");
    let names: Vec<&str> = found.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["tip", "bead", "x"]);
    let sample = found.sample[1];
    assert_eq!((sample.coordinate, sample.speed), (0, true));
    assert_eq!((found.events[0].direction, found.events[0].condition.is_some()), (1, true));
    let energy = at.of(&mut found, "energy")[0];
    let terms: f64 = at.values(&found, &found.conserved[0].terms[0]).iter().sum();
    assert!((energy - terms).abs() < 1e-12);
}

#[test]
fn scenes_inherit() {
    let found = with(
        "scene: {start: {x: 1, phi: 2}, until: 5, every: 0.5, set: {m: 3}}
scenes:
  other: {start: {x: l}, tolerance: 1e-6}
  third: {set: {c: 2*m*w}}
equilibrium: {phi: -pi/2}",
    );
    let at = at();
    let names: Vec<&str> = found.scenes.iter().map(|scene| scene.name.as_str()).collect();
    assert_eq!(names, ["scene", "other", "third"]);
    close(&at.values(&found, &found.scenes[1].q), &[0.0, 0.0, 2.0]);
    close(&at.values(&found, &found.scenes[2].q), &[2.0, 0.0, 1.0]);
    close(&at.values(&found, &[found.scenes[1].until, found.scenes[1].every.unwrap()]), &[5.0, 0.5]);
    let set: Vec<usize> = found.scenes.iter().map(|scene| scene.set[0].0).collect();
    assert_eq!(set, [0, 0, 2]);
    close(&at.values(&found, found.equilibrium.as_ref().expect("a guess")), &[-std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
}

#[test]
fn drawings() {
    let found = with(
        "draw:
  - {line: [O, tip, [1, 2], \"tip + [0, 1]\", rod]}
  - {circle: {at: cart, radius: 10 cm}}
  - {circle: {at: [1, 2], radius: l}}
  - {spring: [O, tip]}
  - {curve: \"[s_, s_^2/l]\", s_: -2..l}
  - {trace: tip}",
    );
    let at = at();
    assert_eq!(found.draw.len(), 6);
    let Shape::Curve(points) = &found.draw[4] else { panic!() };
    assert_eq!(points.len(), 101);
    close(&at.values(&found, &points[0]), &[-2.0, 2.0]);
    close(&at.values(&found, &points[25]), &[-1.0, 0.5]);
    let Shape::Circle { radius, .. } = &found.draw[1] else { panic!() };
    close(&at.values(&found, &[*radius]), &[0.1]);
}
