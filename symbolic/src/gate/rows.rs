//! Constraints at a state: states are brought to them, and say how independent they are.

use super::state::State;
use crate::derive::{Equations, Rows};
use crate::expr::{Id, Measured, Symbol, Tape, jacobian};
use crate::model::Model;
use crate::number::DoubleDouble;

/// Singular values below this part of the largest count as zero where states lie on the constraints.
pub(super) const DEPENDENT: f64 = 1e-6;
/// Steps to the constraints at most.
const STEPS: usize = 60;
/// A constraint holds when it is this part of its own terms.
const HOLDS: f64 = 1e-29;

/// The constraints of a model, ready to evaluate anywhere.
pub(super) struct Constraints {
    /// How many coordinates there are.
    pub n: usize,
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
    /// M's diagonal, by which coordinates of different units are compared.
    diagonal: Tape,
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

/// The same in `f64`, and the rates at which these rows are not met.
pub(super) struct RoughlyHeld {
    pub rows: Vec<usize>,
    /// c'.
    pub rate: Vec<f64>,
    pub matrix: Vec<f64>,
    pub bias: Vec<f64>,
    pub friction: Vec<(usize, usize, f64)>,
}

impl Constraints {
    /// For a model's rows and its equations, in whose h friction stands.
    pub fn new(model: &mut Model, rows: &Rows, equations: &Equations) -> Constraints {
        let (graph, bias) = (&mut model.graph, &equations.bias);
        let diagonal = |i: usize| equations.mass.iter().find(|e| (e.0, e.1) == (i, i)).map_or(Id::ZERO, |e| e.2);
        let diagonal: Vec<Id> = match rows.is_empty() {
            true => Vec::new(),
            false => (0..model.coordinates.len()).map(diagonal).collect(),
        };
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
            diagonal: Tape::new(&model.graph, &diagonal),
        }
    }

    /// How many rows there are, in all phases.
    pub fn len(&self) -> usize {
        self.holonomic.len()
    }

    /// Coordinates and rows that meet in an equation, rows as numbers from n on.
    pub fn couplings(&self) -> Vec<(usize, usize)> {
        let rubbing = self.rubbing.iter().map(|(i, k)| (*k, *i));
        self.places.iter().copied().chain(rubbing).map(|(k, i)| (i, self.n + k)).collect()
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
        self.close_holding(state, (&[], &[]))
    }

    /// The same, with some coordinates and some speeds left as they are.
    pub fn close_holding(&self, state: &mut State, (held_q, held_v): (&[bool], &[bool])) -> bool {
        let active = self.active(state.phase);
        let holonomic: Vec<usize> = active.iter().copied().filter(|k| self.holonomic[*k]).collect();
        let mut damping = 1e-3;
        let mut closed = holonomic.is_empty();
        let weights = self.weights(|s| state.value(s).to_f64());
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
            let lines = weighted(self.lines(state, &holonomic), &free(&weights, held_q));
            let right: Vec<f64> = c.iter().map(|c| -c.value.to_f64()).collect();
            // Near the end nothing is damped, so that every step gains what an `f64` holds.
            let near = c.iter().zip(&scales).all(|(c, scale)| c.value.abs().to_f64() <= 1e-6 * scale);
            let Some(step) = least(&lines, &right, self.n, if near { 0.0 } else { damping }) else { return false };
            let tried = moved(&state.q, &step, &weights);
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
        closed && self.close_speeds(state, active, held_v)
    }

