//! Frequency responses of outputs, and per unit of the file's own forces, against closed forms.
#![cfg(all(feature = "cli", feature = "modal"))]

mod held;
mod quadrature;

use std::sync::atomic::{AtomicUsize, Ordering};

use dalembert::linear::{Drive, Guess, Source, equilibrium_near, linearise, observe};
use dalembert::mechanism::Dynamic;
use nalgebra::Complex;
use serde_json::Value;

type C = Complex<f64>;

fn i(omega: f64) -> C {
    Complex::new(0.0, omega)
}

/// What `modes` writes as JSON for the text of a model file, or its complaint.
fn run(text: &str, options: &[&str]) -> Result<Value, String> {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let of = (std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(format!("dalembert-responses-{}-{}.yaml", of.0, of.1));
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", "modes", path.to_str().unwrap(), "--json"];
    arguments.extend(options);
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    result.map(|()| serde_json::from_slice(&out).unwrap()).map_err(|problem| problem.to_string())
}

fn library(model: &str) -> String {
    std::fs::read_to_string(format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// (Ω, amplitude) of an answer.
fn answer(found: &Value, name: &str) -> Vec<(f64, C)> {
    let response = &found["response"];
    let omegas = response["omega"].as_array().unwrap().iter().map(|omega| omega.as_f64().unwrap());
    let column = response["amplitude"][name].as_array().unwrap_or_else(|| panic!("no {name} in {response}"));
    let pair = |x: &Value| Complex::new(x[0].as_f64().unwrap(), x[1].as_f64().unwrap());
    omegas.zip(column.iter().map(pair)).collect()
}

/// Every amplitude beside its closed form.
fn agrees(found: &Value, name: &str, exact: impl Fn(f64) -> C) {
    let list = answer(found, name);
    assert!(list.len() > 300);
    for (omega, x) in list {
        let expected = exact(omega);
        // Beside a pole at 1 the frequency's own rounding is all that counts.
        let near = 1.0 + 1.0 / (omega - 1.0).abs();
        assert!((x - expected).norm() < 1e-14 * near * (1.0 + expected.norm()), "{name} at {omega}: {x}, {expected}");
    }
}

/// A machine above a floor that shakes: the force on the floor, the floor itself and the machine's speed per metre of it.
#[test]
fn transmissibility_of_outputs() {
    let options = ["--drive", "y", "--response", "force_on_the_floor,floor,x'"];
    let found = run(&library("vibration_isolation"), &options).unwrap();
    let (k, c) = (1.0, 0.2);
    let x = |w: f64| (i(c * w) + k) / (i(c * w) + k - w * w);
    agrees(&found, "force_on_the_floor", |w| (i(c * w) + k) * (x(w) - 1.0));
    agrees(&found, "floor", |_| Complex::new(1.0, 0.0));
    agrees(&found, "x'", |w| i(w) * x(w));
    let units = &found["response"]["units"];
    assert_eq!((&units["force_on_the_floor"], &units["floor"]), (&"N/m".into(), &"m/m".into()), "{units}");
    assert_eq!(found["response"]["drive"], "y");
}

/// An entry of `forces` as the drive: 1 N along it, though it is 0 at rest; the acceleration per newton is 1/m far above.
#[test]
fn forces_of_the_file_drive() {
    let text = "name: A\nparameters: {m: 2 kg, k: 2 N/m, c: 14 N*s/m, F: 0 N}\ncoordinates: {x: m}\n\
        bodies: {b: {mass: m, position: \"[3*x/5, 4*x/5]\"}}\n\
        springs: {s: {stretch: x, stiffness: k, along: \"[3/5, 4/5]\", on: b}}\n\
        forces: {push: {on: b, force: \"[0, F]\"}, pull: {on: b, force: \"[0, -c*x']\"}, none: {on: b, force: \"[F, F]\"}}\n\
        outputs: {a: x'', spring: k*x}\n";
    let found = run(text, &["--drive", "push", "--response", "a,spring"]).unwrap();
    // 4/5 of the force lies along x, and of the resistance 14 x': 2 x'' + 11.2 x' + 2 x = 4/5.
    let d = |w: f64| i(14.0 * 0.8 * w) + 2.0 - 2.0 * w * w;
    agrees(&found, "a", |w| Complex::from(-0.8 * w * w) / d(w));
    agrees(&found, "spring", |w| Complex::from(1.6) / d(w));
    assert_eq!(found["response"]["units"], serde_json::json!({"a": "m/s^2/N", "spring": "N/N"}));
    let refused = run(text, &["--drive", "none", "--range", "1..2"]).unwrap_err();
    assert!(refused.contains("`none` vanishes at the equilibrium, where its direction is not known"), "{refused}");
    let unknown = run(text, &["--drive", "puch", "--range", "1..2"]).unwrap_err();
    assert!(unknown.contains("no input, force or coordinate is called `puch`; did you mean `push`?"), "{unknown}");
}

/// Torques of a pair turn both ends; the couple of 1 N m drives the relative angle alone.
#[test]
fn torques_of_the_file_drive() {
    let text = "name: A\nparameters: {J: 3 kg*m^2, k: 12 N*m, T: 0 N*m}\ncoordinates: {a: rad, b: rad}\n\
        bodies: {A: {mass: 1 kg, inertia: J, angle: a, position: \"[0, 0]\"}, B: {mass: 1 kg, inertia: J, angle: b, position: \"[0, 0]\"}}\n\
        springs: {s: {stretch: a - b, stiffness: k, on: A, from: B}}\n\
        torques: {motor: {on: A, from: B, torque: T}}\noutputs: {twist: a - b, both: a + b}\n";
    let found = run(text, &["--drive", "motor", "--response", "twist,both", "--range", "0.1..2"]).unwrap();
    agrees(&found, "twist", |w| Complex::from(2.0 / (24.0 - 3.0 * w * w)));
    agrees(&found, "both", |_| Complex::from(0.0));
    assert_eq!(found["response"]["units"]["twist"], "1/(N m)");
}

const PUSHED: &str = "name: A\nparameters: {m: 3 kg, l: 2 m, g: 2 m/s^2}\ncoordinates: {theta: rad}\n\
    inputs: {push: 0 N}\npoints: {O: [0, 0], P: \"[l*sin(theta), -l*cos(theta)]\"}\n\
    bodies: {bob: {mass: m, inertia: 0, angle: theta, position: P}}\ngravity: [0, -g]\n\
    forces: {push: {on: bob, at: P, force: \"[push, 0]\"}}\n\
    balances: {equations: [{force: {of: [bob]}}, {moment: {about: bob, of: [bob]}}], reactions: {hinge: {on: bob, at: O}}}\n\
    outputs: {hinge: hinge, tip: P, tip_a: acceleration(P), size: norm(hinge), late: t*theta, edge: abs(theta)}\n";

/// A pendulum that is pushed at its bob: the hinge answers with −(g/l)/(g/l − Ω²), whichever way its force is derived.
#[test]
fn hinge_force_of_a_pushed_pendulum() {
    let found = run(PUSHED, &["--drive", "push", "--response", "hinge,tip,tip_a"]).unwrap();
    agrees(&found, "hinge.x", |w| Complex::from(-1.0 / (1.0 - w * w)));
    agrees(&found, "hinge.y", |_| Complex::from(0.0));
    agrees(&found, "tip.x", |w| Complex::from(1.0 / (3.0 * (1.0 - w * w))));
    agrees(&found, "tip_a.x", |w| Complex::from(-w * w / (3.0 * (1.0 - w * w))));
    // A generalized force may act anywhere.
    let refused = run(PUSHED, &["--drive", "theta", "--response", "hinge"]).unwrap_err();
    assert!(refused.contains("`hinge.x` is a reaction, which depends on where a force acts"), "{refused}");
    assert!(run(PUSHED, &["--drive", "theta", "--response", "tip"]).is_ok());
}

#[test]
fn answers_without_slopes_are_refused() {
    let cases = [
        ("late", "`late` changes with time"),
        ("edge", "`edge` has no derivative at the equilibrium"),
        ("tipp", "no coordinate, rate or output is called `tipp`; did you mean `tip"),
    ];
    for (name, part) in cases {
        let refused = run(PUSHED, &["--response", name]).err().unwrap_or_default();
        assert!(refused.contains(part), "{refused}");
    }
    // The hinge carries the bob's weight, so that the size of its force has a derivative.
    assert!(run(PUSHED, &["--response", "size"]).is_ok());
}

mod compiled {
    dalembert::model!(
        yaml = r#"
name: Absorber
parameters: {m1: 4 kg, m2: 1 kg, k1: 16 N/m, k2: 9 N/m, w: 1 m/s, F: 1 N}
tables: {law: {points: [[-1, -3], [0, 0], [1, 2]], units: [m, N]}}
coordinates: {x: m, y: m}
inputs: {u: 0 N}
kinetic_energy: (m1*x'^2 + m2*y'^2)/2
potential_energy: (k1*x^2 + k2*(y - x)^2)/2
generalized_forces: {x: u}
outputs: {stretch: y - x, odd: "law(y) + F*exp(-x'/w)*cos(y'/w)", lifted: "m2*y'' - u", both: "[x, y]"}
"#
    );
}

/// Compiled and interpreted models have the same slopes.
#[test]
fn compiled_outputs_have_slopes() {
    let system = Dynamic::new(compiled::Absorber::default());
    let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0, 0.0])).unwrap()).unwrap();
    let seen = observe(&system, &linear, &["both", "odd", "lifted", "y'"]).unwrap();
    assert_eq!(seen.names, ["both.x", "both.y", "odd", "lifted", "y'"]);
    assert_eq!(seen.place.row(0).iter().copied().collect::<Vec<f64>>(), [1.0, 0.0]);
    assert_eq!((seen.place[(2, 0)], seen.rate[(2, 0)], seen.rate[(2, 1)]), (0.0, -1.0, 0.0));
    // The natural spline through three points: 5/2 in the middle.
    assert!((seen.place[(2, 1)] - 2.5).abs() < 1e-14, "{}", seen.place);
    assert_eq!((seen.acceleration[(3, 1)], seen.input[(3, 0)], seen.rate[(4, 1)]), (1.0, -1.0, 1.0));
}

