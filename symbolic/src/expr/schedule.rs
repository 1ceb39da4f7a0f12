//! In which order operations are computed.

use std::collections::VecDeque;

use super::places::Places;
use super::{Binary, Graph, Id, Node, Unary};

/// What an operation does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// With one value.
    Unary(Unary),
    /// With two.
    Binary(Binary),
}

/// Equal operations, one after the other.
#[derive(Clone, Copy, Debug)]
pub struct Batch {
    /// What all of them do.
    pub operation: Operation,
    /// How many there are.
    pub length: usize,
}

/// Operations of one kind whose operands are there, by their places among the nodes.
struct Ready {
    operation: Operation,
    nodes: VecDeque<usize>,
}

/// The operations among some nodes, by their places there, each after what it takes, and the batches they form: the kind of which most are ready
/// comes next, until none of it is ready.
pub fn schedule(graph: &Graph, needed: &Places) -> (Vec<usize>, Vec<Batch>) {
    let nodes = needed.list();
    let mut missing = vec![0_u32; nodes.len()];
    let mut users = Users::new(nodes.len());
    let mut ready: Vec<Ready> = Vec::new();
    let mut kinds = vec![0; nodes.len()];
    for (place, id) in nodes.iter().enumerate() {
        let (operation, operands) = match graph.node(*id) {
            Node::Number(_) | Node::Symbol(_) => continue,
            Node::Unary(f, x) => (Operation::Unary(f), [Some(x), None]),
            Node::Binary(f, x, y) => (Operation::Binary(f), [Some(x), Some(y)]),
        };
        kinds[place] = ready.iter().position(|other| other.operation == operation).unwrap_or_else(|| {
            ready.push(Ready { operation, nodes: VecDeque::new() });
            ready.len() - 1
        });
        for operand in operands.into_iter().flatten().filter(|operand| is_operation(graph, *operand)) {
            missing[place] += 1;
            users.add(needed.of(operand), place);
        }
        if missing[place] == 0 {
            ready[kinds[place]].nodes.push_back(place);
        }
    }
    let (mut order, mut batches) = (Vec::new(), Vec::new());
    while let Some(kind) = (0..ready.len()).max_by_key(|k| (ready[*k].nodes.len(), ready.len() - k)) {
        let begun = order.len();
        while let Some(node) = ready[kind].nodes.pop_front() {
            order.push(node);
            for user in users.of(node) {
                missing[user] -= 1;
                if missing[user] == 0 {
                    ready[kinds[user]].nodes.push_back(user);
                }
            }
        }
        if order.len() == begun {
            break;
        }
        batches.push(Batch { operation: ready[kind].operation, length: order.len() - begun });
    }
    (order, batches)
}

fn is_operation(graph: &Graph, id: Id) -> bool {
    matches!(graph.node(id), Node::Unary(..) | Node::Binary(..))
}

/// Which nodes take a node's value: lists that are linked through one array.
struct Users {
    first: Vec<u32>,
    /// A user, and where the next one stands.
    links: Vec<(u32, u32)>,
}

impl Users {
    const END: u32 = u32::MAX;

    fn new(nodes: usize) -> Users {
        Users { first: vec![Users::END; nodes], links: Vec::new() }
    }

    fn add(&mut self, node: usize, user: usize) {
        self.links.push((user as u32, self.first[node]));
        self.first[node] = self.links.len() as u32 - 1;
    }

    fn of(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        let mut next = self.first[node];
        std::iter::from_fn(move || {
            let (user, after) = *self.links.get(next as usize)?;
            next = after;
            Some(user as usize)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Symbol;

    #[test]
    fn equal_operations_stand_together_after_what_they_take() {
        let mut g = Graph::new();
        let terms: Vec<Id> = (0..9)
            .map(|k| {
                let x = g.symbol(Symbol::Coordinate(k));
                let sine = g.unary(Unary::Sin, x);
                g.mul(sine, x)
            })
            .collect();
        let sum = terms[1..].iter().fold(terms[0], |sum, term| g.add(sum, *term));
        let needed = Places::new(g.needed([sum]));
        let (order, batches) = schedule(&g, &needed);
        let told: Vec<(Operation, usize)> = batches.iter().map(|batch| (batch.operation, batch.length)).collect();
        let (sin, mul, add) =
            (Operation::Unary(Unary::Sin), Operation::Binary(Binary::Mul), Operation::Binary(Binary::Add));
        assert_eq!(told, [(sin, 9), (mul, 9), (add, 8)]);
        let done = |node: usize| order.iter().position(|other| *other == node);
        for (k, node) in order.iter().enumerate() {
            if let Node::Binary(_, x, y) = g.node(needed.list()[*node]) {
                assert!([x, y].into_iter().all(|id| done(needed.of(id)).is_none_or(|before| before < k)));
            }
        }
    }
}
