//! What a file says is conserved, or holds.

use std::borrow::Cow;

use super::effects::effects;
use super::explain::{Evidence, Explanation, explain};
use super::motion::Motion;
use super::potential::Conservative;
use super::report::Report;
use super::state::{State, describe};
use super::states::{self, States};
use super::{Gate, impacts};
use crate::derive::{Equations, Rows, Switch, SwitchKind, introduce, rates};
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Place, Problem};
use crate::expr::vectors::axes;
use crate::expr::{Graph, Id, Measured, Scalar, Symbol, Tape, Unary};
use crate::model::{Check, Condition, Conserved, Model};
use crate::number::DoubleDouble;

/// The rates of everything that is claimed to be conserved, component by component.
pub(super) fn invariant_rates(model: &mut Model) -> Vec<Vec<Id>> {
    let Model { graph, conserved, .. } = model;
    conserved.iter().map(|claim| rates(graph, &claim.value)).collect()
}

/// What a file's claims are tested with.
pub(super) struct Claims<'a> {
    pub gate: Gate,
    pub model: &'a Model,
    pub equations: &'a Equations,
    pub rows: &'a Rows,
    pub motion: &'a Motion,
    /// Positions with the first scene's parameters.
    pub own: &'a [State],
    /// States with parameters as they are drawn.
    pub states: &'a States,
}

impl Claims<'_> {
    /// Tests what is said to be conserved, by its `rates`, and identities; adds what does not hold to the problems.
    ///
    /// # Errors
    /// States with a claim's own values of parameters that cannot be found.
    pub fn test(
        &self,
        rates: &[Vec<Id>],
        report: &mut Report,
        problems: &mut Vec<Problem>,
    ) -> Result<(), Vec<Problem>> {
        let Claims { gate, model, equations, rows, motion, .. } = *self;
        for (invariant, rates) in model.conserved.iter().zip(rates) {
            let states = self.states_when(&invariant.when, (&invariant.place, &invariant.name))?;
            match conserved(model, equations, &report.forces, (invariant, rates), &states, gate) {
                Ok(worst) => {
                    report.conserved.push((invariant.name.clone(), worst));
                    report.changed_by.push(impacts::that_change(model, rows, motion, invariant, &states.all));
                }
                Err(problem) => problems.push(*problem),
            }
        }
        for check in &model.checks {
            let states = self.states_when(&check.when, (&check.place, &check.name))?;
            match identity(model, check, &states, gate) {
                Ok(worst) => report.checks.push((check.name.clone(), worst)),
                Err(problem) => problems.push(*problem),
            }
        }
        Ok(())
    }

    /// The states of a claim that holds for some values of parameters only.
    fn states_when(&self, when: &[Condition], (place, name): (&Place, &str)) -> Result<Cow<'_, States>, Vec<Problem>> {
        if when.is_empty() {
            return Ok(Cow::Borrowed(self.states));
        }
        let found = states::states(self.model, self.motion, &set_by(when), self.own, self.gate);
        found.map(Cow::Owned).map_err(|problem| match problem.code {
            "E504" => vec![verdicts::too_few_states_when(place.clone().key("when"), name)],
            _ => vec![*problem],
        })
    }
}

/// The parameters that conditions set, and to what.
pub(super) fn set_by(when: &[Condition]) -> Vec<(usize, Id)> {
    when.iter().map(|condition| (condition.parameter, condition.value)).collect()
}

