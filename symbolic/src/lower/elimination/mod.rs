//! Accelerations by elimination over shared velocities, in O(n) operations for chains and trees.
//!
//! 1. What accelerations make least: look in `derive/least_constraint.rs`.
//! 2. Velocities as linear forms; a velocity that several others are made of is kept as a variable: look in `forms`.
//! 3. The order in which variables are eliminated: look in `order`.
//! 4. Kept variables are put in, coordinates minimise: look in `solve`; sums stay lists of terms until they are read: `sums`.
//! 5. The candidate that takes least time, M and LDLᵀ among them: `depth`.
//!
//! It finds the articulated-body recursion (Featherstone, The International Journal of Robotics Research 2 (1983) 13) without being told of joints:
//! the position of a link's end is shared by all links beyond, so its velocity is kept, and couples no more than its neighbours.  Every pivot is
//! one of LDLᵀ of M in the order of the coordinates that are eliminated, hence positive where M is positive definite.

mod depth;
mod forms;
mod order;
mod solve;
mod sums;

use super::Entry;
use super::count::varying;
use super::factor::Accelerations;
use super::operations;
use crate::derive::{Dynamics, LeastConstraint};
use crate::expr::{Graph, Id, Symbol, canonical_products, copied};
use forms::Forms;
use order::{Interaction, Order, RULES, Rule};
use solve::{Solution, WRITINGS, solve};

/// How accelerations are computed, in words, and the numbers behind it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Elimination {
    /// The order, where accelerations are computed by elimination; none: M and LDLᵀ.
    pub order: Option<&'static str>,
    /// Velocities that several others are made of.
    pub kept: usize,
    /// The largest front.
    pub front: usize,
    /// Nanoseconds that it takes by the model of costs, and that M and LDLᵀ take.
    pub times: [f64; 2],
    /// Operations that it takes, and that M and LDLᵀ take.
    pub operations: [usize; 2],
}

/// Of candidates whose times differ by less than the model of costs can tell, M and LDLᵀ among them, the one with the fewest operations is
/// chosen: it is less to compile, and to interpret.  One with more operations than M and LDLᵀ never is.
const ALIKE: f64 = 1.05;

/// Elimination in the place of M and LDLᵀ, where that takes less time; nothing where no velocity is shared or some is not linear in the
/// speeds.  The graph changes only where the accelerations do.
pub(super) fn choose(
    graph: &mut Graph,
    dynamics: &Dynamics,
    (mass, bias): (&[Entry], &[Id]),
    accelerations: &mut Accelerations,
) -> Option<Elimination> {
    let n = dynamics.n;
    let varies = varying(graph);
    // Where M does not change it is factored once per run; states of first order have no velocities.
    if bias.len() != n || mass.iter().all(|entry| !varies[entry.2.index()]) {
        return None;
    }
    let mut trial = graph.clone();
    let least = LeastConstraint::of(&mut trial, dynamics);
    let forms = Forms::of(&mut trial, n, &least)?;
    if forms.kept.is_empty() {
        return None;
    }
    let (small, forms) = forms.moved(&trial);
    let by_masses = match accelerations {
        Accelerations::Unrolled { values, pivots } => depth::time(graph, &solve::roots(values, pivots)),
        Accelerations::Loop => {
            let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
            depth::time_of_loop(graph, n, &roots)
        }
    };
    let counted = accelerations.operations(graph, n, mass, bias);
    let candidates = candidates(&small, &forms, counted);
    let least = candidates.iter().map(|candidate| candidate.time).reduce(f64::min)?;
    let alike = candidates.into_iter().filter(|candidate| candidate.time <= ALIKE * least);
    let best = alike.min_by_key(|candidate| candidate.operations)?;
    let chosen = best.operations < counted && best.time <= ALIKE * by_masses;
    let found = Elimination {
        order: chosen.then(|| best.rule.words()),
        kept: forms.kept.len(),
        front: best.front,
        times: [best.time, by_masses],
        operations: [best.operations, counted],
    };
    if chosen {
        let roots = copied(&best.graph, &best.solution.roots(), graph);
        let Solution { values, pivots } = best.solution.with(&roots);
        *accelerations = Accelerations::Unrolled { values, pivots };
    }
    Some(found)
}

/// One way to eliminate, in a graph of its own.
struct Candidate {
    rule: Rule,
    front: usize,
    graph: Graph,
    solution: Solution,
    time: f64,
    operations: usize,
}

/// Every order that takes no more operations than the limit, with products written in every way.
fn candidates(base: &Graph, forms: &Forms, limit: usize) -> Vec<Candidate> {
    let interaction = Interaction::of(forms);
    let mut candidates: Vec<Candidate> = Vec::new();
    let mut known: Vec<Order> = Vec::new();
    for rule in RULES {
        let Some(order) = interaction.order(rule, limit).filter(|order| !known.contains(order)) else { continue };
        for writing in WRITINGS {
            let mut graph = base.clone();
            let Some(solution) = solve(&mut graph, forms, &order.variables, writing) else { continue };
            let mut factored = graph.clone();
            let in_order = with_factors_in_order(&mut factored, &solution);
            for (graph, solution) in [(graph, solution), (factored, in_order)] {
                let roots = solution.roots();
                let (time, operations) = (depth::time(&graph, &roots), operations(&graph, &roots));
                if !graph.overflowed() {
                    candidates.push(Candidate { rule, front: order.front, graph, solution, time, operations });
                }
            }
        }
        known.push(order);
    }
    candidates
}

/// With factors of products in one order, which makes chains shorter where it makes more operations.
fn with_factors_in_order(graph: &mut Graph, solution: &Solution) -> Solution {
    let all = canonical_products(graph, &solution.roots(), |symbol| matches!(symbol, Symbol::Parameter(_)));
    solution.with(&all)
}

impl Rule {
    fn words(self) -> &'static str {
        match self {
            Rule::Fill => "fewest new couplings first",
            Rule::Outermost => "outermost first",
            Rule::Bodies => "fewest bodies first",
        }
    }
}

impl Elimination {
    /// What was chosen, and why.
    pub fn words(&self) -> String {
        let Elimination { order, kept, front, times, operations } = self;
        let [eliminating, by_masses] =
            [0, 1].map(|k: usize| format!("about {:.0} ns, {} operations", times[k], operations[k]));
        let velocities = format!("{kept} shared {}", if *kept == 1 { "velocity" } else { "velocities" });
        match order {
            Some(order) => format!(
                "q'': elimination over {velocities}, {order}, largest front {front} ({eliminating}; M and LDLᵀ {by_masses})"
            ),
            None => format!(
                "q'': M and LDLᵀ ({by_masses}; elimination over {velocities}, largest front {front}, {eliminating})"
            ),
        }
    }
}

#[cfg(test)]
mod tests;
