//! A model that is derived once and asked many times, without a command line: what bridges to other languages call.
//!
//! Options are those of the commands (`--set`, `m=2`), and answers the JSON that `--json` prints, so that all ways in have the same words and the
//! same bits.

use std::fmt;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::ArgMatches;
use dalembert_symbolic::diagnose;
use dalembert_symbolic::file::{Node, read, render};
use dalembert_symbolic::model::Files;
use serde_json::Value;

use super::arrows::Over;
use super::load::{Loaded, ModelFile};
use super::plotted::Shown;
use super::set_up::choose;
use super::simulate::{Outcome, outcome};
use super::{Context, Entry, Problem, arguments, check, command, json, modes};
use crate::Run;
use crate::mechanism::System;
use crate::show::Animation;

/// A model that is derived.
pub struct Session {
    models: &'static [Entry],
    kept: Loaded,
    warnings: String,
    warned: String,
}

/// All that a model is loaded from.
pub struct Kept {
    /// The name it goes by.
    pub name: String,
    /// Where its file was.
    pub path: String,
    /// What stood in it.
    pub source: String,
    /// Sizes other than the file's.
    pub sizes: Vec<(String, i64)>,
    /// The folder beside which files stand that it names.
    pub folder: Option<PathBuf>,
    /// These files with their texts.
    pub files: Vec<(PathBuf, String)>,
}

/// The name that the text of a model states.
pub fn stated_name(text: &str) -> Option<String> {
    let Ok(Node::Map(entries)) = read(text) else { return None };
    entries.into_iter().find_map(|entry| match entry {
        (key, Node::Scalar(name)) if key == "name" => Some(name),
        _ => None,
    })
}

/// Why a model cannot be loaded.
#[derive(Debug)]
pub enum LoadError {
    /// There is no such file, or it cannot be read.
    Unread(Problem),
    /// What is wrong with it.
    Wrong {
        /// Rendered, for people.
        text: String,
        /// Where the file is.
        path: String,
        /// What `check --json` lists as `problems`.
        problems: String,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LoadError::Unread(problem) => problem.fmt(f),
            LoadError::Wrong { text, .. } => f.write_str(text.trim_end()),
        }
    }
}

impl std::error::Error for LoadError {}

/// What a command answers.
#[derive(Debug)]
pub struct Answer {
    /// What it writes to standard output.
    pub text: String,
    /// Why it failed, if it did.
    pub problem: Option<Problem>,
}

/// A run of a scene.
pub struct Simulated {
    loaded: Loaded,
    /// What was computed, all of it or until the run failed.
    pub run: Run,
    /// Why it ended early, and when, s, if it did.
    pub failed: Option<(String, f64)>,
    /// What `simulate --json` prints.
    pub json: String,
    /// What `simulate` prints: the end, what happened, and how far to trust it.
    pub text: String,
}

impl Session {
    /// A model by its name in the library or its path, with other sizes than the file's.
    ///
    /// # Errors
    /// [`LoadError`].
    pub fn named(models: &'static [Entry], name: &str, sizes: Vec<(String, i64)>) -> Result<Session, LoadError> {
        let file = ModelFile::named(Context::of(models), name, sizes).map_err(LoadError::Unread)?;
        Session::of(models, &file)
    }

    /// A model of this text, which goes by this name; files of tables are looked for where the process works.
    ///
    /// # Errors
    /// [`LoadError::Wrong`].
    pub fn of_text(
        models: &'static [Entry],
        (name, text): (&str, &str),
        sizes: Vec<(String, i64)>,
    ) -> Result<Session, LoadError> {
        let (name, path, source) = (name.to_owned(), format!("{name}.yaml"), text.to_owned());
        Session::of(models, &ModelFile::of(name, path, source, sizes))
    }

    /// The model that [`Session::kept`] told, wherever the process works and whatever became of its files.
    ///
    /// # Errors
    /// [`LoadError::Wrong`].
    pub fn restored(models: &'static [Entry], kept: Kept) -> Result<Session, LoadError> {
        let Kept { name, path, source, sizes, folder, files } = kept;
        let files = Files { folder, kept: files.into() };
        Session::of(models, &ModelFile { name, path, source, sizes, files })
    }

    /// What it was loaded from.
    pub fn kept(&self) -> Kept {
        let ModelFile { name, path, source, sizes, files } = self.kept.file();
        Kept { name, path, source, sizes, folder: files.folder, files: files.kept.to_vec() }
    }

    fn of(models: &'static [Entry], file: &ModelFile) -> Result<Session, LoadError> {
        let listed = |problems: &[diagnose::Problem]| json_text(&check::mistakes(&file.source, problems));
        let mut kept = Loaded::interpreted(file).map_err(|problems| LoadError::Wrong {
            text: file.problem(&problems).to_string(),
            path: file.path.clone(),
            problems: listed(&problems),
        })?;
        kept.keep().map_err(LoadError::Unread)?;
        let found = kept.program().map_or_else(|_| Vec::new(), |program| program.model.warnings);
        let (warnings, warned) = (listed(&found), render(&file.path, &file.source, &found));
        Ok(Session { models, kept, warnings, warned })
    }

    /// The name that it goes by: its file's.
    pub fn name(&self) -> &str {
        &self.kept.name
    }

    /// The model file's text.
    pub fn source(&self) -> &str {
        &self.kept.source
    }

