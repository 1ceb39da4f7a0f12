// Whether an altered model moves otherwise: decided apart from the program's own comparison, at other states.

use dalembert_symbolic::derive::{Derivation, Equations};
use dalembert_symbolic::expr::{Graph, Id, Symbol, Tape, jacobian};
use dalembert_symbolic::gate::{Draws, State};
use dalembert_symbolic::model::{BalanceSystem, Check, Model};

/// How many states are looked at.
const STATES: usize = 24;
/// The program's own comparison has drawn no more than this.
const SKIPPED: usize = 400;
/// What differs by more than this of the largest acceleration differs.
const TOLERANCE: f64 = 1e-9;

/// States of the sound model's motion, its accelerations in them.
pub fn states(sound: &Derivation, when: &[(usize, f64)]) -> Vec<State> {
    let mut draws = Draws::new(&sound.model, &sound.switches);
    for _ in 0..SKIPPED {
        draws.next(when);
    }
    let mut states = Vec::new();
    for _ in 0..SKIPPED {
        let mut state = draws.next(when);
        if let Some(a) = accelerations(&sound.model.graph, &sound.equations[0], &state) {
            state.a = a;
            states.push(state);
        }
        if states.len() == STATES {
            break;
        }
    }
    states
}

fn accelerations(graph: &Graph, equations: &Equations, state: &State) -> Option<Vec<f64>> {
    let n = equations.bias.len();
    let roots: Vec<Id> = equations.mass.iter().map(|e| e.2).chain(equations.bias.iter().copied()).collect();
    let values = Tape::new(graph, &roots).evaluate(|s| state.value(s));
    let mut rows = vec![vec![0.0; n + 1]; n];
    for ((i, j, _), m) in equations.mass.iter().zip(&values) {
        rows[*i][*j] = *m;
        rows[*j][*i] = *m;
    }
    for (row, h) in rows.iter_mut().zip(&values[equations.mass.len()..]) {
        row[n] = -h;
    }
    solve(rows)
}

/// Whether Lagrange's equations of an altered model give the accelerations in these states.
pub fn lagrange_unchanged(altered: &Derivation, states: &[State]) -> bool {
    let same = |state: &State| {
        accelerations(&altered.model.graph, &altered.equations[0], state).is_some_and(|a| close(&a, &state.a))
    };
    !states.is_empty() && states.iter().all(same)
}

/// Whether a system of balances gives the accelerations in these states, wherever it has a solution.
pub fn system_unchanged(model: &mut Model, system: &BalanceSystem, states: &[State]) -> bool {
    let n = model.coordinates.len();
    let reactions = system.reactions.iter().flat_map(|&k| {
        let reaction = &model.reactions[k];
        (0..reaction.components as u32).map(|c| Symbol::Reaction(reaction.first + c))
    });
    let columns: Vec<Symbol> = (0..n).map(|i| Symbol::Acceleration(i as u32)).chain(reactions).collect();
    let graph = &mut model.graph;
    let mut sums = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            sums.push(balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k])));
        }
    }
    let place = |s: Symbol| columns.iter().position(|c| *c == s);
    let slopes = jacobian(graph, &sums, place);
    let roots: Vec<Id> = sums.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(graph, &roots);
    let mut solved = 0;
    for state in states {
        let values = tape.evaluate(|s| if place(s).is_some() { 0.0 } else { state.value(s) });
        let mut slope = values[sums.len()..].iter();
        let mut rows = vec![vec![0.0; columns.len() + 1]; sums.len()];
        for ((row, entries), rest) in rows.iter_mut().zip(&slopes).zip(&values) {
            row[columns.len()] = -rest;
            for (column, _) in entries {
                row[*column] = *slope.next().unwrap_or(&0.0);
            }
        }
        let Some(found) = solve(rows) else { continue };
        solved += 1;
        if !close(&found[..n], &state.a) {
            return false;
        }
        // Of equations that are not linear this is no solution.
        let unknown = |s: Symbol| place(s).map_or_else(|| state.value(s), |k| found[k]);
        let left = tape.evaluate(unknown);
        let scale = found.iter().chain(&values).fold(0.0_f64, |m, x| m.max(x.abs()));
        if left[..sums.len()].iter().any(|x| x.abs() > 1e-6 * scale) {
            return false;
        }
    }
    solved > 0
}

/// Whether a check holds in these states, to rounding of the largest number that occurs in it.
pub fn check_holds(graph: &Graph, check: &Check, states: &[State]) -> bool {
    let sides: Vec<Id> = check.left.iter().chain(&check.right).copied().collect();
    let reached = graph.reachable(sides.iter().copied());
    let inside = reached.iter().enumerate().filter(|r| *r.1).map(|r| graph.id_at(r.0));
    let roots: Vec<Id> = sides.iter().copied().chain(inside).collect();
    let tape = Tape::new(graph, &roots);
    let holds = |state: &State| {
        let values = tape.evaluate(|s| state.value(s));
        let scale = values.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let (left, right) = values[..sides.len()].split_at(check.left.len());
        left.iter().zip(right).all(|(l, r)| (l - r).abs() <= TOLERANCE * scale)
    };
    !states.is_empty() && states.iter().all(holds)
}

fn close(found: &[f64], wanted: &[f64]) -> bool {
    let scale = found.iter().chain(wanted).fold(0.0_f64, |m, x| m.max(x.abs()));
    found.iter().zip(wanted).all(|(x, y)| (x - y).abs() <= TOLERANCE * scale)
}

/// Gauss and Jordan's elimination of an augmented matrix with pivots from all rows and columns.
fn solve(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    let largest = |row: &Vec<f64>| row[..n].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for row in &mut rows {
        let scale = largest(row);
        row.iter_mut().for_each(|x| *x /= scale);
    }
    let mut order: Vec<usize> = Vec::new();
    for k in 0..n {
        let free = |j: &usize| !order.contains(j);
        let places = (k..n).flat_map(|i| (0..n).filter(free).map(move |j| (i, j)));
        let (i, j) = places.max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()))?;
        if rows[i][j].is_nan() || rows[i][j].abs() < 1e-10 {
            return None;
        }
        rows.swap(k, i);
        let pivot = rows[k].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            let factor = row[j] / pivot[j];
            if other != k && factor != 0.0 {
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
            }
        }
        order.push(j);
    }
    let mut solution = vec![0.0; n];
    for (k, j) in order.into_iter().enumerate() {
        solution[j] = rows[k][n] / rows[k][j];
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
