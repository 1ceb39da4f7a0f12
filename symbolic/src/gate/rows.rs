//! Constraints at a state: states are brought to them, and say how independent they are.

use super::state::State;
use super::system::{plus, times};
use crate::derive::Rows;
use crate::expr::{Id, Measured, Symbol, Tape, jacobian};
use crate::model::Model;
use crate::number::DoubleDouble;

/// Singular values below this part of the largest count as zero where states lie on the constraints.
const DEPENDENT: f64 = 1e-6;
/// Steps to the constraints at most.
const STEPS: usize = 60;
/// What a dependent row leaves in roundings: constraints hold to 29 digits, and speeds multiply what is left.
const CONTRADICTS: f64 = 1e12;
/// A constraint holds when it is this part of its own terms.
const HOLDS: f64 = 1e-29;

/// The constraints of a model, ready to evaluate anywhere.
pub(super) struct Constraints {
    n: usize,
    holonomic: Vec<bool>,
    /// Rows of each phase.
    phases: Vec<Vec<usize>>,
    /// c of all rows.
    values: Tape,
    /// c' of all rows, then J's entries.
    rates: Tape,
    places: Vec<(usize, usize)>,
    /// γ of all rows, then B's entries.
    loads: Tape,
    rubbing: Vec<(usize, usize)>,
}

/// A row that follows from others, or contradicts them.
pub(super) struct Dependent {
    /// The phase in which it does.
    pub phase: usize,
    /// Its place among all rows.
    pub row: usize,
    /// Whether accelerations that meet the others do not meet it.
    pub contradicts: bool,
}

/// What accelerations need of the rows of a phase at a state, chosen rows only.
pub(super) struct Held {
    /// The rows that are kept, by their places among all.
    pub rows: Vec<usize>,
    /// J of these, row by row.
    pub matrix: Vec<Measured>,
    /// γ of these.
    pub bias: Vec<Measured>,
    /// B: (coordinate, place among the kept rows, value).
    pub friction: Vec<(usize, usize, Measured)>,
}

impl Constraints {
    /// For a model's rows; `bias` are the equations' h, in which friction stands.
    pub fn new(model: &mut Model, rows: &Rows, bias: &[Id]) -> Constraints {
        let graph = &mut model.graph;
        let of_row = |s: Symbol| if let Symbol::Multiplier(k) = s { Some(k as usize) } else { None };
        let friction = jacobian(graph, bias, of_row).into_iter().enumerate();
        let friction: Vec<(usize, usize, Id)> =
            friction.flat_map(|(i, line)| line.into_iter().map(move |(k, x)| (i, k, x))).collect();
        let rates: Vec<Id> = rows.rate.iter().copied().chain(rows.matrix.iter().map(|e| e.2)).collect();
        let loads: Vec<Id> = rows.bias.iter().copied().chain(friction.iter().map(|e| e.2)).collect();
        Constraints {
            n: model.coordinates.len(),
            holonomic: rows.holonomic.clone(),
            phases: model.phases.iter().map(|phase| model.rows_of(phase)).collect(),
            values: Tape::new(&model.graph, &rows.value),
            rates: Tape::new(&model.graph, &rates),
            places: rows.matrix.iter().map(|e| (e.0, e.1)).collect(),
            loads: Tape::new(&model.graph, &loads),
            rubbing: friction.iter().map(|e| (e.0, e.1)).collect(),
        }
    }

    /// How many rows there are, in all phases.
    pub fn len(&self) -> usize {
        self.holonomic.len()
    }

    /// True without constraints.
    pub fn is_empty(&self) -> bool {
        self.holonomic.is_empty()
    }

    /// How many phases there are; one at least.
    pub fn phases(&self) -> usize {
        self.phases.len().max(1)
    }

    /// The rows of a phase.
    pub fn active(&self, phase: usize) -> &[usize] {
        self.phases.get(phase).map_or(&[], Vec::as_slice)
    }

