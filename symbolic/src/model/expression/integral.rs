//! Integrals: in closed form where that holds its digits, else by the cheapest rule that is right.
//!
//! The integrand is multiplied out into Σ cᵢ φᵢ(x), so that what does not contain x costs nothing at the nodes.
//! Each ∫ φ dx is found by itself: polynomials by the rule of Gauss that is exact for them; else an antiderivative or
//! a rule of quadrature, whichever is first to hold at the values that `trial.rs` draws for parameters and coordinates.

use std::collections::HashSet;

use super::antiderivative::antiderivative;
use super::builder::ExprBuilder;
use super::facts::Depends;
use super::lines::roots_of_linear;
use super::quadrature::{gauss_legendre, tanh_sinh};
use super::substitute::{bottom_up, degree, substitute};
use super::trial::{Piece, Trial};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{memory, names};
use crate::expr::{Binary, DoubleDouble, Graph, Id, Node, Rational, Symbol, Unary};
use crate::model::resolved::Tried;

/// The variable of integration and its limits.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    /// The dummy.
    pub symbol: Symbol,
    /// From and to.
    pub limits: [Id; 2],
}

/// A node: its distance from the nearer end as a share of the piece, whether that is the right end, its weight.
pub type RuleNode = (DoubleDouble, bool, DoubleDouble);

/// Summands into which an integrand is multiplied out.
const TERM_LIMIT: usize = 64;
/// Points of the largest rule of Gauss for a polynomial.
const POLYNOMIAL_POINTS: usize = 64;
/// Places at which an interval is cut.
const CUT_LIMIT: usize = 4;
/// Nodes of the graph that one integral may need.
const SIZE_LIMIT: u64 = 40_000;
/// Nodes of an integrand that is tried.
const INTEGRAND_LIMIT: u64 = 4_000;
/// What two refinements of a rule may differ by, relative to ∫ |φ| dx; and where no rule within reach is so exact, as where
/// singular places in the complex plane come near the interval (elliptic integrals): a hundredth of the rounding of `f64`.
const AGREEMENTS: [f64; 2] = [1e-24, 1e-18];

/// ∫ e dx; 0 (and a problem at `place`) where no way to it is right.
pub fn integral(builder: &mut ExprBuilder, e: Id, over: Over, words: &str, place: &Place) -> Id {
    if builder.depends(&[e, over.limits[0], over.limits[1]]).meets(Depends::MEMORY) {
        builder.problems.push(memory::integral_of_memory(place.clone(), words));
        return Id::ZERO;
    }
    if let Some(points) = polynomial_points(builder, e, over.symbol) {
        return gauss(builder, e, over, points, place);
    }
    let terms = multiplied_out(builder, e, over.symbol).unwrap_or_else(|| vec![(Id::ONE, e)]);
    let mut total = Id::ZERO;
    for (factor, part) in terms {
        let Some(value) = integral_of_term(builder, part, over, (words, place)) else {
            builder.problems.push(names::integral_not_resolved(place.clone(), words));
            return Id::ZERO;
        };
        let term = builder.graph.mul(factor, value);
        total = builder.graph.add(total, term);
    }
    total
}

/// ∫ φ dx; `None` where nothing holds.
fn integral_of_term(builder: &mut ExprBuilder, e: Id, over: Over, (words, place): (&str, &Place)) -> Option<Id> {
    if let Some(points) = polynomial_points(builder, e, over.symbol) {
        return Some(gauss(builder, e, over, points, place));
    }
    let size =
        bottom_up(&mut builder.graph, &mut builder.facts, e, |_| (), |_, _, _, _| Some(())).map_or(0, |found| found.1);
    if size > INTEGRAND_LIMIT || !builder.spend(size, place) {
        return None;
    }
    let roots = cuts(builder, e, over.symbol);
    let trial = Trial::new(builder, e, over, &roots);
    let Over { limits: [from, to], .. } = trial.over;
    let whole = [Piece::new(builder, e, trial.over, from, to)];
    let edges = match roots.len() <= CUT_LIMIT && (trial.ordered || roots.len() <= 1) {
        true => edges(builder, trial.over, roots),
        false => vec![from, to],
    };
    let split: Vec<Piece> = edges.windows(2).map(|ends| Piece::new(builder, e, trial.over, ends[0], ends[1])).collect();
    let trial = trial.surveyed(builder, &split)?;
    let value = closed(builder, e, &trial).or_else(|| {
        let found =
            AGREEMENTS.into_iter().find_map(|agreement| cheapest(builder, &trial, (&whole, &split), size, agreement));
        let (pieces, nodes) = found?;
        let tried = Tried { words: words.to_owned(), ranges: trial.ranges(builder) };
        if !tried.ranges.is_empty() && !builder.integrals.contains(&tried) {
            builder.integrals.push(tried);
        }
        Some(by_rule(builder, pieces, &nodes, place))
    })?;
    Some(if trial.reversed { builder.graph.neg(value) } else { value })
}

