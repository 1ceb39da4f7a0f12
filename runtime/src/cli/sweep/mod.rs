//! `sweep`: many runs of one mechanism, and a table of what came of them.

mod experiment;
mod judged;
mod kept;
pub(super) mod points;
mod table;

use std::collections::HashSet;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use clap::ArgMatches;

use experiment::Experiment;
use judged::Judged;
use kept::Kept;
use points::{Points, Varied};
use serde_json::{Value, json};
use table::{Row, Table, results};

use super::json::{number, object, write_outcome};
use super::load::Loaded;
use super::modes::at_rest;
use super::plotted::parts;
use super::set_up::{Changes, choose, unknown};
use super::{Context, Problem, outputs};
use crate::ensemble::spread;
use crate::mechanism::{Description, HIDDEN, Method, System};
use crate::numbers::{short, spaced};
use crate::run::Names;
use crate::show::{Axis, Chart, Figure, Series, unit};
use crate::stopwatch::Stopwatch;
use crate::{Error, Settings};

/// A run with the one or two that it is compared with.
const RUNS_AGAIN: f64 = 3.0;
/// Runs again that take longer than this, s, would try a person's patience.
const PATIENCE: f64 = 10.0;
/// No more rows are printed.
const MOST_ROWS: usize = 40;
/// Nor more columns, unless they were asked for.
const MOST_COLUMNS: usize = 6;
/// Progress is told about so many times.
const TOLD: usize = 500;
/// Nor more modes asked for.
const MOST_MODES: usize = 100;
/// What is drawn over the first of what varies has a line for each combination of the others, up to so many: more cannot be told apart
/// nor named beside the chart.
const MOST_LINES: usize = 12;
/// What the file beside the table is called where it cannot be written.
const BESIDE: &str = "csv (what the table is of)";

/// Runs all, or merges the tables of parts; prints a table, and writes it whole.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut loaded = Loaded::find(context, options)?;
    let path = options.get_one::<String>("csv").cloned().unwrap_or_else(|| format!("{}-sweep.csv", loaded.name));
    check_files(options, &path, &loaded)?;
    let columns = names(loaded.system.description());
    let log = log_axes(options)?;
    let merged = options.get_many::<String>("merge");
    let merged = merged.map(|parts| Table::merge(&parts.map(String::as_str).collect::<Vec<_>>())).transpose()?;
    let modes = match &merged {
        Some((table, _)) => table.names.iter().filter(|name| name.starts_with("frequency ")).count(),
        None => wanted_modes(options)?,
    };
    let results = results(&columns, loaded.system.description(), modes);
    let shown = shown(options, &results, &columns)?;
    let (table, all, judged) = match merged {
        Some((table, experiment)) => {
            (put_together(&loaded, (table, experiment), &results, &path)?, None, Judged::default())
        }
        None => {
            let (table, all, judged) = compute(context, &mut loaded, options, (&columns, modes, &shown), &path)?;
            (table, Some(all), judged)
        }
    };
    let varied = table.names.len().saturating_sub(results.len() + 2);
    if let Some(path) = options.get_one::<String>("plot") {
        outputs::draw(path, draw(&loaded, &table, varied, &shown, log))?;
    }
    let arrays = options.get_one::<String>("npz");
    if let Some(path) = arrays {
        write_arrays(path, &table)?;
    }
    let (output, mut out) = outputs::streams(options, out);
    if let Some(output) = output {
        write!(output, "{}", table.to_csv())?;
    }
    let outcome = match all.filter(|all| table.rows.len() < *all) {
        Some(all) => {
            let way_out = if experiment::is_kept(&path) { "; the same command with --resume continues" } else { "" };
            let done = table.rows.len();
            Err(Problem::Run(format!("interrupted: {done} of {all} runs are in the table{way_out}")))
        }
        None => failures(&table),
    };
    if options.get_flag("json") {
        return write_outcome(as_json(&loaded.name, loaded.system.description(), &table, &path), outcome, &mut *out);
    }
    print(&table, (varied, &shown), (loaded.system.description(), &judged), &mut *out)?;
    for path in [Some(&path).filter(|path| *path != "-"), arrays].into_iter().flatten() {
        writeln!(out, "written: {path}")?;
    }
    outcome
}

