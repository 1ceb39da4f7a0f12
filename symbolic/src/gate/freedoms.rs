//! What kind each constraint is, and how many freedoms a phase leaves to configurations and to velocities.
//!
//! 1. Coordinates and rows fall into groups that have nothing to do with each other.
//! 2. A group in which every row with speeds has an integral that is written down is holonomic in all but the name.
//! 3. In any other the Lie closure of the allowed motions decides: look in `closure`.

use super::closure::{Closure, Forms};
use super::motion::Motion;
use super::state::State;
use crate::derive::Rows;
use crate::expr::{Graph, Id, Measured, Symbol, Tape, partial, substitute};
use crate::model::Model;

/// At so many states of each kind the closure is looked at.
const STATES: usize = 6;
/// A combination of rows that is left when those before it are taken off.
const LEFT: f64 = 1e-8;
/// An integral's rate is the row to so many roundings.
const SAME: f64 = 1e10;

/// What a constraint that contains velocities is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrability {
    /// The rate of a function of time and coordinates that was found.
    Integral,
    /// Not such a rate by itself, but it has part in a combination of rows that is one.
    Together,
    /// Equivalent to a constraint of the configuration, but no integral was found in closed form.
    Integrable,
    /// Not integrable by itself, but it has part in a combination that is.
    Combined,
    /// Truly nonholonomic: it restricts velocities and no configurations.
    Nonholonomic,
    /// Not decided, since the work would pass a limit.
    Undecided,
}

/// The freedoms of a phase.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Freedoms {
    /// Degrees of freedom of the configuration: coordinates less the independent constraints that have integrals.  At least
    /// so many, where something is [`Integrability::Undecided`].
    pub configuration: usize,
    /// Degrees of freedom of the velocity: coordinates less independent constraints.
    pub velocity: usize,
    /// The rows that contain velocities, by their places among all rows.
    pub rows: Vec<(usize, Integrability)>,
    /// How many combinations of [`Integrability::Combined`] rows are integrable.
    pub combinations: usize,
    /// How many combinations of [`Integrability::Together`] rows have integrals.
    pub held: usize,
    /// Whether it would be different with other values of the parameters.
    pub particular: bool,
}

impl Freedoms {
    /// Whether the configuration's freedoms are known, and not only that they are no fewer.
    pub fn decided(&self) -> bool {
        !self.rows.iter().any(|row| row.1 == Integrability::Undecided)
    }
}

/// The freedoms of every phase; `own` are positions with the scene's parameters, `states` have drawn ones or these.
/// Integrals that do not have the rows as their rates are dropped.
pub(super) fn freedoms(
    model: &mut Model,
    motion: &Motion,
    rows: &mut Rows,
    own: &[State],
    states: &[State],
) -> Vec<Freedoms> {
    keep_integrals(&mut model.graph, rows, || own.iter().chain(states));
    let phases = motion.constraints.phases();
    (0..phases).map(|phase| of_phase(model, motion, rows, phase, own, states)).collect()
}

fn of_phase(model: &Model, motion: &Motion, rows: &Rows, phase: usize, own: &[State], states: &[State]) -> Freedoms {
    let n = motion.n;
    let active = motion.constraints.active(phase);
    let with = |own: bool| states.iter().filter(move |state| state.phase == phase && state.own == own);
    let of_own: Vec<&State> = own.iter().filter(|state| state.phase == phase).collect();
    let own = if of_own.is_empty() { with(true).collect() } else { of_own };
    let largest = |states: &[&State]| states.iter().map(|state| motion.constraints.rank(state).0).max();
    let drawn: Vec<&State> = with(false).collect();
    let (own_rank, drawn_rank) = (largest(&own), largest(&drawn));
    let rank = own_rank.or(drawn_rank).unwrap_or(active.len());
    let (own, drawn) = (picked(motion, own, rank), picked(motion, drawn, rank));
    let positions = if own.is_empty() { [drawn, Vec::new()] } else { [own, drawn] };
    // Where drawn lengths do not close, rows that depend on each other do for these lengths.
    let elsewhere = drawn_rank.unwrap_or(active.len());
    // The length of a rotation is no freedom, and neither is the hidden coordinate of a state of first order.
    let free = model.mechanical() - model.rotations.len();
    let mut freedoms = Freedoms {
        configuration: free,
        velocity: free.saturating_sub(rank),
        rows: Vec::new(),
        combinations: 0,
        held: 0,
        particular: own_rank.is_some_and(|rank| rank != elsewhere),
    };
    let mut graph = None;
    for group in groups(&model.graph, rows, active, n) {
        let integrals = of_group(model, &mut graph, motion, rows, &group, &positions, &mut freedoms);
        freedoms.configuration -= integrals.min(freedoms.configuration);
    }
    freedoms.rows.sort_unstable_by_key(|row| row.0);
    freedoms
}

