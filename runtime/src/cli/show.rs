//! `show`: the derived equations as text, in LaTeX, as JSON; the generated Rust, C, or a module for Python.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::expr::Id;
use dalembert_symbolic::lower::Program;
use dalembert_symbolic::model::Model;
use dalembert_symbolic::{file, print};
use serde_json::Value;

use super::load::{Loaded, pairs};
use super::{Context, Problem, check, initial_phases, json, outputs};

/// Prints M, h, constraints and what was recognised; with `--rust`, `--python` or `--c` code.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let loaded = Loaded::find(context, options)?;
    let mut text = Vec::new();
    print_form(&loaded, options, &mut text)?;
    let form = ["rust", "latex", "python", "c", "json"].into_iter().find(|form| options.get_flag(form));
    let endings: &[&str] = match form {
        Some("rust") => &["rs"],
        Some("latex") => &["tex"],
        Some("python") => &["py"],
        Some("c") => &["c"],
        Some("json") => &["json"],
        _ => &["txt", "md"],
    };
    outputs::put(options, endings, &loaded.path, &text, out)
}

/// Prints what the options ask for.
fn print_form(loaded: &Loaded, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut program = loaded.program()?;
    if options.get_flag("python") || options.get_flag("c") {
        initial_phases::decide(&mut program, loaded);
    }
    let model = &program.model;
    if options.get_flag("rust") {
        let name = print::type_name(&model.name);
        write!(out, "{}", print::rust(&program, &loaded.source, &name))?;
        return Ok(());
    }
    if options.get_flag("python") && !program.model.states.is_empty() {
        return Err(Problem::usage(
            "--python does not print states of first order yet; --rust does, and `modes --json` has A and B",
        ));
    }
    if options.get_flag("python") {
        write!(out, "{}", print::python(&program, &loaded.name))?;
        return Ok(());
    }
    if options.get_flag("c") {
        write!(out, "{}", print::c(&program, &loaded.name).whole())?;
        return Ok(());
    }
    if options.get_flag("linear") {
        return linear(&program, options, out);
    }
    let reading = print::Reading::of(&program);
    if options.get_flag("latex") {
        write!(out, "{}", reading.latex(model))?;
        return Ok(());
    }
    if options.get_flag("json") {
        let text = |text: &str| Value::String(text.to_owned());
        let unit = |unit: &Option<String>| unit.as_ref().map_or(Value::Null, |unit| Value::String(unit.clone()));
        let coordinates = model.coordinates[..model.mechanical()]
            .iter()
            .map(|c| json::object([("name", text(&c.name)), ("unit", unit(&c.unit))]));
        let parameters = model.parameters.iter().map(|p| {
            let default = json::number(p.default);
            json::object([("name", text(&p.name)), ("unit", unit(&p.unit)), ("default", default)])
        });
        let equations = reading.lines(model).into_iter().map(|(left, right)| (left, Value::String(right)));
        let object = json::object([
            ("name", text(&model.name)),
            ("about", text(model.about.trim())),
            ("coordinates", coordinates.collect()),
            ("parameters", parameters.collect()),
            ("equations", json::object(equations)),
            ("recognised", check::recognised(&program).into()),
            ("operations", json::object(check::operations(&program).into_iter().map(|(k, n)| (k, n.into())))),
        ]);
        json::write(&object, out)?;
        return Ok(());
    }
    writeln!(out, "{}", model.name)?;
    if !model.about.is_empty() {
        writeln!(out, "{}", model.about.trim())?;
    }
    let equations = reading.equations(model);
    if !equations.is_empty() {
        write!(out, "\nequations of motion\n{equations}")?;
    }
    write!(out, "\n{}", reading.text(model))?;
    writeln!(out, "\ncomputed from {}", program.choice)?;
    if let Some(elimination) = &program.elimination {
        writeln!(out, "  {}", elimination.words())?;
    }
    check::structure(&program, out)
}

/// Prints M, C, K and B about the file's equilibrium or that of `--at`, as expressions of the parameters.
fn linear(program: &Program, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let mut model = program.model.clone();
    let mut place = model.equilibrium.clone().unwrap_or_else(|| model.unsaid_place());
    for (name, text) in pairs(options, "at")? {
        let Some(coordinate) = model.coordinates.iter().position(|known| known.name == name) else {
            let names: Vec<&str> = model.coordinates.iter().map(|c| c.name.as_str()).collect();
            let names = names.join(", ");
            return Err(Problem::usage(format!("--at: no coordinate is called `{name}`; there are {names}")));
        };
        place[coordinate] = expression(&mut model, &text)?;
    }
    let linear = print::Linearisation::about(program, &mut model, &place).map_err(Problem::usage)?;
    let text = if options.get_flag("latex") { linear.latex(&model) } else { linear.text(&model) };
    write!(out, "{text}")?;
    Ok(())
}

/// A number of one component from the command line, as an expression.
fn expression(model: &mut Model, text: &str) -> Result<Id, Problem> {
    let components =
        model.expression(text).map_err(|problems| Problem::Usage(file::render("--at", text, &problems)))?;
    match components[..] {
        [value] => Ok(value),
        _ => Err(Problem::usage(format!("--at wants a number, `{text}` is a vector"))),
    }
}
