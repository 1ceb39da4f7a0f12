//! `solve`: finds starts, parameters and end times for which a motion does what is wanted.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::diagnose::quoted;
use dalembert_symbolic::model::{Sets, cells_of};
use serde_json::{Value as Json, json};

use super::json::{number, object};
use super::load::{Loaded, listed_pairs};
use super::plotted::parts;
use super::set_up::{Place, Reader, for_search, like_output, motion_index, parameter_index, place_in_state};
use super::{Context, Problem, outputs, value_files};
use crate::error::{Error, NoSlopes, NotFound};
use crate::find::{Found, Record, Search, Value, another};
use crate::mechanism::Coordinate;
use crate::numbers::{counted, short_within, spaced};
use crate::run::plain;

/// Searches, and prints what was found.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let (loaded, described) = for_search(context, options, &["save", "plot"])?;
    let mut reader = Reader::default();
    let mut search = Search::of(Ok(described));
    if let Some(place) = motion_index(&loaded, options)? {
        let numbers = loaded.system.motion_numbers(place);
        let asked = search.asking(place, &loaded.system.motions()[place], numbers);
        search = asked.map_err(Problem::usage)?;
    }
    for (name, text) in listed_pairs(options, "unknown")? {
        let value = read(&mut reader, &loaded, "unknown", (&name, &text))?;
        search = search.unknown(&name, value);
    }
    for (name, text) in listed_pairs(options, "such-that")? {
        let value = read(&mut reader, &loaded, "such-that", (&name, &text))?;
        stays(&mut reader, &loaded, options, (&name, &text, value))?;
        search = search.such_that(&name, value);
    }
    search = wanted(search, options)?;
    match search.solve() {
        Ok(found) => report(&loaded, &found, options, out),
        Err(Error::NotFound(why)) => {
            if let NotFound::NothingWanted | NotFound::Closes { .. } = &*why {
                return Err(Problem::usage(why));
            }
            let fault = match &*why {
                NotFound::Stuck { why: Some(fault), .. } => touched(&loaded, fault),
                NotFound::Stuck { event: Some(event), .. } => way_out(event),
                _ => String::new(),
            };
            Err(Problem::Run(format!("{why}{fault}")))
        }
        Err(Error::Run(failure)) => Err(Problem::Run(failure.to_string())),
        Err(Error::NoSlopes(why)) => Err(Problem::Run(format!("{why}{}", touched(&loaded, &why)))),
        Err(error) => Err(Problem::refused(&error)),
    }
}

/// The way out where an event is touched.
fn touched(loaded: &Loaded, why: &NoSlopes) -> String {
    let NoSlopes::Touches { event, .. } = why else { return String::new() };
    if loaded.system.description().events.iter().all(|known| known.name != *event) {
        return String::new();
    }
    way_out(event)
}

/// Without an event that is touched.
fn way_out(event: &str) -> String {
    format!("\nhelp: let `{event}` do nothing (--ignore {event}), and the run end at an unknown `until`; or {HALF}")
}

/// What makes a multiple root of a motion that runs back as it came a simple one.
const HALF: &str =
    "seek half of the motion, as far as the instant at which it reverses itself: there the root is simple";

/// A value with the unit of what it is of.
fn read(reader: &mut Reader, loaded: &Loaded, option: &str, (name, text): (&str, &str)) -> Result<f64, Problem> {
    let description = loaded.system.description();
    let is_parameter = description.parameters.iter().any(|parameter| parameter.name == name);
    let sets = match option {
        "unknown" if name == "until" => Sets::Time,
        "unknown" if is_parameter => Sets::Parameter(parameter_index(loaded, name)?),
        "unknown" => match place_in_state(loaded, name)? {
            Place::Coordinate(index) => Sets::Coordinate(index),
            Place::Speed(index) => Sets::Speed(index),
        },
        _ => like_output(loaded, name)?,
    };
    reader.value(loaded, option, sets, text)
}

