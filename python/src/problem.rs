//! Errors of the library as exceptions of the package.

use dalembert::cli::{LoadError, Problem};
use pyo3::prelude::*;

use crate::exception;

/// The exception of what a command refuses.
pub fn raised(py: Python<'_>, problem: &Problem) -> PyErr {
    made(py, class(problem), (text(problem),))
}

/// The name of its class.
pub fn class(problem: &Problem) -> &'static str {
    match problem {
        Problem::Usage(_) => "UsageError",
        Problem::Model(_) => "ModelError",
        Problem::Run(_) => "RunError",
        Problem::File(_) | Problem::Closed => "FileError",
    }
}

/// The words of a problem, without the mark that a terminal shows before them.
pub fn text(problem: &Problem) -> String {
    let text = problem.to_string();
    text.strip_prefix("error: ").map_or_else(|| text.clone(), str::to_owned)
}

/// The exception of a model that cannot be loaded.
pub fn unloaded(py: Python<'_>, error: &LoadError) -> PyErr {
    match error {
        LoadError::Unread(problem) => raised(py, problem),
        LoadError::Wrong { text, path, problems } => made(py, "ModelError", (text.trim_end(), path, problems)),
    }
}

/// An exception of the package, of the class of this name.
pub fn made<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    exception(py, class).and_then(|class| class.call1(arguments)).map_or_else(|error| error, PyErr::from_value)
}
