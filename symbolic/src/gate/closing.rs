//! States brought to the constraints, group by group of rows that share coordinates.

use std::collections::{BTreeMap, BTreeSet};

use super::rows::NEARLY;
use super::state::State;
use crate::derive::Rows;
use crate::expr::{Graph, Id, Measured, Tape};
use crate::model::Model;
use crate::number::DoubleDouble;

/// Steps to the constraints at most.
const STEPS: usize = 60;
/// A constraint holds when it is this part of its own terms.
pub(super) const HOLDS: f64 = 1e-29;
/// So many roundings of coordinates, one or two of each of a few, move a row without meaning.
const ROUNDINGS: f64 = 16.0;
/// Coordinates and speeds are known to this part of themselves at least, twenty digits as all tests ask for, or they are known beside what
/// constraints bring them there with: a speed beside what it was before they took nearly all of it.
const TOLD: f64 = 1e-20;

/// Rows that share coordinates, directly or by way of others, ready to evaluate anywhere.
pub(super) struct Group {
    /// The coordinates that stand in these rows.
    coordinates: Vec<usize>,
    /// For each of these, the place among them of the first that has its unit.
    alike: Vec<usize>,
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
    /// Of these rows among all, which stand in this graph.
    pub fn new((model, graph): (&Model, &Graph), all: &Rows, rows: Vec<usize>) -> Group {
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
        let unit = |i: usize| model.coordinates[i].unit.as_deref();
        let alike = |i: &usize| coordinates.iter().position(|other| unit(*other) == unit(*i)).unwrap_or_default();
        Group {
            alike: coordinates.iter().map(alike).collect(),
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
    /// the holonomic rows hold, and notes what the coordinates are known beside.
    pub fn close_places(&self, state: &mut State, weights: &[f64]) -> bool {
        let mut damping = 1e-3;
        // What a constraint is made of on the way, where at its end it may be made of nothing.
        let mut sizes = vec![0.0_f64; self.holonomic];
        for _ in 0..STEPS {
            let c = self.values.measured(|s| state.value(s));
            let entries = self.entries(state);
            let reach = self.reach(&entries, &state.q);
            match verdict(&c, &reach, &mut sizes) {
                Verdict::Undefined => return false,
                Verdict::Holds => {
                    self.note_places(
                        state,
                        (&entries, weights),
                        sizes.iter().zip(&reach).map(|(s, r)| held_to(*s, *r)),
                    );
                    return true;
                }
                Verdict::Off => {}
            }
            // Near the end nothing is damped, so that every step gains what an `f64` holds.
            let near = c.iter().zip(&sizes).all(|(c, size)| c.value.abs().to_f64() <= 1e-6 * size);
            let lines = self.lines(&entries, self.holonomic, weights);
            let scales = lengths(&lines, self.holonomic, self.coordinates.len());
            let step = least(&lines, &scales, &opposite(&c), if near { 0.0 } else { damping });
            let Some(step) = step else { return false };
            let before: Vec<DoubleDouble> = self.coordinates.iter().map(|i| state.q[*i]).collect();
            self.add(&mut state.q, &step, weights);
            // Steps that are short enough bring the state nearer by this measure, which is also theirs.
            if near || distance(&self.values.measured(|s| state.value(s)), &scales) < distance(&c, &scales) {
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
        let entries = self.entries(state);
        let lines = self.lines(&entries, self.rows, weights);
        let scales = lengths(&lines, self.rows, self.coordinates.len());
        for _ in 0..8 {
            let rates = self.rates.measured(|s| state.value(s));
            match verdict(&rates, &self.reach(&entries, &state.v), &mut sizes) {
                Verdict::Undefined => return false,
                Verdict::Holds => return true,
                Verdict::Off => {}
            }
            let step = least(&lines, &scales, &opposite(&rates), 0.0);
            let Some(step) = step else { return false };
            self.add(&mut state.v, &step, weights);
        }
        false
    }

    /// Notes what its coordinates are known beside, where each of its rows is known to vanish to so much: rows of which one hardly stands out of the
    /// others leave the more to them.
    fn note_places(&self, state: &mut State, (entries, weights): (&[f64], &[f64]), held: impl Iterator<Item = f64>) {
        let lines = self.lines(entries, self.holonomic, weights);
        let scales = lengths(&lines, self.holonomic, self.coordinates.len());
        let moved = held.zip(&scales).filter(|(_, scale)| **scale > 0.0).map(|(held, scale)| held / scale);
        let off = moved.fold(0.0, f64::max) / (NEARLY * TOLD);
        state.near.resize(state.q.len(), 0.0);
        self.coordinates.iter().for_each(|i| state.near[*i] = state.near[*i].max(off * weights[*i]));
    }

    /// The largest of its speeds, measured by these weights.
    pub fn fastest(&self, state: &State, weights: &[f64]) -> f64 {
        let size = |i: &usize| if weights[*i] > 0.0 { state.v[*i].to_f64().abs() / weights[*i] } else { 0.0 };
        self.coordinates.iter().map(size).fold(0.0, f64::max)
    }

    /// Notes what its speeds are known beside, measured by these weights: the largest of them, or what they are known to of what they were before.
    pub fn note_speeds(&self, state: &mut State, weights: &[f64], before: f64) {
        let largest = self.fastest(state, weights).max(HOLDS / TOLD * before);
        self.coordinates.iter().for_each(|i| state.beside[*i] = largest * weights[*i]);
    }

    /// J's entries in `f64`.
    fn entries(&self, state: &State) -> Vec<f64> {
        self.entries.evaluate(|s| state.value(s).to_f64())
    }

    /// How much the coordinates (or speeds) in `list` move each row, every one taken for as large as the largest with its unit: what constraints
    /// keep at zero is held to the rounding of these.
    fn reach(&self, entries: &[f64], list: &[DoubleDouble]) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.coordinates.len()];
        for (i, first) in self.coordinates.iter().zip(&self.alike) {
            largest[*first] = largest[*first].max(list[*i].to_f64().abs());
        }
        let mut reach = vec![0.0; self.rows];
        for ((row, column), entry) in self.places.iter().zip(entries) {
            reach[*row] += entry.abs() * largest[self.alike[*column]];
        }
        reach
    }

    /// The first rows of J, by coordinates that are measured by these weights.
    fn lines(&self, entries: &[f64], rows: usize, weights: &[f64]) -> Vec<f64> {
        let n = self.coordinates.len();
        let mut lines = vec![0.0; rows * n];
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

/// Judges residuals by the largest terms that each was made of so far, or by the rounding of what moves it: where all its terms vanish no more is known.
fn verdict(residuals: &[Measured], reach: &[f64], sizes: &mut [f64]) -> Verdict {
    if residuals.iter().any(|c| !c.value.is_finite()) {
        return Verdict::Undefined;
    }
    residuals.iter().zip(sizes.iter_mut()).for_each(|(c, size)| *size = size.max(c.magnitude));
    let mut rows = residuals.iter().zip(sizes.iter().zip(reach));
    match rows.all(|(c, (size, reach))| c.value.abs().to_f64() <= held_to(*size, *reach)) {
        true => Verdict::Holds,
        false => Verdict::Off,
    }
}

/// How near to zero a row is brought.
fn held_to(size: f64, reach: f64) -> f64 {
    let rounding = if reach.is_finite() { ROUNDINGS * DoubleDouble::UNIT * reach } else { 0.0 };
    (HOLDS * size).max(rounding)
}

fn opposite(residuals: &[Measured]) -> Vec<f64> {
    residuals.iter().map(|c| -c.value.to_f64()).collect()
}

/// How far the coordinates are from all rows together, each taken for linear; a row that nothing changes has no part in it.
fn distance(c: &[Measured], scales: &[f64]) -> f64 {
    let share = |(c, scale): (&Measured, &f64)| if *scale > 0.0 { (c.value.to_f64() / scale).powi(2) } else { 0.0 };
    c.iter().zip(scales).map(share).sum::<f64>().sqrt()
}

/// The lengths of so many lines of n numbers.
pub(super) fn lengths(lines: &[f64], rows: usize, n: usize) -> Vec<f64> {
    (0..rows).map(|k| lines[k * n..][..n].iter().map(|x| x * x).sum::<f64>().sqrt()).collect()
}

/// The least step x with A x = b, or where it is damped the least |A x − b|² + damping |x|², the rows of A and b divided by these scales,
/// their lengths: AᵀA is not formed, but A Aᵀ with its diagonal raised, and what depends on other rows left out.
pub(super) fn least(lines: &[f64], scale: &[f64], right: &[f64], damping: f64) -> Option<Vec<f64>> {
    let (m, n) = (right.len(), lines.len() / right.len().max(1));
    let line = |k: usize| &lines[k * n..][..n];
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
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
