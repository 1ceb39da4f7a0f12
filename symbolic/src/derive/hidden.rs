//! States of first order as speeds of hidden coordinates.
//!
//! With Z' = z the law z' = f is the equation of motion Z'' − f = 0, with M = 1 and h = −f, of a coordinate Z that appears nowhere.  Until
//! here a state was a symbol of its own: what is differentiated along the motion has f in the place of its rate, so that no part of
//! an equation is lost where h is taken at accelerations of 0.

use rustc_hash::FxHashMap as HashMap;

use super::{Energies, Equations, Switch};
use crate::expr::{Id, Symbol, substitute};
use crate::model::Model;

/// The place of the hidden coordinate of a state.
fn place(model: &Model, state: usize) -> usize {
    model.mechanical() + state
}

/// Adds the equations of hidden coordinates to those of each derivation, with what the rates of states are.
pub(super) fn append(model: &mut Model, rates: &[Id], equations: &mut [Equations], momenta: &mut [(Id, Id)]) {
    for (state, rate) in rates.iter().enumerate() {
        let i = place(model, state);
        let graph = &mut model.graph;
        let force = graph.neg(*rate);
        let acceleration = graph.symbol(Symbol::Acceleration(i as u32));
        for derivation in &mut *equations {
            derivation.mass.push((i, i, Id::ONE));
            derivation.bias[i] = force;
            derivation.residual[i] = graph.sub(acceleration, *rate);
        }
        momenta[i] = (graph.symbol(Symbol::Speed(i as u32)), force);
    }
}

/// Puts speeds of hidden coordinates in the place of states, and in the place of their rates what these are; in balances, where they may be
/// unknown, accelerations of hidden coordinates.
pub(super) fn put_in(
    model: &mut Model,
    rates: &[Id],
    equations: &mut [Equations],
    momenta: &mut [(Id, Id)],
    energies: &mut Energies,
    switches: &mut [Switch],
) {
    if model.states.is_empty() {
        return;
    }
    let symbols: Vec<(Symbol, Symbol)> = (0..model.states.len())
        .flat_map(|state| {
            let (j, i) = (state as u32, place(model, state) as u32);
            [(Symbol::State(j), Symbol::Speed(i)), (Symbol::StateRate(j), Symbol::Acceleration(i))]
        })
        .collect();
    let graph = &mut model.graph;
    let hidden: HashMap<Symbol, Id> = symbols.into_iter().map(|(from, to)| (from, graph.symbol(to))).collect();
    let rates = substitute(graph, rates, &hidden);
    let mut known = hidden.clone();
    known.extend(rates.iter().enumerate().map(|(j, rate)| (Symbol::StateRate(j as u32), *rate)));
    let mut places: Vec<&mut Id> = Vec::new();
    for derivation in equations {
        let mass = derivation.mass.iter_mut().map(|entry| &mut entry.2);
        places.extend(mass.chain(&mut derivation.bias).chain(&mut derivation.residual));
    }
    places.extend(momenta.iter_mut().flat_map(|(momentum, rate)| [momentum, rate]));
    let Energies { kinetic, potential, jacobi, power, scale } = energies;
    places.extend([kinetic, potential, jacobi, power, scale]);
    places.extend(switches.iter_mut().map(|switch| &mut switch.argument));
    let old: Vec<Id> = places.iter().map(|id| **id).collect();
    let new = substitute(graph, &old, &known);
    places.into_iter().zip(new).for_each(|(place, id)| *place = id);
    // What the model says of rates of states is put in already, but in balances.
    model.substitute(&hidden);
}
