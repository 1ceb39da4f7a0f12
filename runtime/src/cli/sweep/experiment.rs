//! What a sweep runs, in a file beside its table: only tables of one experiment are continued or put together.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::print::fnv1a;

use super::points::Points;
use crate::cli::Problem;
use crate::cli::load::{Loaded, pairs};
use crate::cli::outputs;
use crate::cli::set_up::Reader;

/// The version of the file and of the table beside it.
const FORMAT: &str = "1";
/// The options whose texts belong to the experiment.
const OPTIONS: [&str; 6] = ["until", "tolerance", "every", "step", "method", "modes"];
/// The entry that tells model files apart.
const MODEL: &str = "model";
/// The entry that says which part of the runs a table has; parts of one sweep differ in it.
const SHARD: &str = "shard";
/// The entry that says how many runs all parts have together.
const RUNS: &str = "runs";

/// What decides the rows of a table, each entry by its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment(BTreeMap<String, String>);

impl Experiment {
    /// What the command line asks for; parameters have the values of all runs in which they do not vary.
    pub fn of(
        loaded: &Loaded,
        reader: &mut Reader,
        options: &ArgMatches,
        scene: usize,
        points: &Points,
    ) -> Result<Experiment, Problem> {
        let description = loaded.system.description();
        let mut entries = BTreeMap::new();
        let mut add = |name: String, value: String| _ = entries.insert(name, value);
        add("format".to_owned(), FORMAT.to_owned());
        add("program".to_owned(), env!("CARGO_PKG_VERSION").to_owned());
        add(MODEL.to_owned(), hash_of(&loaded.source));
        for (path, text) in loaded.tables(reader.model(loaded)?)? {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            add(format!("table {name}"), hash_of(&text));
        }
        loaded.sizes.iter().for_each(|(name, size)| add(format!("size {name}"), size.to_string()));
        add("scene".to_owned(), description.scenes.get(scene).map_or(String::new(), ToString::to_string));
        for (parameter, value) in description.parameters.iter().zip(loaded.system.parameters()) {
            if !points.varied.iter().any(|varied| varied.column() == parameter.name) {
                add(format!("parameter {}", parameter.name), format!("{value:?}"));
            }
        }
        for option in ["start", "input"] {
            pairs(options, option)?.into_iter().for_each(|(name, text)| add(format!("--{option} {name}"), text));
        }
        let texts = OPTIONS.iter().filter_map(|name| Some((*name, options.get_one::<String>(name)?)));
        texts.for_each(|(name, text)| add(format!("--{name}"), text.trim().to_owned()));
        if let Some(steps) = options.get_one::<u64>("max-steps") {
            add("--max-steps".to_owned(), steps.to_string());
        }
        points.summary().into_iter().for_each(|(name, text)| add(name, text));
        add(RUNS.to_owned(), points.len().to_string());
        add(SHARD.to_owned(), options.get_one::<String>("shard").map_or("1/1", String::as_str).replace(' ', ""));
        Ok(Experiment(entries))
    }

    /// The experiment of the table at this path.
    pub fn beside(table: &str) -> Result<Experiment, Problem> {
        let path = path(table);
        let unread = |problem: &dyn std::fmt::Display| {
            Problem::File(format!(
                "cannot read {path}, which says what {table} is a table of and belongs beside it: {problem}"
            ))
        };
        let text = std::fs::read_to_string(&path).map_err(|e| unread(&e))?;
        serde_json::from_str(&text).map(Experiment).map_err(|e| unread(&e))
    }

    /// Writes it beside the table at this path.
    pub fn write(&self, table: &str) -> Result<(), Problem> {
        let entries: Vec<String> =
            self.0.iter().map(|(name, value)| format!("  {}: {}", quoted(name), quoted(value))).collect();
        outputs::write(&path(table), format!("{{\n{}\n}}\n", entries.join(",\n")))
    }

    /// Refuses what differs from this experiment, which is called `own`, in anything but the part of the runs.
    pub fn refuse_other(&self, own: &str, other: &Experiment, name: &str) -> Result<(), Problem> {
        self.refuse(own, other, name, |entry| entry != SHARD)
    }

    /// The same where the part of the runs must be the same too.
    pub fn refuse_other_part(&self, own: &str, other: &Experiment, name: &str) -> Result<(), Problem> {
        self.refuse(own, other, name, |_| true)
    }

    fn refuse(&self, own: &str, other: &Experiment, name: &str, counts: impl Fn(&str) -> bool) -> Result<(), Problem> {
        let entries: BTreeSet<&String> = self.0.keys().chain(other.0.keys()).collect();
        let value = |experiment: &Experiment, entry: &str| {
            experiment.0.get(entry).cloned().unwrap_or_else(|| "not given".to_owned())
        };
        let differences: Vec<String> = entries
            .into_iter()
            .filter(|entry| counts(entry) && self.0.get(*entry) != other.0.get(*entry))
            .map(|entry| format!("  {entry}: {} and {}", value(self, entry), value(other, entry)))
            .collect();
        match differences.is_empty() {
            true => Ok(()),
            false => {
                let list = differences.join("\n");
                Err(Problem::usage(format!("{own} and {name} are not of one sweep; these differ:\n{list}")))
            }
        }
    }

    /// Refuses a model file with another text.
    pub fn refuse_other_model(&self, loaded: &Loaded) -> Result<(), Problem> {
        match self.0.get(MODEL) {
            Some(hash) if *hash == hash_of(&loaded.source) => Ok(()),
            _ => Err(Problem::usage(format!(
                "these tables are not of {}, or its file has changed since they were made",
                loaded.path
            ))),
        }
    }

    /// How many runs all parts have together.
    pub fn runs(&self, table: &str) -> Result<usize, Problem> {
        let count = self.0.get(RUNS).and_then(|count| count.parse().ok());
        count.ok_or_else(|| Problem::usage(format!("{} does not say how many `{RUNS}` there are", path(table))))
    }

    /// The same of all runs.
    pub fn whole(mut self) -> Experiment {
        self.0.insert(SHARD.to_owned(), "1/1".to_owned());
        self
    }
}

/// Where the experiment of a table stands.
pub fn path(table: &str) -> String {
    format!("{table}.json")
}

/// Whether rows are written to this path as they finish, and the experiment beside it: not to devices and pipes.
pub fn is_kept(table: &str) -> bool {
    let place = Path::new(table);
    table != "-" && (place.is_file() || !place.exists())
}

fn hash_of(text: &str) -> String {
    format!("{:016x}", fnv1a(text))
}

fn quoted(text: &str) -> serde_json::Value {
    text.into()
}
