//! What the program says when it cannot go on.

use std::fmt;

use serde_json::Value;

use super::json::object;
use super::set_up::unknown;
use crate::Error;

/// Why a command failed.
#[derive(Debug)]
pub enum Problem {
    /// Bad usage.
    Usage(String),
    /// A bad model file, rendered.
    Model(String),
    /// A run failed; what was computed has been written.
    Run(String),
    /// Something could not be written or read.
    File(String),
    /// The reader of the output has gone.
    Closed,
}

/// Settings that have an option of their name, and nothing in a file that sets them for one run.
const OPTIONS: [&str; 4] = ["step", "stiffness", "damping", "alpha"];

impl Problem {
    /// Bad usage, in these words.
    pub(super) fn usage(text: impl fmt::Display) -> Problem {
        Problem::Usage(format!("error: {text}"))
    }

    /// What is refused before it begins: settings, which are options here, and names, with the nearest that is known.
    pub(super) fn refused(error: &Error) -> Problem {
        match error {
            Error::BadSetting { setting, value, expected } if OPTIONS.contains(setting) => {
                Problem::usage(format!("--{setting} is {value}; expected {expected}"))
            }
            Error::NoStep { method } => Problem::usage(format!("`{method}` needs a fixed step: give --step TIME")),
            Error::UnknownName { kind, name, known } => unknown(kind, name, known.iter().map(String::as_str)),
            other => Problem::usage(other),
        }
    }

    /// A file that was named to be read and cannot be; where it is not there, its name is wrong.
    pub(super) fn unread(path: &str, error: &std::io::Error) -> Problem {
        let text = format!("cannot read {path}: {error}");
        match error.kind() {
            std::io::ErrorKind::NotFound => Problem::usage(text),
            _ => Problem::File(text),
        }
    }

    /// The process's exit code.
    pub fn status(&self) -> u8 {
        match self {
            Problem::Usage(_) => 2,
            Problem::Model(_) | Problem::Run(_) | Problem::File(_) | Problem::Closed => 1,
        }
    }
}

impl Problem {
    /// What `--json` prints of it under `error`.
    pub(super) fn as_json(&self) -> Value {
        let kind = match self {
            Problem::Usage(_) => "usage",
            Problem::Model(_) => "model",
            Problem::Run(_) => "run",
            Problem::File(_) | Problem::Closed => "file",
        };
        let message = self.to_string();
        let message = message.strip_prefix("error: ").unwrap_or(&message);
        object([("kind", kind.into()), ("message", message.into())])
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::Usage(text) | Problem::Model(text) => f.write_str(text.trim_end()),
            Problem::Closed => f.write_str("the output was closed"),
            Problem::Run(text) | Problem::File(text) => write!(f, "error: {}", text.trim_end()),
        }
    }
}

impl std::error::Error for Problem {}

impl From<std::io::Error> for Problem {
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Problem::Closed,
            _ => Problem::File(error.to_string()),
        }
    }
}
