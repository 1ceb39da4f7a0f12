//! The gate: momentum balances against Lagrange's equations.
//!
//! A system of balances is linear in the accelerations and the reactions that it names.  At random parameters and
//! states it is solved numerically, and its accelerations must be those of Lagrange's equations.

use super::sample::State;
use super::test::{Agreement, describe};
use crate::derive::momentum::{Momentum, unknowns};
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Graph, Id, Symbol, Tape, jacobian};
use crate::model::{BalanceSystem, Model, Part};

/// Accelerations may differ by this much of the largest of them.
const TOLERANCE: f64 = 1e-8;

/// One part of one equation of a system, at one state: coefficients of the unknowns, and the rest.
#[derive(Clone)]
pub(super) struct Row {
    balance: usize,
    part: usize,
    equation: usize,
    coefficients: Vec<f64>,
    rest: f64,
}

impl Row {
    /// A part that belongs to no balance of the file.
    pub fn known(equation: usize, coefficients: Vec<f64>, rest: f64) -> Row {
        Row { balance: usize::MAX, part: usize::MAX, equation, coefficients, rest }
    }
}

/// Compares every system at every state.
pub(super) fn agree(
    model: &mut Model,
    momentum: &[Momentum],
    states: &[State],
) -> Result<Vec<Agreement>, Vec<Problem>> {
    let (mut agreements, mut problems) = (Vec::new(), Vec::new());
    for (system, linear) in model.balances.clone().iter().zip(momentum) {
        if linear.is_nonlinear(&model.graph) {
            problems.extend(nonlinear(&mut model.graph, system, &linear.unknowns));
            continue;
        }
        if let Some(agreement) = at_once(model, system, linear, states) {
            agreements.push(agreement);
            continue;
        }
        // Only what does not agree is taken apart.
        let columns = &linear.unknowns;
        let rows: Vec<Vec<Row>> = evaluate(&mut model.graph, system, columns, states);
        match compare(model, system, columns.len(), &rows, states) {
            Ok(agreement) => agreements.push(agreement),
            Err(problem) => problems.push(*problem),
        }
    }
    if problems.is_empty() {
        problems.extend(super::named::disagreements(model, momentum, states));
    }
    if problems.is_empty() { Ok(agreements) } else { Err(problems) }
}

/// A system with written-out equations in their terms.
fn in_terms(mut system: BalanceSystem) -> BalanceSystem {
    for balance in system.balances.iter_mut().filter(|balance| !balance.terms.is_empty()) {
        balance.parts = std::mem::take(&mut balance.terms);
    }
    system
}

/// An error for the first balance in which an unknown multiplies another, or stands in a function.
fn nonlinear(graph: &mut Graph, system: &BalanceSystem, columns: &[Symbol]) -> Option<Problem> {
    let unknown = |s: Symbol| columns.iter().position(|c| *c == s);
    system.balances.iter().find_map(|balance| {
        let values: Vec<Id> = balance.parts.iter().flat_map(|part| part.value.iter().copied()).collect();
        let slopes = jacobian(graph, &values, unknown);
        let slopes: Vec<Id> = slopes.iter().flatten().map(|e| e.1).collect();
        let curved = graph.symbols(slopes).into_iter().any(|s| unknown(s).is_some());
        curved.then(|| verdicts::nonlinear_balance(balance.place.clone(), &balance.label))
    })
}

/// The unknowns of a system at every state; `None` where it is singular.
pub(super) fn solutions(graph: &Graph, linear: &Momentum, states: &[State]) -> Vec<Option<Vec<f64>>> {
    let size = linear.unknowns.len();
    let entries = linear.matrix.iter().map(|e| e.2);
    let tape = Tape::new(graph, &entries.chain(linear.right.iter().copied()).collect::<Vec<Id>>());
    let mut values = vec![0.0; tape.len()];
    let mut scratch = Vec::new();
    let at = |state: &State| {
        tape.run(|s| state.value(s), &mut scratch, &mut values);
        let mut matrix = vec![0.0; size * (size + 1)];
        for ((i, j, _), value) in linear.matrix.iter().zip(&values) {
            matrix[i * (size + 1) + j] = *value;
        }
        for (i, value) in values[linear.matrix.len()..].iter().enumerate() {
            matrix[i * (size + 1) + size] = *value;
        }
        eliminate(matrix, size)
    };
    states.iter().map(at).collect()
}

