//! `states`: what changes at a rate that the file says, without inertia (LANGUAGE, section 3).
//!
//! A state z is kept as the speed of a hidden coordinate ∫z with M = 1 and h = −z'.  Until equations are derived it is a symbol of its own,
//! so that it is no velocity: positions, masses and constraints do not know of it.

use rustc_hash::FxHashMap as HashMap;

use super::resolve_values::Want;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{sections, states};
use crate::expr::{Graph, Id, Symbol, jacobian, substitute};
use crate::file::{Node, Spot, Text, Written, unit_at};
use crate::model::expression::dimension::{Measure, si};
use crate::model::expression::families::Family;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::expression::value::Value;
use crate::model::resolved::{Balance, BalanceSystem, Coordinate, HIDDEN, Model, Part, StateOfFirstOrder};
use crate::model::resolver::Resolver;

/// How a state's rate is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Law {
    /// As it is.
    Rate,
    /// By an equation that contains it.
    Equation,
}

/// A state as declared.
#[derive(Clone, Copy, Debug)]
pub struct DeclaredState {
    /// The item of its rate or equation.
    item: usize,
    law: Law,
}

/// An entry of `states`, read once for all members of a family.
struct Entry {
    family: Family,
    place: Place,
    text: Option<Text>,
    law: Law,
    unit: Option<String>,
    measure: Measure,
}

