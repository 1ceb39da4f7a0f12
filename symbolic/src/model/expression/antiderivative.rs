//! Antiderivatives in closed form: energies of springs from their tensions.

use super::facts::{Depends, Facts};
use super::substitute::bottom_up;
use super::waves::{by_parts, product_of_waves};
use crate::expr::{Binary, Graph, Id, Node, Number, Rational, Symbol, Unary};

/// Terms beyond which no closed form is looked for.
pub(super) const TERM_LIMIT: usize = 64;

/// A term c xᵖ; the exponent is a node that does not contain x.
pub(super) type Term = (Id, Id);

/// ∫ e dx for sums of powers c xᵖ (a logarithm for p = −1) and of `max(c, f)`, `min(c, f)`, `f*step(f)`, `abs(f)`,
/// `step(f)`, `exp(f)`, `sin(f)`, `cos(f)`, `sinh(f)`, `cosh(f)`, `tanh(f)`, roots and powers of f and 1/(c + f²) with f linear in x, of
/// products of sines and cosines of such f, and of a polynomial with one of them or `exp(f)`; `None` for other laws.
///
/// For an exponent that is no number p + 1 is divided by, so that p = −1 has no finite value.
pub fn antiderivative(graph: &mut Graph, facts: &mut Facts, root: Id, x: Symbol) -> Option<Id> {
    let mut sum = Id::ZERO;
    let mut stack = vec![(Id::ONE, root)];
    let mut visited = 0;
    while let Some((factor, node)) = stack.pop() {
        visited += 1;
        if visited > TERM_LIMIT {
            return None;
        }
        let mut free = |id: Id| !facts.of(graph, id).meets(Depends::DUMMY);
        let integral = match graph.node(node) {
            Node::Binary(Binary::Add, a, b) => {
                stack.extend([(factor, a), (factor, b)]);
                continue;
            }
            Node::Binary(Binary::Sub, a, b) => {
                stack.extend([(factor, a), (graph.neg(factor), b)]);
                continue;
            }
            Node::Unary(Unary::Neg, a) => {
                stack.push((graph.neg(factor), a));
                continue;
            }
            Node::Binary(Binary::Mul, a, b) if free(a) => {
                stack.push((graph.mul(factor, a), b));
                continue;
            }
            Node::Binary(Binary::Mul, a, b) if free(b) => {
                stack.push((graph.mul(factor, b), a));
                continue;
            }
            Node::Binary(Binary::Div, a, b) if free(b) => {
                stack.push((graph.div(factor, b), a));
                continue;
            }
            _ => match powers(graph, facts, node, x) {
                Some(terms) => integrated(graph, terms, x),
                None => match product_of_waves(graph, node) {
                    Some(terms) => {
                        stack.extend(terms.into_iter().map(|(c, part)| (graph.mul(factor, c), part)));
                        continue;
                    }
                    None => match by_parts(graph, facts, node, x) {
                        Some(integral) => integral,
                        None => of_linear(graph, facts, node, x)?,
                    },
                },
            },
        };
        let term = graph.mul(factor, integral);
        sum = graph.add(sum, term);
    }
    Some(sum)
}

/// Σ c xᵖ⁺¹/(p + 1).
fn integrated(graph: &mut Graph, terms: Vec<Term>, x: Symbol) -> Id {
    let variable = graph.symbol(x);
    let mut sum = Id::ZERO;
    for (coefficient, exponent) in terms {
        let next = graph.add(exponent, Id::ONE);
        let integral = if next == Id::ZERO {
            graph.unary(Unary::Ln, variable)
        } else {
            let power = graph.pow(variable, next);
            graph.div(power, next)
        };
        let term = graph.mul(coefficient, integral);
        sum = graph.add(sum, term);
    }
    sum
}