/// Writes the table as NumPy's arrays.
fn write_arrays(path: &str, table: &Table) -> Result<(), Problem> {
    let bytes = table.to_npz().ok_or_else(|| outputs::too_large(path))?;
    outputs::write(path, bytes)
}

/// All rows of the table, those that failed with why.
fn as_json(name: &str, description: &Description, table: &Table, path: &str) -> Value {
    let row = |row: &Row| -> Value {
        let cells = row.cells.iter().map(|cell| cell.map_or(Value::Null, number));
        let run = std::iter::once(json!(row.run));
        let error = std::iter::once(if row.error.is_empty() { Value::Null } else { json!(row.error) });
        run.chain(cells).chain(error).collect::<Vec<_>>().into()
    };
    let rows: Vec<Value> = table.rows.iter().map(row).collect();
    let units: Vec<Value> = table.names.iter().map(|name| json!(unit_of(description, name))).collect();
    object([
        ("model", json!(name)),
        ("columns", json!(table.names)),
        ("units", units.into()),
        ("rows", rows.into()),
        ("csv", json!(path)),
    ])
}

/// Refuses files that cannot be written, or that the table is made from.
fn check_files(options: &ArgMatches, path: &str, loaded: &Loaded) -> Result<(), Problem> {
    let beside = experiment::path(path);
    let beside = Some(beside.as_str()).filter(|_| experiment::is_kept(path));
    let named = |option| (option, options.get_one(option).map(String::as_str));
    let files = [("csv", Some(path)), (BESIDE, beside), named("npz"), named("plot")];
    outputs::check_paths(files.into_iter().filter_map(|(option, path)| Some((option, path?))), &loaded.path)?;
    let read = options.get_many::<String>("merge").into_iter().flatten().chain(options.get_one::<String>("points"));
    outputs::keep(path, read.map(String::as_str))
}

/// Writes the table of all parts of a sweep, if they are of this model.
fn put_together(
    loaded: &Loaded,
    (table, experiment): (Table, Experiment),
    results: &[String],
    path: &str,
) -> Result<Table, Problem> {
    experiment.refuse_other_model(loaded)?;
    let varied = table.names.len().saturating_sub(results.len() + 2);
    if varied == 0 || table.names[1 + varied..].iter().ne(results.iter().chain(&["error".to_owned()])) {
        return Err(Problem::usage(format!("these tables are not of {}: their columns differ", loaded.name)));
    }
    kept::replace(path, &table, &experiment)?;
    Ok(table)
}

/// What failed of the runs of a table.
fn failures(table: &Table) -> Result<(), Problem> {
    match table.rows.iter().filter(|row| !row.error.is_empty()).collect::<Vec<_>>().as_slice() {
        [] => Ok(()),
        [first, ..] if table.rows.len() == 1 => Err(Problem::Run(first.error.clone())),
        all @ [first, ..] => {
            let (failed, count) = (all.len(), table.rows.len());
            Err(Problem::Run(format!("{failed} of {count} runs failed; the first, run {}: {}", first.run, first.error)))
        }
    }
}

/// Coordinates, rates and outputs, component by component, as runs name them.
fn names(description: &Description) -> Vec<String> {
    Names::of(description).columns().into_iter().filter(|name| !name.starts_with(HIDDEN)).collect()
}

/// `--log x,y`: whether the axes are logarithmic.
fn log_axes(options: &ArgMatches) -> Result<[bool; 2], Problem> {
    let Some(text) = options.get_one::<String>("log") else {
        let first = options.get_many::<String>("vary").and_then(|mut all| all.next().cloned());
        return Ok([first.is_some_and(|text| text.trim_end().ends_with(":log")), false]);
    };
    match text.split(',').map(str::trim).collect::<Vec<_>>().as_slice() {
        ["x"] => Ok([true, false]),
        ["y"] => Ok([false, true]),
        ["x", "y"] | ["y", "x"] => Ok([true, true]),
        _ => Err(Problem::usage(format!("--log wants x, y or x,y, not `{text}`"))),
    }
}

/// `--modes COUNT`: of how many modes frequencies are wanted.
fn wanted_modes(options: &ArgMatches) -> Result<usize, Problem> {
    let Some(text) = options.get_one::<String>("modes") else { return Ok(0) };
    match text.trim().parse() {
        Ok(count @ 1..=MOST_MODES) => Ok(count),
        _ => Err(Problem::usage(format!("--modes wants a number from 1 to {MOST_MODES}, not `{text}`"))),
    }
}

