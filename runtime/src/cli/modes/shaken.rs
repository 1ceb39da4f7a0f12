//! What `--drive` names: inputs, entries of `forces` and `torques`, coordinates that a force acts on.

use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::gate::{UnitPush, unit_push};
use dalembert_symbolic::model::{Sets, Work};
use nalgebra::Complex;

use super::super::Problem;
use super::super::load::Loaded;
use super::super::set_up::{Reader, unknown};
use super::state_space::input_unit;
use crate::linear::{Drive, Guess, Linearised, Source, force_unit};
use crate::show::has_units;

/// A drive of size 1, in words and with its unit.
#[derive(Default)]
pub struct Shaken {
    pub drive: Drive,
    /// `push1`, `a force on x`.
    pub label: String,
    /// What its size is measured in; empty where that is a pure number or not known.
    pub per: String,
}

/// What can be shaken of a linear model, and where it rests.
pub struct Shakeable {
    /// Its inputs, and the coordinates of the file.
    inputs: Vec<String>,
    coordinates: Vec<String>,
    at: Guess,
}

impl Shakeable {
    /// Of small motions by M, C and K.
    pub fn of(linear: &Linearised) -> Shakeable {
        let at = &linear.equilibrium;
        Shakeable { inputs: linear.inputs.clone(), coordinates: at.coordinates.clone(), at: at.as_guess() }
    }

    /// Of small motions with states of first order, whose inputs are all of the model's.
    #[cfg(feature = "modal")]
    pub fn of_states(loaded: &Loaded, found: &crate::linear::StateSpace) -> Shakeable {
        let inputs = loaded.system.description().inputs.iter().map(ToString::to_string).collect();
        Shakeable { inputs, coordinates: found.coordinates.clone(), at: found.rest().clone() }
    }

    /// The input or coordinate of this name; an input first.
    fn source(&self, name: &str) -> Option<Source> {
        let at = |names: &[String]| names.iter().position(|known| known == name);
        at(&self.inputs).map(Source::Input).or_else(|| at(&self.coordinates).map(Source::Force))
    }
}

/// What shakes under this name, and what a size of it sets.
pub fn named(
    loaded: &Loaded,
    reader: &mut Reader,
    shakeable: &Shakeable,
    name: &str,
) -> Result<(Shaken, Sets), Problem> {
    match shakeable.source(name) {
        Some(source @ Source::Input(input)) => {
            let per = input_unit(loaded, reader, name)?;
            let known = &loaded.system.description().inputs;
            let place = known.iter().position(|known| **known == *name).unwrap_or(input);
            Ok((Shaken { drive: source.into(), label: name.to_owned(), per }, Sets::Input(place)))
        }
        Some(source @ Source::Force(coordinate)) => {
            let unit = &loaded.system.description().coordinates[coordinate].unit;
            let (label, per) = (format!("a force on {name}"), force_unit(unit));
            Ok((Shaken { drive: source.into(), label, per }, Sets::ForceOn(coordinate)))
        }
        None => load(loaded, reader, shakeable, name),
    }
}

/// A force of 1 N, or a couple of 1 N m, along the direction of an entry of the file.
fn load(loaded: &Loaded, reader: &mut Reader, shakeable: &Shakeable, name: &str) -> Result<(Shaken, Sets), Problem> {
    let model = reader.model(loaded)?;
    let Some(push) = unit_push(model, name) else {
        let pushes = model.loads.iter().filter(|load| load.work == Work::Pushes).map(|load| load.name.as_str());
        let known = shakeable.inputs.iter().map(String::as_str).chain(pushes);
        return Err(unknown(
            "input, force or coordinate",
            name,
            known.chain(shakeable.coordinates.iter().map(String::as_str)),
        ));
    };
    let size = push.given.len();
    let values = values(loaded, &shakeable.at, &push);
    let (given, along) = values.split_at(size);
    let Some(direction) = direction(&push, given) else {
        return Err(Problem::Run(format!(
            "`{name}` vanishes at the equilibrium, where its direction is not known; put an input into it, and drive by that"
        )));
    };
    let n = along.len() / size;
    let parts = (0..n).map(|i| (0..size).map(|k| direction[k] * along[k * n + i]).sum::<f64>());
    let parts = parts.enumerate().filter(|(_, q)| *q != 0.0);
    let parts = parts.map(|(i, q)| (Source::Force(i), Complex::from(q))).collect();
    let units = has_units(loaded.system.description());
    let per = match (units, push.couple) {
        (false, _) => "",
        (true, false) => "N",
        (true, true) => "N m",
    };
    let sets = if push.couple { Sets::Couple } else { Sets::Force };
    Ok((Shaken { drive: Drive { parts }, label: name.to_owned(), per: per.to_owned() }, sets))
}

/// The entry's components, and the generalized forces of each axis, at the equilibrium.
fn values(loaded: &Loaded, at: &Guess, push: &UnitPush) -> Vec<f64> {
    let (parameters, memory) = (loaded.system.parameters(), loaded.system.memory());
    let get = |list: &[f64], i: u32| list.get(i as usize).copied().unwrap_or(0.0);
    let first_state = loaded.system.description().mechanical() as u32;
    let phase = loaded.system.phase() as u32;
    let value = |symbol: Symbol| match symbol {
        Symbol::Coordinate(i) => get(&at.q, i),
        Symbol::Speed(i) => get(&at.v, i),
        Symbol::State(j) => get(&at.v, first_state + j),
        Symbol::Memory(j) => get(memory, j),
        Symbol::Parameter(i) => get(&parameters, i),
        Symbol::Input(i, 0) => get(&at.inputs, i),
        Symbol::Phase(k) => f64::from(u8::from(k == phase)),
        _ => 0.0,
    };
    let roots: Vec<_> = push.given.iter().chain(push.along.iter().flatten()).copied().collect();
    Tape::new(&push.graph, &roots).evaluate(value)
}

/// The unit vector along the entry; where it vanishes, along the only axis that it can have.
fn direction(push: &UnitPush, given: &[f64]) -> Option<Vec<f64>> {
    let size = given.iter().map(|f| f * f).sum::<f64>().sqrt();
    if size > 0.0 && size.is_finite() {
        return Some(given.iter().map(|f| f / size).collect());
    }
    let zero = dalembert_symbolic::expr::Id::ZERO;
    let axes: Vec<usize> = (0..given.len()).filter(|k| push.given[*k] != zero).collect();
    let [axis] = axes[..] else { return None };
    Some((0..given.len()).map(|k| f64::from(u8::from(k == axis))).collect())
}
