//! `new`: a commented model file to start from.

use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::print::type_name;

use super::{Problem, outputs, schema};

const TEMPLATE: &str = include_str!("template.yaml");
/// The schema that the first line of the template names; it stands beside the file.
const SCHEMA: &str = "dalembert.schema.json";

/// Writes `NAME.yaml` here, unless there is one, and its schema.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let name = options.get_one::<String>("name").map_or("model", String::as_str).trim_end_matches(".yaml");
    if matches!(name, "" | "-") {
        return Err(Problem::usage(format!("`{name}` names no file: `new pendulum` writes pendulum.yaml")));
    }
    let path = format!("{name}.yaml");
    if Path::new(&path).exists() {
        return Err(Problem::usage(format!("{path} exists already")));
    }
    let stem = Path::new(name).file_stem().map_or(name.to_owned(), |s| s.to_string_lossy().into_owned());
    outputs::write(&path, TEMPLATE.replace("TypeName", &type_name(&stem)))?;
    writeln!(out, "wrote {path}; try: simulate {path}")?;
    let schema_path = Path::new(&path).with_file_name(SCHEMA);
    if !schema_path.exists() {
        outputs::write(&schema_path.to_string_lossy(), schema::text())?;
        writeln!(out, "wrote {}, by which editors complete keys", schema_path.display())?;
    }
    Ok(())
}
