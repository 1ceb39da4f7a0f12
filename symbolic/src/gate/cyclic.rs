//! Cyclic coordinates.

use super::state::State;
use crate::expr::{Angles, Id, Symbol, Tape, expand};
use crate::model::Model;

/// Coordinates on which neither T − V nor any force depends or acts, with their momenta, which are conserved.
pub(super) fn cyclic(model: &mut Model, states: &[State], momenta: &[(Id, Id)]) -> Vec<(usize, Id)> {
    let rests: Vec<Id> = momenta.iter().map(|m| m.1).collect();
    let tape = Tape::new(&model.graph, &rests);
    let mut still = vec![!states.is_empty(); momenta.len()];
    for state in states {
        for (still, rest) in still.iter_mut().zip(tape.evaluate(|s| state.measured(s))) {
            *still &= rest.vanishes(super::ROUNDINGS);
        }
    }
    let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let of_states = model.graph.symbols(model.states.iter().map(|state| state.rate));
    // What a state's law reads is needed, though its momentum is conserved.
    still.iter_mut().enumerate().for_each(|(i, still)| *still &= !of_states.contains(&Symbol::Coordinate(i as u32)));
    let mut found = Vec::new();
    for (i, &(momentum, _)) in momenta.iter().enumerate().filter(|(i, _)| still[*i]) {
        let expanded = expand(&mut model.graph, &[momentum], constant, Angles::Shorter);
        found.push((i, expanded.map_or(momentum, |e| e[0])));
    }
    found
}
