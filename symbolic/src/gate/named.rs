//! Reactions that several systems of balances name: they must have one value.
//!
//! A reaction that stands with a wrong sign or factor in written-out equations is eliminated all the same, and the
//! accelerations do not tell; another system that names it does.

use super::balances::solutions;
use super::sample::State;
use super::test::describe;
use crate::derive::momentum::Momentum;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::model::{BalanceSystem, Model, Reaction};

/// Two values are one where they differ by no more than this of the largest component of the reaction.
const TOLERANCE: f64 = 1e-7;

/// An error for every reaction to which two systems give different values.
pub(super) fn disagreements(model: &Model, momentum: &[Momentum], states: &[State]) -> Vec<Problem> {
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
        let Some((first, others)) = naming.split_first() else { continue };
        let values = |s: usize, state: usize| components(reaction, systems[s].1, solved[s][state].as_deref()?);
        problems.extend(others.iter().find_map(|second| {
            states.iter().enumerate().find_map(|(n, state)| {
                let (here, there) = (values(*first, n)?, values(*second, n)?);
                let scale = here.iter().chain(&there).fold(0.0_f64, |most, x| most.max(x.abs()));
                let c = (0..here.len()).find(|c| (here[*c] - there[*c]).abs() > TOLERANCE * scale)?;
                let axis = if reaction.scalar { "" } else { [".x", ".y", ".z"][c.min(2)] };
                let [one, two] = [here[c], there[c]].map(|x| format!("{x:.6e}"));
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
fn components(reaction: &Reaction, linear: &Momentum, solution: &[f64]) -> Option<Vec<f64>> {
    let symbols = (0..reaction.components as u32).map(|c| crate::expr::Symbol::Reaction(reaction.first + c));
    symbols.map(|s| solution.get(linear.unknowns.iter().position(|u| *u == s)?).copied()).collect()
}
