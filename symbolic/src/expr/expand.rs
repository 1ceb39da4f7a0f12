//! A candidate form: polynomials in the state with coefficients of parameters, factored again.
//!
//! Products of sums are multiplied out over *atoms* (symbols and functions of the state), like terms are
//! collected with coefficients that depend on parameters only, k s² + k c² becomes k, cos a cos b + sin a sin b
//! cos(a − b), and the result is factored greedily by its most frequent factor.  For small planar mechanisms this finds what a person
//! writes by hand; for recursive code it destroys shared prefixes.  The caller keeps the cheaper form.
//!
//! What cancels stays as it is: arguments of functions, denominators and bases that are not linear (of √((x − a)² + …) the
//! expanded square has lost its digits, and may be negative, where the distance is small), and differences of places and
//! times in products, which are atoms there, without what their terms share: (x − c)², (t − t₀)², m (L + R φ)².

use std::collections::BTreeMap;
use std::rc::Rc;

use rustc_hash::FxHashMap as HashMap;

use super::coefficient::{Coefficient, combined};
use super::sums::terms;
use super::{Binary, Graph, Id, Node, Symbol, Unary};

/// Atoms with their exponents, sorted by atom.
type Monomial = Vec<(Id, u32)>;
/// Monomials with their coefficients.
type Polynomial = BTreeMap<Monomial, Coefficient>;

/// Which products of sines and cosines become those of one angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Angles {
    /// Where the new angle has fewer terms: cos q₁ cos(q₁ + q₂) + sin q₁ sin(q₁ + q₂).
    Shorter,
    /// All: cos θ₁ cos θ₂ + sin θ₁ sin θ₂ too.
    All,
}

/// More terms than this in one expression: the form does not pay.
const TERM_LIMIT: usize = 120;
/// Exponents beyond this are not counted: powers of powers have any.
const HIGHEST: u32 = 1 << 20;
/// More terms than this in all polynomials together: stop looking.
const TOTAL_LIMIT: usize = 60_000;

/// What becomes of a sum of places and times that is multiplied by a single term.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sums {
    /// Each of its terms is: a spring's k (x − y) meets its neighbour's.
    MultipliedOut,
    /// It stays one factor: (L + R φ) (g sin φ + R φ'²).
    Whole,
}

/// The expressions in the form above, or `None` where it grows too large.  `constant` is true of symbols
/// that may stand in coefficients.
pub fn expand(graph: &mut Graph, roots: &[Id], constant: impl Fn(Symbol) -> bool, angles: Angles) -> Option<Vec<Id>> {
    let expansion = Expansion { known: HashMap::default(), angles, sums: Sums::MultipliedOut };
    expansion.of(graph, roots, constant)
}

/// The same but that sums of places and times stay factors wherever they are.
pub fn expand_around_sums(graph: &mut Graph, roots: &[Id], constant: impl Fn(Symbol) -> bool) -> Option<Vec<Id>> {
    let expansion = Expansion { known: HashMap::default(), angles: Angles::Shorter, sums: Sums::Whole };
    expansion.of(graph, roots, constant)
}

struct Expansion {
    known: HashMap<Id, Rc<Polynomial>>,
    angles: Angles,
    sums: Sums,
}

impl Expansion {
    fn of(mut self, graph: &mut Graph, roots: &[Id], constant: impl Fn(Symbol) -> bool) -> Option<Vec<Id>> {
        let varying = graph.contains(|s| !constant(s));
        let mut total = 0;
        for id in graph.needed(roots.iter().copied()) {
            let polynomial =
                if varying[id.index()] { self.polynomial(graph, id)? } else { only(self.coefficient(graph, id)) };
            total += polynomial.len();
            if polynomial.len() > TERM_LIMIT || total > TOTAL_LIMIT {
                return None;
            }
            self.known.insert(id, Rc::new(polynomial));
        }
        Some(roots.iter().map(|root| lowered(graph, &self.known[root])).collect())
    }

