//! `generate`: what `model!` expands to, as a file to check in; a crate that has it needs neither the macro nor the deriver.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::model::KEYWORDS;
use dalembert_symbolic::print::Purpose;
use dalembert_symbolic::{file, print};

use super::load::{ModelFile, derived, sizes};
use super::{Context, Problem, outputs};

/// Writes the code of a model, or says where a file differs from it.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let text = |option: &str| options.get_one::<String>(option).map(String::as_str);
    let asked = text("model").unwrap_or_default();
    let path = text("output").unwrap_or("-");
    outputs::ends_in(path, &["rs"])?;
    if options.get_flag("check") && path == "-" {
        return Err(Problem::usage("--check compares with a file; name it by -o FILE.rs"));
    }
    let name = text("name").map(type_name).transpose()?;
    let model = ModelFile::named(context, asked, sizes(options)?)?;
    let program = derived(&model).map_err(|problems| model.problem(&problems))?;
    eprint!("{}", file::render(&model.path, &model.source, &program.model.warnings));
    let program = if text("methods").is_some() { program.with_series(true) } else { program };
    let command = command(options, asked, path);
    let own = print::type_name(&program.model.name);
    let purpose = if options.get_flag("no-std") { Purpose::NoStd } else { Purpose::Runs };
    let code = print::source_file(&program, &model.source, name.unwrap_or(&own), purpose, &command);
    if !options.get_flag("check") {
        outputs::put(options, &["rs"], &model.path, code.as_bytes(), out)?;
        return if path == "-" {
            Ok(())
        } else {
            Ok(writeln!(out, "wrote {path}; to declare it: #[rustfmt::skip] mod NAME;")?)
        };
    }
    let there = std::fs::read_to_string(path)
        .map_err(|e| Problem::File(format!("cannot read {path}: {e}; without --check it is written")))?;
    match print::first_difference(&there, &code) {
        None => Ok(writeln!(out, "{path} is the code of {asked}")?),
        Some((line, found, expected)) => Err(Problem::File(format!(
            "{path} is not the code of {asked}; the first line that differs is {line}:\n  there    {found}\n  expected {expected}\n\
             to renew it: {command}"
        ))),
    }
}

/// A name that a type can have.
fn type_name(name: &str) -> Result<&str, Problem> {
    let fits = name.starts_with(|c: char| c.is_alphabetic())
        && name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && !KEYWORDS.contains(&name);
    match fits {
        true => Ok(name),
        false => Err(Problem::usage(format!("--name wants the name of a Rust type, as DoublePendulum, not `{name}`"))),
    }
}

/// The command that writes the file again.
fn command(options: &ArgMatches, asked: &str, path: &str) -> String {
    let mut words = vec!["dalembert".to_owned(), "generate".to_owned(), asked.to_owned()];
    for option in ["size", "name", "methods"] {
        let given = options.get_many::<String>(option).into_iter().flatten();
        words.extend(given.flat_map(|value| [format!("--{option}"), value.clone()]));
    }
    words.extend(options.get_flag("no-std").then(|| "--no-std".to_owned()));
    if path != "-" {
        words.extend(["-o".to_owned(), path.to_owned()]);
    }
    let quoted = |word: String| if word.contains(char::is_whitespace) { format!("'{word}'") } else { word };
    words.into_iter().map(quoted).collect::<Vec<_>>().join(" ")
}
