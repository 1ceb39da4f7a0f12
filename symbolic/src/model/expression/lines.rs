//! What is linear in a bound variable.

use super::facts::Facts;
use super::substitute::{Known, bottom_up};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// The values of x at which something vanishes, or the sides of a `min` or `max` meet, that is linear in x.
pub fn roots_of_linear(graph: &mut Graph, facts: &mut Facts, root: Id, x: Symbol) -> Vec<Id> {
    /// s and c of s x + c.
    type Line = Option<(Id, Id)>;
    let mut lines = Vec::new();
    let leaf = |id: Id| Some((Id::ZERO, id));
    let _: Option<(Line, u64)> = bottom_up(graph, facts, root, leaf, |graph, _, id, known: &Known<Line>| {
        let line: Line = match graph.node(id) {
            Node::Symbol(s) if s == x => Some((Id::ONE, Id::ZERO)),
            Node::Unary(Unary::Neg, a) => known[&a].map(|(s, c)| (graph.neg(s), graph.neg(c))),
            Node::Binary(operation @ (Binary::Add | Binary::Sub | Binary::Min | Binary::Max), a, b) => {
                let join = if operation == Binary::Add { Graph::add } else { Graph::sub };
                let both = known[&a].zip(known[&b]);
                let line = both.map(|((s, c), (r, d))| (join(graph, s, r), join(graph, c, d)));
                if matches!(operation, Binary::Min | Binary::Max) {
                    lines.extend(line);
                    return Some(None);
                }
                line
            }
            Node::Binary(Binary::Mul, a, b) => match known[&a].zip(known[&b]) {
                Some(((Id::ZERO, f), (s, c))) | Some(((s, c), (Id::ZERO, f))) => {
                    Some((graph.mul(f, s), graph.mul(f, c)))
                }
                _ => None,
            },
            Node::Binary(Binary::Div, a, b) => match known[&a].zip(known[&b]) {
                Some(((s, c), (Id::ZERO, f))) => Some((graph.div(s, f), graph.div(c, f))),
                _ => None,
            },
            _ => graph.children(id).all(|a| known[&a].is_some_and(|(s, _)| s == Id::ZERO)).then_some((Id::ZERO, id)),
        };
        lines.extend(line);
        Some(line)
    });
    lines.retain(|(s, _)| *s != Id::ZERO);
    let root = |(s, c): (Id, Id)| {
        let quotient = graph.div(c, s);
        graph.neg(quotient)
    };
    lines.into_iter().map(root).collect()
}