    /// A node that does not change; its operands are known.
    fn coefficient(&self, graph: &mut Graph, id: Id) -> Coefficient {
        let of = |x: Id| self.known[&x].get(&Vec::new()).cloned().unwrap_or_else(Coefficient::zero);
        let new = match graph.node(id) {
            Node::Unary(Unary::Neg, x) => return of(x).negated(),
            Node::Binary(operation, x, y) => {
                if let Some(known) = combined(graph, operation, &of(x), &of(y)) {
                    return known;
                }
                let (x, y) = (of(x).lowered(graph), of(y).lowered(graph));
                graph.binary(operation, x, y)
            }
            Node::Unary(function, x) => {
                let x = of(x).lowered(graph);
                graph.unary(function, x)
            }
            Node::Number(_) | Node::Symbol(_) => id,
        };
        Coefficient::atom(graph, new)
    }

    /// A node that changes; its operands are known.
    fn polynomial(&self, graph: &mut Graph, id: Id) -> Option<Polynomial> {
        Some(match graph.node(id) {
            Node::Number(_) | Node::Symbol(_) => atom(graph, id),
            Node::Unary(Unary::Neg, x) => {
                self.known[&x].iter().map(|(monomial, c)| (monomial.clone(), c.negated())).collect()
            }
            Node::Unary(f, x) => {
                let argument = self.argument(graph, x);
                let new = graph.unary(f, argument);
                atom(graph, new)
            }
            Node::Binary(operation @ (Binary::Add | Binary::Sub), x, y) => {
                let mut sum = (*self.known[&x]).clone();
                for (monomial, c) in self.known[&y].iter() {
                    let c = if operation == Binary::Sub { c.negated() } else { c.clone() };
                    accumulate(&mut sum, monomial.clone(), &c);
                }
                self.folded(graph, sum)
            }
            Node::Binary(Binary::Mul, x, y) => {
                let (p, q) = (self.known[&x].clone(), self.known[&y].clone());
                let both = p.len() > 1 && q.len() > 1;
                let stays = |p: &Polynomial| p.len() > 1 && (both || self.sums == Sums::Whole);
                let p = if stays(&p) { whole(graph, &p) } else { p };
                let q = if stays(&q) { whole(graph, &q) } else { q };
                if p.len() * q.len() > 4 * TERM_LIMIT {
                    return None;
                }
                self.product(graph, &p, &q)?
            }
            Node::Binary(Binary::Div, x, y) => {
                let reciprocal = match constant(&self.known[&y]) {
                    Some(c) => only(c.clone().recip(graph)),
                    None => {
                        let denominator = self.argument(graph, y);
                        let reciprocal = graph.div(Id::ONE, denominator);
                        atom(graph, reciprocal)
                    }
                };
                self.product(graph, &self.known[&x].clone(), &reciprocal)?
            }
            Node::Binary(operation, x, y) => {
                let (a, b) = (self.argument(graph, x), self.argument(graph, y));
                let new = graph.binary(operation, a, b);
                atom(graph, new)
            }
        })
    }

    /// What a function is taken of: as it is, but that linear expressions of symbols and products get their one form
    /// (of (sin a + sin b)² + (cos a + cos b)² the linear 2 + 2 cos(a − b) has lost the digits of what is small).
    fn argument(&self, graph: &mut Graph, x: Id) -> Id {
        let p = self.known[&x].clone();
        let symbol = |(atom, n): &(Id, u32)| *n == 1 && matches!(graph.node(*atom), Node::Symbol(_));
        let linear = p.keys().all(|monomial| monomial.len() <= 1 && monomial.iter().all(symbol));
        if linear || p.len() == 1 { lowered(graph, &p) } else { x }
    }

    /// `None` where exponents grow beyond what is counted.
    fn product(&self, graph: &mut Graph, p: &Polynomial, q: &Polynomial) -> Option<Polynomial> {
        let highest = |p: &Polynomial| p.keys().flatten().map(|(_, n)| *n).max().unwrap_or(0);
        if highest(p) + highest(q) > HIGHEST {
            return None;
        }
        let mut result = Polynomial::new();
        for (a, c) in p {
            for (b, d) in q {
                accumulate(&mut result, joined(a, b), &c.times(d, graph));
            }
        }
        Some(self.folded(graph, result))
    }

    fn folded(&self, graph: &mut Graph, p: Polynomial) -> Polynomial {
        let p = fold_pythagoras(graph, p);
        fold_angles(graph, p, self.angles)
    }
}

/// The polynomial that is one coefficient.
fn only(coefficient: Coefficient) -> Polynomial {
    let mut polynomial = Polynomial::new();
    accumulate(&mut polynomial, Vec::new(), &coefficient);
    polynomial
}

