//! Sums in one order, so that equal prefixes are shared however the user wrote them.
//!
//! Nested sums, differences and constant multiples are flattened into Σ cₖ termₖ, like terms are
//! collected, and the sum is rebuilt as a chain of binary sums with the terms in order of falling
//! *popularity* (the number of sums a term occurs in).  In a chain of links the terms of inner links occur
//! in most positions, so the recursion tip[i] = tip[i−1] + … comes back by itself from closed-form sums.

use super::{Binary, Graph, Id, Node, Unary};
use crate::number::Number;

/// Rebuilds all roots together.
pub fn canonical(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    // The first pass makes equal terms equal, so that the second can count them.
    let roots = pass(graph, roots, |_, _| {});
    let popularity = popularity(graph, &roots);
    let by_popularity = |_: &Graph, terms: &mut Vec<(Id, Number)>| {
        terms.sort_by_key(|(term, _)| {
            let count = popularity.get(term.index()).copied().unwrap_or(0);
            (std::cmp::Reverse(count), *term)
        });
    };
    pass(graph, &roots, by_popularity)
}

/// One rebuilding; `order` arranges the terms of a sum, given by their places before this pass.
fn pass(graph: &mut Graph, roots: &[Id], order: impl Fn(&Graph, &mut Vec<(Id, Number)>)) -> Vec<Id> {
    let needed = graph.reachable(roots.iter().copied());
    let mut image: Vec<Option<Id>> = vec![None; needed.len()];
    let wanted = consumers(graph, roots, &needed);
    for i in (0..needed.len()).filter(|&i| needed[i]) {
        let id = graph.id_at(i);
        if !wanted[i] {
            continue;
        }
        let of = |image: &[Option<Id>], x: Id| image[x.index()].unwrap_or(x);
        let new = match graph.node(id) {
            _ if is_sum(graph, id) => {
                let mut terms = flatten(graph, id);
                order(graph, &mut terms);
                let mut sum = Id::ZERO;
                for (term, coefficient) in terms {
                    let factor = graph.constant(coefficient);
                    let product = graph.mul(factor, of(&image, term));
                    sum = graph.add(sum, product);
                }
                sum
            }
            Node::Unary(f, x) => graph.unary(f, of(&image, x)),
            Node::Binary(f, x, y) => graph.binary(f, of(&image, x), of(&image, y)),
            Node::Number(_) | Node::Symbol(_) => id,
        };
        image[i] = Some(new);
    }
    roots.iter().map(|r| image[r.index()].unwrap_or(*r)).collect()
}

/// Which nodes are needed as such: roots, and children of anything but a sum, and terms of sums.
fn consumers(graph: &Graph, roots: &[Id], needed: &[bool]) -> Vec<bool> {
    let mut wanted = vec![false; needed.len()];
    for root in roots {
        wanted[root.index()] = true;
    }
    for i in (0..needed.len()).rev() {
        if !wanted[i] {
            continue;
        }
        let id = graph.id_at(i);
        if is_sum(graph, id) {
            for (term, _) in flatten(graph, id) {
                wanted[term.index()] = true;
            }
        } else {
            for child in graph.children(id) {
                wanted[child.index()] = true;
            }
        }
    }
    wanted
}

fn popularity(graph: &Graph, roots: &[Id]) -> Vec<u32> {
    let needed = graph.reachable(roots.iter().copied());
    let wanted = consumers(graph, roots, &needed);
    let mut count = vec![0; needed.len()];
    for i in (0..needed.len()).filter(|&i| wanted[i]) {
        let id = graph.id_at(i);
        if is_sum(graph, id) {
            for (term, _) in flatten(graph, id) {
                count[term.index()] += 1;
            }
        }
    }
    count
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

/// The terms of a sum and their coefficients, like terms collected, in the order of the arena.
fn flatten(graph: &Graph, root: Id) -> Vec<(Id, Number)> {
    let one = Number::ONE;
    let mut terms: Vec<(Id, Number)> = Vec::new();
    // Parents have larger places than children, so taking the largest first visits each node once.
    let mut open = std::collections::BTreeMap::from([(root, one)]);
    while let Some((id, factor)) = open.pop_last() {
        let parts = match graph.node(id) {
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
