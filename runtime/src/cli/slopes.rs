//! `simulate --slopes`: how the end of a run changes with its start and with parameters.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::diagnose::did_you_mean_or;
use serde_json::{Value, json};

use super::Problem;
use super::json::{number, object};
use super::load::Loaded;
use super::plotted::filled_parts;
use super::set_up::origin;
use crate::mechanism::HIDDEN;
use crate::run::written;
use crate::vary::{run_with_slopes, unknown};
use crate::{Error, Settings, Slope, Slopes};

/// The slopes that `--slopes` asks for; `None` where it is not given.
pub fn asked(loaded: &mut Loaded, settings: &Settings, options: &ArgMatches) -> Result<Option<Slopes>, Problem> {
    let Some(names) = options.get_one::<String>("slopes") else { return Ok(None) };
    let origin = origin(loaded, options)?;
    let names: Vec<&str> = filled_parts(names).collect();
    let mut unknowns = Vec::with_capacity(names.len());
    for name in names {
        let found = unknown(&*loaded.system, name).map_err(|error| match &error {
            Error::UnknownName { known, .. } => {
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let hint = did_you_mean_or(name, &known);
                Problem::usage(format!("--slopes: no coordinate, rate or parameter is called `{name}`; {hint}"))
            }
            _ => Problem::refused(&error),
        })?;
        unknowns.push((name.to_owned(), found));
    }
    let settings = Settings { every: None, ..settings.clone() };
    run_with_slopes(&mut *loaded.system, &settings, &origin, &unknowns).map(Some).map_err(|error| match error {
        Error::NoSlopes(_) => Problem::Run(error.to_string()),
        error => Problem::usage(format!("--slopes: {error}")),
    })
}

/// A line for every slope that is not 0.
pub fn write(slopes: &Slopes, out: &mut dyn Write) -> Result<(), Problem> {
    writeln!(out, "slopes at the end, in SI units")?;
    for (unknown, end) in slopes.unknowns.iter().zip(&slopes.end_time) {
        if slopes.run.ended_by().is_some() {
            writeln!(out, "  d t/d {unknown} = {}", text(*end))?;
        }
        for name in slopes.names().iter().filter(|name| !name.starts_with(HIDDEN)) {
            let slope = slopes.get(name, unknown).filter(|slope| slope.value != 0.0);
            if let Some(slope) = slope {
                writeln!(out, "  d {name}/d {unknown} = {}", text(slope))?;
            }
        }
    }
    Ok(())
}

fn text(slope: Slope) -> String {
    written(slope.value, if slope.error.is_nan() { f64::INFINITY } else { slope.error })
}

/// The same as data.
pub fn as_json(slopes: &Slopes) -> Value {
    let one = |slope: Slope| json!({"value": number(slope.value), "error": number(slope.error)});
    object(slopes.unknowns.iter().zip(&slopes.end_time).map(|(unknown, end)| {
        let of = |name: &String| (name.clone(), slopes.get(name, unknown).map_or(Value::Null, one));
        let list = slopes.names().iter().filter(|name| !name.starts_with(HIDDEN)).map(of);
        let end = slopes.run.ended_by().map(|_| ("t".to_owned(), one(*end)));
        (unknown.clone(), object(end.into_iter().chain(list)))
    }))
}
