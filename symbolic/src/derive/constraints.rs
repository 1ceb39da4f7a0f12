//! The rows of the constraints, differentiated as often as accelerations need.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap as HashMap;

use super::combined::combinations;
use super::integrals::integral;
use super::vanishing::without_vanishing;
use super::{bias_rates, rates};
use crate::expr::{Forward, Graph, Id, Rational, Symbol, gradients, jacobian, reverse};
use crate::model::Model;

/// All rows of the constraints, in file order, whatever the phase.
///
/// A holonomic row c(t, q) = 0 is differentiated twice, c'' = J q'' + γ with J = ∂c/∂q; one that contains speeds,
/// c(t, q, q') = J q' + b = 0, once: c' = J q'' + γ.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    /// c.
    pub value: Vec<Id>,
    /// c'; of a row that contains speeds c itself.
    pub rate: Vec<Id>,
    /// The part of `rate` that is there at rest, ∂c/∂t or b: what makes the row do work, −λ times this.
    pub drive: Vec<Id>,
    /// The non-zeros of J: (row, coordinate, value).
    pub matrix: Vec<(usize, usize, Id)>,
    /// γ.
    pub bias: Vec<Id>,
    /// Σ λ_k J_k: the generalized forces of the multipliers.
    pub forces: Vec<Id>,
    /// Whether a row contains no speeds.
    pub holonomic: Vec<bool>,
    /// A function of t and q whose rate a row with speeds is, by itself or with `with`, where one was found.
    pub integral: Vec<Option<Id>>,
    /// The rows, with factors, that make an integral's rate together with its own row.  They have no integrals, and act in
    /// the same phases.
    pub with: Vec<Vec<(usize, Rational)>>,
}

impl Rows {
    /// Differentiates the model's constraints.
    pub fn of(model: &mut Model) -> Rows {
        let graph = &mut model.graph;
        let value: Vec<Id> = model.constraints.iter().flat_map(|c| c.value.iter().copied()).collect();
        let value = without_vanishing(graph, &value);
        let holonomic: Vec<bool> = model.constraints.iter().flat_map(|c| c.value.iter().map(|_| c.holonomic)).collect();
        let first = rates(graph, &value);
        let rate: Vec<Id> = (0..value.len()).map(|k| if holonomic[k] { first[k] } else { value[k] }).collect();
        let column = |s: Symbol| if let Symbol::Speed(i) = s { Some(i as usize) } else { None };
        let lines = jacobian(graph, &rate, column);
        let lines = telling(graph, lines);
        let bias = bias_rates(graph, &rate);
        let bias = without_vanishing(graph, &bias);
        let drive = at_rest(graph, &rate);
        let drive = without_vanishing(graph, &drive);
        let integral = lines.iter().enumerate().map(|(k, line)| match holonomic[k] {
            true => None,
            false => integral(graph, line, drive[k]),
        });
        let mut integral: Vec<Option<Id>> = integral.collect();
        let mut with = vec![Vec::new(); integral.len()];
        for rows in alike(model, &holonomic, &integral) {
            for found in combinations(&mut model.graph, &lines, &drive, &rows) {
                integral[found.row] = Some(found.integral);
                with[found.row] = found.others;
            }
        }
        let graph = &mut model.graph;
        let matrix = lines.into_iter().enumerate();
        let matrix: Vec<(usize, usize, Id)> =
            matrix.flat_map(|(k, line)| line.into_iter().map(move |(i, x)| (k, i, x))).collect();
        let forces = forces(graph, &matrix, model.coordinates.len());
        Rows { value, rate, drive, matrix, bias, forces, holonomic, integral, with }
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.value.len()
    }

    /// True without constraints.
    pub fn is_empty(&self) -> bool {
        self.value.is_empty()
    }

