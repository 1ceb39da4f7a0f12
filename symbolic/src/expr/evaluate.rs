//! Evaluating expressions in `f64`, in double-double, and with the magnitudes of their rounding errors.

use super::places::Places;
use super::scalar::Scalar;
use super::{Binary, Graph, Id, Measured, Node, Symbol, Unary};
use crate::number::DoubleDouble;

/// A list of instructions that evaluates some expressions of a graph: the nodes they need, once each.
///
/// The same list serves every [`Scalar`].
#[derive(Clone, Debug)]
pub struct Tape {
    steps: Vec<Instruction>,
    results: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
enum Instruction {
    Number(DoubleDouble),
    Symbol(Symbol),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
}

impl Tape {
    /// The instructions for these roots.
    pub fn new(graph: &Graph, roots: &[Id]) -> Tape {
        let needed = Places::new(graph.needed(roots.iter().copied()));
        let place = |id: Id| needed.of(id) as u32;
        let step = |id: &Id| match graph.node(*id) {
            Node::Number(n) => Instruction::Number(graph.number_at(n).to_double_double()),
            Node::Symbol(s) => Instruction::Symbol(s),
            Node::Unary(f, x) => Instruction::Unary(f, place(x)),
            Node::Binary(f, x, y) => Instruction::Binary(f, place(x), place(y)),
        };
        Tape { steps: needed.list().iter().map(step).collect(), results: roots.iter().map(|r| place(*r)).collect() }
    }

    /// How many numbers `run` writes.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// How many instructions there are.
    pub fn operations(&self) -> usize {
        self.steps.len()
    }

    /// True when there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Evaluates; `scratch` is reused between calls, which then allocate nothing.
    pub fn run<S: Scalar>(&self, value: impl Fn(Symbol) -> S, scratch: &mut Vec<S>, results: &mut [S]) {
        scratch.clear();
        scratch.reserve(self.steps.len());
        for step in &self.steps {
            let x = match *step {
                Instruction::Number(x) => S::constant(x),
                Instruction::Symbol(s) => value(s),
                Instruction::Unary(f, x) => S::unary(f, scratch[x as usize]),
                Instruction::Binary(f, x, y) => S::binary(f, scratch[x as usize], scratch[y as usize]),
            };
            scratch.push(x);
        }
        for (result, place) in results.iter_mut().zip(&self.results) {
            *result = scratch[*place as usize];
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
        self.steps.iter().any(|step| match *step {
            Instruction::Unary(Unary::Sign | Unary::Step, x) => scratch[x as usize].vanishes(roundings),
            _ => false,
        })
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
