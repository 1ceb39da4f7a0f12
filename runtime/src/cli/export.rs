//! `export`: a model as files for other programs.

use std::fs;
use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::print;

use super::load::Loaded;
use super::{Entry, Problem};

/// Writes what was asked for.
pub fn run(models: &[Entry], options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let loaded = Loaded::find(models, options)?;
    if let Some(folder) = options.get_one::<String>("c") {
        let program = loaded.program()?;
        let code = print::c(&program, &loaded.name);
        let name = &code.prefix;
        let files = [
            (format!("{name}.h"), code.header.clone()),
            (format!("{name}.c"), code.file()),
            ("dalembert_core.h".to_owned(), print::CORE_HEADER.to_owned()),
            ("dalembert_core.c".to_owned(), format!("#include \"dalembert_core.h\"\n\n{}", print::CORE_SOURCE)),
        ];
        let folder = Path::new(folder);
        fs::create_dir_all(folder)?;
        for (file, text) in &files {
            fs::write(folder.join(file), text)?;
        }
        let names: Vec<&str> = files.iter().map(|(file, _)| file.as_str()).collect();
        writeln!(out, "wrote {} to {}", names.join(", "), folder.display())?;
    }
    Ok(())
}
