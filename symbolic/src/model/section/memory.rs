//! `memory`: values that are held between events, and what sets them (LANGUAGE, section 3).

use std::collections::BTreeSet;

use crate::diagnose::catalogue::{mechanics, memory, names, sections};
use crate::diagnose::did_you_mean_or;
use crate::expr::Id;
use crate::file::{Quantity, Spot};
use crate::model::event::{Clock, EventAction, HeldValue, Noise, Set, Target};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::{Expanded, Family, Locals};
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::resolved::{Output, Scene};
use crate::model::resolver::Resolver;

use super::parameters::values;

const FIRST: Rules = Rules::constant("the first tick").si(Dimension::TIME);
const PERIOD: Rules = Rules::constant("a period").si(Dimension::TIME);

/// A held value as declared.
pub struct DeclaredMemory {
    value: Quantity,
    locals: Locals,
}

/// Which held value is meant, or how one is declared.
fn held_or_declared(name: &str, known: &[&str]) -> String {
    match known {
        [] => format!("nothing is held: declare it, with what it starts with, `memory: {{{name}: 0}}`"),
        known => did_you_mean_or(name, known),
    }
}

impl Resolver<'_> {
    /// The names and units of held values; what they start with follows when all names are known.
    pub fn memory(&mut self) -> Vec<DeclaredMemory> {
        let mut declared = Vec::new();
        for (key, spot) in self.section("memory") {
            let Some(family) = self.expand_declared(key, &spot, Section::Memory) else { continue };
            self.declare_empty(Section::Memory, &family);
            let Some(values) = values(&spot, &family, &mut self.builder.problems) else {
                for member in &family.members {
                    self.declare(Section::Memory, member, Member::Refused, &spot.place);
                }
                continue;
            };
            for (member, value) in family.members.iter().zip(values) {
                let unit = value.unit.as_ref().map(|(words, _)| words.clone());
                let measure = match &value.unit {
                    Some((_, unit)) => self.note_unit(Some(unit)),
                    None => Measure::Unknown,
                };
                let place = self.model.memory.len() as u32;
                if self.declare(Section::Memory, member, Member::Memory(place), &spot.place) {
                    self.scope.units.note_radians(&member.base, unit.as_deref());
                    let (name, place) = (member.name(), spot.place.of_key());
                    self.model.memory.push(HeldValue { name, unit, start: Id::ZERO, place });
                    self.scope.units.memory.push(measure);
                    declared.push(DeclaredMemory { value, locals: member.locals.clone() });
                }
            }
        }
        declared
    }

    /// What held values start with, of parameters, and that as numbers in every scene.
    pub fn finish_memory(&mut self, declared: &[DeclaredMemory]) {
        for (j, DeclaredMemory { value, locals }) in declared.iter().enumerate() {
            let rules = Rules::constant("a held value at the start").like(self.scope.units.memory[j]);
            let Some(start) = self.setting(value, rules, locals) else { continue };
            let defaults = self.builder.defaults.clone();
            if crate::model::command::evaluate(&self.builder.graph, start, &defaults).is_none() {
                let place = value.text.place.at(value.text.ast.span);
                self.builder.problems.push(names::undefined_value(place, &value.text.source));
            }
            if value.unit.is_none() && self.builder.graph.number(start).is_none() {
                // `u: u0` has the unit of u0; that of `on: 1` is not known.
                self.scope.units.memory[j] = self.builder.measured;
            }
            self.model.memory[j].start = start;
        }
    }

    /// Every held value is an output, under its own name.
    pub fn memory_outputs(&mut self) {
        let noise: Vec<Noise> = self.model.noise.clone();
        // A direction of sliding is what its rates tell.
        let of_contacts: Vec<usize> =
            self.contacts.iter().filter_map(|contact| contact.direction).flat_map(|first| first..first + 3).collect();
        let of_noise = |j: usize| noise.iter().find(|noise| noise.held.contains(&j));
        for j in (0..self.model.memory.len()).filter(|j| !of_contacts.contains(j)) {
            // Of noise its value alone, which need not be what it holds.
            let value = match of_noise(j) {
                Some(noise) if noise.held[0] != j => continue,
                Some(noise) => noise.value,
                None => self.builder.graph.symbol(crate::expr::Symbol::Memory(j as u32)),
            };
            let name = self.model.memory[j].name.clone();
            if self.model.outputs.iter().any(|output| output.name == name) {
                let outputs = crate::diagnose::Place::default().key("outputs");
                let map = self.root.get("outputs").is_some_and(|outputs| outputs.get(&name).is_some());
                let place = if map { outputs.key(&name).of_key() } else { outputs };
                self.builder.problems.push(memory::column_taken(place, &name, "a held value"));
            }
            let measure = self.scope.units.memory[j];
            let measured = measure.dimension().filter(|dimension| *dimension != Dimension::ONE).map(|d| d.to_string());
            let unit = self.model.memory[j].unit.clone().filter(|unit| unit != "1").or(measured);
            self.model.outputs.push(Output { name, value: vec![value], unit, measure, of_reactions: false });
        }
    }

    /// The held value that a member of a key names.
    fn held(&self, member: &Expanded) -> Option<usize> {
        match self.scope.names.get(&member.base)?.members.get(&member.indices)? {
            Member::Memory(place) => Some(*place as usize),
            _ => None,
        }
    }

    /// Whether an entry of `start` is about held values; puts them where they start.
    pub fn start_memory(&mut self, spot: &Spot<'_>, family: &Family, scene: &mut Scene) -> bool {
        if family.key.primes > 0 || family.members.iter().all(|member| self.held(member).is_none()) {
            return false;
        }
        let Some(values) = self.values_for(spot, family) else { return true };
        for (member, value) in family.members.iter().zip(values) {
            let Some(place) = self.held(member) else { break };
            let rules = Rules::constant("a start of it").like(self.scope.units.memory[place]);
            if let Some(value) = self.setting(&value, rules, &member.locals) {
                scene.memory[place] = value;
            }
        }
        true
    }

    /// `on_set: NAME`, or a list of names.
    pub fn set_names(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Vec<usize>> {
        let items = spot.items().unwrap_or_else(|| vec![spot.clone()]);
        if items.is_empty() {
            self.builder.problems.push(sections::empty_list(spot.place.of_key(), "on_set", "name"));
            return None;
        }
        let mut found = Vec::new();
        for item in items {
            let words = item.words(&mut self.builder.problems)?;
            let family = self.expand_in(words, &item, locals)?;
            for member in &family.members {
                found.push(self.held_or_report(member, &item)?);
            }
        }
        Some(found)
    }

    fn held_or_report(&mut self, member: &Expanded, spot: &Spot<'_>) -> Option<usize> {
        let found = self.held(member);
        if found.is_none() && !self.scope.names.get(&member.base).is_some_and(|entry| entry.refused) {
            let name = member.name();
            let section = self.scope.names.get(&member.base).map(|entry| entry.section);
            let problem = match section {
                Some(section) if section != Section::Memory => {
                    names::wrong_thing(spot.place.clone(), &name, "a held value", section.noun())
                }
                _ => {
                    let known: Vec<&str> = self.model.memory.iter().map(|held| held.name.as_str()).collect();
                    names::unknown_name(spot.place.clone(), &name, held_or_declared(&name, &known))
                }
            };
            self.builder.problems.push(problem);
        }
        found
    }

    /// `every` with its `from`: a clock of its own.
    pub fn clock(&mut self, every: &Spot<'_>, from: Option<&Spot<'_>>, locals: &Locals) -> Option<usize> {
        let period = every.quantity(&mut self.builder.problems)?;
        let period = self.setting(&period, PERIOD, locals)?;
        self.positive_everywhere(every, period)?;
        let from = match from {
            None => Some(Id::ZERO),
            Some(spot) => {
                let first = spot.quantity(&mut self.builder.problems)?;
                self.setting(&first, FIRST, locals)
            }
        };
        self.model.clocks.push(Clock { from: from?, every: period });
        Some(self.model.clocks.len() - 1)
    }

    /// Reports a period that is not positive in some scene.
    fn positive_everywhere(&mut self, spot: &Spot<'_>, value: Id) -> Option<()> {
        for scene in 0..self.model.scenes.len() {
            let parameters = self.scene_parameters(&self.model.scenes[scene]);
            let found = crate::model::command::evaluate(&self.builder.graph, value, &parameters);
            let problem = match found {
                Some(number) if number > 0.0 => continue,
                Some(number) => mechanics::value_out_of_range(spot.place.clone(), PERIOD.what, "positive", number),
                None => names::undefined_value(spot.place.clone(), spot.words(&mut Vec::new()).unwrap_or_default()),
            };
            self.builder.problems.push(problem);
            return None;
        }
        Some(())
    }

    /// `{set: {u: e, …}}`: all at once, from the values before.
    pub fn set_action(&mut self, item: &Spot<'_>, locals: &Locals) -> Option<EventAction> {
        let problems = &mut self.builder.problems;
        item.only(&["set"], "what is set", problems);
        let set = item.need("set", "what is set", problems)?;
        let entries = set.entries(&mut self.builder.problems);
        if entries.is_empty() {
            self.builder.problems.push(sections::empty_list(set.place.of_key(), "set", "value"));
            return None;
        }
        let (mut values, mut seen) = (Vec::new(), BTreeSet::new());
        for (key, spot) in entries {
            let Some(family) = self.expand_in(key, &spot, locals) else { continue };
            let Some(quantity) = spot.quantity(&mut self.builder.problems) else { continue };
            for member in &family.members {
                let Some((target, measure)) = self.target(member, family.key.primes, &spot) else { break };
                if !seen.insert(member.name()) {
                    self.builder.problems.push(names::member_twice(spot.place.of_key(), member.name()));
                    break;
                }
                let rules = Rules::anything("what is set").like(measure);
                values.extend(self.setting(&quantity, rules, &member.locals).map(|value| (target, value)));
            }
        }
        self.model.sets.push(Set { values });
        Some(EventAction::Set(self.model.sets.len() - 1))
    }

    /// What a key of `set` names, and its unit.
    fn target(&mut self, member: &Expanded, primes: u8, spot: &Spot<'_>) -> Option<(Target, Measure)> {
        let place = spot.place.of_key();
        let name = format!("{}{}", member.name(), "'".repeat(usize::from(primes)));
        let Some(entry) = self.scope.names.get(&member.base) else {
            let states = self.model.states.iter().map(|state| state.name.as_str());
            let known: Vec<&str> = self.model.memory.iter().map(|held| held.name.as_str()).chain(states).collect();
            self.builder.problems.push(names::unknown_name(place, &name, held_or_declared(&name, &known)));
            return None;
        };
        let units = &self.scope.units;
        let (found, help) = match entry.members.get(&member.indices) {
            Some(Member::Memory(j)) if primes == 0 => {
                return Some((Target::Memory(*j as usize), units.memory[*j as usize]));
            }
            Some(Member::State(j)) if primes == 0 => {
                return Some((Target::State(*j as usize), units.states[*j as usize]));
            }
            Some(Member::Refused) => return None,
            _ if entry.refused => return None,
            Some(Member::Coordinate(_)) if primes > 0 => (
                "a speed",
                "speeds jump by an impact, `then: {impact: e, along: c}` with a constraint c, or where a phase with further constraints begins",
            ),
            Some(Member::Coordinate(_) | Member::Rotation(_)) => {
                ("a coordinate", "bodies do not jump; what is counted or remembered of it is declared in `memory`")
            }
            Some(Member::State(_)) => ("the rate of a state", "set the state; its rate follows from the model"),
            Some(Member::Memory(_)) => ("the rate of a held value, which has none", "set the value itself"),
            Some(Member::Parameter(_) | Member::Item(_)) => {
                (entry.section.noun(), "declare a value of its own in `memory` and use that")
            }
            Some(_) => (entry.section.noun(), "declare a value of its own in `memory`"),
            None => {
                let range = entry.range(&member.base);
                let indices: Vec<String> = member.indices.iter().map(ToString::to_string).collect();
                let problem = names::index_out_of_range(place, &member.base, indices.join(","), range);
                self.builder.problems.push(problem);
                return None;
            }
        };
        self.builder.problems.push(memory::cannot_set(place, name, found, help));
        None
    }
}
