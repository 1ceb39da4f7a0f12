//! Counting operations.

use super::candidates::Chosen;
use super::{Accelerations, Entry, jacobian_operations, read_signals};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// Operations of the generated functions; what depends on parameters only is computed once and not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(missing_docs, reason = "named after the functions")]
pub struct Counts {
    pub mass: usize,
    pub bias: usize,
    pub mass_and_bias: usize,
    pub accelerations: usize,
    pub residual: usize,
    pub jacobians: usize,
}

impl Counts {
    /// Counts them; where M and h are `unformed`, by slopes of F.
    pub(super) fn of(
        graph: &Graph,
        n: usize,
        (chosen, accelerations): (&Chosen, &Accelerations),
        (stiffness, damping): (&[Entry], &[Entry]),
        signals: &[[Id; 3]],
        unformed: bool,
    ) -> Counts {
        let masses: Vec<Id> = chosen.mass.iter().map(|e| e.2).collect();
        let mass_and_bias = [masses.as_slice(), &chosen.bias].concat();
        let of_motion = if unformed { &chosen.residual } else { &mass_and_bias };
        let signals = read_signals(graph, signals, of_motion.iter().copied());
        let counts = Counts {
            mass: operations(graph, &masses),
            bias: operations(graph, &chosen.bias),
            mass_and_bias: operations(graph, &mass_and_bias),
            accelerations: accelerations.operations(graph, n, &chosen.mass, &chosen.bias) + operations(graph, &signals),
            residual: operations(graph, &chosen.residual),
            jacobians: jacobian_operations(graph, &chosen.residual, stiffness, damping),
        };
        if unformed { counts.by_slopes(n) } else { counts }
    }

    /// With what M, h and Jacobians take by slopes of F along every acceleration, coordinate and speed.
    fn by_slopes(self, n: usize) -> Counts {
        let f = self.residual;
        Counts { mass: n * f, bias: f, mass_and_bias: (n + 1) * f, jacobians: (2 * n + 1) * f, ..self }
    }
}

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
