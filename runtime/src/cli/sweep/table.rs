//! The table of a sweep, one row a run.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use super::experiment::Experiment;
use crate::cli::Problem;
use crate::cli::npz::Archive;
use crate::linear::{Kind, LinearError, Mode};
use crate::mechanism::Description;
use crate::{Error, Run};

/// All runs, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// `run`, what varies, and what came of it; the last is `error`.
    pub names: Vec<String>,
    pub rows: Vec<Row>,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its place in the whole sweep.
    pub run: usize,
    /// What varies, then what came of it; `None`: there is no such value.
    pub cells: Vec<Option<f64>>,
    /// Why it ended early; empty if it did not.
    pub error: String,
}

/// The names of what comes of every run; with frequencies and damping ratios of so many modes.
pub fn results(columns: &[String], description: &Description, modes: usize) -> Vec<String> {
    let of = |column: &String| [column.clone(), format!("min {column}"), format!("max {column}")];
    let events = description.events.iter().map(|event| format!("events {}", event.name));
    let others = ["energy drift", "warnings"].map(str::to_owned);
    let modes = (1..=modes).flat_map(|k| [format!("frequency {k}"), format!("damping {k}")]);
    let run = std::iter::once("t".to_owned()).chain(columns.iter().flat_map(of)).chain(events).chain(others);
    run.chain(modes).collect()
}

/// What came of a run, in the order of [`results`], but for its modes.
pub fn outcome(run: &Run, columns: &[String], description: &Description) -> Vec<Option<f64>> {
    let finite = |value: f64| Some(value).filter(|value| value.is_finite());
    let extremes = run.extremes_of(columns);
    let of = |(name, range): (&String, &Option<(f64, f64)>)| {
        let end = run.column(name).and_then(|column| column.last().copied()).and_then(finite);
        [end, range.map(|(low, _)| low), range.map(|(_, high)| high)]
    };
    let counts = (0..description.events.len())
        .map(|index| Some(run.events.iter().filter(|event| event.event == index).count() as f64));
    let others = [run.energy_balance.and_then(finite), Some(run.warnings.len() as f64)];
    std::iter::once(run.times().last().copied())
        .chain(columns.iter().zip(&extremes).flat_map(of))
        .chain(counts)
        .chain(others)
        .collect()
}

impl Row {
    /// A row of what came of a run.
    pub fn of(
        run: usize,
        values: Vec<f64>,
        outcome: Result<Run, Error>,
        columns: &[String],
        description: &Description,
    ) -> Row {
        let (done, error) = match outcome {
            Ok(done) => (Some(done), String::new()),
            Err(Error::Run(failure)) => (Some(failure.run), failure.cause.to_string()),
            Err(error) => (None, error.to_string()),
        };
        let results = results(columns, description, 0).len();
        let found =
            done.map_or_else(|| vec![None; results], |done| outcome_or_nothing(&done, columns, description, results));
        Row { run, cells: values.into_iter().map(Some).chain(found).collect(), error }
    }

    /// The row with frequencies, Hz, and damping ratios of so many modes, the slowest first and last those that have no frequency; nothing
    /// beyond those there are.
    pub fn with_modes(mut self, found: Result<Vec<Mode>, LinearError>, count: usize) -> Row {
        let of = |mode: &Mode| [has_frequency(mode).then_some(mode.omega / TAU), mode.zeta];
        let mut modes = match found {
            Ok(modes) => modes,
            Err(problem) => {
                if self.error.is_empty() {
                    self.error = format!("modes: {problem}");
                }
                Vec::new()
            }
        };
        in_order(&mut modes);
        self.cells.extend(modes.iter().map(of).chain(std::iter::repeat([None, None])).take(count).flatten());
        self
    }
}

/// Frequencies that differ by less than this part of them are equal but for rounding, as where damping turns one of two equal modes.
const EQUAL: f64 = 1e-9;

