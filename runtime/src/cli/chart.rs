//! `chart`: speed against accuracy; errors against step sizes.

mod steps;

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;

use clap::ArgMatches;

use super::load::Loaded;
use super::plotted::filled_parts;
use super::set_up::{motion_index, origin, set_up};
use super::{Context, Problem, needs, orbit, outputs};
use crate::mechanism::{Description, Interpreted, Method, System};
use crate::needs::Needs;
use crate::numbers::short;
use crate::orbit::{Orbit, OrbitSearch};
use crate::precision::{Candidate, Convergence, DoubleOnly, Fidelity, Plan, Reference, WorkPrecision};
use crate::simulate::Interruption;
use crate::{Error, Settings};

/// Measures every method that suits, and every way of treating constraints; prints a table and what follows from it, and
/// writes the charts and all points.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let (table, mut out) = outputs::streams(options, out);
    let out = &mut *out;
    let mut loaded = Loaded::find(context, options)?;
    let by_steps = options.get_flag("steps");
    let files = [("plot", "svg"), ("csv", "csv")].map(|(option, ending)| {
        let kind = if by_steps { "steps" } else { "chart" };
        options.get_one::<String>(option).cloned().unwrap_or_else(|| format!("{}-{kind}.{ending}", loaded.name))
    });
    outputs::check_paths(["plot", "csv"].into_iter().zip(files.iter().map(String::as_str)), &loaded.path)?;
    let interruption = Interruption::from(context.interruption());
    let reduced = if by_steps { None } else { reduced(&mut loaded, options, &interruption)? };
    let settings = Settings { interruption: interruption.clone(), ..set_up(&mut loaded, options)? };
    loaded.tell_warnings();
    let mut columns = columns(options);
    if by_steps {
        let max_steps = options.get_one("max-steps").copied().unwrap_or(Convergence::MOST_STEPS);
        let settings = Settings { max_steps, ..settings };
        let candidates = methods(&loaded, &settings, options, Candidate::fixed_steps)?;
        let plan = Plan { columns, ..Plan::default() };
        let model = loaded.to_interpret(options);
        let found = said(&interruption, |progress| {
            Convergence::measure_extended(&candidates, &plan, model.as_ref().map_err(|why| *why), progress)
        })?;
        let outcome = unless_broken_off(&interruption);
        if outcome.is_ok() && found.curves.iter().all(|curve| curve.points.is_empty()) {
            return Err(Problem::usage(format!(
                "--max-steps {max_steps} leaves no method a run: even their longest steps are more of them"
            )));
        }
        return steps::report(&found, &files, (options.get_flag("json"), outcome), (table, out));
    }
    let twin = options
        .get_one::<String>("twin")
        .map(|name| twin(context, name, (&loaded, options), &mut columns))
        .transpose()?;
    let methods = methods(&loaded, &settings, options, Candidate::methods)?;
    let by_dop853 = Settings { method: Method::Dop853, ..settings.clone() };
    let mut ways = Candidate::formulations(&*loaded.system, &by_dop853);
    if let Some((name, system, settings)) = twin {
        if ways.is_empty() {
            ways.push(Candidate::new(loaded.name.as_str(), &*loaded.system, by_dop853));
        }
        let until = ways[0].settings.until;
        let settings = Settings { method: Method::Dop853, until, interruption: interruption.clone(), ..settings };
        if let Some(warning) = starts_elsewhere(&ways[0], (&name, &*system, &settings), &columns) {
            eprintln!("warning: {warning}");
        }
        ways.push(Candidate::new(name, &*system, settings));
    }
    let plan = Plan { columns, ..Plan::default() };
    let model = loaded.to_interpret(options);
    let goes_round = match options.get_one::<u64>("returns") {
        Some(0) => return Err(Problem::usage("--returns wants a number of periods, 1 or more, not `0`")),
        Some(count) => Some((found_orbit(&loaded, options, &settings)?, *count as usize)),
        None => None,
    };
    let measure = |candidates: &[Candidate]| match &goes_round {
        Some((orbit, count)) => {
            said(&interruption, |progress| WorkPrecision::of_returns(orbit, *count, candidates, &plan, progress))
        }
        None => measure(candidates, &plan, &model, &interruption),
    };
    let mut measured = vec![measure(&methods)?];
    if !ways.is_empty() && !interruption.is_asked() {
        let mut found = measure(&ways)?;
        found.title = format!("{}: formulations, by dop853", found.title);
        measured.push(found);
    }
    for found in &measured {
        report(found, out)?;
    }
    if let Some(found) = &reduced {
        let sentence = found.as_ref().map_or_else(|why| format!("not known: {why}\n"), Needs::sentence);
        writeln!(out, "what the scene can do without:\n{sentence}")?;
    }
    let fidelity = reduced.and_then(Result::ok).map(|found| found.fidelity());
    write_files(&measured, fidelity.as_ref(), &files, (table, out))?;
    unless_broken_off(&interruption)
}

