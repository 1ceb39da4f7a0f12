//! Antiderivatives of sines, cosines and exponentials in products.

use super::antiderivative::{TERM_LIMIT, powers, slope};
use super::facts::Facts;
use crate::expr::{Binary, Graph, Id, Node, Number, Rational, Symbol, Unary, partial};

/// The factors of a product.
fn factors(graph: &Graph, root: Id) -> Vec<Id> {
    let mut open = vec![root];
    let mut found = Vec::new();
    while let Some(id) = open.pop() {
        match graph.node(id) {
            Node::Binary(Binary::Mul, a, b) if found.len() + open.len() < TERM_LIMIT => open.extend([a, b]),
            _ => found.push(id),
        }
    }
    found
}

fn product(graph: &mut Graph, factors: &[Id]) -> Id {
    factors.iter().fold(Id::ONE, |product, factor| graph.mul(product, *factor))
}

/// The first two sines or cosines of a product as waves of the sum and the difference of their phases:
/// 2 sin f sin g = cos(f − g) − cos(f + g) and its like.
pub fn product_of_waves(graph: &mut Graph, root: Id) -> Option<[(Id, Id); 2]> {
    let wave = |graph: &Graph, id: Id| match graph.node(id) {
        Node::Unary(function @ (Unary::Sin | Unary::Cos), f) => Some((function, f)),
        _ => None,
    };
    let mut rest = factors(graph, root);
    let mut take = |graph: &Graph| {
        let place = rest.iter().position(|id| wave(graph, *id).is_some())?;
        wave(graph, rest.remove(place))
    };
    let (first, second) = (take(graph)?, take(graph)?);
    let ((sine, f), (other, g)) = if first.0 == Unary::Sin { (first, second) } else { (second, first) };
    let (sum, difference) = (graph.add(f, g), graph.sub(f, g));
    let outer = if sine == other { Unary::Cos } else { Unary::Sin };
    let waves = [graph.unary(outer, difference), graph.unary(outer, sum)];
    let half = graph.rational(Rational::HALF);
    let minus = if (sine, other) == (Unary::Sin, Unary::Sin) { graph.neg(half) } else { half };
    let rest = product(graph, &rest);
    Some([(half, graph.mul(waves[0], rest)), (minus, graph.mul(waves[1], rest))])
}

/// ∫ p(x) w(f) dx for a polynomial p and a sine, cosine or exponential w of a linear f = s x + c, by parts:
/// p W/s − p' WW/s² + … with W, WW, … the integrals of w in its argument.
pub fn by_parts(graph: &mut Graph, facts: &mut Facts, root: Id, x: Symbol) -> Option<Id> {
    let mut rest = factors(graph, root);
    let known = |id: &Id| matches!(graph.node(*id), Node::Unary(Unary::Sin | Unary::Cos | Unary::Exp, _));
    let place = rest.iter().position(known)?;
    let Node::Unary(mut function, f) = graph.node(rest.remove(place)) else { return None };
    let rest = product(graph, &rest);
    if rest == Id::ONE {
        return None;
    }
    let slope = slope(graph, facts, f, x)?;
    let terms = powers(graph, facts, rest, x)?;
    let whole = |exponent: Id| match graph.number(exponent) {
        Some(Number::Exact(n)) => n.to_integer().is_some_and(|n| (0..=64).contains(&n)),
        _ => false,
    };
    if !terms.iter().all(|(_, exponent)| whole(*exponent)) {
        return None;
    }
    let (mut polynomial, mut sum, mut negative) = (rest, Id::ZERO, false);
    while polynomial != Id::ZERO {
        (function, negative) = match function {
            Unary::Sin => (Unary::Cos, !negative),
            Unary::Cos => (Unary::Sin, negative),
            _ => (function, negative),
        };
        polynomial = graph.div(polynomial, slope);
        let wave = graph.unary(function, f);
        let term = graph.mul(polynomial, wave);
        sum = if negative { graph.sub(sum, term) } else { graph.add(sum, term) };
        let derivative = partial(graph, polynomial, x);
        polynomial = graph.neg(derivative);
    }
    Some(sum)
}
