//! Sums in one order, so that equal prefixes are shared however the user wrote them.
//!
//! Nested sums, differences and constant multiples are flattened into Σ cₖ termₖ, like terms are
//! collected, and the sum is rebuilt as a chain of binary sums with the terms in order of falling
//! *popularity* (the number of sums a term occurs in).  In a chain of links the terms of inner links occur
//! in most positions, so the recursion tip[i] = tip[i−1] + … comes back by itself from closed-form sums.

use rustc_hash::FxHashMap as HashMap;

use super::places::Places;
use super::{Binary, Graph, Id, Node, Unary};
use crate::number::Number;

/// Rebuilds all roots together.
pub fn canonical(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    // The first pass makes equal terms equal, so that the second can count them.
    let roots = pass(graph, roots, |_, _| {});
    let popularity = popularity(graph, &roots);
    let by_popularity = |_: &Graph, terms: &mut Vec<(Id, Number)>| {
        terms.sort_by_key(|(term, _)| {
            let count = popularity.get(term).copied().unwrap_or(0);
            (std::cmp::Reverse(count), *term)
        });
    };
    pass(graph, &roots, by_popularity)
}

/// One rebuilding; `order` arranges the terms of a sum, given by their places before this pass.
fn pass(graph: &mut Graph, roots: &[Id], order: impl Fn(&Graph, &mut Vec<(Id, Number)>)) -> Vec<Id> {
    let sums = Sums::of(graph, roots);
    let mut image: Vec<Option<Id>> = vec![None; sums.needed.list().len()];
    for (i, &id) in sums.needed.list().iter().enumerate() {
        if !sums.wanted[i] {
            continue;
        }
        let of = |image: &[Option<Id>], x: Id| image[sums.needed.of(x)].unwrap_or(x);
        let new = match graph.node(id) {
            _ if is_sum(graph, id) => {
                let mut terms = sums.terms(graph, i);
                order(graph, &mut terms);
                let mut sum = Id::ZERO;
                for (term, coefficient) in terms {
                    let factor = graph.constant(coefficient);
                    let image = if term == Id::ONE { term } else { of(&image, term) };
                    let product = graph.mul(factor, image);
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
    roots.iter().map(|r| image[sums.needed.of(*r)].unwrap_or(*r)).collect()
}

/// In how many sums each term stands.
fn popularity(graph: &Graph, roots: &[Id]) -> HashMap<Id, u32> {
    let sums = Sums::of(graph, roots);
    let mut count = HashMap::default();
    for (i, &id) in sums.needed.list().iter().enumerate() {
        if sums.wanted[i] && is_sum(graph, id) {
            for (term, _) in sums.terms(graph, i) {
                *count.entry(term).or_default() += 1;
            }
        }
    }
    count
}

/// Terms of all sums together beyond which a sum is not taken apart further than to sums that are needed as such:
/// running sums of n terms have n²/2.
const FLATTENED: usize = 300_000;

/// What is needed as such, and how far sums are taken apart.
struct Sums {
    needed: Places,
    /// Roots, and children of anything but a sum, and terms of sums.
    wanted: Vec<bool>,
    /// Sums that are taken apart as far as to others that are wanted.
    shallow: Vec<bool>,
}

impl Sums {
    fn of(graph: &Graph, roots: &[Id]) -> Sums {
        let needed = Places::new(graph.needed(roots.iter().copied()));
        let count = needed.list().len();
        let mut sums = Sums { needed, wanted: vec![false; count], shallow: vec![false; count] };
        for root in roots {
            let place = sums.needed.of(*root);
            sums.wanted[place] = true;
        }
        let mut terms = 0;
        for i in (0..count).rev() {
            if !sums.wanted[i] {
                continue;
            }
            let id = sums.needed.list()[i];
            let parts: Vec<Id> = if is_sum(graph, id) {
                sums.shallow[i] = terms > FLATTENED;
                sums.terms(graph, i).into_iter().map(|(term, _)| term).collect()
            } else {
                graph.children(id).collect()
            };
            terms += parts.len();
            for part in parts {
                // A constant summand counts as a multiple of 1, which may stand nowhere else.
                if let Some(place) = sums.needed.find(part) {
                    sums.wanted[place] = true;
                }
            }
        }
        sums
    }

    /// The terms of the sum at a place.
    fn terms(&self, graph: &Graph, i: usize) -> Vec<(Id, Number)> {
        let whole = |id: Id| self.shallow[i] && self.needed.find(id).is_some_and(|place| self.wanted[place]);
        flatten(graph, self.needed.list()[i], whole)
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
fn flatten(graph: &Graph, root: Id, whole: impl Fn(Id) -> bool) -> Vec<(Id, Number)> {
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
