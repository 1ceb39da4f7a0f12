//! Products in one form: one number in front, equal factors gathered as powers, one division.
//!
//! Nested products, quotients and roots are flattened into c · Π factorₖ^(nₖ/2), and rebuilt with the factors that occur in
//! most products first, so that what several of them have in common is computed once: the x and the y of a force
//! between two stars share G m²/(s √s).  Factors of parameters stand in front of all, where they become one constant.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use super::chains::{Chain, Chains};
use super::overflow::may_overflow;
use super::{Binary, Graph, Id, Node, Symbol, Unary};
use crate::number::Number;

/// Rebuilds all roots together; `constant` is true of symbols that do not change.
pub fn canonical_products(graph: &mut Graph, roots: &[Id], constant: impl Fn(Symbol) -> bool) -> Vec<Id> {
    // The first pass makes equal factors equal, so that the second can count them.
    let roots = Chains::of::<Product>(graph, roots)
        .rebuild::<Product>(graph, roots, |graph, factors, image| product(graph, &factors, image, |_| 0));
    let varies = graph.contains(|s| !constant(s));
    let chains = Chains::of::<Product>(graph, &roots);
    let popularity = chains.popularity::<Product, _>(graph, |factor| *factor);
    chains.rebuild::<Product>(graph, &roots, |graph, factors, image| {
        product(
            graph,
            &factors,
            image,
            |factor| {
                if varies[factor.base.index()] { popularity[factor] } else { u32::MAX }
            },
        )
    })
}

/// The factors of a product with twice their exponents, equal ones gathered; of anything else itself.
pub fn factors(graph: &Graph, id: Id) -> Vec<(Id, i32)> {
    Product::parts(graph, id, &|_| false).into_iter().map(|factor| (factor.base, factor.halves)).collect()
}

/// Factors in groups of falling popularity; each group is multiplied to what there is, its denominators divided by.
pub(super) fn product(
    graph: &mut Graph,
    factors: &[Factor],
    image: &dyn Fn(Id) -> Id,
    popularity: impl Fn(&Factor) -> u32,
) -> Id {
    let mut number = Number::ONE;
    let mut groups: BTreeMap<Reverse<u32>, Vec<Factor>> = BTreeMap::new();
    for factor in factors {
        match graph.number(factor.base) {
            Some(value) if is_computed(value, factor.halves) => number = number.times(power(value, factor.halves / 2)),
            _ => groups.entry(Reverse(popularity(factor))).or_default().push(*factor),
        }
    }
    let mut whole = Id::ONE;
    for group in groups.into_values() {
        let (mut above, mut below) = (Id::ONE, Id::ONE);
        // Such are divided by one after the other: 0 comes before what is beyond all numbers, and slopes of each are by themselves.
        let mut alone = Vec::new();
        for Factor { base, halves } in group {
            let is_extreme = is_guarded(graph, base) || may_overflow(graph, base);
            let base = image(base);
            let mut power = graph.powi(base, halves.abs() / 2);
            if halves % 2 != 0 {
                let root = graph.unary(Unary::Sqrt, base);
                power = graph.mul(power, root);
            }
            if is_extreme && halves < 0 {
                alone.push(graph.div(Id::ONE, power));
                continue;
            }
            let side = if halves > 0 { &mut above } else { &mut below };
            *side = graph.mul(*side, power);
        }
        whole = graph.mul(whole, above);
        whole = graph.div(whole, below);
        whole = alone.into_iter().fold(whole, |whole, reciprocal| graph.mul(whole, reciprocal));
    }
    let number = graph.constant(number);
    graph.mul(number, whole)
}

fn is_computed(value: Number, halves: i32) -> bool {
    halves % 2 == 0 && halves.abs() <= UNROLLED && (halves > 0 || value.to_f64() != 0.0)
}

fn power(value: Number, n: i32) -> Number {
    let power = (0..n.abs()).fold(Number::ONE, |power, _| power.times(value));
    if n < 0 { power.recip() } else { power }
}

/// Whether this is a sum, or the root of one, that a constant of next to nothing keeps from 0: powers of it beyond itself
/// are none of the numbers that there are.
fn is_guarded(graph: &Graph, id: Id) -> bool {
    const NEXT_TO_NOTHING: f64 = 1e-150;
    let tiny = |x: Id| graph.number(x).is_some_and(|c| c.to_f64() != 0.0 && c.abs().to_f64() < NEXT_TO_NOTHING);
    match graph.node(id) {
        Node::Binary(Binary::Add, x, y) => tiny(x) || tiny(y),
        Node::Unary(Unary::Sqrt, x) => is_guarded(graph, x),
        _ => false,
    }
}

/// A base with twice its exponent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Factor {
    pub base: Id,
    pub halves: i32,
}

/// Products, quotients, and their opposites.
struct Product;

/// Twice the exponent up to which powers of numbers are computed.
const UNROLLED: i32 = 128;
/// Twice the exponent beyond which powers are not taken apart: from a million nodes exponents add up to no more than there
/// are numbers.
const HIGHEST: i32 = 1 << 10;

