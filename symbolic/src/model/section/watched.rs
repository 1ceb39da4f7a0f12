//! `conserved`, `checks`, `sample` and `outputs`: what is tested, and what is computed along a run.

use std::collections::BTreeMap;

use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, memory, names};
use crate::diagnose::did_you_mean_or;
use crate::expr::{Binary, Graph, Id, Node as Expression, Symbol, Unary};
use crate::file::{Node, Spot, Text, Written};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::{Expanded, Locals};
use crate::model::expression::radians;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Member;
use crate::model::expression::value::Value;
use crate::model::resolved::{Check, Condition, Conserved, Output, Sample};
use crate::model::resolver::Resolver;

/// Terms that one invariant is taken apart into.
const TERM_LIMIT: usize = 1000;

/// A quantity that `start_conditions` may name.
#[derive(Clone, Debug)]
pub struct Watched {
    /// Its components.
    pub value: Vec<Id>,
    /// Its unit.
    pub unit: Measure,
}

impl Resolver<'_> {
    /// `conserved`, `checks` and `outputs`.
    pub fn watched(&mut self) {
        self.conserved();
        self.checks();
        self.outputs();
    }

    fn conserved(&mut self) {
        let mut seen = BTreeMap::new();
        for (key, spot) in self.section("conserved") {
            let Some(family) = self.expand(key, &spot) else { continue };
            let (value, when) = self.conditional(&spot, "value", "a conserved quantity");
            let written = value.and_then(|value| value.written(&mut self.builder.problems));
            for member in &family.members {
                let name = member.name();
                if !self.unique(&mut seen, &name, "`conserved`", &spot.place) {
                    break;
                }
                let rules = Rules::invariant("a conserved quantity").tested();
                let value = written.as_ref().map(|w| self.builder.written(&self.scope, w, rules, &member.locals));
                self.watch(&name, value.as_ref().unwrap_or(&Value::Poison));
                let (Some(written), Some(value)) = (&written, value) else { continue };
                if value == Value::Poison {
                    continue;
                }
                let Some(phases) = self.claimed_phases(&spot, &member.locals) else { continue };
                let value = components(value, 1);
                let terms = value.iter().map(|x| terms(&mut self.builder.graph, *x)).collect();
                let place = spot.place.clone();
                let counts_energy = names_energy(written);
                let when = when.clone();
                self.model.conserved.push(Conserved { name, value, terms, counts_energy, when, phases, place });
            }
        }
    }

    fn checks(&mut self) {
        let mut seen = BTreeMap::new();
        for (key, spot) in self.section("checks") {
            let Some(family) = self.expand(key, &spot) else { continue };
            let (holds, when) = self.conditional(&spot, "holds", "a check");
            let text = holds.and_then(|holds| holds.equation(&mut self.builder.problems));
            for member in &family.members {
                let name = member.name();
                if !self.unique(&mut seen, &name, "`checks`", &spot.place) {
                    break;
                }
                let Some(text) = &text else { continue };
                let Some(phases) = self.claimed_phases(&spot, &member.locals) else { continue };
                if let Some((left, right)) = self.sides(text, &member.locals) {
                    let place = spot.place.clone();
                    self.model.checks.push(Check { name, left, right, when: when.clone(), phases, place });
                }
            }
        }
    }

    /// Both sides of an identity, of equal size; an expression without `=` is to vanish.
    pub fn sides(&mut self, text: &Text, locals: &Locals) -> Option<(Vec<Id>, Vec<Id>)> {
        let (left, right) = self.builder.sides(&self.scope, text, Rules::anything("a check").tested(), locals)?;
        Some((components(left, 1), components(right, 1)))
    }

    /// The value, and the parameters that must have certain values.
    fn conditional<'s>(&mut self, spot: &Spot<'s>, key: &str, section: &str) -> (Option<Spot<'s>>, Vec<Condition>) {
        if !matches!(spot.node, Node::Map(_)) {
            return (Some(spot.clone()), Vec::new());
        }
        let problems = &mut self.builder.problems;
        spot.only(&[key, "when", "phase"], section, problems);
        let value = spot.need(key, section, problems);
        let Some(when) = spot.get("when") else { return (value, Vec::new()) };
        let (mut conditions, mut places) = (Vec::new(), Vec::new());
        for (key, spot) in when.entries(&mut self.builder.problems) {
            let Some(family) = self.expand(key, &spot) else { continue };
            let quantity = spot.quantity(&mut self.builder.problems);
            for member in &family.members {
                let Some(parameter) = self.free_parameter(member, &spot.place) else { break };
                let Some(quantity) = &quantity else { continue };
                let words = self.model.parameters[parameter].unit.as_deref();
                let rules =
                    Rules::constant("this parameter").like(self.scope.units.parameters[parameter]).counting(words);
                let id = self.setting(quantity, rules, &member.locals);
                let Some(id) = id else { continue };
                if self.default_value(id).is_none() {
                    self.builder.problems.push(names::undefined_value(spot.place.clone(), &quantity.text.source));
                    continue;
                }
                let written = quantity.text.source.to_string();
                conditions.push(Condition { parameter, value: id, written });
                places.push(spot.place.clone());
            }
        }
        self.refuse_conditions_of_each_other(&conditions, &places);
        (value, conditions)
    }

    /// A condition is computed with the parameters that are drawn, so it may read none that a condition sets.
    fn refuse_conditions_of_each_other(&mut self, conditions: &[Condition], places: &[Place]) {
        for (condition, place) in conditions.iter().zip(places) {
            let read = self.builder.graph.symbols([condition.value]);
            let is_read = |set: &&Condition| read.contains(&Symbol::Parameter(set.parameter as u32));
            if let Some(set) = conditions.iter().find(is_read) {
                let [name, other] = [condition, set].map(|c| self.model.parameters[c.parameter].name.clone());
                self.builder.problems.push(mechanics::moving_condition(place.clone(), name, other));
            }
        }
    }

    /// The value of an expression of parameters at their defaults, if it is finite.
    pub fn default_value(&mut self, id: Id) -> Option<f64> {
        let size = self.builder.graph.len() as u64;
        if self.builder.graph.number(id).is_none() && !self.builder.spend(size, &Place::default()) {
            return None;
        }
        let parameters: Vec<f64> = self.model.parameters.iter().map(|p| p.default).collect();
        crate::model::command::evaluate(&self.builder.graph, id, &parameters)
    }

    /// The free parameter that a key names; reports when it names none.
    pub fn free_parameter(&mut self, member: &Expanded, place: &Place) -> Option<usize> {
        let place = place.of_key();
        let name = member.name();
        if let Some(entry) = self.scope.names.get(&member.base) {
            match entry.members.get(&member.indices) {
                Some(Member::Parameter(parameter)) => return Some(*parameter as usize),
                Some(Member::Refused) => return None,
                _ if entry.refused => return None,
                Some(Member::Item(_)) if entry.section == crate::model::expression::scope::Section::Parameter => {
                    let free = free_names(&self.model);
                    self.builder.problems.push(mechanics::derived_parameter(place, name, free));
                    return None;
                }
                _ if entry.section != crate::model::expression::scope::Section::Parameter => {
                    let found = entry.section.noun();
                    self.builder.problems.push(names::wrong_thing(place, name, "a parameter", found));
                    return None;
                }
                _ => {}
            }
        }
        let known: Vec<&str> = self.model.parameters.iter().map(|p| p.name.as_str()).collect();
        let help =
            if known.is_empty() { "the model has no parameters".to_owned() } else { did_you_mean_or(&name, &known) };
        self.builder.problems.push(names::unknown_name(place, name, help));
        None
    }

    /// `sample`.
    pub fn samples(&mut self) {
        for (key, spot) in self.section("sample") {
            let Some(family) = self.start_key(key, &spot) else { continue };
            let ends = match spot.items() {
                Some(items) if items.len() == 2 => items,
                _ => {
                    spot.wrong_shape("a list of two, `[low, high]`", &mut self.builder.problems);
                    continue;
                }
            };
            let ends: Vec<_> = ends.iter().map(|end| end.quantity(&mut self.builder.problems)).collect();
            let [Some(low), Some(high)] = ends.as_slice() else { continue };
            if family.key.primes > 1 {
                self.builder.problems.push(mechanics::unknown_start(spot.place.of_key(), key, ""));
                continue;
            }
            for member in &family.members {
                let state = self.state(member).filter(|_| family.key.primes == 0);
                let coordinate = state.map(|known| known.0).or_else(|| self.coordinate(member, &spot.place));
                let Some(coordinate) = coordinate else { break };
                let speed = state.is_some() || family.key.primes == 1;
                let unit = self.scope.units.coordinates[coordinate];
                let unit = match state {
                    Some((_, state)) => self.scope.units.states[state],
                    None if speed => self.scope.units.rate(unit),
                    None => unit,
                };
                let words = match state {
                    Some((_, state)) => self.model.states[state].unit.as_deref(),
                    None => self.model.coordinates[coordinate].unit.as_deref(),
                };
                let rules = Rules::constant("a range of it").like(unit).counting(words);
                let low = self.setting(low, rules, &member.locals);
                let high = self.setting(high, rules, &member.locals);
                if let (Some(low), Some(high)) = (low, high) {
                    let ends = [low, high].map(|end| self.default_value(end));
                    if let [Some(low), Some(high)] = ends
                        && low >= high
                    {
                        let context = format!("the range of `{}` in `sample`", member.name());
                        let (wanted, found) = ("from a lower value to a higher one", format!("[{low}, {high}]"));
                        let place = spot.place.clone();
                        self.builder.problems.push(mechanics::value_out_of_range(place, context, wanted, found));
                        break;
                    }
                    self.model.sample.push(Sample { coordinate, speed, low, high });
                }
            }
        }
    }

    fn outputs(&mut self) {
        let Some(spot) = self.root.get("outputs") else { return };
        let mut seen = BTreeMap::new();
        if let Some(items) = spot.items() {
            for item in items {
                self.named_outputs(&item, &mut seen);
            }
            return;
        }
        for (key, spot) in spot.entries(&mut self.builder.problems) {
            let Some(family) = self.expand(key, &spot) else { continue };
            let written = spot.written(&mut self.builder.problems);
            for member in &family.members {
                let name = member.name();
                if !self.unique(&mut seen, &name, "`outputs`", &spot.place) {
                    break;
                }
                match &written {
                    Some(written) => {
                        let value = self.output(name, written, &member.locals);
                        self.refuse_column_of_its_own(member, &value, &spot.place);
                    }
                    None => self.watch(&name, &Value::Poison),
                }
            }
        }
    }

    /// `outputs: [tip, "hand[i in 1..n]"]`: names stand for themselves.
    fn named_outputs(&mut self, item: &Spot<'_>, seen: &mut BTreeMap<String, ()>) {
        let no_locals = Self::no_locals();
        for text in self.listed(item, &no_locals) {
            let place = Place::clone(&text.place);
            if self.unique(seen, &text.source, "`outputs`", &place) {
                let name = text.source.to_string();
                self.output(name, &Written::One(text), &no_locals);
            }
        }
    }

    fn output(&mut self, name: String, written: &Written, locals: &Locals) -> Value {
        let value = self.builder.written(&self.scope, written, Rules::anything("an output"), locals);
        self.watch(&name, &value);
        let measure = self.builder.measured;
        let known = measure.dimension().filter(|dimension| *dimension != Dimension::ONE);
        let ast = if let Written::One(text) = written { Some(&*text.ast) } else { None };
        let unit = known.map(|dimension| radians::unit(dimension, ast, &self.scope.units.radians));
        let components = components(value.clone(), 1);
        self.model.outputs.push(Output { name, value: components, unit, measure, of_reactions: false });
        value
    }

    /// Time, coordinates and states are written down under their own names: an output of one of these names must be that.
    fn refuse_column_of_its_own(&mut self, output: &Expanded, value: &Value, place: &Place) {
        let member = self.scope.names.get(&output.base).and_then(|entry| entry.members.get(&output.indices));
        let (what, own) = match member {
            _ if output.base == "t" => ("time", Some(Symbol::Time)),
            Some(Member::Coordinate(place)) => ("a coordinate", Some(Symbol::Coordinate(*place))),
            Some(Member::Rotation(_)) => ("a coordinate", None),
            Some(Member::State(place)) => ("a state", Some(Symbol::State(*place))),
            _ => return,
        };
        let own = own.map(|symbol| Value::Scalar(self.builder.graph.symbol(symbol)));
        if *value != Value::Poison && own.as_ref() != Some(value) {
            self.builder.problems.push(memory::column_taken(place.of_key(), output.name(), what));
        }
    }

    /// Notes a quantity, in the unit of what was evaluated last, for scenes.
    fn watch(&mut self, name: &str, value: &Value) {
        let unit = self.builder.measured;
        let watched = (*value != Value::Poison).then(|| Watched { value: components(value.clone(), 1), unit });
        self.watched.entry(name.to_owned()).or_default().push(watched);
    }
}

