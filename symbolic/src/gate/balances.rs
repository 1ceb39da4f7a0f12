//! Momentum balances against Lagrange's equations.
//!
//! A system of balances is linear in the accelerations and the reactions that it names.  With Lagrange's accelerations
//! put in and the reactions eliminated nothing may be left of any equation, by the magnitude of its own terms; and
//! somewhere the system must determine the accelerations by itself.

use super::Gate;
use super::causes::cause;
use super::motion::Motion;
use super::report::Agreement;
use super::results;
use super::state::{State, describe};
use super::system::{Assembled, Row, evaluate};
use super::unformed;
use crate::derive::momentum::Momentum;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Graph, Id, Symbol, jacobian};
use crate::model::{Balance, BalanceSystem, Model, rate_name};

/// Operations that solving systems for accelerations may cost.
const SOLVED: usize = 100_000_000;
/// What solving makes of roundings, some thousand of them, and of what constraints are held to.
const ROUNDED: f64 = 1e-28;
/// An acceleration that differs by this part of its terms is wrong.
const ROW: f64 = 1e-9;

/// Compares every system at every state.
pub(super) fn agree(
    model: &mut Model,
    (motion, momentum): (&Motion, &[Momentum]),
    (states, ranks): (&[State], &[usize]),
    gate: Gate,
) -> Result<(Vec<Agreement>, Vec<String>), Vec<Problem>> {
    let (mut agreements, mut alone, mut problems) = (Vec::new(), Vec::new(), Vec::new());
    for (system, linear) in model.balances.clone().iter().zip(momentum) {
        if linear.is_nonlinear(&model.graph) {
            problems.extend(nonlinear(&mut model.graph, system, &linear.unknowns));
            continue;
        }
        let of_phase = |state: &&State| system.phases.contains(&state.phase);
        let own: Vec<State> = states.iter().filter(of_phase).cloned().collect();
        let agreement = match &linear.unformed {
            Some(unformed) => unformed::agree(model, (system, unformed), &own, gate).map(|agreement| (agreement, None)),
            None => compare(model, system, linear, &own, gate),
        };
        match agreement {
            Ok((agreement, hidden)) => {
                agreements.push(agreement);
                alone.extend(hidden);
            }
            Err(problem) => problems.push(*problem),
        }
    }
    if problems.is_empty() {
        problems.extend(super::reaction_values::disagreements(model, momentum, states, gate));
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    for (system, linear) in model.balances.clone().iter().zip(momentum) {
        // Reactions of constraints that depend on each other are not unique.
        let rows = |phase: &usize| model.phases.get(*phase).map_or(0, |p| model.rows_of(p).len());
        let unique = |phase: &usize| ranks.get(*phase).is_none_or(|rank| *rank == rows(phase));
        let named = linear.unformed.is_none();
        if named && system.balances.iter().any(Balance::is_written) && system.phases.iter().all(unique) {
            let of_phase = |state: &&State| system.phases.contains(&state.phase);
            let own: Vec<State> = states.iter().filter(of_phase).cloned().collect();
            match results(model, motion, (system, linear), &own, gate) {
                Ok(words) => alone.extend(words),
                Err(found) => problems.extend(found),
            }
        }
    }
    if problems.is_empty() { Ok((agreements, alone)) } else { Err(problems) }
}

/// Errors for reactions that are not what the motion makes them, words for those that nothing confirms.
fn results(
    model: &mut Model,
    motion: &Motion,
    (system, linear): (&BalanceSystem, &Momentum),
    states: &[State],
    gate: Gate,
) -> Result<Vec<String>, Vec<Problem>> {
    let assembled = Assembled::derived(&model.graph, linear, states);
    let assembled = results::with_multipliers(assembled, linear, states);
    for (a, state) in assembled.iter().zip(states) {
        let found = residual(a, state, gate);
        if !found.agrees {
            // Balances of bodies are right by themselves.
            let worst = &system.balances[owner(system, found.equation)];
            let balance = [worst].into_iter().chain(&system.balances).find(|b| b.is_written()).unwrap_or(worst);
            let off = format!("{:.1e}", found.relative);
            let at = describe(model, state);
            return Err(vec![verdicts::reaction_against_constraint(balance.place.clone(), &balance.label, off, at)]);
        }
    }
    results::confirmed(model, motion, (system, linear), (&assembled, states))
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

/// The largest relative residual that Lagrange's accelerations leave, and the equation that has it.
pub(super) fn residual(system: &Assembled, state: &State, gate: Gate) -> Residual {
    let left = system.left_over(&state.a);
    let largest = left.iter().fold(0.0_f64, |most, (_, r)| most.max(r.magnitude));
    let mut worst = Residual { agrees: true, relative: 0.0, equation: 0 };
    for (equation, r) in left {
        let size = r.value.abs().to_f64();
        if !size.is_finite() {
            // Nothing can be said here.
            continue;
        }
        let agrees = gate.agrees(size, r.magnitude, largest);
        let relative = r.relative();
        if relative > worst.relative || (worst.agrees && !agrees) {
            worst = Residual { agrees: worst.agrees && agrees, relative, equation };
        }
    }
    worst
}

/// How well a system holds with given accelerations.
pub(super) struct Residual {
    /// Whether every equation holds.
    pub agrees: bool,
    /// The largest residual of an equation, of its own magnitude.
    pub relative: f64,
    /// The equation that has it.
    pub equation: usize,
}

fn compare(
    model: &Model,
    system: &BalanceSystem,
    linear: &Momentum,
    states: &[State],
    gate: Gate,
) -> Result<(Agreement, Option<String>), Box<Problem>> {
    let assembled = Assembled::derived(&model.graph, linear, states);
    let silent = |equation: usize| {
        let line = |a: &Assembled| a.matrix[equation * a.size..][..a.size].to_vec();
        !assembled.is_empty() && assembled.iter().all(|a| line(a).iter().all(|c| c.vanishes(1e6)))
    };
    let mut first = 0;
    for balance in &system.balances {
        if (first..first + balance.components).any(silent) {
            return Err(Box::new(verdicts::empty_balance(balance.place.clone(), &balance.label)));
        }
        first += balance.components;
    }
    let mut worst = 0.0_f64;
    for (a, state) in assembled.iter().zip(states) {
        let found = residual(a, state, gate);
        if !found.agrees {
            return Err(Box::new(disagreement(model, system, linear, (a, state), &found, states, gate)));
        }
        worst = worst.max(found.relative);
    }
    let solved = Solved::of(&assembled, states);
    if let Some(k) = solved.differs.filter(|_| gate.rows) {
        let found = residual(&assembled[k], &states[k], gate);
        return Err(Box::new(disagreement(model, system, linear, (&assembled[k], &states[k]), &found, states, gate)));
    }
    let hidden = solved.words(model, system);
    if !assembled.iter().any(|a| a.solution().is_some()) {
        let state = states.first().map_or_else(String::new, |s| describe(model, s));
        return Err(Box::new(verdicts::balances_singular(system.place.clone(), &system.name, state)));
    }
    let agreement = Agreement { between: ("Lagrange".to_owned(), system.name.clone()), states: states.len(), worst };
    Ok((agreement, hidden))
}

/// The accelerations that a system gives by itself, beside Lagrange's: every equation may hold by its own terms, and those of a heavy body hide
/// what moves a light one.
struct Solved {
    /// The first state at which they differ.
    differs: Option<usize>,
    /// To which part of its terms each is told from rounding, where it is told best.
    told: Vec<f64>,
}

impl Solved {
    fn of(assembled: &[Assembled], states: &[State]) -> Solved {
        let size = assembled.first().map_or(1, |a| a.size.max(1));
        let affordable = (SOLVED / size.pow(3)).max(1);
        let mut solved = Solved { differs: None, told: vec![f64::INFINITY; states.first().map_or(0, |s| s.a.len())] };
        for (k, (a, state)) in assembled.iter().zip(states).enumerate().take(affordable) {
            for ((x, y), told) in a.solution().iter().flatten().zip(&state.a).zip(&mut solved.told) {
                let gap = (x.value - y.value).abs().to_f64();
                let rounding = ROUNDED * (x.magnitude + y.magnitude);
                if gap > rounding.max(ROW * y.magnitude) {
                    solved.differs = solved.differs.or(Some(k));
                }
                *told = told.min(if rounding > 0.0 { rounding / y.magnitude } else { 0.0 });
            }
        }
        solved
    }

    /// What is not told, in words.
    fn words(&self, model: &Model, system: &BalanceSystem) -> Option<String> {
        let told = self.told.iter().enumerate().filter(|(_, told)| **told > ROW && told.is_finite());
        let (i, told) = told.max_by(|a, b| a.1.total_cmp(b.1))?;
        let (name, rate) = (&system.name, rate_name(&model.coordinates[i].name, 2));
        Some(format!(
            "`{name}` tells {rate} from rounding to {told:.0e} of its terms only: its equations have terms of very different sizes"
        ))
    }
}

/// The error: what the system gives, which balance is off, and what would mend it.
fn disagreement(
    model: &Model,
    system: &BalanceSystem,
    linear: &Momentum,
    (assembled, state): (&Assembled, &State),
    found: &Residual,
    states: &[State],
    gate: Gate,
) -> Problem {
    let balance = owner(system, found.equation);
    let place = system.balances[balance].place.clone();
    // Judged by its parts, explained by their terms.
    let finer = in_terms(system.clone());
    let mut graph = model.graph.clone();
    let in_terms: Vec<Vec<Row>> = evaluate(&mut graph, &finer, &linear.unknowns, states);
    let in_parts: Vec<Vec<Row>> = evaluate(&mut graph, system, &linear.unknowns, states);
    let help = match found.agrees {
        // Each equation holds by its own terms, so that no change of one term tells.
        true => {
            "terms of very different sizes hide which of them it is: take balances in which large ones do not stand"
                .to_owned()
        }
        false => cause(model, &finer, system, balance, (&in_terms, &in_parts), states, gate),
    };
    let label = &system.balances[balance].label;
    let off = found.relative;
    let worst = format!("{label} is off by {off:.1e} of its terms, at {}", describe(model, state));
    let solution = assembled.solution().unwrap_or_default();
    let gap = |i: &usize| {
        let (x, y) = (solution[*i].value.to_f64(), state.a[*i].value.to_f64());
        let scale = x.abs().max(y.abs());
        if scale > 0.0 { (x - y).abs() / scale } else { 0.0 }
    };
    let n = state.a.len();
    let coordinate = (0..n).filter(|_| solution.len() >= n).max_by(|a, b| gap(a).total_cmp(&gap(b)));
    match coordinate {
        Some(i) => {
            let name = rate_name(&model.coordinates[i].name, 2);
            let [balances, lagrange] = [solution[i].value, state.a[i].value].map(|x| number(x.to_f64()));
            verdicts::balances_disagree(place, &system.name, name, balances, lagrange, worst, help)
        }
        None => verdicts::balance_violated(place, label, worst, help),
    }
}

/// Nine digits, as a person writes a number of its size.
fn number(x: f64) -> String {
    if x == 0.0 || (1e-4..1e7).contains(&x.abs()) { format!("{x:.9}") } else { format!("{x:.9e}") }
}

/// The balance to which an equation belongs.
fn owner(system: &BalanceSystem, equation: usize) -> usize {
    let mut first = 0;
    for (b, balance) in system.balances.iter().enumerate() {
        first += balance.components;
        if equation < first {
            return b;
        }
    }
    0
}

/// A system with written-out equations in their terms.
fn in_terms(mut system: BalanceSystem) -> BalanceSystem {
    for balance in system.balances.iter_mut().filter(|balance| !balance.terms.is_empty()) {
        balance.parts = std::mem::take(&mut balance.terms);
    }
    system
}

/// The unknowns of a system at every state; `None` where it is singular.
pub(super) fn solutions(graph: &Graph, linear: &Momentum, states: &[State]) -> Vec<Option<Vec<crate::expr::Measured>>> {
    Assembled::derived(graph, linear, states).iter().map(Assembled::solution).collect()
}
