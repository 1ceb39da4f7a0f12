//! `motions`: what is asked of motions, beside where runs start (LANGUAGE, section 9).

use std::collections::BTreeMap;

use super::closes::BETWEEN_SAYS;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::diagnose::{Place, did_you_mean_or};
use crate::expr::vectors::axes;
use crate::expr::{Id, Symbol};
use crate::file::{Node, Spot};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::{Expanded, Family};
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Section;
use crate::model::motion::{Goal, Motion};
use crate::model::resolved::HIDDEN;
use crate::model::resolver::Resolver;

/// What a motion may say.
const KEYS: [&str; 13] = [
    "scene",
    "start",
    "set",
    "phase",
    "tolerance",
    "until",
    "closes",
    "energy",
    "unknown",
    "such_that",
    "maximise",
    "minimise",
    "fit",
];

/// What may be asked of a motion.
const GOALS: [&str; 5] = ["closes", "such_that", "maximise", "minimise", "fit"];

/// The name of the end of a run among what is unknown.
const UNTIL: &str = "until";

/// Something that a motion has at its end.
struct Observed {
    /// A coordinate, a rate, or a component of an output.
    name: String,
    unit: Measure,
    /// The coordinate's own unit, as written.
    words: Option<String>,
}

impl Resolver<'_> {
    /// All motions.
    pub fn motions(&mut self) {
        let mut seen = BTreeMap::new();
        for (key, spot) in self.section("motions") {
            let Some(name) = self.label(key, &spot, "`motions`") else { continue };
            if !self.unique(&mut seen, &name, "`motions`", &spot.place)
                || !spot.only(&KEYS, "a motion", &mut self.builder.problems)
            {
                continue;
            }
            self.motion(name, &spot);
        }
    }

    fn motion(&mut self, name: String, spot: &Spot<'_>) {
        let before = self.builder.problems.len();
        let Some(inherited) = self.scenes_of(spot) else { return };
        let texts: Vec<&Spot<'_>> = std::iter::once(spot).chain(&inherited).collect();
        let mut held = Vec::new();
        let mut scene = self.scene(&format!("motions.{name}"), &texts, &mut held);
        scene.need = None;
        let unknowns = self.unknown_values(spot);
        let goal = self.goal(spot, &scene, &unknowns);
        let energy = spot.get("energy").filter(|_| spot.get("closes").is_none());
        if let Some(energy) = energy {
            self.builder.problems.push(sections::needs_another_key(
                energy.place.of_key(),
                "energy",
                "closes",
                "a motion",
            ));
        }
        let Some(goal) = goal else { return };
        let wants_unknowns = !matches!(goal, Goal::Closes(_));
        match (wants_unknowns, spot.get("unknown")) {
            (true, None) => {
                self.builder.problems.push(sections::missing_key(spot.place.of_key(), "unknown", "a motion"));
            }
            (false, Some(unknown)) => {
                let place = unknown.place.of_key();
                self.builder.problems.push(sections::conflicting_keys(place, "closes", "unknown", "a motion"));
            }
            _ => {}
        }
        if self.builder.problems.len() == before {
            let unknowns = unknowns.into_iter().map(|(name, id, _)| (name, id)).collect();
            self.model.motions.push(Motion { name, scene, goal, unknowns, place: spot.place.clone() });
            self.start_conditions(held);
        }
    }

    /// The scene that a motion names, and the first one.
    fn scenes_of<'s>(&mut self, spot: &Spot<'s>) -> Option<Vec<Spot<'s>>>
    where
        Self: 's,
    {
        let root = self.root.clone();
        let default = root.get("scene").filter(|scene| matches!(scene.node, Node::Map(_)));
        let mut texts = Vec::new();
        if let Some(named) = spot.get("scene") {
            let words = named.words(&mut self.builder.problems)?;
            if words != "scene" {
                let Some(scene) = root.get("scenes").and_then(|scenes| scenes.get(words)) else {
                    let known: Vec<&str> = self.model.scenes.iter().map(|scene| scene.name.as_str()).collect();
                    let help = did_you_mean_or(words, &known);
                    self.builder.problems.push(sections::unknown_choice(named.place, words, "a scene", help));
                    return None;
                };
                texts.push(scene);
            }
        }
        texts.extend(default);
        Some(texts)
    }

    /// `unknown`: what the program calls them, their guesses, and which parameters they are.
    fn unknown_values(&mut self, spot: &Spot<'_>) -> Vec<(String, Id, Option<usize>)> {
        let Some(spot) = spot.get("unknown") else { return Vec::new() };
        let mut found: Vec<(String, Id, Option<usize>)> = Vec::new();
        let entries = spot.entries(&mut self.builder.problems);
        if entries.is_empty() && matches!(spot.node, Node::Map(_)) {
            self.builder.problems.push(sections::empty_list(spot.place.of_key(), "unknown", "number"));
        }
        for (key, entry) in entries {
            let Some(family) = self.start_key(key, &entry) else { continue };
            let Some(values) = self.values_for(&entry, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some((name, rules, parameter)) = self.unknown_value(member, &family, &entry) else { break };
                if found.iter().any(|(known, ..)| *known == name) {
                    self.builder.problems.push(names::member_twice(entry.place.of_key(), name));
                    break;
                }
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    found.push((name, value, parameter));
                }
            }
        }
        found
    }

    /// What an entry of `unknown` is: its name, the rules of its guess, and which parameter it is.
    fn unknown_value(
        &mut self,
        member: &Expanded,
        family: &Family,
        spot: &Spot<'_>,
    ) -> Option<(String, Rules, Option<usize>)> {
        let name = member.name();
        let entry = self.scope.names.get(&member.base);
        if family.key.primes == 0 && name == UNTIL && entry.is_none() {
            return Some((name, Rules::constant("a guess of the end").si(Dimension::TIME), None));
        }
        if family.key.primes == 0 && entry.is_some_and(|entry| entry.section == Section::Parameter) {
            let parameter = self.free_parameter(member, &spot.place)?;
            let words = self.model.parameters[parameter].unit.as_deref();
            let unit = self.scope.units.parameters[parameter];
            let rules = Rules::constant("a guess of it").like(unit).counting(words);
            return Some((name, rules, Some(parameter)));
        }
        if entry.is_none() {
            let coordinates = self.model.coordinates.iter().map(|c| c.name.trim_start_matches(HIDDEN));
            let parameters = self.model.parameters.iter().map(|p| p.name.as_str());
            let known: Vec<&str> = coordinates.chain(parameters).chain([UNTIL]).collect();
            let help = did_you_mean_or(&name, &known);
            self.builder.problems.push(names::unknown_name(spot.place.of_key(), &name, help));
            return None;
        }
        let coordinate = self.state_of(member, family.key.primes, &spot.place)?;
        Some((
            coordinate.name,
            Rules::constant("a guess of it").like(coordinate.unit).counting(coordinate.words.as_deref()),
            None,
        ))
    }

    /// A coordinate, its rate, or a state of first order.
    fn state_of(&mut self, member: &Expanded, primes: u8, place: &Place) -> Option<Observed> {
        if primes > 1 {
            let help = "accelerations follow from the model";
            self.builder.problems.push(mechanics::unknown_start(place.of_key(), format!("{}''", member.name()), help));
            return None;
        }
        if let Some((_, state)) = self.state(member).filter(|_| primes == 0) {
            let (unit, known) = (self.scope.units.states[state], &self.model.states[state]);
            return Some(Observed { name: known.name.clone(), unit, words: known.unit.clone() });
        }
        let coordinate = self.coordinate(member, place)?;
        let own = self.scope.units.coordinates.get(coordinate).copied().unwrap_or_default();
        let known = self.model.coordinates.get(coordinate)?;
        let (name, words) = (known.name.clone(), known.unit.clone());
        match primes {
            0 => Some(Observed { name, unit: own, words }),
            _ => Some(Observed { name: format!("{name}'"), unit: self.scope.units.rate(own), words }),
        }
    }

    /// What `closes`, `such_that`, `maximise`, `minimise` and `fit` say.
    fn goal(
        &mut self,
        spot: &Spot<'_>,
        scene: &crate::model::resolved::Scene,
        unknowns: &[(String, Id, Option<usize>)],
    ) -> Option<Goal> {
        let given: Vec<&str> = GOALS.into_iter().filter(|key| spot.get(key).is_some()).collect();
        let Some(first) = given.first() else {
            if !spot.misspelt(&self.builder.problems) {
                let keys = "`closes`, `such_that`, `maximise`, `minimise`, `fit`";
                self.builder.problems.push(sections::needs_one_of(spot.place.of_key(), keys, "a motion"));
            }
            return None;
        };
        // Values at the end may be had while something is largest; nothing else goes together.
        let together = |a: &str, b: &str| a == "such_that" && matches!(b, "maximise" | "minimise");
        for other in &given[1..] {
            if !together(first, other) || given.len() > 2 {
                let place = spot.get(other).map_or_else(Place::default, |spot| spot.place.of_key());
                self.builder.problems.push(sections::conflicting_keys(place, *first, *other, "a motion"));
                return None;
            }
        }
        if let Some(closes) = spot.get("closes") {
            return self.closes(&closes, spot.get("energy"), scene).map(|closes| Goal::Closes(Box::new(closes)));
        }
        if let Some(fit) = spot.get("fit") {
            return self.record(&fit).map(Goal::Fits);
        }
        let conditions = spot.get("such_that").map_or_else(Vec::new, |spot| self.conditions(&spot, unknowns));
        let mut extreme = None;
        for (key, largest) in [("maximise", true), ("minimise", false)] {
            let Some(wanted) = spot.get(key) else { continue };
            let words = wanted.words(&mut self.builder.problems)?;
            extreme = Some((self.observed_name(words, &wanted.place)?, largest));
        }
        Some(Goal::Meets { conditions, extreme })
    }

    /// `such_that`: values at the end.
    fn conditions(&mut self, spot: &Spot<'_>, unknowns: &[(String, Id, Option<usize>)]) -> Vec<(String, Id)> {
        let mut found: Vec<(String, Id)> = Vec::new();
        for (key, entry) in spot.entries(&mut self.builder.problems) {
            let place = entry.place.of_key();
            let Some((observed, locals)) = self.observed(key, &place) else { continue };
            if found.iter().any(|(name, _)| *name == observed.name) {
                self.builder.problems.push(names::member_twice(place, observed.name));
                continue;
            }
            let Some(value) = entry.quantity(&mut self.builder.problems) else { continue };
            let rules = Rules::constant("its value").like(observed.unit).counting(observed.words.as_deref());
            let Some(value) = self.setting(&value, rules, &locals.locals) else { continue };
            let parameters = self.builder.graph.symbols([value]);
            let moving = unknowns
                .iter()
                .find(|(.., parameter)| parameter.is_some_and(|k| parameters.contains(&Symbol::Parameter(k as u32))));
            if let Some((parameter, ..)) = moving {
                self.builder.problems.push(mechanics::moving_goal(entry.place.clone(), &observed.name, parameter));
                continue;
            }
            found.push((observed.name, value));
        }
        found
    }

    /// The name of something that a motion has at its end, or of which there is a record.
    pub fn observed_name(&mut self, words: &str, place: &Place) -> Option<String> {
        self.observed(words, place).map(|(observed, _)| observed.name)
    }

    /// A coordinate, a rate, an output, or a component of an output, `tip.y`.
    fn observed(&mut self, words: &str, place: &Place) -> Option<(Observed, Expanded)> {
        let (base, component) = match words.trim().rsplit_once('.') {
            Some((base, axis @ ("w" | "x" | "y" | "z"))) => (base, Some(axis)),
            _ => (words, None),
        };
        let at = Spot { node: &Node::Null, place: place.clone(), name: String::new() };
        let family = self.start_key(base, &at)?;
        let [member] = family.members.as_slice() else {
            self.builder.problems.push(sections::family_not_allowed(place.clone(), "what a motion has at its end"));
            return None;
        };
        let member = member.clone();
        let moves = |section: Section| matches!(section, Section::Coordinate | Section::State);
        let coordinate = self.scope.names.get(&member.base).is_some_and(|entry| moves(entry.section));
        if coordinate && component.is_none() {
            return self.state_of(&member, family.key.primes, place).map(|observed| (observed, member));
        }
        let name = member.name();
        let output = self.model.outputs.iter().find(|output| output.name == name && family.key.primes == 0);
        let Some(output) = output else {
            let declared = |section: &str| self.root.get(section).is_some_and(|spot| spot.get(base).is_some());
            // One that was refused is not told of twice.
            if !declared("outputs") {
                let coordinates = self.model.coordinates.iter().map(|c| c.name.trim_start_matches(HIDDEN));
                let known: Vec<&str> = coordinates.chain(self.model.outputs.iter().map(|o| o.name.as_str())).collect();
                let help = did_you_mean_or(&name, &known);
                let help = format!("{help}; what a motion has at its end is a coordinate, a rate or an output");
                self.builder.problems.push(names::unknown_name(place.clone(), words.trim(), help));
            }
            return None;
        };
        let count = output.value.len();
        let axis = component.map(|axis| axes(count).iter().position(|known| *known == axis).unwrap_or(count));
        let unit = self.watched.get(&name).and_then(|list| list.iter().flatten().next()).map(|watched| watched.unit);
        let unit = unit.unwrap_or_default();
        match (axis, count) {
            (None, 1) => Some((Observed { name, unit, words: None }, member)),
            (Some(axis), 2..) if axis < count => {
                Some((Observed { name: format!("{name}.{}", axes(count)[axis]), unit, words: None }, member))
            }
            (Some(_), _) => {
                self.builder.problems.push(names::unknown_name(
                    place.clone(),
                    words.trim(),
                    "it has no such component",
                ));
                None
            }
            (None, _) => {
                let help = format!("a vector: name a component, `{name}.x`");
                self.builder.problems.push(names::unknown_name(place.clone(), &name, help));
                None
            }
        }
    }

    /// Conflicts between what says where a motion begins and ends, and what says how its end is its start.
    pub fn not_beside_between(&mut self, spot: &Spot<'_>) -> bool {
        let conflict = BETWEEN_SAYS.into_iter().find_map(|key| spot.get(key).map(|other| (key, other)));
        let Some((key, other)) = conflict else { return true };
        self.builder.problems.push(sections::conflicting_keys(other.place.of_key(), "from", key, "`closes`"));
        false
    }
}
