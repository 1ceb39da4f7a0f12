//! `simulate --by all`: one motion by every derivation, side by side.

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Value, json};

use super::Problem;
use super::json::{number, object};
use super::load::Loaded;
use crate::simulate::LAGRANGE;
use crate::{Error, Run, Settings};

/// One derivation's run.
struct Line {
    name: String,
    equations: usize,
    run: Run,
    /// Why it ended early.
    failure: Option<String>,
    /// From Lagrange's run; of a coordinate or speed, relative to the largest value it has there.
    difference: f64,
}

/// Runs by Lagrange's equations and by every system of balances, and prints a table.
pub fn run(loaded: &mut Loaded, settings: &Settings, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    if let Some(name) = ["csv", "plot", "animate"].iter().find(|name| options.contains_id(name)) {
        return Err(Problem::usage(format!("`--by all` compares; for --{name} choose one derivation")));
    }
    let systems = loaded.system.description().balances.len();
    // Balances know no parts: with the same steps the difference is that of the equations.
    let settings = &Settings { apart: false, ..settings.clone() };
    let mut lines: Vec<Line> = Vec::new();
    for system in std::iter::once(None).chain((0..systems).map(Some)) {
        loaded.system.set_derivation(system);
        let (run, failure) = match crate::simulate(&mut *loaded.system, settings) {
            Ok(run) => (run, None),
            Err(Error::Run(failure)) => (failure.run.clone(), Some(failure.to_string())),
            Err(error) => return Err(Problem::refused(&error)),
        };
        let description = loaded.system.description();
        let (name, equations) = match system {
            Some(k) => (description.balances[k].name.to_string(), description.balances[k].unknowns.len()),
            None => (LAGRANGE.to_owned(), description.coordinates.len()),
        };
        let difference = lines.first().map_or(0.0, |first| difference(&first.run, &run));
        lines.push(Line { name, equations, run, failure, difference });
    }
    loaded.system.set_derivation(None);
    if options.get_flag("json") {
        let list: Vec<Value> = lines.iter().map(|line| as_json(line, &lines[0])).collect();
        super::json::write(&object([("model", json!(loaded.name)), ("derivations", Value::Array(list))]), out)?;
    } else {
        print(loaded, &lines, out)?;
    }
    match lines[0].failure.take() {
        Some(failure) => Err(Problem::Run(failure)),
        None => Ok(()),
    }
}

fn print(loaded: &Loaded, lines: &[Line], out: &mut dyn Write) -> Result<(), Problem> {
    let first = &lines[0].run;
    write!(out, "{} until t = {}, by {}", loaded.name, first.last().t, first.method)?;
    match (first.step, first.tolerance) {
        (Some(step), _) => writeln!(out, ", step {step} s")?,
        (None, tolerance) => writeln!(out, ", tolerance {:e}", tolerance.unwrap_or(f64::NAN))?,
    }
    let width = lines.iter().map(|line| line.name.chars().count()).max().unwrap_or(0).max(10);
    writeln!(out, "{:width$}  equations  difference  evaluations  time  condition  energy balance", "derivation")?;
    for line in lines {
        let worst = line.run.balances.as_ref().map_or("-".to_owned(), |b| format!("{:.1e}", b.worst));
        let difference = if line.run.balances.is_some() { format!("{:.1e}", line.difference) } else { "-".to_owned() };
        let balance = line.run.energy_balance.map_or("-".to_owned(), |drift| format!("{drift:.1e}"));
        writeln!(
            out,
            "{:width$}  {:9}  {difference:>10}  {:11}  {:4.2}  {worst:>9}  {balance:>14}",
            line.name,
            line.equations,
            line.run.work.evaluations,
            line.run.seconds / first.seconds,
        )?;
        if let Some(failure) = &line.failure {
            writeln!(out, "{:width$}  ended early: {}", "", failure.replace('\n', " "))?;
        }
    }
    if lines.len() == 1 {
        writeln!(out, "no balances: there is nothing to compare with")?;
    }
    Ok(())
}

fn as_json(line: &Line, first: &Line) -> Value {
    let condition = line.run.balances.as_ref().map_or(Value::Null, |b| number(b.worst));
    object([
        ("derivation", json!(line.name)),
        ("equations", json!(line.equations)),
        ("t", number(line.run.last().t)),
        ("difference", number(line.difference)),
        ("steps", json!(line.run.work.steps)),
        ("evaluations", json!(line.run.work.evaluations)),
        ("seconds", number(line.run.seconds)),
        ("time", number(line.run.seconds / first.run.seconds)),
        ("condition", condition),
        ("energy_balance", line.run.energy_balance.map_or(Value::Null, number)),
        ("failure", line.failure.as_ref().map_or(Value::Null, |text| json!(text))),
    ])
}

/// The largest difference of a coordinate or speed at the times that both runs report.
fn difference(first: &Run, second: &Run) -> f64 {
    let n = first.first().q.len();
    let mut scale = vec![0.0_f64; 2 * n];
    let mut gap = vec![0.0_f64; 2 * n];
    for (a, b) in first.states().zip(second.states()).take_while(|(a, b)| a.t == b.t) {
        for (k, (x, y)) in a.q.iter().chain(&a.v).zip(b.q.iter().chain(&b.v)).enumerate() {
            scale[k] = scale[k].max(x.abs());
            gap[k] = gap[k].max((x - y).abs());
        }
    }
    gap.iter().zip(scale).map(|(gap, scale)| if scale > 0.0 { gap / scale } else { *gap }).fold(0.0, f64::max)
}
