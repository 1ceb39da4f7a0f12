//! `--steady` and speeds of `--at`: what goes on at a constant rate, and how fast as something else changes.

use std::cell::RefCell;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;

use super::super::Problem;
use super::super::load::{Loaded, pairs};
use super::super::set_up::{Reader, coordinate_index, parameter_index};
use super::failed;
use crate::linear::{Guess, Varied, has_dependent_coordinates, lone_steady_coordinates, steady_coordinates};

/// The speeds that are kept.
pub struct Speeds {
    scene: usize,
    /// Coordinates whose speeds are those of the scene's start.
    of_scene: Vec<usize>,
    /// Coordinates whose speeds are given by hand.
    given: Vec<(usize, String)>,
    /// All, with the present parameters; 0 of what rests or follows.
    pub v: Vec<f64>,
}

impl Speeds {
    /// As the options say, from a scene's start, with inputs held.
    pub fn new(loaded: &Loaded, options: &ArgMatches, scene: usize, inputs: &[f64]) -> Result<Speeds, Problem> {
        let start = loaded.system.scene(scene);
        let mut of_scene = match options.get_flag("steady") {
            false => Vec::new(),
            true => going(loaded, &Guess { inputs: inputs.to_vec(), ..Guess::at(&start.q) }, &start.v)?,
        };
        // States of first order are no speeds that go on: they are looked for.
        of_scene.retain(|i| *i < loaded.system.description().mechanical());
        let mut v = vec![0.0; start.v.len()];
        of_scene.iter().for_each(|i| v[*i] = start.v[*i]);
        let mut given = Vec::new();
        for (name, text) in pairs(options, "at")? {
            if let Some(name) = name.strip_suffix('\'') {
                given.push((coordinate_index(loaded, name)?, text));
            }
        }
        Ok(Speeds { scene, of_scene, given, v })
    }

    /// Coordinates whose speeds are those of the scene's start, with whatever parameters.
    pub fn followed(&self) -> Vec<usize> {
        let given = |i: &usize| self.given.iter().any(|(given, _)| given == i);
        self.of_scene.iter().copied().filter(|i| !given(i)).collect()
    }

    /// What `--vary` names, and the unit and the kind of its values.
    pub fn varied(&self, loaded: &Loaded, reader: &mut Reader, name: &str) -> Result<(Varied, String, Sets), Problem> {
        if let Some(name) = name.strip_suffix('\'') {
            let index = coordinate_index(loaded, name)?;
            let unit = match &*loaded.system.description().coordinates[index].unit {
                "" => String::new(),
                unit => format!("{unit}/s"),
            };
            return Ok((Varied::Speed(index), unit, Sets::Speed(index)));
        }
        let index = parameter_index(loaded, name)?;
        let unit = loaded.system.description().parameters[index].unit.to_string();
        let varied = match self.of_scene.is_empty() && self.given.is_empty() {
            true => Varied::Parameter(index),
            false => self.depending(loaded, reader, index)?,
        };
        Ok((varied, unit, Sets::Parameter(index)))
    }

    /// The speeds as functions of a parameter, which the scene's start, and values given by hand, may contain.
    fn depending(&self, loaded: &Loaded, reader: &mut Reader, parameter: usize) -> Result<Varied, Problem> {
        let world = RefCell::new((loaded.system.boxed_clone(), reader.model(loaded)?.clone()));
        let (scene, of_scene, given) = (self.scene, self.of_scene.clone(), self.given.clone());
        Ok(Varied::with_speeds(parameter, move |value| {
            let (system, model) = &mut *world.borrow_mut();
            system.set_parameter(parameter, value);
            let start = system.scene(scene).v;
            let mut v = vec![0.0; start.len()];
            of_scene.iter().for_each(|i| v[*i] = start[*i]);
            for (i, text) in &given {
                let plain = text.trim().parse::<f64>().ok().filter(|number| number.is_finite());
                let mut read = || model.constant(text, Sets::Speed(*i), &system.parameters());
                v[*i] = plain.unwrap_or_else(|| read().unwrap_or(f64::NAN));
            }
            v
        }))
    }
}