/// The agreement of a system that is regular at every state and gives Lagrange's accelerations there.
fn at_once(model: &Model, system: &BalanceSystem, linear: &Momentum, states: &[State]) -> Option<Agreement> {
    let mut worst = 0.0_f64;
    for (found, state) in solutions(&model.graph, linear, states).into_iter().zip(states) {
        let (gap, _) = difference(&found?, state);
        worst = worst.max(if gap.is_nan() { f64::INFINITY } else { gap });
    }
    let between = ("Lagrange".to_owned(), system.name.clone());
    (worst <= TOLERANCE).then_some(Agreement { between, states: states.len(), worst })
}

/// Every part of every equation at every state.
pub(super) fn evaluate(
    graph: &mut Graph,
    system: &BalanceSystem,
    columns: &[Symbol],
    states: &[State],
) -> Vec<Vec<Row>> {
    let mut shape = Vec::new();
    let mut values = Vec::new();
    let mut equation = 0;
    for (b, balance) in system.balances.iter().enumerate() {
        for (p, part) in balance.parts.iter().enumerate() {
            for (k, value) in part.value.iter().enumerate() {
                shape.push((b, p, equation + k));
                values.push(*value);
            }
        }
        equation += balance.components;
    }
    let place = |s: Symbol| columns.iter().position(|c| *c == s);
    let slopes = jacobian(graph, &values, place);
    let roots: Vec<Id> = values.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(graph, &roots);
    let at = |state: &State| {
        // The unknowns at zero: what is left is the rest.
        let known = |s: Symbol| if place(s).is_some() { 0.0 } else { state.value(s) };
        let numbers = tape.evaluate(known);
        let mut slope = numbers[values.len()..].iter();
        let mut rows = Vec::with_capacity(shape.len());
        for (k, &(balance, part, equation)) in shape.iter().enumerate() {
            let mut coefficients = vec![0.0; columns.len()];
            for (column, _) in &slopes[k] {
                coefficients[*column] = slope.next().copied().unwrap_or(0.0);
            }
            rows.push(Row { balance, part, equation, coefficients, rest: numbers[k] });
        }
        rows
    };
    states.iter().map(at).collect()
}

/// The sum of all parts with one of them scaled, solved for the unknowns; `None` where it is singular.
pub(super) fn solve(rows: &[Row], size: usize, changed: Option<(usize, usize, f64)>) -> Option<Vec<f64>> {
    let mut matrix = vec![0.0; size * (size + 1)];
    for row in rows {
        let factor = match changed {
            Some((balance, part, factor)) if (balance, part) == (row.balance, row.part) => factor,
            _ => 1.0,
        };
        let line = &mut matrix[row.equation * (size + 1)..][..size + 1];
        for (sum, c) in line.iter_mut().zip(&row.coefficients) {
            *sum += factor * c;
        }
        line[size] -= factor * row.rest;
    }
    eliminate(matrix, size)
}

/// Gaussian elimination with partial pivoting of scaled rows.
fn eliminate(mut matrix: Vec<f64>, size: usize) -> Option<Vec<f64>> {
    let width = size + 1;
    for line in matrix.chunks_exact_mut(width) {
        let scale = line[..size].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if scale == 0.0 || !scale.is_finite() {
            return None;
        }
        line.iter_mut().for_each(|x| *x /= scale);
    }
    for k in 0..size {
        let pivot = (k..size).max_by(|a, b| matrix[a * width + k].abs().total_cmp(&matrix[b * width + k].abs()))?;
        let size_of_pivot = matrix[pivot * width + k].abs();
        if size_of_pivot.is_nan() || size_of_pivot <= 1e-11 {
            return None;
        }
        for j in 0..width {
            matrix.swap(k * width + j, pivot * width + j);
        }
        for i in k + 1..size {
            let factor = matrix[i * width + k] / matrix[k * width + k];
            if factor == 0.0 {
                continue;
            }
            let (above, below) = matrix.split_at_mut(i * width);
            let top = &above[k * width..][k..width];
            below[k..width].iter_mut().zip(top).for_each(|(x, y)| *x -= factor * y);
        }
    }
    let mut x = vec![0.0; size];
    for k in (0..size).rev() {
        let known: f64 = (k + 1..size).map(|j| matrix[k * width + j] * x[j]).sum();
        x[k] = (matrix[k * width + size] - known) / matrix[k * width + k];
    }
    Some(x)
}

