//! Quotients of functions that overflow long before the quotients do.

use std::collections::BTreeMap;

use super::products::{Factor, factors, product};
use super::{Binary, Graph, Id, Node, Symbol, Unary, rewrite};

/// Writes e^u/(a + c e^u) as 1/(c + a e^(−u)), and sinh u/cosh u as tanh u: derivatives of ln(1 + e^u), of 1/(1 + e^u) and of 1/cosh u are ∞/∞ beyond
/// u = 710 as they are derived.  a and c are free of the state.
pub fn without_overflow(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let overflows = |id: &Id| matches!(graph.node(*id), Node::Unary(Unary::Exp | Unary::Sinh, _));
    if !graph.needed(roots.iter().copied()).iter().any(overflows) {
        return roots.to_vec();
    }
    rewrite(graph, roots, |graph, node| {
        let (x, y, sign) = match node {
            Node::Binary(Binary::Mul, x, y) => (x, y, 1),
            Node::Binary(Binary::Div, x, y) => (x, y, -1),
            _ => return None,
        };
        let mut all: BTreeMap<Id, i32> = factors(graph, x).into_iter().collect();
        for (base, halves) in factors(graph, y) {
            *all.entry(base).or_default() += sign * halves;
        }
        let mut found = false;
        let above: Vec<(Id, i32)> = all.iter().map(|(base, halves)| (*base, *halves)).filter(|(_, n)| *n > 0).collect();
        for (base, mut left) in above {
            let below: Vec<Id> = all.iter().filter(|(_, halves)| **halves < 0).map(|(base, _)| *base).collect();
            for denominator in below {
                let Some((quotient, power)) = bounded(graph, base, denominator).filter(|_| left > 0) else { continue };
                let taken = left.min(-all[&denominator]);
                left -= taken;
                for (base, halves) in [(base, -taken), (denominator, taken), (quotient, power * taken)] {
                    *all.entry(base).or_default() += halves;
                }
                found = true;
            }
        }
        let all: Vec<Factor> =
            all.into_iter().filter(|(_, n)| *n != 0).map(|(base, halves)| Factor { base, halves }).collect();
        found.then(|| product(graph, &all, &|x| x, |_| 0))
    })
}

/// Writes ln(a + c e^u) as m + ln(a e^(−m) + c e^(u − m)) with m = max(u, 0), which is no infinity beyond u = 710.  To be evaluated, and not derived any
/// further: its slopes have jumps that cancel.
pub fn logarithms_without_overflow(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    rewrite(graph, roots, |graph, node| {
        let Node::Unary(Unary::Ln, sum) = node else { return None };
        let Node::Binary(operation @ (Binary::Add | Binary::Sub), x, y) = graph.node(sum) else { return None };
        let (u, parts) = [(x, y), (y, x)].into_iter().find_map(|(term, constant)| {
            let exponential = exponential_of(graph, term)?;
            let c = coefficient(graph, term, exponential)?;
            let Node::Unary(Unary::Exp, u) = graph.node(exponential) else { return None };
            is_constant(graph, constant).then_some((u, (term == x, c, constant)))
        })?;
        let (first, c, constant) = parts;
        let most = graph.binary(Binary::Max, u, Id::ZERO);
        let opposite = graph.neg(most);
        let (least, rest) = (graph.unary(Unary::Exp, opposite), graph.sub(u, most));
        let rest = graph.unary(Unary::Exp, rest);
        let (constant, term) = (graph.mul(constant, least), graph.mul(c, rest));
        let sum = if first { graph.binary(operation, term, constant) } else { graph.binary(operation, constant, term) };
        let logarithm = graph.unary(Unary::Ln, sum);
        Some(graph.add(most, logarithm))
    })
}

/// e^u of c e^u.
fn exponential_of(graph: &Graph, term: Id) -> Option<Id> {
    let is_exponential = |id: &Id| matches!(graph.node(*id), Node::Unary(Unary::Exp, _));
    match graph.node(term) {
        Node::Binary(Binary::Mul, x, y) => [x, y].into_iter().find(is_exponential),
        _ => Some(term).filter(is_exponential),
    }
}

/// Whether this is a sum with an exponential, or a hyperbolic cosine, which is beyond all numbers where what it divides is none yet.
pub(super) fn may_overflow(graph: &Graph, id: Id) -> bool {
    match graph.node(id) {
        Node::Unary(Unary::Cosh, _) => true,
        Node::Binary(Binary::Add | Binary::Sub, x, y) => {
            [x, y].into_iter().any(|term| exponential_of(graph, term).is_some())
        }
        _ => false,
    }
}

/// What numerator/denominator is a power of, and which, where both may overflow.
fn bounded(graph: &mut Graph, numerator: Id, denominator: Id) -> Option<(Id, i32)> {
    match (graph.node(numerator), graph.node(denominator)) {
        (Node::Unary(Unary::Sinh, u), Node::Unary(Unary::Cosh, v)) if u == v => Some((graph.unary(Unary::Tanh, u), 1)),
        (Node::Unary(Unary::Exp, u), Node::Binary(sum @ (Binary::Add | Binary::Sub), x, y)) => {
            let of_first = coefficient(graph, x, numerator).filter(|_| is_constant(graph, y));
            let of_second = coefficient(graph, y, numerator).filter(|_| is_constant(graph, x));
            let opposite = graph.neg(u);
            let inverse = graph.unary(Unary::Exp, opposite);
            // (c e^u ± a)/e^u, or (a ± c e^u)/e^u
            let (one, other) = match (of_first, of_second) {
                (Some(c), _) => (c, graph.mul(y, inverse)),
                (None, Some(c)) => (graph.mul(x, inverse), c),
                _ => return None,
            };
            Some((graph.binary(sum, one, other), -1))
        }
        _ => None,
    }
}

