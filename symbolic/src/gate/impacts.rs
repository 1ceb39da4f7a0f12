//! What impacts, and what events set, do: each happens where its constraint is zero, and changes some of what is conserved.
//!
//! Both are asked with the parameters of the scenes: an impact takes no energy for one restitution, 1, only.

use super::claims::set_by;
use super::closing::Group;
use super::draw::{with_conditions, with_set};
use super::motion::Motion;
use super::state::{State, describe};
use super::states::States;
use crate::derive::Rows;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Graph, Id, Measured, Symbol, Tape, jacobian};
use crate::model::{Conserved, Event, EventAction, Model, Target};
use crate::number::DoubleDouble;

/// A constraint is zero below this part of the largest value that it has at the states: what a coarse run and a small
/// offset in `when` leave.
const NEARLY_ZERO: f64 = 1e-4;
/// A claim is changed by more than this part of its terms; rates of constraints are known to an `f64`.
const CHANGED: f64 = 1e-9;
/// So many states of a phase are asked.
const ASKED: usize = 8;
/// With fewer zeros of an event nothing is said of it.
const FEWEST: usize = 3;

/// Impacts at whose events the constraint that they act along is not zero: where the motion of scenes meets the event, there;
/// else wherever a zero of its function is found.
pub(super) fn elsewhere(model: &Model, rows: &Rows, motion: &Motion, states: &States) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (k, event) in model.events.iter().enumerate() {
        for action in &event.actions {
            let EventAction::Impact { along, .. } = action else { continue };
            let met: Vec<State> = states.hits.iter().filter(|hit| hit.0 == k).map(|hit| hit.1.clone()).collect();
            let constraint = &model.constraints[*along];
            let distance = Distance::new(model, &constraint.value, &states.all);
            let worst = match met.is_empty() {
                false => met.iter().find_map(|state| Some((distance.at(state)?, state.clone()))),
                true => everywhere(&distance, zeros(model, rows, motion, (event, &states.all))),
            };
            if let Some((value, state)) = worst {
                let (value, at) = (format!("{value:.6e}"), describe(model, &state));
                problems.push(verdicts::impact_elsewhere(
                    event.place.clone(),
                    &event.name,
                    &constraint.name,
                    value,
                    at,
                ));
            }
        }
    }
    problems
}

/// The first of some states, if all of them are off.
fn everywhere(distance: &Distance, states: Vec<State>) -> Option<(f64, State)> {
    let off: Option<Vec<f64>> = states.iter().map(|state| distance.at(state)).collect();
    let first = off.filter(|off| off.len() >= FEWEST)?.first().copied()?;
    Some((first, states.into_iter().next()?))
}

/// How far a constraint is from zero.
struct Distance {
    tape: Tape,
    /// The largest value of each component.
    scales: Vec<f64>,
}

impl Distance {
    fn new(model: &Model, value: &[Id], states: &[State]) -> Distance {
        let tape = Tape::new(&model.graph, value);
        let mut scales = vec![0.0_f64; value.len()];
        for state in states {
            let here = tape.evaluate(|s| state.value(s));
            let sizes = here.iter().map(|x| x.abs().to_f64());
            scales.iter_mut().zip(sizes).filter(|(_, x)| x.is_finite()).for_each(|(scale, x)| *scale = scale.max(x));
        }
        Distance { tape, scales }
    }

    /// The value of the first component that is not zero at a state.
    fn at(&self, state: &State) -> Option<f64> {
        let here = self.tape.evaluate(|s| state.value(s));
        let off = |(x, scale): (&DoubleDouble, &f64)| (x.abs().to_f64() > NEARLY_ZERO * scale).then(|| x.to_f64());
        here.iter().zip(&self.scales).find_map(off)
    }
}

/// Positions at which a function of positions is zero that an event watches.
fn zeros(model: &Model, rows: &Rows, motion: &Motion, (event, states): (&Event, &[State])) -> Vec<State> {
    let moves = |s: &Symbol| !matches!(s, Symbol::Coordinate(_) | Symbol::Parameter(_) | Symbol::Time);
    if model.graph.symbols([event.when]).iter().any(moves) {
        return Vec::new();
    }
    let (mut graph, mut extended) = (model.graph.clone(), rows.clone());
    let slopes = jacobian(&mut graph, &[event.when], |s| match s {
        Symbol::Coordinate(i) => Some(i as usize),
        _ => None,
    });
    let row = extended.value.len();
    extended.matrix.extend(slopes.into_iter().flatten().map(|(i, x)| (row, i, x)));
    extended.value.push(event.when);
    extended.rate.push(Id::ZERO);
    extended.holonomic.push(true);
    let mut found = Vec::new();
    for phase in phases(model, event) {
        found.extend(placed((model, &graph), &extended, motion, (phase, &[row]), states, &[]));
    }
    found
}

/// The phases in which an event counts.
fn phases(model: &Model, event: &Event) -> Vec<usize> {
    event.phases.clone().unwrap_or_else(|| (0..model.phases.len().max(1)).collect())
}

