//! Rebuilding expressions with some nodes replaced.

use rustc_hash::FxHashMap as HashMap;

use super::places::Places;
use super::{Graph, Id, Node, Symbol};

/// Rebuilds expressions from the leaves up.  `replace` sees each node with its children already rebuilt
/// and may give another expression for it; otherwise the constructors simplify anew.
pub fn rewrite(graph: &mut Graph, roots: &[Id], mut replace: impl FnMut(&mut Graph, Node) -> Option<Id>) -> Vec<Id> {
    let needed = Places::new(graph.needed(roots.iter().copied()));
    let mut image: Vec<Id> = Vec::with_capacity(needed.list().len());
    for &id in needed.list() {
        let node = match graph.node(id) {
            Node::Unary(f, x) => Node::Unary(f, image[needed.of(x)]),
            Node::Binary(f, x, y) => Node::Binary(f, image[needed.of(x)], image[needed.of(y)]),
            leaf => leaf,
        };
        let new = match replace(graph, node) {
            Some(other) => other,
            None => graph.rebuilt(id, |x| image[needed.of(x)]),
        };
        image.push(new);
    }
    roots.iter().map(|r| image[needed.of(*r)]).collect()
}

/// Expressions of one graph built again in another one, which may be a small one: what is tried there leaves nothing in the first.
pub fn copied(from: &Graph, roots: &[Id], into: &mut Graph) -> Vec<Id> {
    let needed = Places::new(from.needed(roots.iter().copied()));
    let mut image: Vec<Id> = Vec::with_capacity(needed.list().len());
    for &id in needed.list() {
        let of = |x: Id| image[needed.of(x)];
        image.push(match from.node(id) {
            Node::Number(place) => into.constant(from.number_at(place)),
            Node::Symbol(symbol) => into.symbol(symbol),
            Node::Unary(f, x) => into.unary(f, of(x)),
            Node::Binary(f, x, y) => into.binary(f, of(x), of(y)),
        });
    }
    roots.iter().map(|r| image[needed.of(*r)]).collect()
}

/// Puts expressions in the place of symbols.
pub fn substitute(graph: &mut Graph, roots: &[Id], values: &HashMap<Symbol, Id>) -> Vec<Id> {
    rewrite(graph, roots, |_, node| match node {
        Node::Symbol(s) => values.get(&s).copied(),
        _ => None,
    })
}