impl Resolver<'_> {
    /// The names of states; their rates follow when all names are known.
    pub fn states(&mut self) -> Vec<DeclaredState> {
        // All units first: whether time has one depends on them.
        let entries: Vec<Entry> =
            self.section("states").into_iter().filter_map(|(key, spot)| self.state_entry(key, &spot)).collect();
        let mut declared = Vec::new();
        for entry in entries {
            self.declare_empty(Section::State, &entry.family);
            for member in &entry.family.members {
                let place = self.model.states.len() as u32;
                if !self.declare(Section::State, member, Member::State(place), &entry.place) {
                    continue;
                }
                let (rules, want) = match entry.law {
                    Law::Rate => (Rules::rate_of_state().like(self.scope.units.rate(entry.measure)), Want::Scalar),
                    Law::Equation => (Rules::rate_of_state(), Want::Equation),
                };
                let written = entry.text.clone().map(Written::One);
                let item = self.item(member.name(), written, rules, want, &member.locals);
                declared.push(DeclaredState { item, law: entry.law });
                let (name, unit, place) = (member.name(), entry.unit.clone(), entry.place.of_key());
                let hidden = unit.as_ref().map(|unit| format!("({unit})*s"));
                self.model.coordinates.push(Coordinate {
                    name: format!("{HIDDEN}{name}"),
                    unit: hidden,
                    place: place.clone(),
                });
                self.scope.units.note_radians(&member.base, unit.as_deref());
                self.model.states.push(StateOfFirstOrder { name, unit, rate: Id::ZERO, place });
                self.scope.units.coordinates.push(Measure::Unknown);
                self.scope.units.states.push(entry.measure);
            }
        }
        declared
    }

    fn state_entry(&mut self, key: &str, spot: &Spot<'_>) -> Option<Entry> {
        let family = self.expand_declared(key, spot, Section::State)?;
        let place = spot.place.clone();
        let Node::Map(_) = spot.node else {
            let text = spot.text(&mut self.builder.problems);
            return Some(Entry { family, place, text, law: Law::Rate, unit: None, measure: Measure::Unknown });
        };
        let problems = &mut self.builder.problems;
        spot.only(&["unit", "rate", "equation"], "a state", problems);
        let (text, law) = match (spot.get("rate"), spot.get("equation")) {
            (Some(rate), None) => (rate.text(problems), Law::Rate),
            (None, Some(equation)) => (equation.equation(problems), Law::Equation),
            _ => {
                problems.push(states::state_without_law(place.of_key(), &family.key.name));
                (None, Law::Rate)
            }
        };
        let (unit, measure) = match spot.get("unit") {
            Some(unit) => self.state_unit(&unit),
            None => (None, Measure::Unknown),
        };
        Some(Entry { family, place, text, law, unit, measure })
    }

    /// A unit of SI, as written and as a measure.
    fn state_unit(&mut self, spot: &Spot<'_>) -> (Option<String>, Measure) {
        let Some(words) = spot.words(&mut self.builder.problems) else { return (None, Measure::Unknown) };
        let measure = match unit_at(words, &spot.place) {
            Ok(unit) if !unit.is_si() => {
                self.builder.problems.push(sections::scaled_coordinate(spot.place.clone(), words.trim(), si(&unit)));
                Measure::Unknown
            }
            Ok(unit) => self.note_unit(Some(&unit)),
            Err(found) => {
                self.builder.problems.extend(found);
                Measure::Unknown
            }
        };
        (Some(words.to_owned()), measure)
    }

    /// Rates of states, now that everything has values: those that are given by equations are solved for together.
    pub fn finish_states(&mut self, declared: &[DeclaredState]) {
        let mut residuals = Vec::new();
        for (j, state) in declared.iter().enumerate() {
            let value = match self.scope.value(state.item) {
                Some(Value::Scalar(value)) => *value,
                _ => return,
            };
            let graph = &mut self.builder.graph;
            residuals.push(match state.law {
                Law::Rate => {
                    let own = graph.symbol(Symbol::StateRate(j as u32));
                    graph.sub(own, value)
                }
                Law::Equation => value,
            });
        }
        let graph = &mut self.builder.graph;
        let column = |s: Symbol| if let Symbol::StateRate(j) = s { Some(j as usize) } else { None };
        let lines = jacobian(graph, &residuals, column);
        let slopes: Vec<Id> = lines.iter().flatten().map(|entry| entry.1).collect();
        if graph.symbols(slopes).into_iter().any(|s| column(s).is_some()) {
            return self.report_not_affine(&lines);
        }
        let zero = (0..declared.len()).map(|j| (Symbol::StateRate(j as u32), Id::ZERO)).collect();
        let rests = substitute(&mut self.builder.graph, &residuals, &zero);
        let mut system = System { lines: lines.into_iter().map(|line| line.into_iter().collect()).collect(), rests };
        for j in 0..declared.len() {
            if !self.eliminate(&mut system, j) {
                let place = self.model.states[j].place.clone();
                self.builder.problems.push(states::undetermined_rate(place, &self.model.states[j].name));
                return;
            }
        }
        let rates = system.solved(&mut self.builder.graph);
        self.model.states.iter_mut().zip(rates).for_each(|(state, rate)| state.rate = rate);
    }

    fn report_not_affine(&mut self, lines: &[Vec<(usize, Id)>]) {
        let graph = &self.builder.graph;
        let bent = |line: &Vec<(usize, Id)>| {
            let symbols = graph.symbols(line.iter().map(|entry| entry.1));
            symbols.into_iter().any(|s| matches!(s, Symbol::StateRate(_)))
        };
        if let Some(state) = lines.iter().position(bent).and_then(|j| self.model.states.get(j)) {
            self.builder.problems.push(states::not_affine_in_rates(state.place.clone(), &state.name));
        }
    }

    /// Brings a row with the rate of state j to its place and takes that rate out of the rows below; false where there is none.
    fn eliminate(&mut self, system: &mut System, j: usize) -> bool {
        if system.lines[j].get(&j) != Some(&Id::ONE) {
            let rows: Vec<usize> = (j..system.lines.len()).filter(|i| system.lines[*i].contains_key(&j)).collect();
            let pivots: Vec<Vec<Id>> = rows.iter().map(|i| vec![system.lines[*i][&j]]).collect();
            let zero = self.still(&pivots);
            let Some(first) = rows.iter().zip(&zero).find(|(_, zero)| !**zero).map(|(i, _)| *i) else { return false };
            system.lines.swap(j, first);
            system.rests.swap(j, first);
        }
        let graph = &mut self.builder.graph;
        let (line, rest, pivot) = (system.lines[j].clone(), system.rests[j], system.lines[j][&j]);
        for i in j + 1..system.lines.len() {
            let Some(slope) = system.lines[i].remove(&j) else { continue };
            let factor = graph.div(slope, pivot);
            for (k, entry) in line.iter().filter(|(k, _)| **k != j) {
                let term = graph.mul(factor, *entry);
                let own = system.lines[i].get(k).copied().unwrap_or(Id::ZERO);
                system.lines[i].insert(*k, graph.sub(own, term));
            }
            let term = graph.mul(factor, rest);
            system.rests[i] = graph.sub(system.rests[i], term);
        }
        true
    }

    /// Makes the rates of states unknowns of a system of balances: those that its written equations contain, where these are as many more as
    /// are needed, and each other one by an equation of its own.
    pub fn with_states(&mut self, system: &mut BalanceSystem) {
        if self.model.states.is_empty() {
            return;
        }
        let equations: usize = system.balances.iter().map(|balance| balance.components).sum();
        let needed = self.unknowns_beside_states(system);
        let balances = &mut system.balances;
        let graph = &self.builder.graph;
        let written = balances.iter().filter(|balance| balance.is_written()).flat_map(|balance| &balance.parts);
        let symbols = graph.symbols(written.flat_map(|part| part.value.iter().copied()));
        let named = |j: usize| symbols.contains(&Symbol::StateRate(j as u32));
        let count = (0..self.model.states.len()).filter(|j| named(*j)).count();
        let stated: Vec<bool> = (0..self.model.states.len()).map(|j| named(j) && equations == needed + count).collect();
        for balance in balances.iter_mut() {
            let known: Vec<usize> = (0..stated.len()).filter(|j| !stated[*j] || !balance.is_written()).collect();
            let rates: HashMap<Symbol, Id> =
                known.into_iter().map(|j| (Symbol::StateRate(j as u32), self.model.states[j].rate)).collect();
            for part in balance.parts.iter_mut().chain(&mut balance.terms) {
                part.value = substitute(&mut self.builder.graph, &part.value, &rates);
            }
        }
        for j in (0..stated.len()).filter(|j| !stated[*j]) {
            let graph = &mut self.builder.graph;
            let (own, state) = (graph.symbol(Symbol::StateRate(j as u32)), &self.model.states[j]);
            let parts = vec![
                Part { name: format!("the rate of {}", state.name), value: vec![own] },
                Part { name: format!("the law of {}", state.name), value: vec![graph.neg(state.rate)] },
            ];
            balances.push(Balance {
                label: format!("the rate of {}", state.name),
                parts,
                terms: Vec::new(),
                products: Vec::new(),
                components: 1,
                void_at_rest: false,
                instantaneous: true,
                place: state.place.clone(),
            });
        }
    }
}

