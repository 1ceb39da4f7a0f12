//! States brought to the constraints, group by group of rows that share coordinates.

use std::collections::{BTreeMap, BTreeSet};

use super::state::State;
use crate::derive::Rows;
use crate::expr::{Graph, Id, Measured, Tape};
use crate::number::DoubleDouble;

/// Steps to the constraints at most.
const STEPS: usize = 60;
/// A constraint holds when it is this part of its own terms.
pub(super) const HOLDS: f64 = 1e-29;

/// Rows that share coordinates, directly or by way of others, ready to evaluate anywhere.
pub(super) struct Group {
    /// The coordinates that stand in these rows.
    coordinates: Vec<usize>,
    /// How many rows are holonomic: these stand first.
    holonomic: usize,
    /// How many rows there are.
    rows: usize,
    /// c of the holonomic rows.
    values: Tape,
    /// c' of all rows.
    rates: Tape,
    /// J's entries.
    entries: Tape,
    /// Where these stand: row, and place among `coordinates`.
    places: Vec<(usize, usize)>,
}

/// These rows in groups that have no coordinate in common, in the order of their first rows.
pub(super) fn groups(all: &Rows, rows: &[usize]) -> Vec<Vec<usize>> {
    let mut coordinates: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    all.matrix.iter().for_each(|e| coordinates.entry(e.0).or_default().push(e.1));
    let mut groups: Vec<(Vec<usize>, BTreeSet<usize>)> = Vec::new();
    for row in rows {
        let own = coordinates.get(row).map_or(&[] as &[usize], Vec::as_slice);
        let (met, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(|g| own.iter().any(|i| g.1.contains(i)));
        let mut joined = (vec![*row], own.iter().copied().collect::<BTreeSet<usize>>());
        for (rows, coordinates) in met {
            joined.0.extend(rows);
            joined.1.extend(coordinates);
        }
        groups = apart;
        groups.push(joined);
    }
    let mut groups: Vec<Vec<usize>> = groups.into_iter().map(|(rows, _)| rows).collect();
    groups.iter_mut().for_each(|rows| rows.sort_unstable());
    groups.sort_unstable();
    groups
}

impl Group {
    /// Of these rows among all.
    pub fn new(graph: &Graph, all: &Rows, rows: Vec<usize>) -> Group {
        let (mut ordered, rest): (Vec<usize>, Vec<usize>) = rows.into_iter().partition(|k| all.holonomic[*k]);
        let holonomic = ordered.len();
        ordered.extend(rest);
        let of = |list: &[Id], rows: &[usize]| rows.iter().map(|k| list[*k]).collect::<Vec<Id>>();
        let place: BTreeMap<usize, usize> = ordered.iter().enumerate().map(|(place, row)| (*row, place)).collect();
        let entries = all.matrix.iter().filter_map(|(row, i, x)| Some((*place.get(row)?, *i, *x)));
        let entries: Vec<(usize, usize, Id)> = entries.collect();
        let mut coordinates: Vec<usize> = entries.iter().map(|e| e.1).collect();
        coordinates.sort_unstable();
        coordinates.dedup();
        let column = |i: usize| coordinates.binary_search(&i).unwrap_or_default();
        Group {
            holonomic,
            rows: ordered.len(),
            values: Tape::new(graph, &of(&all.value, &ordered[..holonomic])),
            rates: Tape::new(graph, &of(&all.rate, &ordered)),
            entries: Tape::new(graph, &entries.iter().map(|e| e.2).collect::<Vec<_>>()),
            places: entries.iter().map(|e| (e.0, column(e.1))).collect(),
            coordinates,
        }
    }

    /// Whether a coordinate stands in its rows.
    pub fn contains(&self, coordinate: usize) -> bool {
        self.coordinates.binary_search(&coordinate).is_ok()
    }

    /// Moves the coordinates by the least change, measured by these weights (of all coordinates, 0 for what is held), until
    /// the holonomic rows hold.
    pub fn close_places(&self, state: &mut State, weights: &[f64]) -> bool {
        let mut damping = 1e-3;
        // What a constraint is made of on the way, where at its end it may be made of nothing.
        let mut sizes = vec![0.0_f64; self.holonomic];
        for _ in 0..STEPS {
            let c = self.values.measured(|s| state.value(s));
            match verdict(&c, &mut sizes) {
                Verdict::Undefined => return false,
                Verdict::Holds => return true,
                Verdict::Off => {}
            }
            let size = norm(&c, &sizes);
            // Near the end nothing is damped, so that every step gains what an `f64` holds.
            let near = c.iter().zip(&sizes).all(|(c, size)| c.value.abs().to_f64() <= 1e-6 * size);
            let lines = self.lines(state, self.holonomic, weights);
            let step = least(&lines, &opposite(&c), self.coordinates.len(), if near { 0.0 } else { damping });
            let Some(step) = step else { return false };
            let before: Vec<DoubleDouble> = self.coordinates.iter().map(|i| state.q[*i]).collect();
            self.add(&mut state.q, &step, weights);
            if near || norm(&self.values.measured(|s| state.value(s)), &sizes) < size {
                damping = (damping / 5.0_f64).max(1e-12);
            } else {
                self.coordinates.iter().zip(before).for_each(|(i, q)| state.q[*i] = q);
                damping *= 4.0;
                if damping > 1e12 {
                    return false;
                }
            }
        }
        false
    }

    /// Changes the speeds by the least change, measured by these weights, until the rates of all rows are zero.
    pub fn close_speeds(&self, state: &mut State, weights: &[f64]) -> bool {
        let mut sizes = vec![0.0_f64; self.rows];
        let mut lines = None;
        for _ in 0..8 {
            let rates = self.rates.measured(|s| state.value(s));
            match verdict(&rates, &mut sizes) {
                Verdict::Undefined => return false,
                Verdict::Holds => return true,
                Verdict::Off => {}
            }
            let lines = lines.get_or_insert_with(|| self.lines(state, self.rows, weights));
            let step = least(lines, &opposite(&rates), self.coordinates.len(), 0.0);
            let Some(step) = step else { return false };
            self.add(&mut state.v, &step, weights);
        }
        false
    }

    /// Notes what its speeds are known beside, measured by these weights: the largest of them.
    pub fn note_speeds(&self, state: &mut State, weights: &[f64]) {
        let size = |i: &usize| if weights[*i] > 0.0 { state.v[*i].to_f64().abs() / weights[*i] } else { 0.0 };
        let largest = self.coordinates.iter().map(size).fold(0.0, f64::max);
        self.coordinates.iter().for_each(|i| state.beside[*i] = largest * weights[*i]);
    }

    /// The first rows of J in `f64`, by coordinates that are measured by these weights.
    fn lines(&self, state: &State, rows: usize, weights: &[f64]) -> Vec<f64> {
        let n = self.coordinates.len();
        let mut lines = vec![0.0; rows * n];
        let entries: Vec<f64> = self.entries.evaluate(|s| state.value(s).to_f64());
        for ((row, column), x) in self.places.iter().zip(entries).filter(|((row, _), _)| *row < rows) {
            lines[row * n + column] = x * weights[self.coordinates[*column]];
        }
        lines
    }

    /// Adds a step of this group's coordinates to all coordinates or speeds.
    fn add(&self, list: &mut [DoubleDouble], step: &[f64], weights: &[f64]) {
        for (i, s) in self.coordinates.iter().zip(step) {
            list[*i] += DoubleDouble::from(*s * weights[*i]);
        }
    }
}

/// What residuals say of a state.
enum Verdict {
    Undefined,
    Holds,
    Off,
}

/// Judges residuals by the largest terms that each was made of so far.
fn verdict(residuals: &[Measured], sizes: &mut [f64]) -> Verdict {
    if residuals.iter().any(|c| !c.value.is_finite()) {
        return Verdict::Undefined;
    }
    residuals.iter().zip(sizes.iter_mut()).for_each(|(c, size)| *size = size.max(c.magnitude));
    // Where all terms of one vanish, rounding of rounding is left beside those of others.
    let least = HOLDS * sizes.iter().fold(0.0_f64, |most, size| most.max(*size));
    let holds = residuals.iter().zip(sizes.iter()).all(|(c, size)| c.value.abs().to_f64() <= HOLDS * size.max(least));
    if holds { Verdict::Holds } else { Verdict::Off }
}

fn opposite(residuals: &[Measured]) -> Vec<f64> {
    residuals.iter().map(|c| -c.value.to_f64()).collect()
}

fn norm(c: &[Measured], scales: &[f64]) -> f64 {
    let share = |(c, scale): (&Measured, &f64)| (c.value.to_f64() / scale.max(f64::MIN_POSITIVE)).powi(2);
    c.iter().zip(scales).map(share).sum::<f64>().sqrt()
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
