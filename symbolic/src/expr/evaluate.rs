//! Evaluating expressions in `f64`.

use super::{Binary, Graph, Id, Node, Symbol, Unary};

/// A list of instructions that evaluates some expressions of a graph: the nodes they need, once each.
#[derive(Clone, Debug)]
pub struct Tape {
    steps: Vec<Instruction>,
    results: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
enum Instruction {
    Number(f64),
    Symbol(Symbol),
    Unary(Unary, u32),
    Binary(Binary, u32, u32),
}

impl Tape {
    /// The instructions for these roots.
    pub fn new(graph: &Graph, roots: &[Id]) -> Tape {
        let needed = graph.reachable(roots.iter().copied());
        let mut place = vec![u32::MAX; needed.len()];
        let mut steps = Vec::new();
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let step = match graph.node(graph.id_at(i)) {
                Node::Number(n) => Instruction::Number(graph.number_at(n).to_f64()),
                Node::Symbol(s) => Instruction::Symbol(s),
                Node::Unary(f, x) => Instruction::Unary(f, place[x.index()]),
                Node::Binary(f, x, y) => Instruction::Binary(f, place[x.index()], place[y.index()]),
            };
            place[i] = steps.len() as u32;
            steps.push(step);
        }
        Tape { steps, results: roots.iter().map(|r| place[r.index()]).collect() }
    }

    /// How many numbers `run` writes.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// True when there is nothing to compute.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Evaluates; `scratch` is reused between calls.
    pub fn run(&self, value: impl Fn(Symbol) -> f64, scratch: &mut Vec<f64>, results: &mut [f64]) {
        scratch.clear();
        for step in &self.steps {
            let x = match *step {
                Instruction::Number(x) => x,
                Instruction::Symbol(s) => value(s),
                Instruction::Unary(f, x) => apply_unary(f, scratch[x as usize]),
                Instruction::Binary(f, x, y) => apply_binary(f, scratch[x as usize], scratch[y as usize]),
            };
            scratch.push(x);
        }
        for (result, place) in results.iter_mut().zip(&self.results) {
            *result = scratch[*place as usize];
        }
    }

    /// Evaluates into a new vector.
    pub fn evaluate(&self, value: impl Fn(Symbol) -> f64) -> Vec<f64> {
        let mut results = vec![0.0; self.results.len()];
        self.run(value, &mut Vec::with_capacity(self.steps.len()), &mut results);
        results
    }
}

/// A function of one argument, in `f64`; `sign(0)` is 0 and `step(0)` is 1.
pub fn apply_unary(function: Unary, x: f64) -> f64 {
    match function {
        Unary::Neg => -x,
        Unary::Sqrt => x.sqrt(),
        Unary::Sin => x.sin(),
        Unary::Cos => x.cos(),
        Unary::Tan => x.tan(),
        Unary::Asin => x.asin(),
        Unary::Acos => x.acos(),
        Unary::Atan => x.atan(),
        Unary::Sinh => x.sinh(),
        Unary::Cosh => x.cosh(),
        Unary::Tanh => x.tanh(),
        Unary::Exp => x.exp(),
        Unary::Ln => x.ln(),
        Unary::Abs => x.abs(),
        Unary::Sign if x == 0.0 => 0.0,
        Unary::Sign => x.signum(),
        Unary::Step if x.is_nan() => x,
        Unary::Step => f64::from(u8::from(x >= 0.0)),
    }
}

/// An operation on two arguments, in `f64`.
pub fn apply_binary(operation: Binary, x: f64, y: f64) -> f64 {
    match operation {
        Binary::Add => x + y,
        Binary::Sub => x - y,
        Binary::Mul => x * y,
        Binary::Div => x / y,
        Binary::Pow => x.powf(y),
        Binary::Atan2 => x.atan2(y),
        Binary::Min => x.min(y),
        Binary::Max => x.max(y),
    }
}
