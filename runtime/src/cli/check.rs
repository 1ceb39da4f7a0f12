//! `check`: what was tested when deriving, and how well it held.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::diagnose::quoted;
use dalembert_symbolic::expr::{Id, Symbol};
use dalembert_symbolic::file;
use dalembert_symbolic::gate::{Conservative, Nature, Origin, Report, shared_data};
use dalembert_symbolic::lower::Program;
use dalembert_symbolic::model::{Contact, EventAction, HIDDEN, MOST_COMBINATIONS, Model};
use dalembert_symbolic::number::DoubleDouble;
use serde_json::Value;

use super::json::{number, object, write_outcome};
use super::load::{Loaded, ModelFile, sizes};
use super::{Context, Problem, freedoms, outputs, routh, symmetries};
use crate::mechanism::{At, Balances, Interpreted, System};
use crate::numbers::counted;

/// Derives the model anew and prints the report.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let names: Vec<&String> = options.get_many::<String>("model").into_iter().flatten().collect();
    let as_data = options.get_flag("json");
    if let ([name], true) = (names.as_slice(), as_data) {
        let (report, outcome) = as_json(context, name, options)?;
        return write_outcome(report, outcome, out);
    }
    let mut files = Vec::new();
    let outcome = each(&names, |place, name| match as_data {
        true => {
            let (mut report, outcome) =
                as_json(context, name, options).unwrap_or_else(|e| (object([("name", name.into())]), Err(e)));
            if let Err(problem) = &outcome {
                report["error"] = problem.as_json();
            }
            files.push(report);
            outcome
        }
        false if place > 0 => Ok(writeln!(out)?).and_then(|()| one(context, name, options, out)),
        false => one(context, name, options, out),
    });
    match as_data {
        true => write_outcome(object([("files", files.into())]), outcome, out),
        false => outcome,
    }
}

/// Looks at every file.
fn each(names: &[&String], mut look: impl FnMut(usize, &str) -> Result<(), Problem>) -> Result<(), Problem> {
    let (mut failed, mut wrong) = (None, 0);
    for (place, name) in names.iter().enumerate() {
        match look(place, name) {
            // Of several files all are looked at; what is wrong with the last is said by who called.
            Err(problem) if !matches!(problem, Problem::Closed) => {
                wrong += 1;
                if let Some(before) = failed.replace(problem) {
                    eprintln!("{before}");
                }
            }
            other => other?,
        }
    }
    match (failed, names.len()) {
        (None, _) => Ok(()),
        (Some(only), 1) => Err(only),
        (Some(last), count) => Err(Problem::Model(format!("{last}\nerror: {wrong} of {count} files are wrong"))),
    }
}

/// One file.
fn one(context: Context<'_>, name: &str, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let text = ModelFile::named(context, name, sizes(options)?)?;
    let program = text.for_runs(context).map_err(|problems| text.problem(&problems))?;
    writeln!(out, "{}: {}", text.name, size_in_words(&program.model))?;
    for state in once_stated(&program) {
        writeln!(out, "  the rate of {state} is stated once: an `equation` in `balances` may state it again")?;
    }
    for rotation in &program.model.rotations {
        writeln!(out, "  {} is a rotation: 4 numbers, 3 degrees of freedom", rotation.name)?;
    }
    if let Some(line) = single_contacts(&program.model) {
        writeln!(out, "  {line}")?;
    }
    for agreement in &program.report.agreements {
        let (first, second) = &agreement.between;
        let (states, worst) = (counted(agreement.states, "state"), agreement.worst);
        writeln!(out, "  {first} and {second} agree at {states}, worst {worst:.1e}")?;
    }
    for (rotation, worst) in &program.report.lengths {
        writeln!(out, "  no acceleration depends on the length of {rotation}, worst {worst:.1e}")?;
    }
    for line in freedoms::lines(&program) {
        writeln!(out, "  {line}")?;
    }
    looked_at(&program, out)?;
    unseen(&program, out)?;
    without_units(&program, out)?;
    conditions(&program, &text.source, out)?;
    claims(&program, out)?;
    for force in &program.report.forces {
        writeln!(out, "  {}", nature(force, &program))?;
    }
    let warnings = file::render(&text.path, &text.source, &program.model.warnings);
    match outputs::is_quiet("check", options) {
        true => eprint!("{warnings}"),
        false => write!(out, "{warnings}")?,
    }
    structure(&program, out)?;
    if options.get_flag("routh") {
        write!(out, "{}", routh::lines(&program))?;
    }
    if !options.get_flag("symmetries") {
        return Ok(());
    }
    symmetries::of_scenes(&Loaded::named(context, name, sizes(options)?)?, &program, out)
}