    /// Brings a state to the constraints of its phase: false where it cannot be.
    ///
    /// Levenberg and Marquardt's steps in `f64`, residuals in double-double, until the constraints hold to 29 digits; then
    /// speeds, by the least change.
    pub fn close(&self, state: &mut State) -> bool {
        let active = self.active(state.phase);
        let holonomic: Vec<usize> = active.iter().copied().filter(|k| self.holonomic[*k]).collect();
        let mut damping = 1e-3;
        let mut closed = holonomic.is_empty();
        // What a constraint is made of on the way, where at its end it may be made of nothing.
        let mut sizes = vec![0.0_f64; self.holonomic.len()];
        for _ in 0..STEPS {
            if closed {
                break;
            }
            let c = self.residual(state, &holonomic);
            if c.iter().any(|c| !c.value.is_finite()) {
                return false;
            }
            holonomic.iter().zip(&c).for_each(|(k, c)| sizes[*k] = sizes[*k].max(c.magnitude));
            closed = holonomic.iter().zip(&c).all(|(k, c)| c.value.abs().to_f64() <= HOLDS * sizes[*k]);
            let scales: Vec<f64> = holonomic.iter().map(|k| sizes[*k]).collect();
            let size = norm(&c, &scales);
            if closed {
                break;
            }
            let lines = self.lines(state, &holonomic);
            let right: Vec<f64> = c.iter().map(|c| -c.value.to_f64()).collect();
            // Near the end nothing is damped, so that every step gains what an `f64` holds.
            let near = c.iter().zip(&scales).all(|(c, scale)| c.value.abs().to_f64() <= 1e-6 * scale);
            let Some(step) = least(&lines, &right, self.n, if near { 0.0 } else { damping }) else { return false };
            let tried = moved(&state.q, &step);
            let mut next = state.clone();
            next.q = tried;
            let after = norm(&self.residual(&next, &holonomic), &scales);
            if after < size || near {
                state.q = next.q;
                damping = (damping / 5.0_f64).max(1e-12);
            } else {
                damping *= 4.0;
                if damping > 1e12 {
                    return false;
                }
            }
        }
        closed && self.close_speeds(state, active)
    }

    fn close_speeds(&self, state: &mut State, active: &[usize]) -> bool {
        let lines = self.lines(state, active);
        let mut sizes = vec![0.0_f64; self.holonomic.len()];
        let fastest = state.v.iter().fold(0.0_f64, |most, v| most.max(v.to_f64().abs()));
        for _ in 0..8 {
            let rates = self.rates.measured(|s| state.value(s));
            let off: Vec<&Measured> = active.iter().map(|k| &rates[*k]).collect();
            if off.iter().any(|c| !c.value.is_finite()) {
                return false;
            }
            active.iter().zip(&off).for_each(|(k, c)| sizes[*k] = sizes[*k].max(c.magnitude));
            if active.iter().zip(&off).all(|(k, c)| c.value.abs().to_f64() <= HOLDS * sizes[*k]) {
                // What the constraints leave no speed is at rest, and not at a rounding of what it had.
                state
                    .v
                    .iter_mut()
                    .filter(|v| v.abs().to_f64() <= HOLDS * fastest)
                    .for_each(|v| *v = DoubleDouble::ZERO);
                return true;
            }
            let right: Vec<f64> = off.iter().map(|c| -c.value.to_f64()).collect();
            let Some(step) = least(&lines, &right, self.n, 0.0) else { return false };
            state.v = moved(&state.v, &step);
        }
        false
    }