    fn close_speeds(&self, state: &mut State, active: &[usize], held: &[bool]) -> bool {
        let weights = self.weights(|s| state.value(s).to_f64());
        let lines = weighted(self.lines(state, active), &free(&weights, held));
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
            state.v = moved(&state.v, &step, &weights);
        }
        false
    }

    /// How many rows of its phase are independent at a state, and all of them in order, those first.
    pub fn rank(&self, state: &State) -> (usize, Vec<usize>) {
        self.rank_of(state, self.active(state.phase))
    }

    /// The same of some rows.
    pub fn rank_of(&self, state: &State, active: &[usize]) -> (usize, Vec<usize>) {
        let weights = self.weights(|s| state.value(s).to_f64());
        let (rank, order) = self.independent(weighted(self.lines(state, active), &weights), active.len());
        (rank, order.into_iter().map(|place| active[place]).collect())
    }

    /// How many of so many lines are independent, and the places of all in order, those first.
    fn independent(&self, mut lines: Vec<f64>, count: usize) -> (usize, Vec<usize>) {
        let n = self.n;
        for line in lines.chunks_exact_mut(n) {
            let size = line.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size > 0.0 {
                line.iter_mut().for_each(|x| *x /= size);
            }
        }
        // Orthogonalization with exchanged rows (Golub, Van Loan, 5.4.2): the last row is the one to name.
        let mut order: Vec<usize> = (0..count).collect();
        let mut first = 0.0;
        for k in 0..count {
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
                return (k, order);
            }
            order.swap(k, best);
            let line: Vec<f64> = lines[order[k] * n..][..n].iter().map(|x| x / pivot).collect();
            for &row in &order[k + 1..] {
                let other = &mut lines[row * n..][..n];
                let along: f64 = other.iter().zip(&line).map(|(x, y)| x * y).sum();
                other.iter_mut().zip(&line).for_each(|(x, y)| *x -= along * y);
            }
        }
        (count, order)
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

    /// The same in `f64` for a coarse run, of those among `active` that are independent.
    pub fn roughly(&self, active: &[usize], value: impl Fn(Symbol) -> f64) -> RoughlyHeld {
        let (rates, loads): (Vec<f64>, Vec<f64>) = (self.rates.evaluate(&value), self.loads.evaluate(&value));
        let lines = self.placed(active, &rates[self.holonomic.len()..]);
        let (rank, order) = self.independent(weighted(lines.clone(), &self.weights(&value)), active.len());
        let kept = &order[..rank];
        let place = |row: usize| kept.iter().position(|k| active[*k] == row);
        let friction = self.rubbing.iter().zip(&loads[self.holonomic.len()..]);
        RoughlyHeld {
            rows: kept.iter().map(|k| active[*k]).collect(),
            rate: kept.iter().map(|k| rates[active[*k]]).collect(),
            matrix: kept.iter().flat_map(|k| lines[k * self.n..][..self.n].iter().copied()).collect(),
            bias: kept.iter().map(|k| loads[active[*k]]).collect(),
            friction: friction.filter_map(|((i, row), x)| Some((*i, place(*row)?, *x))).collect(),
        }
    }

    /// Leaves only states at which as many rows are independent as anywhere in their phase, with drawn parameters and with
    /// the scene's own apart.
    pub fn regular(&self, states: &mut Vec<State>) {
        let ranks = [false, true].map(|own| self.ranks(states.iter().filter(|state| state.own == own)));
        states.retain(|state| ranks[usize::from(state.own)][state.phase] == Some(self.rank(state).0));
    }

    /// How many rows of each phase are independent in general: the largest rank at these states, where there are any.
    pub fn ranks<'a>(&self, states: impl IntoIterator<Item = &'a State>) -> Vec<Option<usize>> {
        let mut ranks = vec![None; self.phases()];
        for state in states {
            ranks[state.phase] = ranks[state.phase].max(Some(self.rank(state).0));
        }
        ranks
    }

    fn residual(&self, state: &State, rows: &[usize]) -> Vec<Measured> {
        let values = self.values.measured(|s| state.value(s));
        rows.iter().map(|k| values[*k]).collect()
    }

    /// How far each coordinate moves by the same impulse, the largest being 1: 1/√Mᵢᵢ, so that metres beside nanometres
    /// and angles are no reason to call rows dependent.  What has no mass of its own moves as easily as anything.
    fn weights(&self, value: impl Fn(Symbol) -> f64) -> Vec<f64> {
        let masses: Vec<f64> = self.diagonal.evaluate(value);
        let weighs = |m: &f64| *m > 0.0 && m.is_finite();
        let least = masses.iter().copied().filter(|m| weighs(m)).fold(f64::INFINITY, f64::min);
        masses.iter().map(|m| if weighs(m) { (least / m).sqrt() } else { 1.0 }).collect()
    }

    /// Rows of J in `f64`.
    pub fn lines(&self, state: &State, rows: &[usize]) -> Vec<f64> {
        let rates: Vec<f64> = self.rates.evaluate(|s| state.value(s).to_f64());
        self.placed(rows, &rates[self.holonomic.len()..])
    }

    /// J's entries in their places.
    fn placed(&self, rows: &[usize], entries: &[f64]) -> Vec<f64> {
        let mut lines = vec![0.0; rows.len() * self.n];
        for ((k, i), x) in self.places.iter().zip(entries) {
            if let Some(place) = rows.iter().position(|row| row == k) {
                lines[place * self.n + i] = *x;
            }
        }
        lines
    }
}

/// Weights without those of what may not change.
fn free(weights: &[f64], held: &[bool]) -> Vec<f64> {
    let weight = |(i, w): (usize, &f64)| if held.get(i) == Some(&true) { 0.0 } else { *w };
    weights.iter().enumerate().map(weight).collect()
}

/// Lines by coordinates that are measured by these.
fn weighted(mut lines: Vec<f64>, weights: &[f64]) -> Vec<f64> {
    let columns = lines.chunks_exact_mut(weights.len().max(1));
    columns.for_each(|line| line.iter_mut().zip(weights).for_each(|(x, w)| *x *= w));
    lines
}

fn norm(c: &[Measured], scales: &[f64]) -> f64 {
    let share = |(c, scale): (&Measured, &f64)| (c.value.to_f64() / scale.max(f64::MIN_POSITIVE)).powi(2);
    c.iter().zip(scales).map(share).sum::<f64>().sqrt()
}

fn moved(list: &[DoubleDouble], step: &[f64], weights: &[f64]) -> Vec<DoubleDouble> {
    list.iter().zip(step).zip(weights).map(|((x, s), w)| *x + DoubleDouble::from(*s * w)).collect()
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
