//! A system of momentum balances at a state, as numbers.

use super::dense::factor;
use super::state::State;
use crate::derive::momentum::Momentum;
use crate::expr::{Binary, Graph, Id, Measured, Scalar, Symbol, Tape, jacobian};
use crate::model::BalanceSystem;
use crate::number::DoubleDouble;

/// What is no more than this of its magnitude is zero when looking for pivots.
const NOTHING: f64 = 1e-22;

/// Σ matrix·unknowns + rest = 0 at one state.
pub(super) struct Assembled {
    /// How many equations.
    pub equations: usize,
    /// How many of them are balances; the rest are constraints.
    pub judged: usize,
    /// How many unknowns: accelerations, then reactions.
    pub size: usize,
    /// Coefficients, row by row.
    pub matrix: Vec<Measured>,
    /// What is left where all unknowns vanish.
    pub rest: Vec<Measured>,
}

/// One part of one equation of a system, at one state.
#[derive(Clone)]
pub(super) struct Row {
    /// The balance, and the part of it; `usize::MAX` for what belongs to none.
    pub balance: usize,
    pub part: usize,
    pub equation: usize,
    /// Coefficients of the unknowns.
    pub coefficients: Vec<Measured>,
    /// The rest.
    pub rest: Measured,
}

impl Row {
    /// A part that belongs to no balance of the file.
    pub fn known(equation: usize, coefficients: Vec<Measured>, rest: Measured) -> Row {
        Row { balance: usize::MAX, part: usize::MAX, equation, coefficients, rest }
    }
}

/// 0, exactly.
pub(super) fn zero() -> Measured {
    Measured::exact(DoubleDouble::ZERO)
}

/// x + y.
pub(super) fn plus(x: Measured, y: Measured) -> Measured {
    Measured::binary(Binary::Add, x, y)
}

/// x y.
pub(super) fn times(x: Measured, y: Measured) -> Measured {
    Measured::binary(Binary::Mul, x, y)
}

impl Assembled {
    fn new(equations: usize, size: usize) -> Assembled {
        Assembled {
            equations,
            judged: equations,
            size,
            matrix: vec![zero(); equations * size],
            rest: vec![zero(); equations],
        }
    }

    /// A system as it was derived, at every state.
    pub fn derived(graph: &Graph, linear: &Momentum, states: &[State]) -> Vec<Assembled> {
        let entries = linear.matrix.iter().map(|e| e.2);
        let tape = Tape::new(graph, &entries.chain(linear.right.iter().copied()).collect::<Vec<Id>>());
        let (mut values, mut scratch) = (vec![zero(); tape.len()], Vec::new());
        let at = |state: &State| {
            tape.run(|s| state.measured(s), &mut scratch, &mut values);
            let mut system = Assembled::new(linear.right.len(), linear.unknowns.len());
            system.judged -= linear.constraints;
            for ((i, j, _), value) in linear.matrix.iter().zip(&values) {
                system.matrix[i * system.size + j] = *value;
            }
            for (rest, b) in system.rest.iter_mut().zip(&values[linear.matrix.len()..]) {
                *rest = Measured { value: -b.value, magnitude: b.magnitude };
            }
            system
        };
        states.iter().map(at).collect()
    }

    /// The sum of parts, one of them scaled.
    pub fn of(rows: &[Row], equations: usize, size: usize, changed: Option<(usize, usize, f64)>) -> Assembled {
        let mut system = Assembled::new(equations, size);
        for row in rows {
            let factor = match changed {
                Some((balance, part, factor)) if (balance, part) == (row.balance, row.part) => factor,
                _ => 1.0,
            };
            let factor = Measured::exact(DoubleDouble::from(factor));
            let line = &mut system.matrix[row.equation * size..][..size];
            for (sum, c) in line.iter_mut().zip(&row.coefficients) {
                *sum = plus(*sum, times(factor, *c));
            }
            let rest = &mut system.rest[row.equation];
            *rest = plus(*rest, times(factor, row.rest));
        }
        system
    }

