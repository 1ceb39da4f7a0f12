//! Putting an expression in the place of a bound variable.

use std::collections::HashMap;

use super::facts::{Depends, Facts};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// The values of the nodes below `root` by their ids.
pub type Known<T> = HashMap<Id, T>;

/// The value of `root`, children first: `leaf` of what contains no dummy, `join` of the rest, which finds the values of
/// children in its table; `None` as soon as `join` gives none.  Also returns how many nodes were visited.
pub fn bottom_up<T>(
    graph: &mut Graph,
    facts: &mut Facts,
    root: Id,
    leaf: impl Fn(Id) -> T,
    mut join: impl FnMut(&mut Graph, &mut Facts, Id, &Known<T>) -> Option<T>,
) -> Option<(T, u64)> {
    let mut known = Known::new();
    let mut stack = vec![root];
    while let Some(&top) = stack.last() {
        if known.contains_key(&top) {
            stack.pop();
            continue;
        }
        let value = if facts.of(graph, top).meets(Depends::DUMMY) {
            let before = stack.len();
            stack.extend(graph.children(top).filter(|child| !known.contains_key(child)));
            if stack.len() > before {
                continue;
            }
            join(graph, facts, top, &known)?
        } else {
            leaf(top)
        };
        known.insert(top, value);
        stack.pop();
    }
    let visited = known.len() as u64;
    known.remove(&root).map(|value| (value, visited))
}

/// `root` with `by` in the place of the dummy `symbol`; only nodes that contain a dummy are rebuilt.
/// Also returns how many nodes were visited.
pub fn substitute(graph: &mut Graph, facts: &mut Facts, root: Id, symbol: Symbol, by: Id) -> (Id, u64) {
    let replaced = bottom_up(
        graph,
        facts,
        root,
        |id| id,
        |graph, _, top, known| {
            Some(match graph.node(top) {
                Node::Symbol(s) if s == symbol => by,
                Node::Unary(f, x) => graph.unary(f, known[&x]),
                Node::Binary(f, x, y) => graph.binary(f, known[&x], known[&y]),
                Node::Number(_) | Node::Symbol(_) => top,
            })
        },
    );
    replaced.unwrap_or((root, 0))
}

/// The degree of `root` as a polynomial in the dummy `symbol`, or a bound for it; `None` where it is none, or
/// of a degree beyond a thousand.
pub fn degree(graph: &mut Graph, facts: &mut Facts, root: Id, symbol: Symbol) -> Option<u32> {
    let found = bottom_up(
        graph,
        facts,
        root,
        |_| 0,
        |graph, _, top, known| {
            let degree = match graph.node(top) {
                Node::Symbol(s) => u32::from(s == symbol),
                Node::Unary(Unary::Neg, x) => known[&x],
                Node::Binary(Binary::Add | Binary::Sub, x, y) => known[&x].max(known[&y]),
                Node::Binary(Binary::Mul, x, y) => known[&x] + known[&y],
                Node::Binary(Binary::Div, x, y) if known[&y] == 0 => known[&x],
                Node::Number(_) => 0,
                Node::Unary(_, x) if known[&x] == 0 => 0,
                Node::Binary(_, x, y) if known[&x] == 0 && known[&y] == 0 => 0,
                _ => return None,
            };
            (degree <= 1000).then_some(degree)
        },
    );
    found.map(|(degree, _)| degree)
}
