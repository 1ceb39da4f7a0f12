//! The command `modes` on the library's model files, against the reference cases (`B02` … `B21` of the reference
//! numbers) and closed forms.
#![cfg(feature = "cli")]
#![expect(clippy::excessive_precision, reason = "reference numbers as they were given")]

use serde_json::Value;

/// What the program writes for a model of the library, or its complaint.
fn run(model: &str, options: &[&str]) -> Result<Value, (u8, String)> {
    let path = format!("{}/../models/{model}.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut arguments = vec!["dalembert", "modes", &path, "--json"];
    arguments.extend(options);
    let mut out = Vec::new();
    match dalembert::cli::run(&[], arguments, &mut out) {
        Ok(()) => Ok(serde_json::from_slice(&out).unwrap()),
        Err(problem) => Err((problem.status(), problem.to_string())),
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn matrix(value: &Value) -> Vec<Vec<f64>> {
    value.as_array().unwrap().iter().map(numbers).collect()
}

fn omegas(value: &Value) -> Vec<f64> {
    value["modes"].as_array().unwrap().iter().map(|mode| mode["omega"].as_f64().unwrap()).collect()
}

fn kinds(value: &Value) -> Vec<&str> {
    value["modes"].as_array().unwrap().iter().map(|mode| mode["kind"].as_str().unwrap()).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{found:?} is not {expected:?}");
    }
}

#[test]
fn b02_double_pendulum() {
    let found = run("double_pendulum", &[]).unwrap();
    close(&matrix(&found["M"]).concat(), &[4.0 / 3.0, 0.5, 0.5, 1.0 / 3.0]);
    close(&matrix(&found["K"]).concat(), &[15.0, 0.0, 0.0, 5.0]);
    close(&matrix(&found["C"]).concat(), &[0.0; 4]);
    close(&omegas(&found), &[2.705943757628078708018491, 7.257952078965087355040786]);
    assert_eq!(found["coordinates"], serde_json::json!(["theta1", "theta2"]));
    let keys: Vec<&String> = found.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["model", "equilibrium", "residual", "coordinates", "M", "C", "K", "modes"]);
}

#[test]
fn b03_triple_pendulum() {
    let found = run("triple_pendulum", &[]).unwrap();
    let m = [7.0 / 3.0, 1.5, 0.5, 1.5, 4.0 / 3.0, 0.5, 0.5, 0.5, 1.0 / 3.0];
    close(&matrix(&found["M"]).concat(), &m);
    let expected = [2.202107963826273540272502, 5.477225575051661134569698, 10.34764695178231458306389];
    close(&omegas(&found), &expected);
}

#[test]
fn b10_cart_pendulum_hanging_and_inverted() {
    let hanging = run("cart_pendulum", &[]).unwrap();
    assert_eq!(kinds(&hanging), ["rigid", "oscillating"]);
    assert!(hanging["modes"][0]["zeta"].is_null());
    close(&omegas(&hanging)[1..], &[3.872983346207416885179265]);
    let inverted = run("cart_pendulum", &["--at", "theta=3", "--at", "x=2"]).unwrap();
    assert_eq!(kinds(&inverted), ["unstable", "rigid"]);
    close(&numbers(&inverted["modes"][0]["eigenvalue"]), &[3.872983346207416885179265, 0.0]);
    assert!((inverted["equilibrium"]["theta"].as_f64().unwrap() - std::f64::consts::PI).abs() < 1e-14);
}

#[test]
fn b11_b12_rolling_cylinders() {
    close(&omegas(&run("rolling_cylinder", &[]).unwrap()), &[2.981423969999719595212232]);
    let pipe = run("cylinder_in_pipe", &[]).unwrap();
    assert_eq!(kinds(&pipe), ["rigid", "oscillating"]);
    close(&omegas(&pipe)[1..], &[3.496029493900505156638178]);
}

#[test]
fn b13b_slot_turntable_with_springs() {
    let found = run("slot_turntable_springs", &["--scene", "offset"]).unwrap();
    close(&matrix(&found["M"]).concat(), &[2.25, -0.5, -0.5, 1.0]);
    close(&omegas(&found), &[2.947198925247252496258704, 7.587095524311094357620457]);
}

#[test]
fn b18_three_masses() {
    let root = std::f64::consts::SQRT_2;
    let found = run("three_masses", &[]).unwrap();
    close(&omegas(&found), &[0.76536686473017954345692, root, 1.847759065022573512256366]);
    let shape = |mode: usize| -> Vec<f64> {
        found["modes"][mode]["shape"].as_array().unwrap().iter().map(|x| x[0].as_f64().unwrap()).collect()
    };
    close(&shape(0), &[0.5, root / 2.0, 0.5]);
    close(&shape(1), &[root / 2.0, 0.0, -root / 2.0]);
    close(&shape(2), &[0.5, -root / 2.0, 0.5]);
}

#[cfg(feature = "modal")]
#[test]
fn b18_damped_chain() {
    let eigenvalues = |scene: &str| -> Vec<f64> {
        let found = run("damped_chain", &["--scene", scene]).unwrap();
        assert_eq!(kinds(&found), ["damped"; 3]);
        found["modes"].as_array().unwrap().iter().flat_map(|mode| numbers(&mode["eigenvalue"])).collect()
    };
    let parallel = [
        -0.05857864376269049511983113,
        0.7631218645287453386808003,
        -0.2,
        1.4,
        -0.3414213562373095048801689,
        1.815941909830314821805293,
    ];
    close(&eigenvalues("parallel"), &parallel);
    let one = [
        -0.06306788131221175364097352,
        0.7737776737010220006822875,
        -0.1329489668251750198767196,
        1.406301793304230935731833,
        -0.05398315186261322648230686,
        1.822951053635081430460634,
    ];
    close(&eigenvalues("one_damper"), &one);
}

#[test]
fn b19_spring_structures_by_rank() {
    let cases: [(&str, &[&str], usize, &[f64]); 5] = [
        ("free_chain", &[], 1, &[1.0, 3.0]),
        ("triangle_springs", &[], 3, &[1.5, 1.5, 3.0]),
        ("square_springs", &[], 4, &[2.0, 2.0, 2.0, 2.0]),
        ("square_springs", &["--scene", "braced"], 3, &[2.0, 2.0, 2.0, 2.0, 4.0]),
        ("hexagon_springs", &[], 6, &[1.0, 1.5, 1.5, 2.5, 2.5, 3.0]),
    ];
    for (model, options, rigid, squares) in cases {
        let found = run(model, options).unwrap();
        assert_eq!(kinds(&found).iter().filter(|kind| **kind == "rigid").count(), rigid, "{model}");
        close(&omegas(&found)[rigid..].iter().map(|omega| omega * omega).collect::<Vec<_>>(), squares);
    }
}

#[test]
fn b20_chains_and_strings() {
    let ring = omegas(&run("periodic_chain", &[]).unwrap());
    let mut expected: Vec<f64> = (0..12).map(|j| 2.0 * (std::f64::consts::PI * f64::from(j) / 12.0).sin()).collect();
    expected.sort_by(f64::total_cmp);
    close(&ring, &expected);
    for (n, first) in [
        ("2", [3.0, 5.1961524227066318806]),
        ("10", [3.1309264420122730898, 6.1981162505114533497]),
        ("20", [3.1386639306298186802, 6.259775179399326771]),
    ] {
        close(&omegas(&run("string_masses", &["--size", &format!("n={n}")]).unwrap())[..2], &first);
    }
    close(&omegas(&run("string_rayleigh", &[]).unwrap()), &[3.162277660168379332]);
}

#[test]
fn a_pendulum_aside_is_refused_with_its_residual() {
    let (status, text) = run("simple_pendulum", &["--at", "theta=pi/4", "--here"]).unwrap_err();
    assert_eq!(status, 1);
    assert!(text.contains("no equilibrium") && text.contains("theta: 7.07106781186547"), "{text}");
    let found = run("simple_pendulum", &["--at", "theta=pi/4"]).unwrap();
    close(&omegas(&found), &[10.0_f64.sqrt()]);
    let up = run("simple_pendulum", &["--at", "theta=pi", "--here"]).unwrap();
    assert_eq!(kinds(&up), ["unstable"]);
    assert!(matches!(run("simple_pendulum", &["--at", "phi=1"]), Err((2, _))));
}

#[test]
fn people_get_a_table() {
    let path = format!("{}/../models/double_pendulum_points.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut out = Vec::new();
    dalembert::cli::run(&[], ["dalembert", "modes", &path], &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    for part in ["equilibrium at theta1 = 0, theta2 = 0", "K =", "1: oscillating, omega = 2.420", "carried by"] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn modes_are_drawn_and_animated() {
    let folder = std::env::temp_dir().join(format!("dalembert-modes-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let (svg, html) = (file("modes.svg"), file("mode.html"));
    run("three_masses", &["--plot", &svg, "--animate", &html, "--mode", "2"]).unwrap();
    let drawn = std::fs::read_to_string(&svg).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.matches("at rest").count() == 3);
    assert!(std::fs::read_to_string(&html).unwrap().contains("omega = 1.414"));
    let (status, text) = run("three_masses", &["--mode", "4"]).unwrap_err();
    assert!(status == 2 && text.contains("modes 1 to 3"), "{text}");
    std::fs::remove_dir_all(folder).unwrap();
}
