//! Files that a command will write, looked at before it computes anything.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::ArgMatches;

use super::{Problem, signals};
use crate::Error;
use crate::show::{Animation, Figure, Playback, is_film, is_picture, wants_letters};

/// Refuses paths that cannot be written, that are the model file, or that two options share.
///
/// Files are told apart by what they are, not by how they are called: `./y.yaml`, a symbolic link and a hard link are all
/// the same file.
///
/// # Errors
/// Nothing was computed then, and what was in a file is still there.
pub fn check(options: &ArgMatches, names: &[&str], model: &str) -> Result<(), Problem> {
    let given = names.iter().filter_map(|name| Some((*name, options.get_one::<String>(name)?.as_str())));
    check_paths(given, model)
}

/// The same for (option, path) that are known.
///
/// # Errors
/// As [`check`].
pub fn check_paths<'a>(paths: impl Iterator<Item = (&'a str, &'a str)>, model: &str) -> Result<(), Problem> {
    let mut created = Created::default();
    let mut taken: Vec<(String, PathBuf)> = Vec::new();
    for (name, path) in paths {
        let option = format!("--{name}");
        if (name, path) == ("csv", "-") {
            continue;
        }
        refuse_hyphen(name, path)?;
        let asked = Path::new(path);
        if same_file(asked, Path::new(model)) {
            return Err(Problem::usage(format!("{option} {path} would overwrite the model file")));
        }
        match name {
            "plot" => drawable(path)?,
            "animate" => playable(path)?,
            "csv" => ends_in(path, &["csv"])?,
            "npz" => ends_in(path, &["npz"])?,
            "fmu" => ends_in(path, &["fmu"])?,
            "save" => ends_in(path, &["yaml", "yml", "txt"])?,
            "write" => ends_in(path, &["yaml", "yml"])?,
            _ => (),
        }
        if !asked.exists() {
            created.0.push(asked.to_owned());
        }
        let opened = File::options().append(true).create(true).open(asked);
        opened.map_err(|problem| Problem::File(format!("{option}: cannot write `{path}`: {problem}")))?;
        let clash = taken.iter().find(|(_, other)| same_file(asked, other)).map(|(other, _)| other.clone());
        if let Some(other) = clash {
            return Err(Problem::usage(format!("{other} and {option} name the same file, {path}")));
        }
        taken.push((option, asked.to_owned()));
    }
    Ok(())
}

/// Refuses `-` where a file is to be named.
///
/// # Errors
/// [`Problem::Usage`].
pub fn refuse_hyphen(option: &str, path: &str) -> Result<(), Problem> {
    match path {
        "-" => Err(Problem::usage(format!("--{option}: only tables go to standard output; name a file"))),
        _ => Ok(()),
    }
}

/// Refuses to write the table over a file that it is made from.
///
/// # Errors
/// [`Problem::Usage`].
pub fn keep<'a>(path: &str, mut read: impl Iterator<Item = &'a str>) -> Result<(), Problem> {
    match read.find(|read| same_file(Path::new(path), Path::new(read))) {
        Some(read) => {
            Err(Problem::usage(format!("{path} would overwrite {read}, which it is made from; name another by --csv")))
        }
        None => Ok(()),
    }
}

/// Draws a picture to a file, as SVG, PNG or PDF by its name.
///
/// # Errors
/// [`Problem::File`].
pub fn draw(path: &str, picture: impl Into<Figure>) -> Result<(), Problem> {
    picture.into().write(path).map_err(|problem| Problem::File(problem.to_string()))
}

/// Writes an animation to a file, as a page or a picture by its name; of a picture how it plays.
///
/// # Errors
/// [`Problem::File`].
pub fn animate(path: &str, animation: &Animation) -> Result<Option<Playback>, Problem> {
    animation.write(path).map_err(|problem| Problem::File(problem.to_string()))?;
    Ok(is_film(Path::new(path)).then(|| animation.playback()))
}

/// Refuses a chart in a format that it is not drawn in, or that the program was built without.
///
/// # Errors
/// [`Problem::Usage`].
pub fn drawable(path: &str) -> Result<(), Problem> {
    has_format(path, wants_letters, &["svg", "png", "pdf"])
}

/// The same for an animation.
///
/// # Errors
/// [`Problem::Usage`].
pub fn playable(path: &str) -> Result<(), Problem> {
    has_format(path, is_picture, &["html", "htm", "png", "gif", "svg"])
}

