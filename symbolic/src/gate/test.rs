//! What is tested when a model compiles (LANGUAGE, section 8).

use std::collections::BTreeMap;

use super::blame::{Blame, Court, blame};
use super::effects::effects;
use super::potential::{Conservative, natures};
use super::sample::{Draws, State};
use super::twice::counted_twice;
use crate::derive::Switch;
use crate::derive::momentum::Momentum;
use crate::derive::{Equations, rates};
use crate::diagnose::catalogue::{mechanics, verdicts};
use crate::diagnose::{Place, Problem};
use crate::expr::{Binary, Graph, Id, Node, Symbol, Tape, Unary, reverse};
use crate::model::{Conserved, Load, Model, Work};

/// How many states each test wants.
const STATES: usize = 16;
/// How many draws are made for them at the most.
const DRAWS: usize = 400;
/// Two derivations, or two sides, may differ by this much of their terms.
pub(super) const TOLERANCE: f64 = 1e-9;

/// How well two derivations agree.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    /// The derivations.
    pub between: (String, String),
    /// At how many states.
    pub states: usize,
    /// The largest difference of an equation, relative to its largest term.
    pub worst: f64,
}

/// Everything that was tested and held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Derivations against each other.
    pub agreements: Vec<Agreement>,
    /// Conserved quantities: name, largest relative rate.
    pub conserved: Vec<(String, f64)>,
    /// Identities: name, largest relative difference.
    pub checks: Vec<(String, f64)>,
    /// Which forces have potentials.
    pub forces: Vec<Conservative>,
    /// The states at which derivations were compared.
    pub states: Vec<State>,
}

/// Runs every test and collects every failure.
pub(super) fn all(
    model: &mut Model,
    equations: &[Equations],
    momentum: &[Momentum],
    switches: &[Switch],
) -> Result<Report, Vec<Problem>> {
    let mut problems = massless(model, equations);
    if !problems.is_empty() {
        return Err(problems);
    }
    let mut report = Report::default();
    let invariants = invariant_rates(model);
    match finite_states(model, equations, switches, &[]) {
        Err(problem) => return Err(vec![*problem]),
        Ok(states) => {
            match super::agreement::agreement(model, equations, &states) {
                Ok(agreements) => report.agreements = agreements,
                Err(problem) => problems.push(*problem),
            }
            // Where it matters which body takes a load, there is no one second derivation to compare.
            let unclear = super::shared::ambiguous(model, &states);
            if unclear.is_empty() {
                match super::balances::agree(model, momentum, &states) {
                    Ok(agreements) => report.agreements.extend(agreements),
                    Err(found) => problems.extend(found),
                }
            }
            problems.extend(unclear);
            let force = |load: &Load| load.work == Work::Pushes;
            if model.loads.iter().any(force) || !model.generalized_forces.is_empty() {
                let (mut graph, effects) = effects(model);
                report.forces = natures(&mut graph, model, &effects, &states);
                let (errors, warnings) = counted_twice(&mut graph, model, &effects, &states);
                problems.extend(errors);
                model.warnings.extend(warnings);
            }
            report.states = states;
        }
    }
    let model = &*model;
    if !problems.is_empty() {
        return Err(problems);
    }
    let everywhere = report.states.clone();
    let states_when = |when: &[(usize, f64)]| {
        if when.is_empty() {
            return Ok(everywhere.clone());
        }
        finite_states(model, equations, switches, when).map_err(|problem| vec![*problem])
    };
    for (invariant, components) in model.conserved.iter().zip(&invariants) {
        let states = states_when(&invariant.when)?;
        match conserved(model, components, &states) {
            Ok(worst) => report.conserved.push((invariant.name.clone(), worst)),
            Err(change) => {
                let (mut graph, effects) = effects(model);
                let court = Court { model, equations: &equations[0], effects: &effects, natures: &report.forces };
                let component = (invariant.value[change.component], components[change.component].0);
                let blame = blame(&mut graph, &court, invariant, component, &states, &states[change.state]);
                problems.push(change.problem(model, invariant, blame, &states));
            }
        }
    }
    for check in &model.checks {
        let states = states_when(&check.when)?;
        let pairs: Vec<(Id, Id)> = check.left.iter().copied().zip(check.right.iter().copied()).collect();
        match identity(model, &check.name, &pairs, &states, &check.place) {
            Ok(worst) => report.checks.push((check.name.clone(), worst)),
            Err(problem) => problems.push(*problem),
        }
    }
    if problems.is_empty() { Ok(report) } else { Err(problems) }
}

/// Coordinates without an entry on M's diagonal.
fn massless(model: &Model, equations: &[Equations]) -> Vec<Problem> {
    let moved = |i: usize| equations[0].mass.iter().any(|e| (e.0, e.1) == (i, i));
    let coordinates = model.coordinates.iter().enumerate();
    coordinates.filter(|(i, _)| !moved(*i)).map(|(_, c)| mechanics::no_mass(c.place.clone(), &c.name)).collect()
}