/// The coefficient that a polynomial is.
fn constant(p: &Polynomial) -> Option<&Coefficient> {
    p.get(&Vec::new()).filter(|_| p.len() == 1)
}

/// An expression as a variable; signs are pulled outwards: −sin(x) is −1 times one.
fn atom(graph: &Graph, id: Id) -> Polynomial {
    match graph.node(id) {
        Node::Unary(Unary::Neg, inner) => Polynomial::from([(vec![(inner, 1)], Coefficient::one().negated())]),
        Node::Number(_) => only(Coefficient::atom(graph, id)),
        _ => Polynomial::from([(vec![(id, 1)], Coefficient::one())]),
    }
}

/// A factor with several terms: if these are places and times, whose difference may vanish, what they share times an atom.
fn whole(graph: &mut Graph, p: &Rc<Polynomial>) -> Rc<Polynomial> {
    let place = |graph: &Graph, atom: Id| {
        matches!(graph.node(atom), Node::Symbol(Symbol::Coordinate(_) | Symbol::Time | Symbol::Input(_, 0)))
    };
    if !p.keys().all(|monomial| monomial.iter().all(|(atom, _)| place(graph, *atom))) {
        return p.clone();
    }
    let content = Coefficient::shared(p.values());
    let inverse = content.recip(graph);
    let rest = p.iter().map(|(monomial, c)| (monomial.clone(), c.times(&inverse, graph))).collect();
    let sum = lowered(graph, &rest);
    Rc::new(atom(graph, sum).into_iter().map(|(monomial, c)| (monomial, c.times(&content, graph))).collect())
}

fn joined(a: &Monomial, b: &Monomial) -> Monomial {
    let mut exponents: BTreeMap<Id, u32> = a.iter().copied().collect();
    for &(atom, n) in b {
        *exponents.entry(atom).or_insert(0) += n;
    }
    exponents.into_iter().collect()
}

fn accumulate(p: &mut Polynomial, monomial: Monomial, coefficient: &Coefficient) {
    let sum = p.get(&monomial).map_or_else(|| coefficient.clone(), |known| known.plus(coefficient));
    if sum.is_zero() {
        p.remove(&monomial);
    } else {
        p.insert(monomial, sum);
    }
}

/// a s² + b c² = a + (b − a) c² for s = sin x, c = cos x, wherever both are there.
fn fold_pythagoras(graph: &mut Graph, mut p: Polynomial) -> Polynomial {
    loop {
        let mut found = None;
        'search: for monomial in p.keys() {
            for &(atom, n) in monomial {
                let Node::Unary(Unary::Sin, x) = graph.node(atom) else { continue };
                if n < 2 {
                    continue;
                }
                let cosine = graph.unary(Unary::Cos, x);
                let rest = without_square(monomial, atom);
                let partner = joined(&rest, &vec![(cosine, 2)]);
                if p.contains_key(&partner) {
                    found = Some((monomial.clone(), partner, rest));
                    break 'search;
                }
            }
        }
        let Some((squared_sine, squared_cosine, rest)) = found else { return p };
        let (Some(a), Some(b)) = (p.remove(&squared_sine), p.remove(&squared_cosine)) else { return p };
        accumulate(&mut p, rest, &a);
        accumulate(&mut p, squared_cosine, &b.minus(&a));
    }
}

fn without_square(monomial: &Monomial, atom: Id) -> Monomial {
    divided(&divided(monomial, atom), atom)
}

/// A monomial with one atom less.
fn divided(monomial: &Monomial, atom: Id) -> Monomial {
    let reduced = |&(a, n): &(Id, u32)| if a == atom { (a, n - 1) } else { (a, n) };
    monomial.iter().map(reduced).filter(|&(_, n)| n > 0).collect()
}

/// cos a cos b ± sin a sin b = cos(a ∓ b) and sin a cos b ± cos a sin b = sin(a ± b), wherever both terms are there with
/// one coefficient.
fn fold_angles(graph: &mut Graph, mut p: Polynomial, angles: Angles) -> Polynomial {
    while let Some((one, other, monomial, c)) = angle_in(graph, &p, angles) {
        p.remove(&one);
        p.remove(&other);
        accumulate(&mut p, monomial, &c);
    }
    p
}

/// Angles are joined in products of so many factors at most: all pairs are tried.
const MOST_TURNING: usize = 12;

