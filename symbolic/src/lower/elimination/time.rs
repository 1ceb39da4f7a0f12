//! How long straight-line code takes: by how many operations it has, and by its longest chain of operations that wait for each other.

use crate::derive::elimination::Depths;
use crate::expr::{Binary, Graph, Id, Node, Unary};
use crate::lower::count::operations;
use crate::lower::factor::dense_operations;

/// Nanoseconds of a sine with its cosine.
const SINE_PAIR: f64 = 9.0;
/// Nanoseconds of an operation where operations do not wait for each other much.
const OPERATION: f64 = 0.15;
/// Nanoseconds of a cycle in which one operation waits for another,
const WAITING: f64 = 0.24;
/// and of an operation beside those that wait.
const BESIDE: f64 = 0.045;

/// Nanoseconds that straight-line code for these roots takes about, fitted to measured times of chains, trees and chains in space of 2 to 40
/// links: sines, and whichever is longer, all operations or their longest chain.
pub(super) fn time(graph: &Graph, roots: &[Id]) -> f64 {
    let mut depths = Depths::default();
    let longest = roots.iter().map(|root| depths.of(graph, *root)).max().unwrap_or(0);
    let count = operations(graph, roots) as f64;
    let needed = graph.reachable(roots.iter().copied());
    let mut functions = 0;
    for id in (0..needed.len()).filter(|place| needed[*place]).map(|place| graph.id_at(place)) {
        let alone = match graph.node(id) {
            Node::Unary(Unary::Cos, x) => {
                !graph.find(Node::Unary(Unary::Sin, x)).is_some_and(|sine| needed[sine.index()])
            }
            Node::Unary(Unary::Neg | Unary::Abs | Unary::Sign | Unary::Step | Unary::Sqrt, _) => false,
            Node::Unary(..) | Node::Binary(Binary::Pow | Binary::Atan2 | Binary::Table(_) | Binary::Normal(_), ..) => {
                true
            }
            _ => false,
        };
        functions += usize::from(alone && depths.varies(graph, id));
    }
    SINE_PAIR * functions as f64 + (OPERATION * count).max(WAITING * f64::from(longest) + BESIDE * count)
}

/// Nanoseconds of a loop over the packed triangle of M, with M and h before it.
pub(super) fn time_of_loop(graph: &Graph, n: usize, roots: &[Id]) -> f64 {
    time_with(graph, roots, dense_operations(n))
}

/// Nanoseconds of a loop of so many operations, with these roots before it.
pub(super) fn time_with(graph: &Graph, roots: &[Id], dense: usize) -> f64 {
    time(graph, roots) + OPERATION * dense as f64
}
