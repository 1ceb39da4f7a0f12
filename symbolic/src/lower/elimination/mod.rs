//! Which elimination over shared velocities takes least time, and whether it takes the place of M and LDLᵀ.
//!
//! The elimination itself: look in `derive/elimination`; the model of costs: look in `time`.

mod time;

use super::Entry;
use super::count::varying;
use super::factor::{Accelerations, dense_operations_with_rows};
use super::operations;
use crate::derive::elimination::{
    Eliminated, FEW, Forms, Interaction, Order, RULES, Rule, Solution, WRITINGS, Writing, roots, solve,
};
use crate::derive::{Dynamics, LeastConstraint, Rows};
use crate::expr::{Graph, Id, Symbol, canonical_products, copied};
use crate::gate::Report;
use crate::model::{Model, Phase};

/// How accelerations are computed, in words, and the numbers behind it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Elimination {
    /// The order, where accelerations are computed by elimination; none: M and LDLᵀ.
    pub order: Option<&'static str>,
    /// Velocities that several others are made of.
    pub kept: usize,
    /// Rotations whose angular velocities are unknowns.
    pub rotations: usize,
    /// Rows of constraints whose multipliers are unknowns.
    pub rows: usize,
    /// The largest front.
    pub front: usize,
    /// What it takes.
    pub cost: Cost,
    /// What M and LDLᵀ take, where M is formed.
    pub by_masses: Option<Cost>,
}

/// What accelerations take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// Nanoseconds by the model of costs.
    pub time: f64,
    /// Operations.
    pub operations: usize,
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
    rotations: usize,
    n: usize,
}

impl Found {
    /// From what the equations were derived from; `mass` is any form of M.
    pub fn of(graph: &Graph, dynamics: &Dynamics, mass: &[Entry]) -> Option<Found> {
        let varies = varying(graph);
        if mass.iter().all(|entry| !varies[entry.2.index()]) {
            return None;
        }
        let mut trial = graph.clone();
        let least = LeastConstraint::of(&mut trial, dynamics);
        let forms = Forms::of(&mut trial, dynamics.n, &least)?;
        if forms.are_of_coordinates() {
            return None;
        }
        let bases = in_both_orders(&forms, &trial);
        Some(Found { best: best(&bases)?, kept: forms.kept.len(), rotations: forms.turning.len(), n: forms.n })
    }

    /// Where M is not formed.
    pub fn without_masses(eliminated: &Eliminated) -> Option<Found> {
        let (graph, forms) = &eliminated.least;
        let bases = in_both_orders(forms, graph);
        Some(Found { best: best_of_long(&bases)?, kept: forms.kept.len(), rotations: forms.turning.len(), n: forms.n })
    }

    /// Takes the place of accelerations by M and LDLᵀ where it has fewer operations and takes hardly more time.
    pub fn choose(
        self,
        graph: &mut Graph,
        (mass, bias): (&[Entry], &[Id]),
        accelerations: &mut Accelerations,
    ) -> Elimination {
        let by_masses = cost_by_masses(graph, (self.n, mass, bias), accelerations);
        let Cost { time, operations } = self.best.cost;
        if operations < by_masses.operations && time <= SLOWER * by_masses.time {
            let (own, taken) = self.take(graph);
            *accelerations = own;
            Elimination { by_masses: Some(by_masses), ..taken }
        } else {
            let Candidate { front, cost, .. } = self.best;
            let Found { kept, rotations, .. } = self;
            Elimination { kept, rotations, front, cost, by_masses: Some(by_masses), ..Elimination::default() }
        }
    }

    /// The accelerations, in this graph.
    pub fn take(self, graph: &mut Graph) -> (Accelerations, Elimination) {
        let Found { best: Candidate { rule, front, graph: own, solution, cost }, kept, rotations, .. } = self;
        let roots = copied(&own, &solution.roots(), graph);
        let Solution { values, pivots, .. } = solution.with(&roots);
        let order = Some(rule.words());
        let taken = Elimination { order, kept, rotations, front, cost, ..Elimination::default() };
        (Accelerations::Unrolled { values, pivots }, taken)
    }
}