    /// The elements of the rate of a row's integral by coordinates, and what drives it: the row, with what it needs.
    pub fn of_integral(&self, graph: &mut Graph, row: usize) -> (BTreeMap<usize, Id>, Id) {
        let one = Rational::integer(1);
        let (mut sums, mut drive) = (BTreeMap::new(), Id::ZERO);
        for (row, factor) in [(row, one)].iter().chain(&self.with[row]) {
            let factor = graph.rational(*factor);
            for (_, i, x) in self.matrix.iter().filter(|entry| entry.0 == *row) {
                let (term, sum) = (graph.mul(factor, *x), sums.get(i).copied().unwrap_or(Id::ZERO));
                sums.insert(*i, graph.add(sum, term));
            }
            let term = graph.mul(factor, self.drive[*row]);
            drive = graph.add(drive, term);
        }
        (sums, drive)
    }

    /// Whether rows determine some of n accelerations by themselves: one after the other where a row has one unknown left, or all of them.
    pub fn determine(&self, n: usize) -> bool {
        let unknowns = |row: usize| self.matrix.iter().filter(|entry| entry.0 == row).count();
        self.len() >= n || (0..self.len()).any(|row| unknowns(row) == 1)
    }

    /// J q'' + γ of some rows.
    pub fn accelerations(&self, graph: &mut Graph, rows: &[usize]) -> Vec<Id> {
        let mut sums: Vec<Id> = rows.iter().map(|row| self.bias[*row]).collect();
        for &(row, i, x) in &self.matrix {
            let Some(place) = rows.iter().position(|r| *r == row) else { continue };
            let a = graph.symbol(Symbol::Acceleration(i as u32));
            let term = graph.mul(x, a);
            sums[place] = graph.add(sums[place], term);
        }
        sums
    }

    /// The power of the multipliers' forces on the motion, −Σ λ_k (∂c_k/∂t or b_k): 0 where nothing moves a constraint.
    pub fn power(&self, graph: &mut Graph) -> Id {
        let mut power = Id::ZERO;
        for (row, drive) in self.drive.iter().enumerate() {
            let multiplier = graph.symbol(Symbol::Multiplier(row as u32));
            let term = graph.mul(*drive, multiplier);
            power = graph.sub(power, term);
        }
        power
    }
}

/// Lines of J without what vanishes identically.
fn telling(graph: &Graph, lines: Vec<Vec<(usize, Id)>>) -> Vec<Vec<(usize, Id)>> {
    let all: Vec<Id> = lines.iter().flatten().map(|entry| entry.1).collect();
    let mut known = without_vanishing(graph, &all).into_iter();
    let mut kept = |line: Vec<(usize, Id)>| -> Vec<(usize, Id)> {
        line.into_iter().zip(known.by_ref()).map(|((i, _), x)| (i, x)).filter(|(_, x)| *x != Id::ZERO).collect()
    };
    lines.into_iter().map(&mut kept).collect()
}

/// Rows with speeds and without integrals, those that act in the same phases together.
fn alike(model: &Model, holonomic: &[bool], integral: &[Option<Id>]) -> Vec<Vec<usize>> {
    let of_phase: Vec<Vec<usize>> = model.phases.iter().map(|phase| model.rows_of(phase)).collect();
    let mut groups: BTreeMap<Vec<bool>, Vec<usize>> = BTreeMap::new();
    for row in (0..holonomic.len()).filter(|row| !holonomic[*row] && integral[*row].is_none()) {
        let phases: Vec<bool> = of_phase.iter().map(|rows| rows.contains(&row)).collect();
        if phases.contains(&true) {
            groups.entry(phases).or_default().push(row);
        }
    }
    groups.into_values().collect()
}

/// Σ λ_k J_k, for n coordinates.
fn forces(graph: &mut Graph, matrix: &[(usize, usize, Id)], n: usize) -> Vec<Id> {
    let mut forces = vec![Id::ZERO; n];
    for &(row, i, x) in matrix {
        let multiplier = graph.symbol(Symbol::Multiplier(row as u32));
        let term = graph.mul(x, multiplier);
        forces[i] = graph.add(forces[i], term);
    }
    forces
}