/// States at which the equations give finite numbers, with the accelerations of the motion in them.
fn finite_states(
    model: &Model,
    equations: &[Equations],
    switches: &[Switch],
    when: &[(usize, f64)],
) -> Result<Vec<State>, Box<Problem>> {
    let n = model.coordinates.len();
    let first = &equations[0];
    let roots: Vec<Id> = first.mass.iter().map(|e| e.2).chain(first.bias.iter().copied()).collect();
    let tape = Tape::new(&model.graph, &roots);
    let mut draws = Draws::new(model, switches);
    let mut states = Vec::new();
    let mut singular = vec![0; n];
    let mut scratch = Vec::new();
    let mut values = vec![0.0; tape.len()];
    for _ in 0..DRAWS {
        if states.len() == STATES {
            return Ok(states);
        }
        let mut state = draws.next(when);
        tape.run(|s| state.value(s), &mut scratch, &mut values);
        if values.iter().any(|x| !x.is_finite()) {
            continue;
        }
        let mut mass = vec![0.0; n * n];
        for (k, (i, j, _)) in first.mass.iter().enumerate() {
            mass[i * n + j] = values[k];
            mass[j * n + i] = values[k];
        }
        let force: Vec<f64> = values[first.mass.len()..].iter().map(|h| -h).collect();
        match solve(mass, force) {
            Ok(a) => {
                state.a = a;
                states.push(state);
            }
            Err(i) => singular[i] += 1,
        }
    }
    let worst = (0..n).max_by_key(|&i| singular[i]).filter(|&i| singular[i] > DRAWS / 2);
    Err(Box::new(match worst {
        Some(i) => {
            let coordinate = &model.coordinates[i];
            let state = draws.next(when);
            verdicts::singular_mass(coordinate.place.clone(), &coordinate.name, describe(model, &state))
        }
        None => verdicts::too_few_states(Place::default().key("coordinates"), states.len(), DRAWS),
    }))
}

/// Coordinates on which neither T − V nor any force depends or acts, with their momenta, which are conserved.
pub(super) fn cyclic(model: &mut Model, states: &[State], momenta: &[(Id, Id)]) -> Vec<(usize, Id)> {
    let mut found = Vec::new();
    for (i, &(momentum, rest)) in momenta.iter().enumerate() {
        let scaled = Scaled::new(&model.graph, &[rest]);
        let vanishes = |state: &State| {
            let (values, scale) = scaled.at(state);
            values[0].abs() <= 1e-12 * scale
        };
        if states.iter().all(vanishes) {
            let constant = |s: Symbol| matches!(s, Symbol::Parameter(_));
            let expanded = crate::expr::expand(&mut model.graph, &[momentum], constant);
            found.push((i, expanded.map_or(momentum, |e| e[0])));
        }
    }
    found
}