/// Without damping a curve goes up to the frame's edge on both sides of each pole, down to it at √(k₂/m₂), and nowhere
/// ends; phases fall by half a turn at poles and rise by one at the antiresonance.
#[test]
fn curves_of_undamped_systems_are_whole() {
    let system = Dynamic::new(compiled::Absorber::default());
    let linear = linearise(&system, &equilibrium_near(&system, &Guess::at(&[0.0, 0.0])).unwrap()).unwrap();
    let seen = observe(&system, &linear, &["x", "stretch"]).unwrap();
    let drive: Drive = Source::Input(0).into();
    let response = linear.response(&drive, &seen, None).unwrap().to("u", "N");
    let figure = response.figure();
    let (sizes, phases) = (&figure.charts[0], &figure.charts[1]);
    assert_eq!((sizes.y.unit.as_str(), sizes.x.unit.as_str()), ("m/N", "rad/s"));
    let (bottom, top) = sizes.y.range.unwrap();
    // Poles of 4 x⁴ − 61 x² + 144 = 0, x = Ω.
    let root = |sign: f64| ((61.0 + sign * (61.0_f64 * 61.0 - 16.0 * 144.0).sqrt()) / 8.0).sqrt();
    let poles = [root(-1.0), root(1.0)];
    response.poles.iter().zip(poles).for_each(|(found, pole)| assert!((found - pole).abs() < 1e-14 * pole));
    let points: Vec<(f64, f64)> = sizes.series[0].points.iter().map(|point| point.expect("no gap")).collect();
    let pixel = (points[points.len() - 1].0 / points[0].0).ln() / 700.0;
    let near = |place: f64, side: f64| {
        let within = |w: f64| (0.0..pixel).contains(&(side * (w / place).ln()));
        points.iter().filter(move |point| within(point.0)).map(|point| point.1).collect::<Vec<f64>>()
    };
    for side in [-1.0, 1.0] {
        poles.iter().for_each(|pole| assert!(near(*pole, side).iter().any(|size| *size > top), "{pole} {side}"));
        assert!(near(3.0, side).iter().any(|size| *size < bottom), "{side}");
    }
    let phase = |w: f64| {
        let list = phases.series[0].points.iter().map(|point| point.expect("no gap"));
        list.min_by(|a, b| (a.0 - w).abs().total_cmp(&(b.0 - w).abs())).unwrap().1
    };
    assert_eq!([1.0, 2.0, 3.2, 5.0].map(phase), [0.0, -180.0, 0.0, -180.0]);
    // Between samples straight pieces are as good as the curve: within half a pixel of the figure's height.
    let height = (top / bottom).ln();
    let exact = |w: f64| (9.0 - w * w).abs() / ((25.0 - 4.0 * w * w) * (9.0 - w * w) - 81.0).abs();
    for pair in points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let w = (a.0 * b.0).sqrt();
        let straight = (0.5 * (a.1.ln() + b.1.ln())).exp().clamp(bottom, top);
        if (b.0 / a.0).ln() > 0.2 * pixel && !poles.iter().any(|pole| (a.0..=b.0).contains(pole)) {
            let off = (straight.ln() - exact(w).clamp(bottom, top).ln()).abs();
            assert!(off < 3e-3 * height, "{w}: {off} of {height}");
        }
    }
    let hertz = response.figure_in_hertz();
    let (one, other) = (hertz.charts[0].series[0].points[5].unwrap(), points[5]);
    assert!((one.0 * std::f64::consts::TAU / other.0 - 1.0).abs() < 1e-15 && one.1 == other.1);
    assert_eq!(hertz.charts[1].x.unit, "Hz");
}

