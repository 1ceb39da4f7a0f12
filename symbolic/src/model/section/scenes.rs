//! `scene`, `scenes` and `equilibrium`: where runs start and how long they go.

use std::collections::BTreeMap;

use super::parameters::flat;
use super::watched::Watched;
use crate::diagnose::catalogue::{mechanics, names, sections, units};
use crate::diagnose::{Place, Problem};
use crate::expr::{Id, Rational};
use crate::file::{Node, Quantity, Spot};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::facts::Depends;
use crate::model::expression::families::{self, Expanded, Family, Locals};
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Member;
use crate::model::resolved::{Amount, Coordinate, HIDDEN, Need, Scene};
use crate::model::resolver::Resolver;
use crate::model::text::rate_name;

/// True for a whole number of 10 to 360 that is a multiple of 5: an angle as people write it in degrees, and hardly one in radians.
pub fn looks_like_degrees(words: &str) -> bool {
    let number = words.trim().parse::<f64>().unwrap_or(f64::NAN).abs();
    (10.0..=360.0).contains(&number) && number % 5.0 == 0.0
}

const SCENE_KEYS: [&str; 9] = ["start", "until", "tolerance", "every", "phase", "set", "guess", "also", "needs"];

/// Which numbers a setting may have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Least {
    AboveZero,
    Zero,
}

const END: Rules = Rules::constant("the end of a run").si(Dimension::TIME);
const SPACING: Rules = Rules::constant("a spacing").si(Dimension::TIME);
const TOLERANCE: Rules = Rules::constant("a tolerance").si(Dimension::ONE);
const AMOUNT: Rules = Rules::constant("an accuracy");
const ACCURACY: Rules = Rules::constant("an accuracy").si(Dimension::ONE);

/// An entry of `start_conditions`, to be looked up among what is watched.
#[derive(Clone, Debug)]
pub struct Held {
    /// The scene's place.
    scene: usize,
    /// What is held.
    name: String,
    /// Its value, by component.
    values: Vec<Quantity>,
    locals: Locals,
    place: Place,
}

