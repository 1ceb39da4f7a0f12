//! Directions of the coordinates along which nothing changes: ignorable, where no coordinate is.

use super::state::State;
use crate::expr::{Angles, Id, Measured, Symbol, Tape, expand};
use crate::model::Model;
use crate::number::DoubleDouble;
use crate::random::Random;

/// Coordinates that may be shifted together, each by a multiple of the same amount, and the momentum that is conserved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Direction {
    /// Coordinates, and by how much each is shifted: whole numbers without a common divisor, the first one positive.
    pub shift: Vec<(usize, i64)>,
    /// Σ nᵢ ∂T/∂q'ᵢ, which is conserved.
    pub momentum: Id,
}

/// More coordinates than these are not asked.
const MOST: usize = 200;
/// So many states running that say nothing new say that there is nothing new.
const PROOF: usize = 8;
/// States in a row at which something is not defined end the search.
const UNDEFINED: usize = 50;
/// What is left of a row of ones is rounding.
const REST: f64 = 1e-18;
/// Ratios that are told have a common denominator of no more than this.
const DENOMINATOR: u32 = 60;

/// Directions n ≠ 0 with Σ nᵢ (∂L/∂qᵢ + Qᵢ) = 0 at all states, beside the coordinates for which that holds alone.
///
/// The rows (∂L/∂qᵢ + Qᵢ) at random states are eliminated until further ones add nothing; what no row forbids is brought to whole
/// numbers, and proved to vanish, by the magnitude of its own terms, at the states that derivations are judged at.
pub(super) fn directions(
    model: &mut Model,
    states: &[State],
    momenta: &[(Id, Id)],
    cyclic: &[(usize, Id)],
) -> Vec<Direction> {
    let free = |i: &usize| !cyclic.iter().any(|(known, _)| known == i);
    let columns: Vec<usize> = (0..momenta.len()).filter(free).collect();
    if states.is_empty() || columns.len() < 2 || columns.len() > MOST {
        return Vec::new();
    }
    let rests: Vec<Id> = columns.iter().map(|i| momenta[*i].1).collect();
    let tape = Tape::new(&model.graph, &rests);
    let at = |state: &State| tape.evaluate(|s| state.measured(s));
    let known: Vec<Vec<Measured>> = states.iter().map(at).collect();
    let scales = (0..columns.len()).map(|j| known.iter().fold(0.0_f64, |most, row| most.max(row[j].magnitude)));
    let scales: Vec<f64> =
        scales.map(|scale| if scale > 0.0 && scale.is_finite() { 1.0 / scale } else { 1.0 }).collect();
    let mut rows = Rows::default();
    let (mut random, mut idle, mut undefined) = (Random::new(), 0, 0);
    while idle < PROOF && rows.pivots.len() < columns.len() && undefined < UNDEFINED {
        let row = at(&mixed(states, &mut random));
        if row.iter().all(|entry| entry.magnitude.is_finite() && entry.value.is_finite()) {
            // Where one link alone turns what is left of nothing is rounding.
            let value = |e: &Measured| if e.vanishes(super::ROUNDINGS) { DoubleDouble::ZERO } else { e.value };
            let scaled = row.iter().zip(&scales).map(|(entry, scale)| value(entry) * *scale).collect();
            idle = if rows.add(scaled) { 0 } else { idle + 1 };
            undefined = 0;
        } else {
            undefined += 1;
        }
    }
    if idle < PROOF {
        return Vec::new();
    }
    let found = rows.directions(columns.len()).into_iter().filter_map(|direction| {
        let shift = whole_numbers(direction.iter().zip(&scales).map(|(x, scale)| (*x * *scale).to_f64()))?;
        known.iter().all(|row| vanishes(row, &shift)).then_some(shift)
    });
    let found: Vec<Vec<i64>> = found.collect();
    let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
    let direction = |shift: Vec<i64>| {
        let shift: Vec<(usize, i64)> =
            columns.iter().copied().zip(shift).filter(|(_, multiple)| *multiple != 0).collect();
        let momentum = shift.iter().fold(Id::ZERO, |sum, &(i, multiple)| {
            let multiple = model.graph.integer(multiple);
            let term = model.graph.mul(multiple, momenta[i].0);
            model.graph.add(sum, term)
        });
        let expanded = expand(&mut model.graph, &[momentum], constant, Angles::Shorter);
        Direction { shift, momentum: expanded.map_or(momentum, |e| e[0]) }
    };
    found.into_iter().map(direction).collect()
}