/// How many coordinates, states of first order and held values a model has.
fn size_in_words(model: &Model) -> String {
    let n = model.mechanical();
    let first_order = match model.states.len() {
        0 => String::new(),
        1 => ", 1 state of first order".to_owned(),
        k => format!(", {k} states of first order"),
    };
    // Directions of sliding are the program's own.
    let held = match model.memory.len() - model.contacts.iter().flat_map(Contact::held).count() {
        0 => String::new(),
        1 => ", 1 held value".to_owned(),
        k => format!(", {k} held values"),
    };
    format!("{n} coordinate{}{first_order}{held}", if n == 1 { "" } else { "s" })
}

/// What is said of contacts that have more combinations than phases.
fn single_contacts(model: &Model) -> Option<String> {
    model.contacts_are_single().then(|| {
        format!(
            "{} contacts and frictions, of which each is judged by itself: they have more than {MOST_COMBINATIONS} combinations, which only \
             `--method moreau` runs, with a step",
            model.contacts.len()
        )
    })
}

/// What is conserved, with what changes it, and what holds.
fn claims(program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    let model = &program.model;
    for (((name, worst), events), claim) in conserved(&program.report).zip(&model.conserved) {
        let condition = model.condition(&claim.when);
        if events.is_empty() {
            writeln!(out, "  {name} is conserved{condition}, worst {worst:.1e}")?;
        } else {
            let by = quoted(events);
            let sets = |event: &&String| {
                let found = model.events.iter().find(|known| known.name == **event);
                found.is_some_and(|event| event.actions.iter().any(|action| matches!(action, EventAction::Set(_))))
            };
            let (between, impact) =
                if events.iter().any(|event| sets(&event)) { ("events", "") } else { ("impacts", "impact ") };
            writeln!(
                out,
                "  {name} is conserved between {between}{condition}, worst {worst:.1e}; changed by {impact}{by}"
            )?;
        }
    }
    for ((name, worst), claim) in program.report.checks.iter().zip(&model.checks) {
        writeln!(out, "  check {name} holds{}, worst {worst:.1e}", model.condition(&claim.when))?;
    }
    Ok(())
}

/// What is conserved, how well it held, and the events whose impacts change it.
fn conserved(report: &Report) -> impl Iterator<Item = (&(String, f64), &Vec<String>)> {
    report.conserved.iter().zip(&report.changed_by)
}