/// The largest difference of an acceleration relative to the largest acceleration, and whose it is.
fn difference(found: &[f64], state: &State) -> (f64, usize) {
    let scale = state.a.iter().chain(found.iter().take(state.a.len())).fold(0.0_f64, |m, x| m.max(x.abs()));
    let gap = |i: usize| (found[i] - state.a[i]).abs();
    let worst = (0..state.a.len()).max_by(|i, j| gap(*i).total_cmp(&gap(*j))).unwrap_or(0);
    (if scale > 0.0 { gap(worst) / scale } else { 0.0 }, worst)
}

fn compare(
    model: &Model,
    system: &BalanceSystem,
    size: usize,
    rows: &[Vec<Row>],
    states: &[State],
) -> Result<Agreement, Box<Problem>> {
    for (b, balance) in system.balances.iter().enumerate() {
        let silent = |rows: &Vec<Row>| {
            let own = || rows.iter().filter(|r| r.balance == b);
            let equations: Vec<usize> = own().map(|r| r.equation).collect();
            equations.iter().any(|e| {
                (0..size).all(|c| {
                    let terms = || own().filter(|r| r.equation == *e).map(|r| r.coefficients[c]);
                    terms().sum::<f64>().abs() <= 1e-13 * terms().map(f64::abs).sum::<f64>()
                })
            })
        };
        if rows.iter().all(silent) {
            return Err(Box::new(verdicts::empty_balance(balance.place.clone(), &balance.label)));
        }
    }
    let (mut worst, mut compared) = (0.0_f64, 0);
    for (rows_here, state) in rows.iter().zip(states) {
        let Some(found) = solve(rows_here, size, None) else { continue };
        compared += 1;
        let (gap, coordinate) = difference(&found, state);
        if gap > TOLERANCE || gap.is_nan() {
            let name = &model.coordinates[coordinate].name;
            let (balances, lagrange) = (format!("{:.9}", found[coordinate]), format!("{:.9}", state.a[coordinate]));
            let (worst, balance) = worst_balance(system, rows_here, size, state);
            let place = system.balances[balance].place.clone();
            // Judged by its parts, explained by their terms.
            let finer = in_terms(system.clone());
            let mut graph = model.graph.clone();
            let in_terms = evaluate(&mut graph, &finer, &unknowns(model, system), states);
            let help = cause(&finer, balance, &in_terms, size, states)
                .or_else(|| forgotten_inertia(model, system, rows, size, states))
                .unwrap_or_else(|| suspects(&system.balances[balance].label));
            let worst = format!("{worst}, at {}", describe(model, state));
            return Err(Box::new(verdicts::balances_disagree(
                place,
                &system.name,
                name,
                balances,
                lagrange,
                worst,
                help,
            )));
        }
        worst = worst.max(gap);
    }
    if compared == 0 {
        let state = states.first().map_or_else(String::new, |s| describe(model, s));
        return Err(Box::new(verdicts::balances_singular(system.place.clone(), &system.name, state)));
    }
    Ok(Agreement { between: ("Lagrange".to_owned(), system.name.clone()), states: compared, worst })
}

/// The balance that Lagrange's accelerations violate most, once its reactions are at their best.
fn worst_balance(system: &BalanceSystem, rows: &[Row], size: usize, state: &State) -> (String, usize) {
    let n = state.a.len();
    let equations: usize = system.balances.iter().map(|b| b.components).sum();
    let mut residual = vec![0.0; equations];
    let mut scale = vec![0.0_f64; equations];
    let mut reactions = vec![vec![0.0; size - n]; equations];
    for row in rows {
        let moving: f64 = row.coefficients[..n].iter().zip(&state.a).map(|(c, a)| c * a).sum();
        residual[row.equation] += row.rest + moving;
        scale[row.equation] += row.rest.abs() + moving.abs();
        for (sum, c) in reactions[row.equation].iter_mut().zip(&row.coefficients[n..]) {
            *sum += c;
        }
    }
    // Least squares for the reactions by normal equations.
    let m = size - n;
    let mut normal = vec![0.0; m * (m + 1)];
    for (line, r) in reactions.iter().zip(&residual) {
        for i in 0..m {
            for j in 0..m {
                normal[i * (m + 1) + j] += line[i] * line[j];
            }
            normal[i * (m + 1) + m] -= line[i] * r;
        }
    }
    if m > 0
        && let Some(best) = eliminate(normal, m)
    {
        for (r, line) in residual.iter_mut().zip(&reactions) {
            *r += line.iter().zip(&best).map(|(c, x)| c * x).sum::<f64>();
        }
    }
    let relative = |e: usize| residual[e].abs() / scale[e].max(f64::MIN_POSITIVE);
    let worst = (0..equations).max_by(|a, b| relative(*a).total_cmp(&relative(*b))).unwrap_or(0);
    let balance = rows.iter().find(|r| r.equation == worst).map_or(0, |r| r.balance);
    let words = format!("{} is off by {:.3e}", system.balances[balance].label, residual[worst].abs());
    (words, balance)
}