/// Whether a mode goes to and fro, or is a motion without stiffness, whose frequency is 0: what dies out or grows by a real eigenvalue has none.
fn has_frequency(mode: &Mode) -> bool {
    mode.eigenvalue.im != 0.0 || mode.kind == Kind::Rigid
}

/// Modes by their frequencies, those that are equal by their damping, and behind them those without one by their rates.
fn in_order(modes: &mut [Mode]) {
    modes.sort_by(|a, b| {
        (!has_frequency(a), a.omega).partial_cmp(&(!has_frequency(b), b.omega)).unwrap_or(Ordering::Equal)
    });
    let alike = |a: &Mode, b: &Mode| has_frequency(a) == has_frequency(b) && b.omega - a.omega <= EQUAL * b.omega;
    for equal in modes.chunk_by_mut(alike) {
        equal.sort_by(|a, b| a.zeta.partial_cmp(&b.zeta).unwrap_or(Ordering::Equal));
    }
}

/// What came of a run; nothing where it never began.
fn outcome_or_nothing(run: &Run, columns: &[String], description: &Description, results: usize) -> Vec<Option<f64>> {
    if run.is_empty() { vec![None; results] } else { outcome(run, columns, description) }
}

impl Row {
    /// As a line of the table.
    pub fn to_csv(&self) -> String {
        let cells = self.cells.iter().map(|cell| cell.map(|x| format!("{x:.16e}")).unwrap_or_default());
        line(std::iter::once(self.run.to_string()).chain(cells).chain([self.error.clone()]))
    }
}

/// A record of comma-separated values.
fn line(cells: impl Iterator<Item = String>) -> String {
    let mut record = csv::Writer::from_writer(Vec::new());
    let into_memory = "a vector in memory takes all that is written";
    record.write_record(cells.map(String::into_bytes)).expect(into_memory);
    String::from_utf8(record.into_inner().expect(into_memory)).expect("names and numbers are text")
}

impl Table {
    /// As comma-separated values; numbers keep every digit.
    pub fn to_csv(&self) -> String {
        std::iter::once(line(self.names.iter().cloned())).chain(self.rows.iter().map(Row::to_csv)).collect()
    }

    /// As NumPy's arrays, one for each column, NaN where there is no value; `None` where they are too large for an archive.
    pub fn to_npz(&self) -> Option<Vec<u8>> {
        let mut archive = Archive::default();
        archive.whole("run", &self.rows.iter().map(|row| row.run as i64).collect::<Vec<_>>());
        for (k, name) in self.names.iter().skip(1).take(self.names.len().saturating_sub(2)).enumerate() {
            let cell = |row: &Row| row.cells.get(k).copied().flatten().unwrap_or(f64::NAN);
            archive.numbers(name, &[self.rows.len()], self.rows.iter().map(cell));
        }
        archive.words("error", &self.rows.iter().map(|row| row.error.as_str()).collect::<Vec<_>>());
        archive.bytes()
    }

    /// Reads what [`Table::to_csv`] wrote, as far as its lines are complete, and how many bytes these take; `None`: not even its names
    /// are there.
    pub fn read(path: &str) -> Result<Option<(Table, u64)>, Problem> {
        let unread = |problem: &dyn std::fmt::Display| Problem::File(format!("cannot read {path}: {problem}"));
        let text = std::fs::read(path).map_err(|e| Problem::unread(path, &e))?;
        let text = complete(&text);
        if text.is_empty() {
            return Ok(None);
        }
        let mut table = csv::Reader::from_reader(text);
        let names: Vec<String> = table.headers().map_err(|e| unread(&e))?.iter().map(str::to_owned).collect();
        if names.len() < 2 || names[0] != "run" || names[names.len() - 1] != "error" {
            return Err(Problem::usage(format!("{path} is no table of a sweep")));
        }
        let mut rows = Vec::new();
        for record in table.records() {
            let record = record.map_err(|e| unread(&e))?;
            let bad = |text: &str| Problem::usage(format!("{path}: `{text}` is no number"));
            let cell = |text: &str| match text {
                "" => Ok(None),
                text => text.parse().map(Some).map_err(|_| bad(text)),
            };
            let (first, last) = (&record[0], &record[names.len() - 1]);
            let run = first.parse().map_err(|_| bad(first))?;
            let cells = (1..names.len() - 1).map(|k| cell(&record[k])).collect::<Result<_, _>>()?;
            rows.push(Row { run, cells, error: last.to_owned() });
        }
        Ok(Some((Table { names, rows }, text.len() as u64)))
    }

