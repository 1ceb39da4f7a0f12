//! Systems of balances as linear equations A·[q''; reactions] = b.
//!
//! A and b come from the balances alone: A by one reverse pass for each equation (or one forward pass for all where
//! that is cheaper, which is decided when lowering), b as what is left where all unknowns are zero.

use std::collections::BTreeMap;

use super::Rows;
use super::switches::{self, Switch};
use crate::expr::{Forward, Graph, Id, Symbol, gradients, jacobian, substitute};
use crate::model::{BalanceSystem, Model};

/// One system of balances, solved for nothing yet.
#[derive(Clone, Debug)]
pub struct Momentum {
    /// The unknowns: accelerations, then the components of its reactions.
    pub unknowns: Vec<Symbol>,
    /// The non-zeros of A, row by row: (row, column, value).
    pub matrix: Vec<(usize, usize, Id)>,
    /// b.
    pub right: Vec<Id>,
    /// How many equations at the end are not balances but the constraints of the system's phase.
    pub constraints: usize,
    /// The equations among those of the file and its constraints that these are, where some were left out that follow from others.
    pub kept: Option<Vec<usize>>,
    /// Force and moment on every body, in the same unknowns, to compare reactions with; the rows of one body after the
    /// other's.
    pub bodies: Option<Box<Momentum>>,
    /// What stands for A and b where they are not formed.
    pub unformed: Option<Unformed>,
}

/// A system that has accelerations alone for unknowns, without A and b.
#[derive(Clone, Debug)]
pub struct Unformed {
    /// The equations, A q'' − b.
    pub values: Vec<Id>,
    /// A d, d being `Dummy(i)` for the acceleration i.
    pub along: Vec<Id>,
}

impl Momentum {
    /// The same with some of the equations.
    pub fn only(&self, kept: &[usize]) -> Momentum {
        let balances = self.right.len() - self.constraints;
        let place = |row: usize| kept.iter().position(|k| *k == row);
        let entries = self.matrix.iter().filter_map(|(row, column, value)| Some((place(*row)?, *column, *value)));
        Momentum {
            matrix: entries.collect(),
            right: kept.iter().map(|row| self.right[*row]).collect(),
            constraints: kept.iter().filter(|row| **row >= balances).count(),
            kept: Some(kept.to_vec()),
            ..self.clone()
        }
    }

    /// True where A contains an unknown, so that the equations are not linear.
    pub fn is_nonlinear(&self, graph: &Graph) -> bool {
        let along = self.unformed.iter().flat_map(|unformed| unformed.along.iter().copied());
        let symbols = graph.symbols(self.matrix.iter().map(|e| e.2).chain(along));
        symbols.iter().any(|s| self.unknowns.contains(s))
    }
}

/// Every system of a model, with modes in the place of the discontinuities that the equations of motion have; with A and b
/// where these are to be `formed`, or reactions are unknown.
pub(crate) fn systems(model: &mut Model, rows: &Rows, known: &[Switch], formed: bool) -> Vec<Momentum> {
    let balances = std::mem::take(&mut model.balances);
    let systems = balances.iter().map(|system| match formed || !system.reactions.is_empty() {
        true => linear(model, rows, system, known),
        false => unformed(model, system, known),
    });
    let systems = systems.collect();
    model.balances = balances;
    systems
}

/// A system without constraints whose unknowns are the accelerations.
fn unformed(model: &mut Model, system: &BalanceSystem, known: &[Switch]) -> Momentum {
    let unknowns = unknowns(model, system);
    let graph = &mut model.graph;
    let values = residuals(graph, system);
    let values = switches::recall(graph, &values, known);
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Acceleration(i) => g.symbol(Symbol::Dummy(i)),
        _ => Id::ZERO,
    });
    let along = values.iter().map(|value| forward.of(graph, *value)).collect();
    let unformed = Some(Unformed { values, along });
    Momentum { unknowns, matrix: Vec::new(), right: Vec::new(), constraints: 0, kept: None, bodies: None, unformed }
}

/// The sums of the parts of all balances, component by component.
fn residuals(graph: &mut Graph, system: &BalanceSystem) -> Vec<Id> {
    let mut residuals = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            let sum = balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k]));
            residuals.push(sum);
        }
    }
    residuals
}

fn linear(model: &mut Model, rows: &Rows, system: &BalanceSystem, known: &[Switch]) -> Momentum {
    let unknowns = unknowns(model, system);
    let active = model.rows_of_system(system);
    let acts = contact_rows_act(model, system);
    let graph = &mut model.graph;
    let mut residuals = residuals(graph, system);
    let mut of_bodies = system.bodies.clone();
    if let [phase] = system.phases.as_slice() {
        residuals = in_phase(graph, model.phases.len(), *phase, &residuals);
        of_bodies = in_phase(graph, model.phases.len(), *phase, &of_bodies);
    }
    let mut constraints = Vec::new();
    // What multipliers of contacts are is judged as balances are, and stands with them.
    for (acceleration, row) in rows.accelerations(graph, &active).into_iter().zip(&active) {
        match acts.get(row) {
            None => constraints.push(acceleration),
            Some(acts) => residuals.push(holds_or_is_free(graph, *acts, acceleration, *row)),
        }
    }
    residuals.extend(constraints);
    let bodies = (!of_bodies.is_empty()).then(|| Box::new(solved_for(graph, &of_bodies, &unknowns, known)));
    Momentum { constraints: active.len() - acts.len(), bodies, ..solved_for(graph, &residuals, &unknowns, known) }
}

