//! Named reactions as results, where equations are written out.
//!
//! An equation that alone says what a reaction is takes any value, and accelerations do not tell.  Force and moment on the
//! bodies do: where the named reactions can be all that acts on some bodies beside their loads, so that the motion
//! satisfies these bodies' balances, they must have the values that these balances give.  As a system may leave reactions
//! out, bodies are taken one by one and together, and one set of bodies that agrees is enough.

use super::Gate;
use super::state::{State, describe};
use super::system::Assembled;
use crate::derive::momentum::Momentum;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Measured, Symbol};
use crate::model::{BalanceSystem, Model, Reaction};

/// Of so many bodies every set is tried, of more those that follow each other in the file.
const ALL_SETS: usize = 6;
/// More sets are not tried.
const SETS: usize = 400;

/// The reactions that a set of bodies tells at every state; one that is not determined is none.
struct Told {
    bodies: Vec<usize>,
    reactions: Vec<Vec<Option<Measured>>>,
}

/// Errors for reactions that no set of bodies confirms and some contradicts; words for those of which none tells.
pub(super) fn confirmed(
    model: &Model,
    (system, linear): (&BalanceSystem, &Momentum),
    (assembled, states): (&[Assembled], &[State]),
    gate: Gate,
) -> Result<Vec<String>, Vec<Problem>> {
    let Some(bodies) = &linear.bodies else { return Ok(Vec::new()) };
    let own = told(assembled, states);
    let rows = with_multipliers(Assembled::derived(&model.graph, bodies, states), linear, states);
    let width = system.bodies[0].len();
    let candidates: Vec<Told> =
        sets(system.bodies.len()).into_iter().filter_map(|set| by(&set, width, &rows, states, gate)).collect();
    let (mut problems, mut words) = (Vec::new(), Vec::new());
    let mut place = 0;
    for &k in &system.reactions {
        let reaction = &model.reactions[k];
        for component in place..place + reaction.components {
            let telling: Vec<&Told> =
                candidates.iter().filter(|told| told.reactions.iter().any(|r| r[component].is_some())).collect();
            let disagrees = |told: &&Told| contradiction(&own, told, component, gate).is_some();
            if telling.iter().any(|told| !disagrees(told)) {
                continue;
            }
            let name = named(reaction, component - place);
            let Some((told, state)) = telling.first().and_then(|t| Some((t, contradiction(&own, t, component, gate)?)))
            else {
                words.extend(
                    resting(system, assembled, states, component).map(|on| format!("`{name}` rests on {on} alone")),
                );
                continue;
            };
            let label = resting(system, assembled, states, component);
            let values = (own[state][component], told.reactions[state][component]);
            problems.push(against(model, system, (&name, label), (told, values), &states[state]));
            break;
        }
        place += reaction.components;
    }
    if problems.is_empty() { Ok(words) } else { Err(problems) }
}

/// Systems in whose unknowns Lagrange's multipliers stand no more.
pub(super) fn with_multipliers(systems: Vec<Assembled>, linear: &Momentum, states: &[State]) -> Vec<Assembled> {
    let multipliers: Vec<Symbol> =
        linear.unknowns.iter().copied().filter(|s| matches!(s, Symbol::Multiplier(_))).collect();
    let known = |state: &State| multipliers.iter().map(|s| state.measured(*s)).collect::<Vec<_>>();
    systems.iter().zip(states).map(|(system, state)| system.with_last(&known(state))).collect()
}

/// The reactions of a system with the motion's accelerations and multipliers.
fn told(assembled: &[Assembled], states: &[State]) -> Vec<Vec<Option<Measured>>> {
    assembled.iter().zip(states).map(|(system, state)| system.eliminated(&state.a).reactions).collect()
}

