//! Shapes in space: their numbers, and what is refused.

use dalembert_symbolic::file::locate;
use dalembert_symbolic::model::{Model, Shape, Solid, load};

use crate::{At, close, model};

const SPACE: &str = "name: Test
parameters: {m: 1 kg, R: 2 m, g: 10 m/s^2, w: 3 rad/s}
coordinates: {x: m, a: rad}
frames: {B: {rotate: [z, a]}, C: {from: B, rotate: [x, 0.5]}}
points: {P: [x, 1, 2], Q: [0, 0, 0], \"p[i in 1..2]\": [i, 0, 0]}
bodies:
  hull: {mass: m, inertia: [1, 1, 1], frame: B, position: P}
  bead: {mass: m, position: Q}
";

const PLANE: &str = "name: Test
parameters: {m: 1 kg, R: 2 m}
coordinates: {x: m}
points: {P: '[x, 1]', Q: '[0, 0]'}
bodies: {hull: {mass: m, inertia: 1, angle: x/R, position: P}}
";

fn drawn(shape: &str) -> Model {
    model(&format!("{SPACE}draw: [{shape}]\n"))
}

/// A shape, where x = 3 and B is turned by a quarter.
#[track_caller]
fn is(shape: &str, kind: Solid, numbers: &[f64]) {
    let model = drawn(shape);
    let [Shape::Solid(found, ids)] = &model.draw[..] else { panic!("{shape}: {:?}", model.draw) };
    assert_eq!(*found, kind, "{shape}");
    let at = At::new(&[("x", 3.0), ("a", std::f64::consts::FRAC_PI_2)]);
    let rounded: Vec<f64> = at.values(&model, ids).iter().map(|x| (x * 1e15).round() / 1e15).collect();
    close(&rounded, numbers);
}

#[test]
fn shapes_in_space_have_few_numbers() {
    is("{circle: {at: P, axis: B.x, radius: R}}", Solid::Ring, &[3.0, 1.0, 2.0, 0.0, 2.0, 0.0]);
    // An axis is as long as the radius, however it is written.
    is("{disc: {at: hull, axis: 3*B.x, radius: 10 cm}}", Solid::Disc, &[3.0, 1.0, 2.0, 0.0, 0.1, 0.0]);
    is("{disc: {at: [0, 0, 1], axis: P - Q, radius: 0}}", Solid::Disc, &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    is("{cylinder: {from: P, to: Q, radius: R/4}}", Solid::Cylinder, &[3.0, 1.0, 2.0, 0.0, 0.0, 0.0, 0.5]);
    is("{sphere: {at: \"P + [0, 0, R]\", radius: 0.5}}", Solid::Sphere, &[3.0, 1.0, 4.0, 0.5]);
    is(
        "{box: {frame: B, at: P, size: [2 m, 40 cm, R]}}",
        Solid::Box,
        &[3.0, 1.0, 2.0, 0.0, 1.0, 0.0, -0.2, 0.0, 0.0, 0.0, 0.0, 1.0],
    );
    is(
        "{ellipsoid: {frame: hull, size: [1, 2, 3]}}",
        Solid::Ellipsoid,
        &[3.0, 1.0, 2.0, 0.0, 1.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 3.0],
    );
    is("{plane: {at: Q, normal: ground.z, size: 6 m}}", Solid::Plane, &[0.0, 0.0, 0.0, 0.0, 0.0, 6.0]);
}

#[test]
fn axes_are_at_a_centre_of_mass_or_where_they_are_put() {
    let unit = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    is("{axes: hull}", Solid::UnitAxes, &[&[3.0, 1.0, 2.0][..], &unit].concat());
    is("{axes: {frame: B, at: Q}}", Solid::UnitAxes, &[&[0.0; 3][..], &unit].concat());
    let half = unit.map(|x| x / 2.0);
    is("{axes: {frame: hull, at: Q, size: 50 cm}}", Solid::Axes, &[&[0.0; 3][..], &half].concat());
    is("{axes: ground}", Solid::UnitAxes, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn shapes_in_space_come_in_families() {
    let model = drawn("{sphere: {at: \"p[i]\", radius: R/i}, each: i in 1..2}, {trace: P}");
    let radius = |shape: &Shape| match shape {
        Shape::Solid(Solid::Sphere, numbers) => At::default().values(&model, numbers)[3],
        _ => f64::NAN,
    };
    close(&model.draw[..2].iter().map(radius).collect::<Vec<_>>(), &[2.0, 1.0]);
    assert!(matches!(&model.draw[2], Shape::Trace(name, _) if name == "P"));
}

#[test]
fn what_is_up_is_against_the_usual_gravity() {
    assert_eq!(drawn("").usual_gravity, [0.0; 3]);
    assert_eq!(model(&format!("{SPACE}gravity: [0, 0.2*g, -g]\n")).usual_gravity, [0.0, 2.0, -10.0]);
    // What is known only along a run is not known here.
    assert_eq!(model(&format!("{SPACE}gravity: [\"g*sin(w*t)\", 0, g]\n")).usual_gravity, [0.0, 0.0, 10.0]);
}

/// One problem with this code at these words, and this way out.
#[track_caller]
fn refused(base: &str, shape: &str, code: &str, words: &str, help: &str) {
    let text = format!("{base}draw: [{shape}]\n");
    let problems = load(&text, &[]).err().unwrap_or_default();
    let [problem] = &problems[..] else { panic!("{shape}: {problems:?}") };
    let marked = &text[locate(&text, &[&problem.place])[0].clone()];
    assert_eq!((problem.code, marked), (code, words), "{shape}");
    assert!(problem.help.contains(help), "{shape}: {}", problem.help);
}

#[test]
fn in_the_plane_there_is_another_shape_for_each() {
    for (shape, key, help) in [
        ("{disc: {at: P, axis: hull.x, radius: R}}", "disc", "`circle: {at: P, radius: r}`"),
        ("{sphere: {at: P, radius: R}}", "sphere", "`circle: {at: P, radius: r}`"),
        ("{cylinder: {from: P, to: Q, radius: R}}", "cylinder", "`line: [P, Q]`"),
        ("{box: {frame: hull, at: P, size: [1, 2, 3]}}", "box", "`line: [A, B, C, D, A]`"),
        ("{ellipsoid: {frame: hull, at: P, size: [1, 2, 3]}}", "ellipsoid", "`curve: "),
        ("{plane: {at: P, normal: hull.x, size: 1}}", "plane", "`line: [P, Q]`"),
        ("{axes: hull}", "axes", "`line: [P, P + B.x]`"),
        ("{circle: {at: P, axis: hull.x, radius: R}}", "axis", "leave `axis` out"),
    ] {
        refused(PLANE, shape, "E321", key, help);
    }
}

#[test]
fn what_is_missing_or_wrong_is_said() {
    for (shape, code, words, help) in [
        ("{disc: {at: P, radius: R}}", "E302", "disc", ""),
        ("{disc: {at: P, axis: B.x, radus: R}}", "E301", "radus", "`radius`"),
        ("{disc: {at: P, axis: R, radius: R}}", "E211", "R", ""),
        ("{disc: {at: P, axis: B.x, radius: 2 kg}}", "E242", "2", ""),
        ("{disc: {at: P, axis: [0, 0, 0], radius: R}}", "E323", "[0, 0, 0]", "`ground.z`"),
        ("{circle: {at: P, axis: Q, radius: R}}", "E323", "Q", "`ground.z`"),
        ("{plane: {at: P, normal: ground.z - ground.z, size: R}}", "E323", "ground.z - ground.z", ""),
        ("{box: {frame: B, at: P, size: [1, 2]}}", "E308", "[1, 2]", ""),
        ("{box: {frame: B, at: P, size: 1}}", "E304", "1", ""),
        ("{box: {frame: B, size: [1, 2, 3]}}", "E302", "box", ""),
        ("{box: {frame: bead, size: [1, 2, 3]}}", "E406", "bead", "`frame`"),
        ("{axes: B}", "E322", "B", "`axes: {frame: B, at: P}`"),
        ("{axes: {frame: B, size: 1}}", "E322", "B", "`axes: {frame: B, at: P}`"),
        ("{axes: bead}", "E406", "bead", "`frame`"),
        ("{axes: P}", "E224", "P", ""),
        ("{axes: 2*B.x}", "E224", "2*B.x", ""),
        ("{axes: D}", "E201", "D", ""),
        ("{sphere: {at: P, radius: 1}, disc: {at: P, axis: B.x, radius: 1}}", "E305", "", ""),
    ] {
        let marked = if words.is_empty() { shape } else { words };
        refused(SPACE, shape, code, marked, help);
    }
}
