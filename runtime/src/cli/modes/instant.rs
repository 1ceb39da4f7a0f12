//! `modes --at-time`: small departures from a motion, as they are at one of its instants.

use std::io::Write;

use clap::ArgMatches;
use clap::parser::ValueSource;
use dalembert_symbolic::model::Sets;
use serde_json::json;

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::choose;
use super::super::{Context, Problem, json};
use super::{MOST_PRINTED, state_space};
use crate::linear::{InputOutput, has_dependent_coordinates, short};
use crate::mechanism::At;
use crate::simulate::{Settings, simulate};

/// What wants a rest or a steady motion, or draws it.
const OF_REST: [&str; 20] = [
    "at", "here", "hold", "solve", "phase", "sampled", "steady", "plot", "animate", "mode", "matrices", "motion",
    "drive", "omega", "bode", "response", "range", "vary", "locus", "campbell",
];

/// That eigenvalues of A at one instant say less than they seem to.
const WARNING: &str = "A changes along the motion: its eigenvalues tell how departures grow at this instant, not whether the motion is stable; \
                       `orbit` finds multipliers of motions that repeat";

/// That constraints leave fewer departures than coordinates.
const DEPENDENT: &str = "A and B are of all coordinates: constraints and rotations leave fewer departures than that";

/// Runs the scene until then, and prints A and B.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let given = |option: &&&str| options.value_source(option) == Some(ValueSource::CommandLine);
    if let Some(option) = OF_REST.iter().find(given) {
        return Err(Problem::Usage(format!(
            "error: --{option} is about a rest; with --at-time departures are from a motion, which goes on"
        )));
    }
    let mut loaded = Loaded::find(context, options)?;
    super::super::drawn::check(&loaded, options)?;
    let (scene, mut reader) = choose(&mut loaded, options)?;
    let text = options.get_one::<String>("at-time").map_or("", String::as_str);
    let time = reader.value(&loaded, "at-time", Sets::Time, text)?;
    let settings = Settings::of_scene(&*loaded.system, scene);
    if time < settings.from {
        let words = format!("error: --at-time: the motion begins at t = {} s", short(settings.from));
        return Err(Problem::Usage(words));
    }
    let settings = Settings { until: time, apart: false, every: None, ..settings };
    let run = simulate(&mut *loaded.system, &settings).map_err(|error| Problem::Run(error.to_string()))?;
    let last = run.last();
    if let Some(stop) = run.events.last().filter(|_| last.t < time) {
        return Err(Problem::Run(format!("the motion ends at t = {} s, by `{}`", short(last.t), stop.name)));
    }
    let at = At::new(last.t, &last.q, &last.v);
    loaded.warnings.append(&mut reader.notes);
    let mut written = Vec::new();
    let found = state_space::of_instant(&loaded, options, &mut reader, at, &mut written)?;
    let dependent = has_dependent_coordinates(&*loaded.system);
    let told = loaded.warnings.iter().map(String::as_str).chain([WARNING]).chain(dependent.then_some(DEPENDENT));
    let told: Vec<&str> = told.collect();
    for warning in &told {
        eprintln!("warning: {warning}");
    }
    if options.get_flag("json") {
        let values = found.states.iter().zip(state(&loaded, at)).map(|([name, _], x)| (name.clone(), number(x)));
        let more = [
            ("time".to_owned(), number(last.t)),
            ("state".to_owned(), object(values)),
            ("warnings".to_owned(), json!(told)),
        ];
        return Ok(json::write(&state_space::as_json(&loaded.name, &found, more), out)?);
    }
    table(&loaded, at, &found, out)?;
    Ok(out.write_all(&written)?)
}

/// The state in the order of A's rows.
fn state(loaded: &Loaded, at: At<'_>) -> Vec<f64> {
    let first = loaded.system.description().mechanical();
    at.q[..first].iter().chain(at.v).copied().collect()
}

fn table(loaded: &Loaded, at: At<'_>, found: &InputOutput, out: &mut dyn Write) -> Result<(), Problem> {
    let values = found.states.iter().zip(state(loaded, at)).map(|([name, _], x)| format!("{name} = {}", short(x)));
    writeln!(
        out,
        "{}: at t = {} s of its motion, {}",
        loaded.name,
        short(at.t),
        values.collect::<Vec<_>>().join(", ")
    )?;
    let names = |list: &[[String; 2]]| list.iter().map(|[name, _]| name.as_str()).collect::<Vec<_>>().join(", ");
    writeln!(out, "small departures x' = A x + B u, x = [{}]", names(&found.states))?;
    if found.states.len() <= MOST_PRINTED {
        super::rows("A", &found.a, out)?;
        if !found.inputs.is_empty() {
            super::rows("B", &found.b, out)?;
            writeln!(out, "    u = [{}]", names(&found.inputs))?;
        }
    }
    let eigenvalues = found.a.complex_eigenvalues();
    let mut eigenvalues: Vec<_> = eigenvalues.iter().filter(|value| value.im >= 0.0).collect();
    eigenvalues.sort_by(|one, other| other.re.total_cmp(&one.re));
    let told = |value: &&nalgebra::Complex<f64>| match value.im == 0.0 {
        true => short(value.re),
        false => format!("{} ± {}i", short(value.re), short(value.im)),
    };
    Ok(writeln!(out, "eigenvalues of A, 1/s: {}", eigenvalues.iter().map(told).collect::<Vec<_>>().join(", "))?)
}