/// The report as one object; of a file with mistakes these, each with its place, and that it has some.
fn as_json(context: Context<'_>, name: &str, options: &ArgMatches) -> Result<(Value, Result<(), Problem>), Problem> {
    let text = ModelFile::named(context, name, sizes(options)?)?;
    let program = match text.for_runs(context) {
        Ok(program) => program,
        Err(problems) => {
            let wrong = text.problem(&problems);
            let problems = mistakes(&text.source, &problems);
            return Ok((object([("name", text.name.into()), ("problems", problems)]), Err(wrong)));
        }
    };
    let (model, report) = (&program.model, &program.report);
    let words = |list: &[String]| Value::from(list.to_vec());
    let agreements = report.agreements.iter().map(|agreement| {
        let (first, second) = &agreement.between;
        object([
            ("between", vec![first.to_string(), second.to_string()].into()),
            ("states", agreement.states.into()),
            ("worst", number(agreement.worst)),
        ])
    });
    let claims = |list: &[(String, f64)]| -> Value {
        list.iter().map(|(name, worst)| object([("name", name.clone().into()), ("worst", number(*worst))])).collect()
    };
    let conserved = conserved(report).map(|((name, worst), events)| {
        let (name, worst) = (name.clone().into(), number(*worst));
        object([("name", name), ("worst", worst), ("changed_by_impact", words(events))])
    });
    let forces: Vec<String> = report.forces.iter().map(|force| nature(force, &program)).collect();
    let object = object([
        ("name", text.name.into()),
        ("coordinates", model.mechanical().into()),
        ("states_of_first_order", model.states.len().into()),
        ("stated_once", words(&once_stated(&program))),
        ("agreements", agreements.collect()),
        ("degrees_of_freedom", words(&freedoms::lines(&program))),
        ("states", report.states.len().into()),
        ("unreached", words(&report.unreached)),
        ("confirmed_by_nothing", words(&report.alone)),
        ("without_units", words(&names_without_units(&program))),
        ("conserved", conserved.collect()),
        ("checks", claims(&report.checks)),
        ("forces", words(&forces)),
        ("problems", mistakes(&text.source, &model.warnings)),
        ("recognised", words(&recognised(&program))),
        ("operations", object(operations(&program).into_iter().map(|(what, count)| (what, count.into())))),
    ]);
    Ok((object, Ok(())))
}

/// Errors and warnings, with lines and columns in characters from 1.
pub(super) fn mistakes(source: &str, problems: &[dalembert_symbolic::diagnose::Problem]) -> Value {
    let one = |(extent, problem): (file::Extent, &dalembert_symbolic::diagnose::Problem)| {
        object([
            ("code", problem.code.into()),
            ("severity", if problem.is_warning() { "warning" } else { "error" }.into()),
            ("message", problem.message.clone().into()),
            ("help", problem.help.clone().into()),
            ("line", extent.line.into()),
            ("column", extent.column.into()),
            ("end_line", extent.end_line.into()),
            ("end_column", extent.end_column.into()),
        ])
    };
    file::extents(source, problems).into_iter().map(one).collect()
}

/// Where the states come from, and what they do not reach.
fn looked_at(program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    let report = &program.report;
    let from = |origin: Origin| report.states.iter().filter(|state| state.origin == origin).count();
    let (near, large, group) = (from(Origin::Near), from(Origin::Large), from(Origin::Group));
    let (motion, side) = (from(Origin::Motion), from(Origin::Side));
    writeln!(
        out,
        "  tested at {}: {near} near a start, {large} at large, {group} with one group of coordinates moving, \
         {motion} from the motion, {side} where some function changes",
        counted(report.states.len(), "state")
    )?;
    for (scene, reached, until) in &report.followed {
        if reached < &(until * (1.0 - 1e-9)) {
            writeln!(out, "  the motion of `{scene}` was followed until t = {reached:.4} of {until}")?;
        }
    }
    for words in report.unreached.iter().chain(&report.alone) {
        writeln!(out, "  {words}")?;
    }
    Ok(())
}

/// What the comparisons cannot show to be wrong.
fn unseen(program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    let shared = shared_data(&program.model).join(", ");
    if shared.is_empty() {
        return Ok(());
    }
    let say = if program.model.checks.is_empty() { "; say what you know of these in `checks`" } else { "" };
    match program.report.agreements.is_empty() {
        true => writeln!(out, "  one derivation only, from {shared}{say}")?,
        false => writeln!(out, "  shared by all derivations, so not tested by comparing them: {shared}{say}")?,
    }
    Ok(())
}

/// Names without a unit, which leave what depends on them unchecked.
fn without_units(program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    let names = names_without_units(program);
    if !names.is_empty() {
        let list = names.join(", ");
        writeln!(out, "  no unit is given for {list}: units of what depends on them are not checked")?;
    }
    Ok(())
}

