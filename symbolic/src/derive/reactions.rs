//! Reactions as expressions of the state and the accelerations.

use rustc_hash::FxHashMap as HashMap;

use super::momentum::{in_phase, unknowns};
use super::weights::{typical, weights};
use crate::expr::{Angles, Graph, Id, Node, Symbol, Unary, expand, jacobian};
use crate::model::{BalanceSystem, Model};

/// Puts reactions, by name, into what observes: outputs, events and what these set, and checks.  Tells which components of outputs,
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
    let (graph, count) = (&mut model.graph, model.phases.len());
    for output in &mut model.outputs {
        let symbols = graph.symbols(output.value.iter().copied());
        output.of_reactions = symbols.iter().any(|s| matches!(s, Symbol::Reaction(_)));
    }
    let mut values = |absent: bool| -> HashMap<Symbol, Id> {
        known.iter().map(|(symbol, named)| (*symbol, named.value(graph, count, absent))).collect()
    };
    let (reported, known) = (values(true), values(false));
    let mut put = |list: &mut [Id], known: &HashMap<Symbol, Id>| {
        let new = crate::expr::substitute(graph, list, known);
        list.copy_from_slice(&new);
    };
    // What is infinite is reported as absent.
    model.outputs.iter_mut().for_each(|output| put(&mut output.value, &reported));
    let mut put = |list: &mut [Id]| put(list, &known);
    for event in &mut model.events {
        put(std::slice::from_mut(&mut event.when));
        if let Some(condition) = &mut event.condition {
            put(std::slice::from_mut(condition));
        }
    }
    for (_, value) in model.sets.iter_mut().flat_map(|set| &mut set.values) {
        put(std::slice::from_mut(value));
    }
    for check in &mut model.checks {
        put(&mut check.left);
        put(&mut check.right);
    }
    named
}

/// Each reaction component as an expression of the state and the accelerations: in every phase the least-squares solution
/// of the first system of that phase that names it, which is exact since the system agrees with the motion.
fn reactions(model: &mut Model) -> HashMap<Symbol, Named> {
    let mut known: HashMap<Symbol, Named> = HashMap::default();
    let wanted = wanted(model);
    for system in model.balances.clone() {
        let unknowns: Vec<Symbol> = unknowns(model, &system)[model.coordinates.len()..].to_vec();
        let new = |named: Option<&Named>, phase: &usize| named.is_none_or(|named| !named.phases.contains(phase));
        let asked = |s: &Symbol| wanted.contains(s) && system.phases.iter().any(|phase| new(known.get(s), phase));
        if !unknowns.iter().any(asked) {
            continue;
        }
        let mut values = least_squares(model, &system, &unknowns);
        if let [phase] = system.phases.as_slice() {
            values = in_phase(&mut model.graph, model.phases.len(), *phase, &values);
        }
        // A multiplier has a value of its own, in every phase.
        let reactions = unknowns.iter().zip(values).filter(|(symbol, _)| matches!(symbol, Symbol::Reaction(_)));
        for (symbol, value) in reactions {
            let named = known.entry(*symbol).or_default();
            let phases: Vec<usize> =
                system.phases.iter().copied().filter(|phase| !named.phases.contains(phase)).collect();
            if !phases.is_empty() {
                named.phases.extend(&phases);
                named.values.push((phases, value));
            }
        }
    }
    known
}

/// What systems of balances say of a reaction component.
#[derive(Default)]
struct Named {
    /// The phases of all of them.
    phases: Vec<usize>,
    /// In which phases it has which value.
    values: Vec<(Vec<usize>, Id)>,
}

impl Named {
    /// The value in every phase; where no system tells, infinite if it is to be `absent` there.
    fn value(&self, graph: &mut Graph, count: usize, absent: bool) -> Id {
        let value = match self.values.as_slice() {
            [(_, value)] => *value,
            several => several.iter().fold(Id::ZERO, |sum, (phases, value)| {
                let active = graph.in_phases(phases, count);
                let term = graph.mul(active, *value);
                graph.add(sum, term)
            }),
        };
        let active = graph.in_phases(&self.phases, count);
        if !absent || active == Id::ONE {
            return value;
        }
        // ln 1 is 0, and ln 0 infinite.
        let infinite = graph.unary(Unary::Ln, active);
        graph.add(value, infinite)
    }
}

/// The reactions that outputs, events, what these set and checks contain.
fn wanted(model: &Model) -> Vec<Symbol> {
    let outputs = model.outputs.iter().flat_map(|output| output.value.iter().copied());
    let events = model.events.iter().flat_map(|event| [Some(event.when), event.condition]).flatten();
    let checks = model.checks.iter().flat_map(|check| check.left.iter().chain(&check.right).copied());
    let sets = model.sets.iter().flat_map(|set| set.values.iter().map(|(_, value)| *value));
    let symbols = model.graph.symbols(outputs.chain(events).chain(checks).chain(sets));
    symbols.into_iter().filter(|s| matches!(s, Symbol::Reaction(_))).collect()
}

/// (RᵀWR)⁻¹RᵀW(−s) for residuals R r + s, with s at r = 0.
///
/// W weighs the balances: a row of a moment holds lengths where one of a force holds numbers without a unit, and rows
/// without weights make a normal matrix with the square of the lengths in its condition.  The solution is the same for all W, since the
/// system agrees with the motion.
fn least_squares(model: &mut Model, system: &BalanceSystem, unknowns: &[Symbol]) -> Vec<Id> {
    let (m, defaults) = (unknowns.len(), typical(model));
    let couple = |unknown: &Symbol| model.reactions.iter().any(|r| r.couple && r.symbols().any(|s| s == *unknown));
    let couples: Vec<bool> = unknowns.iter().map(couple).collect();
    let graph = &mut model.graph;
    let mut residuals = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            residuals.push(balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k])));
        }
    }
    let rows = jacobian(graph, &residuals, |s| unknowns.iter().position(|u| *u == s));
    let zero = unknowns.iter().map(|u| (*u, Id::ZERO)).collect();
    let rest = crate::expr::substitute(graph, &residuals, &zero);
    let mut normal = vec![vec![Id::ZERO; m + 1]; m];
    let (mut own, mut others) = (Vec::new(), rows.as_slice());
    for balance in &system.balances {
        let (first, left) = others.split_at(balance.components);
        own.push(first);
        others = left;
    }
    let weights = weights(graph, &own, &couples, &defaults);
    let weights = own.iter().zip(weights).flat_map(|(rows, weight)| vec![weight; rows.len()]);
    for ((row, s), weight) in rows.iter().zip(&rest).zip(weights) {
        for &(i, a) in row {
            let weighted = graph.mul(weight, a);
            for &(j, b) in row {
                let product = graph.mul(weighted, b);
                normal[i][j] = graph.add(normal[i][j], product);
            }
            let product = graph.mul(weighted, *s);
            normal[i][m] = graph.sub(normal[i][m], product);
        }
    }
    // cos² + sin² of a direction becomes 1, so that most pivots are constants.
    // All rows at once, for what they share; row by row where that grows too large.
    let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let all: Vec<Id> = normal.iter().flat_map(|row| &row[..m]).copied().collect();
    let together = expand(graph, &all, constant, Angles::Shorter);
    for (k, row) in normal.iter_mut().enumerate() {
        let simple = match &together {
            Some(all) => Some(all[k * m..][..m].to_vec()),
            None => expand(graph, &row[..m], constant, Angles::Shorter),
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
