//! `orbit`: finds motions that repeat.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use serde_json::{Value as Json, json};

use super::json::{number, object};
use super::load::{Loaded, listed, listed_pairs};
use super::plotted::parts;
use super::set_up::{Reader, for_search, motion_index, parameter_index};
use super::sweep::points;
use super::{Context, Problem, families, outputs, stability_maps, value_files};
use crate::error::{Error, NearReturn, NoOrbit, StuckInWords};
use crate::find::Value;
use crate::mechanism::{Description, Goal};
use crate::numbers::{counted, spaced};
use crate::orbit::{ExtendedOrbit, ExtendedValue, Family, Multiplier, Orbit, OrbitSearch, StabilityMap};
use crate::run::{Run, written};
use crate::show::{Figure, has_units, unit};

/// What names of directions mean in which there are other such motions.
const FREE: [(&str, &str); 3] = [
    ("time", "the same motion may begin at any of its states"),
    ("scale", "larger and smaller motions close too; `energy` in `motions` asks for one of them"),
    ("family", "other motions close too; `energy` in `motions` asks for one of them"),
];

/// Searches, and prints what was found.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let (loaded, run_described) = for_search(context, options, &["save", "plot"])?;
    let search = OrbitSearch::of(Ok(run_described));
    let search = match motion_index(&loaded, options)? {
        Some(place) => asked(search, &loaded, place)?,
        None => search,
    };
    let search = described(search, &loaded, options)?;
    if let Some(text) = options.get_one::<String>("vary") {
        let family = match varied(search, &loaded, options, text)? {
            Ok(family) => family,
            Err(error) => return Err(failed(&loaded, &error, options, out)?),
        };
        if let Some(path) = options.get_one::<String>("plot") {
            outputs::draw(path, with_units(family.figure(), loaded.system.description()))?;
        }
        families::report(&loaded, &family, options, out)?;
        return unless_broken_off(family.interrupted);
    }
    if let Some(text) = options.get_one::<String>("map") {
        let map = mapped(search, &loaded, text)?;
        if let Some(path) = options.get_one::<String>("plot") {
            outputs::draw(path, with_units(map.figure(), loaded.system.description()))?;
        }
        stability_maps::report(&loaded, &map, options, out)?;
        return unless_broken_off(map.interrupted);
    }
    let search = if options.get_flag("double-double") { search.extended(loaded.to_interpret(options)) } else { search };
    match search.find() {
        Ok(orbit) => report(&loaded, &orbit, options, out),
        Err(error) => Err(failed(&loaded, &error, options, out)?),
    }
}

/// Gives axes of parameters, of the energy and of amplitudes their units.
fn with_units(mut figure: Figure, description: &Description) -> Figure {
    let parameter = |label: &str| description.parameters.iter().find(|parameter| parameter.name == label);
    let of = |label: &str| match label.strip_prefix("amplitude of ") {
        Some(name) => unit(description, name),
        None if label == "energy" && has_units(description) => "J".to_owned(),
        None => parameter(label).map_or(String::new(), |parameter| parameter.unit.to_string()),
    };
    for axis in figure.charts.iter_mut().flat_map(|chart| [&mut chart.x, &mut chart.y]) {
        if axis.unit.is_empty() {
            axis.unit = Some(of(&axis.label)).filter(|unit| unit != "1").unwrap_or_default();
        }
    }
    figure
}

/// What is said of a search that failed: where it ended is saved, and JSON has all that is known there.
fn failed(loaded: &Loaded, error: &Error, options: &ArgMatches, out: &mut dyn Write) -> Result<Problem, Problem> {
    let Error::NoOrbit(why) = error else { return Ok(problem(error)) };
    let (start, residuals, returns) = match &**why {
        NoOrbit::Stuck { start, residuals, returns } => (start, &residuals[..], &returns[..]),
        NoOrbit::Interrupted { start } => (start, &[][..], &[][..]),
        _ => return Ok(problem(error)),
    };
    if let Some(path) = options.get_one::<String>("save") {
        outputs::write(path, value_files::guessed_state(&loaded.name, start))?;
    }
    let listed = |list: &[(String, f64)]| {
        let one = |(name, value): &(String, f64)| {
            format!("{name} = {value:.6e}{}", spaced(&unit(loaded.system.description(), name)))
        };
        list.iter().map(one).collect::<Vec<_>>().join(", ")
    };
    let words = StuckInWords { start: &listed(start), residuals: &listed(residuals), returns }.to_string();
    let problem = if residuals.is_empty() { problem(error) } else { Problem::Run(words) };
    if options.get_flag("json") {
        let numbers = |list: &[(String, f64)]| object(list.iter().map(|(name, value)| (name.clone(), number(*value))));
        let near = |near: &NearReturn| json!({"t": number(near.t), "after": number(near.after), "distance": number(near.distance)});
        let failed = json!({
            "start": numbers(start),
            "residuals": numbers(residuals),
            "near_returns": returns.iter().map(near).collect::<Vec<Json>>(),
        });
        super::json::write(&object([("error", problem.as_json()), ("failed", failed)]), out)?;
    }
    Ok(problem)
}

