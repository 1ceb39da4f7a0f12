//! Symmetric starts, watched along runs.
#![cfg(feature = "cli")]

use serde_json::Value;

/// What `simulate --symmetries` prints of a particle at y = 1e-13 on a saddle (−) or in a bowl (+), or the JSON of it.
fn simulated(sign: &str, options: &[&str]) -> String {
    let text = format!(
        "name: Saddle\ncoordinates: {{x: m, y: m}}\nparameters: {{k: 1 N/m, h: 1 N/m^3, m: 1 kg}}\n\
         bodies: {{p: {{mass: m, position: \"[x, y]\"}}}}\n\
         potential_energy: k*x^2/2 {sign} k*y^2/2 + h*x^2*y^2/100 + h*y^4/4\n\
         scene: {{start: {{x: 1, y: 1e-13}}, until: 40, tolerance: 1e-9}}\n"
    );
    let name = format!("dalembert-symmetries-{}-{}-{}.yaml", std::process::id(), sign == "+", options.len());
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", "simulate", path.to_str().unwrap(), "--symmetries"];
    arguments.extend(options);
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    result.unwrap_or_else(|problem| panic!("{problem}"));
    String::from_utf8(out).unwrap()
}

#[test]
fn a_motion_that_leaves_its_symmetry_is_warned_of() {
    let text = simulated("-", &[]);
    assert!(text.contains("the motion leaves its symmetry y -> -y from t = "), "{text}");
    let data: Value = serde_json::from_str(&simulated("-", &["--json"])).unwrap();
    let symmetry = &data["symmetries"][0];
    assert_eq!(symmetry["symmetry"], "y -> -y");
    // It comes as far as the bottoms of the wells, y² = k/h or more.
    assert!(symmetry["departure"].as_f64().unwrap() > 1.0, "{data}");
    let warnings = data["warnings"].to_string();
    // y = 1e-13 cosh t: 1e-6 of x's range is exceeded, by y − (−y), at t = ln(1e7).
    let t: f64 = warnings.split("from t = ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((t - 1e7_f64.ln()).abs() < 0.5, "{warnings}");
}

#[test]
fn symmetries_are_listed_with_the_subspace_of_each_start() {
    let path = format!("{}/../models/three_masses.yaml", env!("CARGO_MANIFEST_DIR"));
    let mut out = Vec::new();
    dalembert::cli::run(&[], ["dalembert", "check", &path, "--symmetries"], &mut out).unwrap();
    let text = String::from_utf8(out).unwrap();
    for line in [
        "symmetries of `second_mode`: x[1] <-> x[3]; x[1] -> -x[1], x[2] -> -x[2], x[3] -> -x[3]",
        "its start has x[1] <-> -x[3], x[2] -> -x[2]: the motion stays in x[1] = -x[3], x[2] = 0",
        "its start has x[1] <-> x[3]: the motion stays in x[1] = x[3]",
        "its start has none of them",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
}

#[test]
fn a_motion_that_keeps_its_symmetry_is_not() {
    let text = simulated("+", &[]);
    assert!(
        text.contains("symmetry       y -> -y: the motion departs from it by ") && !text.contains("leaves"),
        "{text}"
    );
}
