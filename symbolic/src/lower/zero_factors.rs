//! Parameters by which all is multiplied that an expression has a part in: where one of them is 0, it has none.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

type Parameters = BTreeSet<u32>;

/// The parameters, by their places, that multiply each node wherever these roots contain it; roots have none.
///
/// What takes no zero factor to vanish (an exponent, say) passes none on: a node may have more of them than are found.
pub(super) fn gates(graph: &Graph, roots: &[Id]) -> HashMap<Id, Parameters> {
    let needed = graph.needed(roots.iter().copied());
    let mut factors: HashMap<Id, Parameters> = HashMap::default();
    for &id in &needed {
        let of = |child: Id| factors.get(&child).into_iter().flatten().copied();
        let own: Parameters = match graph.node(id) {
            Node::Symbol(Symbol::Parameter(k)) => [k].into(),
            Node::Unary(Unary::Neg, x) | Node::Binary(Binary::Div, x, _) => of(x).collect(),
            Node::Binary(Binary::Mul, x, y) => of(x).chain(of(y)).collect(),
            _ => continue,
        };
        factors.insert(id, own);
    }
    let beside = |child: Id| factors.get(&child).cloned().unwrap_or_default();
    let mut found: HashMap<Id, Parameters> = roots.iter().map(|root| (*root, Parameters::new())).collect();
    for &id in needed.iter().rev() {
        let Some(own) = found.get(&id).cloned() else { continue };
        let mut pass = |child: Id, more: Parameters| {
            let all: Parameters = own.union(&more).copied().collect();
            found.entry(child).and_modify(|known| known.retain(|k| all.contains(k))).or_insert(all);
        };
        match graph.node(id) {
            Node::Binary(Binary::Mul, x, y) => {
                pass(x, beside(y));
                pass(y, beside(x));
            }
            Node::Binary(Binary::Div, x, y) => {
                pass(x, Parameters::new());
                pass(y, beside(x));
            }
            _ => graph.children(id).for_each(|child| pass(child, Parameters::new())),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_multiplied_by_a_parameter_wherever_it_stands_is_gated_by_it() {
        let mut graph = Graph::default();
        let [k, c, x] = [Symbol::Parameter(0), Symbol::Parameter(1), Symbol::Coordinate(0)].map(|s| graph.symbol(s));
        let root = graph.unary(Unary::Sqrt, x);
        let pull = graph.mul(k, root);
        let drag = graph.div(c, root);
        let scaled = graph.mul(c, pull);
        let of = |roots: &[Id]| gates(&graph, roots).get(&root).map(|set| set.iter().copied().collect::<Vec<_>>());
        assert_eq!(of(&[pull]), Some(vec![0]));
        assert_eq!(of(&[scaled]), Some(vec![0, 1]));
        assert_eq!(of(&[pull, drag]), Some(vec![]));
        assert_eq!(of(&[scaled, drag]), Some(vec![1]));
        assert_eq!(of(&[pull, root]), Some(vec![]));
        assert_eq!(of(&[k]), None);
    }
}
