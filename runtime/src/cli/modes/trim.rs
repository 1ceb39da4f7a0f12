//! `--hold` and `--solve`: inputs, parameters and held values with which a mechanism rests where coordinates are said to be.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use serde_json::{Value, json};

use super::super::Problem;
use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::plotted::parts;
use super::super::set_up::{Place, Reader, parameter_index, place_in_state, unknown};
use super::failed;
use crate::linear::{Guess, TrimmedValue, Unknown, trim_steady};
use crate::numbers::spaced;

/// So many digits of a value are printed at most.
const DIGITS: f64 = 12.0;

/// What was held, and what was found.
pub struct Trim {
    held: Vec<(String, f64)>,
    found: Vec<(TrimmedValue, String)>,
    iterations: usize,
}

impl Trim {
    /// Finds what `--solve` names, gives it to the mechanism and to the guess, which is then the rest; `None` without the option.
    pub fn new(
        loaded: &mut Loaded,
        options: &ArgMatches,
        reader: &mut Reader,
        guess: &mut Guess,
        (scene, speeds): (usize, &[usize]),
    ) -> Result<Option<Trim>, Problem> {
        if !options.contains_id("solve") {
            return Ok(None);
        }
        let held = holds(loaded, options, reader, guess)?;
        let unknowns = unknowns(loaded, options, reader, guess)?;
        let places: Vec<usize> = held.iter().map(|(place, _)| *place).collect();
        let asked = (places.as_slice(), unknowns.as_slice());
        let trimmed = trim_steady(&*loaded.system, guess, asked, (scene, speeds)).map_err(failed)?;
        trimmed.apply(&mut *loaded.system);
        *guess = trimmed.guess;
        let mut found = Vec::new();
        for value in trimmed.found {
            let unit = reader.model(loaded)?.unit_of(&value.name).map(|unit| dalembert_symbolic::print::si_unit(&unit));
            found.push((value, unit.unwrap_or_default()));
        }
        let value = |place: usize| {
            if place < loaded.system.description().mechanical() { guess.q[place] } else { guess.v[place] }
        };
        let held = held.into_iter().map(|(place, name)| (name, value(place))).collect();
        Ok(Some(Trim { held, found, iterations: trimmed.iterations }))
    }

    /// `trimmed with theta = 0.3 held: T = 9.55336489126 N m (1 step from T = 0)`.
    pub fn table(&self, name: &str, out: &mut dyn Write) -> Result<(), Problem> {
        let held: Vec<String> =
            self.held.iter().map(|(name, value)| format!("{name} = {}", digits(*value, 0.0))).collect();
        writeln!(out, "{name}: trimmed with {} held", held.join(", "))?;
        for (found, unit) in &self.found {
            let TrimmedValue { name, from, value, uncertainty, .. } = found;
            let unit = spaced(unit);
            let (value, from) = (digits(*value, *uncertainty), digits(*from, 0.0));
            writeln!(out, "  {name} = {value}{unit}, sought from {from}")?;
        }
        // One step is what equations take that are linear in all that is sought.
        if self.iterations > 1 {
            writeln!(
                out,
                "  {} steps of Newton's method: of several solutions the one that these lead to; --solve NAME=VALUE begins elsewhere",
                self.iterations
            )?;
        }
        Ok(())
    }

    /// The key `trim`.
    pub fn as_json(&self) -> (&'static str, Value) {
        let held = object(self.held.iter().map(|(name, value)| (name.clone(), number(*value))));
        let found = self.found.iter().map(|(found, unit)| {
            let entries = [
                ("value", number(found.value)),
                ("unit", json!(unit)),
                ("uncertainty", number(found.uncertainty)),
                ("from", number(found.from)),
            ];
            (found.name.clone(), object(entries))
        });
        ("trim", object([("held", held), ("found", object(found)), ("iterations", json!(self.iterations))]))
    }
}

