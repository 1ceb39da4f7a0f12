//! A model as an FMU of FMI 3.0 or 2.0: its C, what an instance of it does, and, where there is a C compiler, the library made of both.

use std::path::Path;
use std::process::{Command, Stdio};

use dalembert_symbolic::expr::{Id, Symbol};
use dalembert_symbolic::lower::{InputJump, Program};
use dalembert_symbolic::print::{self, CText};

use super::super::Problem;
use super::super::zip;
use super::description::{Start, description};
use super::tables;

/// The version of FMI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fmi {
    /// 2.0.
    Two,
    /// 3.0.
    Three,
}

impl Fmi {
    /// Its functions in C.
    fn functions(self) -> (&'static str, &'static str) {
        match self {
            Fmi::Two => ("fmi2_functions.c", include_str!("fmu/fmi2_functions.c")),
            Fmi::Three => ("fmi3_functions.c", include_str!("fmu/fmi3_functions.c")),
        }
    }

    /// What it calls Linux on x86-64.
    fn platform(self) -> &'static str {
        match self {
            Fmi::Two => "linux64",
            Fmi::Three => "x86_64-linux",
        }
    }
}

/// The C that all FMUs share.
const SHARED: [(&str, &str); 5] = [
    ("fmu_instance.h", include_str!("fmu/fmu_instance.h")),
    ("fmu_instance.c", include_str!("fmu/fmu_instance.c")),
    ("fmu_integrate.c", include_str!("fmu/fmu_integrate.c")),
    ("fmu_calls.h", include_str!("fmu/fmu_calls.h")),
    ("fmu_calls.c", include_str!("fmu/fmu_calls.c")),
];

/// What was written, and of the library why it was not.
pub struct Fmu {
    /// The archive.
    pub bytes: Vec<u8>,
    /// Why it has no library.
    pub without_library: Option<NoLibrary>,
}

/// Why an FMU has no library.
pub enum NoLibrary {
    /// None can be made here.
    Impossible(String),
    /// A compiler did not take the sources.
    Refused(String),
}

/// The FMU of a model.
///
/// # Errors
/// What the model has that an FMU cannot do.
pub fn fmu(fmi: Fmi, program: &Program, code: &CText, start: &Start) -> Result<Fmu, Problem> {
    refuse(program)?;
    let name = &code.prefix;
    let mut sources = vec![
        (format!("{name}.h"), code.header.clone()),
        (format!("{name}.c"), code.file()),
        ("dalembert_core.h".to_owned(), print::CORE_HEADER.to_owned()),
        ("dalembert_core.c".to_owned(), print::core_file()),
        ("fmu_description.h".to_owned(), tables::tables(program, code, start)),
    ];
    let shared = SHARED.into_iter().chain([fmi.functions()]);
    sources.extend(shared.map(|(file, text)| (file.to_owned(), text.to_owned())));
    let library = library(name, &sources);
    let compiled: Vec<String> =
        sources.iter().map(|(file, _)| file.clone()).filter(|file| file.ends_with(".c")).collect();
    let text = description(fmi, program, code, start, &compiled);
    let mut files = vec![("modelDescription.xml".to_owned(), text.into_bytes())];
    if fmi == Fmi::Three {
        files.push(("sources/buildDescription.xml".to_owned(), build(name, &compiled).into_bytes()));
    }
    files.extend(sources.into_iter().map(|(file, text)| (format!("sources/{file}"), text.into_bytes())));
    let without_library = match library {
        Ok(bytes) => {
            files.push((format!("binaries/{}/{name}.so", fmi.platform()), bytes));
            None
        }
        Err(reason) => Some(reason),
    };
    Ok(Fmu { bytes: zip::stored(&files), without_library })
}

/// Refuses what only this program's runs do.
fn refuse(program: &Program) -> Result<(), Problem> {
    let model = &program.model;
    if let Some(contact) = model.contacts.first() {
        return Err(Problem::usage(format!(
            "`{}`: what contacts and friction that sticks do together is decided by a run of this program, not by an FMU; write \
             its `phases` and `events` out, or take the equations with export --c",
            contact.name
        )));
    }
    let sharp = program.switches.iter().any(|switch| switch.of_input);
    let jump = program.jumps.iter().position(|jump| *jump != InputJump::Force);
    if let Some(input) = jump.filter(|_| sharp) {
        return Err(Problem::usage(format!(
            "`{}` may jump or turn sharply, and its rates stand in the equations: such impulses are part of a run of this \
             program, not of an FMU; write a smooth input",
            model.inputs[input].name
        )));
    }
    Ok(())
}

/// The inputs' rates that anything contains, and those by which these change: (input, order).
pub fn used_rates(program: &Program) -> Vec<(usize, usize)> {
    let constraints = &program.constraints;
    let lists: [&[Id]; 7] = [
        &program.residual,
        &program.outputs,
        &program.events,
        &program.assignments,
        &program.switch_pairs,
        &constraints.bias,
        &constraints.values,
    ];
    let symbols = program.model.graph.symbols(lists.concat());
    let inputs = 0..program.model.inputs.len();
    let orders = inputs.flat_map(|input| (1..3).map(move |order| (input, order)));
    let contains = |input: usize, order: usize| symbols.contains(&Symbol::Input(input as u32, order as u8));
    orders.filter(|(input, order)| (*order..3).any(|order| contains(*input, order))).collect()
}

fn build(name: &str, sources: &[String]) -> String {
    let files: String = sources.iter().map(|file| format!("      <SourceFile name=\"{file}\"/>\n")).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration modelIdentifier=\"{name}\">\n    <SourceFileSet language=\"C99\">\n{files}    </SourceFileSet>\n  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
}

/// The library for Linux on x86-64.
fn library(name: &str, sources: &[(String, String)]) -> Result<Vec<u8>, NoLibrary> {
    let impossible = |reason: &str| NoLibrary::Impossible(reason.to_owned());
    if !cfg!(all(target_os = "linux", target_arch = "x86_64")) {
        return Err(impossible("a library is compiled on Linux on x86-64 only"));
    }
    let known = |compiler: &&str| {
        let tried = Command::new(compiler).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        tried.is_ok_and(|status| status.success())
    };
    let compiler =
        ["cc", "gcc", "clang"].into_iter().find(known).ok_or_else(|| impossible("there is no C compiler"))?;
    let folder = std::env::temp_dir().join(format!("dalembert-fmu-{}-{name}", std::process::id()));
    let compiled = compile(compiler, &folder, name, sources);
    let removed = std::fs::remove_dir_all(&folder);
    let bytes = compiled.map_err(NoLibrary::Refused)?;
    removed.map_err(|error| NoLibrary::Refused(error.to_string()))?;
    Ok(bytes)
}

fn compile(compiler: &str, folder: &Path, name: &str, sources: &[(String, String)]) -> Result<Vec<u8>, String> {
    std::fs::create_dir_all(folder).map_err(|error| error.to_string())?;
    for (file, text) in sources {
        std::fs::write(folder.join(file), text).map_err(|error| error.to_string())?;
    }
    let library = folder.join(format!("{name}.so"));
    let files = sources.iter().filter(|(file, _)| file.ends_with(".c")).map(|(file, _)| folder.join(file));
    let done = Command::new(compiler)
        .args(["-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden", "-o"])
        .arg(&library)
        .args(files)
        .arg("-lm")
        .output()
        .map_err(|error| error.to_string())?;
    if !done.status.success() {
        return Err(format!("{compiler} failed: {}", String::from_utf8_lossy(&done.stderr)));
    }
    std::fs::read(&library).map_err(|error| error.to_string())
}
