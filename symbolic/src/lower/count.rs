//! Counting operations.

use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// Additions, multiplications, divisions, roots and functions that the roots need, each shared node once.
/// Changes of sign are free; what depends on parameters only is computed once per run and not counted.
pub fn operations(graph: &Graph, roots: &[Id]) -> usize {
    let varying = varying(graph);
    let needed = graph.reachable(roots.iter().copied());
    let costs = |i: &usize| match graph.node(graph.id_at(*i)) {
        Node::Number(_) | Node::Symbol(_) | Node::Unary(Unary::Neg, _) => false,
        Node::Unary(..) | Node::Binary(..) => true,
    };
    (0..needed.len()).filter(|&i| needed[i] && varying[i]).filter(costs).count()
}

/// About how long that takes, in additions: a sine takes as long as eight, its cosine beside it two more, a division or a
/// root four.
pub(super) fn work(graph: &Graph, roots: &[Id]) -> usize {
    const FUNCTION: usize = 8;
    const BESIDE: usize = 2;
    const DIVISION: usize = 4;
    let varying = varying(graph);
    let needed = graph.reachable(roots.iter().copied());
    let has = |function: Unary, x: Id| graph.find(Node::Unary(function, x)).is_some_and(|id| needed[id.index()]);
    let takes = |i: usize| match graph.node(graph.id_at(i)) {
        Node::Number(_) | Node::Symbol(_) | Node::Unary(Unary::Neg, _) => 0,
        Node::Unary(Unary::Cos, x) if has(Unary::Sin, x) => BESIDE,
        Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, _) => 1,
        Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Div, ..) => DIVISION,
        Node::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Min | Binary::Max, ..) => 1,
        Node::Unary(..) | Node::Binary(Binary::Pow | Binary::Atan2 | Binary::Table(_) | Binary::Normal(_), ..) => {
            FUNCTION
        }
    };
    (0..needed.len()).filter(|&i| needed[i] && varying[i]).map(takes).sum()
}

/// For each node, whether it changes along a run.
pub(crate) fn varying(graph: &Graph) -> Vec<bool> {
    graph.contains(|s| !matches!(s, Symbol::Parameter(_)))
}