/// Runs what the table at this path does not have yet; the table, and how many rows it has when all are run.
fn compute(
    context: Context<'_>,
    loaded: &mut Loaded,
    options: &ArgMatches,
    (columns, modes, shown): (&[String], usize, &[String]),
    path: &str,
) -> Result<(Table, usize, Judged), Problem> {
    let (scene, mut reader) = choose(loaded, options)?;
    let changes = Changes::read(loaded, &mut reader, options)?;
    let points = Points::read(loaded, &mut reader, options)?;
    let method = options.get_one::<String>("method").map(|text| text.parse::<Method>());
    let method = method.transpose().map_err(Problem::usage)?;
    let threads = threads(options)?;
    let (shard, shards) = shard(options)?;
    let experiment = Experiment::of(loaded, &mut reader, options, scene, &points)?;
    loaded.warnings.append(&mut reader.notes);
    loaded.tell_warnings();
    let description = loaded.system.description();
    let varied = points.varied.iter().map(Varied::column);
    let names = std::iter::once("run".to_owned()).chain(varied).chain(results(columns, description, modes));
    let names: Vec<String> = names.chain(["error".to_owned()]).collect();
    let sweep = Sweep { context, system: &*loaded.system, scene, changes, points, method, columns, modes };
    sweep.refuse_settings(options)?;
    let kept = Kept::begin(path, &names, &experiment, options.get_flag("resume"))?;
    sweep.refuse_other_values(path, &kept.done)?;
    let there: HashSet<usize> = kept.done.iter().map(|row| row.run).collect();
    let all: Vec<usize> = (shard..sweep.points.len()).step_by(shards).collect();
    let left: Vec<usize> = all.iter().copied().filter(|run| !there.contains(run)).collect();
    let watch = Stopwatch::start();
    let rows = sweep.rows(&left, threads, &kept)?;
    let a_row = watch.seconds() / left.len() as f64;
    let mut table = Table { names, rows: kept.done.into_iter().chain(rows).collect() };
    table.sort()?;
    kept::replace(path, &table, &experiment)?;
    // A row that is printed is run again, with the runs that it is compared with.
    let again = RUNS_AGAIN * table.rows.len().min(MOST_ROWS) as f64 * a_row;
    let is_quick = again < PATIENCE;
    let is_wanted = !["no-digits", "json", "quiet"].into_iter().any(|flag| options.get_flag(flag));
    let judged = if is_quick && is_wanted { sweep.judged(&table, shown, threads) } else { Judged::default() };
    Ok((table, all.len(), judged))
}

/// What all runs have in common.
struct Sweep<'a> {
    context: Context<'a>,
    system: &'a dyn System,
    scene: usize,
    changes: Changes,
    points: Points,
    method: Option<Method>,
    columns: &'a [String],
    /// Of how many modes frequencies are wanted.
    modes: usize,
}

