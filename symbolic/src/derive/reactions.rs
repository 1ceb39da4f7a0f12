//! Reactions as expressions of the state and the accelerations.

use rustc_hash::FxHashMap as HashMap;

use super::momentum::unknowns;
use crate::expr::{Graph, Id, Node, Symbol, expand, jacobian};
use crate::model::{BalanceSystem, Model};

/// Puts reactions, by name, into what observes: outputs, events and checks.  Tells which components of outputs,
/// by place, were a component of a reaction as it stands.
pub(crate) fn put_in(model: &mut Model) -> Vec<(usize, Symbol)> {
    let components = model.outputs.iter().flat_map(|output| &output.value).enumerate();
    let named = components.filter_map(|(place, id)| match model.graph.node(*id) {
        Node::Symbol(reaction @ Symbol::Reaction(_)) => Some((place, reaction)),
        _ => None,
    });
    let named = named.collect();
    let known = reactions(model);
    if known.is_empty() {
        return named;
    }
    let graph = &mut model.graph;
    let mut put = |list: &mut [Id]| {
        let new = crate::expr::substitute(graph, list, &known);
        list.copy_from_slice(&new);
    };
    model.outputs.iter_mut().for_each(|output| put(&mut output.value));
    for event in &mut model.events {
        put(std::slice::from_mut(&mut event.when));
        if let Some(condition) = &mut event.condition {
            put(std::slice::from_mut(condition));
        }
    }
    for check in &mut model.checks {
        put(&mut check.left);
        put(&mut check.right);
    }
    named
}

/// Each reaction component as an expression of the state and the accelerations: the least-squares solution of the
/// first system that names it, which is exact since the system agrees with the motion.
fn reactions(model: &mut Model) -> HashMap<Symbol, Id> {
    let mut known = HashMap::default();
    let wanted = wanted(model);
    for system in model.balances.clone() {
        let unknowns: Vec<Symbol> = unknowns(model, &system)[model.coordinates.len()..].to_vec();
        if !unknowns.iter().any(|s| wanted.contains(s) && !known.contains_key(s)) {
            continue;
        }
        for (symbol, value) in unknowns.iter().zip(least_squares(&mut model.graph, &system, &unknowns)) {
            known.entry(*symbol).or_insert(value);
        }
    }
    known
}

/// The reactions that outputs, events and checks contain.
fn wanted(model: &Model) -> Vec<Symbol> {
    let outputs = model.outputs.iter().flat_map(|output| output.value.iter().copied());
    let events = model.events.iter().flat_map(|event| [Some(event.when), event.condition]).flatten();
    let checks = model.checks.iter().flat_map(|check| check.left.iter().chain(&check.right).copied());
    let symbols = model.graph.symbols(outputs.chain(events).chain(checks));
    symbols.into_iter().filter(|s| matches!(s, Symbol::Reaction(_))).collect()
}

/// (RᵀR)⁻¹Rᵀ(−s) for residuals R r + s, with s at r = 0.
fn least_squares(graph: &mut Graph, system: &BalanceSystem, unknowns: &[Symbol]) -> Vec<Id> {
    let m = unknowns.len();
    let mut residuals = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            let mut sum = Id::ZERO;
            for part in &balance.parts {
                sum = graph.add(sum, part.value[k]);
            }
            residuals.push(sum);
        }
    }
    let rows = jacobian(graph, &residuals, |s| unknowns.iter().position(|u| *u == s));
    let zero = unknowns.iter().map(|u| (*u, Id::ZERO)).collect();
    let rest = crate::expr::substitute(graph, &residuals, &zero);
    let mut normal = vec![vec![Id::ZERO; m + 1]; m];
    for (row, s) in rows.iter().zip(&rest) {
        for &(i, a) in row {
            for &(j, b) in row {
                let product = graph.mul(a, b);
                normal[i][j] = graph.add(normal[i][j], product);
            }
            let product = graph.mul(a, *s);
            normal[i][m] = graph.sub(normal[i][m], product);
        }
    }
    // cos² + sin² of a direction becomes 1, so that most pivots are constants.
    // All rows at once, for what they share; row by row where that grows too large.
    let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let all: Vec<Id> = normal.iter().flat_map(|row| &row[..m]).copied().collect();
    let together = expand(graph, &all, constant);
    for (k, row) in normal.iter_mut().enumerate() {
        let simple = match &together {
            Some(all) => Some(all[k * m..][..m].to_vec()),
            None => expand(graph, &row[..m], constant),
        };
        if let Some(simple) = simple {
            row[..m].copy_from_slice(&simple);
        }
    }
    for k in 0..m {
        let pivot_row = normal[k].clone();
        let pivot = graph.div(Id::ONE, pivot_row[k]);
        for row in normal.iter_mut().skip(k + 1).filter(|row| row[k] != Id::ZERO) {
            let factor = graph.mul(row[k], pivot);
            for (entry, above) in row.iter_mut().zip(&pivot_row).skip(k + 1).filter(|(_, above)| **above != Id::ZERO) {
                let update = graph.mul(factor, *above);
                *entry = graph.sub(*entry, update);
            }
        }
    }
    let mut solution = vec![Id::ZERO; m];
    for k in (0..m).rev() {
        let mut value = normal[k][m];
        for j in k + 1..m {
            let term = graph.mul(normal[k][j], solution[j]);
            value = graph.sub(value, term);
        }
        solution[k] = graph.div(value, normal[k][k]);
    }
    solution
}