/// Two terms and the one that they are together.
fn angle_in(graph: &mut Graph, p: &Polynomial, angles: Angles) -> Option<(Monomial, Monomial, Monomial, Coefficient)> {
    for (monomial, c) in p.iter().filter(|(monomial, _)| monomial.len() <= MOST_TURNING) {
        for &(u, _) in monomial {
            for &(v, _) in monomial.iter().filter(|atom| atom.0 != u) {
                let (first, a, b) = match (graph.node(u), graph.node(v)) {
                    (Node::Unary(Unary::Cos, a), Node::Unary(Unary::Cos, b)) if u < v => (Unary::Cos, a, b),
                    (Node::Unary(Unary::Sin, a), Node::Unary(Unary::Cos, b)) if a != b => (Unary::Sin, a, b),
                    _ => continue,
                };
                let second = if first == Unary::Cos { Unary::Sin } else { Unary::Cos };
                let (x, y) = (graph.unary(second, a), graph.unary(Unary::Sin, b));
                let rest = divided(&divided(monomial, u), v);
                let partner = joined(&joined(&rest, &vec![(x, 1)]), &vec![(y, 1)]);
                let Some(d) = p.get(&partner) else { continue };
                let same = c.is(d, false);
                if !same && !c.is(d, true) {
                    continue;
                }
                // Of cosines the same sign gives the difference, of sines the sum.
                let subtract = same == (first == Unary::Cos);
                let Some((angle, negative)) = together(graph, a, b, subtract, angles) else { continue };
                let function = graph.unary(first, angle);
                let c = if negative && first == Unary::Sin { c.negated() } else { c.clone() };
                return Some((monomial.clone(), partner, joined(&rest, &vec![(function, 1)]), c));
            }
        }
    }
    None
}

/// a ± b with its first term positive, and whether that changed its sign; `None` for 0, and where it is not wanted.
fn together(graph: &mut Graph, a: Id, b: Id, subtract: bool, angles: Angles) -> Option<(Id, bool)> {
    let new = if subtract { graph.sub(a, b) } else { graph.add(a, b) };
    let sum = terms(graph, new);
    let shorter = sum.len() < terms(graph, a).len().max(terms(graph, b).len());
    let negative = sum.first()?.1.to_f64() < 0.0;
    if !shorter && angles == Angles::Shorter {
        return None;
    }
    let angle = sum.into_iter().fold(Id::ZERO, |sum, (term, c)| {
        let c = graph.constant(if negative { c.negated() } else { c });
        let product = graph.mul(c, term);
        graph.add(sum, product)
    });
    Some((angle, negative))
}

/// Factors greedily by the most frequent factor, coefficients counting as factors too.
fn lowered(graph: &mut Graph, p: &Polynomial) -> Id {
    let terms: Vec<(Monomial, Id)> = p.iter().map(|(m, c)| (m.clone(), c.lowered(graph))).collect();
    factored(graph, terms)
}

fn factored(graph: &mut Graph, terms: Vec<(Monomial, Id)>) -> Id {
    if terms.len() <= 1 {
        return terms.into_iter().next().map_or(Id::ZERO, |(m, c)| term(graph, &m, c));
    }
    // Coefficients that differ in sign only count as one factor.
    let magnitude = |graph: &Graph, c: Id| match graph.node(c) {
        Node::Unary(Unary::Neg, x) => x,
        _ => c,
    };
    let mut counts: BTreeMap<(bool, Id), usize> = BTreeMap::new();
    for (monomial, c) in &terms {
        let size = magnitude(graph, *c);
        if size != Id::ONE && graph.number(size).is_none_or(|n| n.to_f64().abs() != 1.0) {
            *counts.entry((false, size)).or_insert(0) += 1;
        }
        for &(atom, _) in monomial {
            *counts.entry((true, atom)).or_insert(0) += 1;
        }
    }
    let best = counts.iter().max_by_key(|((is_atom, id), count)| (**count, !*is_atom, std::cmp::Reverse(*id)));
    let Some((&(is_atom, factor), &count)) = best else { return sum_of(graph, &terms) };
    if count < 2 {
        return sum_of(graph, &terms);
    }
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for (monomial, c) in terms {
        let has = if is_atom { monomial.iter().any(|m| m.0 == factor) } else { magnitude(graph, c) == factor };
        if !has {
            without.push((monomial, c));
        } else if is_atom {
            with.push((divided(&monomial, factor), c));
        } else {
            let sign = if c == factor { Id::ONE } else { graph.integer(-1) };
            with.push((monomial, sign));
        }
    }
    let inner = factored(graph, with);
    let product = graph.mul(factor, inner);
    let rest = factored(graph, without);
    graph.add(product, rest)
}

