//! A candidate form: polynomials in the state with coefficients of parameters, factored again.
//!
//! Products of sums are multiplied out over *atoms* (symbols and functions of the state), like terms are
//! collected with coefficients that depend on parameters only, k s² + k c² becomes k, and the result is
//! factored greedily by its most frequent factor.  For small planar mechanisms this finds what a person
//! writes by hand; for recursive code it destroys shared prefixes.  The caller keeps the cheaper form.
//!
//! What cancels stays as it is: arguments of functions, denominators and bases that are not linear (of √((x − a)² + …) the
//! expanded square has lost its digits, and may be negative, where the distance is small), and differences of places and
//! times in products, which are atoms there: (x − c)², (t − t₀)².

use std::collections::BTreeMap;
use std::rc::Rc;

use rustc_hash::FxHashMap as HashMap;

use super::{Binary, Graph, Id, Node, Symbol, Unary};

/// Atoms with their exponents, sorted by atom.
type Monomial = Vec<(Id, u32)>;
/// Monomials with their coefficients.
type Polynomial = BTreeMap<Monomial, Id>;

/// More terms than this in one expression: the form does not pay.
const TERM_LIMIT: usize = 120;
/// More terms than this in all polynomials together: stop looking.
const TOTAL_LIMIT: usize = 60_000;

/// The expressions in the form above, or `None` where it grows too large.  `constant` is true of symbols
/// that may stand in coefficients.
pub fn expand(graph: &mut Graph, roots: &[Id], constant: impl Fn(Symbol) -> bool) -> Option<Vec<Id>> {
    let varying = graph.contains(|s| !constant(s));
    let needed = graph.reachable(roots.iter().copied());
    let mut known: HashMap<Id, Rc<Polynomial>> = HashMap::default();
    let mut total = 0;
    for i in (0..needed.len()).filter(|&i| needed[i]) {
        let id = graph.id_at(i);
        let polynomial = if varying[i] {
            polynomial_of(graph, id, &mut known)?
        } else {
            BTreeMap::from([(Vec::new(), id)]).into_iter().filter(|(_, c)| *c != Id::ZERO).collect()
        };
        total += polynomial.len();
        if polynomial.len() > TERM_LIMIT || total > TOTAL_LIMIT {
            return None;
        }
        known.insert(id, Rc::new(polynomial));
    }
    Some(roots.iter().map(|root| lowered(graph, &known[root])).collect())
}

fn polynomial_of(graph: &mut Graph, id: Id, known: &mut HashMap<Id, Rc<Polynomial>>) -> Option<Polynomial> {
    let atom = |id: Id| Polynomial::from([(vec![(id, 1)], Id::ONE)]);
    Some(match graph.node(id) {
        Node::Number(_) | Node::Symbol(_) => atom(id),
        Node::Unary(Unary::Neg, x) => {
            let mut p = (*known[&x]).clone();
            for coefficient in p.values_mut() {
                *coefficient = graph.neg(*coefficient);
            }
            p
        }
        Node::Unary(f, x) => {
            let argument = argument(graph, x, known);
            let new = graph.unary(f, argument);
            match graph.node(new) {
                // Signs pulled outwards: −sin(x) is −1 times an atom.
                Node::Unary(Unary::Neg, inner) => {
                    let minus = graph.integer(-1);
                    Polynomial::from([(vec![(inner, 1)], minus)])
                }
                _ => atom(new),
            }
        }
        Node::Binary(operation @ (Binary::Add | Binary::Sub), x, y) => {
            let mut sum = (*known[&x]).clone();
            for (monomial, &coefficient) in known[&y].clone().iter() {
                let c = if operation == Binary::Sub { graph.neg(coefficient) } else { coefficient };
                accumulate(graph, &mut sum, monomial.clone(), c);
            }
            fold_pythagoras(graph, sum)
        }
        Node::Binary(Binary::Mul, x, y) => {
            let (p, q) = (known[&x].clone(), known[&y].clone());
            let (p, q) = if p.len() > 1 && q.len() > 1 { (whole(graph, &p), whole(graph, &q)) } else { (p, q) };
            if p.len() * q.len() > 4 * TERM_LIMIT {
                return None;
            }
            product(graph, &p, &q)
        }
        Node::Binary(Binary::Div, x, y) => {
            let denominator = argument(graph, y, known);
            let reciprocal = graph.div(Id::ONE, denominator);
            let p = known[&x].clone();
            product(graph, &p, &atom(reciprocal))
        }
        Node::Binary(operation, x, y) => {
            let (a, b) = (argument(graph, x, known), argument(graph, y, known));
            atom(graph.binary(operation, a, b))
        }
    })
}

/// What a function is taken of: as it is, but that linear expressions and products get their one form.
fn argument(graph: &mut Graph, x: Id, known: &HashMap<Id, Rc<Polynomial>>) -> Id {
    let p = known[&x].clone();
    let linear = p.keys().all(|monomial| monomial.iter().map(|(_, n)| n).sum::<u32>() <= 1);
    if linear || p.len() == 1 { lowered(graph, &p) } else { x }
}

/// A factor with several terms: an atom if these are places and times, whose difference may vanish.
fn whole(graph: &mut Graph, p: &Rc<Polynomial>) -> Rc<Polynomial> {
    let place = |graph: &Graph, atom: Id| {
        matches!(graph.node(atom), Node::Symbol(Symbol::Coordinate(_) | Symbol::Time | Symbol::Input(_, 0)))
    };
    if p.keys().all(|monomial| monomial.iter().all(|(atom, _)| place(graph, *atom))) {
        return Rc::new(Polynomial::from([(vec![(lowered(graph, p), 1)], Id::ONE)]));
    }
    p.clone()
}

fn product(graph: &mut Graph, p: &Polynomial, q: &Polynomial) -> Polynomial {
    let mut result = Polynomial::new();
    for (a, &c) in p {
        for (b, &d) in q {
            let coefficient = graph.mul(c, d);
            accumulate(graph, &mut result, joined(a, b), coefficient);
        }
    }
    fold_pythagoras(graph, result)
}

fn joined(a: &Monomial, b: &Monomial) -> Monomial {
    let mut exponents: BTreeMap<Id, u32> = a.iter().copied().collect();
    for &(atom, n) in b {
        *exponents.entry(atom).or_insert(0) += n;
    }
    exponents.into_iter().collect()
}

fn accumulate(graph: &mut Graph, p: &mut Polynomial, monomial: Monomial, coefficient: Id) {
    let old = p.get(&monomial).copied().unwrap_or(Id::ZERO);
    let sum = graph.add(old, coefficient);
    if sum == Id::ZERO {
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
        accumulate(graph, &mut p, rest, a);
        let difference = graph.sub(b, a);
        accumulate(graph, &mut p, squared_cosine, difference);
    }
}

fn without_square(monomial: &Monomial, atom: Id) -> Monomial {
    let reduced = |&(a, n): &(Id, u32)| if a == atom { (a, n - 2) } else { (a, n) };
    monomial.iter().map(reduced).filter(|&(_, n)| n > 0).collect()
}

/// Factors greedily by the most frequent factor, coefficients counting as factors too.
fn lowered(graph: &mut Graph, p: &Polynomial) -> Id {
    let terms: Vec<(Monomial, Id)> = p.iter().map(|(m, &c)| (m.clone(), c)).collect();
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
            let reduced = |&(a, n): &(Id, u32)| if a == factor { (a, n - 1) } else { (a, n) };
            with.push((monomial.iter().map(reduced).filter(|&(_, n)| n > 0).collect(), c));
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