/// The one part whose flip, removal or another factor restores agreement at all states, in words.
fn cause(system: &BalanceSystem, worst: usize, rows: &[Vec<Row>], size: usize, states: &[State]) -> Option<String> {
    let factors = [(-1.0, "with the opposite sign of"), (0.0, "without"), (2.0, "with twice"), (0.5, "with half of")];
    // The balance that is off most comes first.
    let order = || std::iter::once(worst).chain((0..system.balances.len()).filter(move |b| *b != worst));
    for (factor, words) in factors {
        for b in order() {
            let balance = &system.balances[b];
            for (p, part) in balance.parts.iter().enumerate() {
                let restores = rows.iter().zip(states).all(|(rows, state)| {
                    solve(rows, size, Some((b, p, factor))).is_some_and(|x| difference(&x, state).0 <= TOLERANCE)
                });
                if restores {
                    return Some(format!("{words} {} in {} they agree", part.name, balance.label));
                }
            }
        }
    }
    None
}

/// The body whose I α, added to or taken from one balance of one component, restores agreement at all states, in words.
fn forgotten_inertia(
    model: &Model,
    system: &BalanceSystem,
    rows: &[Vec<Row>],
    size: usize,
    states: &[State],
) -> Option<String> {
    let mut graph = model.graph.clone();
    let turning = model.bodies.iter().filter_map(|body| Some((body, body.rotation?)));
    let parts: Vec<Part> = turning
        .map(|(body, rotation)| {
            let omega = crate::derive::rate(&mut graph, rotation.angle);
            let alpha = crate::derive::rate(&mut graph, omega);
            Part { name: format!("I alpha of {}", body.name), value: vec![graph.mul(rotation.inertia, alpha)] }
        })
        .collect();
    let mut inertias = BalanceSystem { balances: system.balances[..1].to_vec(), ..system.clone() };
    inertias.balances[0].parts.clone_from(&parts);
    let seen = evaluate(&mut graph, &inertias, &unknowns(model, system), states);
    let mut equation = 0;
    for balance in &system.balances {
        for (p, part) in parts.iter().enumerate().filter(|_| balance.components == 1) {
            for (sign, words) in [(1.0, "added to the left of"), (-1.0, "taken from the left of")] {
                let restores = rows.iter().zip(&seen).zip(states).all(|((rows, seen), state)| {
                    let signed = |x: &f64| sign * x;
                    let extra =
                        Row::known(equation, seen[p].coefficients.iter().map(signed).collect(), sign * seen[p].rest);
                    let all: Vec<Row> = rows.iter().cloned().chain([extra]).collect();
                    solve(&all, size, None).is_some_and(|x| difference(&x, state).0 <= TOLERANCE)
                });
                if restores {
                    return Some(format!("with {} {words} {} they agree", part.name, balance.label));
                }
            }
        }
        equation += balance.components;
    }
    None
}

/// Where to look if no single term explains a disagreement.
fn suspects(label: &str) -> String {
    let suspects = match label.rsplit(['(', ')']).nth(1) {
        Some("equation") => {
            "for a term that is missing, another body or point, and the acceleration of a moving point that is left out"
        }
        Some("force") => {
            "for a constraint's force on these bodies that is not in `reactions` or lacks its opposite (`from`), for a \
             body missing in `of`, and for where forces act"
        }
        Some("moment") => {
            "for a constraint's force that has a moment about this point and is not in `reactions` or lacks its \
             opposite (`from`), for a body missing in `of`, and for where forces act"
        }
        _ => "for forces that do work and are not declared, and for bodies missing in `of`",
    };
    format!("no single term explains it; look in {label} {suspects}")
}