/// A state that has each coordinate and each speed near that of any state.
pub(crate) fn mixed(states: &[State], random: &mut Random) -> State {
    let mut any = || &states[(random.between(0.0, states.len() as f64) as usize).min(states.len() - 1)];
    let mut state = any().clone();
    let picked: Vec<(DoubleDouble, DoubleDouble)> = (0..state.q.len()).map(|i| (any().q[i], any().v[i])).collect();
    for (i, (q, v)) in picked.into_iter().enumerate() {
        state.q[i] = q * random.between(0.5, 1.5);
        state.v[i] = v * random.between(0.5, 1.5);
    }
    state
}

/// Whether Σ nᵢ rᵢ vanishes beside its own terms; at states where a row is not defined nothing is asked.
fn vanishes(row: &[Measured], shift: &[i64]) -> bool {
    let terms = || row.iter().zip(shift).filter(|(_, multiple)| **multiple != 0);
    let value = terms().fold(DoubleDouble::ZERO, |sum, (entry, multiple)| sum + entry.value * (*multiple as f64));
    let magnitude = terms().map(|(entry, multiple)| entry.magnitude * multiple.unsigned_abs() as f64).sum();
    !f64::is_finite(magnitude) || Measured { value, magnitude }.vanishes(super::ROUNDINGS)
}

/// Rows that are reduced: each has a 1 where all others have 0.
#[derive(Default)]
struct Rows {
    rows: Vec<Vec<DoubleDouble>>,
    /// Where that is.
    pivots: Vec<usize>,
}

impl Rows {
    /// Adds a row; false where it is a combination of those before.
    fn add(&mut self, mut row: Vec<DoubleDouble>) -> bool {
        let size = |row: &[DoubleDouble]| row.iter().fold(0.0_f64, |most, x| most.max(x.to_f64().abs()));
        let whole = size(&row);
        for (known, pivot) in self.rows.iter().zip(&self.pivots) {
            subtract(&mut row, known, *pivot);
        }
        let largest = size(&row);
        if largest.is_nan() || largest <= REST * whole {
            return false;
        }
        let Some(pivot) = row.iter().position(|x| x.to_f64().abs() == largest) else { return false };
        let top = row[pivot];
        row.iter_mut().for_each(|x| *x = *x / top);
        self.rows.iter_mut().for_each(|known| subtract(known, &row, pivot));
        self.rows.push(row);
        self.pivots.push(pivot);
        true
    }

    /// A basis of what all rows are orthogonal to.
    fn directions(&self, n: usize) -> Vec<Vec<DoubleDouble>> {
        let free = (0..n).filter(|j| !self.pivots.contains(j));
        free.map(|j| {
            let mut direction = vec![DoubleDouble::ZERO; n];
            direction[j] = DoubleDouble::from(1.0);
            for (row, pivot) in self.rows.iter().zip(&self.pivots) {
                direction[*pivot] = -row[j];
            }
            direction
        })
        .collect()
    }
}

/// Takes from a row so much of another one that nothing is left at the pivot.
fn subtract(row: &mut [DoubleDouble], other: &[DoubleDouble], pivot: usize) {
    let factor = row[pivot];
    if factor != DoubleDouble::ZERO {
        row.iter_mut().zip(other).for_each(|(x, other)| *x = *x - factor * *other);
        row[pivot] = DoubleDouble::ZERO;
    }
}

/// Numbers as multiples of the same amount, without a common divisor, the first positive; `None` where they have no small ratio.
fn whole_numbers(values: impl Iterator<Item = f64>) -> Option<Vec<i64>> {
    let values: Vec<f64> = values.collect();
    let largest = values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let first = values.iter().copied().find(|x| x.abs() > 1e-12 * largest)?;
    // In parts of the first, times a denominator that serves all.
    let near = |x: f64| (x - x.round()).abs() <= 1e-12 * x.abs().max(1.0);
    let denominator = (1..=DENOMINATOR).map(f64::from).find(|d| values.iter().all(|x| near(x / first * d)))?;
    Some(values.iter().map(|x| (x / first * denominator).round() as i64).collect())
}