/// Accelerations and multipliers where all rows of the constraints act, in the graph of the equations.
///
/// Nothing where a phase never has all rows or they depend on each other, where forces are made of multipliers or states of first order are among
/// the coordinates, and where rows determine accelerations by themselves, which forces had better not round.
pub(super) fn constrained(
    model: &mut Model,
    report: &Report,
    (dynamics, rows): (&Dynamics, &Rows),
    (mass, bias): (&[Entry], &[Id]),
) -> Option<(Solution, Elimination)> {
    let made_of_multipliers =
        model.graph.symbols(bias.iter().copied()).iter().any(|s| matches!(s, Symbol::Multiplier(_)));
    let act = |(phase, rank): (&Phase, &usize)| model.rows_of(phase).len() == rows.len() && *rank == rows.len();
    let all_act = model.phases.iter().zip(&report.ranks).any(act);
    let graph = &mut model.graph;
    if !all_act || made_of_multipliers || model.coordinates.len() > dynamics.n || rows.determine(dynamics.n) {
        return None;
    }
    let mut trial = graph.clone();
    let least = LeastConstraint::constrained(&mut trial, dynamics, rows);
    let forms = Forms::of(&mut trial, dynamics.n, &least)?;
    let Candidate { rule, front, graph: own, solution, cost } = best_of_long(&in_both_orders(&forms, &trial))?;
    let with_pivots = cost_with_pivots(graph, dynamics.n, rows, (mass, bias));
    let moved = copied(&own, &solution.roots(), graph);
    let (order, by_masses) = (Some(rule.words()), Some(with_pivots));
    let (kept, rows) = (forms.kept.len(), rows.len());
    let words = Elimination { order, kept, rows, front, cost, by_masses, ..Elimination::default() };
    Some((solution.with(&moved), words))
}

/// What M, h, J and γ take, and to solve for accelerations and multipliers with them.
fn cost_with_pivots(graph: &Graph, n: usize, rows: &Rows, (mass, bias): (&[Entry], &[Id])) -> Cost {
    let entries = mass.iter().chain(&rows.matrix).map(|entry| entry.2);
    let roots: Vec<Id> = entries.chain(bias.iter().chain(&rows.bias).copied()).collect();
    let dense = dense_operations_with_rows(n, rows.len());
    Cost { time: time::time_with(graph, &roots, dense), operations: operations(graph, &roots) + dense }
}

/// With factors of products as they come, and those without speeds first.
fn in_both_orders(forms: &Forms, graph: &Graph) -> [(Graph, Forms); 2] {
    [false, true].map(|in_order| forms.clone().moved(graph, in_order))
}

/// What accelerations by M and h take, M and h included.
pub(super) fn cost_by_masses(
    graph: &Graph,
    (n, mass, bias): (usize, &[Entry], &[Id]),
    accelerations: &Accelerations,
) -> Cost {
    let time = match accelerations {
        Accelerations::Unrolled { values, pivots } => time::time(graph, &roots(values, pivots)),
        Accelerations::Loop => {
            let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
            time::time_of_loop(graph, n, &roots)
        }
    };
    Cost { time, operations: accelerations.operations(graph, n, mass, bias) }
}

/// One way to eliminate, in a graph of its own.
struct Candidate {
    rule: Rule,
    front: usize,
    graph: Graph,
    solution: Solution,
    cost: Cost,
}

/// Every order with products written in every way; where there are many coordinates the other ways for the fastest order alone.
fn best(bases: &[(Graph, Forms); 2]) -> Option<Candidate> {
    let n = bases[0].1.n;
    let orders = orders(&bases[0].1);
    let [first, others @ ..] = WRITINGS;
    let tried = |(rule, order): &(Rule, Order), writing| {
        let of = |base| candidates(base, (*rule, order), writing);
        bases.iter().flat_map(of).collect::<Vec<Candidate>>()
    };
    let plain: Vec<Vec<Candidate>> = orders.iter().map(|order| tried(order, first)).collect();
    let first = (0..plain.len()).min_by(|a, b| fastest(&plain[*a]).total_cmp(&fastest(&plain[*b])))?;
    let further = (0..plain.len()).filter(|order| n <= FEW || *order == first);
    let written = further.flat_map(|order| others.iter().map(move |writing| (order, *writing)));
    let written: Vec<Candidate> = written.flat_map(|(order, writing)| tried(&orders[order], writing)).collect();
    leanest(plain.into_iter().flatten().chain(written).collect())
}

