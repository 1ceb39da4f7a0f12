//! `needs`: what a scene can do without.

use std::io::{IsTerminal, Write};
use std::ops::{ControlFlow, RangeInclusive};

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use serde_json::{Value, json};

use super::json::{self, number, object};
use super::load::{Loaded, pairs, refuse_model_again};
use super::plotted::filled_parts;
use super::set_up::{Reader, like_output, parameter_index, unknown};
use super::{Context, Problem, outputs, value_files};
use crate::needs::{Deviation, ModelReduction, Need, Needs, NeedsError, NeedsRequest, Prediction, Proposal, Verdict};
use crate::precision::Verified;
use crate::run::plain;
use crate::simulate::Interruption;

/// Parts of a range by which something may be off: runs are not known better, and beyond nothing is like what it was.
const PARTS: RangeInclusive<f64> = 1e-9..=0.5;

/// Tries every ingredient of a model, prints what a scene does without, and writes the smaller file.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut loaded = Loaded::find(context, options)?;
    let comparison = options.get_one::<String>("write").map(|path| comparison_path(path));
    let files = [
        ("write", options.get_one::<String>("write")),
        ("write (the test beside it)", comparison.as_ref()),
        ("plot", options.get_one::<String>("plot")),
    ];
    let files = files.into_iter().filter_map(|(option, path)| Some((option, path?.as_str())));
    outputs::check_paths(files, &loaded.path)?;
    let request = request(&mut loaded, options)?;
    loaded.tell_warnings();
    let said = options.get_flag("json");
    let found = match find(&request, &context.interruption().into()) {
        Ok(found) => found,
        Err(error) => {
            let NeedsError::Interrupted { so_far: Some(found) } = &error else { return Err(problem(error, &loaded)) };
            let found = found.clone();
            return print(&found, said, Err(problem(error, &loaded)), out);
        }
    };
    print(&found, said, Ok(()), out)?;
    let mut written = Vec::new();
    if let Some(path) = options.get_one::<String>("plot") {
        outputs::draw(path, found.chart())?;
        written.push(path.clone());
    }
    if let (Some(path), Some(comparison)) = (options.get_one::<String>("write"), comparison)
        && let (Some(text), Some(test)) = (found.smaller_file(), found.comparison(&loaded.path, path))
    {
        outputs::write(path, &text)?;
        written.push(path.clone());
        match without_test(&request, &loaded) {
            None => {
                outputs::write(&comparison, &test)?;
                written.push(comparison);
            }
            Some(why) if !said => writeln!(out, "no test is written beside {path}: {why}")?,
            Some(_) => {}
        }
    }
    match written.as_slice() {
        _ if said => {}
        [] if options.contains_id("write") => writeln!(out, "nothing is written")?,
        [] => {}
        written => writeln!(out, "written: {}", written.join(", "))?,
    }
    Ok(())
}

/// Why no test can compare the smaller file with the full one.
fn without_test(request: &NeedsRequest, loaded: &Loaded) -> Option<&'static str> {
    if loaded.path == "-" {
        return Some("the model came from standard input, and a test wants its file");
    }
    (request.source != loaded.source)
        .then_some("--params, --set, --start and --until change the model, and a test takes its file as it is")
}

/// The table, or data; and how it ended.
fn print(found: &Needs, as_data: bool, outcome: Result<(), Problem>, out: &mut dyn Write) -> Result<(), Problem> {
    if as_data {
        return json::write_outcome(as_json(found), outcome, out);
    }
    write!(out, "{}", found.table())?;
    outcome
}