/// A few states at which so many rows are independent.
fn picked<'a>(motion: &Motion, states: Vec<&'a State>, rank: usize) -> Vec<&'a State> {
    let usual = states.into_iter().filter(|state| !state.is_special());
    usual.filter(|state| motion.constraints.rank(state).0 == rank).take(STATES).collect()
}

/// How many integrals a group of rows has; what its rows with speeds are is noted.
fn of_group(
    model: &Model,
    copy: &mut Option<Graph>,
    motion: &Motion,
    rows: &Rows,
    group: &Group,
    positions: &[Vec<&State>; 2],
    freedoms: &mut Freedoms,
) -> usize {
    let rank = || positions[0].iter().map(|state| motion.constraints.rank_of(state, &group.rows).0).max();
    let closed = |row: &usize| rows.holonomic[*row] || rows.integral[*row].is_some();
    let (first, open): (Vec<usize>, Vec<usize>) = group.rows.iter().partition(|row| closed(row));
    let combined: Vec<usize> = first.iter().copied().filter(|row| !rows.with[*row].is_empty()).collect();
    freedoms.held += combined.len();
    let together = |row: usize| combined.iter().any(|k| *k == row || rows.with[*k].iter().any(|other| other.0 == row));
    let written = first.iter().filter(|row| !rows.holonomic[**row]);
    let of_written = |row: usize| if together(row) { Integrability::Together } else { Integrability::Integral };
    freedoms.rows.extend(written.map(|row| (*row, of_written(*row))));
    if open.is_empty() {
        return rank().unwrap_or(group.rows.len());
    }
    let all: Vec<usize> = first.iter().chain(&open).copied().collect();
    // What the closure adds belongs to nothing else.
    let graph = copy.get_or_insert_with(|| model.graph.clone());
    let forms = Forms {
        rows: forms(graph, model, rows, &all, &group.coordinates, motion.n),
        coordinates: group.coordinates.clone(),
        closed: first.len(),
    };
    let groups: Vec<Vec<&State>> = positions.iter().filter(|states| !states.is_empty()).cloned().collect();
    let Some(mut closure) = forms.closure(graph, &groups) else {
        freedoms.rows.extend(open.iter().map(|row| (*row, Integrability::Undecided)));
        return rank().unwrap_or(first.len());
    };
    // The closure counts what the ranks count, or it tells nothing.
    let rank = rank().unwrap_or(closure.independent.len());
    closure.cut |= closure.independent.len() != rank;
    freedoms.particular |= !closure.cut && closure.brackets.iter().any(|count| *count != closure.brackets[0]);
    let (kinds, combinations) = kinds(graph, &forms, &closure, &groups[0]);
    freedoms.combinations += combinations;
    // What a row is by itself says less than that its combination is held.
    let of_open = |row: usize, kind| match kind {
        Integrability::Nonholonomic | Integrability::Integrable if together(row) => Integrability::Together,
        _ => kind,
    };
    freedoms.rows.extend(open.iter().zip(kinds).map(|(row, kind)| (*row, of_open(*row, kind))));
    rank.saturating_sub(closure.brackets[0])
}

/// What the rows are that have no integral in writing, and how many combinations of them are integrable.
fn kinds(graph: &mut Graph, forms: &Forms, closure: &Closure, states: &[&State]) -> (Vec<Integrability>, usize) {
    let open = forms.closed..forms.rows.len();
    if closure.cut {
        return (vec![Integrability::Undecided; open.len()], 0);
    }
    let values = forms.on_brackets(graph, closure, states);
    let leaves = |row: usize| values.iter().any(|at| at[row].iter().any(|x| *x != 0.0));
    let mixed: Vec<usize> = open.clone().filter(|row| leaves(*row) && closure.independent.contains(row)).collect();
    let of_mixed = |at: &Vec<Vec<f64>>| rank(mixed.iter().map(|row| at[*row].clone()).collect());
    if values.iter().map(of_mixed).max() != Some(closure.brackets[0]) {
        return (vec![Integrability::Undecided; open.len()], 0);
    }
    let combinations = mixed.len() - closure.brackets[0];
    // A row has part in a combination on which all brackets vanish where the others have the same rank without it.
    let fullest = values.iter().max_by_key(|at| of_mixed(at));
    let combined = |row: usize| {
        let without = |at: &Vec<Vec<f64>>| mixed.iter().filter(|k| **k != row).map(|k| at[*k].clone()).collect();
        combinations > 0 && mixed.contains(&row) && fullest.is_some_and(|at| rank(without(at)) == of_mixed(at))
    };
    let kind = |row: usize| match (leaves(row), combined(row)) {
        (false, _) => Integrability::Integrable,
        (true, true) => Integrability::Combined,
        (true, false) => Integrability::Nonholonomic,
    };
    (open.map(kind).collect(), combinations)
}

