//! The program as a function, with files and references beside it.

use serde_json::Value;

/// The numbers that were computed elsewhere, of a file of `tests/reference/states`.
pub fn reference(name: &str) -> Value {
    let path = format!("{}/../tests/reference/states/{name}.json", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the reference");
    serde_json::from_str::<Value>(&text).expect("JSON")["values"].clone()
}

/// What a command prints, or its error.
pub fn run(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    let all = [&["dalembert"], arguments].concat();
    dalembert::cli::run(&[], all, &mut out).map_err(|problem| problem.to_string())?;
    Ok(String::from_utf8(out).expect("text"))
}

/// What it prints as JSON.
pub fn json(arguments: &[&str]) -> Value {
    let text = run(&[arguments, &["--json"]].concat()).unwrap_or_else(|problem| panic!("{problem}"));
    serde_json::from_str(&text).unwrap_or_else(|problem| panic!("{problem}\n{text}"))
}

/// A file with some text, which is gone with it.
pub struct File(pub String);

impl File {
    pub fn new(name: &str, text: &str) -> File {
        let test = env!("CARGO_CRATE_NAME");
        let path = std::env::temp_dir().join(format!("dalembert-{test}-{name}-{}.yaml", std::process::id()));
        std::fs::write(&path, text).expect("a file");
        File(path.to_str().expect("a path").to_owned())
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

#[track_caller]
pub fn near(found: &Value, expected: f64, within: f64) {
    let found = found.as_f64().unwrap_or_else(|| panic!("no number: {found}"));
    assert!((found - expected).abs() <= within, "{found} is not {expected}, {:e} off", found - expected);
}