/// Refuses a value of a condition that changes with a parameter that is unknown: it would be taken at the guess.
fn stays(
    reader: &mut Reader,
    loaded: &Loaded,
    options: &ArgMatches,
    (name, text, value): (&str, &str, f64),
) -> Result<(), Problem> {
    let sets = like_output(loaded, name)?;
    let of_motion = motion_index(loaded, options)?.map(|place| loaded.system.motions()[place].unknowns.to_vec());
    let given = listed_pairs(options, "unknown")?.into_iter().map(|(name, _)| name);
    let unknowns: Vec<String> = given.chain(of_motion.into_iter().flatten().map(|name| name.to_string())).collect();
    for (k, parameter) in loaded.system.description().parameters.iter().enumerate() {
        if !unknowns.iter().any(|unknown| *unknown == *parameter.name) {
            continue;
        }
        let mut parameters = loaded.system.parameters().to_vec();
        parameters[k] = another(parameters[k]);
        let moved = reader.model(loaded)?.constant(text, sets, &parameters);
        if moved.is_ok_and(|moved| moved != value) {
            let parameter = parameter.name.to_string();
            return Err(Problem::Run(NotFound::MovingGoal { name: name.to_owned(), parameter }.to_string()));
        }
    }
    Ok(())
}

/// With `--maximise`, `--minimise` or `--fit`.
fn wanted(search: Search, options: &ArgMatches) -> Result<Search, Problem> {
    let of = |name: &str| options.get_one::<String>(name);
    let search = match (of("maximise"), of("minimise")) {
        (Some(name), _) => search.maximise(name),
        (None, Some(name)) => search.minimise(name),
        (None, None) => search,
    };
    match of("fit") {
        Some(path) => Ok(search.fit(record(path, of("columns").map(String::as_str))?)),
        None => Ok(search),
    }
}

/// A table with a header; `columns` says which of its columns are time (`t=…`) and what is measured (`x=…`), else they have these names.
fn record(path: &str, columns: Option<&str>) -> Result<Record, Problem> {
    let unread = |why: &dyn std::fmt::Display| Problem::File(format!("cannot read `{path}`: {why}"));
    let text = std::fs::read_to_string(path).map_err(|e| Problem::unread(path, &e))?;
    let mut lines = cells_of(text.strip_prefix('\u{feff}').unwrap_or(&text));
    let (_, header) = lines.next().ok_or_else(|| unread(&"it is empty"))?;
    let named: Vec<(String, String)> = match columns {
        Some(text) => {
            let pairs = parts(text).map(|pair| pair.split_once('=').unwrap_or((pair, pair)));
            pairs.map(|(name, column)| (name.trim().to_owned(), column.trim().to_owned())).collect()
        }
        None => header.iter().map(|name| (name.clone(), name.clone())).collect(),
    };
    let mut places = Vec::with_capacity(named.len());
    for (name, column) in &named {
        let Some(place) = header.iter().position(|known| known == column) else {
            return Err(Problem::usage(format!("`{path}` has no column `{column}`; it has {}", header.join(", "))));
        };
        places.push((name.clone(), place));
    }
    let mut lists: Vec<Vec<f64>> = vec![Vec::new(); places.len()];
    for (line, row) in lines {
        for (list, (name, place)) in lists.iter_mut().zip(&places) {
            let text = row.get(*place).map_or("", String::as_str);
            let value: f64 =
                text.parse().map_err(|_| unread(&format!("`{text}` in line {} of `{name}` is no number", line + 1)))?;
            list.push(value);
        }
    }
    let mut columns: Vec<(String, Vec<f64>)> = places.into_iter().map(|(name, _)| name).zip(lists).collect();
    let Some(time) = columns.iter().position(|(name, _)| name == "t") else {
        return Err(Problem::usage(format!("which column of `{path}` is time? give --columns \"t=…\"")));
    };
    let (_, times) = columns.remove(time);
    Ok(Record { times, columns })
}