impl Resolver<'_> {
    /// A value in SI; a pure number is in the unit of what it sets.
    pub fn setting(&mut self, quantity: &Quantity, rules: Rules, locals: &Locals) -> Option<Id> {
        self.builder.setting(&self.scope, quantity, rules, locals)
    }

    /// All scenes; the default one is there even if the file has none.  Returns what they hold besides coordinates.
    pub fn scenes(&mut self) -> Vec<Held> {
        let mut held = Vec::new();
        let empty = Node::Map(Vec::new());
        let absent = Spot { node: &empty, place: self.root.place.key("scene"), name: "scene".to_owned() };
        let default = self.root.get("scene");
        if let Some(spot) = &default {
            self.check_scene(spot);
        }
        let default = default.filter(|spot| matches!(spot.node, Node::Map(_))).unwrap_or(absent);
        let scene = self.scene("scene", &[&default], &mut held);
        self.model.scenes.push(scene);
        let mut seen = BTreeMap::from([("scene".to_owned(), ())]);
        let further = self.section("scenes");
        if !further.is_empty() && further.iter().all(|(key, _)| SCENE_KEYS.contains(key)) {
            // One scene, which its plural does not name.
            let place = self.root.place.key("scenes").of_key();
            let problem = sections::wrong_shape(place, "`scenes`", "a mapping of scenes by their names", "one scene");
            self.builder.problems.push(Problem { help: "write `scene:`".to_owned(), ..problem });
            self.equilibrium();
            return held;
        }
        for (key, spot) in further {
            let Some(name) = self.label(key, &spot, "`scenes`") else { continue };
            let fresh = self.unique(&mut seen, &name, "`scenes`", &spot.place);
            if fresh && self.check_scene(&spot) {
                let scene = self.scene(&name, &[&spot, &default], &mut held);
                self.model.scenes.push(scene);
            }
        }
        self.equilibrium();
        held
    }

    fn check_scene(&mut self, spot: &Spot<'_>) -> bool {
        spot.only(&SCENE_KEYS, "a scene", &mut self.builder.problems)
    }

    /// One scene; the keys that the first of its texts leaves out are those of the next.
    pub fn scene(&mut self, name: &str, texts: &[&Spot<'_>], held: &mut Vec<Held>) -> Scene {
        let get = |key: &str| texts.iter().find_map(|spot| spot.get(key));
        let count = self.model.coordinates.len();
        let mut scene = Scene {
            name: name.to_owned(),
            q: vec![Id::ZERO; count],
            v: vec![Id::ZERO; count],
            held_q: self.model.coordinates.iter().map(Coordinate::is_hidden).collect(),
            // Of a state nothing is searched: it starts at what the file says, or at 0.
            held_v: self.model.coordinates.iter().map(Coordinate::is_hidden).collect(),
            spins: Vec::new(),
            guessed: false,
            start_conditions: Vec::new(),
            phase: 0,
            until: self.builder.graph.integer(10),
            tolerance: self.builder.graph.rational(Rational::new(1, 1_000_000_000).unwrap_or(Rational::ONE)),
            every: None,
            set: Vec::new(),
            need: None,
            memory: self.model.memory.iter().map(|held| held.start).collect(),
        };
        self.unturned(&mut scene.q);
        if let Some(phase) = get("phase") {
            scene.phase = self.one_phase(&phase, &Self::no_locals()).unwrap_or(0);
        }
        if let Some(start) = get("start") {
            self.start(&start, &mut scene);
        }
        if let Some(start_conditions) = get("also") {
            self.also_held(&start_conditions, held);
        }
        let solved = get("also").is_some() || !self.model.phases[scene.phase].constraints.is_empty() || self.has_knots;
        match get("guess") {
            Some(guess) if solved => self.guess(&guess, &mut scene),
            Some(guess) if texts[0].get("guess").is_some() => {
                self.builder.problems.push(mechanics::idle_guess(guess.place.of_key()));
            }
            _ => {}
        }
        self.rates_of_spins(&mut scene);
        if let Some(set) = get("set") {
            self.set(&set, &mut scene);
        }
        scene.until =
            get("until").and_then(|spot| self.above(&spot, (END, Least::Zero), &scene)).unwrap_or(scene.until);
        let tolerance = get("tolerance").and_then(|spot| self.positive(&spot, TOLERANCE, &scene));
        scene.tolerance = tolerance.unwrap_or(scene.tolerance);
        scene.every = get("every").and_then(|spot| self.positive(&spot, SPACING, &scene));
        scene.need = get("needs").and_then(|spot| self.need(&spot, &scene));
        scene
    }

    /// `needs`: what a scene is run for, and how exactly.
    fn need(&mut self, spot: &Spot<'_>, scene: &Scene) -> Option<Need> {
        if !spot.only(&["outputs", "within", "absolute"], "`needs`", &mut self.builder.problems) {
            return None;
        }
        let mut outputs = Vec::new();
        if let Some(list) = spot.get("outputs") {
            for item in list.list(&mut self.builder.problems) {
                outputs
                    .extend(item.words(&mut self.builder.problems).map(|name| (name.to_owned(), item.place.clone())));
            }
        }
        let within = spot.need("within", "`needs`", &mut self.builder.problems)?;
        let mut absolute = Vec::new();
        if let Some(given) = spot.get("absolute") {
            for (name, entry) in given.entries(&mut self.builder.problems) {
                let Some(value) = self.positive(&entry, AMOUNT, scene) else { continue };
                let dimension = self.builder.measured.dimension().filter(|dimension| *dimension != Dimension::ONE);
                let unit = dimension.map(|dimension| dimension.to_string());
                absolute.push(Amount { name: name.to_owned(), place: entry.place.of_key(), value, unit });
            }
        }
        Some(Need { outputs, within: self.positive(&within, ACCURACY, scene)?, absolute })
    }

    /// The unit of a coordinate, rate or output, where it is known and not 1.
    fn unit_of_wanted(&self, name: &str) -> Option<String> {
        let place = |name: &str| self.model.coordinates.iter().position(|c| c.name == name);
        let units = &self.scope.units;
        let state = self.model.states.iter().position(|state| state.name == name);
        let of = |k: usize| units.coordinates.get(k).copied().unwrap_or_default();
        let measure = match (place(name), name.strip_suffix('\'').and_then(place)) {
            _ if state.is_some() => state.and_then(|j| units.states.get(j)).copied().unwrap_or_default(),
            (Some(k), _) => of(k),
            (None, Some(k)) => units.rate(of(k)),
            (None, None) => return self.model.outputs.iter().find(|output| output.name == name)?.unit.clone(),
        };
        measure.dimension().filter(|dimension| *dimension != Dimension::ONE).map(|dimension| dimension.to_string())
    }

    /// Looks up what scenes need, now that outputs are known.
    pub fn needed(&mut self) {
        let coordinates = self.model.coordinates.iter().flat_map(|c| [c.name.clone(), rate_name(&c.name, 1)]);
        let known: Vec<String> =
            coordinates.chain(self.model.outputs.iter().map(|output| output.name.clone())).collect();
        let mut seen: Vec<Place> = Vec::new();
        let amounts = self.model.scenes.iter().filter_map(|scene| scene.need.as_ref());
        for amount in amounts.flat_map(|need| &need.absolute) {
            let wanted = self.unit_of_wanted(&amount.name);
            if let (Some(unit), Some(wanted)) = (&amount.unit, wanted)
                && *unit != wanted
                && !seen.contains(&amount.place)
            {
                let found = format!("in {unit}");
                let wanted = format!("is in {wanted}");
                let of = format!("`{}`", amount.name);
                self.builder.problems.push(units::wrong_unit(
                    amount.place.clone(),
                    "this amount",
                    found,
                    of,
                    wanted,
                    "",
                ));
                seen.push(amount.place.clone());
            }
        }
        for need in self.model.scenes.iter().filter_map(|scene| scene.need.as_ref()) {
            let amounts = need.absolute.iter().map(|amount| (&amount.name, &amount.place));
            let named = need.outputs.iter().map(|(name, place)| (name, place)).chain(amounts);
            for (name, place) in named.filter(|(name, _)| !known.contains(name)) {
                // A scene that inherits it is not told again.
                if !seen.contains(place) {
                    let known: Vec<&str> = known.iter().map(String::as_str).collect();
                    let help = crate::diagnose::did_you_mean_or(name, &known);
                    self.builder.problems.push(names::unknown_name(place.clone(), name, help));
                    seen.push(place.clone());
                }
            }
        }
    }

    /// The values of the free parameters in a scene.
    pub fn scene_parameters(&self, scene: &Scene) -> Vec<f64> {
        let mut parameters: Vec<f64> = self.model.parameters.iter().map(|p| p.default).collect();
        let set: Vec<Id> = scene.set.iter().map(|(_, value)| *value).collect();
        let values = crate::model::command::evaluate_all(&self.builder.graph, &set, &parameters);
        for ((parameter, _), value) in scene.set.iter().zip(values) {
            parameters[*parameter] = value;
        }
        parameters
    }

    /// A positive number of parameters.
    pub fn positive(&mut self, spot: &Spot<'_>, rules: Rules, scene: &Scene) -> Option<Id> {
        self.above(spot, (rules, Least::AboveZero), scene)
    }

    /// A number of parameters that is no less than 0.
    fn above(&mut self, spot: &Spot<'_>, (rules, least): (Rules, Least), scene: &Scene) -> Option<Id> {
        let what = rules.what;
        let quantity = spot.quantity(&mut self.builder.problems)?;
        let value = self.setting(&quantity, rules, &Self::no_locals())?;
        let constant = self.builder.graph.number(value).is_some();
        let parameters = if constant { Vec::new() } else { self.scene_parameters(scene) };
        match crate::model::command::evaluate(&self.builder.graph, value, &parameters) {
            Some(number) if number > 0.0 || number == 0.0 && least == Least::Zero => Some(value),
            Some(number) => {
                let wanted = if least == Least::Zero { "no less than 0" } else { "positive" };
                let problem = mechanics::value_out_of_range(spot.place.clone(), what, wanted, number);
                self.builder.problems.push(problem);
                None
            }
            None => {
                self.builder.problems.push(names::undefined_value(spot.place.clone(), &quantity.text.source));
                None
            }
        }
    }

    /// `start`: coordinates and, with a prime, their speeds.
    fn start(&mut self, spot: &Spot<'_>, scene: &mut Scene) {
        let mut entries = Vec::new();
        for (key, spot) in spot.entries(&mut self.builder.problems) {
            entries.extend(self.start_key(key, &spot).map(|family| (key, spot, family)));
        }
        // The rates of rotations follow from where these start.
        entries.sort_by_key(|(_, _, family)| family.key.primes);
        let places: BTreeMap<String, Spot<'_>> =
            entries.iter().map(|(key, spot, _)| ((*key).to_owned(), spot.clone())).collect();
        for (key, spot, family) in entries {
            if self.start_rotations(&spot, &family, &places, scene)
                || self.start_states(key, &spot, &family, scene)
                || self.start_memory(&spot, &family, scene)
            {
                continue;
            }
            if family.key.primes > 1 {
                let help = "accelerations follow from the model";
                self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
                continue;
            }
            let speed = usize::from(family.key.primes == 1);
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(coordinate) = self.started(member, key, &spot) else { break };
                let held = if speed == 1 { &mut scene.held_v } else { &mut scene.held_q };
                if std::mem::replace(&mut held[coordinate], true) {
                    let name = format!("{}{}", member.name(), if speed == 1 { "'" } else { "" });
                    self.builder.problems.push(names::member_twice(spot.place.of_key(), name));
                    break;
                }
                let unit = self.scope.units.coordinates[coordinate];
                let unit = if speed == 1 { self.scope.units.rate(unit) } else { unit };
                let words = self.model.coordinates[coordinate].unit.as_deref();
                let rules = Rules::constant("a start of it").like(unit).counting(words);
                if speed == 0 && words == Some("rad") {
                    self.degrees(&value, &member.name());
                }
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    let list = if speed == 1 { &mut scene.v } else { &mut scene.q };
                    list[coordinate] = value;
                }
            }
        }
    }

    /// The coordinate of a state, and the state, that a member of a key names.
    pub fn state(&self, member: &Expanded) -> Option<(usize, usize)> {
        match self.scope.names.get(&member.base)?.members.get(&member.indices)? {
            Member::State(state) => Some((self.model.mechanical() + *state as usize, *state as usize)),
            _ => None,
        }
    }

    /// Whether an entry is about states of first order; puts them where they start.
    fn start_states(&mut self, key: &str, spot: &Spot<'_>, family: &Family, scene: &mut Scene) -> bool {
        if family.members.iter().all(|member| self.state(member).is_none()) {
            return false;
        }
        for (coordinate, value) in self.states_given(key, spot, family, "a start of it") {
            if scene.v[coordinate] != Id::ZERO {
                self.builder.problems.push(names::member_twice(spot.place.of_key(), key));
                break;
            }
            scene.v[coordinate] = value;
        }
        true
    }

    /// Values of states, with the places of their coordinates.
    fn states_given(&mut self, key: &str, spot: &Spot<'_>, family: &Family, what: &'static str) -> Vec<(usize, Id)> {
        if family.key.primes > 0 {
            let help = "the rate of a state follows from the model";
            self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
            return Vec::new();
        }
        let Some(values) = self.values_for(spot, family) else { return Vec::new() };
        let mut given = Vec::new();
        for (member, value) in family.members.iter().zip(values) {
            let Some((coordinate, state)) = self.state(member) else { break };
            let words = self.model.states[state].unit.as_deref();
            let rules = Rules::constant(what).like(self.scope.units.states[state]).counting(words);
            given.extend(self.setting(&value, rules, &member.locals).map(|value| (coordinate, value)));
        }
        given
    }

    /// The rotation that a member of a key names.
    fn rotation(&self, member: &Expanded) -> Option<usize> {
        match self.scope.names.get(&member.base)?.members.get(&member.indices)? {
            Member::Rotation(index) => Some(*index),
            _ => None,
        }
    }

    /// Whether an entry is about rotations; puts them where they start.
    fn start_rotations(
        &mut self,
        spot: &Spot<'_>,
        family: &Family,
        places: &BTreeMap<String, Spot<'_>>,
        scene: &mut Scene,
    ) -> bool {
        let mut any = false;
        for member in &family.members {
            let Some(index) = self.rotation(member) else { continue };
            any = true;
            match family.key.primes {
                0 => self.start_of_rotation(index, spot, scene),
                1 => self.start_of_rate(index, spot, places.get(&member.name()), scene),
                _ => {
                    let help = "accelerations follow from the model";
                    self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), member.name(), help));
                }
            }
        }
        any
    }

    /// Warns where the value of an angle looks like degrees; once of what several scenes inherit.
    pub fn degrees(&mut self, value: &Quantity, name: &str) {
        let words = &value.text.source;
        if value.unit.is_none() && looks_like_degrees(words) {
            let place = value.text.place.at(value.text.ast.span);
            let warning = units::degrees_for_radians(place, name, words.trim());
            if self.model.warnings.iter().all(|known| known.place != warning.place) {
                self.model.warnings.push(warning);
            }
        }
    }

    /// `guess`: values of coordinates that `start` does not name, from which a start is searched.
    fn guess(&mut self, spot: &Spot<'_>, scene: &mut Scene) {
        scene.guessed = true;
        let guess = self.coordinates_given(
            spot,
            Rules::constant("a guess of it"),
            "speeds that `start` does not name are those of least kinetic energy",
        );
        for (coordinate, value) in guess {
            if !scene.held_q[coordinate] {
                scene.q[coordinate] = value;
            }
        }
    }

    /// A key of `start`, `sample`, `set`: a name, a member or a family, perhaps with a prime.
    pub fn start_key(&mut self, key: &str, spot: &Spot<'_>) -> Option<Family> {
        let place = spot.place.of_key();
        let mut indices = Vec::new();
        let family = families::expand(&mut self.builder, &self.scope, &mut indices, key, &place)?;
        for (name, place) in indices {
            if self.scope.names.contains_key(&name) {
                self.builder.problems.push(names::index_hides_name(place, name));
                return None;
            }
        }
        Some(family)
    }

    /// The coordinate that an entry of `start` names.
    pub fn started(&mut self, member: &Expanded, key: &str, spot: &Spot<'_>) -> Option<usize> {
        if self.scope.names.contains_key(&member.base) {
            return self.coordinate(member, &spot.place);
        }
        let known = self.model.coordinates.iter().map(|c| c.name.trim_start_matches(HIDDEN));
        let known: Vec<&str> = known.map(|name| name.split('[').next().unwrap_or(name)).collect();
        let rate = crate::diagnose::rate_meant(&member.base, known.iter().copied());
        let help = rate.unwrap_or_else(|| crate::diagnose::did_you_mean(&member.base, known));
        self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), key, help));
        None
    }

    /// One value for each member: the same expression, or a list.
    pub fn values_for(&mut self, spot: &Spot<'_>, family: &Family) -> Option<Vec<Quantity>> {
        let problems = &mut self.builder.problems;
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
        for (key, spot) in spot.entries(&mut self.builder.problems) {
            let Some(family) = self.start_key(key, &spot) else { continue };
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(parameter) = self.free_parameter(member, &spot.place) else { break };
                if std::mem::replace(&mut given[parameter], true) {
                    self.builder.problems.push(names::member_twice(spot.place.of_key(), member.name()));
                    break;
                }
                let words = self.model.parameters[parameter].unit.as_deref();
                if words == Some("rad") {
                    self.degrees(&value, &member.name());
                }
                let words = self.model.parameters[parameter].unit.as_deref();
                let rules =
                    Rules::constant("this parameter").like(self.scope.units.parameters[parameter]).counting(words);
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    scene.set.push((parameter, value));
                }
            }
        }
    }

    /// `equilibrium`: where the search starts.
    fn equilibrium(&mut self) {
        let Some(spot) = self.root.get("equilibrium") else { return };
        let mut guess = self.model.unsaid_place();
        let given = self.coordinates_given(&spot, Rules::constant("an equilibrium of it"), "an equilibrium is at rest");
        for (coordinate, value) in given {
            guess[coordinate] = value;
        }
        self.model.equilibrium = Some(guess);
    }

    /// Values of coordinates, each once; `at_rest` says why there are no speeds.
    fn coordinates_given(&mut self, spot: &Spot<'_>, rules: Rules, at_rest: &str) -> Vec<(usize, Id)> {
        let mut given = Vec::new();
        let mut seen = vec![false; self.model.coordinates.len()];
        for (key, spot) in spot.entries(&mut self.builder.problems) {
            let Some(family) = self.start_key(key, &spot) else { continue };
            if family.key.primes > 0 {
                self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), key, at_rest));
                continue;
            }
            if family.members.iter().any(|member| self.state(member).is_some()) {
                given.extend(self.states_given(key, &spot, &family, rules.what));
                continue;
            }
            let rotations: Vec<usize> = family.members.iter().filter_map(|member| self.rotation(member)).collect();
            if !rotations.is_empty() {
                for index in rotations {
                    let first = self.model.rotations[index].first;
                    if std::mem::replace(&mut seen[first], true) {
                        let name = self.model.rotations[index].name.clone();
                        self.builder.problems.push(names::member_twice(spot.place.of_key(), name));
                        break;
                    }
                    let Some(quaternion) = self.rotation_given(index, &spot) else { break };
                    given.extend((first..).zip(quaternion.0));
                }
                continue;
            }
            let Some(values) = self.values_for(&spot, &family) else { continue };
            for (member, value) in family.members.iter().zip(values) {
                let Some(coordinate) = self.started(member, key, &spot) else { break };
                if std::mem::replace(&mut seen[coordinate], true) {
                    self.builder.problems.push(names::member_twice(spot.place.of_key(), member.name()));
                    break;
                }
                let rules = rules.like(self.scope.units.coordinates[coordinate]);
                if self.model.coordinates[coordinate].unit.as_deref() == Some("rad") {
                    self.degrees(&value, &member.name());
                }
                if let Some(value) = self.setting(&value, rules, &member.locals) {
                    given.push((coordinate, value));
                }
            }
        }
        given
    }

    /// The entries of `start_conditions`, whose names mean something once `conserved` and `outputs` are read.
    fn also_held(&mut self, spot: &Spot<'_>, held: &mut Vec<Held>) {
        let scene = self.model.all_scenes().count();
        for (key, spot) in spot.entries(&mut self.builder.problems) {
            let Some(family) = self.start_key(key, &spot) else { continue };
            if family.key.primes > 0 {
                let (why, help) = ("it has a prime", "make its rate an output, `rate(…)`, and name that");
                self.builder.problems.push(mechanics::cannot_hold(spot.place.of_key(), key, why, help));
                continue;
            }
            let values: Vec<Vec<Quantity>> = match spot.items() {
                Some(items) if !family.ranged => {
                    let values: Vec<_> = items.iter().map(|item| item.quantity(&mut self.builder.problems)).collect();
                    let Some(values) = values.into_iter().collect() else { continue };
                    vec![values]
                }
                _ => {
                    let Some(values) = self.values_for(&spot, &family) else { continue };
                    values.into_iter().map(|value| vec![value]).collect()
                }
            };
            for (member, values) in family.members.iter().zip(values) {
                let (name, locals, place) = (member.name(), member.locals.clone(), spot.place.clone());
                held.push(Held { scene, name, values, locals, place });
            }
        }
    }

    /// `start_conditions`: equations on what is conserved or an output.
    pub fn start_conditions(&mut self, held: Vec<Held>) {
        for Held { scene, name, values, locals, place } in held {
            let Some(watched) = self.watched_as(&name, &place) else { continue };
            let zero = matches!(values.as_slice(), [value] if &*value.text.source == "0");
            if !zero && values.len() != watched.value.len() {
                let problem = sections::list_length(place.clone(), &name, watched.value.len(), values.len());
                self.builder.problems.push(problem);
                continue;
            }
            let rules = Rules::constant("its value").like(watched.unit);
            for (k, quantity) in watched.value.iter().enumerate() {
                let Some(value) = self.setting(&values[if zero { 0 } else { k }], rules, &locals) else { break };
                let all =
                    self.model.scenes.iter_mut().chain(self.model.motions.iter_mut().map(|motion| &mut motion.scene));
                all.into_iter()
                    .nth(scene)
                    .into_iter()
                    .for_each(|scene| scene.start_conditions.push((*quantity, value)));
            }
        }
    }

    /// What a name of `conserved` or `outputs` stands for, if a start can be made to give it a value.
    fn watched_as(&mut self, name: &str, place: &Place) -> Option<Watched> {
        let Some(entries) = self.watched.get(name) else {
            let known: Vec<&str> = self.watched.keys().map(String::as_str).collect();
            let help = match known.is_empty() {
                true => "the model has neither".to_owned(),
                false => crate::diagnose::did_you_mean_or(name, &known),
            };
            self.builder.problems.push(mechanics::unknown_held(place.of_key(), name, help));
            return None;
        };
        let entries: Option<Vec<Watched>> = entries.iter().cloned().collect();
        let entries = entries?;
        let watched = entries.first()?.clone();
        let depends = self.builder.depends(&watched.value);
        let function = "name a function of coordinates, velocities and time";
        let (why, help) = if entries.iter().any(|other| other.value != watched.value) {
            ("it stands in `conserved` and in `outputs` with different values", "give one of the two another name")
        } else if depends.meets(Depends::ACCELERATION.and(Depends::JERK).and(Depends::MULTIPLIER)) {
            ("it contains accelerations or reactions, which the start determines", function)
        } else if !depends.meets(Depends::COORDINATE.and(Depends::SPEED)) {
            ("no coordinate or velocity changes it", function)
        } else {
            return Some(watched);
        };
        self.builder.problems.push(mechanics::cannot_hold(place.of_key(), name, why, help));
        None
    }
}
