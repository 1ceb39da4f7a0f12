//! Finding a model: one of the library by its name, compiled where the program has it so; or any file, by path, interpreted.

use std::io::{IsTerminal, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use clap::ArgMatches;
use dalembert_symbolic::file::Node;
use dalembert_symbolic::lower::{Program, compile_for_runs_from, compile_from};
use dalembert_symbolic::model::{Files, Model, load_from};
use dalembert_symbolic::print::fnv1a;
use dalembert_symbolic::{diagnose, file};

use super::plotted::filled_parts;
use super::set_up::unknown;
use super::{Context, Entry, Problem};
use crate::mechanism::{Interpreted, System};
use crate::precision::DoubleOnly;

/// A model file, whatever is wrong with it.
#[derive(Clone)]
pub struct ModelFile {
    /// The name it goes by: its file's.
    pub name: String,
    /// Where its file is.
    pub path: String,
    /// What stands in it; where its code was compiled with the program, what stood in it then.
    pub source: String,
    /// Sizes other than the file's.
    pub sizes: Vec<(String, i64)>,
    /// The files that it names.
    pub files: Files,
}

impl ModelFile {
    /// The text of the model of this name or path, whatever is wrong with it.
    pub fn named(context: Context<'_>, name: &str, sizes: Vec<(String, i64)>) -> Result<ModelFile, Problem> {
        if let Some(kept) = context.kept(name) {
            let sizes = if sizes.is_empty() { kept.sizes.clone() } else { sizes };
            return ModelFile { sizes, ..kept.file() }.with_known_sizes();
        }
        let models = context.models;
        if let Some(entry) = models.iter().find(|entry| entry.name == name) {
            let now = || std::fs::read_to_string(entry.path).ok();
            let source = if entry.compiled.is_some() { None } else { now() };
            let (path, source) = (entry.path.to_owned(), source.unwrap_or_else(|| entry.source.to_owned()));
            return ModelFile::of(name.to_owned(), path, source, sizes).with_known_sizes();
        }
        ModelFile::read(models, name, sizes)?.with_known_sizes()
    }

    /// Refuses sizes that the file does not have, as other names on the command line; of a file that is no YAML its own mistakes are told.
    fn with_known_sizes(self) -> Result<ModelFile, Problem> {
        if self.sizes.is_empty() {
            return Ok(self);
        }
        let Ok(Node::Map(sections)) = file::read(&self.source) else { return Ok(self) };
        let known = sections.iter().find(|(key, _)| key == "sizes").map(|(_, sizes)| sizes);
        let known: Vec<&str> = match known {
            Some(Node::Map(sizes)) => sizes.iter().map(|(name, _)| name.as_str()).collect(),
            _ => Vec::new(),
        };
        match self.sizes.iter().find(|(name, _)| !known.contains(&name.as_str())) {
            Some((name, _)) => Err(unknown("size", name, known.iter().copied())),
            None => Ok(self),
        }
    }

    /// A text at a path, beside which the files are that it names.
    pub fn of(name: String, path: String, source: String, sizes: Vec<(String, i64)>) -> ModelFile {
        let files = Files::of_folder(folder(&path).as_deref());
        ModelFile { name, path, source, sizes, files }
    }

    /// What is wrong with it, to print.
    pub fn problem(&self, problems: &[diagnose::Problem]) -> Problem {
        Problem::Model(file::render(&self.path, &self.source, problems))
    }

    /// The derived model as runs have it: that of the model that is kept, if it is this one.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn for_runs(&self, context: Context<'_>) -> Result<Program, Vec<diagnose::Problem>> {
        let kept = context.kept(&self.name).filter(|kept| kept.source == self.source && kept.sizes == self.sizes);
        match kept.and_then(Loaded::for_runs) {
            Some(program) => Ok(program),
            None => derived_for_runs(self),
        }
    }

    fn read(models: &[Entry], name: &str, sizes: Vec<(String, i64)>) -> Result<ModelFile, Problem> {
        if name == "-" {
            let (name, path, source) = ("stdin".to_owned(), "-".to_owned(), standard_input()?);
            return Ok(ModelFile::of(name, path, source, sizes));
        }
        let path = Path::new(name);
        if path.is_dir() {
            return Err(Problem::usage(format!("`{name}` is a folder; name a model file in it")));
        }
        if !path.exists() {
            return Err(Problem::usage(format!("no model and no file is called `{name}`; {}", meant(models, name))));
        }
        let bytes = std::fs::read(name).map_err(|e| Problem::unread(name, &e))?;
        let source = String::from_utf8(bytes).map_err(|e| Problem::File(not_utf8(name, e.as_bytes())))?;
        let stem = Path::new(name).file_stem().map_or(name.to_owned(), |s| s.to_string_lossy().into_owned());
        Ok(ModelFile::of(stem, name.to_owned(), source, sizes))
    }
}

