//! Sums that stay lists of terms until somebody reads them.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use rustc_hash::FxHashMap as HashMap;

use super::depth::Depths;
use crate::expr::{Binary, Graph, Id, Node, Number, Unary, factors};

/// A sum of terms that are added up when it is read first: k s² + k c² is k then for a sine and a cosine of one angle, x − x is nothing, and what is known
/// earliest is added first.
#[derive(Clone, Debug, Default)]
pub(super) struct Sum(Vec<Id>);

impl Sum {
    /// Adds a term.
    pub fn push(&mut self, term: Id) {
        if term != Id::ZERO {
            self.0.push(term);
        }
    }

    /// Its value.
    pub fn read(&mut self, graph: &mut Graph, depths: &mut Depths) -> Id {
        if self.0.len() > 1 {
            let value = total(graph, depths, &self.0);
            self.0 = if value == Id::ZERO { Vec::new() } else { vec![value] };
        }
        self.0.first().copied().unwrap_or(Id::ZERO)
    }
}

fn total(graph: &mut Graph, depths: &mut Depths, terms: &[Id]) -> Id {
    let mut terms = collected(graph, terms);
    while let Some((first, second, merged)) = squares(graph, &terms) {
        // The later one first, so that the places hold.
        terms.swap_remove(first.max(second));
        let (_, number) = terms.swap_remove(first.min(second));
        let number = graph.constant(number);
        let together = graph.mul(number, merged);
        let mut all: Vec<Id> = vec![together];
        for (term, number) in terms {
            let number = graph.constant(number);
            all.push(graph.mul(number, term));
        }
        terms = collected(graph, &all);
    }
    // Terms with one number in front are added up before they are multiplied by it.
    let mut groups: BTreeMap<(u8, i128, i128), (Number, Vec<Id>)> = BTreeMap::new();
    for (term, number) in terms {
        let negative = number.to_f64() < 0.0;
        let size = if negative { number.negated() } else { number };
        let term = if negative { graph.neg(term) } else { term };
        groups.entry(size.bits()).or_insert((size, Vec::new())).1.push(term);
    }
    let mut totals = Vec::with_capacity(groups.len());
    for (number, group) in groups.into_values() {
        if number.bits() == Number::ONE.bits() {
            totals.extend(group);
            continue;
        }
        let sum = earliest_first(graph, depths, group);
        let number = graph.constant(number);
        totals.push(graph.mul(number, sum));
    }
    earliest_first(graph, depths, totals)
}

/// A sum in which the two terms that are known earliest are added again and again.
fn earliest_first(graph: &mut Graph, depths: &mut Depths, terms: Vec<Id>) -> Id {
    let mut heap: BinaryHeap<Reverse<(u32, Id)>> = BinaryHeap::new();
    for term in terms {
        heap.push(Reverse((depths.of(graph, term), term)));
    }
    while let Some(Reverse((_, first))) = heap.pop() {
        let Some(Reverse((_, second))) = heap.pop() else { return first };
        let sum = graph.add(first, second);
        if sum != Id::ZERO {
            heap.push(Reverse((depths.of(graph, sum), sum)));
        }
    }
    Id::ZERO
}

/// Like terms collected, in the order of the arena.
fn collected(graph: &Graph, terms: &[Id]) -> Vec<(Id, Number)> {
    let mut sum: HashMap<Id, Number> = HashMap::default();
    for term in terms {
        let (number, rest) = split(graph, *term);
        let known = sum.get(&rest).copied();
        sum.insert(rest, known.map_or(number, |known| known.plus(number)));
    }
    let mut list: Vec<(Id, Number)> = sum.into_iter().filter(|(_, number)| number.to_f64() != 0.0).collect();
    list.sort_unstable_by_key(|(term, _)| *term);
    list
}

