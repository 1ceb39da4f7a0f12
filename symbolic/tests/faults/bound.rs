// Constraints as the study differentiates them: what accelerations, multipliers and states must meet.

use dalembert_symbolic::derive::rates;
use dalembert_symbolic::expr::{DoubleDouble, Id, Symbol, Tape, gradients};
use dalembert_symbolic::model::Model;

use super::judge::{Known, Route, Term};
use super::moments::Moment;
use super::solve::solve;

/// Newton's steps to the constraints at most.
const STEPS: usize = 60;
/// A constraint holds when it is this part of its largest term.
const HOLDS: f64 = 1e-29;

/// The constraints of a model.
pub struct Bound {
    /// The rows that act in each phase.
    phases: Vec<Vec<usize>>,
    holonomic: Vec<bool>,
    /// c of every row.
    values: Tape,
    /// c' of every row; of one with speeds c itself.
    rates: Tape,
    /// c'' at zero accelerations (with speeds: c').
    bias: Tape,
    /// The slopes of c' by the speeds: (row, coordinate), and their values.
    places: Vec<(usize, usize)>,
    matrix: Tape,
}

/// The constraints at a state.
pub struct Rows {
    /// The rows that act.
    pub active: Vec<usize>,
    /// The slopes by coordinates, a line a row.
    pub matrix: Vec<Vec<DoubleDouble>>,
    /// What is left of the accelerations' constraints where these are 0.
    pub bias: Vec<DoubleDouble>,
}

impl Bound {
    pub fn new(model: &Model) -> Bound {
        let mut graph = model.graph.clone();
        let rows = || model.constraints.iter().flat_map(|c| c.value.iter().map(|value| (*value, c.holonomic)));
        let (values, holonomic): (Vec<Id>, Vec<bool>) = rows().unzip();
        let once = rates(&mut graph, &values);
        let rate: Vec<Id> = (0..values.len()).map(|k| if holonomic[k] { once[k] } else { values[k] }).collect();
        let twice = rates(&mut graph, &rate);
        let (mut places, mut slopes) = (Vec::new(), Vec::new());
        for (row, slope) in gradients(&mut graph, &rate, |s| matches!(s, Symbol::Speed(_))).into_iter().enumerate() {
            for (symbol, id) in slope {
                let Symbol::Speed(i) = symbol else { continue };
                places.push((row, i as usize));
                slopes.push(id);
            }
        }
        Bound {
            phases: model.phases.iter().map(|phase| model.rows_of(phase)).collect(),
            holonomic,
            values: Tape::new(&graph, &values),
            rates: Tape::new(&graph, &rate),
            bias: Tape::new(&graph, &twice),
            places,
            matrix: Tape::new(&graph, &slopes),
        }
    }

    /// How many phases there are.
    pub fn phases(&self) -> usize {
        self.phases.len()
    }

    /// How many rows there are, in all phases.
    pub fn rows(&self) -> usize {
        self.holonomic.len()
    }

    /// The rows of a phase.
    pub fn active(&self, phase: usize) -> &[usize] {
        self.phases.get(phase).map_or(&[], Vec::as_slice)
    }

    /// The rows at a state, for n coordinates.
    pub fn at(&self, known: &Known<'_, DoubleDouble>, n: usize) -> Rows {
        let active = self.active(known.moment.phase).to_vec();
        let mut matrix = vec![vec![DoubleDouble::ZERO; n]; active.len()];
        if active.is_empty() {
            return Rows { active, matrix, bias: Vec::new() };
        }
        for ((row, i), x) in self.places.iter().zip(self.matrix.evaluate(|s| known.value(s))) {
            if let Some(k) = active.iter().position(|k| k == row) {
                matrix[k][*i] = x;
            }
        }
        let all = self.bias.evaluate(|s| known.value(s));
        let bias = active.iter().map(|k| all[*k]).collect();
        Rows { active, matrix, bias }
    }
}

/// Coordinates and speeds that are left where they are.
pub type Left<'a> = (&'a [bool], &'a [bool]);

impl Route {
    /// A state brought to the constraints of its phase: first places, then speeds, each by Newton's method in the metric
    /// of M's diagonal.
    pub fn closed(&self, moment: &Moment, (q, v): Left<'_>) -> Option<Moment> {
        let mut moment = moment.clone();
        if self.bound.active(moment.phase).is_empty() {
            return Some(moment);
        }
        let brought = self.bring(&mut moment, q, false) && self.bring(&mut moment, v, true);
        brought.then_some(moment)
    }

    fn bring(&self, moment: &mut Moment, left: &[bool], speeds: bool) -> bool {
        let n = moment.q.len();
        for _ in 0..STEPS {
            let known = self.known::<Term>(moment);
            let tape = if speeds { &self.bound.rates } else { &self.bound.values };
            let all: Vec<Term> = tape.evaluate(|s| known.value(s));
            let known = self.known::<DoubleDouble>(moment);
            let rows = self.bound.at(&known, n);
            let counts = |k: &usize| speeds || self.bound.holonomic[rows.active[*k]];
            let counted: Vec<usize> = (0..rows.active.len()).filter(counts).collect();
            let missed: Vec<Term> = counted.iter().map(|k| all[rows.active[*k]]).collect();
            if missed.iter().any(|c| !c.value.is_finite()) {
                return false;
            }
            // Where all terms of one vanish, rounding of rounding is left beside those of others.
            let largest = missed.iter().fold(0.0_f64, |most, c| most.max(c.largest));
            if missed.iter().all(|c| c.value.abs().to_f64() <= HOLDS * c.largest.max(HOLDS * largest)) {
                return true;
            }
            let weights: Vec<DoubleDouble> = self
                .ease(&known)
                .iter()
                .enumerate()
                .map(|(i, w)| match left.get(i) {
                    Some(true) => DoubleDouble::ZERO,
                    _ => *w,
                })
                .collect();
            let line = |k: usize| &rows.matrix[k];
            let product = |a: &[DoubleDouble], b: &[DoubleDouble]| {
                (0..n).fold(DoubleDouble::ZERO, |sum, i| sum + a[i] * weights[i] * b[i])
            };
            let system = counted
                .iter()
                .zip(&missed)
                .map(|(k, c)| counted.iter().map(|other| product(line(*k), line(*other))).chain([-c.value]).collect());
            let Some(solution) = solve(system.collect(), 0) else { return false };
            let list = if speeds { &mut moment.v } else { &mut moment.q };
            for (k, y) in counted.iter().zip(solution) {
                (0..n).for_each(|i| list[i] += weights[i] * line(*k)[i] * y);
            }
        }
        false
    }

    /// What a coordinate yields to a force: 1/M_ii, where it has inertia.
    fn ease(&self, known: &Known<'_, DoubleDouble>) -> Vec<DoubleDouble> {
        let one = DoubleDouble::from(1.0);
        self.diagonal(known).into_iter().map(|m| if m > DoubleDouble::ZERO { one / m } else { one }).collect()
    }
}
