//! Constraints at a state: states are brought to them, and say how independent they are.

use super::closing::{Group, HOLDS, groups, least, lengths};
use super::contact_states::ContactStates;
use super::state::State;
use crate::derive::{Equations, Rows};
use crate::expr::{Id, Measured, Symbol, Tape, jacobian};
use crate::model::Model;
use crate::number::DoubleDouble;

/// Singular values below this part of the largest count as zero where states lie on the constraints.
pub(super) const DEPENDENT: f64 = 1e-6;
/// A state at which they are below this part cannot show twenty digits.  It meets the constraints to 1e-29 ([`HOLDS`]), and
/// lies so much over the part beside them; multipliers grow as one over the part, and how they change with the position once more so.
/// 1e-29 over the third power of this is 1e-20.
pub(super) const NEARLY: f64 = 1e-3;

/// The constraints of a model, ready to evaluate anywhere.
pub(super) struct Constraints {
    /// How many coordinates there are.
    pub n: usize,
    holonomic: Vec<bool>,
    phases: Vec<Phase>,
    /// c' of all rows, then J's entries.
    rates: Tape,
    places: Vec<(usize, usize)>,
    /// γ of all rows, then B's entries.
    loads: Tape,
    rubbing: Vec<(usize, usize)>,
    /// M's diagonal, by which coordinates of different units are compared.
    diagonal: Tape,
    contacts: ContactStates,
}

