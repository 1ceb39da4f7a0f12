//! Systems of momentum balances, ready to print: A·[q''; reactions] = b in its cheapest form.

use super::count::{operations, work};
use super::forms::expanded;
use super::gather::gather;
use super::{Entry, Program, gather_entries};
use crate::derive::momentum::systems as formed;
use crate::derive::{Momentum, Rows};
use crate::expr::{Graph, Id, Symbol};
use crate::model::{BalanceSystem, Model, rate_name};

/// One system of balances.
#[derive(Clone, Debug)]
pub struct MomentumSystem {
    /// Its name.
    pub name: String,
    /// The phases to which it belongs.
    pub phases: Vec<usize>,
    /// Names of the unknowns: accelerations, `theta''`, then components of reactions, `hinge.x`.
    pub unknowns: Vec<String>,
    /// Each equation's balance, in words, and whether it says nothing at rest.
    pub equations: Vec<(String, bool)>,
    /// The non-zeros of A.
    pub matrix: Vec<Entry>,
    /// b.
    pub right: Vec<Id>,
    /// Output components that are an unknown as it stands: (place among the outputs' components, unknown).
    pub outputs: Vec<(usize, usize)>,
    /// Operations of A and b.
    pub operations: usize,
}

/// Expanding is tried up to this many equations.
const EXPAND_LIMIT: usize = 12;

/// Lowers every system that is formed.
pub(super) fn systems(model: &mut Model, momentum: Vec<Momentum>, named: &[(usize, Symbol)]) -> Vec<MomentumSystem> {
    let balances = std::mem::take(&mut model.balances);
    let formed = balances.iter().zip(momentum).filter(|(_, linear)| linear.unformed.is_none());
    let lowered = formed.map(|(system, linear)| lower(model, system, linear, named)).collect();
    model.balances = balances;
    lowered
}

/// Forms and lowers the systems that were not, which name no reactions; all stand in the order of the file then.
pub(super) fn form(program: &mut Program) {
    let Program { model, switches, .. } = program;
    let rows = Rows::of(model);
    let momentum = formed(model, &rows, switches, true);
    let mut known = std::mem::take(&mut program.momentum);
    let mut all = systems(&mut program.model, momentum, &[]);
    for system in &mut all {
        if let Some(place) = known.iter().position(|other| other.name == system.name) {
            *system = known.swap_remove(place);
        }
    }
    program.momentum = all;
}

fn lower(model: &mut Model, system: &BalanceSystem, linear: Momentum, named: &[(usize, Symbol)]) -> MomentumSystem {
    let Momentum { unknowns, matrix, right, kept, .. } = linear;
    let mut equations = equation_names(model, system);
    if let Some(kept) = kept {
        equations = kept.into_iter().map(|row| equations[row].clone()).collect();
    }
    let outputs = named.iter().filter_map(|(place, s)| Some((*place, unknowns.iter().position(|u| u == s)?)));
    let outputs = outputs.collect();
    let (mut matrix, right) = cheapest(&mut model.graph, matrix, right);
    gather_entries(&mut model.graph, &mut matrix);
    let right = gather(&mut model.graph, &right);
    let roots: Vec<Id> = matrix.iter().map(|e| e.2).chain(right.iter().copied()).collect();
    MomentumSystem {
        name: system.name.clone(),
        phases: system.phases.clone(),
        unknowns: unknown_names(model, system, &unknowns),
        equations,
        operations: operations(&model.graph, &roots),
        outputs,
        matrix,
        right,
    }
}

/// As derived, or expanded over atoms of the state and factored again.
fn cheapest(graph: &mut Graph, matrix: Vec<Entry>, right: Vec<Id>) -> (Vec<Entry>, Vec<Id>) {
    if right.len() > EXPAND_LIMIT {
        return (matrix, right);
    }
    let values: Vec<Id> = matrix.iter().map(|e| e.2).collect();
    let put = |values: Vec<Id>| -> Vec<Entry> {
        let entries = matrix.iter().zip(values).map(|(e, value)| (e.0, e.1, value));
        entries.filter(|e| e.2 != Id::ZERO).collect()
    };
    let matrices: Vec<Vec<Entry>> = expanded(graph, &values).into_iter().map(|(_, values)| put(values)).collect();
    let rights: Vec<Vec<Id>> = expanded(graph, &right).into_iter().map(|(_, values)| values).collect();
    let cost = |graph: &Graph, matrix: &[Entry], right: &[Id]| {
        work(graph, &matrix.iter().map(|e| e.2).chain(right.iter().copied()).collect::<Vec<Id>>())
    };
    let mut best = (cost(graph, &matrix, &right), &matrix, &right);
    for other in std::iter::once(&matrix).chain(&matrices) {
        for right in std::iter::once(&right).chain(&rights) {
            let cost = cost(graph, other, right);
            if cost < best.0 {
                best = (cost, other, right);
            }
        }
    }
    (best.1.clone(), best.2.clone())
}

/// The components of vectors.
const AXES: [&str; 3] = ["x", "y", "z"];

fn equation_names(model: &Model, system: &BalanceSystem) -> Vec<(String, bool)> {
    let mut names = Vec::new();
    for balance in &system.balances {
        let void = balance.void_at_rest;
        match balance.components {
            1 => names.push((balance.label.clone(), void)),
            n => names.extend(AXES.iter().take(n).map(|axis| (format!("{axis} of {}", balance.label), void))),
        }
    }
    let rows = model.rows_of_system(system);
    names.extend(rows.into_iter().map(|row| (format!("the constraint {}", model.row_name(row)), false)));
    names
}

fn unknown_names(model: &Model, system: &BalanceSystem, unknowns: &[Symbol]) -> Vec<String> {
    let mut names: Vec<String> = model.coordinates.iter().map(|c| rate_name(&c.name, 2)).collect();
    for reaction in system.reactions.iter().map(|&k| &model.reactions[k]) {
        if reaction.scalar {
            names.push(reaction.name.clone());
        } else {
            let axes = AXES.iter().take(reaction.components);
            names.extend(axes.map(|axis| format!("{}.{axis}", reaction.name)));
        }
    }
    for symbol in unknowns {
        if let Symbol::Multiplier(row) = symbol {
            names.push(format!("reaction({})", model.row_name(*row as usize)));
        }
    }
    names
}