    /// How many rows of its phase are independent at a state, those first in `order`, and a measure of the next one.
    pub fn rank(&self, state: &State) -> (usize, Vec<usize>) {
        let active = self.active(state.phase);
        let mut lines = self.lines(state, active);
        let n = self.n;
        for line in lines.chunks_exact_mut(n) {
            let size = line.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size > 0.0 {
                line.iter_mut().for_each(|x| *x /= size);
            }
        }
        // Orthogonalization with exchanged rows (Golub, Van Loan, 5.4.2): the last row is the one to name.
        let mut order: Vec<usize> = (0..active.len()).collect();
        let mut first = 0.0;
        for k in 0..active.len() {
            let size = |row: usize| lines[row * n..][..n].iter().map(|x| x * x).sum::<f64>().sqrt();
            let best = (k..order.len()).max_by(|a, b| {
                let by_size = size(order[*a]).total_cmp(&size(order[*b]));
                // Of equals the earlier stays.
                by_size.then(order[*b].cmp(&order[*a]))
            });
            let Some(best) = best else { break };
            let pivot = size(order[best]);
            first = if k == 0 { pivot } else { first };
            if pivot.is_nan() || pivot <= DEPENDENT * first {
                let rows = order.iter().map(|place| active[*place]).collect();
                return (k, rows);
            }
            order.swap(k, best);
            let line: Vec<f64> = lines[order[k] * n..][..n].iter().map(|x| x / pivot).collect();
            for &row in &order[k + 1..] {
                let other = &mut lines[row * n..][..n];
                let along: f64 = other.iter().zip(&line).map(|(x, y)| x * y).sum();
                other.iter_mut().zip(&line).for_each(|(x, y)| *x -= along * y);
            }
        }
        (order.len(), order.iter().map(|place| active[*place]).collect())
    }

    /// J, γ and B of these rows at a state that meets them.
    pub fn held(&self, state: &State, rows: Vec<usize>) -> Held {
        let zero = Measured::exact(DoubleDouble::ZERO);
        let rates = self.rates.measured(|s| state.value(s));
        let mut matrix = vec![zero; rows.len() * self.n];
        for ((k, i), x) in self.places.iter().zip(&rates[self.holonomic.len()..]) {
            if let Some(place) = rows.iter().position(|row| row == k) {
                matrix[place * self.n + i] = *x;
            }
        }
        let loads = self.loads.measured(|s| state.value(s));
        let bias = rows.iter().map(|k| loads[*k]).collect();
        let friction = self.rubbing.iter().zip(&loads[self.holonomic.len()..]);
        let friction = friction.filter_map(|((i, k), x)| Some((*i, rows.iter().position(|row| row == k)?, *x)));
        Held { bias, friction: friction.collect(), matrix, rows }
    }

    /// Rows of every phase that follow from others, and whether they contradict them somewhere: what they ask of the
    /// accelerations that the others leave.
    pub fn dependent(&self, states: &[State]) -> Vec<Dependent> {
        let mut found: Vec<Dependent> = Vec::new();
        for state in states {
            let (rank, order) = self.rank(state);
            let rest = order[rank..].to_vec();
            if rest.is_empty() {
                continue;
            }
            let held = self.held(state, rest.clone());
            for (place, row) in rest.into_iter().enumerate() {
                let terms = held.matrix[place * self.n..][..self.n].iter().zip(&state.a);
                let sum = terms.fold(held.bias[place], |sum, (x, a)| plus(sum, times(*x, *a)));
                let contradicts = !sum.vanishes(CONTRADICTS);
                match found.iter_mut().find(|d| (d.phase, d.row) == (state.phase, row)) {
                    Some(known) => known.contradicts |= contradicts,
                    None => found.push(Dependent { phase: state.phase, row, contradicts }),
                }
            }
        }
        // Which of several rows is called the last may change with the state: one for each that is too many.
        let ranks = self.ranks(states);
        let mut kept: Vec<Dependent> = Vec::new();
        found.sort_by_key(|d| (!d.contradicts, std::cmp::Reverse(d.row)));
        for dependent in found {
            let already = kept.iter().filter(|d| d.phase == dependent.phase).count();
            if already < self.active(dependent.phase).len() - ranks[dependent.phase] {
                kept.push(dependent);
            }
        }
        kept
    }