/// Whether coordinates go on together where none does alone, as two wheels on an elastic shaft do: small motions are then about a steady motion of a
/// mechanism with dependent coordinates, though it has no constraints.
pub(super) fn go_on_together(loaded: &Loaded, guess: &Guess) -> Result<bool, Problem> {
    let alone = || lone_steady_coordinates(&*loaded.system, guess).map_err(failed);
    Ok(guess.v.iter().any(|v| *v != 0.0) && !has_dependent_coordinates(&*loaded.system) && alone()?.is_empty())
}

/// The coordinates that can go on steadily, from a start with these speeds.
fn going(loaded: &Loaded, guess: &Guess, start: &[f64]) -> Result<Vec<usize>, Problem> {
    if !has_dependent_coordinates(&*loaded.system) {
        let alone = lone_steady_coordinates(&*loaded.system, guess).map_err(failed)?;
        if !alone.is_empty() {
            return Ok(alone);
        }
    }
    let going = steady_coordinates(&*loaded.system, guess).map_err(failed)?;
    if let Some(turning) = turning(loaded, guess, start, &going)? {
        return Ok(turning);
    }
    let still = |first: usize| start[first..first + 4].iter().all(|rate| *rate == 0.0);
    let firsts = loaded.system.description().rotations.iter().map(|first| *first as usize);
    if let Some(turns) = firsts.into_iter().find(|first| !still(*first) && !going.is_empty()) {
        let name = loaded.system.description().coordinate_name(turns);
        let name = name.trim_end_matches(".w");
        return Err(Problem::usage(format!(
            "--steady: the rotation `{name}` turns at the start, and its four numbers have no constant rates; describe the turn that \
             goes on by an angle on which nothing depends, before the others: `rotate: [[z, spin], [x, a], [y, b]]` for a turn about z, with \
             `spin'` at the start"
        )));
    }
    match going.is_empty() {
        false => Ok(going),
        true if !has_dependent_coordinates(&*loaded.system) => Err(Problem::usage(format!(
            "--steady: `{}` has no coordinate on whose value nothing depends, and none that go on together; describe what turns by an angle \
             on which nothing depends",
            loaded.name
        ))),
        true => Err(Problem::usage(format!(
            "--steady: in `{}` the equations or the constraints depend on the value of every coordinate, so that none can go \
             on at a constant rate; describe what turns by an angle on which nothing depends, as in `[r*cos(phi), r*sin(phi)]` with \
             the constraint `r - l`, not by its x and y",
            loaded.name
        ))),
    }
}

/// The same with those that turn as a whole, where the start has such speeds and a steady motion has them too.
#[cfg(feature = "modal")]
fn turning(loaded: &Loaded, guess: &Guess, start: &[f64], going: &[usize]) -> Result<Option<Vec<usize>>, Problem> {
    use crate::linear::{linearise_tangent, turning_coordinates};
    let system = &*loaded.system;
    let all = turning_coordinates(system, guess).map_err(failed)?;
    if !all.iter().any(|i| start[*i] != 0.0 && !going.contains(i)) {
        return Ok(None);
    }
    let v = (0..start.len()).map(|i| if all.contains(&i) { start[i] } else { 0.0 }).collect();
    match linearise_tangent(system, &Guess { v, ..guess.clone() }, false) {
        Ok(_) => Ok(Some(all)),
        // Where nothing else goes on, a rest would be another motion than the one that was asked for.
        Err(error) if going.iter().all(|i| start[*i] == 0.0) => Err(failed(error)),
        Err(_) => Ok(None),
    }
}

#[cfg(not(feature = "modal"))]
fn turning(_: &Loaded, _: &Guess, _: &[f64], _: &[usize]) -> Result<Option<Vec<usize>>, Problem> {
    Ok(None)
}