/// c', J, γ and Σ λ_k J_k by reverse passes, where [`Rows`] has them by forward ones: a second derivation.
#[derive(Clone, Debug, Default)]
pub struct RowsAgain {
    /// c'; of a row that contains speeds c itself.
    pub rate: Vec<Id>,
    /// J, row by row, in the order of the coordinates.
    pub matrix: Vec<Vec<Id>>,
    /// γ.
    pub bias: Vec<Id>,
    /// Σ λ_k J_k.
    pub forces: Vec<Id>,
    /// The part of c' that is there at rest.
    pub drive: Vec<Id>,
}

impl RowsAgain {
    /// Differentiates the constraints of some rows once more, for n coordinates.
    pub fn of(graph: &mut Graph, rows: &Rows, n: usize) -> RowsAgain {
        let place = |s: Symbol| !matches!(s, Symbol::Parameter(_));
        let mut rate = rows.value.clone();
        for k in (0..rate.len()).filter(|k| rows.holonomic[*k]) {
            let slopes = gradients(graph, &[rate[k]], place).swap_remove(0);
            rate[k] = along(graph, slopes);
        }
        let (mut matrix, mut bias): (Vec<Vec<Id>>, Vec<Id>) = (Vec::new(), Vec::new());
        for mut slopes in gradients(graph, &rate, place) {
            let speed = |i: usize| Symbol::Speed(i as u32);
            matrix.push((0..n).map(|i| slopes.remove(&speed(i)).unwrap_or(Id::ZERO)).collect());
            bias.push(along(graph, slopes));
        }
        let seeds: Vec<(Id, Id)> =
            rate.iter().enumerate().map(|(k, rate)| (*rate, graph.symbol(Symbol::Multiplier(k as u32)))).collect();
        let slopes = reverse(graph, &seeds, |s| matches!(s, Symbol::Speed(_)));
        let force = |i: usize| slopes.get(&Symbol::Speed(i as u32)).copied().unwrap_or(Id::ZERO);
        let forces = (0..n).map(force).collect();
        let drive = rate.iter().zip(&matrix).map(|(rate, line)| less_moving(graph, *rate, line)).collect();
        RowsAgain { rate, matrix, bias, forces, drive }
    }
}

/// c' − J q'.
fn less_moving(graph: &mut Graph, rate: Id, line: &[Id]) -> Id {
    line.iter().enumerate().fold(rate, |rest, (i, x)| {
        let speed = graph.symbol(Symbol::Speed(i as u32));
        let term = graph.mul(*x, speed);
        graph.sub(rest, term)
    })
}

/// The rate of a function with these slopes.
fn along(graph: &mut Graph, slopes: HashMap<Symbol, Id>) -> Id {
    let mut slopes: Vec<(Symbol, Id)> = slopes.into_iter().collect();
    slopes.sort_unstable_by_key(|slope| slope.0);
    let mut sum = Id::ZERO;
    for (symbol, slope) in slopes {
        let rate = match symbol {
            Symbol::Time => Id::ONE,
            _ => symbol.rate().map_or(Id::ZERO, |rate| graph.symbol(rate)),
        };
        let term = graph.mul(slope, rate);
        sum = graph.add(sum, term);
    }
    sum
}

/// What is left where all speeds are 0.
fn at_rest(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let needed = graph.symbols(roots.iter().copied());
    let speeds = needed.into_iter().filter(|s| matches!(s, Symbol::Speed(_))).map(|s| (s, Id::ZERO)).collect();
    crate::expr::substitute(graph, roots, &speeds)
}

/// Total time derivatives with accelerations and multipliers held: what c'' = J q'' + γ and F = 0 are differentiated to.
pub fn held_rates(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        Symbol::Acceleration(_) => Id::ZERO,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    roots.iter().map(|r| forward.of(graph, *r)).collect()
}