/// Says that what was written is not all that was wanted.
fn unless_broken_off(interruption: &Interruption) -> Result<(), Problem> {
    if interruption.is_asked() { Err(Problem::Run("interrupted".to_owned())) } else { Ok(()) }
}

/// What the scene can do without, or why that is not known; `None` where neither the options nor the file say what it is run for.
fn reduced(
    loaded: &mut Loaded,
    options: &ArgMatches,
    interruption: &Interruption,
) -> Result<Option<Result<Needs, String>>, Problem> {
    let asked = ["needs", "within"].iter().any(|option| options.contains_id(option));
    if !asked && !needs::is_said(loaded, options) {
        return Ok(None);
    }
    let found = match options.contains_id("input") {
        true => Err(Problem::usage(
            "what can be left out is found with the inputs of the file; write the input there, or leave --input out",
        )),
        false => needs::request(loaded, options)
            .and_then(|request| needs::find(&request, interruption).map_err(|error| needs::problem(error, loaded))),
    };
    match found {
        Ok(found) => Ok(Some(Ok(found))),
        Err(Problem::Run(why)) => Ok(Some(Err(why))),
        Err(problem) if asked => Err(problem),
        Err(problem) => Ok(Some(Err(problem.to_string().trim_start_matches("error: ").to_owned()))),
    }
}

/// Writes a table to its file, or to standard output.
fn put_table(path: &str, table: &str, output: Option<&mut dyn Write>) -> Result<(), Problem> {
    match output {
        Some(output) => Ok(output.write_all(table.as_bytes())?),
        None => outputs::write(path, table),
    }
}

/// Coordinates and outputs to compare.
fn columns(options: &ArgMatches) -> Vec<String> {
    let given = options.get_many::<String>("compare").into_iter().flatten();
    given.flat_map(|list| filled_parts(list)).map(ToOwned::to_owned).collect()
}

/// The methods of `--methods`, or those of a default.
fn methods(
    loaded: &Loaded,
    settings: &Settings,
    options: &ArgMatches,
    default: impl Fn(&dyn System, &Settings) -> Vec<Candidate>,
) -> Result<Vec<Candidate>, Problem> {
    let Some(list) = options.get_one::<String>("methods") else {
        return Ok(default(&*loaded.system, settings));
    };
    let read = |name: &str| -> Result<Candidate, Problem> {
        let method: Method = name.trim().parse().map_err(Problem::usage)?;
        Ok(Candidate::new(method.name(), &*loaded.system, Settings { method, ..settings.clone() }))
    };
    list.split(',').map(read).collect()
}

/// Another file of the same mechanism, and what both can be compared by.
fn twin(
    context: Context<'_>,
    name: &str,
    (loaded, options): (&Loaded, &ArgMatches),
    columns: &mut Vec<String>,
) -> Result<(String, Box<dyn System>, Settings), Problem> {
    let mut other = Loaded::named(context, name, Vec::new())?;
    let wanted = options.get_one::<String>("scene").map_or("scene", String::as_str);
    let known = &other.system.description().scenes;
    let place = known.iter().position(|known| known == wanted).unwrap_or(0);
    let scene = other.system.scene(place);
    for (index, value) in other.system.scene_parameters(place) {
        other.system.set_parameter(index, value);
    }
    if columns.is_empty() {
        let names = components(loaded.system.description());
        *columns = components(other.system.description()).into_iter().filter(|name| names.contains(name)).collect();
    }
    if columns.is_empty() {
        return Err(Problem::usage(format!(
            "{} and {name} have no output of one name, by which they could be compared",
            loaded.name
        )));
    }
    Ok((format!("{name} (minimal)"), other.system, Settings::new(&scene)))
}

/// Starts that differ by more than this part of the largest value are not the same but for rounding of what closes them.
const ELSEWHERE: f64 = 1e-8;

/// That the twin starts elsewhere, if it does: its errors are then those of its start.
fn starts_elsewhere(
    first: &Candidate,
    (name, system, settings): (&str, &dyn System, &Settings),
    columns: &[String],
) -> Option<String> {
    let start = |system: &dyn System, settings: &Settings| -> Option<Vec<f64>> {
        let settings = Settings { until: settings.from, ..settings.clone() };
        let run =
            crate::simulate_with(&mut *system.boxed_clone(), &settings, &mut |_| ControlFlow::Continue(())).ok()?;
        columns.iter().map(|column| run.column(column)?.first().copied()).collect()
    };
    let (here, there) = (start(&*first.system, &first.settings)?, start(system, settings)?);
    let largest = here.iter().chain(&there).fold(0.0, |most: f64, x| most.max(x.abs()));
    let apart = |k: &usize| (here[*k] - there[*k]).abs();
    let worst = (0..columns.len()).max_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    (apart(&worst) > ELSEWHERE * largest).then(|| {
        let (column, [here, there]) = (&columns[worst], [here, there].map(|values| short(values[worst])));
        format!(
            "{name} starts elsewhere: {column} is {there} there and {here} here, and its errors are those of its start"
        )
    })
}