/// The rank of a matrix, columns and rows scaled, by elimination with exchanged rows and columns.
fn rank(mut lines: Vec<Vec<f64>>) -> usize {
    for column in 0..lines.first().map_or(0, Vec::len) {
        let size = lines.iter().fold(0.0_f64, |most, line| most.max(line[column].abs()));
        lines.iter_mut().filter(|_| size > 0.0).for_each(|line| line[column] /= size);
    }
    for line in &mut lines {
        let size = line.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        line.iter_mut().filter(|_| size > 0.0).for_each(|x| *x /= size);
    }
    let mut rank = 0;
    while rank < lines.len() {
        let width = lines[rank].len();
        let places = (rank..lines.len()).flat_map(|i| (0..width).map(move |j| (i, j)));
        let best = places.max_by(|a, b| lines[a.0][a.1].abs().total_cmp(&lines[b.0][b.1].abs()));
        let Some((i, j)) = best.filter(|(i, j)| lines[*i][*j].abs() > LEFT) else { break };
        lines.swap(rank, i);
        let (above, below) = lines.split_at_mut(rank + 1);
        let pivot = &above[rank];
        for line in below {
            let factor = line[j] / pivot[j];
            line.iter_mut().zip(pivot).for_each(|(x, y)| *x -= factor * y);
            line[j] = 0.0;
        }
        rank += 1;
    }
    rank
}

/// Rows and coordinates that have something to do with each other.
struct Group {
    rows: Vec<usize>,
    coordinates: Vec<usize>,
}

/// Rows that share coordinates, in what they multiply or in what they depend on.
fn groups(graph: &Graph, rows: &Rows, active: &[usize], n: usize) -> Vec<Group> {
    let mut of_coordinate: Vec<Option<usize>> = vec![None; n];
    let mut groups: Vec<Option<Group>> = Vec::new();
    for &row in active {
        let line: Vec<(usize, Id)> = rows.matrix.iter().filter(|e| e.0 == row).map(|e| (e.1, e.2)).collect();
        let roots = line.iter().map(|e| e.1).chain([rows.drive[row]]);
        let inside = graph.symbols(roots).into_iter().filter_map(|s| match s {
            Symbol::Coordinate(i) => Some(i as usize),
            _ => None,
        });
        let mut group = Group { rows: vec![row], coordinates: line.iter().map(|e| e.0).chain(inside).collect() };
        let touched: Vec<usize> = group.coordinates.iter().filter_map(|i| of_coordinate[*i]).collect();
        for place in touched {
            if let Some(other) = groups[place].take() {
                group.rows.extend(other.rows);
                group.coordinates.extend(other.coordinates);
            }
        }
        group.rows.sort_unstable();
        group.coordinates.sort_unstable();
        group.coordinates.dedup();
        group.coordinates.iter().for_each(|i| of_coordinate[*i] = Some(groups.len()));
        groups.push(Some(group));
    }
    groups.into_iter().flatten().collect()
}

/// Rows, or the combinations that have their integrals, as forms of coordinates and time, inputs being what the file says
/// that they are.
fn forms(
    graph: &mut Graph,
    model: &Model,
    rows: &Rows,
    chosen: &[usize],
    coordinates: &[usize],
    n: usize,
) -> Vec<Vec<Id>> {
    let mut roots = Vec::new();
    for row in chosen {
        let mut line = vec![Id::ZERO; n];
        let (elements, drive) = rows.of_integral(graph, *row);
        elements.into_iter().for_each(|(i, x)| line[i] = x);
        roots.extend(coordinates.iter().map(|i| line[*i]).chain([drive]));
    }
    let signals = model.inputs.iter().enumerate().flat_map(|(k, input)| {
        let symbol = move |order: usize| Symbol::Input(k as u32, order as u8);
        input.signal.iter().enumerate().map(move |(order, u)| (symbol(order), *u))
    });
    let roots = substitute(graph, &roots, &signals.collect());
    roots.chunks(coordinates.len() + 1).map(<[Id]>::to_vec).collect()
}

/// Drops integrals that do not have the rows as their rates.
fn keep_integrals<'a, I: Iterator<Item = &'a State>>(graph: &mut Graph, rows: &mut Rows, states: impl Fn() -> I) {
    for row in 0..rows.len() {
        let Some(integral) = rows.integral[row] else { continue };
        let (elements, drive) = rows.of_integral(graph, row);
        let mut driven = partial(graph, integral, Symbol::Time);
        for input in graph.symbols([integral]).into_iter().filter(|s| matches!(s, Symbol::Input(..))) {
            let (slope, rate) = (partial(graph, integral, input), input.rate().map(|rate| graph.symbol(rate)));
            let term = graph.mul(slope, rate.unwrap_or(Id::ZERO));
            driven = graph.add(driven, term);
        }
        let mut differences = vec![graph.sub(driven, drive)];
        for (i, wanted) in elements {
            let slope = partial(graph, integral, Symbol::Coordinate(i as u32));
            differences.push(graph.sub(slope, wanted));
        }
        let tape = Tape::new(graph, &differences);
        let same = |x: &Measured| !x.value.is_finite() || x.vanishes(SAME);
        if !states().all(|state| tape.measured(|s| state.value(s)).iter().all(same)) {
            rows.integral[row] = None;
            rows.with[row].clear();
        }
    }
}
