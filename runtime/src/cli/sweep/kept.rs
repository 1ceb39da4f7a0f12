//! The table on disk, to which rows are added as they finish.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::sync::Mutex;

use super::experiment::{Experiment, is_kept};
use super::table::{Row, Table};
use crate::cli::Problem;

/// A table that grows.
pub struct Kept<'a> {
    path: &'a str,
    /// Its runs that were there before.
    pub done: Vec<Row>,
    /// Rows go to it; `None`: they are written when all are there.
    file: Option<Mutex<File>>,
}

impl<'a> Kept<'a> {
    /// Begins a table at this path, where `resume` is false or no table is there yet; else continues the one of this experiment.
    pub fn begin(path: &'a str, names: &[String], experiment: &Experiment, resume: bool) -> Result<Self, Problem> {
        if !is_kept(path) {
            return match resume {
                true => Err(Problem::usage(format!("--resume continues the table of a file, and {path} is none"))),
                false => Ok(Kept { path, done: Vec::new(), file: None }),
            };
        }
        let unwritten = |e: std::io::Error| Problem::File(format!("cannot write `{path}`: {e}"));
        let mut open = OpenOptions::new();
        let mut file = open.write(true).create(true).truncate(false).open(path).map_err(unwritten)?;
        let begun = if resume { Table::read(path)? } else { None };
        if let Some((table, complete)) = begun {
            Experiment::beside(path)?.refuse_other_part(path, experiment, "this command")?;
            if table.names != names {
                return Err(Problem::usage(format!("{path} is not of this sweep: its columns differ")));
            }
            file.set_len(complete).and_then(|()| file.seek(SeekFrom::End(0))).map_err(unwritten)?;
            return Ok(Kept { path, done: table.rows, file: Some(Mutex::new(file)) });
        }
        file.set_len(0).map_err(unwritten)?;
        experiment.write(path)?;
        let header = Table { names: names.to_vec(), rows: Vec::new() }.to_csv();
        file.write_all(header.as_bytes()).map_err(unwritten)?;
        Ok(Kept { path, done: Vec::new(), file: Some(Mutex::new(file)) })
    }

    /// Adds a row; it is in the file when this returns.
    pub fn add(&self, row: &Row) -> Result<(), Problem> {
        let Some(file) = &self.file else { return Ok(()) };
        let mut file = file.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        file.write_all(row.to_csv().as_bytes())
            .map_err(|e| Problem::File(format!("cannot write `{}`: {e}; --resume continues the sweep", self.path)))
    }
}

/// Writes a whole table, in the place of what is at this path at once, so that nobody finds half of it; and its experiment beside it.
pub fn replace(path: &str, table: &Table, experiment: &Experiment) -> Result<(), Problem> {
    let unwritten = |e: std::io::Error| Problem::File(format!("cannot write `{path}`: {e}"));
    let text = table.to_csv();
    match path {
        "-" => return Ok(()),
        _ if !is_kept(path) => return std::fs::write(path, text).map_err(unwritten),
        _ => experiment.write(path)?,
    }
    // A link stays one.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.into());
    let mut beside = place.clone().into_os_string();
    beside.push(".new");
    std::fs::write(&beside, text).and_then(|()| std::fs::rename(&beside, &place)).map_err(unwritten)
}