/// Says that what was printed is not all that was wanted.
pub(super) fn unless_broken_off(interrupted: bool) -> Result<(), Problem> {
    if interrupted { Err(Problem::Run("interrupted".to_owned())) } else { Ok(()) }
}

/// With what a motion of the file says.
pub(super) fn asked(search: OrbitSearch, loaded: &Loaded, place: usize) -> Result<OrbitSearch, Problem> {
    let motion = &loaded.system.motions()[place];
    match &motion.goal {
        Goal::Closes(closes) => Ok(search.asking(place, closes)),
        _ => Err(Problem::usage(format!("{}", NoOrbit::ClosesNot { motion: motion.name.to_string() }))),
    }
}

/// A family, or why there is none; a problem with what was asked.
type Varied = Result<Result<Family, Error>, Problem>;

/// Follows the family that `--vary` names: `NAME=A..B`, `NAME=A,B,C`, of the energy also `energy=..B`.
fn varied(search: OrbitSearch, loaded: &Loaded, options: &ArgMatches, text: &str) -> Varied {
    let usage = || Problem::usage(format!("--vary wants NAME=A..B or NAME=A,B,C, not `{text}`"));
    let (name, range) = text.split_once('=').ok_or_else(usage)?;
    let name = name.trim();
    let mut reader = Reader::default();
    let mut value = |text: &str| {
        let is_parameter = loaded.system.description().parameters.iter().any(|parameter| parameter.name == name);
        let sets = if is_parameter { Sets::Parameter(parameter_index(loaded, name)?) } else { Sets::Energy };
        reader.value(loaded, "vary", sets, text)
    };
    let values: Vec<f64> = match range.split_once("..") {
        Some((first, last)) => {
            // From the motion's own value on.
            let own = || parameter_index(loaded, name).ok().map(|k| loaded.system.parameters()[k]);
            let first = if first.trim().is_empty() { own() } else { Some(value(first)?) };
            first.into_iter().chain([value(last)?]).collect()
        }
        None => range.split(',').map(&mut value).collect::<Result<_, _>>()?,
    };
    let branch = options.get_one::<u64>("branch").map(|number| *number as usize);
    Ok(search.vary(name, &values, branch))
}

/// The stability over the two parameters that `--map` names: `A=FROM..TO:COUNT,B=FROM..TO:COUNT`, or lists.
fn mapped(search: OrbitSearch, loaded: &Loaded, text: &str) -> Result<StabilityMap, Problem> {
    let mut axes: Vec<(&str, String)> = Vec::new();
    for piece in parts(text) {
        match (piece.split_once('='), axes.last_mut()) {
            (Some((name, range)), _) => axes.push((name.trim(), range.to_owned())),
            (None, Some((_, range))) => *range += &format!(",{piece}"),
            (None, None) => axes.clear(),
        }
    }
    let [(x, across), (y, up)] = axes.as_slice() else {
        return Err(Problem::usage(format!(
            "--map wants two parameters, A=FROM..TO:COUNT,B=FROM..TO:COUNT, not `{text}`"
        )));
    };
    let mut reader = Reader::default();
    let mut values = |name: &str, range: &str| {
        let sets = Sets::Parameter(parameter_index(loaded, name)?);
        points::values(loaded, &mut reader, ("map", sets), range)
    };
    let (across, up) = (values(x, across)?, values(y, up)?);
    search.map((x, &across), (y, &up)).map_err(|error| problem(&error))
}

/// What is wrong with a search, or with what it was told.
pub(super) fn problem(error: &Error) -> Problem {
    match error {
        Error::NoOrbit(_) | Error::NoSlopes(_) | Error::Linear(_) => Problem::Run(error.to_string()),
        Error::Run(failure) => Problem::Run(failure.to_string()),
        error => Problem::refused(error),
    }
}

