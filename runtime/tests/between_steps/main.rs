//! Nothing between two steps goes unseen: files that once ran wrong with a good status, each beside a neighbour that
//! must be left alone.
#![cfg(feature = "interpret")]

mod arguments;
mod catalogue;
mod functions;
mod nested;
mod onset;
mod parabolas;
mod poles;
mod struck;
mod tables;
mod time;
mod trust;

use dalembert::mechanism::{Interpreted, System};
use dalembert::{Error, Run, Settings, simulate};
use dalembert_symbolic::lower::compile;

/// A model file that nobody compiled, and how to run it.
struct Case {
    system: Interpreted,
    settings: Settings,
}

impl Case {
    /// With another value of a parameter.
    fn set(mut self, name: &str, value: f64) -> Self {
        let index = self.system.description().parameters.iter().position(|p| p.name == name);
        self.system.set_parameter(index.unwrap_or_else(|| panic!("no parameter `{name}`")), value);
        self
    }

    /// At another tolerance.
    fn tolerance(mut self, tolerance: f64) -> Self {
        self.settings.tolerance = tolerance;
        self
    }

    /// The run, or why it failed.
    fn try_run(&mut self) -> Result<Run, Error> {
        simulate(&mut self.system, &self.settings)
    }

    /// The run.
    fn run(&mut self) -> Run {
        self.try_run().unwrap_or_else(|error| panic!("{error}"))
    }
}

/// A model file with its default scene.
fn file(text: &str) -> Case {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
    let system = Interpreted::new(program, text);
    let settings = Settings::new(&system.scene(0));
    Case { system, settings }
}

/// A particle on the x-axis, x'' = −x with a spring, and these further lines.
fn particle(lines: &str) -> Case {
    file(&format!(
        "name: P
parameters: {{m: 1, k: 1, F: 1}}
coordinates: {{x: 1}}
{lines}
"
    ))
}

const BODY: &str = "bodies: {b: {mass: m, position: \"[x, 0]\"}}";
const SPRING: &str = "springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}";

/// A particle that coasts, with these further lines.
fn coasting(lines: &str) -> Case {
    particle(&format!("{BODY}\n{lines}"))
}

/// A particle on a spring, with these further lines.
fn sprung(lines: &str) -> Case {
    particle(&format!("{BODY}\n{SPRING}\n{lines}"))
}
