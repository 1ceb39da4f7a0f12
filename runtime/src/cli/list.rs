//! `list`: the models that go by a name.

use std::io::Write;

use dalembert_symbolic::file;
use dalembert_symbolic::model::load_in;

use super::load::folder;
use super::{Context, Problem};

/// One line a model: name, degrees of freedom (without constraints as many as coordinates), the first sentence about it.
pub fn run(context: Context<'_>, out: &mut dyn Write) -> Result<(), Problem> {
    let width = context.models.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in context.models {
        let model = load_in(folder(entry.path), entry.source, &[])
            .map_err(|problems| Problem::Model(file::render(entry.path, entry.source, &problems)))?;
        let n = model.mechanical();
        let about = model.about.split(". ").next().unwrap_or("").trim_end_matches('.');
        let freedom = if n == 1 { "degree of freedom, " } else { "degrees of freedom," };
        writeln!(out, "{:width$}  {n:3} {freedom} {about}", entry.name)?;
    }
    Ok(())
}