/// The rows of a phase.
struct Phase {
    rows: Vec<usize>,
    /// The same, in groups that have no coordinate in common.
    groups: Vec<Group>,
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

impl Phase {
    fn new(model: &Model, all: &Rows, rows: Vec<usize>) -> Phase {
        let groups =
            groups(all, &rows).into_iter().map(|group| Group::new((model, &model.graph), all, group)).collect();
        Phase { rows, groups }
    }
}

impl Constraints {
    /// For a model's rows and its equations, in whose h friction stands.
    pub fn new(model: &mut Model, rows: &Rows, equations: &Equations) -> Constraints {
        let (graph, bias) = (&mut model.graph, &equations.bias);
        let diagonal = |i: usize| equations.mass.iter().find(|e| (e.0, e.1) == (i, i)).map_or(Id::ZERO, |e| e.2);
        let mut diagonal: Vec<Id> = match rows.is_empty() {
            true => Vec::new(),
            false => (0..model.coordinates.len()).map(diagonal).collect(),
        };
        // The numbers of a rotation move alike, so that least changes leave its length alone.
        for rotation in model.rotations.iter().filter(|_| !rows.is_empty()) {
            let own = &mut diagonal[rotation.first..rotation.first + 4];
            let sum = own.iter().fold(Id::ZERO, |sum, x| graph.add(sum, *x));
            own.fill(sum);
        }
        let of_row = |s: Symbol| if let Symbol::Multiplier(k) = s { Some(k as usize) } else { None };
        let friction = jacobian(graph, bias, of_row).into_iter().enumerate();
        let friction: Vec<(usize, usize, Id)> =
            friction.flat_map(|(i, line)| line.into_iter().map(move |(k, x)| (i, k, x))).collect();
        let rates: Vec<Id> = rows.rate.iter().copied().chain(rows.matrix.iter().map(|e| e.2)).collect();
        let loads: Vec<Id> = rows.bias.iter().copied().chain(friction.iter().map(|e| e.2)).collect();
        Constraints {
            n: model.coordinates.len(),
            holonomic: rows.holonomic.clone(),
            phases: model.phases.iter().map(|phase| Phase::new(model, rows, model.rows_of(phase))).collect(),
            rates: Tape::new(&model.graph, &rates),
            places: rows.matrix.iter().map(|e| (e.0, e.1)).collect(),
            loads: Tape::new(&model.graph, &loads),
            rubbing: friction.iter().map(|e| (e.0, e.1)).collect(),
            diagonal: Tape::new(&model.graph, &diagonal),
            contacts: ContactStates::new(model, rows),
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
        self.phases.get(phase).map_or(&[], |phase| &phase.rows)
    }

    /// Brings a state to the constraints of its phase: false where it cannot be.
    ///
    /// Levenberg and Marquardt's steps in `f64`, residuals in double-double, until the constraints hold to 29 digits; then
    /// speeds, by the least change.  Groups of rows without a common coordinate are solved one after the other.
    pub fn close(&self, state: &mut State) -> bool {
        self.close_holding(state, (&[], &[]))
    }

    /// The same, with some coordinates and some speeds left as they are.
    pub fn close_holding(&self, state: &mut State, held: (&[bool], &[bool])) -> bool {
        self.close_groups(state, held, |_| true)
    }

    /// The same for a state that met them before one coordinate or its speed was changed: only the group in which that stands is
    /// looked at.
    pub fn close_after(&self, state: &mut State, changed: usize) -> bool {
        self.close_groups(state, (&[], &[]), |group| group.contains(changed))
    }

    fn close_groups(
        &self,
        state: &mut State,
        (held_q, held_v): (&[bool], &[bool]),
        touched: impl Fn(&Group) -> bool,
    ) -> bool {
        let Some(phase) = self.phases.get(state.phase) else { return true };
        let groups = || phase.groups.iter().filter(|group| touched(group));
        let weights = self.weights(|s| state.value(s).to_f64());
        let free_q = free(&weights, held_q);
        if !groups().all(|group| group.close_places(state, &free_q)) {
            return false;
        }
        let weights = self.weights(|s| state.value(s).to_f64());
        let free_v = free(&weights, held_v);
        let before: Vec<f64> = groups().map(|group| group.fastest(state, &weights)).collect();
        let fastest = state.v.iter().fold(0.0_f64, |most, v| most.max(v.to_f64().abs()));
        if !groups().all(|group| group.close_speeds(state, &free_v)) {
            return false;
        }
        // What is left of a speed by others that it goes with is known as well as these.
        state.beside.resize(state.v.len(), 0.0);
        groups().zip(before).for_each(|(group, before)| group.note_speeds(state, &weights, before));
        // What the constraints leave no speed is at rest, and not at a rounding of what it had.
        let still = |v: &&mut DoubleDouble| v.abs().to_f64() <= HOLDS * fastest;
        state.v.iter_mut().filter(still).for_each(|v| *v = DoubleDouble::ZERO);
        true
    }

    /// Moves a state on the constraints of its phase to where friction slides and contacts are open as the phase says: false where that is
    /// not found.
    pub fn meet_contacts(&self, state: &mut State) -> bool {
        self.contacts.meet(self, state)
    }

    /// Whether something rests at a state that slips in its phase.
    pub fn rests(&self, state: &State) -> bool {
        self.contacts.rests(self, state)
    }

    /// c' of all rows.
    pub fn rates(&self, state: &State) -> Vec<Measured> {
        let mut rates = self.rates.evaluate(|s| state.measured(s));
        rates.truncate(self.holonomic.len());
        rates
    }

    /// The least change of the coordinates (or speeds) after which some rows (or their rates) differ by so much, to first order, and those of
    /// the phase do not.
    pub fn change(&self, state: &State, rows: &[(usize, f64)]) -> Option<Vec<f64>> {
        let active = self.active(state.phase);
        let all: Vec<usize> = active.iter().copied().chain(rows.iter().map(|row| row.0)).collect();
        let right: Vec<f64> = active.iter().map(|_| 0.0).chain(rows.iter().map(|row| row.1)).collect();
        let weights = self.weights(|s| state.value(s).to_f64());
        let lines = weighted(self.lines(state, &all), &weights);
        let step = least(&lines, &lengths(&lines, all.len(), self.n), &right, 0.0)?;
        Some(step.iter().zip(&weights).map(|(s, w)| s * w).collect())
    }

    /// How many rows of its phase are independent at a state, and all of them in order, those first.
    pub fn rank(&self, state: &State) -> (usize, Vec<usize>) {
        self.rank_of(state, self.active(state.phase))
    }

    /// The same of some rows.
    pub fn rank_of(&self, state: &State, active: &[usize]) -> (usize, Vec<usize>) {
        let weights = self.weights(|s| state.value(s).to_f64());
        let (rank, order, _) = self.independent(weighted(self.lines(state, active), &weights), active.len());
        (rank, order.into_iter().map(|place| active[place]).collect())
    }

    /// Whether friction is made of multipliers of rows that depend on each other at a state, so that the motion has many accelerations there.
    pub fn leaves_open(&self, state: &State) -> bool {
        let active = self.active(state.phase);
        let rubs = || self.rubbing.iter().any(|(_, row)| active.contains(row));
        rubs()
            && self.rank(state).0 < active.len()
            && self.held(state, active.to_vec()).friction.iter().any(|(_, _, x)| x.value != DoubleDouble::ZERO)
    }

    /// Whether the rows of its phase nearly depend on each other at a state, or one of them nearly vanishes beside its terms.
    pub fn nearly_dependent(&self, state: &State) -> bool {
        let active = self.active(state.phase);
        let weights = self.weights(|s| state.value(s).to_f64());
        let rates = self.rates.measured(|s| state.value(s));
        let of = |part: fn(&Measured) -> f64| {
            let entries: Vec<f64> = rates[self.holonomic.len()..].iter().map(part).collect();
            weighted(self.placed(active, &entries), &weights)
        };
        let (lines, terms) = (of(|x| x.value.to_f64()), of(|x| x.magnitude));
        let size = |line: &[f64]| line.iter().map(|x| x * x).sum::<f64>().sqrt();
        let mut pairs = lines.chunks_exact(self.n).zip(terms.chunks_exact(self.n));
        pairs.any(|(line, terms)| size(line) < NEARLY * size(terms))
            || self.independent(lines.clone(), active.len()).2 < NEARLY
    }

    /// How many of so many lines are independent, the places of all in order, those first, and how far the last of them stands
    /// out of the others, beside the first.
    fn independent(&self, mut lines: Vec<f64>, count: usize) -> (usize, Vec<usize>, f64) {
        let n = self.n;
        for line in lines.chunks_exact_mut(n) {
            let size = line.iter().map(|x| x * x).sum::<f64>().sqrt();
            if size > 0.0 {
                line.iter_mut().for_each(|x| *x /= size);
            }
        }
        // Orthogonalization with exchanged rows (Golub, Van Loan, 5.4.2): the last row is the one to name.
        let mut order: Vec<usize> = (0..count).collect();
        let (mut first, mut last) = (0.0, 1.0);
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
                return (k, order, last);
            }
            last = pivot / first;
            order.swap(k, best);
            let line: Vec<f64> = lines[order[k] * n..][..n].iter().map(|x| x / pivot).collect();
            for &row in &order[k + 1..] {
                let other = &mut lines[row * n..][..n];
                let along: f64 = other.iter().zip(&line).map(|(x, y)| x * y).sum();
                other.iter_mut().zip(&line).for_each(|(x, y)| *x -= along * y);
            }
        }
        (count, order, last)
    }