/// What a name that nothing has may stand for.
fn meant(models: &[Entry], name: &str) -> String {
    let beside = ["yaml", "yml"].map(|ending| format!("{name}.{ending}"));
    if let Some(file) = beside.iter().find(|file| Path::new(file).is_file()) {
        return format!("did you mean the file `{file}`?");
    }
    let near = diagnose::did_you_mean(name, models.iter().map(|entry| entry.name));
    if near.is_empty() { "`list` names the models".to_owned() } else { near }
}

/// What is said of a text in another encoding than that of YAML.
pub(super) fn not_utf8(path: &str, bytes: &[u8]) -> String {
    let wide = bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]);
    let from = if wide { "UTF-16" } else { "LATIN1" };
    let is = if wide { "UTF-16, not UTF-8" } else { "not UTF-8" };
    format!("{path} is {is}; `iconv -f {from} -t UTF-8 {path}` makes it so, if that is what it is")
}

/// No longer model file is read from standard input, bytes: it may have no end.
const LONGEST_INPUT: u64 = 1 << 26;

/// Refuses standard input for an option where it is the model already.
///
/// # Errors
/// [`Problem::Usage`].
pub(super) fn refuse_model_again(loaded: &Loaded, option: &str, path: &str) -> Result<(), Problem> {
    match (loaded.path.as_str(), path) {
        ("-", "-") => Err(Problem::usage(format!("--{option} -: standard input is the model already; name a file"))),
        _ => Ok(()),
    }
}

/// What stands on standard input, which is read once.
pub(super) fn standard_input() -> Result<String, Problem> {
    static TEXT: OnceLock<String> = OnceLock::new();
    if let Some(text) = TEXT.get() {
        return Ok(text.clone());
    }
    let mut text = String::new();
    let mut limited = std::io::stdin().take(LONGEST_INPUT + 1);
    limited.read_to_string(&mut text).map_err(|e| Problem::File(format!("cannot read standard input: {e}")))?;
    if text.len() as u64 > LONGEST_INPUT {
        return Err(Problem::File(format!("standard input has more than {LONGEST_INPUT} bytes")));
    }
    Ok(TEXT.get_or_init(|| text).clone())
}

/// Warnings about a model file, a line each.
fn told(path: &str, source: &str, warnings: &[diagnose::Problem]) -> Vec<String> {
    let line = |(extent, problem): (file::Extent, &diagnose::Problem)| {
        let diagnose::Problem { code, message, .. } = problem;
        format!("{message} ({code} at {path}:{}:{})", extent.line, extent.column)
    };
    file::extents(source, warnings).into_iter().map(line).collect()
}

