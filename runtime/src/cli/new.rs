//! `new`: a commented model file to start from.

use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::print::type_name;

use super::Problem;

const TEMPLATE: &str = include_str!("template.yaml");

/// Writes `NAME.yaml` here, unless there is one.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let name = options.get_one::<String>("name").map_or("model", String::as_str).trim_end_matches(".yaml");
    let path = format!("{name}.yaml");
    if Path::new(&path).exists() {
        return Err(Problem::Usage(format!("error: {path} exists already")));
    }
    let stem = Path::new(name).file_stem().map_or(name.to_owned(), |s| s.to_string_lossy().into_owned());
    std::fs::write(&path, TEMPLATE.replace("TypeName", &type_name(&stem)))?;
    writeln!(out, "wrote {path}; try: simulate {path}")?;
    Ok(())
}
