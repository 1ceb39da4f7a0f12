//! Files that a command will write, looked at before it computes anything.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use clap::ArgMatches;

use super::Problem;

/// Refuses paths that cannot be written, that are the model file, or that two options share.
///
/// Files are told apart by what they are, not by how they are called: `./y.yaml`, a symbolic link and a hard link are all
/// the same file.
///
/// # Errors
/// [`Problem::File`]; nothing was computed then, and what was in a file is still there.
pub fn check(options: &ArgMatches, names: &[&str], model: &str) -> Result<(), Problem> {
    let mut taken: Vec<(String, PathBuf)> = Vec::new();
    for name in names {
        let Some(path) = options.get_one::<String>(name) else { continue };
        let option = format!("--{name}");
        let asked = Path::new(path);
        if same_file(asked, Path::new(model)) {
            return Err(Problem::File(format!("{option} {path} would overwrite the model file")));
        }
        let opened = File::options().append(true).create(true).open(asked);
        opened.map_err(|problem| Problem::File(format!("{option}: cannot write `{path}`: {problem}")))?;
        let clash = taken.iter().find(|(_, other)| same_file(asked, other)).map(|(other, _)| other.clone());
        if let Some(other) = clash {
            return Err(Problem::File(format!("{other} and {option} name the same file, {path}")));
        }
        taken.push((option, asked.to_owned()));
    }
    Ok(())
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