/// c of c e^u, free of the state.
fn coefficient(graph: &Graph, term: Id, exponential: Id) -> Option<Id> {
    match graph.node(term) {
        _ if term == exponential => Some(Id::ONE),
        Node::Binary(Binary::Mul, c, e) | Node::Binary(Binary::Mul, e, c)
            if e == exponential && is_constant(graph, c) =>
        {
            Some(c)
        }
        _ => None,
    }
}

fn is_constant(graph: &Graph, id: Id) -> bool {
    graph.symbols([id]).iter().all(|symbol| matches!(symbol, Symbol::Parameter(_)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Tape, partial};

    /// Slopes up to the second order, beside their values where nothing overflows and their limits where all does.
    #[test]
    fn derivatives_of_what_saturates_are_numbers_everywhere() {
        type Form = fn(&mut Graph, Id) -> Id;
        type Values = fn(f64) -> [f64; 2];
        let soft_wall: Form = |g, u| {
            let e = g.unary(Unary::Exp, u);
            let sum = g.add(Id::ONE, e);
            g.unary(Unary::Ln, sum)
        };
        let well: Form = |g, u| {
            let e = g.unary(Unary::Exp, u);
            let (two, three) = (g.integer(2), g.integer(3));
            let scaled = g.mul(three, e);
            let sum = g.sub(two, scaled);
            g.div(Id::ONE, sum)
        };
        let pulse: Form = |g, u| {
            let cosh = g.unary(Unary::Cosh, u);
            let square = g.mul(cosh, cosh);
            g.div(Id::ONE, square)
        };
        let cases: [(Form, Values, [[f64; 2]; 2]); 3] = [
            (soft_wall, |u| [logistic(u), logistic(u) * logistic(-u)], [[0.0, 0.0], [1.0, 0.0]]),
            (
                well,
                |u| {
                    let e = u.exp();
                    let d = 2.0 - 3.0 * e;
                    [3.0 * e / d.powi(2), 3.0 * e / d.powi(2) + 18.0 * e * e / d.powi(3)]
                },
                [[0.0, 0.0], [0.0, 0.0]],
            ),
            (
                pulse,
                |u| {
                    let (t, s) = (u.tanh(), 1.0 / u.cosh().powi(2));
                    [-2.0 * t * s, 4.0 * t * t * s - 2.0 * s * s]
                },
                [[0.0, 0.0], [0.0, 0.0]],
            ),
        ];
        for (form, values, limits) in cases {
            let mut g = Graph::new();
            let x = g.symbol(Symbol::Coordinate(0));
            let f = form(&mut g, x);
            let slope = partial(&mut g, f, Symbol::Coordinate(0));
            let slope = without_overflow(&mut g, &[slope])[0];
            let second = partial(&mut g, slope, Symbol::Coordinate(0));
            let roots = without_overflow(&mut g, &[slope, second]);
            let at = |u: f64| -> Vec<f64> { Tape::new(&g, &roots).evaluate(|_| u) };
            for u in [-3.0, -0.2, 0.3, 2.0] {
                let (found, right) = (at(u), values(u));
                found
                    .iter()
                    .zip(right)
                    .for_each(|(a, b)| assert!((a - b).abs() < 1e-12 * (1.0 + b.abs()), "{u}: {a} {b}"));
            }
            assert_eq!(at(-2000.0), limits[0]);
            assert_eq!(at(2000.0), limits[1]);
        }
    }

    fn logistic(u: f64) -> f64 {
        1.0 / (1.0 + (-u).exp())
    }

    #[test]
    fn logarithms_of_sums_grow_like_their_exponents() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let e = g.unary(Unary::Exp, x);
        let (two, three) = (g.integer(2), g.integer(3));
        let scaled = g.mul(three, e);
        let sum = g.add(two, scaled);
        let root = g.unary(Unary::Ln, sum);
        let root = logarithms_without_overflow(&mut g, &[root]);
        let at = |u: f64| -> f64 { Tape::new(&g, &root).evaluate(|_| u)[0] };
        for u in [-1.0, 0.0, 0.5, 40.0] {
            assert!((at(u) - (2.0 + 3.0 * u.exp()).ln()).abs() < 1e-14 * (1.0 + u.abs()), "{u}");
        }
        assert_eq!(at(-2000.0), 2.0_f64.ln());
        assert_eq!(at(2000.0), 2000.0 + 3.0_f64.ln());
    }

    #[test]
    fn what_holds_no_such_quotient_stays() {
        let mut g = Graph::new();
        let (x, y) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let (e, f) = (g.unary(Unary::Exp, x), g.unary(Unary::Exp, y));
        let sum = g.add(e, f);
        let share = g.div(e, sum);
        let product = g.mul(e, x);
        assert_eq!(without_overflow(&mut g, &[share, product]), [share, product]);
    }
}