/// The constant in front of a term, and what it multiplies.
fn split(graph: &Graph, mut term: Id) -> (Number, Id) {
    let mut number = Number::ONE;
    loop {
        match graph.node(term) {
            Node::Unary(Unary::Neg, x) => (number, term) = (number.negated(), x),
            Node::Binary(Binary::Mul, c, x) => match graph.number(c) {
                Some(c) => (number, term) = (number.times(c), x),
                None => return (number, term),
            },
            Node::Number(_) if term != Id::ONE => {
                return (number.times(graph.number(term).unwrap_or(Number::ONE)), Id::ONE);
            }
            _ => return (number, term),
        }
    }
}

/// The number of a term, the angle of a squared sine or cosine in it, and its other factors.
type Rest = ((u8, i128, i128), Id, Vec<(Id, i32)>);

/// Two terms k s² and k c² with what is left of both, k.
fn squares(graph: &mut Graph, terms: &[(Id, Number)]) -> Option<(usize, usize, Id)> {
    if terms.len() < 2 {
        return None;
    }
    // By the number, the angle and all other factors: the first term seen, whether it has the sine.
    let mut seen: HashMap<Rest, (usize, bool)> = HashMap::default();
    for (place, (term, number)) in terms.iter().enumerate() {
        if !matches!(graph.node(*term), Node::Binary(Binary::Mul, ..)) {
            continue;
        }
        let list = factors(graph, *term);
        for (k, (base, halves)) in list.iter().enumerate() {
            let Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) = graph.node(*base) else { continue };
            if *halves < SQUARE {
                continue;
            }
            let mut rest = list.clone();
            rest[k].1 -= SQUARE;
            rest.retain(|factor| factor.1 != 0);
            let sine = function == Unary::Sin;
            let base = *base;
            match seen.insert((number.bits(), angle, rest), (place, sine)) {
                Some((other, of_sine)) if of_sine != sine && other != place => {
                    let once = without(graph, *term, base)?;
                    return Some((other, place, without(graph, once, base)?));
                }
                _ => {}
            }
        }
    }
    None
}

/// Twice the exponent of a square.
const SQUARE: i32 = 4;

/// A product without one of its factors, the others as they stand.
fn without(graph: &mut Graph, product: Id, factor: Id) -> Option<Id> {
    if product == factor {
        return Some(Id::ONE);
    }
    match graph.node(product) {
        Node::Unary(Unary::Neg, x) => {
            let rest = without(graph, x, factor)?;
            Some(graph.neg(rest))
        }
        Node::Binary(Binary::Mul, x, y) => {
            if let Some(rest) = without(graph, x, factor) {
                return Some(graph.mul(rest, y));
            }
            let rest = without(graph, y, factor)?;
            Some(graph.mul(x, rest))
        }
        Node::Binary(Binary::Div, x, y) => {
            let rest = without(graph, x, factor)?;
            Some(graph.div(rest, y))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn squares_of_a_sine_and_its_cosine_are_one() {
        let mut g = Graph::new();
        let (angle, k, x) =
            (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Parameter(0)), g.symbol(Symbol::Coordinate(1)));
        let (s, c) = (g.unary(Unary::Sin, angle), g.unary(Unary::Cos, angle));
        let kx = g.mul(k, x);
        let mut sum = Sum::default();
        for f in [s, c] {
            let inner = g.mul(f, kx);
            sum.push(g.mul(f, inner));
        }
        sum.push(kx);
        let mut depths = Depths::default();
        let two = g.integer(2);
        let twice = g.mul(two, kx);
        assert_eq!(sum.read(&mut g, &mut depths), twice);
        // Of other factors they are not.
        let mut sum = Sum::default();
        let (ss, cc) = (g.mul(s, s), g.mul(c, c));
        sum.push(g.mul(ss, k));
        sum.push(g.mul(cc, x));
        let value = sum.read(&mut g, &mut depths);
        assert!(matches!(g.node(value), Node::Binary(Binary::Add, ..)));
    }

    #[test]
    fn a_term_and_its_opposite_are_nothing() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let mut sum = Sum::default();
        sum.push(x);
        sum.push(g.neg(x));
        assert_eq!(sum.read(&mut g, &mut Depths::default()), Id::ZERO);
    }
}
