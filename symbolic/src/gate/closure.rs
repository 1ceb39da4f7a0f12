//! The Lie closure of the motions that constraints allow: how many of the constraints have integrals.
//!
//! Rows A q' + b = 0 are forms ω of (q, t), t being a coordinate of rate 1.  Fields z of (q, t) on which all ω vanish are the
//! motions that they allow; brackets [z, w] = ∂w·z − ∂z·w are where these lead when they alternate.  Brackets are added
//! until none leads further (Chow 1939; Neimark, Fufaev 1972, III; Bloch 2003, 5): integrals are as many as the forms less
//! the brackets that are independent.  One bracket is not enough: a rolling disc needs two.

use super::state::State;
use crate::expr::{Forward, Graph, Id, Symbol, Tape};
use crate::number::DoubleDouble;

/// What `f64` misses by this factor is known of a double-double: positions meet constraints to 29 digits, and ten powers of
/// ten are left for bad luck.
const NOISE: f64 = 1e-10;
/// Roundings of a difference at least.
const UNITS: f64 = 1e3;
/// What is no more than this of what `f64` misses is nothing.
const NOTHING: f64 = 1e-8;
/// Nothing is known of a bracket where noise is more than this of the two terms that it is the difference of.
const DROWNED: f64 = 1e-8;
/// An element that is less than this of its row's largest is no pivot.
const PIVOT: f64 = 1e-6;
/// The graph may grow by so many nodes.
const NODES: usize = 200_000;
/// Operations of all evaluations.
const WORK: usize = 20_000_000;

/// (row, column) of pivots, in the order in which they were chosen.
type Pivots = Vec<(usize, usize)>;

/// A form or a field: its components, those of the coordinates that take part and then that of time.
type Components = Vec<Id>;

/// Rows of constraints as forms ω, over the coordinates that take part in them and time.
pub(super) struct Forms {
    /// The coordinates.
    pub coordinates: Vec<usize>,
    /// The rows, those first of which integrals are known.
    pub rows: Vec<Components>,
    /// How many these are.
    pub closed: usize,
}

/// What the closure tells.
pub(super) struct Closure {
    /// Rows that are independent, by their places among the forms.
    pub independent: Vec<usize>,
    /// How many brackets are independent, at most, at the states of each group.
    pub brackets: Vec<usize>,
    /// Whether the work was bounded before the brackets ended, or rounding left nothing to decide by.
    pub cut: bool,
    /// Brackets that are independent at some state, as fields.
    fields: Vec<Components>,
}

/// Numbers at a state in double-double, and how far those in `f64` are from them: the sensitivity to rounding, of which
/// running magnitudes are too large a bound after long eliminations.
struct Numbers {
    exact: Vec<DoubleDouble>,
    missed: Vec<f64>,
}

impl Numbers {
    fn of(tape: &Tape, state: &State) -> Numbers {
        let exact: Vec<DoubleDouble> = tape.evaluate(|s| state.value(s));
        let rough: Vec<f64> = tape.evaluate(|s| state.value(s).to_f64());
        let missed = exact.iter().zip(rough).map(|(x, y)| (*x - DoubleDouble::from(y)).to_f64().abs()).collect();
        Numbers { exact, missed }
    }
}

/// The directions that brackets have at a state.
struct Directions {
    /// Orthonormal, and what noise there is in each.
    basis: Vec<(Vec<DoubleDouble>, f64)>,
    /// Sizes of the components.
    scales: Vec<f64>,
}

impl Forms {
    /// The place of a symbol among the components.
    fn place(&self, symbol: Symbol) -> Option<usize> {
        match symbol {
            Symbol::Time => Some(self.coordinates.len()),
            Symbol::Coordinate(i) => self.coordinates.iter().position(|c| *c == i as usize),
            _ => None,
        }
    }

