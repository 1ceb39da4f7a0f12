//! The native half of the Python package `dalembert`: models, runs and equations, and the program itself.
//!
//! Commands take the options of the command line and answer with the JSON that `--json` prints; `python/dalembert` makes Python of both.
//! Work is done in a thread of its own without the interpreter's lock (`background.rs`), and no panic crosses into Python.

mod background;
mod equations;
mod model;
mod problem;
mod run;

use std::sync::OnceLock;

use dalembert::cli::Entry;
use pyo3::prelude::*;

/// The module `dalembert._dalembert`.
#[pymodule]
mod _dalembert {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::equations::Equations;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::run::Run;

    /// Runs the program with these arguments, the first of which is its name, and returns its exit code.
    #[pyfunction]
    fn program(py: Python<'_>, arguments: Vec<String>) -> u8 {
        py.detach(|| dalembert::cli::status(super::library(), arguments))
    }

    /// The name that the text of a model states.
    #[pyfunction]
    fn stated_name(text: &str) -> Option<String> {
        dalembert::cli::stated_name(text)
    }

    /// The names of the library's models.
    #[pyfunction]
    fn models() -> Vec<&'static str> {
        super::library().iter().map(|entry| entry.name).collect()
    }
}

/// The library's models, all of them interpreted, whatever else is built with this crate.
fn library() -> &'static [Entry] {
    static LIBRARY: OnceLock<Vec<Entry>> = OnceLock::new();
    LIBRARY.get_or_init(|| dalembert_models::MODELS.iter().map(|entry| Entry { compiled: None, ..*entry }).collect())
}

/// A class of exceptions of the package, by its name.
fn exception<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("dalembert._errors")?.getattr(name)
}
