//! What went wrong in strangers' hands: each file beside a neighbour that must stay as it is.
#![cfg(all(feature = "interpret", feature = "cli"))]

mod advice;
mod angles;
mod branches;
mod by_hand;
mod carried;
mod contacts;
mod control;
mod equilibria;
mod events;
mod extremes;
mod false_alarms;
mod fits;
mod found_steps;
mod gaps;
mod gimbal_lock;
mod inputs;
mod limits;
mod orbits;
mod pictures;
mod printing;
mod reactions;
mod rotations;
mod rubbing;
mod second_runs;
mod shared;
mod slow;
mod starts;
mod strikes;
mod surfaces;
mod units;
mod warnings;
mod zero;

use std::path::{Path, PathBuf};

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Error, Run, Settings, Simulation, simulate};
use dalembert_symbolic::lower::compile;

/// A model file that nobody compiled, with the settings of its default scene.
struct Case {
    system: Interpreted,
    settings: Settings,
}

impl Case {
    /// The run, or why it failed.
    fn try_run(&mut self) -> Result<Run, Error> {
        simulate(&mut self.system, &self.settings)
    }

    /// The run.
    fn run(&mut self) -> Run {
        self.try_run().unwrap_or_else(|error| panic!("{error}"))
    }
}

/// A model file's text with its default scene.
fn case(text: &str) -> Case {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let system = Interpreted::new(program, text);
    let settings = Settings::new(&system.scene(0));
    Case { system, settings }
}

/// A simulation of a model file's text.
fn simulation(text: &str) -> Simulation<Interpreted> {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    Simulation::new(Interpreted::new(program, text))
}

/// A model file of `tests/strangers`.
fn stranger(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/strangers").join(format!("{name}.yaml"))
}

/// The text of a model file of `tests/strangers`.
fn text_of(name: &str) -> String {
    let path = stranger(name);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// A folder of a test's own for what it writes.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-strangers-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// What the program prints for a command line, or what it says is wrong.
fn program(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    match dalembert::cli::run(&[], ["dalembert"].iter().chain(arguments), &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

/// What a command of the program prints of a file of `tests/strangers`, with further arguments.
fn printed(command: &str, name: &str, arguments: &[&str]) -> String {
    let path = stranger(name);
    let all = [&[command, path.to_str().expect("a path")], arguments].concat();
    program(&all).unwrap_or_else(|error| panic!("{all:?}: {error}"))
}