    /// Leaves only states at which as many rows are independent as anywhere in their phase.
    pub fn regular(&self, states: &mut Vec<State>) {
        let ranks = self.ranks(states);
        states.retain(|state| self.rank(state).0 == ranks[state.phase]);
    }

    /// How many rows of each phase are independent in general: the largest rank at these states.
    pub fn ranks(&self, states: &[State]) -> Vec<usize> {
        let mut ranks = vec![0; self.phases()];
        for state in states {
            ranks[state.phase] = ranks[state.phase].max(self.rank(state).0);
        }
        ranks
    }

    fn residual(&self, state: &State, rows: &[usize]) -> Vec<Measured> {
        let values = self.values.measured(|s| state.value(s));
        rows.iter().map(|k| values[*k]).collect()
    }

    /// Rows of J in `f64`.
    fn lines(&self, state: &State, rows: &[usize]) -> Vec<f64> {
        let rates: Vec<f64> = self.rates.evaluate(|s| state.value(s).to_f64());
        let mut lines = vec![0.0; rows.len() * self.n];
        for ((k, i), x) in self.places.iter().zip(&rates[self.holonomic.len()..]) {
            if let Some(place) = rows.iter().position(|row| row == k) {
                lines[place * self.n + i] = *x;
            }
        }
        lines
    }
}

fn norm(c: &[Measured], scales: &[f64]) -> f64 {
    let share = |(c, scale): (&Measured, &f64)| (c.value.to_f64() / scale.max(f64::MIN_POSITIVE)).powi(2);
    c.iter().zip(scales).map(share).sum::<f64>().sqrt()
}

fn moved(list: &[DoubleDouble], step: &[f64]) -> Vec<DoubleDouble> {
    list.iter().zip(step).map(|(x, s)| *x + DoubleDouble::from(*s)).collect()
}

/// The least step x with A x = b, or where it is damped the least |A x − b|² + damping |x|²: AᵀA is not formed, but
/// A Aᵀ with its diagonal raised, rows scaled, and what depends on other rows left out.
fn least(lines: &[f64], right: &[f64], n: usize, damping: f64) -> Option<Vec<f64>> {
    let m = right.len();
    let line = |k: usize| &lines[k * n..][..n];
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let scale: Vec<f64> = (0..m).map(|k| dot(line(k), line(k)).sqrt()).collect();
    let unit = |k: usize| if scale[k] > 0.0 { 1.0 / scale[k] } else { 0.0 };
    let mut gram: Vec<f64> = (0..m * m).map(|k| dot(line(k / m), line(k % m)) * unit(k / m) * unit(k % m)).collect();
    (0..m).for_each(|k| gram[k * m + k] += damping);
    let mut y: Vec<f64> = (0..m).map(|k| right[k] * unit(k)).collect();
    // Gauss–Jordan on the diagonal, largest pivots first.
    let mut done = vec![false; m];
    for _ in 0..m {
        let pivot = (0..m).filter(|k| !done[*k]).max_by(|a, b| gram[a * m + a].total_cmp(&gram[b * m + b]))?;
        let size = gram[pivot * m + pivot];
        if !size.is_finite() {
            return None;
        }
        if size <= 1e-13 {
            break;
        }
        done[pivot] = true;
        for i in (0..m).filter(|i| *i != pivot) {
            let factor = gram[i * m + pivot] / size;
            if factor != 0.0 {
                (0..m).for_each(|j| gram[i * m + j] -= factor * gram[pivot * m + j]);
                y[i] -= factor * y[pivot];
            }
        }
    }
    let mut step = vec![0.0; n];
    for k in (0..m).filter(|k| done[*k]) {
        let factor = y[k] / gram[k * m + k] * unit(k);
        step.iter_mut().zip(line(k)).for_each(|(s, x)| *s += factor * x);
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
}