impl Chain for Product {
    type Part = Factor;

    fn is(graph: &Graph, id: Id) -> bool {
        match graph.node(id) {
            Node::Binary(Binary::Mul | Binary::Div, ..) => true,
            Node::Unary(Unary::Neg, x) => matches!(graph.node(x), Node::Binary(Binary::Mul | Binary::Div, ..)),
            _ => false,
        }
    }

    /// An opposite has −1 among its factors.
    fn parts(graph: &Graph, root: Id, whole: &dyn Fn(Id) -> bool) -> Vec<Factor> {
        let mut negative = false;
        let mut found: BTreeMap<Id, i32> = BTreeMap::new();
        // Parents have larger places than children, so taking the largest first visits each node once.
        let mut open = BTreeMap::from([(root, 2_i32)]);
        while let Some((id, halves)) = open.pop_last() {
            let stays = (id != root && whole(id)) || halves % 2 != 0 || halves.abs() > HIGHEST;
            let parts = match graph.node(id) {
                _ if stays => vec![],
                Node::Unary(Unary::Neg, x) => {
                    negative ^= halves % 4 != 0;
                    vec![(x, halves)]
                }
                Node::Binary(Binary::Mul, x, y) => vec![(x, halves), (y, halves)],
                Node::Binary(Binary::Div, x, y) => vec![(x, halves), (y, -halves)],
                _ => vec![],
            };
            if parts.is_empty() {
                let (base, halves) = match graph.node(id) {
                    Node::Unary(Unary::Sqrt, x) if halves % 2 == 0 && !is_guarded(graph, x) => (x, halves / 2),
                    _ => (id, halves),
                };
                *found.entry(base).or_default() += halves;
            }
            for (part, halves) in parts {
                *open.entry(part).or_default() += halves;
            }
        }
        let mut factors: Vec<Factor> =
            found.into_iter().filter(|(_, n)| *n != 0).map(|(base, halves)| Factor { base, halves }).collect();
        if negative {
            factors.push(Factor { base: Id::MINUS_ONE, halves: 2 });
        }
        factors
    }

    fn id(part: &Factor) -> Id {
        part.base
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Tape;

    fn all(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
        canonical_products(graph, roots, |s| matches!(s, Symbol::Parameter(_)))
    }

    #[test]
    fn equal_factors_are_gathered_and_one_number_stands_in_front() {
        let mut g = Graph::new();
        let (x, s) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let root = g.unary(Unary::Sqrt, s);
        // 2 (x/s) (1/2)/√s and x/(√s s)
        let (two, half) = (g.integer(2), g.rational(crate::expr::Rational::new(1, 2).unwrap()));
        let (first, second) = (g.div(x, s), g.div(half, root));
        let one = g.mul(first, second);
        let one = g.mul(two, one);
        let below = g.mul(root, s);
        let other = g.div(x, below);
        let images = all(&mut g, &[one, other]);
        assert_eq!(images[0], images[1]);
        // s/√s = √s
        let quotient = g.div(s, root);
        assert_eq!(all(&mut g, &[quotient]), [root]);
    }

    #[test]
    fn what_products_share_is_computed_once() {
        let mut g = Graph::new();
        let [m, x, y, s] = [Symbol::Parameter(0), Symbol::Coordinate(0), Symbol::Coordinate(1), Symbol::Coordinate(2)]
            .map(|symbol| g.symbol(symbol));
        let roots = [x, y].map(|place| {
            let above = g.mul(place, m);
            g.div(above, s)
        });
        let images = all(&mut g, &roots);
        let shared = g.div(m, s);
        for (image, place) in images.into_iter().zip([x, y]) {
            assert_eq!(image, g.mul(shared, place));
        }
    }

    #[test]
    fn what_is_barely_kept_from_zero_is_divided_by_as_it_stands() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let (guard, square) = (g.float(1e-300), g.mul(x, x));
        let sum = g.add(square, guard);
        let root = g.unary(Unary::Sqrt, sum);
        let (first, second) = (g.div(square, sum), g.div(Id::ONE, root));
        let whole = g.mul(first, second);
        let image = all(&mut g, &[whole])[0];
        let value: f64 = Tape::new(&g, &[image]).evaluate(|_| 0.0)[0];
        assert_eq!(value, 0.0);
    }

    #[test]
    fn powers_of_powers_and_zeros_below_keep_their_values() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let mut tower = x;
        for _ in 0..8 {
            tower = g.powi(tower, 64);
        }
        let below = g.div(x, tower);
        let zero = g.div(x, Id::ZERO);
        let negative = g.neg(below);
        let images = all(&mut g, &[tower, below, zero, negative]);
        let value = |x: f64| -> Vec<f64> { Tape::new(&g, &images).evaluate(|_| x) };
        assert_eq!(value(1.0)[..2], [1.0, 1.0]);
        assert!(!value(1.0)[2].is_finite());
        assert_eq!(value(1.0)[3], -1.0);
    }
}
