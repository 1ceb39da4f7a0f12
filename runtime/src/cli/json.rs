//! JSON with numbers of 17 significant digits.

use std::io;

use serde_json::ser::{Formatter, Serializer};
use serde_json::{Map, Value};

use super::Problem;

/// The number of the format: it changes when keys change their meaning or go.
const FORMAT: u32 = 1;

/// One object on one line, its format first.
pub fn write(value: &Value, out: &mut dyn io::Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    let mut serializer = Serializer::with_formatter(&mut bytes, Digits);
    match value {
        Value::Object(entries) => {
            let format = Value::from(FORMAT);
            let entries = entries.iter().map(|(key, value)| (key.as_str(), value));
            serde::Serializer::collect_map(&mut serializer, std::iter::once(("format", &format)).chain(entries))?;
        }
        other => serde::Serialize::serialize(other, &mut serializer)?,
    }
    out.write_all(&bytes)?;
    writeln!(out)
}

/// The same of a command that may have failed, which the object then says beside what there is.
///
/// # Errors
/// The command's own.
pub fn write_outcome(mut value: Value, outcome: Result<(), Problem>, out: &mut dyn io::Write) -> Result<(), Problem> {
    if let Err(problem) = &outcome {
        value["error"] = problem.as_json();
    }
    write(&value, out)?;
    outcome
}

struct Digits;

impl Formatter for Digits {
    fn write_f64<W: ?Sized + io::Write>(&mut self, writer: &mut W, value: f64) -> io::Result<()> {
        write!(writer, "{value:.16e}")
    }
}

/// A number, or `null` where it is not finite.
pub fn number(x: f64) -> Value {
    serde_json::Number::from_f64(x).map_or(Value::Null, Value::Number)
}

/// An object in the order given.
pub fn object<K: Into<String>>(entries: impl IntoIterator<Item = (K, Value)>) -> Value {
    Value::Object(entries.into_iter().map(|(k, v)| (k.into(), v)).collect::<Map<_, _>>())
}