fn names_without_units(program: &Program) -> Vec<String> {
    let model = &program.model;
    let parameters = model.parameters.iter().filter(|p| p.unit.is_none()).map(|p| match &p.family {
        Some(family) => family.name.as_str(),
        None => p.name.as_str(),
    });
    let coordinates = model.coordinates.iter().filter(|c| c.unit.is_none());
    let coordinates = coordinates.map(|c| c.name.trim_start_matches(HIDDEN));
    let coordinates = coordinates.map(|name| name.split('[').next().unwrap_or(name));
    let mut names: Vec<String> = parameters.chain(coordinates).map(str::to_owned).collect();
    names.dedup();
    names
}

/// States whose rates no system of balances states again.
fn once_stated(program: &Program) -> Vec<String> {
    let first = program.model.mechanical() as u32;
    let systems = program.model.balances.iter();
    let written = systems.flat_map(|system| &system.balances).filter(|balance| balance.is_written());
    let parts = written.flat_map(|balance| &balance.parts).flat_map(|part| part.value.iter().copied());
    let symbols = program.model.graph.symbols(parts);
    let again = |j: usize| symbols.contains(&Symbol::Acceleration(first + j as u32));
    let states = program.model.states.iter().enumerate().filter(|(j, _)| !again(*j));
    states.map(|(_, state)| state.name.clone()).collect()
}

/// What kind of force an entry is, in words.
fn nature(force: &Conservative, program: &Program) -> String {
    // A state stands with the speeds.
    let speeds = if program.model.states.is_empty() { "velocity" } else { "velocities or states" };
    let name = match (force.section.as_str(), force.name.as_str()) {
        (_, "") => "all forces together".to_owned(),
        ("torques", name) => format!("torque {name}"),
        ("generalized_forces", name) => format!("generalized force on {name}"),
        (_, name) => format!("force {name}"),
    };
    match &force.nature {
        Nature::Idle => format!("{name}: does no work"),
        Nature::Potential if force.name.is_empty() => format!("{name} have a potential"),
        Nature::Potential => format!("{name} has a potential"),
        Nature::TimeDependent => format!("{name} depends on time: it has a potential at each time, which changes"),
        Nature::Velocity { idle: true } => format!("{name} has no potential: it depends on {speeds}, but does no work"),
        Nature::Velocity { idle: false } => format!("{name} has no potential: it depends on {speeds}"),
        Nature::Curl { between: Some((i, j)), value, state } => {
            format!("{name} has no potential: ∂Q({i})/∂{j} − ∂Q({j})/∂{i} = {value:.3e} at {state}")
        }
        Nature::Curl { between: None, state, .. } => {
            format!("{name} has no potential: its curl is not zero at {state}")
        }
    }
}

/// Size, operations and conditioning of every system of balances, at the states where it was compared.
fn conditions(program: &Program, source: &str, out: &mut dyn Write) -> Result<(), Problem> {
    if program.momentum.is_empty() {
        return Ok(());
    }
    let mut mechanism = Interpreted::new(program.clone(), source);
    let mut ranges = vec![(f64::INFINITY, 0.0_f64); program.momentum.len()];
    for state in &program.report.states {
        for (index, value) in state.parameters.iter().enumerate() {
            mechanism.set_parameter(index, *value);
        }
        mechanism.set_modes(&state.modes);
        for (k, range) in ranges.iter_mut().enumerate() {
            let Some(mut balances) = Balances::new(&mechanism, k) else { continue };
            let floats = |list: &[DoubleDouble]| list.iter().map(|x| x.to_f64()).collect::<Vec<f64>>();
            let (q, v) = (floats(&state.q), floats(&state.v));
            balances.evaluate(&mechanism, At::new(state.t.to_f64(), &q, &v));
            let condition = 1.0 / balances.reciprocal_condition();
            *range = (range.0.min(condition), range.1.max(condition));
        }
    }
    for (system, (low, high)) in program.momentum.iter().zip(ranges) {
        let reactions = system.unknowns.len() - program.model.coordinates.len();
        let unknowns = match reactions {
            0 => "accelerations only".to_owned(),
            1 => "1 reaction component".to_owned(),
            n => format!("{n} reaction components"),
        };
        let equations = counted(system.right.len(), "equation");
        writeln!(
            out,
            "  {}: {equations}, {unknowns}, {}, condition number {low:.1e} to {high:.1e}",
            system.name,
            counted(system.operations, "operation")
        )?;
    }
    Ok(())
}