/// With what the options say.
fn described(mut search: OrbitSearch, loaded: &Loaded, options: &ArgMatches) -> Result<OrbitSearch, Problem> {
    let mut reader = Reader::default();
    if let Some(text) = options.get_one::<String>("period") {
        search = search.period(reader.value(loaded, "period", Sets::Time, text)?);
    }
    if let Some(part) = options.get_one::<u64>("part") {
        search = search.part(*part as usize);
    }
    if let Some(event) = options.get_one::<String>("at") {
        search = search.after(event, options.get_one::<u64>("count").map_or(1, |count| *count as usize));
    }
    for (a, b) in listed_pairs(options, "exchange")? {
        search = search.exchanged(&a, &b);
    }
    for name in listed(options, "mirror") {
        search = search.mirrored(&name);
    }
    for name in listed(options, "shift") {
        search = search.shifted(&name);
    }
    for (name, turns) in listed_pairs(options, "turn")? {
        let turns =
            turns.parse().map_err(|_| Problem::usage(format!("--turn {name}={turns} is no number of turns")))?;
        search = search.turned(&name, turns);
    }
    if let Some(text) = options.get_one::<String>("from") {
        let mode = text.strip_prefix("mode").map(str::trim).and_then(|number| number.parse().ok());
        let Some(mode) = mode else {
            return Err(Problem::usage(format!("--from wants `mode` and its number, as `mode 2`, not `{text}`")));
        };
        let amplitude = match options.get_one::<String>("amplitude") {
            None => AMPLITUDE,
            Some(text) => {
                let moved = search.most_moved(mode).map_err(|error| problem(&error))?;
                reader.value(loaded, "amplitude", Sets::Coordinate(moved), text)?
            }
        };
        search = search.from_mode(mode, amplitude);
    }
    if options.get_flag("here") {
        search = search.at_rest();
    }
    if let Some(text) = options.get_one::<String>("energy") {
        search = search.energy(reader.value(loaded, "energy", Sets::Energy, text)?);
    }
    if let Some(legs) = options.get_one::<u64>("segments") {
        search = search.legs(*legs as usize);
    }
    Ok(search)
}

/// By how much the coordinate that moves most moves in a mode from which a search begins, SI: small for lengths in metres and for angles.
const AMPLITUDE: f64 = 1e-3;

fn report(loaded: &Loaded, orbit: &Orbit, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    if let Some(path) = options.get_one::<String>("save") {
        outputs::write(path, value_files::start_state(&orbit.run, &[]))?;
    }
    if let Some(path) = options.get_one::<String>("plot") {
        outputs::draw(path, orbit.figure())?;
    }
    if options.get_flag("json") {
        super::json::write(&as_json(loaded, orbit), out)?;
        return Ok(());
    }
    let (steps, pieces) = (counted(orbit.steps, "Newton step"), counted(orbit.runs, "piece"));
    writeln!(out, "{}: {steps}, {pieces} run", loaded.name)?;
    // A model without units knows neither seconds nor joules.
    let [second, joule] = if has_units(&orbit.run.description) { [" s", " J"] } else { [""; 2] };
    writeln!(out, "  period = {}{second}", orbit.period.written())?;
    for value in &orbit.start {
        let unit = spaced(&orbit.run.unit(&value.name));
        writeln!(out, "  {} = {}{unit}", value.name, value.written())?;
    }
    if let Some(energy) = orbit.energy {
        writeln!(out, "  energy = {}{joule}", crate::numbers::short(energy))?;
    }
    if let Some(extended) = &orbit.extended {
        report_extended(extended, &orbit.run, [second, joule], out)?;
    }
    if orbit.repeats > 1 {
        writeln!(out, "shorter        the motion repeats itself {} times in the period of the guess", orbit.repeats)?;
    }
    writeln!(out, "map            {}", orbit.map_in_words())?;
    let stable = if orbit.is_stable() { "no small change grows" } else { "small changes grow" };
    writeln!(out, "multipliers    {} ({stable})", multipliers(&orbit.multipliers))?;
    if orbit.part > 1 && !orbit.multipliers.is_empty() {
        writeln!(out, "  of the whole period {}", multipliers(&orbit.whole()))?;
    }
    if orbit.superstable > 0 {
        writeln!(out, "  {} of them 0: constraints that come into force take so many freedoms", orbit.superstable)?;
    }
    if !orbit.known.is_empty() {
        writeln!(out, "  known beforehand: {}", orbit.known.join(", "))?;
    }
    if !orbit.free.is_empty() {
        writeln!(out, "free           {}: the nearest to the guess was taken", orbit.free.join(", "))?;
        for (name, meaning) in FREE.iter().filter(|(name, _)| orbit.free.iter().any(|free| free == name)) {
            writeln!(out, "  {name}: {meaning}")?;
        }
    }
    if !orbit.events.is_empty() {
        writeln!(out, "events         {}", orbit.events.join(", "))?;
    }
    writeln!(
        out,
        "run            a plain run of one period misses its start by {} of how far it goes",
        crate::numbers::short(orbit.returns)
    )?;
    Ok(())
}