impl Sweep<'_> {
    /// Refuses what no run can have, before anything is written: a spacing of 0, an end before the start.
    fn refuse_settings(&self, options: &ArgMatches) -> Result<(), Problem> {
        let settings = self.settings(&mut *self.system.boxed_clone(), &self.points.at(0));
        match settings.check(self.system.description()) {
            Err(Error::BadSetting { setting, value, expected })
                if options.try_contains_id(setting).unwrap_or(false) =>
            {
                Err(Problem::usage(format!("--{setting} is {value}; expected {expected}")))
            }
            _ => Ok(()),
        }
    }

    /// Refuses rows of a table whose values are not those that their runs have here.
    fn refuse_other_values(&self, path: &str, rows: &[Row]) -> Result<(), Problem> {
        for row in rows {
            let wanted = if row.run < self.points.len() { self.points.at(row.run) } else { Vec::new() };
            let own = row.cells.iter().take(wanted.len()).copied();
            if wanted.is_empty() || own.ne(wanted.iter().copied().map(Some)) {
                return Err(Problem::usage(format!("{path}: run {} has other values than in this sweep", row.run)));
            }
        }
        Ok(())
    }

    /// What a run with these values starts from; what varies is set.
    fn settings(&self, system: &mut dyn System, values: &[f64]) -> Settings {
        let varied = || self.points.varied.iter().zip(values);
        varied().for_each(|(varied, value)| varied.set(system, *value));
        let mut settings = self.changes.of(Settings::of_scene(system, self.scene));
        varied().for_each(|(varied, value)| varied.start(&mut settings, *value));
        settings.method = self.method.unwrap_or(settings.method);
        // Extremes are those of dense output.
        settings.dense = true;
        settings
    }

    /// The rows of these runs, which are kept as they finish; fewer where they were interrupted.
    fn rows(&self, runs: &[usize], threads: Option<usize>, kept: &Kept<'_>) -> Result<Vec<Row>, Problem> {
        let interrupted = self.context.interruption();
        let unwritten = OnceLock::new();
        let stopped = || interrupted.load(Ordering::Relaxed) || unwritten.get().is_some();
        let (done, shown) = (AtomicUsize::new(0), std::io::stderr().is_terminal());
        let first_note = OnceLock::new();
        let rows = spread(runs.len(), threads, |place| {
            let row = self.row(runs[place], &stopped, &first_note)?;
            if let Err(problem) = kept.add(&row) {
                _ = unwritten.set(problem);
                return None;
            }
            let done = 1 + done.fetch_add(1, Ordering::Relaxed);
            if shown && (done == runs.len() || done.is_multiple_of(runs.len().div_ceil(TOLD))) {
                eprint!("\r{done} of {} runs\x1b[K", runs.len());
            }
            Some(row)
        });
        if shown {
            eprint!("\r\x1b[K");
        }
        if let Some(note) = first_note.get() {
            eprintln!("warning: modes: {note}");
        }
        unwritten.into_inner().map_or_else(|| Ok(rows.into_iter().flatten().collect()), Err)
    }

    /// How many digits hold of the rows that are printed.
    fn judged(&self, table: &Table, shown: &[String], threads: Option<usize>) -> Judged {
        let rows: Vec<&Row> = table.rows.iter().take(MOST_ROWS).filter(|row| row.error.is_empty()).collect();
        let interrupted = self.context.interruption();
        let runs = spread(rows.len(), threads, |place| {
            let mut system = self.system.boxed_clone();
            let settings = Settings { digits: true, ..self.settings(&mut *system, &self.points.at(rows[place].run)) };
            let goes_on = |_| {
                if interrupted.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
            };
            crate::simulate_with(&mut *system, &settings, &mut { goes_on }).ok()
        });
        let mut judged = Judged::default();
        judged.asked = true;
        for (row, run) in rows.iter().zip(runs) {
            if let Some(run) = run {
                judged.note(&run, row, table, shown);
            }
        }
        judged
    }

    /// One run; `None` where it was interrupted.
    fn row(&self, run: usize, stopped: &impl Fn() -> bool, first_note: &OnceLock<String>) -> Option<Row> {
        if stopped() {
            return None;
        }
        let values = self.points.at(run);
        let mut system = self.system.boxed_clone();
        let settings = self.settings(&mut *system, &values);
        let found = (self.modes > 0).then(|| at_rest(&*system, self.scene)).map(|found| {
            let (modes, untried) = found?;
            untried.into_iter().next().inspect(|note| _ = first_note.set(note.clone()));
            Ok(modes)
        });
        let outcome = crate::simulate_with(&mut *system, &settings, &mut |_| match stopped() {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        });
        if stopped() {
            return None;
        }
        let row = Row::of(run, values, outcome, self.columns, self.system.description());
        Some(match found {
            None => row,
            Some(found) => row.with_modes(found, self.modes),
        })
    }
}

/// `--threads COUNT`.
fn threads(options: &ArgMatches) -> Result<Option<usize>, Problem> {
    let Some(text) = options.get_one::<String>("threads") else { return Ok(None) };
    match text.trim().parse::<usize>() {
        Ok(threads @ 1..=4096) => Ok(Some(threads)),
        _ => Err(Problem::usage(format!("--threads wants a number from 1 to 4096, not `{text}`"))),
    }
}

