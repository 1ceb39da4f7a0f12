//! Systems of balances whose A and b are not formed, since accelerations are their only unknowns and these are many.

use super::Gate;
use super::balances::empty;
use super::dense::factor;
use super::report::Agreement;
use super::state::{State, describe};
use crate::derive::momentum::Unformed;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Graph, Measured, Symbol, Tape};
use crate::model::{Balance, BalanceSystem, Model};
use crate::number::DoubleDouble;
use crate::random::Random;

/// A pivot of A that is more than this beside the largest entry of its column is certainly none: rounding in `f64` leaves some 1e-13 of an A
/// of a thousand coordinates.
const CERTAIN: f64 = 1e-10;

/// Whether Lagrange's accelerations leave nothing of any equation, each contains an acceleration, and together they determine all.
pub(super) fn agree(
    model: &Model,
    (system, unformed): (&BalanceSystem, &Unformed),
    states: &[State],
    gate: Gate,
) -> Result<Agreement, Box<Problem>> {
    let owners: Vec<&Balance> =
        system.balances.iter().flat_map(|balance| std::iter::repeat_n(balance, balance.components)).collect();
    if let Some(balance) = silent(&model.graph, unformed, states).and_then(|equation| owners.get(equation)) {
        return Err(Box::new(empty(balance)));
    }
    let tape = Tape::new(&model.graph, &unformed.values);
    let mut worst = 0.0_f64;
    for state in states {
        let rows = tape.evaluate(|s| state.measured(s));
        let largest = rows.iter().fold(0.0_f64, |most, row| most.max(row.magnitude));
        for (row, balance) in rows.iter().zip(&owners) {
            let left = row.value.to_f64().abs();
            // Nothing can be said where it is not finite.
            if left.is_finite() && !gate.agrees(left, row.magnitude, largest) {
                let label = &balance.label;
                let off =
                    format!("{label} is off by {:.1e} of its terms, at {}", row.relative(), describe(model, state));
                return Err(Box::new(verdicts::balance_violated(balance.place.clone(), label, off, String::new())));
            }
            worst = worst.max(if left.is_finite() { row.relative() } else { 0.0 });
        }
    }
    if !states.iter().any(|state| determines(&model.graph, unformed, state)) {
        let state = states.first().map_or_else(String::new, |s| describe(model, s));
        return Err(Box::new(verdicts::balances_singular(system.place.clone(), &system.name, state)));
    }
    Ok(Agreement { between: ("Lagrange".to_owned(), system.name.clone()), states: states.len(), worst })
}

/// An equation that no acceleration changes at any state: along accelerations of any kind nothing happens.
fn silent(graph: &Graph, unformed: &Unformed, states: &[State]) -> Option<usize> {
    let mut random = Random::new();
    let along: Vec<Measured> =
        unformed.values.iter().map(|_| Measured::exact(random.between(0.5, 1.5).into())).collect();
    let tape = Tape::new(graph, &unformed.along);
    let mut speaks = vec![states.is_empty(); unformed.along.len()];
    for state in states {
        let value = |s: Symbol| match s {
            Symbol::Dummy(i) => along.get(i as usize).copied().unwrap_or(Measured::exact(DoubleDouble::ONE)),
            _ => state.measured(s),
        };
        for (speaks, change) in speaks.iter_mut().zip(tape.evaluate(value)) {
            *speaks |= !change.vanishes(1e6);
        }
    }
    speaks.iter().position(|speaks| !speaks)
}

/// Whether A has an inverse at a state: in `f64` where its pivots leave no doubt, else in double-double.
fn determines(graph: &Graph, unformed: &Unformed, state: &State) -> bool {
    let (n, tape) = (state.q.len(), Tape::new(graph, &unformed.along));
    if unformed.along.len() != n {
        return false;
    }
    let mut scratch = Vec::new();
    let mut line = vec![0.0; n];
    let mut matrix = vec![0.0; n * n];
    for (j, row) in matrix.chunks_exact_mut(n).enumerate() {
        let unit = |s: Symbol| match s {
            Symbol::Dummy(i) => f64::from(u8::from(i as usize == j)),
            _ => state.value(s).to_f64(),
        };
        tape.run(unit, &mut scratch, &mut line);
        row.copy_from_slice(&line);
    }
    if matrix.iter().any(|x| !x.is_finite()) {
        return false;
    }
    has_certain_inverse(matrix, n) || {
        let column = |j: usize| {
            tape.evaluate(|s| match s {
                Symbol::Dummy(i) => Measured::exact(DoubleDouble::from(f64::from(u8::from(i as usize == j)))),
                _ => state.measured(s),
            })
        };
        let entries: Vec<Measured> = (0..n).flat_map(column).collect();
        let values: Vec<DoubleDouble> = entries.iter().map(|x| x.value).collect();
        let sizes: Vec<f64> = entries.iter().map(|x| x.magnitude).collect();
        factor(&values, &sizes, n).is_ok()
    }
}

/// Gaussian elimination with exchanged rows, each brought near 1 first.
fn has_certain_inverse(mut matrix: Vec<f64>, n: usize) -> bool {
    let largest = |row: &[f64]| row.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for row in matrix.chunks_exact_mut(n) {
        let size = largest(row);
        row.iter_mut().for_each(|x| *x /= size);
    }
    let mut rows: Vec<Vec<f64>> = matrix.chunks_exact(n).map(<[f64]>::to_vec).collect();
    for k in 0..n {
        let Some(pivot) = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs())) else { return false };
        rows.swap(k, pivot);
        let (above, below) = rows.split_at_mut(k + 1);
        let top = &above[k];
        if top[k].is_nan() || top[k].abs() <= CERTAIN {
            return false;
        }
        for row in below {
            let factor = row[k] / top[k];
            if factor != 0.0 {
                row[k..].iter_mut().zip(&top[k..]).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    true
}
