//! The command line, for any list of models.
//!
//! A crate gets the program for its own models in three lines:
//!
//! ```ignore
//! fn main() -> std::process::ExitCode {
//!     dalembert::cli::main(MODELS)
//! }
//! ```
//!
//! Exit codes are those that `--help` states (`arguments.rs`).

mod arguments;
mod arrows;
mod chart;
mod check;
mod compare;
mod completions;
mod contacts;
mod context;
mod drawn;
mod enforcement;
mod export;
mod families;
mod freedoms;
mod generate;
mod help;
mod import;
mod initial_phases;
mod json;
mod list;
mod load;
mod mat;
mod modes;
mod needs;
mod new;
mod npz;
mod orbit;
mod outputs;
mod plotted;
mod problem;
mod routh;
mod schema;
mod session;
mod set_up;
mod show;
mod signals;
mod simulate;
mod slopes;
mod solve;
mod stability;
mod stability_maps;
mod sweep;
mod symmetries;
mod value_files;
mod zip;

use std::process::ExitCode;

use crate::mechanism::System;
use context::Context;

pub use problem::Problem;
pub use session::{Answer, Kept, LoadError, Session, Simulated, stated_name};

/// A model that goes by its name.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The file's name without `.yaml`.
    pub name: &'static str,
    /// The file's text when the program was built.
    pub source: &'static str,
    /// Where the file is.
    pub path: &'static str,
    /// A system with the file's parameters, where it was compiled with the program; else the file is derived anew and interpreted.
    pub compiled: Option<fn() -> Box<dyn System>>,
}

/// Runs the program with the process's arguments.
pub fn main(models: &[Entry]) -> ExitCode {
    ExitCode::from(status(models, std::env::args_os()))
}

/// Runs the program with these arguments (the first is the program's name), on standard output and standard error; its exit code.
pub fn status(models: &[Entry], arguments: impl IntoIterator<Item = impl Into<std::ffi::OsString> + Clone>) -> u8 {
    let arguments: Vec<std::ffi::OsString> = arguments.into_iter().map(Into::into).collect();
    signals::listen(is_json(&arguments));
    // Not locked, so that a signal may print too.
    match run(models, arguments, &mut std::io::stdout()) {
        // Whoever reads has seen enough.
        Ok(()) | Err(Problem::Closed) => 0,
        Err(problem) => {
            eprintln!("{problem}");
            problem.status()
        }
    }
}

/// The commands and their options, for what writes man pages of them.
#[doc(hidden)]
pub fn command_line() -> clap::Command {
    arguments::command()
}

/// Runs the program with these arguments (the first is the program's name) and writes to `out`.
///
/// # Errors
/// Bad usage, a bad model file, or a run that failed.
pub fn run(
    models: &[Entry],
    arguments: impl IntoIterator<Item = impl Into<std::ffi::OsString> + Clone>,
    out: &mut dyn std::io::Write,
) -> Result<(), Problem> {
    command(Context::of(models), arguments, out)
}

/// Whether these arguments ask for JSON, whatever else is wrong with them.
fn is_json(arguments: &[std::ffi::OsString]) -> bool {
    arguments.iter().take_while(|argument| *argument != "--").any(|argument| argument == "--json")
}

fn command(
    context: Context<'_>,
    arguments: impl IntoIterator<Item = impl Into<std::ffi::OsString> + Clone>,
    out: &mut dyn std::io::Write,
) -> Result<(), Problem> {
    let arguments: Vec<std::ffi::OsString> = arguments.into_iter().map(Into::into).collect();
    let as_json = is_json(&arguments);
    let matches = match arguments::parsed(arguments) {
        Ok(matches) => matches,
        Err(error) if !error.use_stderr() => {
            write!(out, "{error}")?;
            return Ok(());
        }
        Err(error) => return failed(Problem::Usage(error.to_string()), as_json, out),
    };
    let Some((command, options)) = matches.subcommand() else {
        return Err(Problem::Usage(arguments::command().render_help().to_string()));
    };
    let mut nothing = std::io::sink();
    let out = if outputs::is_quiet(command, options) { &mut nothing } else { out };
    let mut counted = outputs::Counted { out, bytes: 0 };
    let outcome = answer(context, command, options, &mut counted);
    match outcome {
        Err(problem) if counted.bytes == 0 => failed(problem, outputs::wants(options, "json"), &mut counted),
        outcome => outcome,
    }
}

/// A command that fails prints one object all the same.
fn failed(problem: Problem, as_json: bool, out: &mut dyn std::io::Write) -> Result<(), Problem> {
    match as_json {
        true => json::write_outcome(json::object::<&str>([]), Err(problem), out),
        false => Err(problem),
    }
}

fn answer(
    context: Context<'_>,
    command: &str,
    options: &clap::ArgMatches,
    out: &mut dyn std::io::Write,
) -> Result<(), Problem> {
    match command {
        "list" => list::run(context, options, out),
        "show" => show::run(context, options, out),
        "export" => export::run(context, options, out),
        "generate" => generate::run(context, options, out),
        "check" => check::run(context, options, out),
        "simulate" => simulate::run(context, options, out),
        "orbit" => orbit::run(context, options, out),
        "solve" => solve::run(context, options, out),
        "chart" => chart::run(context, options, out),
        "stability" => stability::run(options, out),
        "sweep" => sweep::run(context, options, out),
        "modes" => modes::run(context, options, out),
        "needs" => needs::run(context, options, out),
        "new" => new::run(options, out),
        "import" => import::run(options, out),
        "schema" => schema::run(options, out),
        "completions" => completions::run(context, options, out),
        other => Err(Problem::usage(format!("no command is called `{other}`"))),
    }
}
