//! Running magnitudes: how large the terms are of which an expression is made.

use rustc_hash::{FxHashMap as HashMap, FxHashSet as HashSet};

use crate::expr::{Binary, Graph, Id, Node, Unary};

/// Sums of the absolute values of terms: |x + y| ≤ m(x) + m(y), |x y| = m(x) m(y), |x/y| ≤ m(x)/|y|.
///
/// Rounding of an expression is some ε m; what is far below m has cancelled.  Arguments of functions are taken as exact.
#[derive(Default)]
pub(super) struct Magnitudes {
    known: HashMap<Id, Id>,
}

impl Magnitudes {
    /// The magnitude of an expression, as an expression.
    pub fn of(&mut self, graph: &mut Graph, root: Id) -> Id {
        for id in self.unknown(graph, root) {
            let size = self.one(graph, id);
            self.known.insert(id, size);
        }
        self.known[&root]
    }

    /// What an expression needs beyond what is known, children before parents: of many expressions together each node once.
    fn unknown(&self, graph: &Graph, root: Id) -> Vec<Id> {
        let mut found = HashSet::default();
        let mut open = vec![root];
        while let Some(id) = open.pop() {
            if !self.known.contains_key(&id) && found.insert(id) {
                open.extend(graph.children(id));
            }
        }
        let mut list: Vec<Id> = found.into_iter().collect();
        list.sort_unstable();
        list
    }

    fn one(&self, graph: &mut Graph, id: Id) -> Id {
        match graph.node(id) {
            Node::Unary(Unary::Neg, x) => self.known[&x],
            Node::Binary(Binary::Add | Binary::Sub, x, y) => graph.add(self.known[&x], self.known[&y]),
            Node::Binary(Binary::Mul, x, y) if self.cancels(graph, x) || self.cancels(graph, y) => {
                graph.mul(self.known[&x], self.known[&y])
            }
            Node::Binary(Binary::Div, x, y) if self.cancels(graph, x) => {
                let size = graph.unary(Unary::Abs, y);
                graph.div(self.known[&x], size)
            }
            _ => graph.unary(Unary::Abs, id),
        }
    }

    /// True where the magnitude is more than the absolute value.
    fn cancels(&self, graph: &mut Graph, x: Id) -> bool {
        self.known[&x] != graph.unary(Unary::Abs, x)
    }
}