/// Of each contact's row, in a system of all phases, the indicator of those in which it acts.
fn contact_rows_act(model: &mut Model, system: &BalanceSystem) -> BTreeMap<usize, Id> {
    let mut acts = BTreeMap::new();
    if system.phases.len() < 2 {
        return acts;
    }
    for row in model.contact_rows() {
        let phases: Vec<usize> =
            (0..model.phases.len()).filter(|k| model.rows_of(&model.phases[*k]).contains(&row)).collect();
        acts.insert(row, model.graph.in_phases(&phases, model.phases.len()));
    }
    acts
}

/// c'' = 0 where a row acts, λ = 0 where it does not: (acts) c'' + (1 − acts) λ.
fn holds_or_is_free(graph: &mut Graph, acts: Id, acceleration: Id, row: usize) -> Id {
    let multiplier = graph.symbol(Symbol::Multiplier(row as u32));
    let free = graph.sub(Id::ONE, acts);
    let (held, free) = (graph.mul(acts, acceleration), graph.mul(free, multiplier));
    graph.add(held, free)
}

/// Residuals as linear equations in the unknowns.
fn solved_for(graph: &mut Graph, residuals: &[Id], unknowns: &[Symbol], known: &[Switch]) -> Momentum {
    let residuals = switches::recall(graph, residuals, known);
    let matrix = slopes(graph, &residuals, unknowns);
    let zero = unknowns.iter().map(|s| (*s, Id::ZERO)).collect();
    let right = substitute(graph, &residuals, &zero).into_iter().map(|rest| graph.neg(rest)).collect();
    Momentum { unknowns: unknowns.to_vec(), matrix, right, constraints: 0, kept: None, bodies: None, unformed: None }
}

/// The unknowns of a system: accelerations, then the components of its reactions, then the multipliers that stand in it.
pub(crate) fn unknowns(model: &Model, system: &BalanceSystem) -> Vec<Symbol> {
    let accelerations = (0..model.coordinates.len()).map(|i| Symbol::Acceleration(i as u32));
    let reactions = system.reactions.iter().flat_map(|&k| model.reactions[k].symbols());
    let parts = system.balances.iter().flat_map(|balance| &balance.parts);
    let values: Vec<Id> = parts.flat_map(|part| part.value.iter().copied()).collect();
    if model.constraints.is_empty() {
        return accelerations.chain(reactions).collect();
    }
    // Those of forces that act in none of its phases are no unknowns.
    let mut graph = model.graph.clone();
    let mut multipliers: Vec<Symbol> = Vec::new();
    for phase in &system.phases {
        let values = in_phase(&mut graph, model.phases.len(), *phase, &values);
        multipliers.extend(graph.symbols(values).into_iter().filter(|s| matches!(s, Symbol::Multiplier(_))));
    }
    if system.phases.len() > 1 {
        multipliers.extend(model.contact_rows().into_iter().map(|row| Symbol::Multiplier(row as u32)));
    }
    multipliers.sort_unstable();
    multipliers.dedup();
    accelerations.chain(reactions).chain(multipliers).collect()
}

/// Expressions as they are in a phase.
pub(super) fn in_phase(graph: &mut Graph, phases: usize, phase: usize, values: &[Id]) -> Vec<Id> {
    let indicators =
        (0..phases).map(|k| (Symbol::Phase(k as u32), if k == phase { Id::ONE } else { Id::ZERO })).collect();
    substitute(graph, values, &indicators)
}

/// With more equations than this a reverse pass for each, which walks a chain of bodies once, is always cheaper
/// than a forward pass, which carries every column through every body.
const FORWARD_LIMIT: usize = 16;

/// ∂residuals/∂unknowns.
fn slopes(graph: &mut Graph, residuals: &[Id], unknowns: &[Symbol]) -> Vec<(usize, usize, Id)> {
    let column = |s: Symbol| unknowns.iter().position(|u| *u == s);
    if residuals.len() <= FORWARD_LIMIT {
        let rows = jacobian(graph, residuals, column).into_iter().enumerate();
        return rows.flat_map(|(i, row)| row.into_iter().map(move |(j, slope)| (i, j, slope))).collect();
    }
    let mut entries = Vec::new();
    for (i, gradient) in gradients(graph, residuals, |s| unknowns.contains(&s)).iter().enumerate() {
        let first = entries.len();
        entries.extend(gradient.iter().filter_map(|(s, slope)| Some((i, column(*s)?, *slope))));
        entries[first..].sort_by_key(|e| e.1);
    }
    entries.retain(|e| e.2 != Id::ZERO);
    entries
}