    /// The closure, decided at groups of states; pivots are chosen at the first state.  None where the motions that are
    /// allowed would take too much room.
    pub fn closure(&self, graph: &mut Graph, groups: &[Vec<&State>]) -> Option<Closure> {
        let begin = graph.len();
        let first = groups.iter().flatten().next()?;
        let (allowed, pivots) = self.kernel(graph, first)?;
        let independent: Vec<usize> = pivots.iter().map(|pivot| pivot.0).collect();
        // No bracket leads out of what has integrals.
        let most = independent.iter().filter(|row| **row >= self.closed).count();
        let columns: Vec<usize> = pivots.iter().map(|pivot| pivot.1).collect();
        // All other components of a field are constants, so brackets have none.
        let states = || groups.iter().enumerate().flat_map(|(k, group)| group.iter().map(move |state| (k, *state)));
        let mut directions: Vec<Directions> =
            states().map(|(_, state)| Directions::new(graph, &allowed, &columns, state)).collect();
        let mut known = vec![0; groups.len()];
        let mut closure = Closure { independent, brackets: Vec::new(), cut: false, fields: Vec::new() };
        let mut work = 0;
        let mut along: Vec<_> = allowed.iter().map(|field| self.along(field.clone())).collect();
        // Each field with those of the motions before it, then brackets with all of them.
        let mut next = 0;
        'brackets: while next < allowed.len() + closure.fields.len() && known.iter().any(|known| *known < most) {
            let is_bracket = next >= allowed.len();
            let field = if is_bracket { closure.fields[next - allowed.len()].clone() } else { allowed[next].clone() };
            let mut by_field = self.along(field.clone());
            for k in 0..if is_bracket { allowed.len() } else { next } {
                let mut bracket = vec![Id::ZERO; field.len()];
                let mut roots = Vec::with_capacity(3 * columns.len());
                for &p in &columns {
                    let (one, other) = (along[k].of(graph, field[p]), by_field.of(graph, allowed[k][p]));
                    bracket[p] = graph.sub(one, other);
                    roots.extend([bracket[p], one, other]);
                }
                if bracket.iter().all(|x| *x == Id::ZERO) {
                    continue;
                }
                let tape = Tape::new(graph, &roots);
                work += tape.operations() * directions.len();
                closure.cut = work > WORK || graph.len() > begin + NODES || graph.overflowed();
                if closure.cut {
                    break 'brackets;
                }
                let numbers: Vec<Numbers> = states().map(|(_, state)| Numbers::of(&tape, state)).collect();
                let missed =
                    |(direction, numbers): (&Directions, &Numbers)| direction.length(numbers, |x, k| x.missed[k]);
                let missed = directions.iter().zip(&numbers).map(missed).filter(|x| x.is_finite()).fold(0.0, f64::max);
                let (mut grows, mut drowned) = (false, true);
                for ((direction, (group, _)), numbers) in directions.iter_mut().zip(states()).zip(&numbers) {
                    let Some(leads) = direction.add(numbers, missed) else { continue };
                    drowned = false;
                    if leads && direction.basis.len() > known[group] {
                        known[group] = direction.basis.len();
                        grows = true;
                    }
                }
                if drowned {
                    closure.cut = true;
                    break 'brackets;
                }
                if grows {
                    closure.fields.push(bracket);
                }
            }
            next += 1;
        }
        closure.brackets = known;
        Some(closure)
    }

    /// Fields on which all forms vanish, one for each column without a pivot, and the pivots (row, column).
    ///
    /// Gauss and Jordan's elimination in the graph, rows with integrals first; pivots are constants where there are any, and
    /// else fill little.  Time has none: it always passes.
    fn kernel(&self, graph: &mut Graph, state: &State) -> Option<(Vec<Components>, Pivots)> {
        let (begin, mut work) = (graph.len(), 0);
        let width = self.coordinates.len() + 1;
        let mut rows = self.rows.clone();
        let mut pivots: Vec<(usize, usize)> = Vec::new();
        let mut left: Vec<usize> = (0..rows.len()).collect();
        while !left.is_empty() {
            let roots: Vec<Id> = left.iter().flat_map(|row| rows[*row].iter().copied()).collect();
            let tape = Tape::new(graph, &roots);
            work += tape.operations();
            if work > WORK || graph.len() > begin + NODES || graph.overflowed() {
                return None;
            }
            let numbers = Numbers::of(&tape, state);
            let used = |column: usize| pivots.iter().any(|pivot| pivot.1 == column);
            let filled = |column: usize| left.iter().filter(|row| rows[**row][column] != Id::ZERO).count();
            // Row and column come last: among equals the first.
            let mut best: Option<(bool, bool, usize, usize, usize)> = None;
            let mut empty = Vec::new();
            for (place, row) in left.iter().enumerate() {
                let span = place * width..(place + 1) * width - 1;
                let missed = numbers.missed[span.clone()].iter().fold(0.0_f64, |most, x| most.max(*x));
                let sizes = numbers.exact[span].iter().map(|x| x.to_f64().abs());
                let line: Vec<f64> = sizes.map(|x| if x > NOTHING * missed { x } else { 0.0 }).collect();
                let largest = line.iter().copied().fold(0.0, f64::max);
                if largest == 0.0 {
                    empty.push(*row);
                    continue;
                }
                let entries = rows[*row].iter().filter(|x| **x != Id::ZERO).count();
                for (column, x) in line.iter().enumerate().filter(|(column, _)| !used(*column)) {
                    if *x >= PIVOT * largest {
                        let varies = graph.number(rows[*row][column]).is_none();
                        let fill = (entries - 1) * (filled(column) - 1);
                        let key = (*row >= self.closed, varies, fill, *row, column);
                        best = Some(best.map_or(key, |known| known.min(key)));
                    }
                }
            }
            left.retain(|row| !empty.contains(row));
            let Some((.., row, column)) = best else { break };
            left.retain(|other| *other != row);
            pivots.push((row, column));
            let pivot = rows[row][column];
            for x in &mut rows[row] {
                *x = graph.div(*x, pivot);
            }
            rows[row][column] = Id::ONE;
            let line = rows[row].clone();
            for (other, entries) in rows.iter_mut().enumerate().filter(|(other, _)| *other != row) {
                let factor = entries[column];
                if factor == Id::ZERO || !(left.contains(&other) || pivots.iter().any(|p| p.0 == other)) {
                    continue;
                }
                for (x, y) in entries.iter_mut().zip(&line).filter(|(_, y)| **y != Id::ZERO) {
                    let product = graph.mul(factor, *y);
                    *x = graph.sub(*x, product);
                }
                entries[column] = Id::ZERO;
            }
        }
        let free = (0..width).filter(|column| !pivots.iter().any(|pivot| pivot.1 == *column));
        let mut fields = Vec::new();
        for column in free {
            let mut field = vec![Id::ZERO; width];
            field[column] = Id::ONE;
            for (row, pivot) in &pivots {
                field[*pivot] = graph.neg(rows[*row][column]);
            }
            fields.push(field);
        }
        Some((fields, pivots))
    }

    /// Differentiation along a field.
    fn along(&self, field: Components) -> Forward<impl Fn(&mut Graph, Symbol) -> Id + use<'_>> {
        Forward::new(move |_, symbol| self.place(symbol).map_or(Id::ZERO, |place| field[place]))
    }

    /// ω(w) of rows and brackets w, state by state, 0 for noise: rows on which all brackets vanish have integrals.
    pub fn on_brackets(&self, graph: &mut Graph, closure: &Closure, states: &[&State]) -> Vec<Vec<Vec<f64>>> {
        let (width, mut products) = (closure.fields.len(), Vec::new());
        for row in &self.rows {
            for field in &closure.fields {
                let terms: Vec<Id> = row.iter().zip(field).map(|(x, y)| graph.mul(*x, *y)).collect();
                products.push(terms.into_iter().fold(Id::ZERO, |sum, term| graph.add(sum, term)));
            }
        }
        let tape = Tape::new(graph, &products);
        let numbers: Vec<Numbers> = states.iter().map(|state| Numbers::of(&tape, state)).collect();
        let missed = |k: usize| numbers.iter().map(|x| x.missed[k]).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let missed: Vec<f64> = (0..products.len()).map(missed).collect();
        let values = numbers.iter().zip(states).map(|(numbers, state)| {
            let floor = tape.measured(|s| state.value(s)).into_iter().map(|x| UNITS * DoubleDouble::UNIT * x.magnitude);
            let noise = floor.zip(&missed).map(|(floor, missed)| floor.max(NOTHING * missed));
            let value = |(x, noise): (&DoubleDouble, f64)| if x.to_f64().abs() > noise { x.to_f64() } else { 0.0 };
            let values: Vec<f64> = numbers.exact.iter().zip(noise).map(value).collect();
            (0..self.rows.len()).map(|row| values[row * width..][..width].to_vec()).collect()
        });
        values.collect()
    }
}

