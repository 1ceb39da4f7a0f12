//! Columns on the constraints.

use super::response::Response;
use crate::mechanism::{Along, At, Function, Singular, System, rows_in_force};

/// Brings [q, δq …, q', δq' …] back to the constraints in force by the least change in the metric of M: first c = 0 of the places, with the
/// slopes J δq + ∂c/∂p δp = 0, then c' = 0 of the rates, with theirs.
///
/// # Errors
/// Those of the accelerations there.
pub(super) fn project(
    system: &dyn System,
    columns: &[Option<usize>],
    response: &mut Response,
    t: f64,
    y: &mut [f64],
) -> Result<(), Singular> {
    let n = system.len();
    let (places, rates) = y.split_at_mut(n * (columns.len() + 1));
    let rows = &system.description().rows;
    let count = rows.len();
    let (mut triples, mut off, mut moved) = (vec![0.0; 3 * count], vec![0.0; count], vec![0.0; n]);
    let active: Vec<usize> = rows_in_force(system).collect();
    for speeds in [false, true] {
        response.stand(system, At::new(t, &places[..n], &rates[..n]))?;
        system.constraints(At::new(t, &places[..n], &rates[..n]), &mut triples);
        take(&triples, &active, |row| speeds || rows[row].holonomic, speeds, &mut off);
        response.least_move(&off, &mut moved);
        let list = if speeds { &mut *rates } else { &mut *places };
        list[..n].iter_mut().zip(&moved).for_each(|(x, moved)| *x += moved);
        response.stand(system, At::new(t, &places[..n], &rates[..n]))?;
        for (k, parameter) in columns.iter().enumerate() {
            let column = n * (k + 1)..n * (k + 2);
            let along = Along {
                q: &places[column.clone()],
                v: &rates[column.clone()],
                parameter: *parameter,
                ..Along::default()
            };
            let here = At::new(t, &places[..n], &rates[..n]);
            system.slopes(Function::Constraints, here, &along, &mut triples);
            take(&triples, &active, |row| speeds || rows[row].holonomic, speeds, &mut off);
            response.least_move(&off, &mut moved);
            let list = if speeds { &mut *rates } else { &mut *places };
            list[column].iter_mut().zip(&moved).for_each(|(x, moved)| *x += moved);
        }
    }
    Ok(())
}

/// c, or c', of the rows in force that count; 0 of all others.
fn take(triples: &[f64], active: &[usize], counts: impl Fn(usize) -> bool, speeds: bool, off: &mut [f64]) {
    off.fill(0.0);
    for &row in active.iter().filter(|row| counts(**row)) {
        off[row] = triples[3 * row + usize::from(speeds)];
    }
}