    /// The unknowns with the scale of their errors; `None` where they are not determined.
    pub fn solution(&self) -> Option<Vec<Measured>> {
        if self.equations != self.size {
            return None;
        }
        let matrix: Vec<DoubleDouble> = self.matrix.iter().map(|m| m.value).collect();
        let sizes: Vec<f64> = self.matrix.iter().map(|m| m.magnitude).collect();
        let finite = |x: &Measured| x.value.is_finite() && x.magnitude.is_finite();
        if !self.matrix.iter().chain(&self.rest).all(finite) {
            return None;
        }
        let factored = factor(&matrix, &sizes, self.size).ok()?;
        let right: Vec<DoubleDouble> = self.rest.iter().map(|x| -x.value).collect();
        let found = factored.solve(&right);
        let lines = sizes.chunks(self.size.max(1)).zip(&self.rest);
        let error = |(line, rest): (&[f64], &Measured)| {
            line.iter().zip(&found).map(|(m, x)| m * x.to_f64().abs()).sum::<f64>() + rest.magnitude
        };
        let felt = factored.spread(&lines.map(error).collect::<Vec<f64>>());
        let measured =
            |(value, felt): (&DoubleDouble, f64)| Measured { value: *value, magnitude: felt.max(value.to_f64().abs()) };
        Some(found.iter().zip(felt).map(measured).collect())
    }

    /// What known accelerations leave of the equations once the reactions are eliminated: (equation, residual).
    ///
    /// Each reaction is taken from the equation that says most sharply what it is: where the coefficient is largest
    /// beside the magnitude of all else in that equation.
    pub fn left_over(&self, accelerations: &[Measured]) -> Vec<(usize, Measured)> {
        let n = accelerations.len();
        let mut rest: Vec<Measured> = Vec::new();
        for (line, constant) in self.matrix.chunks(self.size.max(1)).zip(&self.rest) {
            let terms = line[..n].iter().zip(accelerations).map(|(c, a)| times(*c, *a));
            rest.push(terms.fold(*constant, plus));
        }
        let mut reactions: Vec<Vec<Measured>> =
            self.matrix.chunks(self.size.max(1)).map(|line| line[n..].to_vec()).collect();
        let mut open: Vec<usize> = (0..self.judged).collect();
        for k in 0..self.size - n {
            let sharp = |e: usize| {
                let c = reactions[e][k];
                let size = c.value.to_f64().abs();
                if size <= NOTHING * c.magnitude { 0.0 } else { size / rest[e].magnitude.max(f64::MIN_POSITIVE) }
            };
            let Some(place) = (0..open.len()).max_by(|a, b| sharp(open[*a]).total_cmp(&sharp(open[*b]))) else { break };
            let from = open[place];
            if sharp(from) == 0.0 {
                continue;
            }
            open.swap_remove(place);
            let (pivot, known) = (reactions[from].clone(), rest[from]);
            for &e in &open {
                if reactions[e][k].value == DoubleDouble::ZERO {
                    continue;
                }
                let share = Measured::binary(Binary::Div, reactions[e][k], pivot[k]);
                let factor = Measured { value: -share.value, magnitude: share.magnitude };
                rest[e] = plus(rest[e], times(factor, known));
                for c in k + 1..pivot.len() {
                    reactions[e][c] = plus(reactions[e][c], times(factor, pivot[c]));
                }
                reactions[e][k] = zero();
            }
        }
        open.sort_unstable();
        let constraints = self.judged..self.equations;
        open.into_iter().chain(constraints).map(|e| (e, rest[e])).collect()
    }
}

/// Every part of every equation at every state.
pub(super) fn evaluate(
    graph: &mut Graph,
    system: &BalanceSystem,
    columns: &[Symbol],
    states: &[State],
) -> Vec<Vec<Row>> {
    let mut shape = Vec::new();
    let mut values = Vec::new();
    let mut equation = 0;
    for (b, balance) in system.balances.iter().enumerate() {
        for (p, part) in balance.parts.iter().enumerate() {
            for (k, value) in part.value.iter().enumerate() {
                shape.push((b, p, equation + k));
                values.push(*value);
            }
        }
        equation += balance.components;
    }
    let place = |s: Symbol| columns.iter().position(|c| *c == s);
    let slopes = jacobian(graph, &values, place);
    let roots: Vec<Id> = values.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(graph, &roots);
    let at = |state: &State| {
        // The unknowns at zero: what is left is the rest.
        let known = |s: Symbol| if place(s).is_some() { zero() } else { state.measured(s) };
        let numbers = tape.evaluate(known);
        let mut slope = numbers[values.len()..].iter();
        let mut rows = Vec::with_capacity(shape.len());
        for (k, &(balance, part, equation)) in shape.iter().enumerate() {
            let mut coefficients = vec![zero(); columns.len()];
            for (column, _) in &slopes[k] {
                coefficients[*column] = slope.next().copied().unwrap_or_else(zero);
            }
            rows.push(Row { balance, part, equation, coefficients, rest: numbers[k] });
        }
        rows
    };
    states.iter().map(at).collect()
}
