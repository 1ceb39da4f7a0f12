//! Friction that drives.
//!
//! Friction is a force that is made of a constraint's reaction.  Where its law contains `sign(s)` of a speed s it must not
//! push towards growing s: s (Q · ∂s/∂q') ≤ 0, also where s is the speed beside a belt that pulls.  Without it the work
//! Q · q' tells, where it has one sign in all states.

use super::effects::{Effect, Kind, effects};
use super::state::{Origin, State, describe};
use crate::derive::lagrange::speed_gradient;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::mechanics;
use crate::expr::{Graph, Id, Node, Symbol, Tape, Unary};
use crate::model::Model;

/// Warns of each force made of reactions that acts along the sliding: somewhere on the motion of a scene, or wherever it acts.
pub(super) fn drives(model: &Model, states: &[State]) -> Vec<Problem> {
    let reacts = |load: &crate::model::Load| {
        let parts = load.pushes.iter().flat_map(|push| push.force.iter().chain(&push.couple).copied());
        model.graph.symbols(parts).iter().any(is_reaction)
    };
    if !model.loads.iter().any(reacts) {
        return Vec::new();
    }
    let (mut graph, effects) = effects(model);
    let mut problems = Vec::new();
    for effect in effects.iter().filter(|effect| effect.kind == Kind::Force) {
        if !graph.symbols(effect.force.iter().copied()).iter().any(is_reaction) {
            continue;
        }
        if let Some((power, state)) = driving(&mut graph, effect, states) {
            let (place, by) = (effect.place.clone(), format!("{power:.6e}"));
            problems.push(mechanics::driving_friction(place, &effect.words, by, describe(model, state)));
        }
    }
    problems
}

fn is_reaction(symbol: &Symbol) -> bool {
    matches!(symbol, Symbol::Multiplier(_))
}

/// The work done at a state that shows that a force drives.
fn driving<'a>(graph: &mut Graph, effect: &Effect, states: &'a [State]) -> Option<(f64, &'a State)> {
    let n = effect.force.len();
    let along = |graph: &mut Graph, direction: &[Id]| {
        direction.iter().zip(&effect.force).fold(Id::ZERO, |sum, (v, q)| {
            let term = graph.mul(*v, *q);
            graph.add(sum, term)
        })
    };
    let speeds: Vec<Id> = (0..n).map(|i| graph.symbol(Symbol::Speed(i as u32))).collect();
    let power = along(graph, &speeds);
    let sliding = sliding(graph, &effect.force);
    let judged = match sliding {
        Some(speed) => {
            let slopes = speed_gradient(graph, n, &[(speed, Id::ONE)]);
            let push = along(graph, &slopes);
            graph.mul(speed, push)
        }
        None => power,
    };
    let tape = Tape::new(graph, &[judged, power]);
    let at = |state: &'a State| {
        let [judged, power] = tape.evaluate(|s| state.measured(s))[..] else { return None };
        let acts = judged.value.is_finite() && !judged.vanishes(super::ROUNDINGS);
        acts.then(|| (judged.value.to_f64(), power.value.to_f64(), state))
    };
    let acting: Vec<(f64, f64, &State)> = states.iter().filter_map(at).collect();
    let everywhere = acting.iter().all(|(judged, ..)| *judged > 0.0);
    let on_the_way = |state: &State| sliding.is_some() && state.origin == Origin::Motion;
    let shown = acting.iter().find(|(judged, _, state)| *judged > 0.0 && (everywhere || on_the_way(state)));
    shown.map(|(_, power, state)| (*power, *state))
}

/// The speed s of the only `sign(s)` in a force.
fn sliding(graph: &Graph, force: &[Id]) -> Option<Id> {
    let argument = |id: Id| match graph.node(id) {
        Node::Unary(Unary::Sign, argument) => Some(argument),
        _ => None,
    };
    let moves = |id: &Id| graph.symbols([*id]).iter().any(|s| matches!(s, Symbol::Speed(_)));
    let found: Vec<Id> = graph.needed(force.iter().copied()).into_iter().filter_map(argument).filter(moves).collect();
    if let [one] = found[..] { Some(one) } else { None }
}
