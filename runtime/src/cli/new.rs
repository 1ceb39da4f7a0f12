//! `new`: a commented model file to start from, or a crate with one.

use std::fs;
use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::model::KEYWORDS;
use dalembert_symbolic::print::type_name;

use super::{Problem, outputs, schema};

const TEMPLATE: &str = include_str!("template.yaml");
/// The program of a crate; its model is `model.yaml`, of the type `TypeName`.
const PROGRAM: &str = include_str!("template.rs");
/// The schema that the first line of the template names; it stands beside the file.
const SCHEMA: &str = "dalembert.schema.json";

/// Writes `NAME.yaml` here, unless there is one, and its schema; or the crate `NAME`.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let name = options.get_one::<String>("name").map_or("model", String::as_str).trim_end_matches(".yaml");
    if matches!(name, "" | "-") {
        return Err(Problem::usage(format!("`{name}` names no file: `new pendulum` writes pendulum.yaml")));
    }
    if options.get_flag("crate") {
        return write_crate(name, out);
    }
    let path = format!("{name}.yaml");
    write_model(&path, &format!("simulate {path}"), out)
}

/// Writes a model file and beside it the schema, and what to try.
fn write_model(path: &str, next: &str, out: &mut dyn Write) -> Result<(), Problem> {
    refuse_what_exists(path)?;
    let stem = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    outputs::write(path, TEMPLATE.replace("TypeName", &type_name(&stem)))?;
    writeln!(out, "wrote {path}; try: {next}")?;
    let schema_path = Path::new(path).with_file_name(SCHEMA);
    if !schema_path.exists() {
        outputs::write(&schema_path.to_string_lossy(), schema::text())?;
        writeln!(out, "wrote {}, by which editors complete keys", schema_path.display())?;
    }
    Ok(())
}

/// Writes the folder of a crate: manifest, model and a program that runs it.
fn write_crate(folder: &str, out: &mut dyn Write) -> Result<(), Problem> {
    let name = package_name(folder)?;
    refuse_what_exists(folder)?;
    for within in ["src", "models"] {
        let path = format!("{folder}/{within}");
        fs::create_dir_all(&path).map_err(|problem| Problem::File(format!("cannot write `{path}`: {problem}")))?;
    }
    let program = PROGRAM.replace("model.yaml", &format!("{name}.yaml")).replace("TypeName", &type_name(&name));
    for (file, text) in [("Cargo.toml", manifest(&name)), ("src/main.rs", program)] {
        let path = format!("{folder}/{file}");
        outputs::write(&path, text)?;
        writeln!(out, "wrote {path}")?;
    }
    let run = format!("cargo run --release --manifest-path {folder}/Cargo.toml");
    write_model(&format!("{folder}/models/{name}.yaml"), &run, out)
}

fn refuse_what_exists(path: &str) -> Result<(), Problem> {
    match Path::new(path).exists() {
        true => Err(Problem::usage(format!("{path} exists already"))),
        false => Ok(()),
    }
}

/// The name of a package in this folder.
fn package_name(folder: &str) -> Result<String, Problem> {
    let name = Path::new(folder).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let fits = name.starts_with(|c: char| c.is_ascii_alphabetic())
        && name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-'))
        && !KEYWORDS.contains(&name.as_str())
        && name != "dalembert";
    match fits {
        true => Ok(name),
        false => Err(Problem::usage(format!(
            "no crate can be called `{name}` here: letters of ASCII, digits, - and _; no keyword, and not dalembert"
        ))),
    }
}

/// Where the source is from which this program was built, if it is there still, the crate takes that; else the version of the registry.
fn manifest(name: &str) -> String {
    let source = Path::new(env!("CARGO_MANIFEST_DIR"));
    let from = match source.with_file_name("Cargo.toml").exists() {
        true => format!("{{ path = '{}' }}", source.display()),
        false => format!("\"{}\"", env!("CARGO_PKG_VERSION")),
    };
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\ndalembert = {from}\n\n\
         # A workspace of its own, whatever folder it is in; in a workspace of yours this line goes.\n[workspace]\n"
    )
}