/// What a set of bodies tells, if reactions can satisfy its balances at every state.
fn by(set: &[usize], width: usize, rows: &[Assembled], states: &[State], gate: Gate) -> Option<Told> {
    let sums: Vec<Vec<usize>> = (0..width).map(|k| set.iter().map(|b| b * width + k).collect()).collect();
    let mut reactions = Vec::with_capacity(states.len());
    for (system, state) in rows.iter().zip(states) {
        let found = system.summed(&sums).eliminated(&state.a);
        let largest = found.left.iter().fold(0.0_f64, |most, (_, r)| most.max(r.magnitude));
        let holds = |r: &Measured| {
            let size = r.value.abs().to_f64();
            !size.is_finite() || gate.agrees(size, r.magnitude, largest)
        };
        if !found.left.iter().all(|(_, r)| holds(r)) {
            return None;
        }
        reactions.push(found.reactions);
    }
    Some(Told { bodies: set.to_vec(), reactions })
}

/// The error: what the system says, and what the bodies say.
fn against(
    model: &Model,
    system: &BalanceSystem,
    (name, label): (&str, Option<String>),
    (told, (here, there)): (&Told, (Option<Measured>, Option<Measured>)),
    state: &State,
) -> Problem {
    let value = |x: Option<Measured>| x.map_or_else(String::new, |x| format!("{:.6e}", x.value.to_f64()));
    let on: Vec<String> = told.bodies.iter().map(|b| format!("`{}`", model.bodies[*b].name)).collect();
    let balance = label.as_ref().and_then(|label| system.balances.iter().find(|b| b.label == *label));
    let place = balance.map_or(&system.place, |b| &b.place).clone();
    let label = label.unwrap_or_else(|| format!("`{}`", system.name));
    verdicts::reaction_against_bodies(
        place,
        name,
        value(here),
        label,
        value(there),
        super::listed(&on),
        describe(model, state),
    )
}

/// The first state at which a set of bodies gives another value.
fn contradiction(own: &[Vec<Option<Measured>>], told: &Told, component: usize, gate: Gate) -> Option<usize> {
    own.iter().zip(&told.reactions).position(|(own, told)| {
        let (Some(x), Some(y)) = (own[component], told[component]) else { return false };
        let (gap, size) = ((x.value - y.value).abs().to_f64(), x.magnitude + y.magnitude);
        gap.is_finite() && size.is_finite() && !gate.agrees(gap, size, size)
    })
}

/// The written equation without which a reaction is not determined.
fn resting(system: &BalanceSystem, assembled: &[Assembled], states: &[State], component: usize) -> Option<String> {
    let determined = |a: &Assembled, state: &State| a.eliminated(&state.a).reactions[component].is_some();
    let (whole, state) = assembled.iter().zip(states).find(|(a, state)| determined(a, state))?;
    let mut first = 0;
    for balance in &system.balances {
        let own = first..first + balance.components;
        first = own.end;
        let kept: Vec<Vec<usize>> = (0..whole.judged).filter(|row| !own.contains(row)).map(|row| vec![row]).collect();
        if balance.is_written() && !determined(&whole.summed(&kept), state) {
            return Some(balance.label.clone());
        }
    }
    None
}

/// `pin.x`.
fn named(reaction: &Reaction, component: usize) -> String {
    let axis = if reaction.scalar { "" } else { [".x", ".y", ".z"][component.min(2)] };
    format!("{}{axis}", reaction.name)
}

/// Sets of bodies to try: the smallest first.
fn sets(bodies: usize) -> Vec<Vec<usize>> {
    if bodies <= ALL_SETS {
        let set = |bits: usize| (0..bodies).filter(|b| bits >> b & 1 == 1).collect::<Vec<_>>();
        let mut sets: Vec<Vec<usize>> = (1..1 << bodies).map(set).collect();
        sets.sort_by_key(Vec::len);
        return sets;
    }
    let runs =
        (1..=bodies).rev().flat_map(|length| (0..=bodies - length).map(move |first| (first..first + length).collect()));
    let mut sets: Vec<Vec<usize>> = runs.take(SETS).collect();
    sets.reverse();
    sets
}
