//! Small motions as matrices, for programs that design controllers: M q'' + C q' + K q = F u, and x' = A x + B u.

use clap::ArgMatches;
use nalgebra::DMatrix;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::set_up::Reader;
use super::super::{Context, Problem};
use super::{Prepared, failed, prepared};
use crate::linear::{
    Equilibrium, LinearError, equilibrium_here, equilibrium_near, has_dependent_coordinates, linearise,
    linearise_constrained,
};
#[cfg(feature = "modal")]
use crate::linear::{StateSpace, linearise_states};
use crate::mechanism::rate_name;
use crate::show::unit;

/// Linearises as `modes` does, by the same options, and returns all matrices with names and units.
pub fn linearised(context: Context<'_>, options: &ArgMatches) -> Result<Value, Problem> {
    let Prepared { loaded, mut reader, guess, held, .. } = prepared(context, options)?;
    let (system, here) = (&*loaded.system, options.get_flag("here"));
    let warnings = ("warnings", json!(loaded.warnings.iter().chain(&held).collect::<Vec<_>>()));
    if system.description().has_states() {
        return of_first_order(&loaded, &mut reader, &guess, here, warnings);
    }
    let linear = match has_dependent_coordinates(system) {
        true => linearise_constrained(system, &guess, here).map_err(failed)?.linear,
        false => {
            let found = if here { equilibrium_here(system, &guess) } else { equilibrium_near(system, &guess) };
            linearise(system, &found.map_err(failed)?).map_err(failed)?
        }
    };
    let units = input_units(&loaded, &mut reader, &linear.inputs)?;
    let input = linear.input.to_dense();
    let of_order = |order: usize| DMatrix::from_fn(linear.len(), linear.inputs.len(), |i, j| input[(i, 3 * j + order)]);
    let drive = linear.m().lu().solve(&of_order(0));
    let drive = drive.ok_or_else(|| failed(LinearError::NoConvergence { what: "the accelerations' derivatives" }))?;
    let (n, mut b) = (linear.len(), DMatrix::zeros(2 * linear.len(), linear.inputs.len()));
    b.rows_mut(n, n).copy_from(&drive);
    let speeds = linear.coordinates.iter().map(|name| rate_name(name));
    let variables: Vec<String> = linear.coordinates.iter().cloned().chain(speeds).collect();
    Ok(object([
        ("model", json!(loaded.name)),
        ("equilibrium", place(&linear.equilibrium)),
        ("coordinates", json!(linear.coordinates)),
        ("coordinate_units", json!(linear.units)),
        ("inputs", json!(linear.inputs)),
        ("input_units", json!(units)),
        ("M", matrix(&linear.m())),
        ("C", matrix(&linear.c())),
        ("K", matrix(&linear.k())),
        ("F", matrix(&of_order(0))),
        ("F_rates", matrix(&of_order(1))),
        ("F_accelerations", matrix(&of_order(2))),
        ("state", state(&loaded, &variables, &linear.state_matrix().map_err(failed)?, &b)),
        warnings,
    ]))
}

#[cfg(feature = "modal")]
fn of_first_order(
    loaded: &Loaded,
    reader: &mut Reader,
    guess: &crate::linear::Guess,
    here: bool,
    warnings: (&'static str, Value),
) -> Result<Value, Problem> {
    let StateSpace { place, variables, matrix, inputs, input, .. } =
        linearise_states(&*loaded.system, guess, here).map_err(failed)?;
    Ok(object([
        ("model", json!(loaded.name)),
        ("equilibrium", object(place.into_iter().map(|(name, value)| (name, number(value))))),
        ("inputs", json!(inputs)),
        ("input_units", json!(input_units(loaded, reader, &inputs)?)),
        ("state", state(loaded, &variables, &matrix, &input)),
        warnings,
    ]))
}

#[cfg(not(feature = "modal"))]
fn of_first_order(
    _: &Loaded,
    _: &mut Reader,
    _: &crate::linear::Guess,
    _: bool,
    _: (&'static str, Value),
) -> Result<Value, Problem> {
    Err(failed(LinearError::NeedsFeature { feature: "modal" }))
}

/// x' = A x + B u.
fn state(loaded: &Loaded, variables: &[String], a: &DMatrix<f64>, b: &DMatrix<f64>) -> Value {
    let units: Vec<String> = variables.iter().map(|name| unit(loaded.system.description(), name)).collect();
    object([("variables", json!(variables)), ("units", json!(units)), ("A", matrix(a)), ("B", matrix(b))])
}

fn input_units(loaded: &Loaded, reader: &mut Reader, inputs: &[String]) -> Result<Vec<String>, Problem> {
    let model = reader.model(loaded)?;
    let mut unit = |input: &String| model.unit_of(input).map(|unit| dalembert_symbolic::print::si_unit(&unit));
    Ok(inputs.iter().map(|input| unit(input).unwrap_or_default()).collect())
}

fn place(at: &Equilibrium) -> Value {
    object(at.coordinates.iter().cloned().zip(at.q.iter().map(|q| number(*q))))
}

fn matrix(matrix: &DMatrix<f64>) -> Value {
    matrix.row_iter().map(|row| row.iter().map(|x| number(*x)).collect::<Vec<_>>()).collect::<Vec<_>>().into()
}
