//! `list`: the compiled models.

use std::io::Write;

use super::{Entry, Problem};

/// One line a model: name, degrees of freedom (without constraints as many as coordinates), the first sentence about it.
pub fn run(models: &[Entry], out: &mut dyn Write) -> Result<(), Problem> {
    let width = models.iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    for entry in models {
        let system = (entry.system)();
        let description = system.description();
        let n = description.mechanical();
        let about = description.about.split(". ").next().unwrap_or("").trim_end_matches('.');
        let freedom = if n == 1 { "degree of freedom, " } else { "degrees of freedom," };
        writeln!(out, "{:width$}  {n:3} {freedom} {about}", entry.name)?;
    }
    Ok(())
}