/// Outputs, component by component, as runs name them.
fn components(description: &Description) -> Vec<String> {
    let of = |output: &crate::mechanism::Quantity| match output.axes() {
        [] => vec![output.name.to_string()],
        axes => axes.iter().map(|axis| format!("{}.{axis}", output.name)).collect(),
    };
    description.outputs.iter().flat_map(of).collect()
}

fn measure(
    candidates: &[Candidate],
    plan: &Plan,
    model: &Result<Interpreted, DoubleOnly>,
    interruption: &Interruption,
) -> Result<WorkPrecision, Problem> {
    let extended = |first: &Candidate| {
        Ok(Reference::find(first, &plan.columns)?.extended(first, model.as_ref().map_err(|why| *why)))
    };
    said(interruption, |progress| WorkPrecision::against(candidates, plan, extended, progress))
}

/// The motion that repeats, whose returns are charted.
fn found_orbit(loaded: &Loaded, options: &ArgMatches, settings: &Settings) -> Result<Orbit, Problem> {
    let described = (loaded.system.boxed_clone(), settings.clone(), origin(loaded, options)?);
    let search = OrbitSearch::of(Ok(described));
    let search = match motion_index(loaded, options)? {
        Some(place) => orbit::asked(search, loaded, place)?,
        None => search,
    };
    search.find().map_err(|error| orbit::problem(&error))
}

/// Measures while a terminal says whose turn it is.
fn said<T>(
    interruption: &Interruption,
    measure: impl FnOnce(&mut dyn FnMut(&str) -> ControlFlow<()>) -> Result<T, Error>,
) -> Result<T, Problem> {
    let shown = std::io::stderr().is_terminal();
    let found = measure(&mut |name| {
        if shown {
            eprint!("\r{name}\x1b[K");
        }
        if interruption.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    if shown {
        eprint!("\r\x1b[K");
    }
    found.map_err(|error| match error {
        Error::NoReference { .. } | Error::Run(_) => Problem::Run(error.to_string()),
        _ => Problem::refused(&error),
    })
}

fn report(found: &WorkPrecision, out: &mut dyn Write) -> Result<(), Problem> {
    let reference = &found.reference;
    let times = reference.times();
    writeln!(out, "{} until t = {}", found.title, times[times.len() - 1])?;
    writeln!(out, "errors of {}, the largest, in parts of their ranges", reference.columns.join(", "))?;
    writeln!(out, "{}", reference.sentence())?;
    if reference.is_cut {
        writeln!(out, "the scene goes on, but beyond that time they agree on fewer than eight digits")?;
    }
    writeln!(out, "\nwork in evaluations, then time, to reach 1e-3, 1e-6 and 1e-9:\n{}", found.table())?;
    left_out(&found.refused, out)?;
    writeln!(out, "{}\n", found.sentence())?;
    Ok(())
}

/// Who does not suit the scene; those with one reason in a line.
fn left_out(mut refused: &[(String, String)], out: &mut dyn Write) -> Result<(), Problem> {
    while let Some((_, why)) = refused.first() {
        let alike = refused.iter().take_while(|(_, other)| other == why).count();
        let names: Vec<&str> = refused[..alike].iter().map(|(name, _)| name.as_str()).collect();
        writeln!(out, "left out {}: {why}", names.join(", "))?;
        refused = &refused[alike..];
    }
    Ok(())
}

/// Writes the charts and the points.
fn write_files(
    measured: &[WorkPrecision],
    fidelity: Option<&Fidelity>,
    [plot, csv]: &[String; 2],
    (output, out): (Option<&mut dyn Write>, &mut dyn Write),
) -> Result<(), Problem> {
    let mut charts = measured.iter().flat_map(|found| found.figure().charts).collect::<Vec<_>>();
    charts.extend(fidelity.map(Fidelity::chart));
    let mut table = String::new();
    for text in measured.iter().map(WorkPrecision::to_csv).chain(fidelity.map(Fidelity::to_csv)) {
        let rows = if table.is_empty() { text.as_str() } else { text.split_once('\n').map_or("", |(_, rows)| rows) };
        table += rows;
    }
    outputs::draw(plot, charts)?;
    put_table(csv, &table, output)?;
    [plot, csv].into_iter().filter(|path| *path != "-").try_for_each(|path| writeln!(out, "written: {path}"))?;
    Ok(())
}
