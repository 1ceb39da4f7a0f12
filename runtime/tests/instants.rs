//! Small departures from motions, at one of their instants: `linearise_instant`, `modes --at-time`.
#![cfg(feature = "cli")]

use dalembert::cli;
use dalembert::linear::{LinearError, NamedDrive, Source, linearise_instant};
use dalembert::mechanism::{At, Interpreted};
use dalembert_symbolic::lower::compile;
use serde_json::Value;

/// A cart with a pendulum, a motor with a current, a rod of its own length, and an input that lifts a table.
const CART: &str = "
name: Cart
parameters: {M: 2 kg, m: 1 kg, l: 0.5 m, g: 9.81 m/s^2, R: 3 ohm, L: 0.2 H, k: 0.7 N/A, W: 3 rad/s}
coordinates: {x: m, theta: rad}
inputs: {volts: 4*sin(W*t)}
states: {i: {unit: A, rate: (volts - R*i - k*x')/L}}
bodies:
  cart: {mass: M, position: '[x, 0]'}
  bob: {mass: m, position: 'cart + l*[sin(theta), -cos(theta)]'}
gravity: [0, -g]
forces: {motor: {on: cart, force: '[k*i, 0]'}}
outputs: {push: k*i, acceleration: \"x''\"}
scene: {start: {theta: 1, theta': -2}, until: 3, tolerance: 1e-12}
";

fn system(text: &str) -> Interpreted {
    Interpreted::new(compile(text, &[]).expect("a model"), text)
}

fn modes(text: &str, name: &str, options: &[&str]) -> (Result<(), cli::Problem>, String) {
    let path = std::env::temp_dir().join(format!("dalembert-instant-{name}-{}.yaml", std::process::id()));
    std::fs::write(&path, text).expect("a file");
    let words = [&["dalembert", "modes", path.to_str().expect("a path")][..], options].concat();
    let mut out = Vec::new();
    let outcome = cli::run(&[], words, &mut out);
    std::fs::remove_file(&path).expect("the file");
    (outcome, String::from_utf8(out).expect("text"))
}

fn volts() -> NamedDrive {
    NamedDrive { drive: Source::Input(0).into(), name: "volts".into(), unit: "V".into() }
}

/// Hand-derived: (M + m) x'' + m l (θ'' cos θ − θ'² sin θ) = k i, l θ'' + x'' cos θ + g sin θ = 0.
fn by_hand(theta: f64, rate: f64, i: f64) -> [f64; 2] {
    let (s, c) = theta.sin_cos();
    let x = (0.7 * i + 0.5 * rate * rate * s + 9.81 * s * c) / (3.0 - c * c);
    [x, -(x * c + 9.81 * s) / 0.5]
}

#[test]
fn departures_from_a_motion_are_those_of_the_equations_by_hand() {
    let system = system(CART);
    let (q, v) = ([0.3, 1.1, 0.0], [0.5, -2.0, 0.8]);
    let found =
        linearise_instant(&system, At::new(0.4, &q, &v), &[volts()], &["push", "acceleration", "i", "theta'"]).unwrap();
    let names: Vec<&str> = found.states.iter().map(|[name, _]| name.as_str()).collect();
    assert_eq!(names, ["x", "theta", "x'", "theta'", "i"]);
    let step = 1e-5;
    let differences = |by: [f64; 3]| {
        let at = |s: f64| by_hand(1.1 + s * by[0], -2.0 + s * by[1], 0.8 + s * by[2]);
        let (up, down) = (at(step), at(-step));
        [0, 1].map(|k| (up[k] - down[k]) / (2.0 * step))
    };
    for (column, by) in [(1, [1.0, 0.0, 0.0]), (3, [0.0, 1.0, 0.0]), (4, [0.0, 0.0, 1.0])] {
        for (row, expected) in differences(by).into_iter().enumerate() {
            let value = found.a[(2 + row, column)];
            assert!((value - expected).abs() < 1e-8 * expected.abs().max(1.0), "{row} {column}: {value} {expected}");
        }
        assert_eq!(found.c[(1, column)], found.a[(2, column)], "the output x'' is a row of A");
    }
    assert!((found.a[(4, 4)] + 15.0).abs() < 1e-13 && (found.a[(4, 2)] + 3.5).abs() < 1e-14);
    assert!((found.b[(4, 0)] - 5.0).abs() < 1e-14 && found.b[(2, 0)] == 0.0);
    let rows: Vec<Vec<f64>> = [0, 2, 3].map(|row| found.c.row(row).iter().copied().collect()).into();
    assert_eq!(rows, [[0.0, 0.0, 0.0, 0.0, 0.7], [0.0, 0.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0, 0.0]]);
    assert_eq!(found.outputs[0], ["push", "N"].map(str::to_owned));
}

#[test]
fn with_a_constraint_departures_follow_its_reaction() {
    let text = "
name: Rod
parameters: {m: 1 kg, l: 2 m, g: 9.81 m/s^2}
coordinates: {x: m, y: m}
inputs: {push: 0 N, lift: 0 m}
bodies: {bob: {mass: m, position: '[x, y]'}}
gravity: [0, -g]
forces: {wind: {on: bob, force: '[push, 0]'}}
constraints: {rod: x^2 + (y - lift)^2 - l^2 = 0}
outputs: {across: x*y' - y*x'}
scene: {start: {x: 1.2, y: -1.6, x': 0.8, y': 0.6}}
";
    let system = system(text);
    let (q, v) = ([1.2, -1.6], [0.8, 0.6]);
    let push = NamedDrive { drive: Source::Input(0).into(), name: "push".into(), unit: "N".into() };
    let found = linearise_instant(&system, At::new(0.0, &q, &v), &[push], &["across"]).unwrap();
    // Along the circle, x = l sin φ, y = −l cos φ: φ'' = −g/l sin φ + push cos φ/(m l), so that δ(φ'') = −g/l cos φ δφ.
    let (s, c) = (0.6_f64, 0.8_f64);
    let turned = |a: [f64; 2]| (c * a[0] + s * a[1]) / 2.0;
    let b = [found.b[(2, 0)], found.b[(3, 0)]];
    assert!((turned(b) - c / 2.0).abs() < 1e-14, "{b:?}");
    // δφ moves (x, y) by l (c, s) and turns the speed l φ' (c, s), φ' = 1/2, by l φ' (−s, c).
    let along = [2.0 * c, 2.0 * s, -s, c];
    let moved = |row: usize| (0..4).map(|k| found.a[(row, k)] * along[k]).sum::<f64>();
    // The acceleration is l φ'' (c, s) + l φ'² (−s, c): along (c, s) it changes by l δφ'' − l φ'² δφ.
    let expected = -9.81 / 2.0 * c - 0.25;
    assert!((turned([moved(2), moved(3)]) - expected).abs() < 1e-13, "{} {expected}", turned([moved(2), moved(3)]));
    let lift = NamedDrive { drive: Source::Input(1).into(), name: "lift".into(), unit: "m".into() };
    let refused = linearise_instant(&system, At::new(0.0, &q, &v), &[lift], &[]).unwrap_err();
    assert_eq!(refused, LinearError::MovedByInput { constraint: "rod".into(), input: "lift".into() });
}

#[test]
fn a_mass_is_that_of_its_state() {
    let spring = |mass: &str, more: &str| {
        format!(
            "name: Filling\nparameters: {{m: 1 kg, k: 16 N/m, r: 2 kg/s}}\ncoordinates: {{x: m{more}}}\ninputs: {{push: 0 N}}\n\
             states: {{s: {{unit: kg, rate: r}}}}\nbodies: {{b: {{mass: {mass}, position: '[x, 0]'}}}}\n\
             springs: {{k: {{stretch: x, stiffness: k, along: ground.x, on: b}}}}\nforces: {{push: {{on: b, force: '[push, 0]'}}}}\n"
        )
    };
    let push = NamedDrive { drive: Source::Input(0).into(), name: "push".into(), unit: "N".into() };
    // (m + s) x'' = −k x + push, at rest where x is: d(x'')/ds = k x/(m + s)².
    for (mass, by_place, by_state) in [("m + s", -4.0, 0.5), ("4*m", -4.0, 0.0)] {
        let found = linearise_instant(
            &system(&spring(mass, "")),
            At::new(0.0, &[0.5, 0.0], &[0.0, 3.0]),
            std::slice::from_ref(&push),
            &["x"],
        )
        .unwrap();
        assert_eq!([found.a[(1, 0)], found.a[(1, 2)], found.b[(1, 0)]], [by_place, by_state, 0.25], "{mass}");
    }
    // With a constraint, on which the mass has no say.
    let held = spring("m + s", ", y: m") + "constraints: {tie: x - y}\n";
    let found =
        linearise_instant(&system(&held), At::new(0.0, &[0.5, 0.5, 0.0], &[0.0, 0.0, 3.0]), &[push], &["x"]).unwrap();
    assert!((found.a[(2, 0)] + 4.0).abs() < 1e-14 && (found.b[(3, 0)] - 0.25).abs() < 1e-14, "{:?}", found.a);
}

#[test]
fn the_command_runs_the_scene_until_then() {
    let (outcome, text) = modes(CART, "json", &["--at-time", "400 ms", "--json"]);
    outcome.unwrap();
    let json: Value = serde_json::from_str(&text).expect("JSON");
    let number = |value: &Value| value.as_f64().expect("a number");
    assert_eq!(json["time"], 0.4);
    let (theta, rate, i) = (&json["state"]["theta"], &json["state"]["theta'"], &json["state"]["i"]);
    let step = 1e-5;
    let [up, down] = [step, -step].map(|s| by_hand(number(theta) + s, number(rate), number(i))[1]);
    assert!((number(&json["A"][3][1]) - (up - down) / (2.0 * step)).abs() < 1e-6);
    assert!(json["warnings"][0].as_str().expect("text").contains("not whether the motion is stable"));
    let growth: f64 = json["eigenvalues"].as_array().expect("pairs").iter().map(|pair| number(&pair[0])).sum();
    let trace: f64 = (0..5).map(|i| number(&json["A"][i][i])).sum();
    assert!((growth - trace).abs() < 1e-9, "{growth} {trace}");
    let (outcome, text) = modes(CART, "told", &["--at-time", "0"]);
    outcome.unwrap();
    assert!(text.contains("at t = 0 s of its motion, x = 0, theta = 1, x' = 0, theta' = -2, i = 0"), "{text}");
    assert!(text.contains("x = [x, theta, x', theta', i]") && text.contains("eigenvalues of A, 1/s: "), "{text}");
    let (outcome, _) = modes(CART, "refused", &["--at-time", "1", "--steady"]);
    assert!(outcome.unwrap_err().to_string().contains("--steady is about a rest"));
}