/// Linear equations for rates: A z' + b = 0.
struct System {
    /// The non-zeros of A, row by row.
    lines: Vec<std::collections::BTreeMap<usize, Id>>,
    /// b.
    rests: Vec<Id>,
}

impl System {
    /// z' of a triangular system; rows of a single rate are taken as they stand.
    fn solved(&self, graph: &mut Graph) -> Vec<Id> {
        let mut rates = vec![Id::ZERO; self.rests.len()];
        for j in (0..rates.len()).rev() {
            let mut sum = self.rests[j];
            for (k, entry) in self.lines[j].iter().filter(|(k, _)| **k != j) {
                let term = graph.mul(*entry, rates[*k]);
                sum = graph.add(sum, term);
            }
            let minus = graph.neg(sum);
            let pivot = self.lines[j].get(&j).copied().unwrap_or(Id::ONE);
            rates[j] = graph.div(minus, pivot);
        }
        rates
    }
}

/// Puts what the rates of states are into all of a model but its balances, where they may be unknown.
pub fn put_in(model: &mut Model) {
    if model.states.is_empty() {
        return;
    }
    let rates = model.states.iter().enumerate().map(|(j, state)| (Symbol::StateRate(j as u32), state.rate)).collect();
    let balances = std::mem::take(&mut model.balances);
    model.substitute(&rates);
    model.balances = balances;
}