/// Places in the state that `--hold` names, each put where it is said to be, or kept where the guess has it.
fn holds(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    guess: &mut Guess,
) -> Result<Vec<(usize, String)>, Problem> {
    let mut held: Vec<(usize, String)> = Vec::new();
    for text in options.get_many::<String>("hold").into_iter().flatten().flat_map(|text| parts(text)) {
        let (name, value) =
            text.split_once('=').map_or((text.trim(), None), |(name, value)| (name.trim(), Some(value)));
        let hidden = |i: usize| i >= loaded.system.description().mechanical();
        let (place, sets, list) = match place_in_state(loaded, name)? {
            Place::Coordinate(i) => (i, Sets::Coordinate(i), &mut guess.q),
            Place::Speed(i) if hidden(i) => (i, Sets::Speed(i), &mut guess.v),
            Place::Speed(_) => {
                return Err(Problem::usage(format!("--hold is for places, and `{name}` is a rate; at rest all are 0")));
            }
        };
        if held.iter().any(|(known, _)| *known == place) {
            return Err(Problem::usage(format!("--hold gives `{name}` twice")));
        }
        if let Some(value) = value {
            list[place] = reader.value(loaded, "hold", sets, value)?;
        }
        held.push((place, name.to_owned()));
    }
    Ok(held)
}

/// What `--solve` names; `NAME=VALUE` lets the search begin there.
fn unknowns(
    loaded: &mut Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    guess: &mut Guess,
) -> Result<Vec<Unknown>, Problem> {
    let mut unknowns = Vec::new();
    for text in options.get_many::<String>("solve").into_iter().flatten().flat_map(|text| parts(text)) {
        let (name, value) =
            text.split_once('=').map_or((text.trim(), None), |(name, value)| (name.trim(), Some(value)));
        let (found, sets) = named(loaded, name)?;
        if unknowns.contains(&found) {
            return Err(Problem::usage(format!("--solve gives `{name}` twice")));
        }
        if let Some(value) = value {
            let value = reader.value(loaded, "solve", sets, value)?;
            match found {
                Unknown::Input(k) => guess.inputs[k] = value,
                other => other.give(&mut *loaded.system, value),
            }
        }
        unknowns.push(found);
    }
    Ok(unknowns)
}

/// An input, a held value or a free parameter.
fn named(loaded: &Loaded, name: &str) -> Result<(Unknown, Sets), Problem> {
    let (description, sampling) = (loaded.system.description(), loaded.system.sampling());
    if let Some(k) = description.inputs.iter().position(|input| input == name) {
        return Ok((Unknown::Input(k), Sets::Input(k)));
    }
    if let Some(k) = sampling.place_of(name) {
        return Ok((Unknown::Memory(k), Sets::Memory(k)));
    }
    if description.derived.iter().any(|derived| derived == name)
        || description.parameters.iter().any(|p| p.name == name)
    {
        let k = parameter_index(loaded, name)?;
        return Ok((Unknown::Parameter(k), Sets::Parameter(k)));
    }
    let inputs = description.inputs.iter().map(AsRef::as_ref);
    let known = inputs.chain(sampling.memory.iter().map(|held| held.name.as_ref()));
    Err(unknown(
        "input, parameter or held value",
        name,
        known.chain(description.parameters.iter().map(|p| p.name.as_ref())),
    ))
}

/// The digits of a number that an uncertainty leaves, twelve at most; 0 where it leaves none, `?` where it is not known.
fn digits(value: f64, uncertainty: f64) -> String {
    if !uncertainty.is_finite() {
        return "?".to_owned();
    }
    if value.abs() <= uncertainty {
        return "0".to_owned();
    }
    let certain = -(uncertainty / value).abs().log10();
    let count = if certain.is_nan() { DIGITS } else { certain.floor().clamp(1.0, DIGITS) };
    let rounded: f64 = format!("{value:.*e}", count as usize - 1).parse().unwrap_or(value);
    let usual = rounded == 0.0 || (1e-4..1e7).contains(&rounded.abs());
    if usual { (rounded + 0.0).to_string() } else { format!("{rounded:e}") }
}