/// Every derivative must vanish by the magnitude of its own terms: the largest rate beside them.
fn conserved(
    model: &Model,
    equations: &Equations,
    natures: &[Conservative],
    (invariant, rates): (&Conserved, &[Id]),
    states: &States,
    gate: Gate,
) -> Result<f64, Box<Problem>> {
    let tape = Tape::new(&model.graph, rates);
    let (mut scratch, mut values) = (Vec::new(), vec![Measured::exact(DoubleDouble::ZERO); rates.len()]);
    let mut worst = 0.0_f64;
    let claimed = |state: &State| invariant.phases.as_ref().is_none_or(|phases| phases.contains(&state.phase));
    for (k, state) in states.all.iter().enumerate().filter(|(_, state)| claimed(state)) {
        tape.run(|s| state.measured(s), &mut scratch, &mut values);
        if tape.undecided(&scratch, super::ROUNDINGS) {
            // At a kink there is no rate; whether the value jumps there is asked below.
            continue;
        }
        let largest = values.iter().fold(0.0_f64, |most, x| most.max(x.magnitude));
        for (component, rate) in values.iter().enumerate() {
            let size = rate.value.abs().to_f64();
            if !size.is_finite() && state.is_special() {
                continue;
            }
            if !gate.agrees(size, rate.magnitude, largest) {
                let change = Change { component, state: k, rate: *rate };
                let (mut graph, effects) = effects(model);
                let evidence = Evidence { model, equations, effects: &effects, natures };
                let claim = (invariant.value[component], rates[component]);
                let explain = explain(&mut graph, &evidence, invariant, claim, &states.all, state);
                return Err(Box::new(change.problem(model, invariant, explain, &states.all)));
            }
            worst = worst.max(rate.relative());
        }
    }
    match jump(model, invariant, &states.surfaces, gate) {
        Some(problem) => Err(Box::new(problem)),
        None => Ok(worst),
    }
}

/// How a quantity was seen to change.
struct Change {
    component: usize,
    state: usize,
    rate: Measured,
}

impl Change {
    fn problem(&self, model: &Model, invariant: &Conserved, explain: Option<Explanation>, states: &[State]) -> Problem {
        let (place, name) = (invariant.place.clone(), &invariant.name);
        match explain {
            Some(Explanation { causes, help }) => verdicts::changed_by(place, name, causes, help),
            None => {
                let axis = axes(invariant.value.len()).get(self.component);
                let component = axis.map_or_else(String::new, |axis| format!("{axis} component "));
                let (rate, terms) = (self.rate.value.to_f64(), self.rate.magnitude);
                let by = format!("{component}{rate:.6e} where its terms change at up to {terms:.3e}");
                verdicts::not_conserved(place, name, by, describe(model, &states[self.state]))
            }
        }
    }
}

/// An error for an invariant that jumps where a discontinuity is met, with positions and speeds as they are.
fn jump(model: &Model, invariant: &Conserved, surfaces: &[State], gate: Gate) -> Option<Problem> {
    if surfaces.is_empty() {
        return None;
    }
    let mut graph = model.graph.clone();
    let (roots, switches) = introduce(&mut graph, &invariant.value, 0);
    if switches.is_empty() {
        return None;
    }
    let arguments: Vec<Id> = switches.iter().map(|switch| switch.argument).collect();
    let ways: Vec<Tape> = rates(&mut graph, &arguments).iter().map(|rate| Tape::new(&graph, &[*rate])).collect();
    let sides = Sides::new(&graph, &roots, &switches);
    surfaces.iter().find_map(|state| {
        // No motion crosses where what vanishes stays zero.
        let way = |k: usize, modes: &[f64]| {
            let rate = ways[k].evaluate(|s| with_modes(state, modes, s))[0];
            if rate.vanishes(super::ROUNDINGS) { 0.0 } else { rate.value.to_f64().signum() }
        };
        let Crossing { before, after, .. } = sides.along(state, way)?;
        let largest = before.iter().chain(&after).fold(0.0_f64, |most, x| most.max(x.magnitude));
        before.iter().zip(&after).find_map(|(x, y)| {
            let gap = (x.value - y.value).abs().to_f64();
            let sound = !gap.is_finite() || gate.agrees(gap, x.magnitude + y.magnitude, largest);
            (!sound).then(|| {
                let by = format!("{:.6e} to {:.6e}", x.value.to_f64(), y.value.to_f64());
                verdicts::jumps(invariant.place.clone(), &invariant.name, by, describe(model, state))
            })
        })
    })
}