/// Gaussian elimination on the diagonal of a symmetric matrix; the place of a pivot that vanishes to rounding.
pub(crate) fn solve(mut m: Vec<f64>, mut f: Vec<f64>) -> Result<Vec<f64>, usize> {
    let n = f.len();
    let diagonal: Vec<f64> = (0..n).map(|i| m[i * n + i].abs()).collect();
    for k in 0..n {
        let pivot = m[k * n + k];
        if pivot.abs() <= 1e-13 * diagonal[k] || !pivot.is_finite() {
            return Err(k);
        }
        for i in k + 1..n {
            let factor = m[i * n + k] / pivot;
            if factor != 0.0 {
                for j in k..n {
                    m[i * n + j] -= factor * m[k * n + j];
                }
                f[i] -= factor * f[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| m[k * n + j] * f[j]).sum();
        f[k] = (f[k] - known) / m[k * n + k];
    }
    Ok(f)
}

/// For each conserved quantity and component: its rate and the parts of its rate.
fn invariant_rates(model: &mut Model) -> Vec<Vec<(Id, Vec<Id>)>> {
    let conserved: Vec<Vec<Id>> = model.conserved.iter().map(|c| c.value.clone()).collect();
    let graph = &mut model.graph;
    conserved
        .into_iter()
        .map(|components| {
            components
                .into_iter()
                .map(|component| {
                    let total = rates(graph, &[component])[0];
                    let gradient = reverse(graph, &[(component, Id::ONE)], |_| true);
                    let mut parts = Vec::new();
                    for symbol in graph.symbols([component]) {
                        let rate = match symbol {
                            Symbol::Time => Id::ONE,
                            _ => symbol.rate().map_or(Id::ZERO, |r| graph.symbol(r)),
                        };
                        let slope = gradient.get(&symbol).copied().unwrap_or(Id::ZERO);
                        parts.push(graph.mul(slope, rate));
                    }
                    (total, parts)
                })
                .collect()
        })
        .collect()
}

/// How a quantity was seen to change.
struct Change {
    component: usize,
    state: usize,
    rate: f64,
    scale: f64,
}

impl Change {
    fn problem(&self, model: &Model, invariant: &Conserved, blame: Option<Blame>, states: &[State]) -> Problem {
        let (place, name) = (invariant.place.clone(), &invariant.name);
        match blame {
            Some(Blame { causes, help }) => verdicts::changed_by(place, name, causes, help),
            None => {
                let by = format!("{:.6e} where its terms change at up to {:.3e}", self.rate, self.scale);
                verdicts::not_conserved(place, name, by, describe(model, &states[self.state]))
            }
        }
    }
}

/// The largest relative rate, or where it is too large.
fn conserved(model: &Model, components: &[(Id, Vec<Id>)], states: &[State]) -> Result<f64, Change> {
    let mut worst = 0.0_f64;
    for (component, (total, parts)) in components.iter().enumerate() {
        let roots: Vec<Id> = std::iter::once(*total).chain(parts.iter().copied()).collect();
        let tape = Tape::new(&model.graph, &roots);
        for (k, state) in states.iter().enumerate() {
            let values = tape.evaluate(|s| state.value(s));
            let scale: f64 = values[1..].iter().map(|p| p.abs()).sum();
            if values[0].abs() > TOLERANCE * scale || !values[0].is_finite() {
                return Err(Change { component, state: k, rate: values[0], scale });
            }
            worst = worst.max(if scale > 0.0 { values[0].abs() / scale } else { 0.0 });
        }
    }
    Ok(worst)
}

fn identity(
    model: &Model,
    name: &str,
    pairs: &[(Id, Id)],
    states: &[State],
    place: &Place,
) -> Result<f64, Box<Problem>> {
    let mut worst = 0.0_f64;
    for &(left, right) in pairs {
        let scaled = Scaled::new(&model.graph, &[left, right]);
        for state in states {
            let (values, scale) = scaled.at(state);
            let difference = (values[0] - values[1]).abs();
            if difference > TOLERANCE * scale || !difference.is_finite() {
                let by = format!("{difference:.6e}, {:.9e} against {:.9e}", values[0], values[1]);
                return Err(Box::new(verdicts::check_fails(place.clone(), name, by, describe(model, state))));
            }
            worst = worst.max(if scale > 0.0 { difference / scale } else { 0.0 });
        }
    }
    Ok(worst)
}

/// The terms of a sum, and how often each occurs.
fn terms(graph: &Graph, root: Id) -> Vec<(Id, f64)> {
    let mut found = Vec::new();
    // Parents have larger places than children, so taking the largest first visits each node once.
    let mut open = BTreeMap::from([(root, 1.0)]);
    while let Some((id, weight)) = open.pop_last() {
        let parts = match graph.node(id) {
            Node::Binary(Binary::Add | Binary::Sub, x, y) => vec![x, y],
            Node::Unary(Unary::Neg, x) => vec![x],
            _ => {
                found.push((id, weight));
                continue;
            }
        };
        for part in parts {
            *open.entry(part).or_insert(0.0) += weight;
        }
    }
    found
}

/// Expressions with the terms that scale them: evaluates to each expression's value and its scale.
pub(super) struct Scaled {
    tape: Tape,
    weights: Vec<f64>,
    roots: usize,
}

impl Scaled {
    pub fn new(graph: &Graph, roots: &[Id]) -> Scaled {
        let terms: Vec<(Id, f64)> = roots.iter().flat_map(|r| terms(graph, *r)).collect();
        let all: Vec<Id> = roots.iter().copied().chain(terms.iter().map(|t| t.0)).collect();
        Scaled { tape: Tape::new(graph, &all), weights: terms.iter().map(|t| t.1).collect(), roots: roots.len() }
    }

    /// The values, and the sum of the absolute values of all their terms.
    pub fn at(&self, state: &State) -> (Vec<f64>, f64) {
        self.with(|s| state.value(s))
    }

    /// The same, with values for symbols that are no part of a state.
    pub fn with(&self, value: impl Fn(Symbol) -> f64) -> (Vec<f64>, f64) {
        let mut values = self.tape.evaluate(value);
        let scale = values[self.roots..].iter().zip(&self.weights).map(|(x, w)| x.abs() * w).sum();
        values.truncate(self.roots);
        (values, scale)
    }
}

/// A state in words, for messages.
pub(super) fn describe(model: &Model, state: &State) -> String {
    let mut words: Vec<String> = Vec::new();
    for (k, c) in model.coordinates.iter().enumerate().take(4) {
        words.push(format!("{} = {:.4}, {}' = {:.4}", c.name, state.q[k], c.name, state.v[k]));
    }
    if model.coordinates.len() > 4 {
        words.push("…".to_owned());
    }
    words.join(", ")
}