/// F(b) − F(a) where it is right at every trial and cancels no digits.
fn closed(builder: &mut ExprBuilder, e: Id, trial: &Trial) -> Option<Id> {
    let Over { symbol, limits } = trial.over;
    let primitive = antiderivative(&mut builder.graph, &mut builder.facts, e, symbol)?;
    let [from, to] = limits.map(|end| substitute(&mut builder.graph, &mut builder.facts, primitive, symbol, end).0);
    let value = builder.graph.sub(to, from);
    let entire = is_entire(builder, e);
    (!may_divide_by_zero(&builder.graph, value, e) && trial.accepts(builder, value, entire)).then_some(value)
}

/// Whether some divisor that the integrand does not have is a sum, which parameters far from their defaults could make
/// 0: ∫ sin(a x) sin(b x) dx at a = b.
fn may_divide_by_zero(graph: &Graph, value: Id, e: Id) -> bool {
    let is_sum = |id: Id| matches!(graph.node(id), Node::Binary(Binary::Add | Binary::Sub, _, _));
    let divisors = |root: Id| -> HashSet<Id> {
        let needed = graph.reachable([root]);
        let quotients = (0..needed.len()).filter(|i| needed[*i]).map(|i| graph.id_at(i));
        quotients
            .filter_map(|id| if let Node::Binary(Binary::Div, _, y) = graph.node(id) { Some(y) } else { None })
            .collect()
    };
    let known = divisors(e);
    divisors(value).difference(&known).any(|divisor| {
        let needed = graph.reachable([*divisor]);
        (0..needed.len()).any(|i| needed[i] && is_sum(graph.id_at(i)))
    })
}