/// A model that was found.
pub struct Loaded {
    /// The name it goes by: its file's.
    pub name: String,
    /// Where its file is.
    pub path: String,
    /// What stands in it; where its code was compiled with the program, what stood in it then.
    pub source: String,
    /// Sizes other than the file's.
    pub sizes: Vec<(String, i64)>,
    /// The mechanism, with the file's parameters.
    pub system: Box<dyn System>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// What is interpreted.
    derived: Option<Arc<Program>>,
    /// The files that it names: where they were when it was loaded, wherever the process works later, and their texts, if it keeps them.
    pub files: Files,
    /// The model with its names, where it outlives a command.
    written: Option<Arc<Model>>,
}

impl Loaded {
    /// Finds the model that the command line names.
    pub fn find(context: Context<'_>, options: &ArgMatches) -> Result<Loaded, Problem> {
        let name = options.get_one::<String>("model").map_or("", String::as_str);
        Loaded::named(context, name, sizes(options)?)
    }

    /// Finds a model by its name or path.
    pub fn named(context: Context<'_>, name: &str, sizes: Vec<(String, i64)>) -> Result<Loaded, Problem> {
        if let Some(kept) = context.kept(name).filter(|_| sizes.is_empty()) {
            return Ok(kept.again());
        }
        if let Some(entry) = context.models.iter().find(|entry| entry.name == name)
            && let Some(system) = entry.compiled
        {
            return Loaded::compiled(entry, system, sizes);
        }
        let file = ModelFile::named(context, name, sizes)?;
        Loaded::interpreted(&file).map_err(|problems| file.problem(&problems))
    }

    fn compiled(entry: &Entry, system: fn() -> Box<dyn System>, sizes: Vec<(String, i64)>) -> Result<Loaded, Problem> {
        let mut warnings = Vec::new();
        if let Ok(now) = std::fs::read_to_string(entry.path)
            && fnv1a(&now) != fnv1a(entry.source)
        {
            warnings.push(format!("{} has changed since it was compiled", entry.path));
        }
        let (name, path, source) = (entry.name.to_owned(), entry.path.to_owned(), entry.source.to_owned());
        if !sizes.is_empty() {
            let file = ModelFile::of(name, path, source, sizes).with_known_sizes()?;
            return Loaded::interpreted(&file).map_err(|problems| file.problem(&problems));
        }
        let ModelFile { name, path, source, sizes, files } = ModelFile::of(name, path, source, sizes);
        Ok(Loaded { name, path, source, sizes, system: system(), warnings, derived: None, files, written: None })
    }

