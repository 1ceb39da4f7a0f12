//! `--state-space`: x' = A x + B u, y = C x + D u in a file that programs for control read.

use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::super::json::number;
use super::super::load::Loaded;
use super::super::mat::Variables;
use super::super::npz::Archive;
use super::super::plotted::{listed, parts};
use super::super::set_up::Reader;
use super::super::{Problem, outputs};
use super::failed;
use super::model::Model;
use super::shaken::{Shakeable, Shaken, named};
use crate::linear::{
    InputOutput, LinearError, Linearised, NamedDrive, Source, Unreached, linearise_instant, short_beside,
};
use crate::mechanism::At;
use crate::numbers::counted;

/// Endings of files that are written.
pub const ENDINGS: [&str; 5] = ["json", "npz", "mat", "m", "csv"];

/// Of small motions: what inputs do, and what is seen.
///
/// # Errors
/// Names that are unknown.
pub fn of_model(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    model: Model<'_>,
) -> Result<InputOutput, Problem> {
    for name in inputs(loaded, options) {
        model.can_move(&name).map_err(failed)?;
    }
    let drives = drives(loaded, options, reader, &Shakeable::of(model.linear()))?;
    let answers = answers(loaded, options)?;
    let answers: Vec<&str> = answers.iter().map(String::as_str).collect();
    let seen = model.observe(loaded, &answers).map_err(failed)?;
    model.linear().input_output(&drives, &seen).map_err(failed)
}

/// The same of a mechanism with states of first order.
#[cfg(feature = "modal")]
pub fn of_states(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    found: &crate::linear::StateSpace,
) -> Result<InputOutput, Problem> {
    let drives = drives(loaded, options, reader, &Shakeable::of_states(loaded, found))?;
    let answers = answers(loaded, options)?;
    let answers: Vec<&str> = answers.iter().map(String::as_str).collect();
    found.input_output(&*loaded.system, &drives, &answers).map_err(failed)
}

/// The same of small departures from a motion at an instant.
///
/// # Errors
/// Names that are unknown.
pub fn of_instant(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    at: At<'_>,
) -> Result<InputOutput, Problem> {
    let mut drives = Vec::new();
    for name in inputs(loaded, options) {
        let place = input_place(loaded, &name)?;
        let unit = input_unit(loaded, reader, &name)?;
        drives.push(NamedDrive { drive: Source::Input(place).into(), name, unit });
    }
    let answers = answers(loaded, options)?;
    let answers: Vec<&str> = answers.iter().map(String::as_str).collect();
    linearise_instant(&*loaded.system, at, &drives, &answers).map_err(failed)
}

/// What `--in` names, or all inputs.
///
/// # Errors
/// Names that are unknown.
pub fn drives(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    shakeable: &Shakeable,
) -> Result<Vec<NamedDrive>, Problem> {
    let drive = |name: &String| {
        let (Shaken { drive, label, per }, _) = named(loaded, reader, shakeable, name)?;
        Ok(NamedDrive { drive, name: label, unit: per })
    };
    inputs(loaded, options).iter().map(drive).collect()
}

/// All inputs of a model.
pub fn all_inputs(loaded: &Loaded, reader: &mut Reader, linear: &Linearised) -> Result<Vec<NamedDrive>, Problem> {
    let one = |(k, name): (usize, &String)| {
        let unit = input_unit(loaded, reader, name)?;
        Ok(NamedDrive { drive: Source::Input(k).into(), name: name.clone(), unit })
    };
    linear.inputs.iter().enumerate().map(one).collect()
}

/// The place of an input of the model.
fn input_place(loaded: &Loaded, name: &str) -> Result<usize, Problem> {
    let known = &loaded.system.description().inputs;
    let place = known.iter().position(|input| **input == *name);
    place.ok_or_else(|| super::super::set_up::unknown("input", name, known.iter().map(|name| &**name)))
}

/// The unit of an input, SI; empty for a pure number and where it is not known.
pub fn input_unit(loaded: &Loaded, reader: &mut Reader, name: &str) -> Result<String, Problem> {
    let unit = reader.model(loaded)?.unit_of(name).map(|unit| dalembert_symbolic::print::si_unit(&unit));
    Ok(unit.unwrap_or_default())
}

/// `--in`, or all inputs.
pub fn inputs(loaded: &Loaded, options: &ArgMatches) -> Vec<String> {
    match options.get_one::<String>("in") {
        Some(text) => parts(text).map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect(),
        None => loaded.system.description().inputs.iter().map(ToString::to_string).collect(),
    }
}

