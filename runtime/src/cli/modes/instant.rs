//! `modes --at-time`: small departures from a motion, as they are at one of its instants.

use std::io::Write;

use clap::ArgMatches;
use clap::parser::ValueSource;
use dalembert_symbolic::model::Sets;
use nalgebra::Complex;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::choose;
use super::super::{Context, Problem, json};
use super::{MOST_PRINTED, state_space};
use crate::linear::{InputOutput, has_dependent_coordinates, short};
use crate::mechanism::At;
use crate::simulate::{Settings, simulate};
use crate::vary::no_share_decides;

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

/// Small departures from a motion at one of its instants.
pub struct Departures {
    /// The model, as the motion left it.
    pub loaded: Loaded,
    /// When, s.
    pub time: f64,
    /// Values of x then.
    pub state: Vec<f64>,
    /// x' = A x + B u, y = C x + D u.
    pub found: InputOutput,
    /// What the numbers alone do not tell.
    pub warnings: Vec<String>,
}

/// Runs the scene until then, and prints A and B.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let departures = departures(context, options)?;
    let Departures { loaded, found, warnings, .. } = &departures;
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
    let mut written = Vec::new();
    state_space::write(&loaded.name, options, || Ok(found.clone()), &mut written)?;
    if state_space::goes_to_output(options)? {
        return Ok(out.write_all(&written)?);
    }
    if options.get_flag("json") {
        let eigenvalues = departures.eigenvalues();
        let pairs = eigenvalues.iter().map(|value| json!([number(value.re), number(value.im)]));
        let more = [
            ("time".to_owned(), number(departures.time)),
            ("state".to_owned(), departures.place()),
            ("eigenvalues".to_owned(), pairs.collect::<Vec<_>>().into()),
            ("warnings".to_owned(), json!(warnings)),
        ];
        return Ok(json::write(&state_space::as_json(&loaded.name, found, more), out)?);
    }
    departures.table(out)?;
    Ok(out.write_all(&written)?)
}

/// Runs the scene until then.
///
/// # Errors
/// Options that are about a rest, and a motion that does not last until then.
pub fn departures(context: Context<'_>, options: &ArgMatches) -> Result<Departures, Problem> {
    let given = |option: &&&str| options.value_source(option) == Some(ValueSource::CommandLine);
    if let Some(option) = OF_REST.iter().find(given) {
        return Err(Problem::usage(format!(
            "--{option} is about a rest; with --at-time departures are from a motion, which goes on"
        )));
    }
    let mut loaded = Loaded::find(context, options)?;
    super::super::drawn::check(&loaded, options)?;
    let (scene, mut reader) = choose(&mut loaded, options)?;
    let text = options.get_one::<String>("at-time").map_or("", String::as_str);
    let time = reader.value(&loaded, "at-time", Sets::Time, text)?;
    let settings = Settings::of_scene(&*loaded.system, scene);
    if time < settings.from {
        let words = format!("--at-time: the motion begins at t = {} s", short(settings.from));
        return Err(Problem::usage(words));
    }
    let settings = Settings { until: time, apart: false, every: None, ..settings };
    let run = simulate(&mut *loaded.system, &settings).map_err(|error| Problem::Run(error.to_string()))?;
    no_share_decides(&run).map_err(|why| Problem::Run(why.to_string()))?;
    let last = run.last();
    if let Some(stop) = run.events.last().filter(|_| last.t < time) {
        return Err(Problem::Run(format!("the motion ends at t = {} s, by `{}`", short(last.t), stop.name)));
    }
    let at = At::new(last.t, &last.q, &last.v);
    loaded.warnings.append(&mut reader.notes);
    let found = state_space::of_instant(&loaded, options, &mut reader, at)?;
    let dependent = has_dependent_coordinates(&*loaded.system);
    let told = loaded.warnings.iter().map(String::as_str).chain([WARNING]).chain(dependent.then_some(DEPENDENT));
    let warnings = told.map(str::to_owned).collect();
    let first = loaded.system.description().mechanical();
    let state = at.q[..first].iter().chain(at.v).copied().collect();
    Ok(Departures { time: last.t, state, found, warnings, loaded })
}

impl Departures {
    /// x by its names.
    pub fn place(&self) -> Value {
        object(self.found.states.iter().zip(&self.state).map(|([name, _], x)| (name.clone(), number(*x))))
    }

    /// Of A, the fastest growth first.
    fn eigenvalues(&self) -> Vec<Complex<f64>> {
        let mut eigenvalues = self.found.a.complex_eigenvalues().as_slice().to_vec();
        eigenvalues.sort_by(|one, other| other.re.total_cmp(&one.re).then(other.im.total_cmp(&one.im)));
        eigenvalues
    }

    fn table(&self, out: &mut dyn Write) -> Result<(), Problem> {
        let found = &self.found;
        let values = found.states.iter().zip(&self.state).map(|([name, _], x)| format!("{name} = {}", short(*x)));
        let values = values.collect::<Vec<_>>().join(", ");
        writeln!(out, "{}: at t = {} s of its motion, {values}", self.loaded.name, short(self.time))?;
        let names = |list: &[[String; 2]]| list.iter().map(|[name, _]| name.as_str()).collect::<Vec<_>>().join(", ");
        writeln!(out, "small departures x' = A x + B u, x = [{}]", names(&found.states))?;
        if found.states.len() <= MOST_PRINTED {
            super::rows("A", &found.a, out)?;
            if !found.inputs.is_empty() {
                super::rows("B", &found.b, out)?;
                writeln!(out, "    u = [{}]", names(&found.inputs))?;
            }
        }
        let told = |value: &Complex<f64>| match value.im == 0.0 {
            true => short(value.re),
            false => format!("{} ± {}i", short(value.re), short(value.im)),
        };
        let eigenvalues = self.eigenvalues();
        let upper: Vec<String> = eigenvalues.iter().filter(|value| value.im >= 0.0).map(told).collect();
        Ok(writeln!(out, "eigenvalues of A, 1/s: {}", upper.join(", "))?)
    }
}