    /// Derives a model file.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn interpreted(file: &ModelFile) -> Result<Loaded, Vec<diagnose::Problem>> {
        let program = derived_for_runs(file)?;
        let ModelFile { name, path, source, sizes, files } = file.clone();
        let system = Box::new(Interpreted::new(program.clone(), &source));
        let warnings = told(&path, &source, &program.model.warnings);
        let derived = Some(Arc::new(program));
        Ok(Loaded { name, path, source, sizes, system, warnings, derived, files, written: None })
    }

    /// Says on standard error what the user should know.
    pub fn tell_warnings(&self) {
        for warning in &self.warnings {
            eprintln!("warning: {warning}");
        }
    }

    /// Keeps what would else be read from files again.
    ///
    /// # Errors
    /// What is wrong with them by now.
    pub fn keep(&mut self) -> Result<(), Problem> {
        if self.derived.as_ref().is_some_and(|program| !program.model.files.is_empty()) {
            let model = self.model()?;
            self.files.kept = self.tables(&model)?.into();
            self.written = Some(Arc::new(model));
        }
        Ok(())
    }

    /// The files of its tables with their texts, as they were when it was loaded if it keeps them.
    ///
    /// # Errors
    /// One cannot be read any more.
    pub fn tables(&self, model: &Model) -> Result<Vec<(PathBuf, String)>, Problem> {
        if self.written.is_some() {
            return Ok(self.files.kept.to_vec());
        }
        let read = |path: &PathBuf| {
            let text = self.files.text(path).map_err(|e| Problem::File(format!("cannot read {}: {e}", path.display())));
            text.map(|text| (path.clone(), text))
        };
        model.files.iter().map(read).collect()
    }

    /// With all systems of balances, of which runs by Lagrange's equations need none.
    ///
    /// # Errors
    /// They are too large.
    pub fn form(&mut self) -> Result<(), Problem> {
        if self.derived.as_ref().is_some_and(|program| program.unformed) {
            let program = self.program()?;
            self.system = Box::new(Interpreted::new(program.clone(), &self.source));
            self.derived = Some(Arc::new(program));
        }
        Ok(())
    }

    /// The same once more, as it was loaded.
    pub fn again(&self) -> Loaded {
        Loaded {
            name: self.name.clone(),
            path: self.path.clone(),
            source: self.source.clone(),
            sizes: self.sizes.clone(),
            system: self.system.boxed_clone(),
            warnings: self.warnings.clone(),
            derived: self.derived.clone(),
            files: self.files.clone(),
            written: self.written.clone(),
        }
    }

    /// The file that it was made of.
    pub fn file(&self) -> ModelFile {
        ModelFile {
            name: self.name.clone(),
            path: self.path.clone(),
            source: self.source.clone(),
            sizes: self.sizes.clone(),
            files: self.files.clone(),
        }
    }

    /// The derived model, for what the compiled code does not keep.
    pub fn program(&self) -> Result<Program, Problem> {
        match &self.derived {
            Some(program) => Program::clone(program).with_matrices(),
            None => derived(&self.file()),
        }
        .map_err(|problems| self.problem(&problems))
    }

    /// The model to interpret in double-double, or why there is none.
    pub fn to_interpret(&self, options: &ArgMatches) -> Result<Interpreted, DoubleOnly> {
        if options.contains_id("input") {
            return Err(DoubleOnly::Inputs);
        }
        self.program().map_or(Err(DoubleOnly::NoModel), |program| Ok(Interpreted::new(program, &self.source)))
    }

    /// The model with its names, for reading expressions.
    pub fn model(&self) -> Result<Model, Problem> {
        if let Some(written) = &self.written {
            return Ok(Model::clone(written));
        }
        load_from(&self.files, &self.source, &self.sizes).map_err(|problems| self.problem(&problems))
    }

    /// The derived model as runs have it, if it was derived.
    pub fn for_runs(&self) -> Option<Program> {
        self.derived.as_deref().cloned()
    }

    /// What is wrong with it, to print.
    pub fn problem(&self, problems: &[diagnose::Problem]) -> Problem {
        Problem::Model(file::render(&self.path, &self.source, problems))
    }
}

/// Derives a model; a terminal says so where that takes longer than [`PATIENCE`].
pub fn derived(file: &ModelFile) -> Result<Program, Vec<diagnose::Problem>> {
    announced_on_terminals(&file.path, || compile_from(&file.files, &file.source, &file.sizes))
}

/// The same, with a large M left out where runs need none.
fn derived_for_runs(file: &ModelFile) -> Result<Program, Vec<diagnose::Problem>> {
    announced_on_terminals(&file.path, || compile_for_runs_from(&file.files, &file.source, &file.sizes))
}

fn announced_on_terminals<T>(path: &str, work: impl FnOnce() -> T) -> T {
    match std::io::stderr().is_terminal() {
        true => announced(&mut std::io::stderr(), path, PATIENCE, work),
        false => work(),
    }
}

/// Deriving that takes no longer than this needs no word.
const PATIENCE: Duration = Duration::from_secs(1);

/// Does something; where that takes longer than this, a line says what is derived until it is done.
fn announced<T>(line: &mut (impl Write + Send), path: &str, patience: Duration, work: impl FnOnce() -> T) -> T {
    let (working, done) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            if done.recv_timeout(patience) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            // A line that cannot be written is no loss.
            let _ = write!(line, "deriving {path} ...").and_then(|()| line.flush());
            let _ = done.recv();
            let _ = write!(line, "\r\x1b[K").and_then(|()| line.flush());
        });
        let found = work();
        drop(working);
        found
    })
}