/// `--out`, or all coordinates.
fn answers(loaded: &Loaded, options: &ArgMatches) -> Result<Vec<String>, Problem> {
    let description = loaded.system.description();
    match options.get_one::<String>("out") {
        Some(text) => listed(description, text),
        None => Ok(description.coordinates[..description.mechanical()].iter().map(|c| c.name.to_string()).collect()),
    }
}

/// Writes the file that was asked for, if one was, and says what inputs do not reach and outputs do not show.
///
/// # Errors
/// Those of finding it, and a file that cannot be written.
pub fn write(
    name: &str,
    options: &ArgMatches,
    find: impl FnOnce() -> Result<InputOutput, Problem>,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let Some(path) = options.get_one::<String>("state-space") else { return Ok(()) };
    let found = &find()?;
    let ending = Path::new(path).extension().map_or_else(String::new, |ending| ending.to_string_lossy().to_lowercase());
    let bytes = match ending.as_str() {
        "npz" => arrays(found).ok_or_else(|| outputs::too_large(path))?,
        "mat" => variables(found).ok_or_else(|| outputs::too_large(path))?,
        "m" => script(name, found).into_bytes(),
        "csv" => table(found).into_bytes(),
        _ => {
            let ranks = [
                ("controllability_rank", found.controllability_rank()),
                ("observability_rank", found.observability_rank()),
            ];
            let ranks = ranks.map(|(key, rank)| (key.to_owned(), json!(rank)));
            (serde_json::to_string_pretty(&as_json(name, found, ranks)).unwrap_or_default() + "\n").into_bytes()
        }
    };
    if path == "-" {
        return Ok(out.write_all(&bytes)?);
    }
    outputs::write(path, bytes)?;
    if options.get_flag("json") {
        return Ok(());
    }
    let m = found.inputs.len();
    let states = counted(found.states.len(), "state");
    let (inputs, outputs) = (counted(m, "input"), counted(found.outputs.len(), "output"));
    writeln!(out, "{path}: x' = A x + B u, y = C x + D u, of {states}, {inputs} and {outputs}")?;
    if m > 0 {
        told(
            ["inputs reach", "inputs do not reach"],
            (found, found.controllability_rank()),
            found.uncontrollable(),
            out,
        )?;
    }
    told(["outputs show", "outputs do not show"], (found, found.observability_rank()), found.unobservable(), out)
}

/// Whether the matrices go to standard output, in the place of the report.
///
/// # Errors
/// Where the report is data, too.
pub fn goes_to_output(options: &ArgMatches) -> Result<bool, Problem> {
    let goes = options.get_one::<String>("state-space").is_some_and(|path| path == "-");
    if goes && options.get_flag("json") {
        return Err(Problem::usage("--state-space - and --json both ask for standard output; name a file for one"));
    }
    Ok(goes)
}

/// Whether all motions are reached, or which are not; with Kalman's rank.
fn told(
    [all, some]: [&str; 2],
    (space, rank): (&InputOutput, usize),
    found: Result<Vec<Unreached>, LinearError>,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let found = found.map_err(failed)?;
    if found.is_empty() {
        return Ok(writeln!(out, "  {all} all motions (rank {rank})")?);
    }
    writeln!(out, "  {all} {rank} of {} directions (rank {rank})", space.states.len())?;
    for Unreached { eigenvalue, directions, state } in found {
        let [re, im] = [eigenvalue.re, eigenvalue.im].map(|part| short_beside(part, eigenvalue.norm()));
        let value = if im == "0" { re } else { format!("{re} ± {im}i") };
        let (s, are) = if directions == 1 { ("", "") } else { ("s", " each") };
        writeln!(out, "  {some} {directions} motion{s}{are} at {value} 1/s, most of {state}")?;
    }
    Ok(())
}

