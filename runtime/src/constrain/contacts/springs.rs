//! Whether springs that are alike at all contacts, as those by which rows that depend on each other share a force, would be pressed where a contact
//! counts as open.

use nalgebra::DVector;

use super::bounds::{Bound, Lowest, lowest};
use crate::mechanism::dense::constraint_matrix;
use crate::mechanism::{At, Contact, Solutions, System, rows_in_force};

/// By how much springs in the place of rows that are not in force would be long, if springs stood in the place of all others, alike at all contacts, as
/// forces are shared among rows that depend on each other (`mechanism/kkt/shares.rs`); with the size of what makes it.  A place of the bodies is looked
/// for at which the shortest is the longest.
pub(super) fn length_of_springs(
    system: &dyn System,
    at: At<'_>,
    (compliance, lambda): (&[f64], &[f64]),
    rows: &[usize],
) -> Option<(f64, f64)> {
    if rows.is_empty() {
        return None;
    }
    let contacts = &system.contacts().all;
    let normals: Vec<u32> = contacts.iter().filter_map(|contact| contact.normal).collect();
    let tangents: Vec<u32> = contacts.iter().flat_map(Contact::tangents).collect();
    let active: Vec<usize> = rows_in_force(system).filter(|row| !tangents.contains(&(*row as u32))).collect();
    let is_contact = |row: &usize| normals.contains(&(*row as u32));
    let pressed: Vec<f64> = active.iter().filter(|row| is_contact(row)).map(|row| compliance[*row]).collect();
    let mean = pressed.iter().sum::<f64>() / pressed.len().max(1) as f64;
    let shortened = |row: &usize| lambda[*row] * if is_contact(row) { mean } else { compliance[*row] };
    let shortened: Vec<f64> = active.iter().map(shortened).collect();
    let size = shortened.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let scaled: Vec<f64> = shortened.iter().map(|x| if size > 0.0 { x / size } else { 0.0 }).collect();
    let places = Solutions::of(&constraint_matrix(system, at, &active), &scaled);
    let matrix = constraint_matrix(system, at, rows);
    let mut slopes = &matrix * &places.basis;
    for mut column in slopes.column_iter_mut() {
        let largest = column.amax();
        column *= if largest > 0.0 { 1.0 / largest } else { 0.0 };
    }
    let values = &matrix * &places.particular;
    let mut bounds: Vec<Bound> = slopes
        .row_iter()
        .zip(values.iter())
        .map(|(slope, value)| Bound { slope: slope.transpose(), value: *value })
        .collect();
    // Long enough.
    bounds.push(Bound { slope: DVector::zeros(slopes.ncols()), value: -1.0 });
    match lowest(&bounds, &mut DVector::zeros(slopes.ncols()))? {
        Lowest::At(shortest) => Some((-size * shortest, size)),
        Lowest::Falls(_) => None,
    }
}
