//! Reactions that several systems of balances name: they must have one value.
//!
//! A reaction that stands with a wrong sign or factor in written-out equations is eliminated all the same, and the
//! accelerations do not tell; another system that names it does.

use super::Gate;
use super::balances::solutions;
use super::state::{State, describe};
use crate::derive::momentum::Momentum;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::Measured;
use crate::model::{BalanceSystem, Model, Reaction};

/// An error for every reaction to which two systems give different values.
pub(super) fn disagreements(model: &Model, momentum: &[Momentum], states: &[State], gate: Gate) -> Vec<Problem> {
    let named: Vec<usize> = model.balances.iter().flat_map(|system| system.reactions.iter().copied()).collect();
    let shared = |k: &usize| named.iter().filter(|other| *other == k).count() > 1;
    if !named.iter().any(shared) {
        return Vec::new();
    }
    let systems: Vec<(&BalanceSystem, &Momentum)> = model.balances.iter().zip(momentum).collect();
    let solved: Vec<_> = systems.iter().map(|(_, linear)| solutions(&model.graph, linear, states)).collect();
    let mut problems = Vec::new();
    for (k, reaction) in model.reactions.iter().enumerate().filter(|(k, _)| shared(k)) {
        let naming: Vec<usize> = (0..systems.len()).filter(|s| systems[*s].0.reactions.contains(&k)).collect();
        let mut pairs =
            naming.iter().enumerate().flat_map(|(i, first)| naming[i + 1..].iter().map(move |second| (first, second)));
        // Each in the phases of its system.
        let values = |s: usize, state: usize| {
            let (system, linear) = systems[s];
            let solution = solved[s][state].as_deref().filter(|_| system.phases.contains(&states[state].phase));
            components(reaction, linear, solution?)
        };
        problems.extend(pairs.find_map(|(first, second)| {
            states.iter().enumerate().find_map(|(n, state)| {
                let (here, there) = (values(*first, n)?, values(*second, n)?);
                let largest = here.iter().chain(&there).fold(0.0_f64, |most, x| most.max(x.magnitude));
                let differs = |c: &usize| {
                    let (x, y) = (here[*c], there[*c]);
                    let gap = (x.value - y.value).abs().to_f64();
                    gap.is_finite() && !gate.agrees(gap, x.magnitude + y.magnitude, largest)
                };
                let c = (0..here.len()).find(differs)?;
                let axis = if reaction.scalar { "" } else { [".x", ".y", ".z"][c.min(2)] };
                let [one, two] = [here[c], there[c]].map(|x| format!("{:.6e}", x.value.to_f64()));
                let (first, second) = (systems[*first].0, systems[*second].0);
                let name = format!("{}{axis}", reaction.name);
                let at = describe(model, state);
                Some(verdicts::reactions_disagree(second.place.clone(), name, &first.name, one, &second.name, two, at))
            })
        }));
    }
    problems
}

/// The components of a reaction in the solution of a system that names it.
fn components(reaction: &Reaction, linear: &Momentum, solution: &[Measured]) -> Option<Vec<Measured>> {
    reaction.symbols().map(|s| solution.get(linear.unknowns.iter().position(|u| *u == s)?).copied()).collect()
}
