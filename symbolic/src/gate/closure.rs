//! The Lie closure of the motions that constraints allow: how many of the constraints have integrals.
//!
//! Rows A q' + b = 0 are forms ω of (q, t), t being a coordinate of rate 1.  Fields z of (q, t) on which all ω vanish are the
//! motions that they allow; brackets [z, w] = ∂w·z − ∂z·w are where these lead when they alternate.  Brackets are added
//! until none leads further (Chow 1939; Neimark, Fufaev 1972, III; Bloch 2003, 5): integrals are as many as the forms less
//! the brackets that are independent.  One bracket is not enough: a rolling disc needs two.

use super::state::State;
use super::system::{plus, times, zero};
use crate::expr::{Forward, Graph, Id, Measured, Symbol, Tape};
use crate::number::DoubleDouble;

/// What is left of a bracket beside others counts when it is more than this of the sum of its own terms.  Double-doubles
/// leave some 1e-28 of what is nothing.
const INDEPENDENT: f64 = 1e-12;
/// An element that is less than this of its row's largest is no pivot.
const PIVOT: f64 = 1e-6;
/// The graph may grow by so many nodes.
const NODES: usize = 200_000;
/// Operations of all evaluations of brackets.
const WORK: usize = 40_000_000;

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
    /// Whether the work was bounded before the brackets ended.
    pub cut: bool,
    /// Brackets that are independent at some state, as fields.
    fields: Vec<Components>,
}

/// A bracket's numbers at a state: its direction, and the length of its terms' sums.
struct Numbers {
    values: Vec<DoubleDouble>,
    size: f64,
}

/// The directions that brackets have at a state.
struct Directions {
    /// Orthonormal.
    basis: Vec<Vec<DoubleDouble>>,
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

    /// The closure, decided at groups of states; pivots are chosen at the first state.
    pub fn closure(&self, graph: &mut Graph, groups: &[Vec<&State>]) -> Option<Closure> {
        let begin = graph.len();
        let first = groups.iter().flatten().next()?;
        let (allowed, pivots) = self.kernel(graph, first);
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
                for &p in &columns {
                    let (one, other) = (along[k].of(graph, field[p]), by_field.of(graph, allowed[k][p]));
                    bracket[p] = graph.sub(one, other);
                }
                let roots: Vec<Id> = columns.iter().map(|p| bracket[*p]).collect();
                if roots.iter().all(|x| *x == Id::ZERO) {
                    continue;
                }
                let tape = Tape::new(graph, &roots);
                work += tape.operations() * directions.len();
                closure.cut = work > WORK || graph.len() > begin + NODES || graph.overflowed();
                if closure.cut {
                    break 'brackets;
                }
                let mut grows = false;
                for (direction, (group, state)) in directions.iter_mut().zip(states()) {
                    let numbers = direction.numbers(&tape.measured(|s| state.value(s)));
                    if numbers.is_some_and(|numbers| direction.add(numbers)) && direction.basis.len() > known[group] {
                        known[group] = direction.basis.len();
                        grows = true;
                    }
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
    fn kernel(&self, graph: &mut Graph, state: &State) -> (Vec<Components>, Vec<(usize, usize)>) {
        let width = self.coordinates.len() + 1;
        let mut rows = self.rows.clone();
        let mut pivots: Vec<(usize, usize)> = Vec::new();
        let mut left: Vec<usize> = (0..rows.len()).collect();
        while !left.is_empty() {
            let roots: Vec<Id> = left.iter().flat_map(|row| rows[*row].iter().copied()).collect();
            let numbers = Tape::new(graph, &roots).measured(|s| state.value(s));
            let used = |column: usize| pivots.iter().any(|pivot| pivot.1 == column);
            let filled = |column: usize| left.iter().filter(|row| rows[**row][column] != Id::ZERO).count();
            // Row and column come last: among equals the first.
            let mut best: Option<(bool, bool, usize, usize, usize)> = None;
            let mut empty = Vec::new();
            for (place, row) in left.iter().enumerate() {
                let line = &numbers[place * width..][..width - 1];
                let there = |x: &Measured| x.value.to_f64().abs() > INDEPENDENT * x.magnitude;
                let largest = line.iter().filter(|x| there(x)).map(|x| x.value.to_f64().abs()).fold(0.0, f64::max);
                if largest == 0.0 {
                    empty.push(*row);
                    continue;
                }
                let entries = rows[*row].iter().filter(|x| **x != Id::ZERO).count();
                for (column, x) in line.iter().enumerate().filter(|(column, _)| !used(*column)) {
                    if there(x) && x.value.to_f64().abs() >= PIVOT * largest {
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
        (fields, pivots)
    }

    /// Differentiation along a field.
    fn along(&self, field: Components) -> Forward<impl Fn(&mut Graph, Symbol) -> Id + use<'_>> {
        Forward::new(move |_, symbol| self.place(symbol).map_or(Id::ZERO, |place| field[place]))
    }

    /// ω(w) of rows and brackets w at a state, each by the sum of its terms: rows on which brackets vanish have integrals.
    pub fn on_brackets(&self, graph: &Graph, closure: &Closure, state: &State) -> Vec<Vec<f64>> {
        let fields = closure.fields.iter().flatten();
        let roots: Vec<Id> = self.rows.iter().flatten().chain(fields).copied().collect();
        let numbers = Tape::new(graph, &roots).measured(|s| state.value(s));
        let width = self.coordinates.len() + 1;
        let (rows, fields) = numbers.split_at(self.rows.len() * width);
        let product = |row: &[Measured], field: &[Measured]| {
            let terms = row.iter().zip(field).map(|(x, y)| times(*x, *y));
            let sum = terms.fold(zero(), plus);
            let part = sum.value.to_f64() / sum.magnitude;
            if part.abs() > INDEPENDENT { part } else { 0.0 }
        };
        rows.chunks(width).map(|row| fields.chunks(width).map(|field| product(row, field)).collect()).collect()
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

    /// A bracket's components by their sizes; none where something is not finite.
    fn numbers(&self, bracket: &[Measured]) -> Option<Numbers> {
        let scaled = || bracket.iter().zip(&self.scales);
        let size = scaled().map(|(x, scale)| (x.magnitude / scale).powi(2)).sum::<f64>().sqrt();
        let values = scaled().map(|(x, scale)| x.value / DoubleDouble::from(*scale)).collect();
        size.is_finite().then_some(Numbers { values, size })
    }

    /// Adds a bracket where it leads out of the others.
    fn add(&mut self, Numbers { mut values, size }: Numbers) -> bool {
        // Twice is enough (Parlett 1980, 6-9).
        for _ in 0..2 {
            for known in &self.basis {
                let along = dot(&values, known);
                values.iter_mut().zip(known).for_each(|(x, y)| *x = *x - along * *y);
            }
        }
        let rest = dot(&values, &values).sqrt();
        let leads = rest.to_f64() > INDEPENDENT * size;
        if leads {
            self.basis.push(values.iter().map(|x| *x / rest).collect());
        }
        leads
    }
}

fn dot(x: &[DoubleDouble], y: &[DoubleDouble]) -> DoubleDouble {
    x.iter().zip(y).fold(DoubleDouble::ZERO, |sum, (x, y)| sum + *x * *y)
}
