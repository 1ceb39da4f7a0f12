//! `simulate --arrows` and `--mark-events`: forces as arrows over an animation, and events of the run.

use clap::ArgMatches;
use dalembert_symbolic::diagnose::did_you_mean_or;
use dalembert_symbolic::model::{PointForces, load_with_forces};
use dalembert_symbolic::{gate, lower};

use super::Problem;
use super::load::{Loaded, listed};
use super::set_up::unknown;
use crate::Run;
use crate::mechanism::{Interpreted, System};
use crate::run::Forces;
use crate::show::{Animation, Instant, has_units};

/// A force below this part of what the energies of the mechanism are over its size is rounding.
const ROUNDING: f64 = 1e-9;

/// What is drawn over the mechanism.
#[derive(Default)]
pub struct Over {
    forces: Option<Asked>,
    /// The events that are marked.
    events: Option<Vec<String>>,
}

/// The forces that are drawn.
struct Asked {
    /// The mechanism with all forces as its last outputs.
    system: Box<dyn System>,
    /// The name of each, where it is drawn.
    names: Vec<Option<String>>,
}

impl Over {
    /// Reads the options; names are looked up before anything is computed.
    ///
    /// # Errors
    /// Names that are not known, and a mechanism in which no force acts at a point.
    pub fn read(loaded: &Loaded, options: &ArgMatches) -> Result<Over, Problem> {
        let given = |option: &str| options.contains_id(option).then(|| listed(options, option));
        Over::of(loaded, given("arrows").as_deref(), given("mark-events").as_deref())
    }

    /// Forces of these names, and events; all of them where a list is empty.
    ///
    /// # Errors
    /// As [`Over::read`].
    pub fn of(loaded: &Loaded, forces: Option<&[String]>, events: Option<&[String]>) -> Result<Over, Problem> {
        Ok(Over {
            forces: forces.map(|names| asked(loaded, names)).transpose()?,
            events: events.map(|names| marked(loaded, names)).transpose()?,
        })
    }

    /// An animation of a run with what is drawn over it.
    ///
    /// # Errors
    /// Forces of a run with an input of other discontinuities than the file's.
    pub fn over(&self, run: &Run, mut animation: Animation) -> Result<Animation, Problem> {
        if let Some(names) = &self.events {
            let of_name = |name: &str| names.iter().any(|known| known == name);
            let happened = run.events.iter().filter(|event| of_name(&event.name));
            animation.events = happened.map(|event| Instant { x: event.state.t, name: event.name.clone() }).collect();
        }
        let Some(Asked { system, names }) = &self.forces else { return Ok(animation) };
        let times: Vec<f64> = animation.frames.iter().map(|(time, _)| *time).collect();
        if times.is_empty() {
            return Ok(animation);
        }
        let Some(mut forces) = run.forces(&**system, &times, names.len()) else {
            return Err(Problem::usage(
                "--arrows: an --input that jumps or turns where the file's does not changes the equations; write it into the file",
            ));
        };
        forces.leave_out_below(ROUNDING * forces.energy / animation.reach());
        let drawn: Vec<usize> = (0..names.len()).filter(|place| names[*place].is_some()).collect();
        if !forces.keep(&drawn) {
            eprintln!("warning: --arrows: no force that is drawn is ever other than 0");
        }
        let Forces { frames, .. } = forces;
        let unit = if has_units(&run.description) { "N" } else { "" };
        Ok(animation.with_arrows(names.iter().flatten(), unit, &frames))
    }
}

fn asked(loaded: &Loaded, wanted: &[String]) -> Result<Asked, Problem> {
    if loaded.system.description().draw.is_empty() {
        return Err(Problem::usage(format!(
            "--arrows are drawn over the mechanism, and {} has no `draw`",
            loaded.path
        )));
    }
    let model = load_with_forces(&loaded.files, &loaded.source, &loaded.sizes);
    let program = model.and_then(gate::judged).and_then(lower::lower).map_err(|problems| loaded.problem(&problems))?;
    let forces = program.model.point_forces.clone();
    if forces.names.is_empty() {
        return Err(Problem::usage(nothing_acts(&loaded.name, &forces)));
    }
    for name in wanted {
        look_up(name, &forces)?;
    }
    let names = forces.names.into_iter().map(|name| {
        let is_wanted = wanted.is_empty() || wanted.iter().any(|wanted| is_of(&name, wanted));
        is_wanted.then_some(name)
    });
    Ok(Asked { names: names.collect(), system: Box::new(Interpreted::new(program, &loaded.source)) })
}

/// Whether a name is this one, or a member of the family of this name.
fn is_of(name: &str, wanted: &str) -> bool {
    name == wanted || name.split('[').next() == Some(wanted)
}

fn look_up(name: &str, forces: &PointForces) -> Result<(), Problem> {
    if forces.names.iter().any(|known| is_of(known, name)) {
        return Ok(());
    }
    if forces.elsewhere.iter().any(|known| is_of(known, name)) {
        let known: Vec<&str> = distinct(&forces.names);
        return Err(Problem::usage(format!(
            "--arrows: the file does not say at which point `{name}` acts as a force; those with a point are {}",
            known.join(", ")
        )));
    }
    let known = distinct(&forces.names);
    let hint = did_you_mean_or(name, &known);
    Err(Problem::usage(format!("no force is called `{name}`; {hint}")))
}

fn distinct(names: &[String]) -> Vec<&str> {
    let mut known: Vec<&str> = names.iter().map(String::as_str).collect();
    known.dedup();
    known
}

/// What is said of a mechanism without forces at points.
fn nothing_acts(model: &str, forces: &PointForces) -> String {
    let others = match forces.elsewhere.as_slice() {
        [] => "it has no constraints, joints, contacts, loads or named reactions".to_owned(),
        names => format!("the file does not say at which points {} act", names.join(", ")),
    };
    format!(
        "--arrows: {model} has no force to draw: {others}; `reactions: {{pin_force: {{on: BODY, at: POINT}}}}` of `balances` names one"
    )
}

fn marked(loaded: &Loaded, names: &[String]) -> Result<Vec<String>, Problem> {
    let known: Vec<&str> = loaded.system.description().events.iter().map(|event| event.name.as_ref()).collect();
    if known.is_empty() {
        return Err(Problem::usage(format!("--mark-events: {} has no events", loaded.name)));
    }
    for name in names {
        if !known.contains(&name.as_str()) {
            return Err(unknown("event", name, known.iter().copied()));
        }
    }
    let all = || known.iter().map(|name| (*name).to_owned()).collect();
    Ok(if names.is_empty() { all() } else { names.to_vec() })
}
