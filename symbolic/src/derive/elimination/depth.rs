//! How long chains of operations are that wait for each other.

use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// Cycles from the operands of an operation to its result, on processors of today (Fog, Instruction tables, 2022).
const ADDITION: u32 = 4;
/// Of a division or a root.
const DIVISION: u32 = 13;
/// Of a sine, and of any other function.
const FUNCTION: u32 = 40;

/// For every node, the cycles of the longest chain that ends in it; what depends on parameters only is there from the start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Depths {
    known: Vec<u32>,
    varies: Vec<bool>,
}

impl Depths {
    /// Whether a node changes along a run.
    pub fn varies(&mut self, graph: &Graph, id: Id) -> bool {
        self.of(graph, id);
        self.varies[id.index()]
    }

    /// a b, where a constant and the constant factor of a product become one that is computed once per run.
    pub fn product(&mut self, graph: &mut Graph, a: Id, b: Id) -> Id {
        let (varying, constant) = match [a, b].map(|x| self.varies(graph, x)) {
            [true, false] => (a, b),
            [false, true] => (b, a),
            _ => return graph.mul(a, b),
        };
        let (negative, inner) = match graph.node(varying) {
            Node::Unary(Unary::Neg, x) => (true, x),
            _ => (false, varying),
        };
        let (factor, rest) = match graph.node(inner) {
            Node::Binary(Binary::Mul, x, y) if !self.varies(graph, x) => (x, y),
            Node::Binary(Binary::Mul, x, y) if !self.varies(graph, y) => (y, x),
            _ => return graph.mul(a, b),
        };
        let together = graph.mul(factor, constant);
        let product = if together == Id::ONE { rest } else { graph.mul_as_is(together, rest) };
        if negative { graph.neg(product) } else { product }
    }

    /// Of one node.
    pub fn of(&mut self, graph: &Graph, id: Id) -> u32 {
        for place in self.known.len()..graph.len() {
            let node = graph.id_at(place);
            let children = || graph.children(node);
            let varies = match graph.node(node) {
                Node::Symbol(symbol) => !matches!(symbol, Symbol::Parameter(_)),
                _ => children().any(|child| self.varies[child.index()]),
            };
            let takes = match graph.node(node) {
                Node::Number(_) | Node::Symbol(_) | Node::Unary(Unary::Neg | Unary::Abs, _) => 0,
                Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Div, ..) => DIVISION,
                Node::Binary(Binary::Pow | Binary::Atan2 | Binary::Table(_) | Binary::Normal(_), ..)
                | Node::Unary(..) => FUNCTION,
                Node::Binary(..) => ADDITION,
            };
            let before = children().map(|child| self.known[child.index()]).max().unwrap_or(0);
            self.known.push(if varies { before + takes } else { 0 });
            self.varies.push(varies);
        }
        self.known[id.index()]
    }
}