/// ∫ F(f) dx = (∫F)(f)/s for f = s x + c.
fn of_linear(graph: &mut Graph, facts: &mut Facts, node: Id, x: Symbol) -> Option<Id> {
    let half = graph.rational(Rational::new(1, 2)?);
    // ½ m² for the part m of a linear function beyond a bound.
    let half_square = |graph: &mut Graph, part: Id| {
        let square = graph.mul(part, part);
        graph.mul(half, square)
    };
    let (argument, integral) = match graph.node(node) {
        Node::Binary(operation @ (Binary::Max | Binary::Min), a, b) => {
            // max(c, f) = c + max(0, f − c)
            let (bound, f) = if facts.of(graph, a).meets(Depends::DUMMY) { (b, a) } else { (a, b) };
            if facts.of(graph, bound).meets(Depends::DUMMY) {
                return None;
            }
            let slope = slope(graph, facts, f, x)?;
            let beyond = graph.sub(f, bound);
            let part = graph.binary(operation, Id::ZERO, beyond);
            let area = half_square(graph, part);
            let triangle = graph.div(area, slope);
            let variable = graph.symbol(x);
            let rest = graph.mul(bound, variable);
            return Some(graph.add(rest, triangle));
        }
        Node::Binary(Binary::Mul, a, b) => {
            let f = match (graph.node(a), graph.node(b)) {
                (Node::Unary(Unary::Step, f), _) if f == b => f,
                (_, Node::Unary(Unary::Step, f)) if f == a => f,
                _ => return None,
            };
            let part = graph.binary(Binary::Max, Id::ZERO, f);
            (f, half_square(graph, part))
        }
        Node::Binary(Binary::Pow, f, exponent) if !facts.of(graph, exponent).meets(Depends::DUMMY) => {
            let next = graph.add(exponent, Id::ONE);
            let power = graph.pow(f, next);
            (f, graph.div(power, next))
        }
        Node::Binary(Binary::Div, a, b) if !facts.of(graph, a).meets(Depends::DUMMY) => {
            let Node::Unary(Unary::Sqrt, f) = graph.node(b) else {
                let peak = of_peak(graph, facts, b, x)?;
                return Some(graph.mul(a, peak));
            };
            let twice = graph.add(b, b);
            (f, graph.mul(a, twice))
        }
        Node::Unary(function, f) => {
            let integral = match function {
                Unary::Sqrt => {
                    let product = graph.mul(f, node);
                    let two_thirds = graph.rational(Rational::new(2, 3)?);
                    graph.mul(two_thirds, product)
                }
                Unary::Abs => {
                    let product = graph.mul(f, node);
                    graph.mul(half, product)
                }
                Unary::Step => graph.binary(Binary::Max, Id::ZERO, f),
                Unary::Exp => node,
                Unary::Sin => {
                    let cosine = graph.unary(Unary::Cos, f);
                    graph.neg(cosine)
                }
                Unary::Cos => graph.unary(Unary::Sin, f),
                Unary::Sinh => graph.unary(Unary::Cosh, f),
                Unary::Cosh => graph.unary(Unary::Sinh, f),
                Unary::Tanh => {
                    let cosh = graph.unary(Unary::Cosh, f);
                    graph.unary(Unary::Ln, cosh)
                }
                _ => return None,
            };
            (f, integral)
        }
        _ => return None,
    };
    let slope = slope(graph, facts, argument, x)?;
    Some(graph.div(integral, slope))
}

