//! Momentum balances against Lagrange's equations.
//!
//! A system of balances is linear in the accelerations and the reactions that it names.  With Lagrange's accelerations
//! put in and the reactions eliminated nothing may be left of any equation, by the magnitude of its own terms; and
//! somewhere the system must determine the accelerations by itself.

use super::Gate;
use super::causes::Causes;
use super::motion::Motion;
use super::report::Agreement;
use super::results::{self, Values};
use super::state::{State, describe};
use super::surplus;
use super::suspects::{Suspect, suspects};
use super::system::Assembled;
use super::unformed;
use crate::derive::momentum::Momentum;
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Place, Problem, listed};
use crate::expr::{Graph, Id, Symbol, jacobian};
use crate::model::{Balance, BalanceSystem, Model, rate_name};

/// Operations that solving systems for accelerations may cost.
const SOLVED: usize = 100_000_000;
/// What solving makes of roundings, some thousand of them, and of what constraints are held to.
const ROUNDED: f64 = 1e-28;
/// What refining leaves of an unknown that is 0, beside the largest of all, is a rounding of a rounding: some 1e-64.  Units may make of it 1e12 times
/// as much.
const NOTHING: f64 = 1e-50;
/// An acceleration that differs by this part of its terms is wrong.
const ROW: f64 = 1e-9;

/// What was found of systems that agree.
#[derive(Default)]
pub(super) struct Agreed {
    pub agreements: Vec<Agreement>,
    /// Reactions that nothing confirms, in words.
    pub alone: Vec<String>,
    /// Systems, by their places, without equations that follow from others.
    pub fewer: Vec<(usize, Momentum)>,
}

/// What comparing a system that agrees tells.
struct Compared {
    agreement: Agreement,
    /// What it does not tell from rounding, in words.
    hidden: Option<String>,
    /// The system without equations that follow from others, where it has such.
    fewer: Option<Momentum>,
}

/// Compares every system at every state.
pub(super) fn agree(
    model: &mut Model,
    (motion, momentum): (&Motion, &[Momentum]),
    (states, ranks): (&[State], &[usize]),
    gate: Gate,
) -> Result<Agreed, Vec<Problem>> {
    let (mut agreed, mut problems) = (Agreed::default(), Vec::new());
    let (systems, mut sound) = (model.balances.clone(), Vec::new());
    for (k, (system, linear)) in systems.iter().zip(momentum).enumerate() {
        if linear.is_nonlinear(&model.graph) {
            problems.extend(nonlinear(&mut model.graph, system, &linear.unknowns));
            continue;
        }
        let of_phase = |state: &&State| system.phases.contains(&state.phase);
        let own: Vec<State> = states.iter().filter(of_phase).cloned().collect();
        let agreement = match &linear.unformed {
            Some(unformed) => {
                let agreement = unformed::agree(model, (system, unformed), &own, gate);
                let whole = |agreement| Compared { agreement, hidden: None, fewer: None };
                agreement.map(whole).map_err(|problem| vec![*problem])
            }
            None => compare(model, motion, (system, linear), (&own, ranks), gate),
        };
        match agreement {
            Ok(Compared { agreement, hidden, fewer }) => {
                agreed.agreements.push(agreement);
                agreed.alone.extend(hidden);
                agreed.fewer.extend(fewer.map(|equations| (k, equations)));
                sound.push((system, linear));
            }
            Err(found) => problems.extend(found),
        }
    }
    if problems.is_empty() {
        problems.extend(super::reaction_values::disagreements(model, momentum, states, gate));
        if !problems.is_empty() {
            return Err(problems);
        }
    }
    for (system, linear) in sound {
        let named = linear.unformed.is_none();
        if named && system.balances.iter().any(Balance::is_written) && unique(model, system, ranks) {
            let of_phase = |state: &&State| system.phases.contains(&state.phase);
            let own: Vec<State> = states.iter().filter(of_phase).cloned().collect();
            match results(model, motion, (system, linear), &own, gate) {
                Ok(words) => agreed.alone.extend(words),
                Err(found) => problems.extend(found),
            }
        }
    }
    if problems.is_empty() { Ok(agreed) } else { Err(problems) }
}

