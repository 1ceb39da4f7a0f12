//! `modes` of a mechanism with constraints: in independent coordinates, shapes in all of the file's.

use std::io::Write;

use clap::ArgMatches;
use clap::parser::ValueSource;
use serde_json::json;

use super::super::load::Loaded;
use super::super::{Problem, json};
use super::{failed, pictures, report};
use crate::linear::{Guess, linearise_constrained};

/// Options that need the equations in all coordinates.
const OTHERS: [&str; 8] = ["steady", "motion", "drive", "omega", "bode", "range", "vary", "locus"];

/// Linearises at rest and prints the modes.
pub fn run(loaded: &Loaded, options: &ArgMatches, guess: &Guess, out: &mut dyn Write) -> Result<(), Problem> {
    let given = |option: &&&str| options.value_source(option) == Some(ValueSource::CommandLine);
    if let Some(option) = OTHERS.iter().find(given) {
        let words = format!("error: --{option} is not there for a mechanism with constraints; use minimal coordinates");
        return Err(Problem::Usage(words));
    }
    let system = &*loaded.system;
    let found = linearise_constrained(system, guess, options.get_flag("here")).map_err(failed)?;
    let modes = found.in_all_coordinates(&found.linear.modes().map_err(failed)?);
    pictures(loaded, options, &found.linear, &modes)?;
    let rows = system.active_rows().iter().map(|row| system.description().rows[*row as usize].name.to_string());
    let reactions: Vec<(String, f64)> = rows.zip(found.multipliers.iter().copied()).collect();
    if options.get_flag("json") {
        let reactions = reactions.into_iter().map(|(name, value)| (name, json::number(value)));
        let more = vec![("shape_coordinates", json!(found.coordinates)), ("reactions", json::object(reactions))];
        json::write(&report::as_json(&loaded.name, &found.linear, &modes, more), out)?;
        return Ok(());
    }
    report::table(&loaded.name, &found.linear, &modes, &[], out)?;
    for (name, value) in reactions {
        writeln!(out, "reaction({name}) at rest = {}", crate::linear::short(value))?;
    }
    Ok(())
}
