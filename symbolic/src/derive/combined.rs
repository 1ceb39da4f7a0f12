//! Combinations of velocity constraints that are rates, where none of them is by itself.
//!
//! A row is a form ω = Σ A_i dq_i + b dt, closed where dω = 0.  Σ a_k ω_k with constant numbers a is closed where
//! Σ a_k dω_k = 0 in every state: the a are what the values of the dω_k at a few states leave.  Elimination chooses
//! combinations that have one row each which stands in no other, beside rows that are left without an integral.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;

use super::integrals::integral;
use crate::expr::{Graph, Id, Rational, Symbol, Tape, jacobian};
use crate::number::DoubleDouble;
use crate::random::Random;

/// A combination of rows whose integral was found: its own row once, and numbers times others.
pub(super) struct Combination {
    pub row: usize,
    pub others: Vec<(usize, Rational)>,
    pub integral: Id,
}

/// More rows than this are not combined.
const ROWS: usize = 32;
/// Values are taken at so many states, out of so many draws.
const STATES: usize = 4;
const DRAWS: usize = 16;
/// What is no more than this beside 1 is zero.
const ZERO: f64 = 1e-9;
/// Numbers in combinations are fractions with denominators up to this.
const DENOMINATOR: i64 = 12;

/// Combinations of some rows, whose elements and drives are given for all rows.
pub(super) fn combinations(
    graph: &mut Graph,
    lines: &[Vec<(usize, Id)>],
    drive: &[Id],
    rows: &[usize],
) -> Vec<Combination> {
    let plain = |row: &usize| {
        let symbols = graph.symbols(lines[*row].iter().map(|e| e.1).chain([drive[*row]]));
        symbols.iter().all(|s| matches!(s, Symbol::Coordinate(_) | Symbol::Parameter(_) | Symbol::Time))
    };
    let rows: Vec<usize> = rows.iter().copied().filter(plain).collect();
    if !(2..=ROWS).contains(&rows.len()) {
        return Vec::new();
    }
    let Some(curls) = curls(graph, lines, drive, &rows) else { return Vec::new() };
    let closed = closed(curls, rows.len());
    closed.into_iter().filter_map(|(own, others)| combined(graph, lines, drive, &rows, own, &others)).collect()
}

/// The components of dω of every row at a few states: a line for each component and state, a column for each row; none
/// where there are no states.
fn curls(graph: &mut Graph, lines: &[Vec<(usize, Id)>], drive: &[Id], rows: &[usize]) -> Option<Vec<Vec<f64>>> {
    // Time is the first of the variables.
    let place = |s: Symbol| match s {
        Symbol::Time => Some(0),
        Symbol::Coordinate(i) => Some(i as usize + 1),
        _ => None,
    };
    let (mut places, mut slopes) = (Vec::new(), Vec::new());
    for (k, &row) in rows.iter().enumerate() {
        let elements: Vec<(usize, Id)> =
            [(0, drive[row])].into_iter().chain(lines[row].iter().map(|e| (e.0 + 1, e.1))).collect();
        let roots: Vec<Id> = elements.iter().map(|e| e.1).collect();
        for ((i, _), line) in elements.iter().zip(jacobian(graph, &roots, place)) {
            for (j, slope) in line.into_iter().filter(|e| e.0 != *i) {
                places.push((k, (j.min(*i), j.max(*i)), if j < *i { 1.0 } else { -1.0 }));
                slopes.push(slope);
            }
        }
    }
    let tape = Tape::new(graph, &slopes);
    let symbols = graph.symbols(slopes);
    let mut random = Random::new();
    let mut found = Vec::new();
    let mut states = 0;
    for _ in 0..DRAWS {
        let values: HashMap<Symbol, f64> = symbols.iter().map(|s| (*s, random.between(0.3, 1.7))).collect();
        let numbers = tape.evaluate(|s| DoubleDouble::from(values.get(&s).copied().unwrap_or(0.0)));
        if numbers.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let mut components: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
        for ((k, pair, sign), x) in places.iter().zip(numbers) {
            components.entry(*pair).or_insert_with(|| vec![0.0; rows.len()])[*k] += sign * x.to_f64();
        }
        found.extend(components.into_values());
        states += 1;
        if states == STATES {
            break;
        }
    }
    (states > 0).then_some(found)
}

/// The numbers with which columns add up to nothing: for each combination its own column, which counts once and is in no
/// other, and the others with their factors.
fn closed(mut lines: Vec<Vec<f64>>, columns: usize) -> Vec<(usize, Vec<(usize, f64)>)> {
    let mut pivots: Vec<usize> = Vec::new();
    let mut free: Vec<usize> = Vec::new();
    for line in &mut lines {
        let size = line.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        line.iter_mut().filter(|_| size > 0.0).for_each(|x| *x /= size);
    }
    for column in 0..columns {
        let below = pivots.len()..lines.len();
        let best = below.max_by(|a, b| lines[*a][column].abs().total_cmp(&lines[*b][column].abs()));
        let Some(best) = best.filter(|k| lines[*k][column].abs() > ZERO) else {
            free.push(column);
            continue;
        };
        let own = pivots.len();
        lines.swap(own, best);
        let pivot = lines[own][column];
        lines[own].iter_mut().for_each(|x| *x /= pivot);
        let taken = lines[own].clone();
        for line in lines.iter_mut().enumerate().filter(|(k, _)| *k != own).map(|e| e.1) {
            let factor = line[column];
            line.iter_mut().zip(&taken).for_each(|(x, y)| *x -= factor * y);
        }
        pivots.push(column);
    }
    let others = |column: usize| {
        let factors = pivots.iter().zip(&lines).map(|(pivot, line)| (*pivot, -line[column]));
        factors.filter(|e| e.1.abs() > ZERO).collect::<Vec<(usize, f64)>>()
    };
    free.into_iter().map(|column| (column, others(column))).filter(|e| !e.1.is_empty()).collect()
}

/// A combination in exact numbers, and its integral; none where either is not found.
fn combined(
    graph: &mut Graph,
    lines: &[Vec<(usize, Id)>],
    drive: &[Id],
    rows: &[usize],
    own: usize,
    others: &[(usize, f64)],
) -> Option<Combination> {
    let exact = |(k, factor): &(usize, f64)| Some((rows[*k], fraction(*factor)?));
    let others: Vec<(usize, Rational)> = others.iter().map(exact).collect::<Option<_>>()?;
    let mut sums: BTreeMap<usize, Id> = lines[rows[own]].iter().copied().collect();
    let mut driven = drive[rows[own]];
    for (row, factor) in &others {
        let factor = graph.rational(*factor);
        for (i, x) in &lines[*row] {
            let (term, sum) = (graph.mul(factor, *x), sums.get(i).copied().unwrap_or(Id::ZERO));
            sums.insert(*i, graph.add(sum, term));
        }
        let term = graph.mul(factor, drive[*row]);
        driven = graph.add(driven, term);
    }
    let line: Vec<(usize, Id)> = sums.into_iter().filter(|e| e.1 != Id::ZERO).collect();
    let integral = integral(graph, &line, driven)?;
    Some(Combination { row: rows[own], others, integral })
}

/// The fraction that a number is.
fn fraction(x: f64) -> Option<Rational> {
    let near = |q: &i64| (x * *q as f64 - (x * *q as f64).round()).abs() <= ZERO * x.abs().max(1.0);
    let q = (1..=DENOMINATOR).find(near)?;
    Rational::new((x * q as f64).round() as i128, q.into())
}
