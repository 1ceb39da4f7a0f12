//! Evaluating expressions in `f64`, in double-double, and with the magnitudes of their rounding errors.

use super::places::Places;
use super::scalar::Scalar;
use super::schedule::{Batch, Operation, schedule};
use super::{Binary, Graph, Id, Measured, Node, Symbol, Unary};
use crate::number::DoubleDouble;

/// A list of instructions that evaluates some expressions of a graph: the nodes they need, once each.
///
/// Values stand in one array: those of constants, then of symbols, then one of each operation.  Equal operations stand together as far as
/// what they need allows, so that what to do next is looked up once for many of them.  The same list serves every [`Scalar`].
#[derive(Clone, Debug)]
pub struct Tape {
    constants: Vec<DoubleDouble>,
    symbols: Vec<Symbol>,
    batches: Vec<Batch>,
    /// The places of what each operation takes; twice the same where it takes one.
    operands: Vec<[u32; 2]>,
    results: Vec<u32>,
}

impl Tape {
    /// The instructions for these roots.
    pub fn new(graph: &Graph, roots: &[Id]) -> Tape {
        let needed = Places::new(graph.needed(roots.iter().copied()));
        let (mut constants, mut symbols) = (Vec::new(), Vec::new());
        for id in needed.list() {
            match graph.node(*id) {
                Node::Number(n) => constants.push(graph.number_at(n).to_double_double()),
                Node::Symbol(s) => symbols.push(s),
                Node::Unary(..) | Node::Binary(..) => {}
            }
        }
        let (order, batches) = schedule(graph, &needed);
        let mut places = vec![0; needed.list().len()];
        let [mut constant, mut symbol] = [0, constants.len()];
        for (place, id) in places.iter_mut().zip(needed.list()) {
            let next = match graph.node(*id) {
                Node::Number(_) => &mut constant,
                Node::Symbol(_) => &mut symbol,
                Node::Unary(..) | Node::Binary(..) => continue,
            };
            *place = *next as u32;
            *next += 1;
        }
        for (k, node) in order.iter().enumerate() {
            places[*node] = (constants.len() + symbols.len() + k) as u32;
        }
        let place = |id: Id| places[needed.of(id)];
        let operands = order.iter().map(|node| match graph.node(needed.list()[*node]) {
            Node::Binary(_, x, y) => [place(x), place(y)],
            Node::Unary(_, x) => [place(x); 2],
            Node::Number(_) | Node::Symbol(_) => [0; 2],
        });
        Tape {
            operands: operands.collect(),
            results: roots.iter().map(|root| place(*root)).collect(),
            constants,
            symbols,
            batches,
        }
    }

    /// How many numbers `run` writes.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// How many values there are: of constants, symbols and operations.
    pub fn operations(&self) -> usize {
        self.constants.len() + self.symbols.len() + self.operands.len()
    }

    /// True when there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Evaluates; `scratch` is reused between calls, which then allocate nothing.
    pub fn run<S: Scalar>(&self, value: impl Fn(Symbol) -> S, scratch: &mut Vec<S>, results: &mut [S]) {
        self.fill(value, scratch);
        results.iter_mut().enumerate().for_each(|(k, result)| *result = self.result(scratch, k));
    }

    /// A result, from an array that [`Tape::fill`] filled.
    pub fn result<S: Scalar>(&self, scratch: &[S], k: usize) -> S {
        scratch[self.results[k] as usize]
    }

    /// Evaluates into the array, of which what stands behind the values of this list stays as it is.
    pub fn fill<S: Scalar>(&self, value: impl Fn(Symbol) -> S, scratch: &mut Vec<S>) {
        if scratch.len() < self.operations() {
            scratch.resize(self.operations(), S::constant(DoubleDouble::ZERO));
        }
        let (constants, rest) = scratch.split_at_mut(self.constants.len());
        constants.iter_mut().zip(&self.constants).for_each(|(slot, x)| *slot = S::constant(*x));
        rest.iter_mut().zip(&self.symbols).for_each(|(slot, s)| *slot = value(*s));
        let mut place = self.constants.len() + self.symbols.len();
        let mut operands = self.operands.as_slice();
        for batch in &self.batches {
            let (these, later) = operands.split_at(batch.length);
            let mut run = Stretch { values: scratch, place, operands: these };
            match batch.operation {
                Operation::Binary(Binary::Add) => run.each(|x, y| S::binary(Binary::Add, x, y)),
                Operation::Binary(Binary::Sub) => run.each(|x, y| S::binary(Binary::Sub, x, y)),
                Operation::Binary(Binary::Mul) => run.each(|x, y| S::binary(Binary::Mul, x, y)),
                Operation::Binary(Binary::Div) => run.each(|x, y| S::binary(Binary::Div, x, y)),
                Operation::Binary(other) => run.each(|x, y| S::binary(other, x, y)),
                Operation::Unary(function) => run.each(|x, _| S::unary(function, x)),
            }
            place += batch.length;
            operands = later;
        }
    }