fn report(loaded: &Loaded, found: &Found, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    if let Some(path) = options.get_one::<String>("save") {
        let parameters = loaded.system.description().parameters.iter();
        let of = |name: &str| found.values.iter().find(|value| value.name == name);
        let changed = parameters.filter_map(|parameter| Some((parameter.name.to_string(), of(&parameter.name)?.value)));
        outputs::write(path, value_files::start_state(&found.run, &changed.collect::<Vec<_>>()))?;
    }
    if let Some(path) = options.get_one::<String>("plot") {
        outputs::draw(path, found.figure())?;
    }
    if options.get_flag("json") {
        super::json::write(&as_json(loaded, found), out)?;
        return Ok(());
    }
    writeln!(out, "{}: {}, {}", loaded.name, counted(found.steps, "Newton step"), counted(found.runs, "run"))?;
    for (k, value) in found.values.iter().enumerate() {
        let unit = unit(loaded, &value.name);
        match &found.fit {
            Some(fit) => writeln!(
                out,
                "  {} = {}{unit}, standard error {}, 95 % within {}",
                value.name,
                value.written(),
                short_within(fit.standard_errors[k], fit.uncertain[k]),
                short_within(fit.within[k], fit.uncertain[k])
            )?,
            None => writeln!(out, "  {} = {}{unit}", value.name, value.written())?,
        }
    }
    for value in &found.reached {
        let unit = spaced(&found.run.unit(&value.name));
        writeln!(out, "  where {} = {}{unit}", value.name, value.written())?;
    }
    // What nothing moves was known beforehand.
    let t = &found.end_time;
    writeln!(out, "  at t = {}", if t.error == 0.0 { plain(t.value) } else { t.written() })?;
    if let Some(fit) = &found.fit {
        let of = match fit.columns.as_slice() {
            [column] => spaced(&found.run.unit(column)),
            _ => " of each column's range".to_owned(),
        };
        let sigma = short_within(fit.sigma, fit.uncertain.last().copied().unwrap_or(f64::NAN));
        writeln!(out, "residuals      standard deviation {sigma}{of}, {}", freedoms(fit.freedoms))?;
    }
    for direction in &found.free {
        let parts: Vec<String> = direction.iter().map(|(name, part)| format!("{name} by {part:.4}")).collect();
        writeln!(
            out,
            "free           {} of themselves changes nothing that is wanted: the nearest to the guess was taken",
            parts.join(", ")
        )?;
    }
    if found.multiplicity > 1 {
        writeln!(out, "warning: {}", multiple_root(found))?;
    }
    Ok(())
}

/// What a multiple root takes, and the way out.
fn multiple_root(found: &Found) -> String {
    let (kind, part) = match found.multiplicity {
        2 => ("a double root".to_owned(), "half".to_owned()),
        3 => ("a triple root".to_owned(), "a third".to_owned()),
        order => (format!("a root of order {order}"), format!("1/{order}")),
    };
    let free = found.values.iter().any(|value| value.name == "until");
    let advice = if free { HALF.to_owned() } else { format!("let the run end at an unknown `until`, or {HALF}") };
    format!("{kind} in {}: {part} of the digits hold; {advice}", quoted(&found.multiple_in))
}

/// Degrees of freedom in words.
fn freedoms(count: usize) -> String {
    if count == 1 { "1 degree of freedom".to_owned() } else { format!("{count} degrees of freedom") }
}

/// The unit of something unknown, with a space before it.
fn unit(loaded: &Loaded, name: &str) -> String {
    let description = loaded.system.description();
    let of_parameter =
        description.parameters.iter().find(|parameter| parameter.name == name).map(|p| p.unit.to_string());
    let is = |c: &Coordinate, name: &str| c.name == name || c.state() == Some(name);
    let coordinate = |name: &str| description.coordinates.iter().find(|c| is(c, name)).map(|c| c.unit.to_string());
    let unit = match name.strip_suffix('\'') {
        _ if name == "until" => Some("s".to_owned()),
        Some(name) => coordinate(name).map(|unit| format!("{unit}/s")),
        None => of_parameter.or_else(|| coordinate(name)),
    };
    unit.map_or_else(String::new, |unit| spaced(&unit))
}

fn as_json(loaded: &Loaded, found: &Found) -> Json {
    let list = |values: &[Value]| {
        object(values.iter().map(|v| (v.name.clone(), json!({"value": number(v.value), "error": number(v.error)}))))
    };
    let direction = |list: &Vec<(String, f64)>| object(list.iter().map(|(name, part)| (name.clone(), number(*part))));
    let fit = found.fit.as_ref().map_or(Json::Null, |fit| {
        let named = |list: &[f64]| object(found.values.iter().zip(list).map(|(v, x)| (v.name.clone(), number(*x))));
        json!({
            "sigma": number(fit.sigma),
            "degrees_of_freedom": fit.freedoms,
            "standard_errors": named(&fit.standard_errors),
            "uncertain": named(&fit.uncertain),
            "within_95_percent": named(&fit.within),
        })
    });
    object([
        ("model", json!(loaded.name)),
        ("values", list(&found.values)),
        ("reached", list(&found.reached)),
        ("t", number(found.end_time.value)),
        ("t_error", number(found.end_time.error)),
        ("steps", json!(found.steps)),
        ("runs", json!(found.runs)),
        ("free", found.free.iter().map(direction).collect::<Vec<Json>>().into()),
        ("multiplicity", json!(found.multiplicity)),
        ("multiple_in", json!(found.multiple_in)),
        ("fit", fit),
    ])
}
