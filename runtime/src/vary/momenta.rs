//! Slopes of M x − Jᵀ P, by which jumps and starts are determined.

use crate::mechanism::{Along, At, Function, System};

/// The change of M x − Jᵀ P along a direction of (t, q, p) and of states of first order, with x and P held: n numbers; P for these rows.
pub(super) fn momentum_slopes(
    system: &dyn System,
    At { t, q, v, .. }: At<'_>,
    x: &[f64],
    (rows, impulses): (&[usize], &[f64]),
    along: &Along<'_>,
) -> Vec<f64> {
    let (n, first) = (system.len(), system.description().mechanical());
    let rest = vec![0.0; n];
    let states = |v: &[f64]| v.iter().enumerate().map(|(i, v)| if i < first { 0.0 } else { *v }).collect::<Vec<_>>();
    let (still, moves) = (states(v), states(along.v));
    let place = Along { v: &moves, a: &[], lambda: &[], ..*along };
    let residual = |a: &[f64]| {
        let mut slopes = vec![0.0; n];
        system.slopes(Function::Residual, At::new(t, q, &still).accelerated(a), &place, &mut slopes);
        slopes
    };
    // F = M a + h at rest, so that h goes out.
    let (with, without) = (residual(x), residual(&rest));
    let mut found: Vec<f64> = with.iter().zip(&without).map(|(with, without)| with - without).collect();
    if impulses.iter().all(|impulse| *impulse == 0.0) {
        return found;
    }
    let demands = |a: &[f64]| {
        let mut slopes = vec![0.0; system.description().rows.len()];
        system.slopes(Function::RowAccelerations, At::new(t, q, &still).accelerated(a), &place, &mut slopes);
        slopes
    };
    let bias = demands(&rest);
    for (i, found) in found.iter_mut().enumerate() {
        let mut unit = rest.clone();
        unit[i] = 1.0;
        // J eᵢ + γ less γ.
        let column = demands(&unit);
        *found -= rows.iter().zip(impulses).map(|(row, impulse)| impulse * (column[*row] - bias[*row])).sum::<f64>();
    }
    found
}

/// The slopes of c' of all rows along a direction.
pub(super) fn rate_slopes(system: &dyn System, at: At<'_>, along: &Along<'_>) -> Vec<f64> {
    let mut triples = vec![0.0; 3 * system.description().rows.len()];
    system.slopes(Function::Constraints, at, along, &mut triples);
    triples.chunks_exact(3).map(|triple| triple[1]).collect()
}