/// `--shard I/N`: the first run of this part, and how many parts there are.
fn shard(options: &ArgMatches) -> Result<(usize, usize), Problem> {
    let Some(text) = options.get_one::<String>("shard") else { return Ok((0, 1)) };
    let parts = text.split_once('/').and_then(|(part, of)| Some((part.trim().parse().ok()?, of.trim().parse().ok()?)));
    match parts {
        Some((part, of)) if (1..=of).contains(&part) => Ok((part - 1, of)),
        _ => Err(Problem::usage(format!("--shard wants I/N, the part I of N, not `{text}`"))),
    }
}

/// Which results are printed and drawn.
fn shown(options: &ArgMatches, results: &[String], columns: &[String]) -> Result<Vec<String>, Problem> {
    let Some(list) = options.get_one::<String>("show") else {
        let first = columns.iter().filter(|name| !name.ends_with('\''));
        let modes = results.iter().filter(|name| name.starts_with("frequency "));
        return Ok(modes.chain(first).take(MOST_COLUMNS).cloned().collect());
    };
    let known = |name: &str| match results.iter().find(|result| *result == name) {
        Some(name) => Ok(name.clone()),
        None => Err(unknown("result", name, results.iter().map(String::as_str))),
    };
    parts(list).map(known).collect()
}

/// The first rows, with what varies and what is shown.
fn print(
    table: &Table,
    (varied, shown): (usize, &[String]),
    (description, judged): (&Description, &Judged),
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let places: Vec<usize> = (0..varied).chain(shown.iter().filter_map(|name| table.column(name))).collect();
    let title = |place: &usize| {
        let name = &table.names[1 + place];
        match unit_of(description, name).as_str() {
            "" | "1" => name.clone(),
            unit => format!("{name} ({unit})"),
        }
    };
    let mut lines = vec![std::iter::once(table.names[0].clone()).chain(places.iter().map(title)).collect::<Vec<_>>()];
    for row in table.rows.iter().take(MOST_ROWS) {
        let cell = |k: &usize| {
            row.cells[*k].map_or_else(|| "-".to_owned(), |value| judged.text(row.run, &table.names[1 + k], value))
        };
        let failed = if row.error.is_empty() { None } else { Some("failed".to_owned()) };
        lines.push(std::iter::once(row.run.to_string()).chain(places.iter().map(cell)).chain(failed).collect());
    }
    let width =
        |k: usize| lines.iter().filter_map(|line| line.get(k)).map(|cell| cell.chars().count()).max().unwrap_or(0);
    for line in &lines {
        let cells: Vec<String> = line.iter().enumerate().map(|(k, cell)| format!("{cell:>0$}", width(k))).collect();
        writeln!(out, "{}", cells.join("  "))?;
    }
    if table.rows.len() > MOST_ROWS {
        writeln!(out, "and {} more runs; the table that is written has them all", table.rows.len() - MOST_ROWS)?;
    }
    if !judged.asked {
        writeln!(out, "how many digits hold was not asked; `simulate` with the values of a run tells it")?;
    }
    Ok(())
}

