//! What `modes` linearises as one JSON object, for programs that design controllers: M q'' + C q' + K q = F u, and x' = A x + B u.

use clap::ArgMatches;
use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::Reader;
use super::super::{Context, Problem};
#[cfg(feature = "modal")]
use super::state_space::input_unit;
use super::state_space::{all_inputs, matrix};
use super::trim::Trim;
use super::{Place, Prepared, failed, prepared};
#[cfg(feature = "modal")]
use crate::linear::linearise_states;
use crate::linear::{
    Equilibrium, InputOutput, Observed, equilibrium_here, equilibrium_near, has_dependent_coordinates, linearise,
    linearise_constrained,
};

/// Linearises as `modes` does, by the same options, and returns all matrices with names and units.
pub fn linearised(context: Context<'_>, options: &ArgMatches) -> Result<Value, Problem> {
    let Prepared { loaded, mut reader, place: Place { guess, here, trim }, held, .. } = prepared(context, options)?;
    let system = &*loaded.system;
    let warnings = ("warnings", json!(loaded.warnings.iter().chain(&held).collect::<Vec<_>>()));
    if system.description().has_states() {
        return of_first_order(&loaded, &mut reader, (&guess, here), trim.as_ref(), warnings);
    }
    let linear = match has_dependent_coordinates(system) {
        true => linearise_constrained(system, &guess, here).map_err(failed)?.linear,
        false => {
            let found = if here { equilibrium_here(system, &guess) } else { equilibrium_near(system, &guess) };
            linearise(system, &found.map_err(failed)?).map_err(failed)?
        }
    };
    let drives = all_inputs(&loaded, &mut reader, &linear)?;
    let state = linear.input_output(&drives, &Observed::coordinates(&linear)).map_err(failed)?;
    let input = linear.input.to_dense();
    let of_order = |order: usize| DMatrix::from_fn(linear.len(), linear.inputs.len(), |i, j| input[(i, 3 * j + order)]);
    let entries = [
        ("model", json!(loaded.name)),
        ("equilibrium", place(&linear.equilibrium)),
        ("coordinates", json!(linear.coordinates)),
        ("coordinate_units", json!(linear.units)),
        ("inputs", json!(linear.inputs)),
        ("input_units", json!(drives.iter().map(|drive| drive.unit.clone()).collect::<Vec<_>>())),
        ("M", matrix(&linear.m())),
        ("C", matrix(&linear.c())),
        ("K", matrix(&linear.k())),
        ("F", matrix(&of_order(0))),
        ("F_rates", matrix(&of_order(1))),
        ("F_accelerations", matrix(&of_order(2))),
        ("state", of_state(&state)),
        warnings,
    ];
    Ok(object(entries.into_iter().chain(trim.iter().map(Trim::as_json))))
}

#[cfg(feature = "modal")]
fn of_first_order(
    loaded: &Loaded,
    reader: &mut Reader,
    (guess, here): (&crate::linear::Guess, bool),
    trim: Option<&Trim>,
    warnings: (&'static str, Value),
) -> Result<Value, Problem> {
    let system = &*loaded.system;
    let found = linearise_states(system, guess, here).map_err(failed)?;
    let names = &system.description().inputs;
    let units = names.iter().map(|name| input_unit(loaded, reader, name)).collect::<Result<Vec<_>, _>>()?;
    let inputs: Vec<(usize, String)> = units.iter().cloned().enumerate().collect();
    let state = found.input_output(system, &inputs, &[]).map_err(failed)?;
    let entries = [
        ("model", json!(loaded.name)),
        ("equilibrium", object(found.place.into_iter().map(|(name, value)| (name, number(value))))),
        ("inputs", json!(names.iter().map(|name| &**name).collect::<Vec<_>>())),
        ("input_units", json!(units)),
        ("state", of_state(&state)),
        warnings,
    ];
    Ok(object(entries.into_iter().chain(trim.map(Trim::as_json))))
}

#[cfg(not(feature = "modal"))]
fn of_first_order(
    _: &Loaded,
    _: &mut Reader,
    _: (&crate::linear::Guess, bool),
    _: Option<&Trim>,
    _: (&'static str, Value),
) -> Result<Value, Problem> {
    Err(failed(crate::linear::LinearError::NeedsFeature { feature: "modal" }))
}

/// x' = A x + B u, where u are the inputs and after each those of its rates that act.
fn of_state(found: &InputOutput) -> Value {
    let column = |list: &[[String; 2]], k: usize| json!(list.iter().map(|entry| &*entry[k]).collect::<Vec<_>>());
    object([
        ("variables", column(&found.states, 0)),
        ("units", column(&found.states, 1)),
        ("inputs", column(&found.inputs, 0)),
        ("input_units", column(&found.inputs, 1)),
        ("A", matrix(&found.a)),
        ("B", matrix(&found.b)),
    ])
}

fn place(at: &Equilibrium) -> Value {
    object(at.coordinates.iter().cloned().zip(at.q.iter().map(|q| number(*q))))
}
