//! Factors that depend on parameters only, gathered into one, so that they are computed once per run; and quotients that do not overflow.

use super::count::varying;
use crate::expr::{Binary, Graph, Id, Node, rewrite, without_overflow};

/// In every product the constant factors become one: ((1/2) x) m is (m/2) x; and a quotient by a constant
/// becomes a product with its reciprocal.
pub(super) fn gather(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let roots = &without_overflow(graph, roots);
    let mut varies = varying(graph);
    rewrite(graph, roots, |graph, node| {
        let product = match node {
            Node::Binary(Binary::Mul, x, y) => {
                extend(graph, &mut varies);
                let (mut c, mut p) = split(graph, &varies, x);
                let (mut d, mut q) = split(graph, &varies, y);
                // A quotient gives its constant where there is another one.
                if d != Id::ONE {
                    (c, p) = above(graph, &varies, (c, p));
                } else if c != Id::ONE {
                    (d, q) = above(graph, &varies, (d, q));
                }
                extend(graph, &mut varies);
                let coefficient = graph.mul(c, d);
                let rest = match (p, q) {
                    (Some(p), Some(q)) if coefficient != Id::ONE || (c, d) != (Id::ONE, Id::ONE) => graph.mul(p, q),
                    (Some(_), Some(_)) | (None, None) => return None,
                    (Some(p), None) | (None, Some(p)) => p,
                };
                (coefficient, rest)
            }
            Node::Binary(Binary::Div, x, y) => {
                extend(graph, &mut varies);
                if varies[y.index()] || !varies[x.index()] {
                    return None;
                }
                let reciprocal = graph.div(Id::ONE, y);
                let (c, p) = split(graph, &varies, x);
                let (c, p) = above(graph, &varies, (c, p));
                extend(graph, &mut varies);
                (graph.mul(c, reciprocal), p?)
            }
            _ => return None,
        };
        let (coefficient, rest) = product;
        if coefficient == Id::ONE {
            return Some(rest);
        }
        // c (1/x) is c/x.
        if let Node::Binary(Binary::Div, Id::ONE, denominator) = graph.node(rest) {
            return Some(graph.div(coefficient, denominator));
        }
        // The sign stays outside, where it is free.
        if let Node::Unary(crate::expr::Unary::Neg, positive) = graph.node(coefficient) {
            let value = graph.mul_as_is(positive, rest);
            return Some(graph.neg(value));
        }
        Some(graph.mul_as_is(coefficient, rest))
    })
}

/// The constant and the varying factor of a node whose own products have been gathered.
fn split(graph: &Graph, varies: &[bool], id: Id) -> (Id, Option<Id>) {
    if !varies[id.index()] {
        return (id, None);
    }
    match graph.node(id) {
        Node::Binary(Binary::Mul, c, x) if !varies[c.index()] => (c, Some(x)),
        Node::Binary(Binary::Mul, x, c) if !varies[c.index()] => (c, Some(x)),
        _ => (Id::ONE, Some(id)),
    }
}

/// c · 1/x for c/x.
fn above(graph: &mut Graph, varies: &[bool], (c, x): (Id, Option<Id>)) -> (Id, Option<Id>) {
    match x.map(|x| graph.node(x)) {
        Some(Node::Binary(Binary::Div, d, y)) if c == Id::ONE && d != Id::ONE && !varies[d.index()] => {
            (d, Some(graph.div(Id::ONE, y)))
        }
        _ => (c, x),
    }
}

/// Learns which of the nodes made since vary.
fn extend(graph: &Graph, varies: &mut Vec<bool>) {
    for i in varies.len()..graph.len() {
        let id = graph.id_at(i);
        let varies_now = match graph.node(id) {
            Node::Symbol(s) => !matches!(s, crate::expr::Symbol::Parameter(_)),
            _ => graph.children(id).any(|c| varies[c.index()]),
        };
        varies.push(varies_now);
    }
}