    /// J, γ and B of these rows at a state that meets them.
    pub fn held(&self, state: &State, rows: Vec<usize>) -> Held {
        let zero = Measured::exact(DoubleDouble::ZERO);
        let rates = self.rates.evaluate(|s| state.measured(s));
        let mut matrix = vec![zero; rows.len() * self.n];
        for ((k, i), x) in self.places.iter().zip(&rates[self.holonomic.len()..]) {
            if let Some(place) = rows.iter().position(|row| row == k) {
                matrix[place * self.n + i] = *x;
            }
        }
        let loads = self.loads.evaluate(|s| state.measured(s));
        let bias = rows.iter().map(|k| loads[*k]).collect();
        let friction = self.rubbing.iter().zip(&loads[self.holonomic.len()..]);
        let friction = friction.filter_map(|((i, k), x)| Some((*i, rows.iter().position(|row| row == k)?, *x)));
        Held { bias, friction: friction.collect(), matrix, rows }
    }

    /// The same in `f64` for a coarse run, of those among `active` that are independent.
    pub fn roughly(&self, active: &[usize], value: impl Fn(Symbol) -> f64) -> RoughlyHeld {
        let (rates, loads): (Vec<f64>, Vec<f64>) = (self.rates.evaluate(&value), self.loads.evaluate(&value));
        let lines = self.placed(active, &rates[self.holonomic.len()..]);
        let (rank, order, _) = self.independent(weighted(lines.clone(), &self.weights(&value)), active.len());
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

    /// How far each coordinate moves by the same impulse, the largest being 1: 1/√Mᵢᵢ, so that metres beside nanometres
    /// and angles are no reason to call rows dependent.  What has no mass of its own moves as easily as anything.
    pub fn weights(&self, value: impl Fn(Symbol) -> f64) -> Vec<f64> {
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
