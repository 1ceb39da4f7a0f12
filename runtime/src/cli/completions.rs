//! `completions`: what shells need to complete the program's words.

use std::io::Write;

use clap::ArgMatches;
use clap_complete::Shell;

use super::arguments::completed;
use super::{Context, Problem};

/// Writes the script with which a shell completes what is typed after the program's name.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let Some(shell) = options.get_one::<Shell>("shell") else { return Ok(()) };
    let names: Vec<&str> = context.models.iter().map(|model| model.name).collect();
    let mut script = Vec::new();
    clap_complete::generate(*shell, &mut completed(&names), "dalembert", &mut script);
    Ok(out.write_all(&script)?)
}