    /// Evaluates into a new vector.
    pub fn evaluate<S: Scalar>(&self, value: impl Fn(Symbol) -> S) -> Vec<S> {
        let mut results = vec![S::constant(DoubleDouble::ZERO); self.results.len()];
        self.run(value, &mut Vec::new(), &mut results);
        results
    }

    /// Evaluates in double-double with running magnitudes, leaves being exact: the measure of each result by itself.
    pub fn measured(&self, value: impl Fn(Symbol) -> DoubleDouble) -> Vec<Measured> {
        self.evaluate(|symbol| Measured::exact(value(symbol)))
    }

    /// Whether, in the run that filled `scratch`, rounding may have decided a `sign` or a `step`: its argument was
    /// within `roundings` roundings of 0.  Such results are not wrong by a rounding but by 1 or 2.
    pub fn undecided(&self, scratch: &[Measured], roundings: f64) -> bool {
        let mut operands = self.operands.as_slice();
        self.batches.iter().any(|batch| {
            let (these, later) = operands.split_at(batch.length);
            operands = later;
            matches!(batch.operation, Operation::Unary(Unary::Sign | Unary::Step))
                && these.iter().any(|[x, _]| scratch[*x as usize].vanishes(roundings))
        })
    }
}

/// Operations of one kind: what they take, and from which place on their values stand.
struct Stretch<'a, S> {
    values: &'a mut [S],
    place: usize,
    operands: &'a [[u32; 2]],
}

impl<S: Scalar> Stretch<'_, S> {
    fn each(&mut self, operation: impl Fn(S, S) -> S) {
        for (k, [x, y]) in self.operands.iter().enumerate() {
            self.values[self.place + k] = operation(self.values[*x as usize], self.values[*y as usize]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_list_serves_all_scalars() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let third = g.rational(crate::number::Rational::new(1, 3).unwrap());
        let sine = g.unary(Unary::Sin, x);
        let product = g.mul(third, sine);
        let root = g.unary(Unary::Sqrt, product);
        let tape = Tape::new(&g, &[root]);
        let short = tape.evaluate(|_| 0.7)[0];
        let long = tape.evaluate(|_| DoubleDouble::from(0.7))[0];
        // √(sin(0.7)/3) with 0.7 the float, from 40 digits.
        let exact = DoubleDouble::from_decimal("0.463399642942493364090657075582340264").unwrap();
        assert!((short - exact.to_f64()).abs() < 1e-15);
        assert!((long - exact).abs().to_f64() < 1e-31, "{long:?}");
        assert_eq!(tape.measured(|_| 0.7.into())[0].value, long);
    }

    #[test]
    fn a_switch_within_rounding_of_zero_is_undecided() {
        let mut g = Graph::new();
        let x = g.symbol(Symbol::Coordinate(0));
        let three = g.integer(3);
        let tenth = g.rational(crate::number::Rational::new(1, 10).unwrap());
        let (product, part) = (g.mul(three, x), g.rational(crate::number::Rational::new(3, 10).unwrap()));
        let difference = g.sub(product, part);
        let step = g.unary(Unary::Step, difference);
        let tape = Tape::new(&g, &[step, tenth]);
        let mut scratch = Vec::new();
        let mut results = [Measured::exact(DoubleDouble::ZERO); 2];
        let mut undecided = |x: DoubleDouble| {
            tape.run(|_| Measured::exact(x), &mut scratch, &mut results);
            tape.undecided(&scratch, 10.0)
        };
        assert!(undecided(DoubleDouble::ONE / 10.0.into()));
        assert!(!undecided(0.1.into()));
        assert!(!undecided(0.3.into()));
    }
}
