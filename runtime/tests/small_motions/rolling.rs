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