/// What was recognised, and operation counts.
pub fn structure(program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    for word in recognised(program) {
        writeln!(out, "  {word}")?;
    }
    let counts: Vec<String> = operations(program).iter().map(|(what, count)| format!("{what} {count}")).collect();
    writeln!(out, "  operations: {}", counts.join(", "))?;
    Ok(())
}

/// What was recognised, in words.
pub fn recognised(program: &Program) -> Vec<String> {
    let s = &program.structure;
    let name = |i: usize| program.model.coordinates.get(i).map_or("?", |c| c.name.trim_start_matches(HIDDEN));
    let flags = [
        (s.linear, "linear with constant coefficients"),
        (s.constant_mass, "constant mass matrix"),
        (s.separable, "separable"),
        (s.diagonal_mass, "diagonal mass matrix"),
        (s.conservative, "conservative"),
        (s.time_dependent, "depends on time"),
        (s.uniformly_accelerated, "constant accelerations"),
    ];
    let mut words: Vec<String> = flags.iter().filter(|(is, _)| *is).map(|(_, word)| (*word).to_owned()).collect();
    if s.mass_blocks.len() > 1 && !s.diagonal_mass {
        words.push(format!("mass matrix in {} blocks", s.mass_blocks.len()));
    }
    if s.parts.len() > 1 {
        let names = |part: &Vec<usize>| part.iter().map(|i| name(*i)).collect::<Vec<_>>().join(", ");
        let parts: Vec<String> = s.parts.iter().map(names).collect();
        let run = if program.parts.is_empty() { "run together" } else { "run apart" };
        words.push(format!("{} decoupled subsystems, {run}: {}", parts.len(), parts.join("; ")));
    }
    for (i, momentum) in &s.cyclic {
        let momentum = conserved_momentum(program, *momentum);
        words.push(format!("{} is cyclic, its momentum{momentum} is conserved", name(*i)));
    }
    for direction in s.directions.iter().take(SHOWN_DIRECTIONS) {
        let names: Vec<&str> = direction.shift.iter().map(|(i, _)| name(*i)).collect();
        let ratio: Vec<String> = direction.shift.iter().map(|(_, multiple)| multiple.to_string()).collect();
        let alike = ratio.iter().all(|multiple| *multiple == ratio[0]);
        let how = if alike { "together".to_owned() } else { format!("in the ratio {}", ratio.join(" : ")) };
        let momentum = conserved_momentum(program, direction.momentum);
        words.push(format!("{} may be shifted {how}, the momentum{momentum} is conserved", names.join(", ")));
    }
    if let Some(more @ 1..) = s.directions.len().checked_sub(SHOWN_DIRECTIONS) {
        words.push(format!("{more} more directions in which coordinates may be shifted together"));
    }
    words
}

/// A momentum, with a blank before it; nothing where it is long, or would be cut off.
fn conserved_momentum(program: &Program, momentum: Id) -> String {
    let text = dalembert_symbolic::model::text(&program.model, momentum);
    if text.len() > LONGEST_MOMENTUM || text.contains('…') { String::new() } else { format!(" {text}") }
}

/// Directions of shifts that are listed; a reader sees from so many what kind they are.
const SHOWN_DIRECTIONS: usize = 5;

/// A momentum of more characters, some ten lines of a terminal, is not written out.
const LONGEST_MOMENTUM: usize = 800;

/// Operations of the generated functions.
pub fn operations(program: &Program) -> Vec<(&'static str, usize)> {
    let c = program.counts;
    vec![
        ("M", c.mass),
        ("h", c.bias),
        ("M and h", c.mass_and_bias),
        ("accelerations", c.accelerations),
        ("F", c.residual),
        ("F with its Jacobians", c.jacobians),
    ]
}
