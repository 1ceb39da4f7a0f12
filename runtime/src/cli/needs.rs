//! `needs`: what a scene can do without.

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::file;

use super::load::{Loaded, folder};
use super::{Entry, Problem, outputs};
use crate::needs::{Need, Needs, Question, Unanswered};

/// Tries every ingredient of a model, prints what a scene does without, and writes the smaller file.
pub fn run(models: &[Entry], options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let loaded = Loaded::find(models, options)?;
    outputs::check(options, &["write"], &loaded.path)?;
    let question = question(&loaded, options)?;
    let shown = std::io::stderr().is_terminal();
    let found = Needs::find(&question, &mut |name| {
        if shown {
            eprint!("\r{name}\x1b[K");
        }
        ControlFlow::Continue(())
    });
    if shown {
        eprint!("\r\x1b[K");
    }
    let found = found.map_err(|unanswered| match unanswered {
        Unanswered::Model { problems } => Problem::Model(file::render(&loaded.path, &loaded.source, &problems)),
        Unanswered::Fails { .. } | Unanswered::NotKnown { .. } => Problem::Run(unanswered.to_string()),
        other => Problem::Usage(format!("error: {other}")),
    })?;
    write!(out, "{}", found.table())?;
    if let Some(path) = options.get_one::<String>("write") {
        match found.smaller_file() {
            Some(text) => {
                std::fs::write(path, text)
                    .map_err(|problem| Problem::File(format!("cannot write `{path}`: {problem}")))?;
                writeln!(out, "written: {path}")?;
            }
            None => writeln!(out, "nothing is written")?,
        }
    }
    Ok(())
}

/// What the options ask of the file; what they leave out the scene says.
fn question(loaded: &Loaded, options: &ArgMatches) -> Result<Question, Problem> {
    let own = |option: &str| options.get_one::<String>(option).cloned();
    let mut question = Question {
        sizes: loaded.sizes.clone(),
        folder: folder(&loaded.path).map(Path::to_owned),
        scene: own("scene"),
        all: options.get_flag("all"),
        ..Question::new(loaded.source.as_str())
    };
    let (names, within) = (own("needs"), own("within"));
    if names.is_none() && within.is_none() {
        return Ok(question);
    }
    let said = question.need().map_err(|unanswered| Problem::Usage(format!("error: {unanswered}")))?;
    let outputs = names.map_or(said.outputs, |names| {
        names.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
    });
    let within = match within {
        None => said.within,
        Some(text) => text.trim().parse().map_err(|_| {
            Problem::Usage(format!("error: --within wants a part of the range of each, such as 1e-3, not `{text}`"))
        })?,
    };
    question.need = Some(Need { outputs, within });
    Ok(question)
}
