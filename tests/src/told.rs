//! What the program tells as JSON, beside references of motions that are found.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use dalembert_models::MODELS;
use serde_json::Value;

/// What the program prints as JSON.
///
/// # Errors
/// What it says is wrong.
///
/// # Panics
/// If what it prints is not JSON.
pub fn told(arguments: &[&str]) -> Result<Value, String> {
    let mut out = Vec::new();
    let arguments = ["dalembert"].iter().chain(arguments).chain(&["--json"]);
    match dalembert::cli::run(MODELS, arguments, &mut out) {
        Ok(()) => Ok(serde_json::from_slice(&out).expect("JSON")),
        Err(problem) => Err(problem.to_string()),
    }
}

/// The path of a file with this text.
///
/// # Panics
/// If it cannot be written.
pub fn written(text: &str) -> String {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let name = format!("dalembert-told-{}-{}.yaml", std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, text).expect("a file");
    path.to_str().expect("a path").to_owned()
}

/// A file of `reference/orbits` by its name without `.json`.
///
/// # Panics
/// If there is none.
pub fn reference(name: &str) -> Value {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("reference/orbits").join(format!("{name}.json"));
    let all: Value = serde_json::from_str(&std::fs::read_to_string(path).expect("a reference")).expect("JSON");
    all[name].clone()
}

/// A number, also one that stands as text for the sake of its digits; NaN of anything else.
pub fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.parse().ok()).unwrap_or(f64::NAN)
}

/// # Panics
/// If a number is farther from another than this.
#[track_caller]
pub fn near(found: f64, expected: f64, error: f64) {
    assert!((found - expected).abs() <= error, "{found:?} is not {expected:?} within {error:e}");
}
