//! Every form and function of LANGUAGE.md, section 1.

use crate::{At, close, model};
use dalembert_symbolic::model::Sets;

const PLANE: &str = r#"
name: Plane
sizes: {n: 4}
parameters: {m: 2, l: 0.5, "k[i in 1..3]": [10, 20, 30]}
coordinates: {x: , y: , theta: rad}
inputs: {u: sin(3*t)}
define:
  speed: "norm(velocity(P))"
  e: "[cos(theta), sin(theta)]"
frames: {slot: {angle: 2*theta}, inner: {angle: theta, from: slot}}
points: {P: "[x, y]", Q: "P + l*e"}
bodies:
  bead: {mass: m, position: P}
  rod: {mass: m, inertia: m*l^2/12, angle: theta, position: "P + l/2*e"}
gravity: [0, -9.81]
kinetic_energy: 3*u'^2
"#;

fn at() -> At {
    At::new(&[
        ("t", 0.25),
        ("x", 0.3),
        ("y", -0.7),
        ("theta", 0.9),
        ("x'", 1.5),
        ("y'", -2.0),
        ("theta'", 0.8),
        ("x''", 0.2),
        ("y''", 0.4),
        ("theta''", -0.6),
        ("u", 0.11),
        ("u'", 0.22),
        ("u''", 0.33),
    ])
}

#[track_caller]
fn check(expression: &str, wanted: &[f64]) {
    close(&at().of(&mut model(PLANE), expression), wanted);
}

#[test]
fn numbers_operators_and_functions() {
    use std::f64::consts::PI;
    check("0.1 + 2.5e-3", &[0.1025]);
    check("2*pi", &[2.0 * PI]);
    check("t", &[0.25]);
    check("-2^2", &[-4.0]);
    check("2^3^2", &[512.0]);
    check("x^-1", &[1.0 / 0.3]);
    check("6/3/2 - 1 - 1", &[-1.0]);
    check("y^3", &[-0.343]);
    check("x^0.5 + x^1.7", &[0.3_f64.sqrt() + 0.3_f64.powf(1.7)]);
    check("sin(x) + cos(x) + tan(x)", &[0.3_f64.sin() + 0.3_f64.cos() + 0.3_f64.tan()]);
    check("asin(x) + acos(x) + atan(y)", &[PI / 2.0 - 0.7_f64.atan()]);
    check("atan2(y, x)", &[(-0.7_f64).atan2(0.3)]);
    check("sinh(x) + cosh(x) + tanh(x)", &[0.3_f64.exp() + 0.3_f64.tanh()]);
    check("exp(ln(x)) + sqrt(x^2)", &[0.6]);
    check("abs(y) + sign(y) + sign(0)", &[-0.3]);
    check("min(x, y, 1) + max(x, y, -5, 0.1)", &[-0.4]);
    check("step(y) + step(0) + step(x)", &[2.0]);
    check("mod(7, 4) + mod(-1, n)", &[6.0]);
    check("n/8", &[0.5]);
    check("k[2] + k[mod(5, 3) + 1]", &[50.0]);
}

#[test]
fn vectors() {
    check("dot([x, y], [2, 3])", &[0.6 - 2.1]);
    check("cross([1, 2], [3, 4])", &[-2.0]);
    check("cross(2, [3, 4])", &[-8.0, 6.0]);
    check("norm([3, 4])", &[5.0]);
    check("unit([3, 4])", &[0.6, 0.8]);
    check("unit([0, 0]*x)", &[0.0, 0.0]);
    check("2*[1, 2]/4 - [x, y]*2", &[-0.1, 2.4]);
    check("([1, 2] + [x, y]).y", &[1.3]);
    check("P.x + Q.y", &[0.3 - 0.7 + 0.5 * 0.9_f64.sin()]);
    check("(rod).x", &[0.3 + 0.25 * 0.9_f64.cos()]);
    check("rod.x", &[0.9_f64.cos(), 0.9_f64.sin()]);
    check("rod.y.x", &[-(0.9_f64.sin())]);
    check("position(bead).y", &[-0.7]);
    check("bead + [1, 1]", &[1.3, 0.3]);
    check("slot.x", &[1.8_f64.cos(), 1.8_f64.sin()]);
    check("inner.y", &[-(2.7_f64.sin()), 2.7_f64.cos()]);
    check("ground.x + 2*ground.y", &[1.0, 2.0]);
    check("ground", &[0.0, 0.0]);
}

#[test]
fn rates_along_the_motion() {
    check("rate(x*y)", &[1.5 * -0.7 + 0.3 * -2.0]);
    check("rate(x'^2)", &[2.0 * 1.5 * 0.2]);
    check("rate(t*u)", &[0.11 + 0.25 * 0.22]);
    check("rate(rate(u))", &[0.33]);
    check("velocity(P)", &[1.5, -2.0]);
    check("acceleration(bead)", &[0.2, 0.4]);
    check("speed", &[2.5]);
    check("theta'' + u'' + u'", &[-0.6 + 0.55]);
    check("angular_velocity(rod)", &[0.8]);
    check("angular_velocity(inner)", &[2.4]);
    check("angular_velocity(ground)", &[0.0]);
}

