//! Expressions that are 0 whatever their symbols are, but for the rounding of the numbers in them.
//!
//! The product of two axes that are turned by 0.4 rad alike is cos² 0.4 + sin² 0.4, which is 1 only to 32 digits: what should be the zero of a row
//! of a constraint is 1e-33, and a row of nothing else would count like any other wherever rows are brought to one size.

use rustc_hash::FxHashMap as HashMap;

use crate::expr::{Graph, Id, Symbol, Tape};
use crate::number::DoubleDouble;
use crate::random::Random;

/// So often an expression must be 0 at numbers that are drawn; what has a value anywhere has one at the first of them.
const TIMES: usize = 4;
/// It is 0 within so many roundings of its terms.
const ROUNDINGS: f64 = 64.0;

/// Zeros in the places of the expressions that vanish identically.
pub fn without_vanishing(graph: &Graph, roots: &[Id]) -> Vec<Id> {
    // A table is 0 beyond its last point, and has values all the same.
    let pieces = graph.has_pieces();
    let may_vanish = |root: Id| root != Id::ZERO && !pieces[root.index()];
    let mut left: Vec<usize> = (0..roots.len()).filter(|k| may_vanish(roots[*k])).collect();
    let mut random = Random::new();
    for _ in 0..TIMES {
        let asked: Vec<Id> = left.iter().map(|k| roots[*k]).collect();
        if asked.is_empty() {
            return roots.to_vec();
        }
        let symbols = graph.symbols(asked.iter().copied());
        let drawn: HashMap<Symbol, f64> =
            symbols.into_iter().map(|symbol| (symbol, random.between(0.2, 1.4))).collect();
        let found = Tape::new(graph, &asked).measured(|symbol| DoubleDouble::from(drawn[&symbol]));
        // Where terms are too small to have any size their sum may be anything.
        let zero: Vec<bool> = found.iter().map(|x| x.magnitude > 0.0 && x.vanishes(ROUNDINGS)).collect();
        let mut zero = zero.into_iter();
        left.retain(|_| zero.next() == Some(true));
    }
    let gone = |(k, root): (usize, &Id)| if left.contains(&k) { Id::ZERO } else { *root };
    roots.iter().enumerate().map(gone).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::{Smooth, Table, Unary};

    #[test]
    fn what_is_zero_for_any_numbers_is_zero() {
        let mut graph = Graph::new();
        let (x, angle) = (graph.symbol(Symbol::Coordinate(0)), graph.float(0.4));
        let (sin, cos) = (graph.unary(Unary::Sin, angle), graph.unary(Unary::Cos, angle));
        let (sin, cos) = (graph.mul(sin, sin), graph.mul(cos, cos));
        let one = graph.add(sin, cos);
        let nothing = graph.sub(one, Id::ONE);
        let vanishing = graph.mul(nothing, x);
        let little = graph.float(1e-20);
        let small = graph.mul(little, x);
        let found = without_vanishing(&graph, &[vanishing, small, x, Id::ZERO]);
        assert_eq!(found, [Id::ZERO, small, x, Id::ZERO]);
    }

    #[test]
    fn what_is_zero_elsewhere_only_stays() {
        let mut graph = Graph::new();
        let x = graph.symbol(Symbol::Coordinate(0));
        let track = Table::new("track", &[[0.0, 0.0], [1e-3, 1e-4], [2e-3, 0.0]], Smooth::Twice, false);
        let bend = track.derivative().and_then(Table::derivative).expect("a table with two derivatives");
        let (bend, beside) = (graph.unary(Unary::Table(bend), x), graph.float(1e-6));
        let parts = graph.div(x, beside);
        let square = graph.mul(parts, parts);
        let negative = graph.neg(square);
        let narrow = graph.unary(Unary::Exp, negative);
        assert_eq!(without_vanishing(&graph, &[bend, narrow]), [bend, narrow]);
    }
}
