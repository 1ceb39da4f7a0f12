//! `scene`, `scenes` and `equilibrium`: where runs start and how long they go.

use std::collections::BTreeMap;

use super::parameters::flat;
use crate::diagnose::catalogue::{later, mechanics, names, sections};
use crate::expr::{Id, Rational};
use crate::file::{Node, Quantity, Spot};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::{self, Expanded, Family, Locals};
use crate::model::expression::rules::Rules;
use crate::model::resolved::Scene;
use crate::model::resolver::Resolver;

const SCENE_KEYS: [&str; 8] = ["start", "until", "tolerance", "every", "phase", "set", "guess", "also"];

const END: Rules = Rules::constant("the end of a run").si(Dimension::TIME);
const SPACING: Rules = Rules::constant("a spacing").si(Dimension::TIME);
const TOLERANCE: Rules = Rules::constant("a tolerance").si(Dimension::ONE);

impl Resolver<'_> {
    /// A value in SI; a pure number is in the unit of what it sets.
    pub fn setting(&mut self, quantity: &Quantity, rules: Rules, locals: &Locals) -> Option<Id> {
        self.bench.setting(&self.scope, quantity, rules, locals)
    }

    /// All scenes; the default one is there even if the file has none.
    pub fn scenes(&mut self) {
        let empty = Node::Map(Vec::new());
        let absent = Spot { node: &empty, place: self.root.place.key("scene"), name: "scene".to_owned() };
        let default = self.root.get("scene");
        if let Some(spot) = &default {
            self.check_scene(spot);
        }
        let default = default.filter(|spot| matches!(spot.node, Node::Map(_))).unwrap_or(absent);
        self.scene("scene", &default, None);
        let mut seen = BTreeMap::from([("scene".to_owned(), ())]);
        for (key, spot) in self.section("scenes") {
            let Some(name) = self.label(key, &spot, "`scenes`") else { continue };
            let fresh = self.unique(&mut seen, &name, "`scenes`", &spot.place);
            if fresh && self.check_scene(&spot) {
                self.scene(&name, &spot, Some(&default));
            }
        }
        self.equilibrium();
    }

    fn check_scene(&mut self, spot: &Spot<'_>) -> bool {
        let problems = &mut self.bench.problems;
        if !spot.only(&SCENE_KEYS, "a scene", problems) {
            return false;
        }
        for key in ["phase", "guess", "also"] {
            if let Some(found) = spot.get(key) {
                problems.push(later::key_not_supported(found.place.of_key(), key, "a scene"));
            }
        }
        true
    }

    /// One scene; the keys it leaves out are those of `inherited`.
    fn scene(&mut self, name: &str, spot: &Spot<'_>, inherited: Option<&Spot<'_>>) {
        let get = |key: &str| spot.get(key).or_else(|| inherited.and_then(|scene| scene.get(key)));
        let count = self.model.coordinates.len();
        let mut scene = Scene {
            name: name.to_owned(),
            q: vec![Id::ZERO; count],
            v: vec![Id::ZERO; count],
            held_q: vec![false; count],
            held_v: vec![false; count],
            guessed: false,
            also: Vec::new(),
            phase: 0,
            until: self.bench.graph.integer(10),
            tolerance: self.bench.graph.rational(Rational::new(1, 1_000_000_000).unwrap_or(Rational::ONE)),
            every: None,
            set: Vec::new(),
        };
        if let Some(start) = get("start") {
            self.start(&start, &mut scene);
        }
        if let Some(set) = get("set") {
            self.set(&set, &mut scene);
        }
        scene.until = get("until").and_then(|spot| self.positive(&spot, END, &scene)).unwrap_or(scene.until);
        let tolerance = get("tolerance").and_then(|spot| self.positive(&spot, TOLERANCE, &scene));
        scene.tolerance = tolerance.unwrap_or(scene.tolerance);
        scene.every = get("every").and_then(|spot| self.positive(&spot, SPACING, &scene));
        self.model.scenes.push(scene);
    }

    /// A positive number of parameters.
    fn positive(&mut self, spot: &Spot<'_>, rules: Rules, scene: &Scene) -> Option<Id> {
        let what = rules.what;
        let quantity = spot.quantity(&mut self.bench.problems)?;
        let value = self.setting(&quantity, rules, &Self::no_locals())?;
        let mut parameters: Vec<f64> = self.model.parameters.iter().map(|p| p.default).collect();
        if self.bench.graph.number(value).is_none() {
            let set: Vec<Id> = scene.set.iter().map(|(_, value)| *value).collect();
            for ((parameter, _), value) in
                scene.set.iter().zip(crate::model::command::evaluate_all(&self.bench.graph, &set, &parameters.clone()))
            {
                parameters[*parameter] = value;
            }
        }
        match crate::model::command::evaluate(&self.bench.graph, value, &parameters) {
            Some(number) if number > 0.0 => Some(value),
            Some(number) => {
                let problem = mechanics::value_out_of_range(spot.place.clone(), what, "positive", number);
                self.bench.problems.push(problem);
                None
            }
            None => {
                self.bench.problems.push(names::undefined_value(spot.place.clone(), &quantity.text.source));
                None
            }
        }
    }

    /// `start`: coordinates and, with a prime, their speeds.
    fn start(&mut self, spot: &Spot<'_>, scene: &mut Scene) {
        let mut given = [vec![false; scene.q.len()], vec![false; scene.v.len()]];
        for (key, spot) in spot.entries(&mut self.bench.problems) {
            let Some(family) = self.start_key(key, &spot) else { continue };
            if family.key.primes > 1 {
                let help = "accelerations follow from the model";
                self.bench.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
                continue;
            }
            let speed = usize::from(family.key.primes == 1);
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(coordinate) = self.started(member, key, &spot) else { break };
                if std::mem::replace(&mut given[speed][coordinate], true) {
                    let name = format!("{}{}", member.name(), if speed == 1 { "'" } else { "" });
                    self.bench.problems.push(names::member_twice(spot.place.of_key(), name));
                    break;
                }
                let unit = self.scope.units.coordinates[coordinate];
                let unit = if speed == 1 { self.scope.units.rate(unit) } else { unit };
                let rules = Rules::constant("a start of it").like(unit);
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    let list = if speed == 1 { &mut scene.v } else { &mut scene.q };
                    list[coordinate] = value;
                }
            }
        }
    }

    /// A key of `start`, `sample`, `set`: a name, a member or a family, perhaps with a prime.
    pub fn start_key(&mut self, key: &str, spot: &Spot<'_>) -> Option<Family> {
        let place = spot.place.of_key();
        let mut indices = Vec::new();
        let family = families::expand(&mut self.bench, &self.scope, &mut indices, key, &place)?;
        for (name, place) in indices {
            if self.scope.names.contains_key(&name) {
                self.bench.problems.push(names::index_hides_name(place, name));
                return None;
            }
        }
        Some(family)
    }

    /// The coordinate that an entry of `start` names.
    fn started(&mut self, member: &Expanded, key: &str, spot: &Spot<'_>) -> Option<usize> {
        if self.scope.names.contains_key(&member.base) {
            return self.coordinate(member, &spot.place);
        }
        let known = self.model.coordinates.iter().map(|c| c.name.split('[').next().unwrap_or(&c.name));
        let help = crate::diagnose::did_you_mean(&member.base, known);
        self.bench.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
        None
    }

    /// One value for each member: the same expression, or a list.
    fn values_for(&mut self, spot: &Spot<'_>, family: &Family) -> Option<Vec<Quantity>> {
        let problems = &mut self.bench.problems;
        if spot.items().is_none() {
            return spot.quantity(problems).map(|value| vec![value; family.members.len()]);
        }
        if !family.ranged {
            spot.wrong_shape("one number; a list goes with a family, `x[i in 1..3]`", problems);
            return None;
        }
        let values: Vec<Option<Quantity>> = flat(spot).iter().map(|item| item.quantity(problems)).collect();
        if values.len() != family.members.len() {
            let (wanted, found) = (family.members.len(), values.len());
            problems.push(sections::list_length(spot.place.clone(), &family.key.name, wanted, found));
            return None;
        }
        values.into_iter().collect()
    }

    /// `set`: free parameters.
    fn set(&mut self, spot: &Spot<'_>, scene: &mut Scene) {
        let mut given = vec![false; self.model.parameters.len()];
        for (key, spot) in spot.entries(&mut self.bench.problems) {
            let Some(family) = self.start_key(key, &spot) else { continue };
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(parameter) = self.free_parameter(member, &spot.place) else { break };
                if std::mem::replace(&mut given[parameter], true) {
                    self.bench.problems.push(names::member_twice(spot.place.of_key(), member.name()));
                    break;
                }
                let rules = Rules::constant("this parameter").like(self.scope.units.parameters[parameter]);
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    scene.set.push((parameter, value));
                }
            }
        }
    }

    /// `equilibrium`: where the search starts.
    fn equilibrium(&mut self) {
        self.model.equilibrium = vec![Id::ZERO; self.model.coordinates.len()];
        for (key, spot) in self.section("equilibrium") {
            let Some(family) = self.start_key(key, &spot) else { continue };
            if family.key.primes > 0 {
                let help = "an equilibrium is at rest";
                self.bench.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
                continue;
            }
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(coordinate) = self.started(member, key, &spot) else { break };
                let unit = self.scope.units.coordinates[coordinate];
                let rules = Rules::constant("an equilibrium of it").like(unit);
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    self.model.equilibrium[coordinate] = value;
                }
            }
        }
    }
}