/// ∫ dx/(c + k u²) = atan(u √(k/c))/(√(c k) u') for u linear in x: a peak, however narrow, and where c or k is negative no number.
fn of_peak(graph: &mut Graph, facts: &mut Facts, divisor: Id, x: Symbol) -> Option<Id> {
    // The sum may have a factor that is free of x.
    let (mut outside, mut sum) = (Id::ONE, divisor);
    let (a, b) = loop {
        let mut free = |id: Id| !facts.of(graph, id).meets(Depends::DUMMY);
        (outside, sum) = match graph.node(sum) {
            Node::Binary(Binary::Add, a, b) => break (a, b),
            Node::Binary(Binary::Mul, p, q) if free(p) => (graph.mul(outside, p), q),
            Node::Binary(Binary::Mul, p, q) if free(q) => (graph.mul(outside, q), p),
            Node::Binary(Binary::Div, p, q) if free(q) => (graph.div(outside, q), p),
            _ => return None,
        };
    };
    let (c, square) = if facts.of(graph, a).meets(Depends::DUMMY) { (b, a) } else { (a, b) };
    if facts.of(graph, c).meets(Depends::DUMMY) {
        return None;
    }
    // The factors of the square: those free of x make k, two others are u.
    let (mut k, mut others, mut open) = (Id::ONE, Vec::new(), vec![square]);
    while let Some(factor) = open.pop() {
        if !facts.of(graph, factor).meets(Depends::DUMMY) {
            k = graph.mul(k, factor);
            continue;
        }
        match graph.node(factor) {
            Node::Binary(Binary::Mul, p, q) => open.extend([p, q]),
            Node::Binary(Binary::Div, p, q) if !facts.of(graph, q).meets(Depends::DUMMY) => {
                k = graph.div(k, q);
                open.push(p);
            }
            _ => others.push(factor),
        }
        if others.len() > 2 {
            return None;
        }
    }
    let [u, v] = others[..] else { return None };
    if u != v {
        return None;
    }
    let slope = slope(graph, facts, u, x)?;
    let (ratio, product) = (graph.div(k, c), graph.mul(k, c));
    let [scale, root] = [ratio, product].map(|squared| graph.unary(Unary::Sqrt, squared));
    let angle = graph.mul(u, scale);
    let angle = graph.unary(Unary::Atan, angle);
    let divisor = graph.mul(root, slope);
    let divisor = graph.mul(outside, divisor);
    Some(graph.div(angle, divisor))
}

/// s where f = s x + c with s ≠ 0.
pub(super) fn slope(graph: &mut Graph, facts: &mut Facts, f: Id, x: Symbol) -> Option<Id> {
    let terms = powers(graph, facts, f, x)?;
    let linear = terms.iter().all(|(_, exponent)| matches!(*exponent, Id::ZERO | Id::ONE));
    let found = terms.iter().find(|(_, exponent)| *exponent == Id::ONE).map(|(slope, _)| *slope);
    found.filter(|slope| linear && *slope != Id::ZERO)
}

/// The expression as a sum of powers.
pub(super) fn powers(graph: &mut Graph, facts: &mut Facts, root: Id, x: Symbol) -> Option<Vec<Term>> {
    let leaf = |id: Id| vec![(id, Id::ZERO)];
    let found = bottom_up(graph, facts, root, leaf, |graph, facts, top, known| {
        let terms = match graph.node(top) {
            Node::Symbol(s) if s == x => vec![(Id::ONE, Id::ONE)],
            Node::Unary(Unary::Neg, a) => scaled(graph, &known[&a], Id::ONE, true),
            Node::Unary(Unary::Sqrt, a) => {
                let half = graph.rational(Rational::new(1, 2)?);
                let [(coefficient, exponent)] = known[&a][..] else { return None };
                vec![(graph.unary(Unary::Sqrt, coefficient), graph.mul(half, exponent))]
            }
            Node::Binary(Binary::Add, a, b) => merged(graph, known[&a].clone(), &known[&b]),
            Node::Binary(Binary::Sub, a, b) => {
                let minus = scaled(graph, &known[&b], Id::ONE, true);
                merged(graph, known[&a].clone(), &minus)
            }
            Node::Binary(Binary::Mul, a, b) => {
                let (a, b) = (known[&a].clone(), known[&b].clone());
                let mut product = Vec::new();
                for (coefficient, exponent) in a {
                    let mut part = Vec::new();
                    for (c, p) in &b {
                        part.push((graph.mul(coefficient, *c), graph.add(exponent, *p)));
                    }
                    product = merged(graph, product, &part);
                    if product.len() > TERM_LIMIT {
                        return None;
                    }
                }
                product
            }
            Node::Binary(Binary::Div, a, b) => {
                let [(coefficient, exponent)] = known[&b][..] else { return None };
                let terms = known[&a].clone();
                terms.into_iter().map(|(c, p)| (graph.div(c, coefficient), graph.sub(p, exponent))).collect()
            }
            Node::Binary(Binary::Pow, a, b) if !facts.of(graph, b).meets(Depends::DUMMY) => {
                let [(coefficient, exponent)] = known[&a][..] else { return None };
                vec![(graph.pow(coefficient, b), graph.mul(exponent, b))]
            }
            _ => return None,
        };
        (terms.len() <= TERM_LIMIT).then_some(terms)
    });
    found.map(|(terms, _)| terms)
}