impl Directions {
    /// None yet; a component is measured by what it is in the motions themselves, whatever its unit.
    fn new(graph: &Graph, allowed: &[Components], columns: &[usize], state: &State) -> Directions {
        let roots: Vec<Id> = allowed.iter().flat_map(|field| columns.iter().map(|p| field[*p])).collect();
        let numbers = Tape::new(graph, &roots).measured(|s| state.value(s));
        let mut scales = vec![0.0_f64; columns.len()];
        for line in numbers.chunks(columns.len().max(1)) {
            scales.iter_mut().zip(line).for_each(|(scale, x)| *scale = scale.max(x.magnitude));
        }
        scales.iter_mut().filter(|scale| **scale == 0.0).for_each(|scale| *scale = 1.0);
        Directions { basis: Vec::new(), scales }
    }

    /// The length of some part of a bracket's components, by their sizes.
    fn length(&self, numbers: &Numbers, part: impl Fn(&Numbers, usize) -> f64) -> f64 {
        let parts = self.scales.iter().enumerate().map(|(k, scale)| part(numbers, 3 * k) / scale);
        parts.map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Adds a bracket (each component with the two terms that it is the difference of) where it leads out of the others,
    /// `missed` being what `f64` misses of such brackets; none where noise drowns it.
    fn add(&mut self, numbers: &Numbers, missed: f64) -> Option<bool> {
        let term = |x: &Numbers, k: usize| x.exact[k + 1].to_f64().abs() + x.exact[k + 2].to_f64().abs();
        let size = self.length(numbers, term);
        if !size.is_finite() {
            return None;
        }
        let scaled = |(k, scale): (usize, &f64)| numbers.exact[3 * k] / DoubleDouble::from(*scale);
        let mut values: Vec<DoubleDouble> = self.scales.iter().enumerate().map(scaled).collect();
        let mut noise = NOISE * missed + UNITS * DoubleDouble::UNIT * size;
        // Twice is enough (Parlett 1980, 6-9).
        for _ in 0..2 {
            for (known, of_known) in &self.basis {
                let along = dot(&values, known);
                noise += along.to_f64().abs() * of_known;
                values.iter_mut().zip(known).for_each(|(x, y)| *x = *x - along * *y);
            }
        }
        let rest = dot(&values, &values).sqrt();
        if rest.to_f64() > noise {
            self.basis.push((values.iter().map(|x| *x / rest).collect(), noise / rest.to_f64()));
            return Some(true);
        }
        // Both terms are nothing, or their difference is well below them.
        (size <= NOTHING * missed || noise <= DROWNED * size).then_some(false)
    }
}

fn dot(x: &[DoubleDouble], y: &[DoubleDouble]) -> DoubleDouble {
    x.iter().zip(y).fold(DoubleDouble::ZERO, |sum, (x, y)| sum + *x * *y)
}