/// The four matrices with their names.
fn matrices(found: &InputOutput) -> [(&'static str, &DMatrix<f64>); 4] {
    [("A", &found.a), ("B", &found.b), ("C", &found.c), ("D", &found.d)]
}

/// Names and units of x, u and y.
fn lists(found: &InputOutput) -> [(&'static str, &[[String; 2]]); 3] {
    [("state", &found.states), ("input", &found.inputs), ("output", &found.outputs)]
}

/// A matrix, row by row.
pub fn matrix(matrix: &DMatrix<f64>) -> Value {
    matrix.row_iter().map(|row| row.iter().map(|x| number(*x)).collect::<Vec<_>>()).collect::<Vec<_>>().into()
}

/// All of it, with more at the end.
pub fn as_json(name: &str, found: &InputOutput, more: impl IntoIterator<Item = (String, Value)>) -> Value {
    let mut entries = vec![("format".to_owned(), json!(1)), ("model".to_owned(), json!(name))];
    for (kind, list) in lists(found) {
        entries.push((format!("{kind}s"), list.iter().map(|[name, _]| name.clone()).collect::<Vec<_>>().into()));
        entries.push((format!("{kind}_units"), list.iter().map(|[_, unit]| unit.clone()).collect::<Vec<_>>().into()));
    }
    entries.extend(matrices(found).map(|(name, matrix)| (name.to_owned(), self::matrix(matrix))));
    entries.extend(more);
    super::super::json::object(entries)
}

/// All digits of a number; no sign of 0.
fn digits(x: &f64) -> String {
    format!("{:e}", x + 0.0)
}

/// Definitions for MATLAB and Octave.
fn script(name: &str, found: &InputOutput) -> String {
    let mut text = format!("% Small motions of {name}: x' = A x + B u, y = C x + D u, SI.\n");
    for (letter, matrix) in matrices(found) {
        let row = |i: usize| matrix.row(i).iter().map(digits).collect::<Vec<_>>().join(" ");
        let rows = (0..matrix.nrows()).map(row).collect::<Vec<_>>().join("; ");
        let _ = match matrix.is_empty() {
            true => writeln!(text, "{letter} = zeros({}, {});", matrix.nrows(), matrix.ncols()),
            false => writeln!(text, "{letter} = [{rows}];"),
        };
    }
    let quoted = |text: &String| format!("'{}'", text.replace('\'', "''"));
    for (kind, list) in lists(found) {
        let column = |k: usize| list.iter().map(|entry| quoted(&entry[k])).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "{kind}s = {{{}}};\n{kind}_units = {{{}}};", column(0), column(1));
    }
    text + "% ss(A, B, C, D, 'StateName', states, 'InputName', inputs, 'OutputName', outputs)\n"
}

/// [A B; C D] with names at both sides.
fn table(found: &InputOutput) -> String {
    let names = |list: &[[String; 2]]| list.iter().map(|[name, _]| name.clone()).collect::<Vec<_>>();
    let (states, inputs, outputs) = (names(&found.states), names(&found.inputs), names(&found.outputs));
    let quoted = |name: &String| if name.contains([',', '"']) { format!("\"{name}\"") } else { name.clone() };
    let head: Vec<String> = states.iter().chain(&inputs).map(quoted).collect();
    let mut text = format!("row,{}\n", head.join(","));
    let blocks = [(&states, &found.a, &found.b, "'"), (&outputs, &found.c, &found.d, "")];
    for (names, left, right, rate) in blocks {
        for (i, name) in names.iter().enumerate() {
            let values = left.row(i).iter().chain(right.row(i).iter()).map(digits).collect::<Vec<_>>();
            let _ = writeln!(text, "{},{}", quoted(&format!("{name}{rate}")), values.join(","));
        }
    }
    text
}

/// NumPy's arrays; `None` where they are too large for an archive.
fn arrays(found: &InputOutput) -> Option<Vec<u8>> {
    let mut archive = Archive::default();
    for (name, matrix) in matrices(found) {
        archive.numbers(name, &[matrix.nrows(), matrix.ncols()], matrix.transpose().iter().copied());
    }
    for (kind, list) in lists(found) {
        for (k, ending) in ["s", "_units"].into_iter().enumerate() {
            let words: Vec<&str> = list.iter().map(|entry| entry[k].as_str()).collect();
            archive.words(&format!("{kind}{ending}"), &words);
        }
    }
    archive.bytes()
}

/// Variables for MATLAB and Octave, named as those of the script; `None` where they are too large for a file.
fn variables(found: &InputOutput) -> Option<Vec<u8>> {
    let mut variables = Variables::default();
    for (name, matrix) in matrices(found) {
        variables.numbers(name, [matrix.nrows(), matrix.ncols()], matrix.as_slice());
    }
    for (kind, list) in lists(found) {
        for (k, ending) in ["s", "_units"].into_iter().enumerate() {
            let words: Vec<&str> = list.iter().map(|entry| entry[k].as_str()).collect();
            variables.words(&format!("{kind}{ending}"), &words);
        }
    }
    variables.bytes()
}