/// Whether multipliers are unique in all phases of a system: those of constraints that depend on each other are not.
fn unique(model: &Model, system: &BalanceSystem, ranks: &[usize]) -> bool {
    let rows = |phase: &usize| model.phases.get(*phase).map_or(0, |p| model.rows_of(p).len());
    system.phases.iter().all(|phase| ranks.get(*phase).is_none_or(|rank| *rank == rows(phase)))
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
    let with_multipliers = results::with_multipliers(assembled, linear, states);
    if with_multipliers.iter().zip(states).all(|(a, state)| residual(a, state, gate).agrees) {
        return results::confirmed(model, motion, (system, linear), (&with_multipliers, states), gate);
    }
    let assembled = Assembled::derived(&model.graph, linear, states);
    let reactions = results::presumed(model, motion, (system, linear), (&with_multipliers, states));
    let multipliers = multipliers(linear, states);
    let (_, suspects) = suspects(system, &assembled, (&reactions, &multipliers), (states, gate));
    let problem = |suspect: &Suspect| against_constraint(model, system, suspect, states, None);
    Err(suspects.iter().map(problem).collect())
}

/// Lagrange's multipliers that stand in a system, at every state.
fn multipliers(linear: &Momentum, states: &[State]) -> Vec<Values> {
    let those = linear.unknowns.iter().filter(|s| matches!(s, Symbol::Multiplier(_)));
    those.map(|s| states.iter().map(|state| Some(state.measured(*s))).collect()).collect()
}

/// The error for an equation that does not hold with Lagrange's multipliers.
fn against_constraint(
    model: &Model,
    system: &BalanceSystem,
    suspect: &Suspect,
    states: &[State],
    help: Option<String>,
) -> Problem {
    const OF_REACTIONS: &str =
        "`reaction(c)` makes the generalized force (∂c/∂q) reaction(c): a factor or a sign may be missing";
    // Balances of bodies are right by themselves.
    let written: Vec<usize> = suspect.balances.iter().copied().filter(|b| system.balances[*b].is_written()).collect();
    let balances = if written.is_empty() { &suspect.balances } else { &written };
    let (off, at) = (format!("{:.1e}", suspect.relative), describe(model, &states[suspect.state]));
    let label = labels(system, balances, suspect.one_of);
    let help = help.unwrap_or_else(|| OF_REACTIONS.to_owned());
    verdicts::reaction_against_constraint(system.balances[balances[0]].place.clone(), label, off, at, help)
}

