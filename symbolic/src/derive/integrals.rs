//! Integrals of velocity constraints, where they can be written down.

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Angles, Binary, Graph, Id, Node, Symbol, Tape, Unary, expand, partial, substitute};
use crate::number::DoubleDouble;
use crate::random::Random;

/// Steps of the search for one row's integral.
const FUEL: usize = 400;

/// A function I(q, u, t) with I' = Σ A_i q_i' + b: a row's elements A, then b; none where none is found.
///
/// b is Σ B_k u_k' and a rest, inputs u and their rates being moved as coordinates are.  One after the other, I grows by
/// ∫ (A_i − ∂I/∂q_i) dq_i, in which nothing earlier can stand where the row is closed; sums of products of powers, sines and
/// the like are integrated.  An integrable row that is not closed as it is written (it wants an integrating factor, or other
/// rows) is not found.
pub(super) fn integral(graph: &mut Graph, row: &[(usize, Id)], drive: Id) -> Option<Id> {
    let mut fuel = FUEL;
    let mut wanted: Vec<(Symbol, Id)> = row.iter().map(|(i, x)| (Symbol::Coordinate(*i as u32), *x)).collect();
    let rest = of_inputs(graph, drive, &mut wanted);
    wanted.push((Symbol::Time, rest));
    // What has no element must not stand in the others: the integral would move with it.
    let moved: Vec<Symbol> = wanted.iter().map(|e| e.0).collect();
    let needed = graph.symbols(wanted.iter().map(|e| e.1));
    if needed.iter().any(|s| match s {
        Symbol::Coordinate(_) | Symbol::Input(..) => !moved.contains(s),
        Symbol::Parameter(_) | Symbol::Time => false,
        // A jump has no integral.
        _ => true,
    }) {
        return None;
    }
    let mut found = Id::ZERO;
    for (place, (symbol, wanted)) in wanted.iter().enumerate() {
        let have = partial(graph, found, *symbol);
        let missing = graph.sub(*wanted, have);
        let earlier = &moved[..place];
        if earlier.iter().any(|earlier| depends(graph, missing, *earlier)) {
            return None;
        }
        let stands = |graph: &Graph, missing: Id| earlier.iter().any(|earlier| contains(graph, missing, *earlier));
        let direct = if stands(graph, missing) { None } else { antiderivative(graph, missing, *symbol, &mut fuel) };
        let more = match direct {
            Some(more) => more,
            None => {
                let missing =
                    *expand(graph, &[missing], |s| matches!(s, Symbol::Parameter(_)), Angles::Shorter)?.first()?;
                if stands(graph, missing) {
                    return None;
                }
                antiderivative(graph, missing, *symbol, &mut fuel)?
            }
        };
        found = graph.add(found, more);
    }
    Some(found)
}

/// Splits Σ B_k u_k' from what drives a row, the highest rates first, and returns the rest.
fn of_inputs(graph: &mut Graph, drive: Id, wanted: &mut Vec<(Symbol, Id)>) -> Id {
    let mut rest = drive;
    let rates = graph.symbols([drive]).into_iter();
    let mut rates: Vec<(u8, u32)> =
        rates.filter_map(|s| if let Symbol::Input(k, order @ 1..) = s { Some((order, k)) } else { None }).collect();
    rates.sort_unstable();
    for (order, k) in rates.into_iter().rev() {
        let rate = Symbol::Input(k, order);
        let slope = partial(graph, rest, rate);
        if slope != Id::ZERO && !contains(graph, slope, rate) {
            wanted.push((Symbol::Input(k, order - 1), slope));
            rest = substitute(graph, &[rest], &[(rate, Id::ZERO)].into_iter().collect())[0];
        }
    }
    rest
}

/// ∫ e dx, where simple rules find it.
fn antiderivative(graph: &mut Graph, e: Id, x: Symbol, fuel: &mut usize) -> Option<Id> {
    *fuel = fuel.checked_sub(1)?;
    if e == Id::ZERO {
        return Some(e);
    }
    match graph.node(e) {
        Node::Unary(Unary::Neg, inner) => {
            let inner = antiderivative(graph, inner, x, fuel)?;
            Some(graph.neg(inner))
        }
        Node::Binary(operation @ (Binary::Add | Binary::Sub), a, b) => {
            let (a, b) = (antiderivative(graph, a, x, fuel)?, antiderivative(graph, b, x, fuel)?);
            Some(graph.binary(operation, a, b))
        }
        _ => {
            let (mut fixed, mut moving) = (Id::ONE, Vec::new());
            for (factor, below) in factors(graph, e) {
                if contains(graph, factor, x) {
                    moving.push((factor, below));
                } else if below {
                    fixed = graph.div(fixed, factor);
                } else {
                    fixed = graph.mul(fixed, factor);
                }
            }
            let inner = product(graph, &moving, x, fuel)?;
            Some(graph.mul(fixed, inner))
        }
    }
}