/// The numbers of a motion in double-double.
fn report_extended(
    ExtendedOrbit { period, start, energy, .. }: &ExtendedOrbit,
    run: &Run,
    [second, joule]: [&str; 2],
    out: &mut dyn Write,
) -> Result<(), Problem> {
    writeln!(out, "in double-double, to the digits of two extrapolations:")?;
    writeln!(out, "  period = {}{second}", period.written())?;
    for value in start {
        writeln!(out, "  {} = {}{}", value.name, value.written(), spaced(&run.unit(&value.name)))?;
    }
    if let Some(energy) = energy {
        writeln!(out, "  energy = {}{joule}", energy.written())?;
    }
    Ok(())
}

/// Multipliers with the digits that hold; those that are too small for a number by their logarithm.
pub(super) fn multipliers(list: &[Multiplier]) -> String {
    if list.is_empty() {
        return "none".to_owned();
    }
    let one = |multiplier: &Multiplier| {
        let size = multiplier.log_abs.exp();
        let error = if multiplier.error.is_nan() { f64::INFINITY } else { multiplier.error * size };
        match () {
            () if multiplier.log_abs == f64::NEG_INFINITY => "0".to_owned(),
            () if multiplier.error >= 1.0 => format!("below {}", crate::numbers::short(size + error)),
            () if size < 1e-12 => format!("e^{}", written(multiplier.log_abs, multiplier.error)),
            () if multiplier.im == 0.0 || multiplier.im.abs() <= multiplier.error * size => {
                written(multiplier.re, error)
            }
            () => {
                let sign = if multiplier.im < 0.0 { "-" } else { "+" };
                format!("{} {sign} {} i", written(multiplier.re, error), written(multiplier.im.abs(), error))
            }
        }
    };
    list.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn as_json(loaded: &Loaded, orbit: &Orbit) -> Json {
    let value = |value: &Value| json!({"value": number(value.value), "error": number(value.error)});
    let extended = |value: &ExtendedValue| {
        json!({
            "digits": value.written(),
            "value": number(value.value),
            "rest": number(value.rest),
            "error": number(value.error),
        })
    };
    let in_double_double = orbit.extended.as_ref().map(|found| {
        json!({
            "period": extended(&found.period),
            "start": object(found.start.iter().map(|number| (number.name.clone(), extended(number)))),
            "energy": found.energy.as_ref().map(extended),
        })
    });
    object([
        ("model", json!(loaded.name)),
        ("period", value(&orbit.period)),
        ("start", object(orbit.start.iter().map(|number| (number.name.clone(), value(number))))),
        ("map", json!({"part": orbit.part, "does": orbit.map})),
        ("multipliers", json_multipliers(&orbit.multipliers)),
        ("whole", json_multipliers(&orbit.whole())),
        ("known", json!(orbit.known)),
        ("superstable", json!(orbit.superstable)),
        ("stable", json!(orbit.is_stable())),
        ("free", json!(orbit.free)),
        ("energy", orbit.energy.map_or(Json::Null, number)),
        ("events", json!(orbit.events)),
        ("double_double", json!(in_double_double)),
        ("returns", number(orbit.returns)),
        ("steps", json!(orbit.steps)),
        ("runs", json!(orbit.runs)),
        ("segments", json!(orbit.legs)),
        ("repeats", json!(orbit.repeats)),
    ])
}

/// Multipliers with their errors.
pub(super) fn json_multipliers(multipliers: &[Multiplier]) -> Json {
    let one = |multiplier: &Multiplier| {
        json!({
            "re": number(multiplier.re),
            "im": number(multiplier.im),
            "log_abs": number(multiplier.log_abs),
            "angle": number(multiplier.angle),
            "error": number(multiplier.error),
        })
    };
    Json::Array(multipliers.iter().map(one).collect())
}
