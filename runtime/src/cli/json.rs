//! JSON with numbers of 17 significant digits.

use std::io;

use serde_json::ser::{Formatter, Serializer};
use serde_json::{Map, Value};

/// One value on one line.
pub fn write(value: &Value, out: &mut dyn io::Write) -> io::Result<()> {
    let mut bytes = Vec::new();
    serde::Serialize::serialize(value, &mut Serializer::with_formatter(&mut bytes, Digits))?;
    out.write_all(&bytes)?;
    writeln!(out)
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
