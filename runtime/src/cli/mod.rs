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
mod chart;
mod check;
mod compare;
mod completions;
mod drawn;
mod enforcement;
mod export;
mod families;
mod freedoms;
mod generate;
mod import;
mod json;
mod list;
mod load;
mod modes;
mod needs;
mod new;
mod orbit;
mod outputs;
mod plotted;
mod problem;
mod routh;
mod schema;
mod set_up;
mod show;
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

pub use problem::Problem;

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
    match run(models, std::env::args_os(), &mut std::io::stdout().lock()) {
        // Whoever reads has seen enough.
        Ok(()) | Err(Problem::Closed) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(problem.status())
        }
    }
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
    let matches = match arguments::command().try_get_matches_from(arguments) {
        Ok(matches) => matches,
        Err(error) if !error.use_stderr() => {
            write!(out, "{error}")?;
            return Ok(());
        }
        Err(error) => return Err(Problem::Usage(error.to_string())),
    };
    let Some((command, options)) = matches.subcommand() else {
        return Err(Problem::Usage(arguments::command().render_help().to_string()));
    };
    let mut nothing = std::io::sink();
    let out = if outputs::is_quiet(options) { &mut nothing } else { out };
    match command {
        "list" => list::run(models, out),
        "show" => show::run(models, options, out),
        "export" => export::run(models, options, out),
        "generate" => generate::run(models, options, out),
        "check" => check::run(models, options, out),
        "simulate" => simulate::run(models, options, out),
        "orbit" => orbit::run(models, options, out),
        "solve" => solve::run(models, options, out),
        "chart" => chart::run(models, options, out),
        "stability" => stability::run(options, out),
        "sweep" => sweep::run(models, options, out),
        "modes" => modes::run(models, options, out),
        "needs" => needs::run(models, options, out),
        "new" => new::run(options, out),
        "import" => import::run(options, out),
        "schema" => schema::run(options, out),
        "completions" => completions::run(models, options, out),
        other => Err(Problem::Usage(format!("error: no command is called `{other}`"))),
    }
}
