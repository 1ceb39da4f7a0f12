//! `modes --steady --vary` through constraints that contain speeds and have no integrals: what rolls.

use serde_json::Value;

use super::{limits, run};

fn model(name: &str) -> String {
    let path = format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(path).unwrap()
}

fn reference(name: &str) -> Value {
    let path = format!("{}/../tests/reference/space/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A number that is written as text.
fn number(value: &Value) -> f64 {
    value.as_str().unwrap().parse().unwrap()
}

/// (re, im) of the eigenvalues of a step, without those that are 0 everywhere.
fn moving(step: &Value, zeros: usize) -> Vec<[f64; 2]> {
    let pair = |x: &Value| [0, 1].map(|k| x[k].as_f64().unwrap());
    let all: Vec<[f64; 2]> = step["eigenvalues"].as_array().unwrap().iter().map(pair).collect();
    assert!(all[..zeros].iter().all(|x| *x == [0.0, 0.0]), "{step}");
    all[zeros..].to_vec()
}

/// The benchmark bicycle: where weave ends and capsize begins, and at every state of the branch eigenvalues of the published
/// M λ² + v C₁ λ + g K₀ + v² K₂; place, wheels, heading and speed stay as they are set.
#[test]
fn a_bicycle_is_stable_between_weave_and_capsize() {
    let known = reference("whipple_linear");
    let found = run(&model("whipple_bicycle"), &["--scene", "straight", "--steady", "--vary", "v=0.5..10"]);
    let [(weave, flutter), (capsize, divergence)] = limits(&found)[..] else { panic!("{}", found["locus"]["limits"]) };
    assert_eq!((flutter, divergence), ("flutter", "divergence"));
    assert!((weave - number(&known["weave_speed"])).abs() < 1e-12, "{weave}");
    assert!((capsize - number(&known["capsize_speed"])).abs() < 1e-12, "{capsize}");
    let entry = |name: &str, i: usize, j: usize| number(&known[name][i][j]);
    for step in found["locus"]["steps"].as_array().unwrap() {
        let v = step["value"].as_f64().unwrap();
        let moving = moving(step, 6);
        assert_eq!(moving.len(), 4, "{step}");
        // a λ⁴ + b λ³ + c λ² + d λ + e, from the products of the entries' polynomials.
        let [a, b, c, d, e] = quartic(|i, j| {
            let stiffness = 9.81 * entry("K0", i, j) + v * v * entry("K2", i, j);
            [entry("M", i, j), v * entry("C1", i, j), stiffness]
        });
        let sum: f64 = moving.iter().map(|x| x[0]).sum();
        assert!((sum + b / a).abs() < 1e-11 * (b / a).abs(), "{v}: {sum}");
        for [re, im] in moving {
            // Σ |terms|, and what an error of 1e-12 makes.
            let powers = [a, b, c, d, e];
            let value = powers.iter().fold([0.0, 0.0], |[x, y], k| [x * re - y * im + k, x * im + y * re]);
            let size = powers.iter().fold(0.0, |sum, k| sum * re.hypot(im) + k.abs());
            let slope = [4.0 * a, 3.0 * b, 2.0 * c, d].iter().fold(0.0, |sum, k| sum * re.hypot(im) + k.abs());
            assert!(value[0].hypot(value[1]) < 1e-12 * (size + slope), "{v}: {re} {im}");
        }
    }
}

/// det of a matrix of two rows with polynomials of degree 2 as entries, highest power first.
fn quartic(entry: impl Fn(usize, usize) -> [f64; 3]) -> [f64; 5] {
    let mut sum = [0.0; 5];
    for (sign, x, y) in [(1.0, entry(0, 0), entry(1, 1)), (-1.0, entry(0, 1), entry(1, 0))] {
        for (i, a) in x.iter().enumerate() {
            for (j, b) in y.iter().enumerate() {
                sum[i + j] += sign * a * b;
            }
        }
    }
    sum
}

/// Upright rolling: C ω (C + m R²) ω = A m g R with A = m R²/4 and C = m R²/2 about the axle (Routh), in either direction.
#[test]
fn a_disc_rolls_upright_above_its_speed() {
    let found = run(&model("rolling_disc"), &["--scene", "upright", "--steady", "--vary", "phi'=-4..4"]);
    let threshold = 2.5573423705088844;
    let [(back, _), (forth, _)] = limits(&found)[..] else { panic!("{}", found["locus"]["limits"]) };
    assert!((back + threshold).abs() < 1e-11 && (forth - threshold).abs() < 1e-11, "{back} {forth}");
    for step in found["locus"]["steps"].as_array().unwrap() {
        let rolling = step["value"].as_f64().unwrap();
        // λ² = g/(5/4 R)·(1 − ω²/ω₀²).
        let square = 9.81 / (1.25 * 0.5) * (1.0 - (rolling / threshold).powi(2));
        let [re, im] = moving(step, 6)[1];
        assert!((re * re - im * im - square).abs() < 1e-11 && (re * im).abs() < 1e-12, "{rolling}: {re} {im}");
    }
}

/// λ² of a disc that rolls along a circle, from the equations of Euler's disc, in θ' = p, the spin n and the turning r about the
/// axes of the leaning frame, with I = A + m R²:
/// I p' = (C + m R²) r n − A r² tan θ + m g R sin θ, (C + m R²) n' = −m R² r p, A r' = −C p n + A r p tan θ.
fn squared(theta: f64, psi: f64, phi: f64) -> [f64; 2] {
    let (m, radius, g) = (1.0, 0.5, 9.81);
    let (about_diameter, about_axle, tread) = (0.0625, 0.125, m * radius * radius);
    let (inertia, rolling) = (about_diameter + tread, about_axle + tread);
    let (n, r) = (phi + psi * theta.sin(), psi * theta.cos());
    let accelerated = (rolling * r * n - about_diameter * r * r * theta.tan() + m * g * radius * theta.sin()) / inertia;
    let by_lean = (m * g * radius * theta.cos() - about_diameter * (r / theta.cos()).powi(2)) / inertia;
    let by_spin = rolling * r / inertia * (-tread * r / rolling);
    let by_turning = (rolling * n - 2.0 * about_diameter * r * theta.tan()) / inertia;
    [accelerated, by_lean + by_spin + by_turning * (r * theta.tan() - about_axle * n / about_diameter)]
}

/// The steady circle of the reference: x, y and the heading turn as a whole.  The eigenvalue is that of the reduced equations with
/// 40 digits; a start beside it leads there.
#[test]
fn a_disc_rolls_along_a_circle_steadily() {
    let text = model("rolling_disc");
    let expected = 2.453_847_718_902_244_5_f64;
    for more in [&[][..], &["--at", "theta=0.31"], &["--here"]] {
        let found = run(&text, &[&["--scene", "circle", "--steady"], more].concat());
        assert_eq!(found["turning"], serde_json::json!(["x", "y"]), "{found}");
        assert_eq!((&found["zeros"], &found["departures"]), (&6.into(), &8.into()), "{found}");
        assert!((found["equilibrium"]["theta"].as_f64().unwrap() - 0.3).abs() < 1e-14, "{found}");
        for [re, im] in moving(&found, 6) {
            assert!(re.abs() < 1e-13 && (im.abs() - expected).abs() < 1e-11, "{re} {im}");
        }
    }
    let along = run(&text, &["--scene", "circle", "--steady", "--vary", "psi'=-3..-0.5"]);
    let steps = along["locus"]["steps"].as_array().unwrap();
    assert!(limits(&along).is_empty() && steps.len() > 60, "{}", along["locus"]["limits"]);
    for step in steps {
        let [psi, theta] = [&step["value"], &step["equilibrium"]["theta"]].map(|x| x.as_f64().unwrap());
        let [accelerated, square] = squared(theta, psi, 3.066812354922589);
        let [re, im] = moving(step, 6)[1];
        assert!(accelerated.abs() < 1e-12 && (re * re - im * im - square).abs() < 1e-10, "{psi}: {re} {im}, {square}");
    }
    let near = squared(0.3, -1.5, 3.066812354922589)[1];
    assert!((near + expected.powi(2)).abs() < 1e-12, "{near}");
}

/// A disc that spins upright on its place: A + m R² times the square of its rate is m g R.
#[test]
fn a_spinning_disc_stands_above_its_rate() {
    let options = ["--scene", "upright", "--steady", "--at", "phi'=0", "--at", "psi'=4", "--vary", "psi'=1..5"];
    let found = run(&model("rolling_disc"), &options);
    let [(threshold, "divergence")] = limits(&found)[..] else { panic!("{}", found["locus"]["limits"]) };
    assert!((threshold - 3.9618177646126027).abs() < 1e-11, "{threshold}");
    for step in found["locus"]["steps"].as_array().unwrap() {
        let [re, im] = moving(step, 6)[1];
        let square = squared(0.0, step["value"].as_f64().unwrap(), 0.0)[1];
        assert!((re * re - im * im - square).abs() < 1e-11, "{step}");
    }
}

/// A heavy top precesses steadily, in angles that are cyclic without any turn: with p₃ = I₃ (φ' + ψ' cos θ) and I about the foot
/// it nutates at ω² = (p₃/I − 2 ψ' cos θ)² + (ψ' sin θ)².
#[test]
fn a_top_nutates_about_its_steady_precession() {
    let (psi, phi, about_foot, axial) = (1.3454, 40.0, 0.4, 0.1);
    let found = run(&model("heavy_top"), &["--steady", "--at", "psi'=1.3454", "--at", "theta=0.5"]);
    let theta = found["equilibrium"]["theta"].as_f64().unwrap();
    let momentum = axial * (phi + psi * theta.cos());
    // m g l = (p₃ − I ψ' cos θ) ψ'.
    assert!(((momentum - about_foot * psi * theta.cos()) * psi - 9.81 * 0.5).abs() < 1e-12, "{theta}");
    let expected = (momentum / about_foot - 2.0 * psi * theta.cos()).hypot(psi * theta.sin());
    let fastest = found["modes"].as_array().unwrap().iter().map(|mode| mode["omega"].as_f64().unwrap());
    let fastest = fastest.fold(0.0, f64::max);
    assert!((fastest - expected).abs() < 1e-11, "{fastest} is not {expected}");
}

/// A bicycle without hands on circles that a run of 3 s keeps to 13 digits, and a start beside one: it leans and steers, and x, y and the
/// heading turn as a whole.
#[test]
fn a_bicycle_keeps_to_its_circle() {
    let circle = |v: f64, phi: f64, delta: f64| {
        let circle = format!(
            "scenes:\n  circle: {{start: {{x: 0, y: 0, psi: 0, thR: 0, thF: 0, phi: {phi}, phi': 0, delta: {delta}, delta': 0, \
             thR': -v/rR}}, guess: {{pitch: 0}}}}\n"
        );
        model("whipple_bicycle").replace("scenes:\n", &circle).replace("v: 4.6 m/s", &format!("v: {v:?} m/s"))
    };
    let exact = [(5.99780560896461, 0.1, 0.02910841874575428), (5.908324285295904, 0.2, 0.06015738456984883)];
    let options = ["--scene", "circle", "--steady"];
    for (v, phi, delta) in exact {
        let found = run(&circle(v, phi, delta), &options);
        assert_eq!(found["turning"], serde_json::json!(["x", "y"]), "{found}");
        let at = |name: &str| found["equilibrium"][name].as_f64().unwrap();
        assert!((at("phi") - phi).abs() < 1e-10 && (at("delta") - delta).abs() < 1e-10, "{found}");
    }
    // A start that is none of these motions leads to the one between 0.05, at 6.0178 m/s, and 0.1.
    let beside = run(&circle(6.0, 0.1, 0.0288), &options);
    let phi = beside["equilibrium"]["phi"].as_f64().unwrap();
    assert!(phi > 0.05 && phi < 0.1, "{beside}");
}