/// At its resonance x = t sin(ωt) F/(2 m ω), so that x'' has a part that stays bounded: F/m cos ωt, without which the forces on the mass would not
/// balance.
#[test]
fn accelerations_at_a_resonance_have_a_bounded_part() {
    let text = "name: Swell\nparameters: {m: 2 kg, k: 50 N/m}\ncoordinates: {x: m}\ninputs: {u: 0 N}\n\
        bodies: {a: {mass: m, position: \"[x, 0]\"}}\npotential_energy: k*x^2/2\nforces: {f: {on: a, force: \"[u, 0]\"}}\n\
        outputs: {left: u - k*x - m*acceleration(a).x, late: \"acceleration(a).x + k*x/m\", rate: \"x'\"}\nscene: {until: 1}\n";
    let found = run(text, &["--drive", "u", "--omega", "5", "--response", "left,late,rate"]).unwrap();
    let answers = &found["steady"]["answers"];
    let [left, late] = ["left", "late"].map(|name| [0, 1].map(|part| answers[name][part].as_f64().unwrap()));
    assert_eq!(left, [0.0, 0.0], "{answers}");
    assert!((late[0] - 0.5).abs() < 1e-14 && late[1].abs() < 1e-14, "{answers}");
    assert!(answers["rate"].is_null(), "{answers}");
    assert!(answer(&found, "left").iter().all(|(_, x)| x.norm() == 0.0));
}
