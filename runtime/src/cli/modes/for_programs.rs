//! What `modes` linearises as one JSON object, for programs that design controllers: M q'' + C q' + K q = F u + F_rates u' + F_accelerations u'',
//! and x' = A x + B u.

use clap::ArgMatches;
use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::Reader;
use super::super::{Context, Problem};
use super::model::Model;
use super::shaken::Shakeable;
use super::state_space::{self, all_inputs, input_unit, matrix};
use super::trim::Trim;
use super::{Place, Prepared, failed, instant, prepared};
#[cfg(feature = "modal")]
use crate::linear::linearise_states;
use crate::linear::{
    Equilibrium, InputOutput, Observed, equilibrium_here, equilibrium_near, has_dependent_coordinates, linearise,
    linearise_constrained,
};

/// Linearises as `modes` does, by the same options, and returns all matrices with names and units; C and D where `--out` names outputs.
pub fn linearised(context: Context<'_>, options: &ArgMatches) -> Result<Value, Problem> {
    if options.get_one::<String>("at-time").is_some() {
        return departures(context, options);
    }
    let Prepared { loaded, mut reader, place: Place { guess, here, trim }, held: notes, .. } =
        prepared(context, options)?;
    let system = &*loaded.system;
    let warnings = ("warnings", json!(loaded.warnings.iter().chain(&notes).collect::<Vec<_>>()));
    if system.description().has_states() {
        return of_first_order(&loaded, options, &mut reader, (&guess, here), trim.as_ref(), warnings);
    }
    let (free, held);
    let model = if has_dependent_coordinates(system) {
        held = linearise_constrained(system, &guess, here).map_err(failed)?;
        Model::Held(&held)
    } else {
        let found = if here { equilibrium_here(system, &guess) } else { equilibrium_near(system, &guess) };
        free = linearise(system, &found.map_err(failed)?).map_err(failed)?;
        Model::Free(&free)
    };
    let linear = model.linear();
    let drives = match options.contains_id("in") {
        true => state_space::drives(&loaded, options, &mut reader, &Shakeable::of(linear))?,
        false => all_inputs(&loaded, &mut reader, linear)?,
    };
    let state = match names_ends(options) {
        true => state_space::of_model(&loaded, options, &mut reader, model)?,
        false => linear.input_output(&drives, &Observed::coordinates(linear)).map_err(failed)?,
    };
    let of_order = |order: usize| {
        let columns: Vec<_> = drives.iter().map(|named| linear.pushed_by(&named.drive, order)).collect();
        DMatrix::from_fn(linear.len(), columns.len(), |i, j| columns[j][i])
    };
    let entries = [
        ("model", json!(loaded.name)),
        ("equilibrium", place(&linear.equilibrium)),
        ("coordinates", json!(linear.coordinates)),
        ("coordinate_units", json!(linear.units)),
        ("inputs", json!(drives.iter().map(|drive| &drive.name).collect::<Vec<_>>())),
        ("input_units", json!(drives.iter().map(|drive| &drive.unit).collect::<Vec<_>>())),
        ("M", matrix(&linear.m())),
        ("C", matrix(&linear.c())),
        ("K", matrix(&linear.k())),
        ("F", matrix(&of_order(0))),
        ("F_rates", matrix(&of_order(1))),
        ("F_accelerations", matrix(&of_order(2))),
        ("state", of_state(&state, options)),
        warnings,
    ];
    Ok(object(entries.into_iter().chain(trim.iter().map(Trim::as_json))))
}

#[cfg(feature = "modal")]
fn of_first_order(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    (guess, here): (&crate::linear::Guess, bool),
    trim: Option<&Trim>,
    warnings: (&'static str, Value),
) -> Result<Value, Problem> {
    let system = &*loaded.system;
    let found = linearise_states(system, guess, here).map_err(failed)?;
    let drives = state_space::drives(loaded, options, reader, &Shakeable::of_states(loaded, &found))?;
    let state = state_space::of_states(loaded, options, reader, &found)?;
    let entries = [
        ("model", json!(loaded.name)),
        ("equilibrium", object(found.place.into_iter().map(|(name, value)| (name, number(value))))),
        ("inputs", json!(drives.iter().map(|drive| &drive.name).collect::<Vec<_>>())),
        ("input_units", json!(drives.iter().map(|drive| &drive.unit).collect::<Vec<_>>())),
        ("state", of_state(&state, options)),
        warnings,
    ];
    Ok(object(entries.into_iter().chain(trim.map(Trim::as_json))))
}

#[cfg(not(feature = "modal"))]
fn of_first_order(
    _: &Loaded,
    _: &ArgMatches,
    _: &mut Reader,
    _: (&crate::linear::Guess, bool),
    _: Option<&Trim>,
    _: (&'static str, Value),
) -> Result<Value, Problem> {
    Err(failed(crate::linear::LinearError::NeedsFeature { feature: "modal" }))
}

/// Small departures from a motion, at an instant of it.
fn departures(context: Context<'_>, options: &ArgMatches) -> Result<Value, Problem> {
    let departures = instant::departures(context, options)?;
    let mut reader = Reader::default();
    let names = state_space::inputs(&departures.loaded, options);
    let unit = |name: &String| input_unit(&departures.loaded, &mut reader, name);
    let units = names.iter().map(unit).collect::<Result<Vec<_>, _>>()?;
    Ok(object([
        ("model", json!(departures.loaded.name)),
        ("time", number(departures.time)),
        ("place", departures.place()),
        ("inputs", json!(names)),
        ("input_units", json!(units)),
        ("state", of_state(&departures.found, options)),
        ("warnings", json!(departures.warnings)),
    ]))
}

/// Whether inputs or outputs are named.
fn names_ends(options: &ArgMatches) -> bool {
    ["in", "out"].iter().any(|name| options.contains_id(name))
}

/// x' = A x + B u, where u are the inputs and after each those of its rates that act; and y = C x + D u of outputs that are named.
fn of_state(found: &InputOutput, options: &ArgMatches) -> Value {
    let column = |list: &[[String; 2]], k: usize| json!(list.iter().map(|entry| &*entry[k]).collect::<Vec<_>>());
    let mut entries = vec![
        ("variables", column(&found.states, 0)),
        ("units", column(&found.states, 1)),
        ("inputs", column(&found.inputs, 0)),
        ("input_units", column(&found.inputs, 1)),
        ("A", matrix(&found.a)),
        ("B", matrix(&found.b)),
    ];
    if options.contains_id("out") {
        entries.extend([
            ("outputs", column(&found.outputs, 0)),
            ("output_units", column(&found.outputs, 1)),
            ("C", matrix(&found.c)),
            ("D", matrix(&found.d)),
        ]);
    }
    object(entries)
}

fn place(at: &Equilibrium) -> Value {
    object(at.coordinates.iter().cloned().zip(at.q.iter().map(|q| number(*q))))
}