    /// One table of the parts of a sweep, each run once and none missing, and the experiment of all.
    pub fn merge(paths: &[&str]) -> Result<(Table, Experiment), Problem> {
        let [first, others @ ..] = paths else {
            return Err(Problem::usage("--merge wants the tables of all parts".to_owned()));
        };
        let of = |path: &str| match Table::read(path)? {
            Some((table, _)) => Ok(table),
            None => Err(Problem::usage(format!("{path} is no table of a sweep"))),
        };
        let (mut whole, experiment) = (of(first)?, Experiment::beside(first)?);
        for path in others {
            experiment.refuse_other(first, &Experiment::beside(path)?, path)?;
            let table = of(path)?;
            if table.names != whole.names {
                return Err(Problem::usage(format!("{path} and {first} are not of one sweep: their columns differ")));
            }
            whole.rows.extend(table.rows);
        }
        whole.sort()?;
        let missing = (0..experiment.runs(first)?).find(|run| whole.rows.get(*run).is_none_or(|row| row.run != *run));
        match missing {
            Some(run) => Err(Problem::usage(format!(
                "run {run} is missing: a part has not been given, or was interrupted, which --resume continues"
            ))),
            None => Ok((whole, experiment.whole())),
        }
    }

    /// Puts its rows in the order of their runs.
    pub fn sort(&mut self) -> Result<(), Problem> {
        self.rows.sort_by_key(|row| row.run);
        match self.rows.windows(2).find(|pair| pair[0].run == pair[1].run) {
            Some(pair) => Err(Problem::usage(format!("run {} stands there twice", pair[0].run))),
            None => Ok(()),
        }
    }

    /// A column by its name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name).and_then(|place| place.checked_sub(1))
    }
}

/// The lines that were written to their ends: a line ends outside of quotes.
fn complete(text: &[u8]) -> &[u8] {
    let (mut end, mut quoted) = (0, false);
    for (place, byte) in text.iter().enumerate() {
        match byte {
            b'"' => quoted = !quoted,
            b'\n' if !quoted => end = place + 1,
            _ => (),
        }
    }
    &text[..end]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_were_not_written_to_their_ends_are_left_out() {
        let whole = "run,x,error\n1,2.0,\n0,,\"first\nsecond \"\"quoted\"\"\"\n";
        let ends = [0, 12, 19, whole.len()];
        for length in 0..=whole.len() {
            let expected = ends.into_iter().rev().find(|end| *end <= length).unwrap_or(0);
            assert_eq!(complete(&whole.as_bytes()[..length]).len(), expected, "{length}");
        }
    }

    #[test]
    fn a_table_that_is_read_is_written_the_same() {
        let path = std::env::temp_dir().join(format!("dalembert-table-{}.csv", std::process::id()));
        let cells = vec![Some(-0.0), None, Some(5e-324), Some(f64::MAX), Some(0.1)];
        let names = ["run", "a", "b", "c", "d", "e", "error"].map(str::to_owned).to_vec();
        let table = Table { names, rows: vec![Row { run: 3, cells, error: "a, \"b\"\nc".to_owned() }] };
        std::fs::write(&path, table.to_csv()).expect("a file");
        let read = Table::read(path.to_str().expect("a path")).expect("a table");
        std::fs::remove_file(&path).expect("the file");
        let (again, length) = read.expect("names");
        assert_eq!((again.to_csv(), length), (table.to_csv(), table.to_csv().len() as u64));
    }
}
