//! Whole files of LANGUAGE.md, section 12.

use crate::{At, close, model};

const DOUBLE_PENDULUM: &str = r#"
name: DoublePendulum
about: Two uniform bars, hinged at the origin and at the elbow (TAM 4735, problem 19).
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
"#;

#[test]
fn double_pendulum() {
    let mut model = model(DOUBLE_PENDULUM);
    assert_eq!(model.name, "DoublePendulum");
    assert_eq!(model.coordinates.len(), 2);
    assert_eq!(model.bodies.len(), 2);
    let (a, b, da, db) = (0.4_f64, 1.1_f64, 0.7, -1.3);
    let at = At::new(&[("theta1", a), ("theta2", b), ("theta1'", da), ("theta2'", db)]);
    close(&at.of(&mut model, "hand"), &[a.sin() + b.sin(), -a.cos() - b.cos()]);
    // Uniform bars: T = (m l²/6)(4 a'² + b'² + 3 a' b' cos(a − b)), V = −m g l (3 cos a + cos b)/2.
    let kinetic = (4.0 * da * da + db * db + 3.0 * da * db * (a - b).cos()) / 6.0;
    let potential = -10.0 * (3.0 * a.cos() + b.cos()) / 2.0;
    close(&at.of(&mut model, "kinetic_energy"), &[kinetic]);
    close(&at.of(&mut model, "potential_energy"), &[potential]);
    close(&at.of(&mut model, "energy"), &[kinetic + potential]);
    let scene = &model.scenes[0];
    close(&at.values(&model, &scene.q), &[std::f64::consts::FRAC_PI_2, std::f64::consts::PI]);
    close(&at.values(&model, &[scene.until, scene.tolerance]), &[10.0, 1e-10]);
    assert_eq!(model.draw.len(), 2);
    assert_eq!(model.outputs[0].name, "tip");
}

const FIGURE_EIGHT: &str = r#"
name: FigureEight
about: Montgomery's three-body choreography (TAM 4735, problem 7).
sizes: {n: 3}
parameters: {m: 1, G: 1}
coordinates: {"x[i in 1..n]": 1, "y[i in 1..n]": 1}
bodies: {"star[i in 1..n]": {mass: m, position: "[x[i], y[i]]"}}
springs: {"pull[i in 1..n, j in i+1..n]": {between: ["star[i]", "star[j]"], energy: -G*m^2/length}}
conserved:
  energy: energy
  momentum: sum(m*velocity(star[i]), i in 1..n)
  spin: sum(m*cross(position(star[i]), velocity(star[i])), i in 1..n)
scene:
  start:
    "x[i in 1..n]": [-0.97000436, 0.97000436, 0]
    "y[i in 1..n]": [0.24308753, -0.24308753, 0]
    "x[i in 1..n]'": [-0.466203685, -0.466203685, 0.93240737]
    "y[i in 1..n]'": [-0.432365730, -0.432365730, 0.86473146]
  until: 10
"#;

#[test]
fn figure_eight() {
    let mut model = model(FIGURE_EIGHT);
    let names: Vec<&str> = model.loads.iter().map(|load| load.name.as_str()).collect();
    assert_eq!(names, ["pull[1,2]", "pull[1,3]", "pull[2,3]"]);
    let at = At::new(&[("x[1]", 3.0), ("y[2]", 4.0), ("x[2]'", 2.0), ("y[3]'", 5.0)]);
    // Stars at (3, 0), (0, 4), (0, 0).
    close(&at.of(&mut model, "potential_energy"), &[-1.0 / 5.0 - 1.0 / 3.0 - 1.0 / 4.0]);
    close(&at.of(&mut model, "kinetic_energy"), &[2.0 + 12.5]);
    assert_eq!(model.conserved[1].value.len(), 2);
    close(&at.values(&model, &model.conserved[1].value), &[2.0, 5.0]);
    close(&at.values(&model, &model.conserved[2].value), &[-8.0]);
    // The pull on star 1 towards star 2: 1/25 along (−3, 4)/5, and its opposite.
    let pushes = &model.loads[0].pushes;
    assert_eq!((pushes[0].body, pushes[1].body), (Some(0), Some(1)));
    close(&at.values(&model, &pushes[0].force), &[-3.0 / 125.0, 4.0 / 125.0]);
    close(&at.values(&model, &pushes[1].force), &[3.0 / 125.0, -4.0 / 125.0]);
    close(&at.values(&model, &model.scenes[0].q), &[-0.97000436, 0.97000436, 0.0, 0.24308753, -0.24308753, 0.0]);
    close(&at.values(&model, &model.scenes[0].v[..3]), &[-0.466203685, -0.466203685, 0.93240737]);
}

#[test]
fn string_rayleigh() {
    let mut model = model(
        "name: StringRayleigh
parameters: {rho: 1 kg/m, tension: 1 N, L: 2 m}
coordinates: {b: 1/m}
kinetic_energy:   integral(rho/2*(b'*x*(L-x))^2, x in 0..L)
potential_energy: integral(tension/2*diff(b*x*(L-x), x)^2, x in 0..L)
",
    );
    // ∫ x²(L−x)² dx = L⁵/30, ∫ (L − 2x)² dx = L³/3.
    let at = At::new(&[("b", 3.0), ("b'", 5.0)]);
    close(&at.of(&mut model, "kinetic_energy"), &[12.5 * 32.0 / 30.0]);
    close(&at.of(&mut model, "potential_energy"), &[4.5 * 8.0 / 3.0]);
    assert_eq!(model.scenes.len(), 1);
    close(&at.values(&model, &[model.scenes[0].until, model.scenes[0].tolerance]), &[10.0, 1e-9]);
}

#[test]
fn simple_pendulum() {
    let mut model = model(
        "name: SimplePendulum
parameters: {m: 2 kg, l: 50 cm, g: 10 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: 'l*[sin(theta), -cos(theta)]'}}
gravity: [0, -g]
scene: {start: {theta: 30 deg}}
",
    );
    assert_eq!(model.parameters[1].default, 0.5);
    let at = At::new(&[("theta", 0.3), ("theta'", 2.0)]);
    close(&at.of(&mut model, "energy"), &[1.0 - 10.0 * 0.3_f64.cos()]);
    close(&at.values(&model, &model.scenes[0].q), &[std::f64::consts::PI / 6.0]);
}