/// The rule with the fewest points that agrees with its own refinement and with the survey.
fn cheapest<'a>(
    builder: &ExprBuilder,
    trial: &Trial,
    (whole, split): (&'a [Piece], &'a [Piece]),
    size: u64,
    agreement: f64,
) -> Option<(&'a [Piece], Vec<RuleNode>)> {
    type Family = (fn(usize) -> Vec<RuleNode>, &'static [usize]);
    let gauss: Family = (gauss_rule, &[16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512]);
    let equal: Family = (equal_rule, &[16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536, 2048]);
    let root: Family = (root_rule, &[12, 16, 24, 32, 48, 64]);
    let exponential: Family = (|n| tanh_sinh(n).to_vec(), &[6, 8, 12, 16, 24, 32, 48, 64, 96]);
    let dyadic: Family = (dyadic_rule, &[4, 6, 8, 10, 12, 16]);
    let families =
        [(whole, gauss), (whole, equal), (split, gauss), (split, root), (split, exponential), (split, dyadic)];
    let mut best: Option<(&[Piece], Vec<RuleNode>)> = None;
    for (pieces, (rule, sizes)) in families {
        let mut coarse: Option<(Vec<RuleNode>, Vec<DoubleDouble>)> = None;
        for &n in sizes {
            let nodes = rule(n);
            let points = |nodes: &Vec<RuleNode>, pieces: &[Piece]| nodes.len() * pieces.len();
            let dearer = best.as_ref().is_some_and(|(p, found)| points(found, p) <= points(&nodes, pieces));
            if dearer || (points(&nodes, pieces) as u64).saturating_mul(size) > 2 * SIZE_LIMIT {
                break;
            }
            let fine = trial.by_rule(&builder.graph, pieces, &nodes);
            if let Some((known, values)) = coarse
                && trial.agree(&values, &fine, agreement)
            {
                if points(&known, pieces) as u64 * size <= SIZE_LIMIT {
                    best = Some((pieces, known));
                }
                break;
            }
            coarse = Some((nodes, fine));
        }
    }
    best
}

/// Σ over the pieces of width Σ wᵢ φ(xᵢ).
fn by_rule(builder: &mut ExprBuilder, pieces: &[Piece], nodes: &[RuleNode], place: &Place) -> Id {
    let mut total = Id::ZERO;
    for piece in pieces {
        let mut sum = Id::ZERO;
        for (distance, right, weight) in nodes {
            let share = builder.graph.double_double(*distance);
            let offset = builder.graph.mul(share, piece.width);
            let from = if *right { piece.from_right } else { piece.from_left };
            let (value, visited) = substitute(&mut builder.graph, &mut builder.facts, from, Piece::OFFSET, offset);
            if !builder.spend(visited, place) {
                return Id::ZERO;
            }
            let weight = builder.graph.double_double(*weight);
            let term = builder.graph.mul(weight, value);
            sum = builder.graph.add(sum, term);
        }
        let part = builder.graph.mul(piece.width, sum);
        total = builder.graph.add(total, part);
    }
    total
}

/// Gauss and Legendre's rule.
fn gauss_rule(n: usize) -> Vec<RuleNode> {
    let half = |&(x, w): &(DoubleDouble, DoubleDouble)| {
        let right = x > DoubleDouble::ZERO;
        ((-x.abs() + 1.0) * 0.5, right, w * 0.5)
    };
    gauss_legendre(n).iter().map(half).collect()
}

/// The midpoints of equal parts: converges as an exponential for functions that repeat after the interval.
fn equal_rule(n: usize) -> Vec<RuleNode> {
    let count = DoubleDouble::from(n as f64);
    let node = |k: usize| {
        let from_left = DoubleDouble::from(k as f64 + 0.5) / count;
        let right = 2 * k >= n;
        let distance = if right { DoubleDouble::from((n - k) as f64 - 0.5) / count } else { from_left };
        (distance, right, DoubleDouble::ONE / count)
    };
    (0..n).map(node).collect()
}

/// Gauss and Legendre's rule in s, where the distance from an end is s²/2: for roots, and inverse roots, at the ends.
fn root_rule(n: usize) -> Vec<RuleNode> {
    let mut nodes = Vec::new();
    for right in [false, true] {
        for &(x, w) in gauss_legendre(n) {
            let s = (x + 1.0) * 0.5;
            nodes.push((s * s * 0.5, right, w * s * 0.5));
        }
    }
    nodes
}

/// Panels that are halved towards both ends `halvings` times, with more points on each the more there are: for peaks
/// at the ends.
fn dyadic_rule(halvings: usize) -> Vec<RuleNode> {
    let mut nodes = Vec::new();
    for k in 0..=halvings {
        // From 2^(−k−2) to 2^(−k−1), the last from 0.
        let end = DoubleDouble::from(2_f64.powi(-(k as i32) - 1));
        let start = if k == halvings { DoubleDouble::ZERO } else { end * 0.5 };
        let half = (end - start) * 0.5;
        for &(x, w) in gauss_legendre(2 * halvings + 8) {
            let distance = start + half * (x + 1.0);
            nodes.extend([false, true].map(|right| (distance, right, w * half)));
        }
    }
    nodes
}

/// Points of the rule of Gauss that is exact; `None` for what is no polynomial, or of too high a degree.
fn polynomial_points(builder: &mut ExprBuilder, e: Id, symbol: Symbol) -> Option<usize> {
    let degree = degree(&mut builder.graph, &mut builder.facts, e, symbol)?;
    Some(degree as usize / 2 + 1).filter(|points| *points <= POLYNOMIAL_POINTS)
}

/// h Σ wᵢ e(m + h ξᵢ), h = (b − a)/2, m = (a + b)/2.
fn gauss(builder: &mut ExprBuilder, e: Id, over: Over, points: usize, place: &Place) -> Id {
    let [from, to] = over.limits;
    let half = builder.graph.rational(Rational::HALF);
    let (sum, width) = (builder.graph.add(from, to), builder.graph.sub(to, from));
    let (middle, reach) = (builder.graph.mul(half, sum), builder.graph.mul(half, width));
    let mut total = Id::ZERO;
    for &(node, weight) in gauss_legendre(points) {
        let node = builder.graph.double_double(node);
        let offset = builder.graph.mul(node, reach);
        let at = builder.graph.add(middle, offset);
        let (value, visited) = substitute(&mut builder.graph, &mut builder.facts, e, over.symbol, at);
        if !builder.spend(visited, place) {
            return Id::ZERO;
        }
        let weight = builder.graph.double_double(weight);
        let term = builder.graph.mul(weight, value);
        total = builder.graph.add(total, term);
    }
    builder.graph.mul(reach, total)
}

/// Where an interval is cut: the places at which something linear in x vanishes, kinks and peaks among them.
fn cuts(builder: &mut ExprBuilder, e: Id, symbol: Symbol) -> Vec<Id> {
    let mut roots = roots_of_linear(&mut builder.graph, &mut builder.facts, e, symbol);
    roots.sort();
    roots.dedup();
    roots
}

/// The ends and the cuts between them in order, cuts outside moved to the ends.
fn edges(builder: &mut ExprBuilder, over: Over, cuts: Vec<Id>) -> Vec<Id> {
    let [from, to] = over.limits;
    let graph = &mut builder.graph;
    let (low, high) = (graph.binary(Binary::Min, from, to), graph.binary(Binary::Max, from, to));
    // Limits known to be in order need no comparison.
    let (low, high) = if cuts.len() > 1 { (from, to) } else { (low, high) };
    let mut inside: Vec<Id> = cuts
        .into_iter()
        .filter(|cut| *cut != from && *cut != to)
        .map(|cut| {
            let below = graph.binary(Binary::Min, cut, high);
            graph.binary(Binary::Max, below, low)
        })
        .collect();
    for last in (1..inside.len()).rev() {
        for i in 0..last {
            let (a, b) = (inside[i], inside[i + 1]);
            inside[i] = graph.binary(Binary::Min, a, b);
            inside[i + 1] = graph.binary(Binary::Max, a, b);
        }
    }
    [vec![from], inside, vec![to]].concat()
}

/// The integrand as Σ factor·part with factors free of x, equal parts joined; `None` where there are too many.
fn multiplied_out(builder: &mut ExprBuilder, e: Id, symbol: Symbol) -> Option<Vec<(Id, Id)>> {
    let free = |id: Id| vec![(id, Id::ONE)];
    let found = bottom_up(&mut builder.graph, &mut builder.facts, e, free, |graph, _, id, known| {
        let alone = |id: Id| vec![(Id::ONE, id)];
        // What does not contain this dummy, but perhaps another, is a factor too.
        let constant = |id: Id| known.get(&id).is_none_or(|terms| terms.iter().all(|(_, part)| *part == Id::ONE));
        if graph.children(id).next().is_some() && graph.children(id).all(constant) {
            return Some(vec![(id, Id::ONE)]);
        }
        let terms = match graph.node(id) {
            Node::Symbol(s) if s != symbol => vec![(id, Id::ONE)],
            Node::Unary(Unary::Neg, x) => known[&x].iter().map(|(c, p)| (graph.neg(*c), *p)).collect(),
            Node::Binary(Binary::Add, x, y) => joined(graph, known[&x].clone(), &known[&y]),
            Node::Binary(Binary::Sub, x, y) => {
                let minus: Vec<(Id, Id)> = known[&y].iter().map(|(c, p)| (graph.neg(*c), *p)).collect();
                joined(graph, known[&x].clone(), &minus)
            }
            Node::Binary(Binary::Mul, x, y) => {
                let mut sum = Vec::new();
                for (c, p) in &known[&x] {
                    let row: Vec<(Id, Id)> =
                        known[&y].iter().map(|(d, q)| (graph.mul(*c, *d), graph.mul(*p, *q))).collect();
                    sum = joined(graph, sum, &row);
                    if sum.len() > TERM_LIMIT {
                        return None;
                    }
                }
                sum
            }
            Node::Binary(Binary::Div, x, y) if constant(y) => {
                known[&x].iter().map(|(c, p)| (graph.div(*c, y), *p)).collect()
            }
            Node::Binary(Binary::Div, x, y) => match &known[&x][..] {
                [(c, p)] => vec![(*c, graph.div(*p, y))],
                _ => alone(id),
            },
            _ => alone(id),
        };
        (terms.len() <= TERM_LIMIT).then_some(terms)
    });
    found.map(|(terms, _)| terms)
}

fn joined(graph: &mut Graph, mut terms: Vec<(Id, Id)>, more: &[(Id, Id)]) -> Vec<(Id, Id)> {
    for (factor, part) in more {
        match terms.iter().position(|(_, known)| known == part) {
            Some(place) => terms[place].0 = graph.add(terms[place].0, *factor),
            None => terms.push((*factor, *part)),
        }
    }
    terms.retain(|(factor, _)| *factor != Id::ZERO);
    terms
}

/// Whether the integrand has neither pole, branch nor kink, so that an antiderivative is right everywhere.
fn is_entire(builder: &mut ExprBuilder, e: Id) -> bool {
    let entire = bottom_up(
        &mut builder.graph,
        &mut builder.facts,
        e,
        |_| true,
        |graph, _, id, known| {
            let grows = match graph.node(id) {
                Node::Number(_) | Node::Symbol(_) => true,
                Node::Unary(f, _) => {
                    matches!(f, Unary::Neg | Unary::Sin | Unary::Cos | Unary::Exp | Unary::Sinh | Unary::Cosh)
                }
                Node::Binary(f, _, y) => {
                    // A divisor is free of dummies where it is a leaf of this walk.
                    matches!(f, Binary::Add | Binary::Sub | Binary::Mul)
                        || f == Binary::Div && known.get(&y) == Some(&true)
                }
            };
            Some(grows && graph.children(id).all(|child| known.get(&child).copied().unwrap_or(true)))
        },
    );
    entire.is_some_and(|(entire, _)| entire)
}