/// Tries every ingredient, and names each on a terminal.
///
/// # Errors
/// As [`Needs::find`].
pub fn find(request: &NeedsRequest, interruption: &Interruption) -> Result<Needs, NeedsError> {
    let shown = std::io::stderr().is_terminal();
    let found = Needs::find_until(request, interruption, &mut |name| {
        if shown {
            eprint!("\r{name}\x1b[K");
        }
        if interruption.is_asked() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    if shown {
        eprint!("\r\x1b[K");
    }
    found
}

/// What is told of a question that has no answer.
pub fn problem(error: NeedsError, loaded: &Loaded) -> Problem {
    match error {
        NeedsError::Model { problems } => loaded.problem(&problems),
        NeedsError::Fails { .. } | NeedsError::NotKnown { .. } | NeedsError::Interrupted { .. } => {
            Problem::Run(error.to_string())
        }
        NeedsError::UnknownName { kind, name, known } => unknown(kind, &name, known.iter().map(String::as_str)),
        other => Problem::usage(other),
    }
}

/// Whether the file says what the scene is run for.
pub fn is_said(loaded: &Loaded, options: &ArgMatches) -> bool {
    asked(loaded, options).said().is_ok_and(|said| said.is_some())
}

/// The question with `--params`, `--set`, `--start` and `--until` written into the file.
fn changed(loaded: &mut Loaded, options: &ArgMatches, mut request: NeedsRequest) -> Result<NeedsRequest, Problem> {
    let usage = Problem::usage;
    let mut reader = Reader::default();
    let mut set: Vec<(usize, String, String)> = Vec::new();
    let given = match options.get_one::<String>("params") {
        Some(path) => {
            refuse_model_again(loaded, "params", path)?;
            value_files::read(path)?
        }
        None => Vec::new(),
    };
    for (name, text) in given.into_iter().chain(pairs(options, "set")?) {
        set.push((parameter_index(loaded, &name)?, name, text));
    }
    for (index, name, text) in set {
        let value = reader.value(loaded, "set", Sets::Parameter(index), &text)?;
        let unit = &loaded.system.description().parameters[index].unit;
        let written = format!("{} {unit}", plain(value));
        request = request.setting(&name, written.trim_end()).map_err(usage)?;
    }
    let [mut q, mut v] = [(); 2].map(|()| vec![f64::NAN; loaded.system.len()]);
    reader.states(loaded, options, "start", &mut q, &mut v)?;
    for (prime, values) in [("", q), ("'", v)] {
        for (coordinate, value) in loaded.system.description().coordinates.iter().zip(values) {
            if !value.is_nan() {
                let name = format!("{}{prime}", coordinate.name);
                request = request.starting(&name, &plain(value)).map_err(usage)?;
            }
        }
    }
    if let Some(text) = options.get_one::<String>("until") {
        let until = reader.value(loaded, "until", Sets::Time, text)?;
        if until <= 0.0 {
            return Err(Problem::usage(format!("--until is {until}; expected a time after the start")));
        }
        request = request.ending(&plain(until)).map_err(usage)?;
    }
    Ok(request)
}

/// `small_test.rs` beside `small.yaml`.
fn comparison_path(path: &str) -> String {
    format!("{}_test.rs", path.strip_suffix(".yaml").unwrap_or(path))
}

/// The table and what follows as data.
fn as_json(found: &Needs) -> Value {
    let strings = |list: &[String]| Value::from(list.to_vec());
    let gone = |gone: &[(String, String)]| -> Value {
        gone.iter().map(|(claim, why)| object([("claim", json!(claim)), ("why", json!(why))])).collect()
    };
    let told = |deviation: f64| number(found.need.told(deviation));
    let reduction = |reduction: &ModelReduction| {
        let deviation = reduction.deviation.as_ref();
        let of = |what: fn(&Deviation) -> f64| deviation.map_or(Value::Null, |deviation| told(what(deviation)));
        let predicted = reduction.predicted;
        let law = |predicted: Prediction| json!(found.need.told_prediction(predicted).law.to_string());
        object([
            ("ingredient", json!(reduction.ingredient)),
            ("proposed", json!(reduction.proposal.to_string())),
            ("predicted", predicted.map_or(Value::Null, |predicted| told(predicted.change))),
            ("holds", predicted.map_or(Value::Null, |predicted| json!(predicted.holds()))),
            ("law", predicted.map_or(Value::Null, law)),
            ("change", of(|deviation| deviation.largest)),
            ("of", deviation.map_or(Value::Null, |deviation| json!(deviation.of))),
            ("clock", deviation.map_or(Value::Null, |deviation| number(deviation.phase_error))),
            ("shape", of(|deviation| deviation.waveform_error)),
            ("saving", number(reduction.saving)),
            ("needed", json!(reduction.verdict != Verdict::Serves)),
            ("unfelt", json!(reduction.not_depended_on)),
            ("found", json!(reduction.verdict.to_string())),
            ("missed", reduction.margin.as_ref().map_or(Value::Null, |(guard, _)| json!(guard))),
            ("margin", reduction.margin.as_ref().map_or(Value::Null, |(_, margin)| number(*margin))),
            ("gone", gone(&reduction.gone)),
        ])
    };
    let choice = found.choice.as_ref().map_or(Value::Null, |choice| {
        let members = choice.members.iter().zip(&choice.proposals);
        let member = |(ingredient, proposal): (&String, &Proposal)| {
            object([("ingredient", json!(ingredient)), ("proposed", json!(proposal.to_string()))])
        };
        let off = |(name, size): &(String, f64)| object([("of", json!(name)), ("change", number(*size))]);
        object([
            ("members", members.map(member).collect()),
            ("idle", strings(&choice.idle)),
            ("tolerance", number(choice.tolerance)),
            ("predicted", choice.predicted.map_or(Value::Null, told)),
            ("change", told(choice.change)),
            ("verified", told(choice.verified)),
            ("of", json!(choice.of)),
            ("clock", choice.parts.map_or(Value::Null, |(phase_error, _)| number(phase_error))),
            ("shape", choice.parts.map_or(Value::Null, |(_, waveform_error)| told(waveform_error))),
            ("moved", choice.moved.map_or(Value::Null, told)),
            ("operations", number(choice.operations)),
            ("saving", number(choice.saving)),
            ("not_promised", choice.not_promised.iter().map(off).collect()),
            ("gone", gone(&choice.gone)),
        ])
    });
    let full = |run: &Verified| {
        let operations = run.work * found.evaluation;
        object([("tolerance", number(run.tolerance)), ("change", told(run.error)), ("operations", number(operations))])
    };
    object([
        ("model", json!(found.name)),
        ("scene", json!(found.scene)),
        ("outputs", strings(&found.need.outputs)),
        ("within", number(found.need.within)),
        (
            "absolute",
            found
                .need
                .absolute
                .iter()
                .map(|(name, amount)| object([("of", json!(name)), ("within", number(*amount))]))
                .collect(),
        ),
        ("until", number(found.until)),
        ("in_parts_of", json!(found.need.measure())),
        ("known", told(found.known)),
        ("growth", number(found.growth)),
        ("promised_until", found.promised_until.map_or(Value::Null, number)),
        ("operations", number(found.operations)),
        ("full", found.full.iter().map(full).collect()),
        ("rungs", found.reductions.iter().map(reduction).collect()),
        ("choice", choice),
    ])
}

/// What the options ask of the file; what they leave out the scene says.
pub fn request(loaded: &mut Loaded, options: &ArgMatches) -> Result<NeedsRequest, Problem> {
    let own = |option: &str| options.get_one::<String>(option).cloned();
    let request = asked(loaded, options);
    let mut request = changed(loaded, options, request)?;
    let (names, within) = (own("needs"), own("within"));
    if names.is_none() && within.is_none() {
        return Ok(request);
    }
    let said = request.need().map_err(Problem::usage)?;
    let (outputs, absolute) = match names {
        None => (said.outputs, said.absolute),
        Some(names) => named(loaded, &names)?,
    };
    let within = match within {
        None => said.within,
        Some(text) => text.trim().parse().ok().filter(|part| PARTS.contains(part)).ok_or_else(|| {
            Problem::usage(format!(
                "--within wants a part of the range of each, from 1e-9 to 0.5, such as 1e-3, not `{text}`"
            ))
        })?,
    };
    request.need = Some(Need { outputs, within, absolute });
    Ok(request)
}

/// Names, and amounts by which others may be off.
type Named = (Vec<String>, Vec<(String, f64)>);

/// Names with the amounts by which some may be off: `tip,gap=0.1 mm`.
fn named(loaded: &mut Loaded, names: &str) -> Result<Named, Problem> {
    let mut reader = Reader::default();
    let (mut outputs, mut absolute) = (Vec::new(), Vec::new());
    for name in filled_parts(names) {
        match name.split_once('=') {
            None => outputs.push(name.to_owned()),
            Some((name, amount)) => {
                let name = name.trim();
                let sets = like_output(loaded, name).unwrap_or(Sets::Any);
                absolute.push((name.to_owned(), reader.value(loaded, "needs", sets, amount.trim())?));
            }
        }
    }
    Ok((outputs, absolute))
}

/// The question of the file as it is.
fn asked(loaded: &Loaded, options: &ArgMatches) -> NeedsRequest {
    NeedsRequest {
        sizes: loaded.sizes.clone(),
        files: loaded.files.clone(),
        scene: options.get_one::<String>("scene").cloned(),
        all: options.try_get_one("all").ok().flatten().copied().unwrap_or(false),
        ..NeedsRequest::new(loaded.source.as_str())
    }
}
