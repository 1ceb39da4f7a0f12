//! The command `modes` on model files of their own: what is easily misjudged, and mechanisms with constraints beside twins without, each
//! case beside a neighbour that must be left alone.
#![cfg(all(feature = "cli", feature = "modal"))]

mod branches;
mod first_order;
mod rests;
mod rolling;
mod rotations;
mod sampled;
mod steady;
mod trim;

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

/// A path that no other test has.
fn scratch(name: &str) -> PathBuf {
    static FILES: AtomicUsize = AtomicUsize::new(0);
    let of = (std::process::id(), FILES.fetch_add(1, Ordering::Relaxed));
    std::env::temp_dir().join(format!("dalembert-small-motions-{}-{}-{name}", of.0, of.1))
}

/// What the program writes for people about the text of a model file, or its complaint.
fn words(text: &str, options: &[&str]) -> Result<String, String> {
    let path = scratch("model.yaml");
    std::fs::write(&path, text).unwrap();
    let mut arguments = vec!["dalembert", "modes", path.to_str().unwrap()];
    arguments.extend(options);
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], arguments, &mut out);
    std::fs::remove_file(&path).unwrap();
    result.map(|()| String::from_utf8(out).unwrap()).map_err(|problem| problem.to_string())
}

/// As JSON, or its complaint.
fn try_run(text: &str, options: &[&str]) -> Result<Value, String> {
    let written = words(text, &[options, &["--json"]].concat())?;
    Ok(serde_json::from_str(&written).unwrap())
}

/// As JSON.
fn run(text: &str, options: &[&str]) -> Value {
    try_run(text, options).unwrap_or_else(|problem| panic!("{problem}\n{text}"))
}

/// (value, kind) of all limits of `--vary`.
fn limits(found: &Value) -> Vec<(f64, &str)> {
    let list = found["locus"]["limits"].as_array().unwrap();
    list.iter().map(|limit| (limit["value"].as_f64().unwrap(), limit["kind"].as_str().unwrap())).collect()
}

fn close(a: f64, b: f64, part: f64) {
    assert!((a - b).abs() <= part * b.abs(), "{a} is not {b}");
}