    /// Warnings about the file, as `check --json` lists them among its `problems`.
    pub fn warnings(&self) -> &str {
        &self.warnings
    }

    /// The same warnings as `check` prints them; empty where there are none.
    pub fn warned(&self) -> &str {
        &self.warned
    }

    /// The mechanism, with the file's parameters.
    pub fn system(&self) -> Box<dyn System> {
        self.kept.system.boxed_clone()
    }

    /// The mechanism with the parameters of a scene, by `--scene` and `--set`, and which scene it is.
    ///
    /// # Errors
    /// What `simulate` refuses of these.
    pub fn system_of(&self, options: &[String]) -> Result<(Box<dyn System>, usize), Problem> {
        let options = self.options("simulate", options)?;
        let mut loaded = self.kept.again();
        let (scene, _) = choose(&mut loaded, &options)?;
        Ok((loaded.system, scene))
    }

    /// Runs a command of the program on this model.
    pub fn command(&self, name: &str, options: &[String], interrupted: &Arc<AtomicBool>) -> Answer {
        let mut out = Vec::new();
        let context = Context { models: self.models, kept: Some(&self.kept), interrupted: Some(interrupted) };
        let problem = command(context, self.line(name, options), &mut out).err();
        Answer { text: String::from_utf8_lossy(&out).into_owned(), problem }
    }

    /// Runs a scene as `simulate` does, and keeps the run, of which only `--save` is written; `watch` is asked at every step whether to go on.
    ///
    /// # Errors
    /// What `simulate` refuses; a run that failed is none of it.
    pub fn simulate(
        &self,
        options: &[String],
        watch: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Simulated, Problem> {
        let options = self.options("simulate", options)?;
        let Outcome { loaded, run, failed, json, text } = outcome(self.context(), &options, &mut |_| watch())?;
        Ok(Simulated { loaded, run, failed, json: json_text(&json), text })
    }

    /// What `modes` prints by its options, as [`Session::command`] does; a program that runs no other command has the code of none.
    pub fn modes(&self, options: &[String]) -> Answer {
        let mut out = Vec::new();
        let options = self.options("modes", options);
        let problem = options.and_then(|options| modes::run(self.context(), &options, &mut out)).err();
        Answer { text: String::from_utf8_lossy(&out).into_owned(), problem }
    }

    /// Linearises as `modes` does, by its options: one JSON object with M, C, K, F, F_rates and
    /// F_accelerations of M q'' + C q' + K q = F u + F_rates u' + F_accelerations u'', A and B of x' = A x + B u, names and units; with `--out` C and D of
    /// y = C x + D u; with `--at-time` A to D of departures from a motion.
    ///
    /// # Errors
    /// What `modes` refuses.
    pub fn linearise(&self, options: &[String]) -> Result<String, Problem> {
        // `--in` and `--out` are of the state space, which is not written here.
        let options = [options, &["--state-space=linear.json".to_owned()]].concat();
        let options = self.options("modes", &options)?;
        modes::linearised(self.context(), &options).map(|found| json_text(&found))
    }

    fn context(&self) -> Context<'_> {
        Context { models: self.models, kept: Some(&self.kept), interrupted: None }
    }

    fn line(&self, command: &str, options: &[String]) -> Vec<String> {
        let words = ["dalembert", command].map(str::to_owned).into_iter().chain(options.iter().cloned());
        words.chain(["--".to_owned(), self.kept.name.clone()]).collect()
    }

    fn options(&self, command: &str, options: &[String]) -> Result<ArgMatches, Problem> {
        matches(self.line(command, options))
    }
}

impl Simulated {
    /// What `simulate --plot` draws of it, as SVG: the charts of each `--show`, or those that a run has by itself; states at multiples of
    /// `section` only.
    ///
    /// # Errors
    /// Names that are not known.
    pub fn figure(&self, shown: &[String], section: Option<&str>) -> Result<String, Problem> {
        let asked = shown.iter().map(|text| format!("--show={text}"));
        let section = section.map(|period| format!("--section={period}"));
        let words =
            ["dalembert", "simulate", "--plot=run.svg"].map(str::to_owned).into_iter().chain(asked).chain(section);
        let options = matches(words.chain(["--".to_owned(), self.loaded.name.clone()]).collect())?;
        let shown = Shown::read(&self.loaded, &options)?;
        let figure = shown.figure(&[(String::new(), &self.run)]);
        figure.map(|figure| figure.to_svg()).map_err(Problem::usage)
    }

    /// What `simulate --animate` plays, with what `--arrows` and `--mark-events` draw over it; of an empty list all.
    ///
    /// # Errors
    /// Names that are not known, and a mechanism without forces that act at points.
    pub fn animation(&self, arrows: Option<&[String]>, events: Option<&[String]>) -> Result<Animation, Problem> {
        Over::of(&self.loaded, arrows, events)?.over(&self.run, self.run.animation())
    }
}

fn matches(line: Vec<String>) -> Result<ArgMatches, Problem> {
    let matches = arguments::parsed(line).map_err(|e| Problem::Usage(e.to_string()))?;
    let chosen = matches.subcommand().map(|(_, options)| options.clone());
    chosen.ok_or_else(|| Problem::usage("no command is given"))
}

fn json_text(value: &Value) -> String {
    let mut text = Vec::new();
    // Nothing fails that is written to memory.
    let _ = json::write(value, &mut text);
    String::from_utf8_lossy(&text).into_owned()
}
