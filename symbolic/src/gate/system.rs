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

/// A change of a system.
pub(super) enum Change {
    /// Parts of balances, by both their places, times a factor.
    Parts(Vec<(usize, usize)>, f64),
    /// The opposite sign of an unknown, by its place, in one balance.
    Unknown(usize, usize),
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

    /// The sum of parts, some of them changed.
    pub fn of(rows: &[Row], equations: usize, size: usize, change: Option<&Change>) -> Assembled {
        let mut system = Assembled::new(equations, size);
        for row in rows {
            let (factor, turned) = match change {
                Some(Change::Parts(parts, factor)) if parts.contains(&(row.balance, row.part)) => (*factor, None),
                Some(Change::Unknown(balance, column)) if *balance == row.balance => (1.0, Some(*column)),
                _ => (1.0, None),
            };
            let factor = Measured::exact(DoubleDouble::from(factor));
            let line = &mut system.matrix[row.equation * size..][..size];
            for (column, (sum, c)) in line.iter_mut().zip(&row.coefficients).enumerate() {
                let c = if turned == Some(column) { Measured { value: -c.value, ..*c } } else { *c };
                *sum = plus(*sum, times(factor, c));
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
        let (found, known) = factored.refined(&matrix, &right);
        let lines = sizes.chunks(self.size.max(1)).zip(&self.rest);
        let error = |(line, rest): (&[f64], &Measured)| {
            line.iter().zip(&known).map(|(m, x)| m * x).sum::<f64>() + rest.magnitude
        };
        let spread = factored.spread(&lines.map(error).collect::<Vec<f64>>());
        let magnitudes = spread.iter().zip(&known).map(|(spread, known)| spread.max(*known));
        Some(found.iter().zip(magnitudes).map(|(x, magnitude)| Measured { value: *x, magnitude }).collect())
    }

    /// The same with the unknowns from some place on known.
    pub fn with_last(&self, values: &[Measured]) -> Assembled {
        let size = self.size - values.len();
        let lines = || self.matrix.chunks(self.size.max(1));
        let known = |(line, rest): (&[Measured], &Measured)| {
            line[size..].iter().zip(values).map(|(c, x)| times(*c, *x)).fold(*rest, plus)
        };
        let rest = lines().zip(&self.rest).map(known).collect();
        let matrix = lines().flat_map(|line| line[..size].iter().copied()).collect();
        Assembled { equations: self.equations, judged: self.judged, size, matrix, rest }
    }

    /// The same with some of the unknowns after the accelerations put in; their columns stay, and are empty.
    pub fn put(&self, accelerations: usize, values: &[Option<Measured>]) -> Assembled {
        let mut system = Assembled { matrix: self.matrix.clone(), rest: self.rest.clone(), ..*self };
        for (line, rest) in system.matrix.chunks_mut(self.size.max(1)).zip(&mut system.rest) {
            for (c, x) in line[accelerations..].iter_mut().zip(values).filter_map(|(c, x)| Some((c, (*x)?))) {
                *rest = plus(*rest, times(*c, x));
                *c = zero();
            }
        }
        system
    }

    /// Equations from some place on, as parts that belong to no balance.
    pub fn lines_from(&self, first: usize) -> Vec<Row> {
        let line = |e: usize| Row::known(e, self.matrix[e * self.size..][..self.size].to_vec(), self.rest[e]);
        (first..self.equations).map(line).collect()
    }

    /// These equations alone.
    pub fn only(&self, equations: &[usize]) -> Assembled {
        let line = |e: &usize| self.matrix[e * self.size..][..self.size].to_vec();
        let rest = equations.iter().map(|e| self.rest[*e]).collect();
        let (matrix, count) = (equations.iter().flat_map(line).collect(), equations.len());
        Assembled { equations: count, judged: count, size: self.size, matrix, rest }
    }

    /// What an equation is with these accelerations, and no reactions.
    pub fn known(&self, equation: usize, accelerations: &[Measured]) -> Measured {
        let line = &self.matrix[equation * self.size..][..accelerations.len()];
        let terms = line.iter().zip(accelerations).map(|(c, a)| times(*c, *a));
        terms.fold(self.rest[equation], plus)
    }

    /// What known accelerations leave of the equations: look in [`Assembled::eliminated`].
    pub fn left_over(&self, accelerations: &[Measured]) -> Vec<(usize, Measured)> {
        self.eliminated(accelerations).left
    }

    /// What known accelerations leave of the equations once the reactions are eliminated, and the reactions.
    ///
    /// Each reaction is taken from the equation that says most sharply what it is: where the coefficient is largest
    /// beside the magnitude of all else in that equation.  What is left of an equation is a combination yᵀ(r + R λ) of all
    /// of them, and its magnitude Σ |y| (m(r) + m(R) |λ|): magnitudes that ran along with the elimination would grow with
    /// every step of it, and hide what is left.
    pub fn eliminated(&self, accelerations: &[Measured]) -> Eliminated {
        let n = accelerations.len();
        let lines = || self.matrix.chunks(self.size.max(1));
        let known: Vec<Measured> = (0..self.equations).map(|e| self.known(e, accelerations)).collect();
        let coefficients: Vec<&[Measured]> = lines().map(|line| &line[n..]).collect();
        let mut combined: Vec<Combined> = (0..self.judged)
            .map(|e| Combined {
                weights: (0..self.judged).map(|k| DoubleDouble::from(f64::from(u8::from(k == e)))).collect(),
                coefficients: coefficients[e].iter().map(|c| c.value).collect(),
                rest: known[e].value,
            })
            .collect();
        let mut open: Vec<usize> = (0..self.judged).collect();
        let mut taken: Vec<(usize, usize)> = Vec::new();
        for k in 0..self.size - n {
            let sharpness: Vec<f64> = open.iter().map(|e| combined[*e].sharpness(k, &coefficients, &known)).collect();
            let Some(place) = (0..open.len()).max_by(|a, b| sharpness[*a].total_cmp(&sharpness[*b])) else { break };
            if sharpness[place] == 0.0 {
                continue;
            }
            let from = open.swap_remove(place);
            let pivot = combined[from].clone();
            open.iter().for_each(|e| combined[*e].eliminate(k, &pivot));
            taken.push((k, from));
        }
        // The reactions, the last one first.
        let mut reactions = vec![DoubleDouble::ZERO; self.size - n];
        let mut determined = vec![false; self.size - n];
        for (k, from) in taken.iter().copied().rev() {
            let of = &combined[from];
            let after = k + 1..reactions.len();
            let others = after.clone().fold(of.rest, |sum, c| sum + of.coefficients[c] * reactions[c]);
            reactions[k] = -others / of.coefficients[k];
            let contains = |c: usize| {
                let among = of.sum(|e| coefficients[e][c].magnitude);
                of.coefficients[c].abs().to_f64() > NOTHING * among
            };
            determined[k] = after.clone().all(|c| determined[c] || !contains(c));
        }
        let magnitude = |e: usize| {
            let pushed = coefficients[e].iter().zip(&reactions).map(|(c, x)| c.magnitude * x.to_f64().abs());
            known[e].magnitude + pushed.sum::<f64>()
        };
        let magnitudes: Vec<f64> = (0..self.judged).map(magnitude).collect();
        open.sort_unstable();
        let left = open
            .into_iter()
            .map(|e| (e, Measured { value: combined[e].rest, magnitude: combined[e].sum(|e| magnitudes[e]) }));
        let left = left.chain((self.judged..self.equations).map(|e| (e, known[e]))).collect();
        let mut errors = vec![0.0; reactions.len()];
        for (k, from) in taken.into_iter().rev() {
            let of = &combined[from];
            let others: f64 = (k + 1..errors.len()).map(|c| of.coefficients[c].abs().to_f64() * errors[c]).sum();
            errors[k] = (of.sum(|e| magnitudes[e]) + others) / of.coefficients[k].abs().to_f64();
        }
        let value =
            |(k, value): (usize, DoubleDouble)| determined[k].then_some(Measured { value, magnitude: errors[k] });
        Eliminated { left, reactions: reactions.into_iter().enumerate().map(value).collect() }
    }
}

/// What is left of equations without their reactions, and the reactions, where they are determined.
pub(super) struct Eliminated {
    pub left: Vec<(usize, Measured)>,
    pub reactions: Vec<Option<Measured>>,
}

/// A combination of equations: Σ weights (coefficients·reactions + rest).
#[derive(Clone)]
struct Combined {
    weights: Vec<DoubleDouble>,
    coefficients: Vec<DoubleDouble>,
    rest: DoubleDouble,
}

impl Combined {
    /// Σ |weight| of what every equation has.
    fn sum(&self, of: impl Fn(usize) -> f64) -> f64 {
        let taken = self.weights.iter().enumerate().filter(|(_, weight)| **weight != DoubleDouble::ZERO);
        taken.map(|(e, weight)| weight.to_f64().abs() * of(e)).sum()
    }

    /// How sharply it says what a reaction is: its coefficient beside the magnitude of all else; 0 where it has none.
    fn sharpness(&self, reaction: usize, coefficients: &[&[Measured]], known: &[Measured]) -> f64 {
        let size = self.coefficients[reaction].to_f64().abs();
        let among = self.sum(|e| coefficients[e][reaction].magnitude);
        let beside = self.sum(|e| known[e].magnitude);
        if size <= NOTHING * among { 0.0 } else { size / beside.max(f64::MIN_POSITIVE) }
    }

    /// Takes a reaction out by another combination.
    fn eliminate(&mut self, reaction: usize, pivot: &Combined) {
        if self.coefficients[reaction] == DoubleDouble::ZERO {
            return;
        }
        let factor = -self.coefficients[reaction] / pivot.coefficients[reaction];
        let add = |mine: &mut [DoubleDouble], theirs: &[DoubleDouble]| {
            mine.iter_mut().zip(theirs).for_each(|(x, y)| *x += factor * *y);
        };
        add(&mut self.weights, &pivot.weights);
        add(&mut self.coefficients, &pivot.coefficients);
        self.rest += factor * pivot.rest;
        self.coefficients[reaction] = DoubleDouble::ZERO;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// Many reactions that push on every equation: what is left is measured by what is combined, not by what one elimination
    /// after the other might have added, so that a fault of 1e-12 shows.
    #[test]
    fn what_is_left_is_measured_by_what_is_combined() {
        const REACTIONS: usize = 40;
        let mut random = Random::new();
        let mut number = || Measured::exact(DoubleDouble::from(random.between(-1.0, 1.0)));
        let pushes: Vec<Vec<Measured>> = (0..=REACTIONS).map(|_| (0..REACTIONS).map(|_| number()).collect()).collect();
        let reactions: Vec<Measured> = (0..REACTIONS).map(|_| number()).collect();
        let sound = |line: &Vec<Measured>| {
            let sum = line.iter().zip(&reactions).fold(DoubleDouble::ZERO, |sum, (c, x)| sum + c.value * x.value);
            Measured::exact(-sum)
        };
        for (fault, shows) in [(0.0, false), (1e-12, true)] {
            let rows = pushes.iter().enumerate().map(|(e, line)| {
                let off = if e == 3 { DoubleDouble::from(fault) } else { DoubleDouble::ZERO };
                Row::known(e, line.clone(), Measured::exact(sound(line).value + off))
            });
            let system = Assembled::of(&rows.collect::<Vec<_>>(), REACTIONS + 1, REACTIONS, None);
            let left = system.left_over(&[]);
            let [(_, left)] = left.as_slice() else { panic!("{left:?}") };
            assert!(left.magnitude < 1e3 * left.value.to_f64().abs().max(1.0), "{left:?}");
            assert_eq!(left.relative() > 1e-16, shows, "{left:?}");
        }
    }
}
