//! Counting operations.

use crate::expr::{Graph, Id, Node, Symbol, Unary};

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

/// For each node, whether it changes along a run.
pub(crate) fn varying(graph: &Graph) -> Vec<bool> {
    graph.contains(|s| !matches!(s, Symbol::Parameter(_)))
}
