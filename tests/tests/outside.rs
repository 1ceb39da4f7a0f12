//! A stranger's crate builds against dalembert and runs.

use std::path::{Path, PathBuf};
use std::process::Command;

#[test]
fn a_crate_outside_the_workspace_builds_and_runs() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("outside/Cargo.toml");
    let output = Command::new(env!("CARGO"))
        .args(["run", "--quiet", "--locked", "--manifest-path"])
        .arg(&manifest)
        .arg("--target-dir")
        .arg(target())
        .output()
        .expect("cargo can be started");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    // The model file's one warning, once of three: where it is not silenced.
    assert_eq!(told.matches("warning[W420]: `plate` has mass and turns, and has no `inertia`").count(), 1, "{told}");
    assert!(told.contains("models/doubtful.yaml:5:27"), "{told}");
    let number = |key: &str| -> f64 {
        let line = text.lines().find_map(|line| line.strip_prefix(key)).unwrap_or_else(|| panic!("no {key}: {text}"));
        line.split_whitespace().next().and_then(|x| x.parse().ok()).unwrap_or(f64::NAN)
    };
    // T/2 = π √(l/g) / agm(1, cos(θ₀/2)), θ₀ = 20°.
    let (mut a, mut b) = (1.0_f64, 10_f64.to_radians().cos());
    for _ in 0..6 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    let expected = std::f64::consts::PI * (2.5_f64 / 9.81).sqrt() / a;
    assert!((number("half period ") - expected).abs() < 1e-8, "{text}");
    assert!(number("balance ") < 1e-10, "{text}");
}

/// A folder beside this test's own target folder, so that a second run finds what the first built.
fn target() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("outside")
}