/// ∫ of a product of factors that contain x: f(u) w with w dx = k du.
fn product(graph: &mut Graph, factors: &[(Id, bool)], x: Symbol, fuel: &mut usize) -> Option<Id> {
    if factors.is_empty() {
        return Some(graph.symbol(x));
    }
    let rest = |graph: &mut Graph, without: &dyn Fn(usize) -> bool| {
        let mut rest = Id::ONE;
        for (_, (factor, below)) in factors.iter().enumerate().filter(|(place, _)| !without(*place)) {
            rest = if *below { graph.div(rest, *factor) } else { graph.mul(rest, *factor) };
        }
        rest
    };
    for (place, &(factor, below)) in factors.iter().enumerate() {
        *fuel = fuel.checked_sub(1)?;
        // uⁿ.
        let power = factors.iter().filter(|other| **other == (factor, below)).count() as i32;
        let others = rest(graph, &|k| factors[k] == (factor, below));
        if !below && let Some(k) = ratio(graph, others, factor, x) {
            let (raised, over) = (graph.powi(factor, power + 1), graph.integer(i64::from(power) + 1));
            let share = graph.div(raised, over);
            return Some(graph.mul(k, share));
        }
        // f(u), of which the antiderivative is known.
        if let (Node::Unary(function, u), 1) = (graph.node(factor), power)
            && let Some(k) = ratio(graph, others, u, x)
            && let Some(whole) = known(graph, function, factor, u, below)
        {
            return Some(graph.mul(k, whole));
        }
        if !below && let Node::Binary(operation @ (Binary::Add | Binary::Sub), a, b) = graph.node(factor) {
            let others = rest(graph, &|k| k == place);
            let (a, b) = (graph.mul(a, others), graph.mul(b, others));
            let (a, b) = (antiderivative(graph, a, x, fuel)?, antiderivative(graph, b, x, fuel)?);
            return Some(graph.binary(operation, a, b));
        }
    }
    None
}

/// ∫ f(u) du, or ∫ du/f(u).
fn known(graph: &mut Graph, function: Unary, value: Id, u: Id, below: bool) -> Option<Id> {
    let two = graph.integer(2);
    Some(match (function, below) {
        (Unary::Sin, false) => {
            let cosine = graph.unary(Unary::Cos, u);
            graph.neg(cosine)
        }
        (Unary::Cos, false) => graph.unary(Unary::Sin, u),
        (Unary::Exp, false) => value,
        (Unary::Sinh, false) => graph.unary(Unary::Cosh, u),
        (Unary::Cosh, false) => graph.unary(Unary::Sinh, u),
        (Unary::Sqrt, true) => graph.mul(two, value),
        (Unary::Sqrt, false) => {
            let third = graph.integer(3);
            let (cube, part) = (graph.mul(u, value), graph.div(two, third));
            graph.mul(part, cube)
        }
        _ => return None,
    })
}

/// w/(du/dx) where x does not stand in it.
fn ratio(graph: &mut Graph, w: Id, u: Id, x: Symbol) -> Option<Id> {
    let slope = partial(graph, u, x);
    if slope == Id::ZERO {
        return None;
    }
    let ratio = graph.div(w, slope);
    (!contains(graph, ratio, x)).then_some(ratio)
}

/// The factors of a product, and whether each is divided by.
fn factors(graph: &Graph, e: Id) -> Vec<(Id, bool)> {
    let (mut stack, mut found) = (vec![(e, false)], Vec::new());
    while let Some((id, below)) = stack.pop() {
        match graph.node(id) {
            Node::Binary(Binary::Mul, a, b) => stack.extend([(b, below), (a, below)]),
            Node::Binary(Binary::Div, a, b) => stack.extend([(b, !below), (a, below)]),
            _ => found.push((id, below)),
        }
    }
    found
}

/// Whether the value changes with x, at arbitrary numbers: where not, x may stand in what cancels.
fn depends(graph: &mut Graph, e: Id, x: Symbol) -> bool {
    let slope = partial(graph, e, x);
    let mut random = Random::new();
    let mut values: HashMap<Symbol, f64> = HashMap::default();
    for symbol in graph.symbols([slope]) {
        values.insert(symbol, random.between(0.3, 1.7));
    }
    let value = |s: Symbol| DoubleDouble::from(values.get(&s).copied().unwrap_or(0.0));
    let found = Tape::new(graph, &[slope]).measured(value)[0];
    // What is not defined there tells nothing.
    found.value.is_finite() && !found.vanishes(1e10)
}

fn contains(graph: &Graph, e: Id, x: Symbol) -> bool {
    graph.symbols([e]).contains(&x)
}