/// The labels of balances, one of which is wrong, or all.
fn labels(system: &BalanceSystem, balances: &[usize], one_of: bool) -> String {
    let labels: Vec<String> = balances.iter().map(|b| system.balances[*b].label.clone()).collect();
    match labels.len() {
        1 => listed(&labels),
        _ => format!("{} {}", if one_of { "one of" } else { "the system of" }, listed(&labels)),
    }
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

/// The largest relative residual that Lagrange's accelerations leave.
fn residual(system: &Assembled, state: &State, gate: Gate) -> Residual {
    let left = system.left_over(&state.a);
    let largest = left.iter().fold(0.0_f64, |most, (_, r)| most.max(r.magnitude));
    let mut worst = Residual { agrees: true, relative: 0.0 };
    for (_, r) in left {
        let size = r.value.abs().to_f64();
        if !size.is_finite() {
            // Nothing can be said here.
            continue;
        }
        let agrees = gate.agrees(size, r.magnitude, largest);
        let relative = r.relative();
        if relative > worst.relative || (worst.agrees && !agrees) {
            worst = Residual { agrees: worst.agrees && agrees, relative };
        }
    }
    worst
}

/// How well a system holds with given accelerations.
struct Residual {
    /// Whether every equation holds.
    agrees: bool,
    /// The largest residual of an equation, of its own magnitude.
    relative: f64,
}

fn compare(
    model: &mut Model,
    motion: &Motion,
    (system, linear): (&BalanceSystem, &Momentum),
    (states, ranks): (&[State], &[usize]),
    gate: Gate,
) -> Result<Compared, Vec<Problem>> {
    let assembled = Assembled::derived(&model.graph, linear, states);
    // What says something without an acceleration may be what determines a coordinate without mass.
    let idle = |a: &Assembled, equation: usize| linear.constraints == 0 || a.rest[equation].magnitude == 0.0;
    let silent = |equation: usize| {
        let line = |a: &Assembled| a.matrix[equation * a.size..][..a.size].to_vec();
        let nothing = |a: &Assembled| idle(a, equation) && line(a).iter().all(|c| c.vanishes(1e6));
        !assembled.is_empty() && assembled.iter().all(nothing)
    };
    let mut first = 0;
    for balance in &system.balances {
        if (first..first + balance.components).any(silent) {
            return Err(vec![empty(balance)]);
        }
        first += balance.components;
    }
    let mut worst = 0.0_f64;
    for (a, state) in assembled.iter().zip(states) {
        let found = residual(a, state, gate);
        if !found.agrees {
            return Err(disagreement(model, motion, (system, linear), (&assembled, states), (ranks, gate)));
        }
        worst = worst.max(found.relative);
    }
    let agreement = Agreement { between: ("Lagrange".to_owned(), system.name.clone()), states: states.len(), worst };
    if let Some(fewer) = surplus::square(model, (system, linear), &assembled).map_err(|problem| vec![*problem])? {
        return Ok(Compared { agreement, hidden: None, fewer: Some(fewer) });
    }
    let solved = Solved::of(&assembled, states);
    if let Some(k) = solved.differs.filter(|_| gate.rows) {
        let found = residual(&assembled[k], &states[k], gate);
        // Each equation holds by its own terms, so that no change of one term tells.
        let help =
            "terms of very different sizes hide which of them it is: take balances in which large ones do not stand";
        let balances = (0..system.balances.len()).collect();
        let suspect = Suspect { balances, one_of: true, block: Vec::new(), state: k, relative: found.relative };
        return Err(vec![problem(model, system, (&assembled[k], &states[k]), &suspect, help.to_owned())]);
    }
    let hidden = solved.words(model, system);
    if !assembled.iter().any(|a| a.solution().is_some()) {
        let state = states.first().map_or_else(String::new, |s| describe(model, s));
        return Err(vec![verdicts::balances_singular(system.place.clone(), &system.name, state)]);
    }
    Ok(Compared { agreement, hidden, fewer: None })
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
            let Some(solution) = a.solution() else { continue };
            let nothing = NOTHING * solution.iter().map(|x| x.magnitude).fold(0.0, f64::max);
            for ((x, y), told) in solution.iter().zip(&state.a).zip(&mut solved.told) {
                let gap = (x.value - y.value).abs().to_f64();
                let rounding = ROUNDED * (x.magnitude + y.magnitude);
                if gap > rounding.max(ROW * y.magnitude).max(nothing) {
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

/// The error for a balance that is 0 = 0, with what else it may be.
pub(super) fn empty(balance: &Balance) -> Problem {
    let help = match (balance.components, balance.label.rsplit(['(', ')']).nth(1)) {
        (1, Some("moment")) => "choose another point with `about`, where masses or forces have a moment about it",
        (1, Some("force")) => "choose another direction with `along`, or other bodies",
        (1, _) => "an acceleration or a reaction must stand in it",
        _ => "one direction may be enough: say which with `along`",
    };
    verdicts::empty_balance(balance.place.clone(), &balance.label, help)
}

/// The errors: what the system gives, which balances are off, and what would mend each.
fn disagreement(
    model: &mut Model,
    motion: &Motion,
    (system, linear): (&BalanceSystem, &Momentum),
    (assembled, states): (&[Assembled], &[State]),
    (ranks, gate): (&[usize], Gate),
) -> Vec<Problem> {
    let unique = unique(model, system, ranks);
    let multipliers = if unique { multipliers(linear, states) } else { Vec::new() };
    let reactions = match unique {
        true => {
            let derived = Assembled::derived(&model.graph, linear, states);
            let with_multipliers = results::with_multipliers(derived, linear, states);
            results::presumed(model, motion, (system, linear), (&with_multipliers, states))
        }
        false => Vec::new(),
    };
    let (known, suspects) = suspects(system, assembled, (&reactions, &multipliers), (states, gate));
    let causes = Causes::new(model, (system, linear), assembled, &known);
    let explained: Vec<(Suspect, Option<String>)> = suspects.into_iter().map(|suspect| causes.of(suspect)).collect();
    let whole = matches!(explained.as_slice(), [(suspect, Some(_))] if suspect.balances.len() == 1);
    if let Some((balances, help)) = causes.entry().filter(|_| !whole) {
        let state = explained.first().map_or(0, |(suspect, _)| suspect.state);
        let relative = residual(&assembled[state], &states[state], gate).relative;
        let suspect = Suspect { balances, one_of: false, block: Vec::new(), state, relative };
        return vec![problem(model, system, (&assembled[state], &states[state]), &suspect, help)];
    }
    let told = |(suspect, help): (Suspect, Option<String>)| {
        let at = (&assembled[suspect.state], &states[suspect.state]);
        let multiplied = |b: &usize| contains_multiplier(system, linear, at.0, *b);
        match unique && suspect.balances.iter().any(multiplied) {
            true => against_constraint(model, system, &suspect, states, help),
            false => problem(model, system, at, &suspect, help.unwrap_or_else(|| causes.where_to_look(&suspect))),
        }
    };
    let mut problems: Vec<Problem> = explained.into_iter().map(told).collect();
    // Components of one balance may be off each by itself.
    let places: Vec<Place> = problems.iter().map(|problem| problem.place.clone()).collect();
    let mut place = 0;
    problems.retain(|problem| {
        place += 1;
        !places[..place - 1].contains(&problem.place)
    });
    problems
}

/// Whether a multiplier stands in a written-out equation.
fn contains_multiplier(system: &BalanceSystem, linear: &Momentum, assembled: &Assembled, balance: usize) -> bool {
    let multiplier = |column: &usize| matches!(linear.unknowns[*column], Symbol::Multiplier(_));
    let stands = |e: usize| {
        (0..assembled.size).filter(multiplier).any(|c| !assembled.matrix[e * assembled.size + c].vanishes(1e6))
    };
    system.balances[balance].is_written() && equations(system, balance).any(stands)
}

/// The error for these balances, with the acceleration among those in them that is most wrong.
fn problem(
    model: &Model,
    system: &BalanceSystem,
    (assembled, state): (&Assembled, &State),
    suspect: &Suspect,
    help: String,
) -> Problem {
    let balances = &suspect.balances;
    let label = labels(system, balances, suspect.one_of);
    let off = suspect.relative;
    let place = system.balances[balances[0]].place.clone();
    let worst = format!("{label} is off by {off:.1e} of its terms, at {}", describe(model, state));
    let solution = assembled.solution().unwrap_or_default();
    let stands = |i: &usize| {
        let mut of = balances.iter().flat_map(|b| equations(system, *b));
        of.any(|e| !assembled.matrix[e * assembled.size + i].vanishes(1e6))
    };
    let gap = |i: &usize| {
        let (x, y) = (solution[*i], state.a[*i]);
        let gap = (x.value - y.value).abs().to_f64();
        let differs = gap > ROUNDED * (x.magnitude + y.magnitude);
        differs.then(|| gap / x.value.to_f64().abs().max(y.value.to_f64().abs()))
    };
    let gaps = (0..state.a.len()).filter(|_| !solution.is_empty()).filter(stands).filter_map(|i| Some((i, gap(&i)?)));
    match gaps.max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((i, _)) => {
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

/// The equations of a balance.
pub(super) fn equations(system: &BalanceSystem, balance: usize) -> std::ops::Range<usize> {
    let first = system.balances[..balance].iter().map(|b| b.components).sum::<usize>();
    first..first + system.balances[balance].components
}

/// The unknowns of a system at every state; `None` where it is singular.
pub(super) fn solutions(graph: &Graph, linear: &Momentum, states: &[State]) -> Vec<Option<Vec<crate::expr::Measured>>> {
    Assembled::derived(graph, linear, states).iter().map(Assembled::solution).collect()
}
