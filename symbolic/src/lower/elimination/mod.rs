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
use super::factor::{Accelerations, factoring_operations};
use super::operations;
use crate::derive::{Dynamics, LeastConstraint};
use crate::expr::{Graph, Id, Symbol, canonical_products, copied};
use forms::Forms;
use order::{Interaction, Order, RULES, Rule};
use solve::{Solution, WRITINGS, Writing, solve};

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

/// Of eliminations whose times differ by less than the model of costs can tell (its choices took up to 12 % longer than the best), the one with
/// the fewest operations is taken: it is less to compile, and to interpret.
const ALIKE: f64 = 1.1;
/// How many times longer than M and LDLᵀ it may take by the model, for fewer operations.
const SLOWER: f64 = 1.05;

/// The best elimination, in a graph of its own, with how many velocities are kept; nothing where no velocity is shared or some is not linear in the
/// speeds, and where M does not change, since it is factored once per run.
pub(super) struct Found {
    best: Candidate,
    kept: usize,
    n: usize,
}

impl Found {
    /// From what the equations were derived from; `mass` is any form of M.
    pub fn of(graph: &Graph, dynamics: &Dynamics, mass: &[Entry]) -> Option<Found> {
        let n = dynamics.n;
        let varies = varying(graph);
        if mass.iter().all(|entry| !varies[entry.2.index()]) {
            return None;
        }
        let mut trial = graph.clone();
        let least = LeastConstraint::of(&mut trial, dynamics);
        let forms = Forms::of(&mut trial, n, &least)?;
        if forms.kept.is_empty() {
            return None;
        }
        let kept = forms.kept.len();
        let bases = [false, true].map(|in_order| forms.clone().moved(&trial, in_order));
        let best = best(&bases)?;
        Some(Found { best, kept, n })
    }

    /// Whether factoring M alone, with as many entries as it has, takes more operations than everything here: then M and h need not be
    /// brought to their best forms.  Where there are few coordinates it is not asked.
    pub fn is_certain(&self, mass: &[Entry]) -> bool {
        self.n > FEW && self.best.operations < factoring_operations(self.n, mass)
    }

    /// Takes the place of accelerations by M and LDLᵀ where it has fewer operations and takes hardly more time.
    pub fn choose(
        self,
        graph: &mut Graph,
        (mass, bias): (&[Entry], &[Id]),
        accelerations: &mut Accelerations,
    ) -> Elimination {
        let by_masses = match accelerations {
            Accelerations::Unrolled { values, pivots } => depth::time(graph, &solve::roots(values, pivots)),
            Accelerations::Loop => {
                let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
                depth::time_of_loop(graph, self.n, &roots)
            }
        };
        let counted = accelerations.operations(graph, self.n, mass, bias);
        let Candidate { rule, front, graph: own, solution, time, operations } = self.best;
        let chosen = operations < counted && time <= SLOWER * by_masses;
        if chosen {
            let roots = copied(&own, &solution.roots(), graph);
            let Solution { values, pivots } = solution.with(&roots);
            *accelerations = Accelerations::Unrolled { values, pivots };
        }
        Elimination {
            order: chosen.then(|| rule.words()),
            kept: self.kept,
            front,
            times: [time, by_masses],
            operations: [operations, counted],
        }
    }
}

/// With no more coordinates than this M and LDLᵀ in their best forms are compared.
const FEW: usize = 16;

/// One way to eliminate, in a graph of its own.
struct Candidate {
    rule: Rule,
    front: usize,
    graph: Graph,
    solution: Solution,
    time: f64,
    operations: usize,
}

/// Every order with products written in every way; where there are many coordinates the other ways for the fastest order alone.
fn best(bases: &[(Graph, Forms); 2]) -> Option<Candidate> {
    let n = bases[0].1.n;
    let interaction = Interaction::of(&bases[0].1);
    let mut orders: Vec<(Rule, Order)> = Vec::new();
    for rule in RULES {
        let order = interaction.order(rule);
        orders.extend(order.filter(|order| orders.iter().all(|known| known.1 != *order)).map(|order| (rule, order)));
    }
    let [first, others @ ..] = WRITINGS;
    let tried = |(rule, order): &(Rule, Order), writing| {
        let of = |base| candidates(base, (*rule, order), writing);
        bases.iter().flat_map(of).collect::<Vec<Candidate>>()
    };
    let plain: Vec<Vec<Candidate>> = orders.iter().map(|order| tried(order, first)).collect();
    let fastest = |list: &[Candidate]| list.iter().map(|candidate| candidate.time).fold(f64::INFINITY, f64::min);
    let first = (0..plain.len()).min_by(|a, b| fastest(&plain[*a]).total_cmp(&fastest(&plain[*b])))?;
    let further = (0..plain.len()).filter(|order| n <= FEW || *order == first);
    let written = further.flat_map(|order| others.iter().map(move |writing| (order, *writing)));
    let written: Vec<Candidate> = written.flat_map(|(order, writing)| tried(&orders[order], writing)).collect();
    let all: Vec<Candidate> = plain.into_iter().flatten().chain(written).collect();
    let least = fastest(&all);
    all.into_iter().filter(|candidate| candidate.time <= ALIKE * least).min_by_key(|candidate| candidate.operations)
}

/// With factors of products as they come, and in one order.
fn candidates((base, forms): &(Graph, Forms), (rule, order): (Rule, &Order), writing: Writing) -> Vec<Candidate> {
    let mut graph = base.clone();
    let Some(solution) = solve(&mut graph, forms, &order.variables, writing) else { return Vec::new() };
    let mut factored = graph.clone();
    let in_order = with_factors_in_order(&mut factored, &solution);
    let candidate = |(graph, solution): (Graph, Solution)| {
        let roots = solution.roots();
        let (time, operations) = (depth::time(&graph, &roots), operations(&graph, &roots));
        let fits = !graph.overflowed();
        fits.then_some(Candidate { rule, front: order.front, graph, solution, time, operations })
    };
    [(graph, solution), (factored, in_order)].into_iter().filter_map(candidate).collect()
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