fn sum_of(graph: &mut Graph, terms: &[(Monomial, Id)]) -> Id {
    let mut sum = Id::ZERO;
    for (monomial, c) in terms {
        let product = term(graph, monomial, *c);
        sum = graph.add(sum, product);
    }
    sum
}

fn term(graph: &mut Graph, monomial: &Monomial, coefficient: Id) -> Id {
    let mut product = Id::ONE;
    for &(atom, n) in monomial {
        let power = graph.powi(atom, n as i32);
        product = graph.mul(product, power);
    }
    graph.mul(coefficient, product)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// cos a cos b + sin a sin b and sin a cos b − cos a sin b.
    fn turned(g: &mut Graph, a: Id, b: Id) -> [Id; 2] {
        let [(ca, sa), (cb, sb)] = [a, b].map(|x| (g.unary(Unary::Cos, x), g.unary(Unary::Sin, x)));
        let [cc, ss, sc, cs] = [(ca, cb), (sa, sb), (sa, cb), (ca, sb)].map(|(x, y)| g.mul(x, y));
        [g.add(cc, ss), g.sub(sc, cs)]
    }

    #[test]
    fn frames_that_turn_about_one_axis_have_one_angle_between_them() {
        let mut g = Graph::new();
        let (q, r) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let sum = g.add(q, r);
        let parameters = |s: Symbol| matches!(s, Symbol::Parameter(_));
        let (cosine, sine) = (g.unary(Unary::Cos, r), g.unary(Unary::Sin, r));
        let roots = turned(&mut g, sum, q);
        assert_eq!(expand(&mut g, &roots, parameters, Angles::Shorter), Some(vec![cosine, sine]));
        let opposite = g.neg(sine);
        let roots = turned(&mut g, q, sum);
        assert_eq!(expand(&mut g, &roots, parameters, Angles::Shorter), Some(vec![cosine, opposite]));
        // The difference of two coordinates is no shorter than they are.
        let roots = turned(&mut g, q, r);
        let difference = g.sub(q, r);
        let both = [Unary::Cos, Unary::Sin].map(|f| g.unary(f, difference));
        assert_eq!(expand(&mut g, &roots, parameters, Angles::All), Some(both.to_vec()));
        let kept = expand(&mut g, &roots, parameters, Angles::Shorter).unwrap();
        assert_ne!(kept[0], both[0]);
    }

    #[test]
    fn a_distance_that_may_vanish_keeps_its_squares() {
        let mut g = Graph::new();
        let (q, r) = (g.symbol(Symbol::Coordinate(0)), g.symbol(Symbol::Coordinate(1)));
        let squares = [Unary::Sin, Unary::Cos].map(|f| {
            let (a, b) = (g.unary(f, q), g.unary(f, r));
            let sum = g.add(a, b);
            g.mul(sum, sum)
        });
        let sum = g.add(squares[0], squares[1]);
        let distance = g.unary(Unary::Sqrt, sum);
        let form = expand(&mut g, &[distance], |_| false, Angles::All).unwrap();
        assert_eq!(form, [distance]);
    }

    #[test]
    fn products_with_different_factors_keep_their_angles() {
        let mut g = Graph::new();
        let [a, b, m, n] = [Symbol::Coordinate(0), Symbol::Coordinate(1), Symbol::Parameter(0), Symbol::Parameter(1)]
            .map(|s| g.symbol(s));
        let [(ca, sa), (cb, sb)] = [a, b].map(|x| (g.unary(Unary::Cos, x), g.unary(Unary::Sin, x)));
        let [cc, ss] = [(ca, cb, m), (sa, sb, n)].map(|(x, y, c)| {
            let product = g.mul(x, y);
            g.mul(c, product)
        });
        let sum = g.add(cc, ss);
        let form = expand(&mut g, &[sum], |s| matches!(s, Symbol::Parameter(_)), Angles::All).unwrap();
        assert_eq!(g.symbols(form.clone()).len(), 4);
        assert!(g.needed(form).contains(&sb));
    }
}