fn scaled(graph: &mut Graph, terms: &[Term], by: Id, negative: bool) -> Vec<Term> {
    let scale = |(c, p): &Term| {
        let product = graph.mul(*c, by);
        (if negative { graph.neg(product) } else { product }, *p)
    };
    terms.iter().map(scale).collect()
}

/// The sum of two sums, like powers joined.
fn merged(graph: &mut Graph, mut terms: Vec<Term>, more: &[Term]) -> Vec<Term> {
    for (coefficient, exponent) in more {
        let same = |p: Id| p == *exponent || equal_numbers(graph, p, *exponent);
        match terms.iter().position(|(_, p)| same(*p)) {
            Some(place) => terms[place].0 = graph.add(terms[place].0, *coefficient),
            None => terms.push((*coefficient, *exponent)),
        }
    }
    terms.retain(|(coefficient, _)| *coefficient != Id::ZERO);
    terms
}

fn equal_numbers(graph: &Graph, a: Id, b: Id) -> bool {
    match (graph.number(a), graph.number(b)) {
        (Some(Number::Exact(a)), Some(Number::Exact(b))) => a == b,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Tape, partial};

    #[test]
    fn derivatives_of_antiderivatives_are_the_laws() {
        let mut g = Graph::new();
        let symbol = Symbol::Dummy(0);
        let (x, k) = (g.symbol(symbol), g.symbol(Symbol::Parameter(0)));
        let two = g.integer(2);
        let cube = g.powi(x, 3);
        let linear = g.sub(x, two);
        let hooke = g.mul(k, linear);
        let inverse = g.div(k, x);
        let newton = g.powi(x, -2);
        let root = g.unary(Unary::Sqrt, x);
        let general = g.pow(x, k);
        let line = g.mul(k, linear);
        let positive = g.sub(x, Id::ONE);
        let mut laws = vec![cube, hooke, inverse, newton, root, general];
        for f in [line, positive] {
            laws.extend([Binary::Max, Binary::Min].map(|bound| g.binary(bound, k, f)));
            let step = g.unary(Unary::Step, f);
            laws.push(g.mul(f, step));
            let functions = [Unary::Abs, Unary::Step, Unary::Exp, Unary::Sin, Unary::Cos, Unary::Sinh, Unary::Cosh];
            laws.extend(functions.map(|function| g.unary(function, f)));
            let tanh = g.unary(Unary::Tanh, f);
            let scaled = g.mul(k, tanh);
            laws.push(g.sub(scaled, cube));
            let square = g.mul(f, f);
            let [half, twice] = [g.div(square, k), g.mul(two, square)];
            let sum = g.add(twice, k);
            for divisor in [g.add(k, square), g.add(Id::ONE, half), sum, g.mul(sum, k)] {
                laws.push(g.div(k, divisor));
            }
        }
        let (sine, cosine, exponential) =
            (g.unary(Unary::Sin, line), g.unary(Unary::Cos, linear), g.unary(Unary::Exp, line));
        let (square, waves) = (g.mul(sine, sine), g.mul(sine, cosine));
        let (root, general) = (g.unary(Unary::Sqrt, positive), g.pow(positive, k));
        let inverse = g.div(k, root);
        let parts = [sine, cosine, exponential, waves].map(|wave| g.mul(cube, wave));
        laws.extend([square, waves, root, general, inverse]);
        laws.extend(parts);
        for law in laws {
            let mut facts = Facts::default();
            let energy = antiderivative(&mut g, &mut facts, law, symbol).unwrap();
            let slope = partial(&mut g, energy, symbol);
            let tape = Tape::new(&g, &[law, slope]);
            let values = tape.evaluate(|s| if s == symbol { 1.7 } else { 0.6 });
            assert!((values[0] - values[1]).abs() < 1e-12, "{values:?}");
        }
        let tangent = g.unary(Unary::Tan, x);
        assert_eq!(antiderivative(&mut g, &mut Facts::default(), tangent, symbol), None);
    }
}
