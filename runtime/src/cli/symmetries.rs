//! `--symmetries`: exchanges and reflections under which a mechanism stays as it is, and what of them a start has.

use std::io::Write;

use dalembert_symbolic::lower::{Program, generators, symmetries};
use serde_json::Value;

use super::Problem;
use super::json::{number, object};
use super::load::Loaded;
use crate::Run;
use crate::mechanism::System;
use crate::run::Symmetry;

/// What was found for certain values of the parameters.
pub struct Found {
    /// Those of which all others are products.
    generators: Vec<Symmetry>,
    all: Vec<dalembert_symbolic::lower::Symmetry>,
    complete: bool,
}

impl Found {
    /// Searches with the parameters of a system; `None` where nothing is asked.
    fn of(program: &Program, system: &dyn System) -> Option<Found> {
        let found = symmetries(program, &system.parameters())?;
        let generators = named(&generators(&found.found), system);
        Some(Found { generators, all: found.found, complete: found.complete })
    }

    /// Those that a start has, without products of others.
    fn of_start(&self, system: &dyn System, q: &[f64], v: &[f64]) -> Vec<Symmetry> {
        let has =
            |symmetry: &&dalembert_symbolic::lower::Symmetry| one(symmetry, system).is_of(system.description(), q, v);
        let own: Vec<_> = self.all.iter().filter(has).cloned().collect();
        named(&generators(&own), system)
    }
}

/// For every scene of a model its symmetries, and those of its start.
pub fn of_scenes(loaded: &Loaded, program: &Program, out: &mut dyn Write) -> Result<(), Problem> {
    for (k, name) in loaded.system.description().scenes.iter().enumerate() {
        let mut system = loaded.system.boxed_clone();
        for (index, value) in loaded.system.scene_parameters(k) {
            system.set_parameter(index, value);
        }
        let Some(found) = Found::of(program, &*system) else {
            writeln!(
                out,
                "  symmetries are not looked for where constraints, discontinuities, phases, states of first order or held values act"
            )?;
            return Ok(());
        };
        writeln!(out, "  symmetries of `{name}`: {}{}", listed(&found.generators), rest(found.complete))?;
        let scene = system.scene(k);
        let own = found.of_start(&*system, &scene.q, &scene.v);
        match own.is_empty() {
            true => writeln!(out, "  its start has none of them")?,
            false => {
                writeln!(out, "  its start has {}: the motion stays in {}", listed(&own), subspace(&own, &*system))?
            }
        }
    }
    Ok(())
}

/// What a run's start has.
pub struct Watched {
    /// Its symmetries, each with how far the motion departed from it.
    kept: Vec<(Symmetry, f64)>,
    /// Whether all maps were tried.
    complete: bool,
}

/// The symmetries that the start of a run has, watched along it; `None` where nothing is asked.
pub fn watch(loaded: &Loaded, run: &mut Run) -> Result<Option<Watched>, Problem> {
    let program = loaded.program()?;
    let Some(found) = Found::of(&program, &*loaded.system) else { return Ok(None) };
    let start = run.first();
    let own = found.of_start(&*loaded.system, &start.q, &start.v);
    let watched = own.into_iter().map(|symmetry| {
        let departure = run.watch_symmetry(&symmetry);
        (symmetry, departure)
    });
    Ok(Some(Watched { kept: watched.collect(), complete: found.complete }))
}

/// The lines of `simulate`.
pub fn write(watched: Option<&Watched>, out: &mut dyn Write) -> Result<(), Problem> {
    let Some(Watched { kept, complete }) = watched else {
        writeln!(
            out,
            "symmetry       not looked for where constraints, discontinuities, phases, states of first order or held values act"
        )?;
        return Ok(());
    };
    if kept.is_empty() {
        writeln!(out, "symmetry       none of the start was found{}", rest(*complete))?;
    }
    for (symmetry, departure) in kept {
        writeln!(out, "symmetry       {}: the motion departs from it by {departure:.1e} at most", symmetry.name)?;
    }
    Ok(())
}

/// The same as data; `null` where nothing is asked.
pub fn as_json(watched: Option<&Watched>) -> Value {
    let one = |(symmetry, departure): &(Symmetry, f64)| {
        object([("symmetry", symmetry.name.clone().into()), ("departure", number(*departure))])
    };
    watched.map_or(Value::Null, |watched| watched.kept.iter().map(one).collect())
}

fn rest(complete: bool) -> &'static str {
    if complete { "" } else { "; there are too many maps of this kind to try all" }
}

fn listed(symmetries: &[Symmetry]) -> String {
    let names: Vec<&str> = symmetries.iter().map(|symmetry| symmetry.name.as_str()).collect();
    if names.is_empty() { "none found".to_owned() } else { names.join("; ") }
}

/// What holds as long as symmetries are kept: `theta = 0, a = -b`.
fn subspace(symmetries: &[Symmetry], system: &dyn System) -> String {
    let name = |i: usize| system.description().coordinate_name(i);
    let mut equations: Vec<String> = Vec::new();
    for symmetry in symmetries {
        for (i, (to, opposite)) in symmetry.images.iter().enumerate() {
            let equation = match (i == *to, opposite) {
                (true, true) => format!("{} = 0", name(i)),
                (false, _) if i < *to => format!("{} = {}{}", name(i), if *opposite { "-" } else { "" }, name(*to)),
                _ => continue,
            };
            if !equations.contains(&equation) {
                equations.push(equation);
            }
        }
    }
    equations.join(", ")
}

fn named(symmetries: &[dalembert_symbolic::lower::Symmetry], system: &dyn System) -> Vec<Symmetry> {
    symmetries.iter().map(|symmetry| one(symmetry, system)).collect()
}

/// `a <-> b, x -> -x`.
fn one(symmetry: &dalembert_symbolic::lower::Symmetry, system: &dyn System) -> Symmetry {
    let name = |i: usize| system.description().coordinate_name(i);
    let images = symmetry.images.iter().enumerate();
    let words = images.filter_map(|(i, (to, opposite))| {
        let sign = if *opposite { "-" } else { "" };
        match i.cmp(to) {
            std::cmp::Ordering::Equal if *opposite => Some(format!("{} -> -{}", name(i), name(i))),
            std::cmp::Ordering::Less => Some(format!("{} <-> {sign}{}", name(i), name(*to))),
            _ => None,
        }
    });
    Symmetry { name: words.collect::<Vec<_>>().join(", "), images: symmetry.images.clone() }
}