/// Where the files of a model's tables are: beside its own.
pub fn folder(path: &str) -> Option<PathBuf> {
    let whole = std::path::absolute(path).unwrap_or_else(|_| PathBuf::from(path));
    whole.parent().map(Path::to_owned)
}

/// The `--size` of a command line.
pub fn sizes(options: &ArgMatches) -> Result<Vec<(String, i64)>, Problem> {
    pairs(options, "size")?
        .into_iter()
        .map(|(name, value)| {
            let size = value.trim().parse();
            size.map(|size| (name, size)).map_err(|_| Problem::usage(format!("`{value}` is not an integer")))
        })
        .collect()
}

/// The `NAME=VALUE` of an option that may be given several times.
pub fn pairs(options: &ArgMatches, option: &str) -> Result<Vec<(String, String)>, Problem> {
    let texts = options.get_many::<String>(option).into_iter().flatten();
    each_once(option, texts.map(String::as_str))
}

/// The `NAME=VALUE` of these texts, each name once.
fn each_once<'a>(option: &str, texts: impl Iterator<Item = &'a str>) -> Result<Vec<(String, String)>, Problem> {
    let mut pairs: Vec<(String, String)> = Vec::new();
    for text in texts {
        let Some((name, value)) = text.split_once('=') else {
            return Err(Problem::usage(format!("--{option} wants NAME=VALUE, not `{text}`")));
        };
        let name = name.trim();
        if pairs.iter().any(|(known, _)| known == name) {
            return Err(Problem::usage(format!("--{option} gives `{name}` twice")));
        }
        if let Some(next) = next_pair(value) {
            return Err(Problem::usage(format!(
                "--{option} takes one NAME=VALUE each time: write --{option} again for `{next}`"
            )));
        }
        pairs.push((name.to_owned(), value.to_owned()));
    }
    Ok(pairs)
}

/// `y=2` in `1,y=2`: another pair behind a comma, which is no part of a value.
fn next_pair(value: &str) -> Option<&str> {
    let (before, _) = value.split_once('=')?;
    let comma = before.rfind(',')?;
    let name = before[comma + 1..].trim();
    let is_name = name.starts_with(|c: char| c.is_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_alphanumeric() || "_'.[]".contains(c));
    let depth = |c: char| i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
    let is_outside = before[..comma].chars().map(depth).sum::<i32>() == 0;
    (is_name && is_outside).then(|| value[comma + 1..].trim())
}

/// What an option lists: it may be given several times, and each time name several with commas between them.
pub fn listed(options: &ArgMatches, option: &str) -> Vec<String> {
    let texts = options.get_many::<String>(option).into_iter().flatten();
    texts.flat_map(|text| filled_parts(text)).map(ToOwned::to_owned).collect()
}

/// The same of `NAME=VALUE`, each name once.
pub fn listed_pairs(options: &ArgMatches, option: &str) -> Result<Vec<(String, String)>, Problem> {
    let parts = listed(options, option);
    let pairs = each_once(option, parts.iter().map(String::as_str))?;
    Ok(pairs.into_iter().map(|(name, value)| (name, value.trim().to_owned())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// What is written, for another thread to see.
    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn deriving_that_takes_long_is_announced_and_the_line_goes_again() {
        let seen = Shared::default();
        let mut line = seen.clone();
        let found = announced(&mut line, "crane.yaml", Duration::ZERO, || {
            while seen.0.lock().unwrap().is_empty() {
                std::thread::yield_now();
            }
            7
        });
        assert_eq!((found, seen.0.lock().unwrap().as_slice()), (7, &b"deriving crane.yaml ...\r\x1b[K"[..]));
        // What is quick is not talked about.
        let mut line = Shared::default();
        assert_eq!(announced(&mut line, "crane.yaml", Duration::from_secs(3600), || 8), 8);
        assert!(line.0.lock().unwrap().is_empty());
    }
}
