//! `export`: a model as files for other programs, C99 or an FMU.

mod description;
mod fmu;
mod tables;

use std::fs;
use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::print::{self, CText};

use self::description::Start;
use self::fmu::{Fmi, NoLibrary};
use super::load::Loaded;
use super::set_up::set_up;
use super::{Context, Problem, initial_phases, outputs};
use crate::initial_state;

/// Tolerances of an FMU's own integration are no tighter: beyond them its method of order 5 takes too many steps.
const TIGHTEST: f64 = 1e-10;

/// Writes what was asked for.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let of_scene = ["scene", "set", "params", "start", "input", "until", "tolerance"];
    if let Some(option) = of_scene.into_iter().find(|option| options.contains_id(option))
        && !options.contains_id("fmu")
    {
        return Err(Problem::usage(format!(
            "--{option}: C has parameters and scenes as the file says, and takes others where it runs (`NAME_parameters`)"
        )));
    }
    let mut loaded = Loaded::find(context, options)?;
    loaded.tell_warnings();
    let mut program = loaded.program()?;
    initial_phases::decide(&mut program, &loaded);
    let code = print::c(&program, &loaded.name);
    outputs::check(options, &["fmu"], &loaded.path)?;
    if let Some(folder) = options.get_one::<String>("c") {
        c(&code, Path::new(folder), out)?;
    }
    if let Some(path) = options.get_one::<String>("fmu") {
        if options.contains_id("input") {
            return Err(Problem::usage("--input: inputs of an FMU are set by the program that runs it"));
        }
        let start = start(&mut loaded, options)?;
        let two = options.get_one::<String>("fmi").is_some_and(|version| version == "2");
        let fmu = fmu::fmu(if two { Fmi::Two } else { Fmi::Three }, &program, &code, &start)?;
        outputs::write(path, fmu.bytes)?;
        match fmu.without_library {
            None => writeln!(out, "wrote {path}")?,
            Some(NoLibrary::Impossible(reason)) => writeln!(out, "wrote {path}, sources only: {reason}")?,
            Some(NoLibrary::Refused(reason)) => {
                return Err(Problem::File(format!("wrote {path}, sources only: {reason}")));
            }
        }
    }
    Ok(())
}

fn c(code: &CText, folder: &Path, out: &mut dyn Write) -> Result<(), Problem> {
    let name = &code.prefix;
    let files = [
        (format!("{name}.h"), code.header.clone()),
        (format!("{name}.c"), code.file()),
        ("dalembert_core.h".to_owned(), print::CORE_HEADER.to_owned()),
        ("dalembert_core.c".to_owned(), print::core_file()),
    ];
    fs::create_dir_all(folder)
        .map_err(|problem| Problem::File(format!("--c: cannot make the folder `{}`: {problem}", folder.display())))?;
    for (file, text) in &files {
        outputs::write(&folder.join(file).to_string_lossy(), text)?;
    }
    let names: Vec<&str> = files.iter().map(|(file, _)| file.as_str()).collect();
    writeln!(out, "wrote {} to {}", names.join(", "), folder.display())?;
    Ok(())
}

/// Where a scene starts, on its constraints.
fn start(loaded: &mut Loaded, options: &ArgMatches) -> Result<Start, Problem> {
    let settings = set_up(loaded, options)?;
    let system = &mut *loaded.system;
    let memory = settings.memory.clone().unwrap_or_else(|| system.scene_memory(0));
    let mut inputs = vec![0.0; 3 * system.description().inputs.len()];
    system.inputs(settings.from, &mut inputs);
    // What happens at the start is left to the FMU.
    let first = initial_state(system, &settings).map_err(|error| Problem::Run(error.to_string()))?;
    Ok(Start {
        token: format!("{{{:016x}}}", print::fnv1a(&loaded.source)),
        parameters: system.parameters(),
        q: first.q,
        v: first.v,
        memory,
        inputs,
        phase: settings.phase,
        until: settings.until,
        span: settings.until - settings.from,
        tolerance: settings.tolerance.max(TIGHTEST),
    })
}