/// Every order with factors as they come and those without speeds first, and the best of them with factors in one order too: other ways to write
/// products take more operations, for no more time than the model of costs can tell.
fn best_of_long(bases: &[(Graph, Forms); 2]) -> Option<Candidate> {
    let orders = orders(&bases[0].1);
    let tried = |(rule, order): &(Rule, Order)| {
        let of = |base| Candidate::of(base, (*rule, order), WRITINGS[0]);
        bases.iter().filter_map(of).collect::<Vec<Candidate>>()
    };
    let best = leanest(orders.iter().flat_map(tried).collect())?;
    let (_, order) = orders.iter().find(|(rule, _)| *rule == best.rule)?;
    let factored = bases.iter().flat_map(|base| candidates(base, (best.rule, order), WRITINGS[0]));
    leanest(factored.collect())
}

/// The orders that the rules give, each once.
fn orders(forms: &Forms) -> Vec<(Rule, Order)> {
    let interaction = Interaction::of(forms);
    let mut orders: Vec<(Rule, Order)> = Vec::new();
    for rule in RULES {
        let order = interaction.order(rule);
        orders.extend(order.filter(|order| orders.iter().all(|known| known.1 != *order)).map(|order| (rule, order)));
    }
    orders
}

fn fastest(list: &[Candidate]) -> f64 {
    list.iter().map(|candidate| candidate.cost.time).fold(f64::INFINITY, f64::min)
}

/// Of those that are about as fast as the fastest the one with the fewest operations.
fn leanest(all: Vec<Candidate>) -> Option<Candidate> {
    let least = fastest(&all);
    let alike = all.into_iter().filter(|candidate| candidate.cost.time <= ALIKE * least);
    alike.min_by_key(|candidate| candidate.cost.operations)
}

/// With factors of products as they come, and in one order.
fn candidates(base: &(Graph, Forms), (rule, order): (Rule, &Order), writing: Writing) -> Vec<Candidate> {
    let Some(plain) = Candidate::of(base, (rule, order), writing) else { return Vec::new() };
    let mut graph = plain.graph.clone();
    let in_order = with_factors_in_order(&mut graph, &plain.solution);
    let factored = Candidate::with_cost((rule, order), graph, in_order);
    [Some(plain), factored].into_iter().flatten().collect()
}

impl Candidate {
    fn of((base, forms): &(Graph, Forms), (rule, order): (Rule, &Order), writing: Writing) -> Option<Candidate> {
        let mut graph = base.clone();
        let solution = solve(&mut graph, forms, &order.variables, writing)?;
        Candidate::with_cost((rule, order), graph, solution)
    }

    fn with_cost((rule, order): (Rule, &Order), graph: Graph, solution: Solution) -> Option<Candidate> {
        let roots = solution.roots();
        let cost = Cost { time: time::time(&graph, &roots), operations: operations(&graph, &roots) };
        let fits = !graph.overflowed();
        fits.then_some(Candidate { rule, front: order.front, graph, solution, cost })
    }
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
        let Elimination { order, kept, rotations, rows, front, cost, by_masses } = self;
        let words = |cost: &Cost| format!("about {:.0} ns, {} operations", cost.time, cost.operations);
        let eliminating = words(cost);
        let by_masses = by_masses.as_ref().map_or_else(|| "are not formed".to_owned(), words);
        let shared = format!("{kept} shared {}", if *kept == 1 { "velocity" } else { "velocities" });
        let velocities = match (kept, rotations) {
            (_, 0) => shared,
            (0, _) => "angular velocities".to_owned(),
            _ => format!("angular velocities and {shared}"),
        };
        match order {
            Some(order) if *rows > 0 => format!(
                "q'' and the multipliers of {rows} {}: elimination over {velocities}, {order}, largest front {front} ({eliminating}); where \
                 rows depend on each other, or nearly, M and J with pivots ({by_masses})",
                if *rows == 1 { "row" } else { "rows" }
            ),
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