#[test]
fn material_of_a_body_at_a_point() {
    // The rod's material at the origin: v + ω×(0 − r), a + α×(0 − r) − ω²(0 − r).
    let (c, s) = (0.9_f64.cos(), 0.9_f64.sin());
    let (rx, ry) = (-0.3 - 0.25 * c, 0.7 - 0.25 * s);
    let velocity = [1.5 - 0.25 * 0.8 * s, -2.0 + 0.25 * 0.8 * c];
    check("velocity(rod, [0, 0])", &[velocity[0] - 0.8 * ry, velocity[1] + 0.8 * rx]);
    let (w2, alpha) = (0.64, -0.6);
    let centre = [0.2 - 0.25 * (alpha * s + w2 * c), 0.4 + 0.25 * (alpha * c - w2 * s)];
    let wanted = [centre[0] - alpha * ry - w2 * rx, centre[1] + alpha * rx - w2 * ry];
    check("acceleration(rod, ground)", &wanted);
    check("velocity(rod, Q) - velocity(Q)", &[0.0, 0.0]);
    check("acceleration(rod, P) - acceleration(P)", &[0.0, 0.0]);
    check("velocity(ground, P)", &[0.0, 0.0]);
}

#[test]
fn derivatives_sums_and_integrals() {
    check("diff(x^2*y, x)", &[2.0 * 0.3 * -0.7]);
    check("diff(theta'^2*x, theta')", &[1.6 * 0.3]);
    check("diff(sin(2*t), t)", &[2.0 * 0.5_f64.cos()]);
    check("diff(m*x + u^2, m)", &[0.3]);
    check("diff(u^2, u)", &[0.22]);
    check("diff([x^2, y], x)", &[0.6, 0.0]);
    check("sum(i^2, i in 1..n)", &[30.0]);
    check("sum(i*j, i in 1..3, j in i+1..3)", &[2.0 + 3.0 + 6.0]);
    check("sum(k[i], i in 1..3)", &[60.0]);
    check("sum([i, 1], i in 1..2)", &[3.0, 2.0]);
    check("sum(x, i in 1..0) + 1", &[1.0]);
    check("sum([i, 1], i in 1..0) + [x, 1]", &[0.3, 1.0]);
    check("integral(s^2, s in 0..3)", &[9.0]);
    check("integral(s^31, s in 0..1)", &[1.0 / 32.0]);
    check("integral(exp(s), s in 0..x)", &[0.3_f64.exp() - 1.0]);
    check("integral([s, 1], s in 1..2)", &[1.5, 1.0]);
    check("integral(integral(s*r, r in 0..s), s in 0..2)", &[2.0]);
    check("integral(diff(sin(theta*s), s), s in 0..1)", &[0.9_f64.sin()]);
    check("rate(integral(x*s, s in 0..2))", &[3.0]);
}

#[test]
fn energies_of_the_model() {
    let (c, s) = (0.9_f64.cos(), 0.9_f64.sin());
    let velocity = [1.5 - 0.25 * 0.8 * s, -2.0 + 0.25 * 0.8 * c];
    let square = velocity[0] * velocity[0] + velocity[1] * velocity[1];
    let kinetic = 6.25 + square + 0.5 * (2.0 * 0.25 / 12.0) * 0.64 + 3.0 * 0.22 * 0.22;
    let potential = 2.0 * 9.81 * (-1.4 + 0.25 * s);
    check("kinetic_energy", &[kinetic]);
    check("potential_energy", &[potential]);
    check("energy", &[kinetic + potential]);
}

#[test]
fn space() {
    let mut model = model(
        "name: Space
parameters: {m: 1}
coordinates: {x: m, y: m, z: m}
bodies: {bob: {mass: m, position: '[x, y, z]'}}
gravity: [0, 0, -10]
springs: {s: {between: [ground, bob], stiffness: 8, rest: 1}}
",
    );
    assert_eq!(model.dimension, 3);
    let at = At::new(&[("x", 1.0), ("y", 2.0), ("z", 2.0), ("x'", 3.0)]);
    close(&at.of(&mut model, "cross([1, 0, 0], [0, 1, 0])"), &[0.0, 0.0, 1.0]);
    close(&at.of(&mut model, "cross(position(bob), velocity(bob))"), &[0.0, 6.0, -6.0]);
    close(&at.of(&mut model, "ground.z"), &[0.0, 0.0, 1.0]);
    close(&at.of(&mut model, "energy"), &[4.5 + 20.0 + 16.0]);
    assert_eq!(model.expression("bob.z").unwrap_err()[0].code, "E225");
}

#[test]
fn command_line_values() {
    let mut model = model(PLANE);
    let parameters: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
    let mut value = |text: &str| model.constant(text, Sets::Number, &parameters);
    assert_eq!(value("2*m + l + k[3]"), Ok(34.5));
    assert_eq!(value("180 deg"), Ok(std::f64::consts::PI));
    assert_eq!(value("n^2"), Ok(16.0));
    assert_eq!(value("x + 1").unwrap_err()[0].code, "E215");
    assert_eq!(value("t").unwrap_err()[0].code, "E216");
    assert_eq!(value("ln(-m)").unwrap_err()[0].code, "E231");
    assert_eq!(value("2 *").unwrap_err()[0].code, "E103");
    let mut model = crate::model(PLANE);
    let signal = model.signal("l*sin(2*t)", 0).unwrap();
    let at = At::new(&[("t", 0.4)]);
    let (s, c) = (0.8_f64.sin(), 0.8_f64.cos());
    close(&at.values(&model, &signal), &[0.5 * s, c, -2.0 * s]);
    assert_eq!(model.signal("x", 0).unwrap_err()[0].code, "E215");
    // In an input the names of inputs stand for their expressions.
    let signal = model.signal("2*u", 0).unwrap();
    close(&at.values(&model, &signal), &[2.0 * 1.2_f64.sin(), 6.0 * 1.2_f64.cos(), -18.0 * 1.2_f64.sin()]);
}