/// A chart for each of what is shown, over the first of what varies; runs that failed are counted in its title, with a cross where each is.
fn draw(loaded: &Loaded, table: &Table, varied: usize, shown: &[String], [x_log, y_log]: [bool; 2]) -> Figure {
    let columns = names(loaded.system.description());
    let description = loaded.system.description();
    let with_unit = |name: &str, value: Option<f64>| {
        format!("{}{}", short(value.unwrap_or(f64::NAN)), spaced(&unit_of(description, name)))
    };
    let label = |name: &str, log: bool| {
        let axis = Axis::new(name, unit_of(description, name));
        if log { axis.log() } else { axis }
    };
    let all = combinations(table, varied);
    let others = evenly_spread(&all);
    let left_out = match all.len() {
        count if count > others.len() => format!("{} of {count} curves", others.len()),
        _ => String::new(),
    };
    if !left_out.is_empty() {
        eprintln!("warning: the picture has {left_out}, evenly spread; the table has all");
    }
    let chart = |name: &String| {
        let Some(place) = table.column(name) else {
            return Chart::new(name.clone(), label("", false), label("", false));
        };
        let line = |other: &&Combination| {
            let rows = table.rows.iter().filter(|row| row.cells[1..varied] == other[..]);
            // Where a run failed is no end of it.
            let ends = rows.map(|row| Some(row).filter(|row| row.error.is_empty()));
            let points = ends.map(|row| row.and_then(|row| Some((row.cells[0]?, row.cells[place]?))));
            let values = table.names[2..].iter().zip(other.iter());
            let title: Vec<String> =
                values.map(|(name, value)| format!("{name} = {}", with_unit(name, *value))).collect();
            let failed = table.rows.iter().filter(|row| row.cells[1..varied] == other[..] && !row.error.is_empty());
            let line = Series::marked_line(title.join(", "), points);
            failed.filter_map(|row| row.cells[0]).fold(line, |line, x| line.failed(x, ""))
        };
        let when = if columns.contains(name) { " at the end" } else { "" };
        let (x, mut y) = (label(&table.names[1], x_log), label(name, y_log));
        y.range = rounding_range(table, name);
        let values = |place: usize| table.rows.iter().filter_map(move |row| row.cells[place]);
        for (log, place, name) in [(x_log, 0, &table.names[1]), (y_log, place, name)] {
            let lost = values(place).filter(|value| *value <= 0.0).count();
            if log && lost > 0 {
                eprintln!(
                    "warning: {name} is not above 0 in {lost} of {} runs, which have no place on a logarithmic axis",
                    table.rows.len()
                );
            }
        }
        let failed = match table.rows.iter().filter(|row| !row.error.is_empty()).count() {
            0 => String::new(),
            failed => format!("{failed} of {} runs failed", table.rows.len()),
        };
        let notes: Vec<&str> = [&*left_out, &*failed].into_iter().filter(|note| !note.is_empty()).collect();
        let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join(", ")) };
        let empty = Chart::new(format!("{}: {name}{when}{notes}", loaded.name), x, y);
        others.iter().map(line).fold(empty, Chart::with)
    };
    Figure::from(shown.iter().map(chart).collect::<Vec<_>>())
}

/// Values that differ by less than this part of how large they were in between do so by rounding: runs are no more accurate.
const ROUNDING: f64 = 1e-12;

/// An axis of what differs from run to run by rounding alone: as far as the values went in between; `None` where they differ by more.
fn rounding_range(table: &Table, name: &str) -> Option<(f64, f64)> {
    let values = |name: &str| {
        let place = table.column(name);
        table.rows.iter().filter_map(move |row| row.cells[place?])
    };
    let ends = values(name).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let between =
        ["min", "max"].map(|most| values(&format!("{most} {name}")).fold(0.0, |far: f64, x| far.max(x.abs())));
    let far = between[0].max(between[1]);
    let middle = 0.5 * (ends.0 + ends.1);
    (ends.1 - ends.0 <= ROUNDING * far && far > 0.0).then_some((middle - far, middle + far))
}

/// Values of all that varies but the first.
type Combination = Vec<Option<f64>>;

/// All combinations that the table has, in order.
fn combinations(table: &Table, varied: usize) -> Vec<Combination> {
    let mut seen = HashSet::new();
    let of = |row: &Row| row.cells[1..varied].to_vec();
    let key = |other: &Combination| other.iter().map(|value| value.map(f64::to_bits)).collect::<Vec<_>>();
    table.rows.iter().map(of).filter(|other| seen.insert(key(other))).collect()
}

/// The first and the last of these and as many evenly between them as there are lines for.
fn evenly_spread(all: &[Combination]) -> Vec<&Combination> {
    let count = all.len().min(MOST_LINES);
    let place = |k: usize| (k * (all.len() - 1)) as f64 / (count - 1).max(1) as f64;
    (0..count).map(|k| &all[place(k).round() as usize]).collect()
}

/// The unit of a parameter, a coordinate, a rate or an output, `min`, `max` and `at the start` left aside.
fn unit_of(description: &Description, name: &str) -> String {
    let name = name.strip_prefix("min ").or_else(|| name.strip_prefix("max ")).unwrap_or(name);
    let name = name.strip_suffix(" at the start").unwrap_or(name);
    if let Some(parameter) = description.parameters.iter().find(|parameter| parameter.name == name) {
        return parameter.unit.to_string();
    }
    if name == "t" {
        return "s".to_owned();
    }
    if name.starts_with("frequency ") {
        return "Hz".to_owned();
    }
    unit(description, name)
}
