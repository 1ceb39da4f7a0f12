//! `list`: the models that go by a name.

use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::file;
use dalembert_symbolic::model::load_in;
use serde_json::{Value, json};

use super::json::{object, write};
use super::load::folder;
use super::{Context, Problem};

/// One line a model: name, coordinates, the first sentence about it.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let width = context.models.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    let mut all = Vec::new();
    for entry in context.models {
        let model = load_in(folder(entry.path).as_deref(), entry.source, &[])
            .map_err(|problems| Problem::Model(file::render(entry.path, entry.source, &problems)))?;
        let n = model.mechanical();
        if options.get_flag("json") {
            let about = json!(model.about);
            all.push(object([("name", json!(entry.name)), ("coordinates", json!(n)), ("about", about)]));
            continue;
        }
        let about = model.about.split(". ").next().unwrap_or("").trim_end_matches('.');
        let coordinates = if n == 1 { "coordinate, " } else { "coordinates," };
        writeln!(out, "{:width$}  {n:3} {coordinates} {about}", entry.name)?;
    }
    if options.get_flag("json") {
        write(&object([("models", Value::Array(all))]), out)?;
    }
    Ok(())
}