/// Whether `energy` or `potential_energy` stands in an expression.
fn names_energy(written: &Written) -> bool {
    let texts = match written {
        Written::One(text) => std::slice::from_ref(text),
        Written::List(texts, _) => texts,
    };
    let letter = |c: char| c.is_alphanumeric() || c == '_';
    texts.iter().flat_map(|text| text.source.split(|c| !letter(c))).any(|w| matches!(w, "energy" | "potential_energy"))
}

/// `a`, `b` and `c`.
pub fn free_names(model: &crate::model::resolved::Model) -> String {
    let names: Vec<String> = model.parameters.iter().take(20).map(|p| format!("`{}`", p.name)).collect();
    names.join(", ")
}

/// Components; zeros of the wanted number for the sum of nothing, and for what was refused.
fn components(value: Value, size: usize) -> Vec<Id> {
    match value {
        Value::Scalar(x) => vec![x],
        Value::Vector(v) => v,
        Value::Nothing | Value::Poison | Value::Orientation(_) => vec![Id::ZERO; size],
    }
}

/// The terms of a sum, signs left out, factors that all have in common multiplied in: the size of what cancels.
///
/// `m*(x*y' - y*x')` has two: where its parenthesis vanishes, rounding is small beside them, and not beside it.
fn terms(graph: &mut Graph, root: Id) -> Vec<Id> {
    let mut terms = Vec::new();
    for term in summands(graph, root) {
        match graph.node(term) {
            Expression::Binary(Binary::Mul, x, y) => {
                let (xs, ys) = (summands(graph, x), summands(graph, y));
                match (xs.len(), ys.len()) {
                    (1, 2..) => terms.extend(ys.into_iter().map(|y| graph.mul(x, y))),
                    (2.., 1) => terms.extend(xs.into_iter().map(|x| graph.mul(x, y))),
                    _ => terms.push(term),
                }
            }
            _ => terms.push(term),
        }
    }
    terms
}

/// What is added or subtracted on the way to a sum.
fn summands(graph: &Graph, root: Id) -> Vec<Id> {
    let mut summands = Vec::new();
    let mut stack = vec![root];
    while let Some(top) = stack.pop() {
        match graph.node(top) {
            Expression::Binary(Binary::Add | Binary::Sub, x, y) if summands.len() + stack.len() < TERM_LIMIT => {
                stack.extend([y, x]);
            }
            Expression::Unary(Unary::Neg, x) => stack.push(x),
            _ if top != Id::ZERO => summands.push(top),
            _ => {}
        }
    }
    summands
}
