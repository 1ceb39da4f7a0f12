//! `stability`: where a method is stable.

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Value, json};

use super::json::{number, object, write};
use super::{Problem, outputs};
use crate::mechanism::Method;
use crate::precision::{Limit, StabilityMap};

/// Prints the longest stable steps by damping, measured and by theory, and writes the map.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let text = |name: &str| options.get_one::<String>(name).map(String::as_str);
    let usage = Problem::usage;
    let method: Method = text("method").unwrap_or_default().parse().map_err(|e| usage(format!("{e}")))?;
    let longest: f64 = text("longest").unwrap_or("7").trim().parse().unwrap_or(f64::NAN);
    if !(longest > 0.0 && longest <= 1e6) {
        return Err(usage("--longest wants a positive number".to_owned()));
    }
    let path = text("plot").map_or_else(|| format!("{method}-stability.svg"), str::to_owned);
    outputs::check_paths(std::iter::once(("plot", path.as_str())), "")?;
    let map = StabilityMap::measure(method, longest).map_err(|error| usage(error.to_string()))?;
    outputs::draw(&path, map.chart())?;
    if options.get_flag("json") {
        let limit = |limit: &Limit| {
            let of = |limit: Option<f64>| limit.map_or(Value::Null, number);
            let [measured, theory] = [limit.measured, limit.theory].map(of);
            let again = limit.again.map_or(Value::Null, |(from, to)| json!([from, to]));
            object([("damping", number(limit.damping)), ("measured", measured), ("theory", theory), ("again", again)])
        };
        let limits = map.limits.iter().map(limit).collect();
        let object = object([
            ("method", json!(method.to_string())),
            ("longest", number(longest)),
            ("limits", limits),
            ("plot", json!(path)),
        ]);
        return Ok(write(&object, out)?);
    }
    writeln!(out, "h·ω up to which x'' + 2ζω x' + ω² x = 0 does not grow by {method}")?;
    writeln!(out, "{:>6}  {:>9}  {:>9}", "ζ", "measured", "theory")?;
    let write = |limit: Option<f64>| limit.map_or(format!("> {longest}"), |limit| format!("{limit:.4}"));
    for limit in &map.limits {
        let again = limit.again.map_or(String::new(), |(from, to)| format!("  nor from {from:.4} to {to:.4}"));
        writeln!(out, "{:>6.3}  {:>9}  {:>9}{again}", limit.damping, write(limit.measured), write(limit.theory))?;
    }
    writeln!(out, "written: {path}")?;
    Ok(())
}
