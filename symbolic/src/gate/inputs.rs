//! Inputs taken as arbitrary: what a file says of one, 0 N say, is an example.

use super::state::State;
use crate::derive::Rows;
use crate::expr::Symbol;
use crate::model::Model;
use crate::number::DoubleDouble;
use crate::random::Random;

/// Values that are added to an input and its rates, in parts of the largest that each has (in its unit where that is 0).
const ADDED: (f64, f64) = (0.3, 1.0);

/// The same states with other values of all inputs that no constraint contains; accelerations are not brought up to date.
pub(super) fn arbitrary(model: &Model, rows: &Rows, states: &[State]) -> Vec<State> {
    let held = model.graph.symbols(rows.value.iter().chain(&rows.rate).copied());
    let free = |k: usize| !held.iter().any(|s| matches!(s, Symbol::Input(i, _) if *i as usize == k));
    let free: Vec<usize> = (0..model.inputs.len()).filter(|k| free(*k)).collect();
    let mut random = Random::new();
    let mut states = states.to_vec();
    for k in free {
        for order in 0..4 {
            let size = |state: &State| state.inputs.get(k).map_or(0.0, |u| u[order].abs().to_f64());
            let largest = states.iter().map(size).filter(|x| x.is_finite()).fold(0.0, f64::max);
            let unit = if largest > 0.0 { largest } else { 1.0 };
            for u in states.iter_mut().filter_map(|state| state.inputs.get_mut(k)) {
                let sign = if random.between(-1.0, 1.0) < 0.0 { -unit } else { unit };
                u[order] += DoubleDouble::from(sign * random.between(ADDED.0, ADDED.1));
            }
        }
    }
    states
}
