//! `simulate`: runs a scene and reports.

use std::collections::BTreeMap;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use clap::ArgMatches;
use clap::parser::ValueSource;
use dalembert_symbolic::diagnose::did_you_mean_or;
use dalembert_symbolic::print::fnv1a;
use serde_json::{Value, json};

use super::arrows::Over;
use super::json::{number, object};
use super::load::Loaded;
use super::plotted::{self, Shown};
use super::set_up::{set_method, set_up, set_up_scene};
use super::{Context, Problem, compare, contacts, drawn, enforcement, outputs, slopes, symmetries, value_files};
use crate::mechanism::{self, Action, Description, Enforcement, Stabilisation, Target};
use crate::numbers::{short, spaced};
use crate::run::{RunPart, Work};
use crate::show::{Animation, has_units};
use crate::simulate::{LAGRANGE, estimate_global_error};
use crate::{Error, Impulse, Run, Settings, Slopes};

/// Runs, writes files that were asked for, and prints the outcome; a run that failed is written and printed too.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut loaded = with_derivations(Loaded::find(context, options)?, options)?;
    outputs::check(options, &["csv", "plot", "animate", "save"], &loaded.path)?;
    drawn::check(&loaded, options)?;
    let settings = set_up(&mut loaded, options).and_then(|settings| by_options(settings, options))?;
    let pictures = Pictures { shown: Shown::read(&loaded, options)?, over: Over::read(&loaded, options)? };
    loaded.tell_warnings();
    match options.get_one::<String>("by").map(String::as_str) {
        Some("all") => return compare::run(&mut loaded, &settings, options, out),
        Some(name) => choose_derivation(&mut loaded, name)?,
        None => (),
    }
    let others = others(context, options)?;
    let mut progress = Progress::new(&settings);
    let interrupted = context.interruption();
    let outcome = computed(&mut loaded, &settings, options, &mut |stage| {
        match stage {
            Stage::At(t) => progress.tell(t),
            Stage::SecondRun => progress.say("how many digits hold: a second run"),
            Stage::InSecondRun => (),
        }
        if interrupted.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    progress.clear();
    match outcome {
        Ok(mut run) => {
            let slopes = slopes::asked(&mut loaded, &settings, options)?;
            report((&loaded, &settings), (&mut run, None), (&pictures, &others, slopes.as_ref()), options, out)
        }
        Err(Error::Run(mut failure)) => {
            let problem = Problem::Run(failure.to_string());
            // Of what never began there is nothing to report but why.
            if failure.run.work.steps == 0 && failure.run.len() < 2 && !options.get_flag("json") {
                return Err(problem);
            }
            report((&loaded, &settings), (&mut failure.run, Some(&problem)), (&pictures, &others, None), options, out)?;
            Err(problem)
        }
        Err(error) => Err(Problem::refused(&error)),
    }
}

/// How far a simulation is.
pub enum Stage {
    /// The run has reached this time, s.
    At(f64),
    /// The second run begins.
    SecondRun,
    /// It goes on.
    InSecondRun,
}

/// Runs, and where that is wanted a second time to tell how many digits hold.
fn computed(
    loaded: &mut Loaded,
    settings: &Settings,
    options: &ArgMatches,
    watch: &mut dyn FnMut(Stage) -> ControlFlow<()>,
) -> Result<Run, Error> {
    let mut run = crate::simulate_with(&mut *loaded.system, settings, &mut |t| watch(Stage::At(t)))?;
    if wants_digits(&run, options) && watch(Stage::SecondRun).is_continue() {
        estimate_global_error(&mut *loaded.system, settings, &mut run, &mut |_| watch(Stage::InSecondRun));
    }
    Ok(run)
}

/// What a scene's run comes to, for programs: the run, whether it reached its end, and what `--json` prints of it.
pub struct Outcome {
    /// The mechanism as it was run.
    pub loaded: Loaded,
    /// What was computed.
    pub run: Run,
    /// Why it ended early, and when, s.
    pub failed: Option<(String, f64)>,
    /// What `--json` prints.
    pub json: Value,
    /// What is printed without `--json`.
    pub text: String,
}

/// Runs a scene, and writes nothing but its final state where `--save` asks for it.
pub fn outcome(
    context: Context<'_>,
    options: &ArgMatches,
    watch: &mut dyn FnMut(Stage) -> ControlFlow<()>,
) -> Result<Outcome, Problem> {
    let mut loaded = with_derivations(Loaded::find(context, options)?, options)?;
    outputs::check(options, &["save"], &loaded.path)?;
    let settings = set_up(&mut loaded, options).and_then(|settings| by_options(settings, options))?;
    if let Some(name) = options.get_one::<String>("by") {
        choose_derivation(&mut loaded, name)?;
    }
    let (run, failed) = match computed(&mut loaded, &settings, options, watch) {
        Ok(run) => (run, None),
        Err(Error::Run(failure)) => {
            let told = (failure.to_string(), failure.state.t);
            (failure.run, Some(told))
        }
        Err(error) => return Err(Problem::refused(&error)),
    };
    save(&loaded, &run, options)?;
    let mut json = as_json(&loaded, &settings, &run);
    if failed.is_none()
        && let Some(slopes) = slopes::asked(&mut loaded, &settings, options)?
    {
        json["slopes"] = slopes::as_json(&slopes);
    }
    if let Some((told, _)) = &failed {
        json["error"] = Problem::Run(told.clone()).as_json();
    }
    let mut text = Vec::new();
    in_words((&loaded, &settings), (&run, failed.is_some()), options, &mut text)?;
    let text = String::from_utf8_lossy(&text).into_owned();
    Ok(Outcome { loaded, run, failed, json, text })
}

/// With `--method`, `--together` and what is said of constraints.
fn by_options(mut settings: Settings, options: &ArgMatches) -> Result<Settings, Problem> {
    set_method(&mut settings, options)?;
    settings.apart &= !options.get_flag("together");
    enforcement::choose(options, &mut settings)?;
    Ok(settings)
}

/// The runs of `--with`, as far as they came.
fn others(context: Context<'_>, options: &ArgMatches) -> Result<Vec<(String, Run)>, Problem> {
    let scenes = options.get_one::<String>("with").map_or("", String::as_str);
    plotted::filled_parts(scenes)
        .map(|scene| {
            let mut loaded = Loaded::find(context, options)?;
            let settings = set_up_scene(&mut loaded, options, Some(scene))?;
            let settings = by_options(settings, options)?;
            match crate::simulate(&mut *loaded.system, &settings) {
                Ok(run) => Ok((scene.to_owned(), run)),
                Err(Error::Run(failure)) => {
                    eprintln!("warning: {scene}: {failure}");
                    Ok((scene.to_owned(), failure.run))
                }
                Err(error) => Err(Problem::usage(format!("{scene}: {error}"))),
            }
        })
        .collect()
}

/// An event that happens more often than this, and more impulses, are counted: a list as long as this one is read at a glance.
const FEW: usize = 8;
/// Of these so many are told first.
const FIRST: usize = 4;
/// A second run after one that took longer than this, s, would try a person's patience.
const PATIENCE: f64 = 10.0;

/// Whether to run a second time to tell how many digits hold.
fn wants_digits(run: &Run, options: &ArgMatches) -> bool {
    options.get_flag("digits") || run.seconds < PATIENCE && !options.get_flag("no-digits")
}

/// With all systems of balances, where the options name a derivation.
fn with_derivations(mut loaded: Loaded, options: &ArgMatches) -> Result<Loaded, Problem> {
    if options.contains_id("by") {
        loaded.form()?;
    }
    Ok(loaded)
}

/// Puts the system of balances of this name in force.
fn choose_derivation(loaded: &mut Loaded, name: &str) -> Result<(), Problem> {
    let description = loaded.system.description();
    match crate::simulate::derivation(description, name) {
        Ok(system) => {
            loaded.system.set_derivation(system);
            Ok(())
        }
        Err(_) if description.balances.is_empty() => Err(Problem::usage(format!(
            "{} has no `balances`, so that its accelerations come from Lagrange's equations alone",
            loaded.name
        ))),
        Err(_) => {
            let known: Vec<&str> = description.balances.iter().map(|s| s.name.as_ref()).chain(["all"]).collect();
            let hint = did_you_mean_or(name, &known);
            Err(Problem::usage(format!("no system of balances is called `{name}`; {hint}")))
        }
    }
}

/// The time that a long run has reached, on standard error and only on a terminal.
struct Progress {
    from: f64,
    until: f64,
    next: Option<Instant>,
    shown: bool,
}

impl Progress {
    const PAUSE: Duration = Duration::from_millis(500);

    fn new(settings: &Settings) -> Progress {
        let next = std::io::stderr().is_terminal().then(|| Instant::now() + Progress::PAUSE);
        Progress { from: settings.from, until: settings.until, next, shown: false }
    }

    fn tell(&mut self, t: f64) {
        if self.next.is_some_and(|next| Instant::now() >= next) {
            let done = 100.0 * (t - self.from) / (self.until - self.from);
            eprint!("\r{done:5.1} %, t = {t:.4}\x1b[K");
            self.next = Some(Instant::now() + Progress::PAUSE);
            self.shown = true;
        }
    }

    fn say(&mut self, what: &str) {
        if self.shown {
            eprint!("\r{what}\x1b[K");
        }
    }

    fn clear(&self) {
        if self.shown {
            eprint!("\r\x1b[K");
        }
    }
}

/// What pictures of the run show.
struct Pictures {
    /// The charts.
    shown: Shown,
    /// What is drawn over the mechanism.
    over: Over,
}

fn report(
    (loaded, settings): (&Loaded, &Settings),
    (run, failed): (&mut Run, Option<&Problem>),
    (Pictures { shown, over }, others, slopes): (&Pictures, &[(String, Run)], Option<&Slopes>),
    options: &ArgMatches,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let asked = options.get_flag("symmetries");
    let watched = if asked { symmetries::watch(loaded, run)? } else { None };
    let run = &*run;
    let file = |name: &str| options.get_one::<String>(name);
    let unwritten = |error: Error| Problem::File(error.to_string());
    let (table, mut out) = outputs::streams(options, out);
    let out = &mut *out;
    match (table, file("csv")) {
        (Some(table), _) => write!(table, "{}", run.to_csv())?,
        (None, Some(path)) => run.csv(path).map_err(unwritten)?,
        (None, None) => (),
    }
    if let Some(path) = file("plot") {
        let scene = file("scene").map_or("scene", String::as_str);
        let mut runs = vec![(scene.to_owned(), run)];
        runs.extend(others.iter().map(|(name, run)| (name.clone(), run)));
        let figure = shown.figure(&runs).map_err(Problem::usage)?;
        outputs::draw(path, figure)?;
    }
    save(loaded, run, options)?;
    if let Some(path) = file("animate") {
        let charts = shown.of(run).map_err(Problem::usage)?;
        let animation = over.over(run, Animation { charts, ..run.animation() })?;
        let playback = outputs::animate(path, &animation)?;
        if let Some(playback) = playback.filter(|_| !options.get_flag("json")) {
            writeln!(out, "{path}: {playback}")?;
        }
    }
    if options.get_flag("json") {
        let mut object = as_json(loaded, settings, run);
        if options.value_source("every") == Some(ValueSource::CommandLine) {
            object["trajectory"] = trajectory(run);
        }
        if let Some(problem) = failed {
            object["error"] = problem.as_json();
        }
        if asked {
            object["symmetries"] = symmetries::as_json(watched.as_ref());
        }
        if let Some(slopes) = slopes {
            object["slopes"] = slopes::as_json(slopes);
        }
        super::json::write(&object, out)?;
        return Ok(());
    }
    in_words((loaded, settings), (run, failed.is_some()), options, out)?;
    if asked {
        symmetries::write(watched.as_ref(), out)?;
    }
    if let Some(slopes) = slopes {
        slopes::write(slopes, out)?;
    }
    writeln!(out)?;
    Ok(())
}

/// Writes the final state, if that was asked for.
fn save(loaded: &Loaded, run: &Run, options: &ArgMatches) -> Result<(), Problem> {
    let Some(path) = options.get_one::<String>("save") else { return Ok(()) };
    let known = loaded.system.description().parameters.iter().zip(loaded.system.parameters());
    let changed: Vec<(String, f64)> = known
        .filter(|(parameter, value)| parameter.default != *value)
        .map(|(parameter, value)| (parameter.name.to_string(), value))
        .collect();
    outputs::write(path, value_files::state(run, &changed))
}

/// Where the motion ends, what happened on the way, and how far that can be trusted.
fn in_words(
    (loaded, settings): (&Loaded, &Settings),
    (run, failed): (&Run, bool),
    options: &ArgMatches,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let last = run.last();
    let unit = |name: &str| spaced(&run.unit(name));
    writeln!(out, "{} at t = {}, by {}", loaded.name, run.written_end(&last), run.by())?;
    for (name, value) in last.entries() {
        writeln!(out, "  {name} = {}{}", run.written(&name, value), unit(&name))?;
    }
    for (name, value) in last.outputs() {
        match value {
            Some(value) => writeln!(out, "  {name} = {}{}", run.written(name, value), unit(name))?,
            None => writeln!(out, "  {name} is absent")?,
        }
    }
    events(run, out)?;
    impulses_in_words(loaded, run, out)?;
    contacts::write(run, out)?;
    write!(out, "{}", run.trust())?;
    for line in what_sets(run) {
        writeln!(out, "memory         {line}")?;
    }
    if let Some(rows) = run.residuals.filter(|_| {
        settings.enforcement != Enforcement::default() || settings.stabilisation != Stabilisation::default()
    }) {
        let ways = (settings.enforcement.name(), settings.stabilisation.name());
        let way = if ways.0 == "springs" { ways.0.to_owned() } else { format!("{}, drift {}", ways.0, ways.1) };
        writeln!(
            out,
            "constraints    by {way}: missed by {:.1e} at most, their rates by {:.1e}",
            rows.position, rows.velocity
        )?;
    }
    if run.digits.is_none() && !options.get_flag("no-digits") {
        let why = if failed {
            "the run ended early"
        } else if run.has_untried_integrals() {
            "an integral is beyond where its rule was tried"
        } else if run.seconds < PATIENCE {
            "there is too much to compare, the second run would take many more steps, or it was interrupted"
        } else {
            "the run took long; --digits runs a second time all the same"
        };
        writeln!(out, "digits         not estimated: {why}")?;
    }
    Ok(())
}

/// Events, a line each; where one happens often, its first and last times and how often.
fn events(run: &Run, out: &mut dyn Write) -> Result<(), Problem> {
    let mut all: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (index, event) in run.events.iter().enumerate() {
        all.entry(&event.name).or_default().push(index);
    }
    for (index, event) in run.events.iter().enumerate() {
        let name: &str = &event.name;
        let alike = &all[name];
        if alike.len() <= FEW {
            writeln!(out, "  event {name} at t = {}", run.written_event(index))?;
        } else if alike[0] == index {
            let first: Vec<String> = alike.iter().take(FIRST).map(|k| run.written_event(*k)).collect();
            let last = alike.last().map_or_else(String::new, |k| run.written_event(*k));
            writeln!(
                out,
                "  event {name} {} times, at t = {}, …, {last}; --json has all",
                alike.len(),
                first.join(", ")
            )?;
        }
    }
    Ok(())
}

/// Impulses, a line each; of many the first ones, and what all others took of the kinetic energy.
fn impulses_in_words(loaded: &Loaded, run: &Run, out: &mut dyn Write) -> Result<(), Problem> {
    let joule = if has_units(loaded.system.description()) { " J" } else { "" };
    let hit = &run.impulses;
    let shown = if hit.len() <= FEW { hit.len() } else { FIRST };
    for impulse in &hit[..shown] {
        let rows = impulse.constraints.iter().map(|(name, p)| format!("{name} {}", short(*p)));
        let rows: Vec<String> =
            rows.chain(impulse.inputs.iter().map(|name| format!("{name} turns or jumps"))).collect();
        let what = if rows.is_empty() { "what time moves turns".to_owned() } else { rows.join(", ") };
        let (t, energy) = (short(impulse.t), short(impulse.energy));
        writeln!(out, "  impulse at t = {t}: {what}; kinetic energy {energy}{joule}")?;
    }
    if let [first, ..] = &hit[shown..] {
        let energy: f64 = hit[shown..].iter().map(|impulse| impulse.energy).sum();
        let (count, t) = (hit.len() - shown, short(first.t));
        writeln!(
            out,
            "  and {count} more impulses from t = {t} on; kinetic energy {}{joule}; --json has all",
            short(energy)
        )?;
    }
    Ok(())
}

/// What each event sets, and how many ticks it had: `tick sets u and n, at 401 ticks`.
fn what_sets(run: &Run) -> Vec<String> {
    let (description, sampling) = (&run.description, &run.sampling);
    let of_event = |event: &mechanism::Event| {
        let sets = event.actions.iter().filter_map(|action| match action {
            Action::Set(set) => sampling.sets.get(*set as usize),
            _ => None,
        });
        let names = sets.flat_map(|targets| targets.iter()).map(|target| match target {
            Target::Memory(place) => sampling.memory[*place as usize].name.to_string(),
            Target::State(place) => description.coordinate_name(*place as usize),
        });
        let names: Vec<String> = names.collect();
        let ticks = run.ticks().find(|(name, _)| *name == event.name).map(|(_, count)| count);
        let ticks =
            ticks.map_or(String::new(), |count| format!(", at {count} tick{}", if count == 1 { "" } else { "s" }));
        (!names.is_empty()).then(|| format!("{} sets {}{ticks}", event.name, names.join(", ")))
    };
    description.events.iter().filter_map(of_event).collect()
}

fn as_json(loaded: &Loaded, settings: &Settings, run: &Run) -> Value {
    let last = run.last();
    let description = loaded.system.description();
    let named = |values: &[f64]| {
        let all = description.coordinates.iter().zip(values).filter(|(c, _)| c.state().is_none());
        object(all.map(|(c, x)| (c.name.to_string(), number(*x))))
    };
    let states = description.coordinates.iter().zip(&last.v);
    let states = states.filter_map(|(c, x)| Some((c.state()?.to_owned(), number(*x))));
    let of_contacts: Vec<u32> = loaded.system.contacts().all.iter().flat_map(mechanism::Contact::held).collect();
    let memory = run.sampling.memory.iter().zip(&run.memory).zip(0..).filter(|(_, place)| !of_contacts.contains(place));
    let memory = memory.map(|((held, value), _)| (held.name.to_string(), number(*value)));
    let drift = run.drift.iter().map(|d| (d.name.clone(), d.value.map_or(Value::Null, number)));
    let balance = run.energy_balance.map_or(Value::Null, number);
    let residuals = run.residuals.unwrap_or_default();
    let warnings = loaded.warnings.iter().cloned().chain(run.warnings.iter().map(ToString::to_string));
    let told = [
        ("model", json!(loaded.name)),
        ("source", json!(format!("{:016x}", fnv1a(&loaded.source)))),
        ("method", json!(run.by())),
        ("method_chosen", json!(run.why)),
        ("parts", parts(run)),
        ("constraints", json!(settings.enforcement.name())),
        ("constraint_drift", json!(settings.stabilisation.name())),
        ("derivation", json!(run.balances.as_ref().map_or(LAGRANGE, |b| b.system.as_str()))),
        ("condition", run.balances.as_ref().map_or(Value::Null, |b| number(b.worst))),
        ("tolerance", if settings.step.is_some() { Value::Null } else { number(settings.tolerance) }),
        ("t", number(last.t)),
        ("q", named(&last.q)),
        ("v", named(&last.v)),
        ("states", object(states)),
        ("memory", object(memory)),
        ("ticks", object(run.ticks().map(|(event, count)| (event.to_owned(), json!(count))))),
        ("outputs", outputs_at_end(description, run)),
        ("drift", object(drift.chain([("energy_balance".to_owned(), balance)]))),
        ("constraint", object([("position", number(residuals.position)), ("velocity", number(residuals.velocity))])),
        (
            "events",
            run.events
                .iter()
                .map(|e| object([("t", number(e.state.t)), ("name", json!(e.name))]))
                .collect::<Vec<_>>()
                .into(),
        ),
        ("impulses", impulses(description, run)),
        ("contacts", contacts::of_run(run)),
        ("work", work(&run.work)),
        ("digits", digits(run)),
        ("digits_until", run.digits_until().map_or(Value::Null, number)),
        ("errors", errors(run)),
        ("seconds", number(run.seconds)),
        ("warnings", json!(warnings.collect::<Vec<String>>())),
    ];
    object(told.into_iter().chain(contacts::stepped_over(run)))
}

fn work(work: &Work) -> Value {
    json!({
        "steps": work.steps,
        "rejected": work.rejected,
        "evaluations": work.evaluations,
        "jacobians": work.jacobians,
        "factorizations": work.factorizations,
        "retries": work.retries,
        "samples": work.samples,
    })
}

/// All reported times, and the columns there.
fn trajectory(run: &Run) -> Value {
    let names = std::iter::once("t".to_owned()).chain(run.shown_names());
    object(names.filter_map(|name| {
        let values = run.column(&name)?;
        Some((name, values.into_iter().map(number).collect::<Vec<_>>().into()))
    }))
}

/// The parts that were run apart.
fn parts(run: &Run) -> Value {
    let one = |part: &RunPart| {
        object([
            ("coordinates", json!(part.coordinates)),
            ("method", json!(part.method.to_string())),
            ("method_chosen", json!(part.why)),
            ("work", work(&part.work)),
        ])
    };
    run.parts.iter().map(one).collect::<Vec<_>>().into()
}

/// Significant digits that hold at the end, column by column; `null` where they were not estimated.
fn digits(run: &Run) -> Value {
    by_column(run, |name| run.digits(name).map(|digits| json!(digits)))
}

/// Bounds of the errors at the end, SI, column by column; `null` where they were not estimated.
fn errors(run: &Run) -> Value {
    by_column(run, |name| run.errors(name).and_then(|errors| errors.last().map(|error| number(*error))))
}

fn by_column(run: &Run, value: impl Fn(&str) -> Option<Value>) -> Value {
    if run.digits.is_none() {
        return Value::Null;
    }
    object(run.shown_names().into_iter().map(|name| (name.clone(), value(&name).unwrap_or(Value::Null))))
}

/// Jumps of the speeds: when, by what, and of which rates.
fn impulses(description: &Description, run: &Run) -> Value {
    let one = |impulse: &Impulse| {
        let coordinates = description.coordinates.iter().zip(&impulse.jump).filter(|(c, _)| c.state().is_none());
        let jumps = coordinates.map(|(c, jump)| (c.name.to_string(), number(*jump)));
        let rows = impulse.constraints.iter().map(|(name, impulse)| (name.clone(), number(*impulse)));
        object([
            ("t", number(impulse.t)),
            ("inputs", json!(impulse.inputs)),
            ("constraints", object(rows)),
            ("v", object(jumps)),
            ("energy", number(impulse.energy)),
        ])
    };
    run.impulses.iter().map(one).collect::<Vec<_>>().into()
}

/// Outputs at the end: a number for a scalar, an array for a vector.
fn outputs_at_end(description: &Description, run: &Run) -> Value {
    let last = run.last();
    let mut values = last.outputs().map(|(_, value)| value.map_or(Value::Null, number));
    object(description.outputs.iter().map(|output| {
        let components: Vec<Value> = values.by_ref().take(output.components as usize).collect();
        let value = if components.len() == 1 { components[0].clone() } else { Value::Array(components) };
        (output.name.to_string(), value)
    }))
}
