//! Putting an expression in the place of a bound variable.

use std::collections::HashMap;

use super::facts::{Depends, Facts};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// `root` with `by` in the place of the dummy `symbol`; only nodes that contain a dummy are rebuilt.
/// Also returns how many nodes were visited.
pub fn substitute(graph: &mut Graph, facts: &mut Facts, root: Id, symbol: Symbol, by: Id) -> (Id, u64) {
    let mut known: HashMap<Id, Id> = HashMap::new();
    let mut stack = vec![root];
    while let Some(&top) = stack.last() {
        if known.contains_key(&top) {
            stack.pop();
            continue;
        }
        if !facts.of(graph, top).meets(Depends::DUMMY) {
            known.insert(top, top);
            stack.pop();
            continue;
        }
        let before = stack.len();
        stack.extend(graph.children(top).filter(|child| !known.contains_key(child)));
        if stack.len() > before {
            continue;
        }
        let replaced = match graph.node(top) {
            Node::Symbol(s) if s == symbol => by,
            Node::Unary(f, x) => graph.unary(f, known[&x]),
            Node::Binary(f, x, y) => graph.binary(f, known[&x], known[&y]),
            Node::Number(_) | Node::Symbol(_) => top,
        };
        known.insert(top, replaced);
        stack.pop();
    }
    (known[&root], known.len() as u64)
}

/// The degree of `root` as a polynomial in the dummy `symbol`, or a bound for it; `None` where it is none, or
/// of a degree beyond a thousand.
pub fn degree(graph: &Graph, facts: &mut Facts, root: Id, symbol: Symbol) -> Option<u32> {
    let mut known: HashMap<Id, u32> = HashMap::new();
    let mut stack = vec![root];
    while let Some(&top) = stack.last() {
        if known.contains_key(&top) {
            stack.pop();
            continue;
        }
        if !facts.of(graph, top).meets(Depends::DUMMY) {
            known.insert(top, 0);
            stack.pop();
            continue;
        }
        let before = stack.len();
        stack.extend(graph.children(top).filter(|child| !known.contains_key(child)));
        if stack.len() > before {
            continue;
        }
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
        if degree > 1000 {
            return None;
        }
        known.insert(top, degree);
        stack.pop();
    }
    known.get(&root).copied()
}