/// Expressions with modes, evaluated on both sides of the discontinuity that a state lies on.
pub(super) struct Sides {
    values: Tape,
    arguments: Vec<(SwitchKind, Tape)>,
}

/// What is on both sides.
pub(super) struct Crossing {
    /// The values on the side where what vanishes is negative.
    pub before: Vec<Measured>,
    /// The values on the other.
    pub after: Vec<Measured>,
    /// Which arguments vanish.
    pub met: Vec<usize>,
    /// The modes before.
    pub modes: Vec<f64>,
}

impl Sides {
    pub fn new(graph: &Graph, roots: &[Id], switches: &[Switch]) -> Sides {
        let arguments = switches.iter().map(|s| (s.kind, Tape::new(graph, &[s.argument]))).collect();
        Sides { values: Tape::new(graph, roots), arguments }
    }

    /// The values with the modes of what vanishes here on one side and on the other; `None` where nothing vanishes.
    pub fn at(&self, state: &State) -> Option<Crossing> {
        self.along(state, |_, _| 1.0)
    }

    /// The same where each argument that vanishes goes its own way, by its place and the modes before it: up, down, or not at all.
    fn along(&self, state: &State, way: impl Fn(usize, &[f64]) -> f64) -> Option<Crossing> {
        let side = |after: f64| {
            let (mut modes, mut met): (Vec<f64>, Vec<usize>) = (Vec::new(), Vec::new());
            for (k, (kind, tape)) in self.arguments.iter().enumerate() {
                let argument = tape.evaluate(|s| with_modes(state, &modes, s))[0];
                let zero = argument.vanishes(1e6);
                if zero {
                    met.push(k);
                }
                let value = if zero { after * way(k, &modes) } else { argument.value.to_f64() };
                let function = if *kind == SwitchKind::Sign { Unary::Sign } else { Unary::Step };
                modes.push(f64::unary(function, value));
            }
            (self.values.evaluate(|s| with_modes(state, &modes, s)), met, modes)
        };
        let ((before, met, modes), (after, met_after, _)) = (side(-1.0), side(1.0));
        let nothing = met.is_empty() && met_after.is_empty();
        (!nothing).then_some(Crossing { before, after, met, modes })
    }
}

pub(super) fn with_modes(state: &State, modes: &[f64], symbol: Symbol) -> Measured {
    match symbol {
        Symbol::Mode(k) => Measured::exact(DoubleDouble::from(modes.get(k as usize).copied().unwrap_or(0.0))),
        _ => state.measured(symbol),
    }
}

/// Both sides of an identity must be equal by the magnitude of their own terms.
fn identity(model: &Model, check: &Check, states: &States, gate: Gate) -> Result<f64, Box<Problem>> {
    let roots: Vec<Id> = check.left.iter().zip(&check.right).flat_map(|(l, r)| [*l, *r]).collect();
    let tape = Tape::new(&model.graph, &roots);
    let mut worst = 0.0_f64;
    let claimed = |state: &&State| check.phases.as_ref().is_none_or(|phases| phases.contains(&state.phase));
    for state in states.all.iter().chain(&states.surfaces).filter(claimed) {
        let values = tape.evaluate(|s| state.measured(s));
        let largest = values.iter().fold(0.0_f64, |most, x| most.max(x.magnitude));
        for pair in values.chunks_exact(2) {
            let [left, right] = [pair[0], pair[1]];
            let difference = (left.value - right.value).abs().to_f64();
            if !difference.is_finite() && state.is_special() {
                continue;
            }
            let own = left.magnitude + right.magnitude;
            if !gate.agrees(difference, own, largest) {
                let by = format!("{difference:.6e}, {:.9e} against {:.9e}", left.value.to_f64(), right.value.to_f64());
                let at = describe(model, state);
                return Err(Box::new(verdicts::check_fails(check.place.clone(), &check.name, by, at)));
            }
            if difference > 0.0 {
                worst = worst.max(difference / own);
            }
        }
    }
    Ok(worst)
}