fn has_format(path: &str, has_pixels: fn(&Path) -> bool, known: &[&str]) -> Result<(), Problem> {
    let path = PathBuf::from(path);
    if has_pixels(&path) && !cfg!(feature = "png") {
        return Err(Problem::usage(format!("{}", Error::NeedsPng { path })));
    }
    ends_in(&path.to_string_lossy(), known)
}

/// Refuses a file whose ending is none of these; one without an ending is what it is asked to be.
///
/// # Errors
/// [`Problem::Usage`].
pub fn ends_in(path: &str, known: &[&str]) -> Result<(), Problem> {
    match Path::new(path).extension() {
        Some(own) if !known.iter().any(|known| own.eq_ignore_ascii_case(known)) => {
            let names = known.iter().map(|name| format!("`.{name}`")).collect::<Vec<_>>().join(", ");
            Err(Problem::usage(format!("{path}: nothing is written in that format; end the name in one of {names}")))
        }
        _ => Ok(()),
    }
}

/// Whether no report is wanted; what is data for others, as JSON or a table on standard output, is no report.
pub fn is_quiet(command: &str, options: &ArgMatches) -> bool {
    let is_data = match command {
        "list" | "show" | "schema" | "completions" => true,
        "generate" => output(options).is_none_or(|path| path == "-"),
        "import" => output(options).is_some_and(|path| path == "-"),
        _ => wants(options, "json") || has_table_on_output(options),
    };
    wants(options, "quiet") && !is_data
}

/// Where what a command makes is to go.
fn output(options: &ArgMatches) -> Option<&String> {
    options.try_get_one("output").ok().flatten()
}

/// Whether a flag is given that the command has.
pub fn wants(options: &ArgMatches, flag: &str) -> bool {
    options.try_get_one::<bool>(flag).ok().flatten().is_some_and(|given| *given)
}

fn has_table_on_output(options: &ArgMatches) -> bool {
    options.try_get_one::<String>("csv").ok().flatten().is_some_and(|path| path == "-")
}

/// Where a table goes, if to standard output, and the report, which then goes to standard error.
pub fn streams<'a>(options: &ArgMatches, out: &'a mut dyn Write) -> (Option<&'a mut dyn Write>, Box<dyn Write + 'a>) {
    match has_table_on_output(options) {
        true if wants(options, "quiet") => (Some(out), Box::new(std::io::sink())),
        true => (Some(out), Box::new(std::io::stderr())),
        false => (None, Box::new(out)),
    }
}

/// Writes what a command prints to the file of `--output`, or to standard output.
///
/// # Errors
/// An ending that is none of these, the model file, or a file that cannot be written.
pub fn put(
    options: &ArgMatches,
    endings: &[&str],
    model: &str,
    text: &[u8],
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let Some(path) = options.get_one::<String>("output").filter(|path| *path != "-") else {
        return Ok(out.write_all(text)?);
    };
    check(options, &["output"], model)?;
    ends_in(path, endings)?;
    write(path, text)
}

/// Writes a file that was looked at before.
///
/// # Errors
/// [`Problem::File`].
pub fn write(path: &str, bytes: impl AsRef<[u8]>) -> Result<(), Problem> {
    fs::write(path, bytes).map_err(|problem| Problem::File(format!("cannot write `{path}`: {problem}")))
}

/// That there would be more in a file than the sizes in it can tell.
pub fn too_large(path: &str) -> Problem {
    Problem::File(format!(
        "cannot write `{path}`: it would be larger than the 4 GB of such a file; write a table as .csv"
    ))
}

/// Files that are there only to be tried; they go when all are known.
#[derive(Default)]
struct Created(Vec<PathBuf>);

impl Drop for Created {
    fn drop(&mut self) {
        // What cannot be taken away is empty and harmless.
        self.0.iter().for_each(|path| fs::remove_file(path).unwrap_or_default());
    }
}

/// True where two paths lead to one file that exists.
#[cfg(unix)]
fn same_file(one: &Path, other: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (fs::metadata(one), fs::metadata(other)) {
        (Ok(one), Ok(other)) => (one.dev(), one.ino()) == (other.dev(), other.ino()),
        _ => false,
    }
}

/// True where two paths lead to one file that exists.
#[cfg(not(unix))]
fn same_file(one: &Path, other: &Path) -> bool {
    match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => false,
    }
}

/// Output, and how much there was.
pub struct Counted<'a> {
    pub out: &'a mut dyn Write,
    pub bytes: usize,
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        signals::printing();
        let written = self.out.write(bytes)?;
        self.bytes += written;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
