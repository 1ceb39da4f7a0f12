//! Outputs that are made of reactions which are not unique.

use nalgebra::{DMatrix, DVector};

use crate::constrain::{Moment, resting_open};
use crate::matrix::svd;
use crate::mechanism::dense::{constraint_matrix, multiplier_effects};
use crate::mechanism::{At, Enforcement, System, rows_in_force};

/// A combination of multipliers does nothing whose effect is below this part of the largest.
const NOTHING: f64 = 1e-9;

/// The places of the components of outputs that multipliers change which together do nothing: where rows of the constraints in force depend on
/// each other, the motion determines sums of their multipliers only.
pub(crate) fn not_unique<S: System + ?Sized>(system: &S, t: f64, y: &[f64]) -> Vec<usize> {
    let description = system.description();
    let (n, rows) = (system.len(), description.rows.len());
    let active: Vec<usize> = rows_in_force(system).collect();
    let rank = description.phases.get(system.phase()).map_or(active.len(), |phase| phase.rank as usize);
    let sprung = matches!(system.enforcement(), Enforcement::Springs { .. });
    if rank >= active.len() || description.output_len() == 0 || sprung {
        return Vec::new();
    }
    let at = At::packed(t, y, n);
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; rows]);
    let mut slopes = DMatrix::zeros(description.output_len(), 3 * n + rows + 3 * description.inputs.len() + 1);
    if system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err()
        || !system.output_slopes(at.accelerated(&a).constrained(&lambda), slopes.as_mut_slice())
    {
        return Vec::new();
    }
    let Some(idle) = idle_combinations(&multiplier_effects(system, at, &active)) else { return Vec::new() };
    let by_multipliers = slopes.columns(3 * n, rows).select_columns(&active);
    let changes = |row: &usize| {
        let line = by_multipliers.row(*row);
        (line * &idle).amax() > NOTHING * line.amax()
    };
    (0..by_multipliers.nrows()).filter(changes).collect()
}

/// The constraints in force of which friction is made, and whose share of a force is not determined, though the motion depends on it: multipliers w
/// with Jᵀ w = 0 and (Jᵀ + B) w ≠ 0.  Contacts take part that count as open, though others hold them closed.
pub(crate) fn deciding<S: System + ?Sized>(system: &S, moment: &Moment<'_>) -> Vec<String> {
    let description = system.description();
    let mut active: Vec<usize> = rows_in_force(system).collect();
    let rank = description.phases.get(system.phase()).map_or(active.len(), |phase| phase.rank as usize);
    let open = resting_open(system, moment);
    if rank >= active.len() && open.is_empty() {
        return Vec::new();
    }
    active.extend(open);
    active.sort_unstable();
    let at = At::packed(moment.t, moment.y, system.len());
    let effects = multiplier_effects(system, at, &active);
    let Some(idle) = idle_combinations(&constraint_matrix(system, at, &active).transpose()) else { return Vec::new() };
    let moves = |combination: &usize| {
        let w = idle.column(*combination);
        let terms: f64 = effects.column_iter().zip(w.iter()).map(|(effect, w)| effect.norm() * w.abs()).sum();
        (&effects * w).norm() > NOTHING * terms
    };
    let moving: Vec<usize> = (0..idle.ncols()).filter(moves).collect();
    let largest = idle.amax();
    let takes_part = |k: &usize| moving.iter().any(|combination| idle[(*k, *combination)].abs() > NOTHING * largest);
    (0..active.len()).filter(takes_part).map(|k| description.rows[active[k]].name.to_string()).collect()
}

/// Combinations of columns, as columns, that are 0.
fn idle_combinations(effects: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let m = effects.ncols();
    let size = DVector::from_iterator(m, effects.column_iter().map(|column| column.norm()));
    let unit = size.map(|size| if size > 0.0 { 1.0 / size } else { 1.0 });
    // Square, so that there is a direction for each column.
    let scaled = (effects * DMatrix::from_diagonal(&unit)).resize_vertically(effects.nrows().max(m), 0.0);
    let found = svd(scaled, false, true)?;
    let largest = found.singular_values.max();
    let directions = found.v_t?.transpose();
    let idle: Vec<usize> = (0..m).filter(|k| found.singular_values[*k] <= NOTHING * largest).collect();
    Some(DMatrix::from_diagonal(&unit) * directions.select_columns(&idle))
}
