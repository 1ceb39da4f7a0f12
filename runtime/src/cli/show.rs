//! `show`: the derived equations, or the generated Rust.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::{model, print};

use super::load::Loaded;
use super::{Entry, Problem, check};

/// Prints M, h and what was recognised; with `--rust` the generated code.
pub fn run(models: &[Entry], options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let loaded = Loaded::find(models, options)?;
    let program = loaded.program()?;
    if options.get_flag("rust") {
        let name = print::type_name(&program.model.name);
        write!(out, "{}", print::rust(&program, &loaded.source, &name))?;
        return Ok(());
    }
    let model = &program.model;
    writeln!(out, "{}", model.name)?;
    if !model.about.is_empty() {
        writeln!(out, "{}", model.about.trim())?;
    }
    writeln!(out, "\nM q'' + h = 0, with ({})", program.choice)?;
    let name = |i: usize| &model.coordinates[i].name;
    for (i, j, m) in &program.mass {
        writeln!(out, "  M[{}, {}] = {}", name(*i), name(*j), model::text(model, *m))?;
    }
    for (i, h) in program.bias.iter().enumerate() {
        writeln!(out, "  h[{}] = {}", name(i), model::text(model, *h))?;
    }
    writeln!(out)?;
    check::recognised(&program, out)
}