/// States of a phase with the parameters of scenes, brought to the positions at which its rows and further ones hold.
fn placed(
    (model, graph): (&Model, &Graph),
    rows: &Rows,
    motion: &Motion,
    (phase, further): (usize, &[usize]),
    states: &[State],
    when: &[(usize, Id)],
) -> Vec<State> {
    let defaults: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
    let mut sets: Vec<Vec<f64>> =
        model.scenes.iter().map(|scene| with_set(graph, &scene.set, defaults.clone())).collect();
    if sets.is_empty() {
        sets.push(defaults);
    }
    let held: Vec<usize> = motion.constraints.active(phase).iter().chain(further).copied().collect();
    let group = Group::new((model, graph), rows, held);
    let weights = vec![1.0; motion.n];
    let of_phase = states.iter().filter(|state| state.phase == phase).take(ASKED);
    let pairs = of_phase.flat_map(|state| sets.iter().map(move |set| (state, set)));
    let place = |(state, set): (&State, &Vec<f64>)| {
        let mut state = state.clone();
        (state.parameters, state.rests) = with_conditions(graph, when, set.clone());
        motion.signals(&mut state);
        // Speeds follow from the rows of the phase alone.
        (group.close_places(&mut state, &weights) && motion.place(&mut state)).then_some(state)
    };
    pairs.filter_map(place).collect()
}

/// The events whose impacts change what is said to be conserved, by name: those that end in a phase with further constraints among
/// them.
pub(super) fn that_change(
    model: &Model,
    rows: &Rows,
    motion: &Motion,
    invariant: &Conserved,
    states: &[State],
) -> Vec<String> {
    let value = Tape::new(&model.graph, &invariant.value);
    let claimed = |phase: &usize| invariant.phases.as_ref().is_none_or(|phases| phases.contains(phase));
    let changes = |event: &&Event| {
        phases(model, event).into_iter().filter(claimed).any(|phase| {
            event.actions.iter().any(|action| {
                if let EventAction::Set(set) = action {
                    let of_phase = states.iter().filter(|state| state.phase == phase);
                    return of_phase.into_iter().any(|state| is_set(model, *set, state, &value));
                }
                let struck = rows_of(model, motion, phase, action);
                let at =
                    placed((model, &model.graph), rows, motion, (phase, &struck), states, &set_by(&invariant.when));
                !struck.is_empty() && at.iter().any(|state| is_changed(model, motion, (action, &struck), state, &value))
            })
        })
    };
    model.events.iter().filter(changes).map(|event| event.name.clone()).collect()
}

/// Whether what an event sets changes what is claimed at a state.
fn is_set(model: &Model, set: usize, state: &State, value: &Tape) -> bool {
    let (targets, values): (Vec<Target>, Vec<Id>) = model.sets[set].values.iter().copied().unzip();
    let mut after = state.clone();
    for (target, value) in targets.iter().zip(Tape::new(&model.graph, &values).evaluate(|s| state.value(s))) {
        match target {
            Target::Memory(j) => after.memory[*j] = value.to_f64(),
            Target::State(j) => after.v[model.mechanical() + j] = value,
        }
    }
    differs(value, state, &after)
}

/// Whether what is claimed has another value in one state than in the other.
fn differs(value: &Tape, before: &State, after: &State) -> bool {
    let [before, after] = [before, after].map(|state| value.evaluate(|s| state.measured(s)));
    let differs = |(x, y): (&Measured, &Measured)| {
        let size = (x.value - y.value).abs().to_f64();
        size.is_finite() && size > CHANGED * (x.magnitude + y.magnitude)
    };
    before.iter().zip(&after).any(differs)
}

/// The rows that an action makes push, beside those of its phase.
fn rows_of(model: &Model, motion: &Motion, phase: usize, action: &EventAction) -> Vec<usize> {
    match action {
        EventAction::Stop | EventAction::Record | EventAction::Set(_) | EventAction::Contact(_) => Vec::new(),
        EventAction::Phase(next) => {
            let active = motion.constraints.active(phase);
            motion.constraints.active(*next).iter().filter(|row| !active.contains(row)).copied().collect()
        }
        EventAction::Impact { along, .. } => model.constraints[*along].rows().collect(),
    }
}

/// Whether an impact changes what is claimed at a state.
fn is_changed(
    model: &Model,
    motion: &Motion,
    (action, struck): (&EventAction, &[usize]),
    state: &State,
    value: &Tape,
) -> bool {
    let restitution = match action {
        EventAction::Impact { restitution, .. } => {
            Tape::new(&model.graph, &[*restitution]).evaluate(|s| state.value(s))[0].to_f64()
        }
        _ => 0.0,
    };
    // In a phase that is entered those rows act that it has, no others of the phase before.
    let acting = match action {
        EventAction::Phase(next) => motion.constraints.active(*next).to_vec(),
        _ => motion.constraints.active(state.phase).iter().chain(struck).copied().collect(),
    };
    let held = motion.constraints.roughly(&acting, |s| state.value(s).to_f64());
    let change = |(row, rate): (&usize, &f64)| {
        let kept = if struck.contains(row) { -(1.0 + restitution) * rate } else { 0.0 };
        (*row, kept)
    };
    let changes: Vec<(usize, f64)> = held.rows.iter().zip(&held.rate).map(change).collect();
    let Some(jump) = motion.velocity_jump(state, &changes) else { return false };
    let mut after = state.clone();
    after.v.iter_mut().zip(&jump).for_each(|(v, jump)| *v += jump.value);
    differs(value, state, &after)
}
