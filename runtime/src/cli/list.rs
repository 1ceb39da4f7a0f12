//! `list`: the compiled models.

use std::io::Write;

use super::{Entry, Problem};

/// One line a model: name, coordinates, degrees of freedom, the first sentence about it.
pub fn run(models: &[Entry], out: &mut dyn Write) -> Result<(), Problem> {
    let width = models.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in models {
        let system = (entry.system)();
        let description = system.description();
        let n = description.coordinates.len();
        let about = description.about.split(". ").next().unwrap_or("").trim_end_matches('.');
        writeln!(out, "{:width$}  {n:3} coordinates, {n:3} degrees of freedom  {about}", entry.name)?;
    }
    Ok(())
}
