//! Sums in one order, so that equal prefixes are shared however the user wrote them.
//!
//! Nested sums, differences and constant multiples are flattened into Σ cₖ termₖ, like terms are
//! collected, and the sum is rebuilt as a chain of binary sums with the terms in order of falling
//! *popularity* (the number of sums a term occurs in).  In a chain of links the terms of inner links occur
//! in most positions, so the recursion tip[i] = tip[i−1] + … comes back by itself from closed-form sums.

use super::chains::{Chain, Chains};
use super::{Binary, Graph, Id, Node, Unary};
use crate::number::Number;

/// Rebuilds all roots together.
pub fn canonical_sums(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    // The first pass makes equal terms equal, so that the second can count them.
    let roots = Chains::of::<Sum>(graph, roots).rebuild::<Sum>(graph, roots, sum);
    let sums = Chains::of::<Sum>(graph, &roots);
    let popularity = sums.popularity::<Sum, _>(graph, |term| term.0);
    sums.rebuild::<Sum>(graph, &roots, |graph, mut terms, image| {
        terms.sort_by_key(|(term, _)| (std::cmp::Reverse(popularity.get(term)), *term));
        sum(graph, terms, image)
    })
}

/// Σ cₖ termₖ, the terms as they have become.
fn sum(graph: &mut Graph, terms: Vec<(Id, Number)>, image: &dyn Fn(Id) -> Id) -> Id {
    terms.into_iter().fold(Id::ZERO, |sum, (term, coefficient)| {
        let factor = graph.constant(coefficient);
        let term = if term == Id::ONE { term } else { image(term) };
        let product = graph.mul(factor, term);
        graph.add(sum, product)
    })
}

/// The terms of a sum with their coefficients, like terms collected; of anything else itself.
pub fn terms(graph: &Graph, id: Id) -> Vec<(Id, Number)> {
    flatten(graph, id, &|_| false)
}

/// Sums of multiples.
pub(super) struct Sum;

impl Chain for Sum {
    type Part = (Id, Number);

    fn is(graph: &Graph, id: Id) -> bool {
        is_sum(graph, id)
    }

    fn parts(graph: &Graph, root: Id, whole: &dyn Fn(Id) -> bool) -> Vec<(Id, Number)> {
        flatten(graph, root, whole)
    }

    fn id(part: &(Id, Number)) -> Id {
        part.0
    }
}

/// True for sums, differences, opposites and constant multiples of sums.
fn is_sum(graph: &Graph, id: Id) -> bool {
    match graph.node(id) {
        Node::Binary(Binary::Add | Binary::Sub, _, _) => true,
        Node::Unary(Unary::Neg, x) => is_sum(graph, x),
        Node::Binary(Binary::Mul, c, x) => graph.number(c).is_some() && is_sum(graph, x),
        _ => false,
    }
}

/// The terms of a sum and their coefficients, like terms collected, in the order of the arena; parts of which `whole` is
/// true are terms as they are.
fn flatten(graph: &Graph, root: Id, whole: &dyn Fn(Id) -> bool) -> Vec<(Id, Number)> {
    let one = Number::ONE;
    let mut terms: Vec<(Id, Number)> = Vec::new();
    // Parents have larger places than children, so taking the largest first visits each node once.
    let mut open = std::collections::BTreeMap::from([(root, one)]);
    while let Some((id, factor)) = open.pop_last() {
        let parts = match graph.node(id) {
            _ if id != root && whole(id) => {
                terms.push((id, factor));
                continue;
            }
            Node::Binary(Binary::Add, x, y) => vec![(x, factor), (y, factor)],
            Node::Binary(Binary::Sub, x, y) => vec![(x, factor), (y, factor.negated())],
            Node::Unary(Unary::Neg, x) => vec![(x, factor.negated())],
            Node::Binary(Binary::Mul, c, x) if graph.number(c).is_some() => {
                vec![(x, factor.times(graph.number(c).unwrap_or(one)))]
            }
            Node::Number(_) if id != Id::ONE => vec![(Id::ONE, factor.times(graph.number(id).unwrap_or(one)))],
            _ => {
                terms.push((id, factor));
                continue;
            }
        };
        for (part, factor) in parts {
            let known = open.get(&part).copied();
            open.insert(part, known.map_or(factor, |k| k.plus(factor)));
        }
    }
    terms.retain(|(_, c)| c.to_f64() != 0.0);
    terms.reverse();
    terms
}
