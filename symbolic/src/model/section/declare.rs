//! Sections that declare names: sizes, parameters, coordinates, inputs, definitions, frames, points, bodies.

use std::rc::Rc;

use super::resolve_values::Want;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{later, mechanics, names, sections};
use crate::expr::Id;
use crate::file::{Node, Quantity, Spot, Written, describe, unit_at};
use crate::language::{Ast, parse, parse_key};
use crate::model::expression::dimension::{Dimension, Measure, si};
use crate::model::expression::families::Family;
use crate::model::expression::index::{Indices, integer};
use crate::model::expression::lower::Local;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{BodyNames, Entry, Member, Section};
use crate::model::resolved::{Coordinate, Input};
use crate::model::resolver::Resolver;

/// A body's entry in the file, read once for all members of a family.
#[derive(Clone, Debug)]
pub struct BodyText {
    /// Its mass.
    pub mass: Option<Quantity>,
    /// Its moment of inertia.
    pub inertia: Option<Quantity>,
    /// Where it stands.
    pub place: Place,
}

/// A body as declared.
#[derive(Clone, Debug)]
pub struct DeclaredBody {
    /// Its entry.
    pub text: Rc<BodyText>,
    /// Its indices.
    pub locals: crate::model::expression::families::Locals,
}

impl Resolver<'_> {
    /// `sizes`, and what the caller sets instead.
    pub fn sizes(&mut self, overrides: &[(String, i64)]) {
        let entries = self.section("sizes");
        for (name, value) in overrides {
            if !entries.iter().any(|(key, _)| key == name) {
                let known: Vec<&str> = entries.iter().map(|(key, _)| *key).collect();
                let help = crate::diagnose::did_you_mean_or(name, &known);
                let help = if known.is_empty() { "the model has no sizes".to_owned() } else { help };
                self.builder.problems.push(names::unknown_name(Place::default(), name, help));
            }
            let _ = value;
        }
        for (key, spot) in entries {
            let Some(family) = self.expand_declared(key, &spot, Section::Size) else { continue };
            if !family.key.indices.is_empty() {
                self.builder.problems.push(sections::family_not_allowed(spot.place.of_key(), "`sizes`"));
                continue;
            }
            let set = overrides.iter().rev().find(|(name, _)| *name == family.key.name).map(|(_, value)| *value);
            let value = set.or_else(|| self.size(key, &spot));
            if let (Some(value), [member]) = (value, family.members.as_slice()) {
                self.declare(Section::Size, member, Member::Size(value), &spot.place);
                self.model.sizes.push((family.key.name.clone(), value));
            } else {
                self.refuse_name(&family.key.name, Section::Size);
            }
        }
    }

    fn size(&mut self, key: &str, spot: &Spot<'_>) -> Option<i64> {
        if matches!(spot.node, Node::List(_) | Node::Map(_)) {
            self.builder.problems.push(names::size_not_integer(spot.place.clone(), key, describe(spot.node)));
            return None;
        }
        let words = spot.words(&mut self.builder.problems)?;
        let found = parse(words).ok().and_then(|ast: Ast| {
            integer(&Indices { scope: &self.scope, source: words, place: &spot.place }, &[], &ast).ok()
        });
        if found.is_none() {
            self.builder.problems.push(names::size_not_integer(spot.place.clone(), key, format!("`{words}`")));
        }
        found
    }

    /// `coordinates`.
    pub fn coordinates(&mut self) {
        let entries = self.section("coordinates");
        for (key, spot) in entries {
            let Some(family) = self.expand_declared(key, &spot, Section::Coordinate) else { continue };
            let mut measure = Measure::Unknown;
            let unit = match spot.node {
                Node::Null => None,
                _ => {
                    let words = spot.words(&mut self.builder.problems);
                    match words.map(|words| unit_at(words, &spot.place)) {
                        Some(Ok(unit)) if !unit.is_si() => {
                            let found = words.unwrap_or_default().trim();
                            self.builder.problems.push(sections::scaled_coordinate(
                                spot.place.clone(),
                                found,
                                si(&unit),
                            ));
                        }
                        Some(Ok(unit)) => measure = self.note_unit(Some(&unit)),
                        Some(Err(found)) => self.builder.problems.extend(found),
                        None => {}
                    }
                    words.map(str::to_owned)
                }
            };
            self.declare_empty(Section::Coordinate, &family);
            for member in &family.members {
                let place = self.model.coordinates.len() as u32;
                if self.declare(Section::Coordinate, member, Member::Coordinate(place), &spot.place) {
                    let coordinate = Coordinate { name: member.name(), unit: unit.clone(), place: spot.place.of_key() };
                    self.model.coordinates.push(coordinate);
                    self.scope.units.coordinates.push(measure);
                }
            }
        }
        let declared = self.root.get("coordinates").is_some();
        if declared && self.model.coordinates.is_empty() && self.builder.problems.is_empty() {
            self.builder.problems.push(mechanics::no_coordinates(Place::default()));
        }
    }

    /// `inputs`.
    pub fn inputs(&mut self) {
        for (key, spot) in self.section("inputs") {
            let Some(family) = self.expand_declared(key, &spot, Section::Input) else { continue };
            let written = spot.text(&mut self.builder.problems).map(Written::One);
            self.declare_empty(Section::Input, &family);
            for member in &family.members {
                let rules = Rules::signal("an input");
                let item = self.item(member.name(), written.clone(), rules, Want::Scalar, &member.locals);
                let place = self.model.inputs.len() as u32;
                if self.declare(Section::Input, member, Member::Input(place, item), &spot.place) {
                    self.model.inputs.push(Input { name: member.name(), signal: [Id::ZERO; 3] });
                }
            }
        }
    }

    /// `define` and `points`.
    pub fn definitions(&mut self) {
        let kinds = [
            (Section::Definition, Rules::any("a definition"), Want::Any),
            (Section::Point, Rules::position("a point").si(Dimension::LENGTH), Want::Vector),
        ];
        for (section, rules, want) in kinds {
            for (key, spot) in self.section(section.key()) {
                let Some(family) = self.expand_declared(key, &spot, section) else { continue };
                let written = spot.written(&mut self.builder.problems);
                self.declare_items(section, &family, &spot.place, written.as_ref(), rules, want);
            }
        }
    }

    fn declare_items(
        &mut self,
        section: Section,
        family: &Family,
        place: &Place,
        written: Option<&Written>,
        rules: Rules,
        want: Want,
    ) {
        self.declare_empty(section, family);
        for member in &family.members {
            let item = self.item(member.name(), written.cloned(), rules, want, &member.locals);
            self.declare(section, member, Member::Item(item), place);
        }
    }

    /// `frames`.
    pub fn frames(&mut self) {
        for (key, spot) in self.section("frames") {
            let Some(family) = self.expand_declared(key, &spot, Section::Frame) else { continue };
            self.declare_empty(Section::Frame, &family);
            let problems = &mut self.builder.problems;
            spot.only(&["angle", "from", "rotate"], "a frame", problems);
            let spatial = spot.get("rotate").is_some() || self.scope.dimension == 3;
            if spatial {
                problems.push(later::form_not_supported(spot.place.of_key(), "a frame that turns in space"));
            }
            let angle = if spatial { None } else { spot.need("angle", "a frame", problems) };
            let written = angle.and_then(|angle| angle.text(problems)).map(Written::One);
            let from = spot.get("from").map(|from| from.text(problems));
            for member in &family.members {
                if spatial || matches!(from, Some(None)) {
                    self.declare(Section::Frame, member, Member::Refused, &spot.place);
                    continue;
                }
                let rules = Rules::position("an angle").si(Dimension::ONE);
                let item = self.item(member.name(), written.clone(), rules, Want::Scalar, &member.locals);
                self.items[item].from = from.clone().flatten();
                self.declare(Section::Frame, member, Member::Frame(item), &spot.place);
            }
        }
    }

    /// `bodies`: their names, positions and angles; masses follow when all names are known.
    pub fn bodies(&mut self) -> Vec<DeclaredBody> {
        let mut bodies = Vec::new();
        for (key, spot) in self.section("bodies") {
            let Some(family) = self.expand_declared(key, &spot, Section::Body) else { continue };
            self.declare_empty(Section::Body, &family);
            self.declare_body(&spot, &family, &mut bodies);
        }
        bodies
    }

    fn declare_body(&mut self, spot: &Spot<'_>, family: &Family, bodies: &mut Vec<DeclaredBody>) {
        let problems = &mut self.builder.problems;
        spot.only(&["mass", "position", "inertia", "angle", "frame"], "a body", problems);
        let inertia = spot.get("inertia");
        let spatial = spot.get("frame").is_some()
            || matches!(inertia, Some(Spot { node: Node::List(_), .. }))
            || (self.scope.dimension == 3 && (spot.get("angle").is_some() || inertia.is_some()));
        if spatial {
            problems.push(later::form_not_supported(spot.place.of_key(), "a rigid body in space"));
            for member in &family.members {
                self.declare(Section::Body, member, Member::Refused, &spot.place);
            }
            return;
        }
        let mass = spot.need("mass", "a body", problems).and_then(|mass| mass.quantity(problems));
        let position = spot.need("position", "a body", problems).and_then(|spot| spot.written(problems));
        let turns = spot.get("angle");
        if let (Some(inertia), None) = (&inertia, &turns) {
            problems.push(mechanics::incomplete_body(inertia.place.of_key(), &family.key.name, "inertia", "angle"));
        }
        if let (Some(turns), None) = (&turns, &inertia)
            && mass.as_ref().is_none_or(|mass| &*mass.text.source != "0")
        {
            let warning = mechanics::no_inertia(turns.place.of_key(), &family.key.name);
            self.model.warnings.push(warning);
        }
        let problems = &mut self.builder.problems;
        let angle = turns.as_ref().and_then(|angle| angle.text(problems)).map(Written::One);
        let inertia = inertia.and_then(|inertia| inertia.quantity(problems));
        for quantity in [&mass, &inertia].into_iter().flatten() {
            self.note_unit(quantity.unit.as_ref().map(|(_, unit)| unit));
        }
        let text = Rc::new(BodyText { mass, inertia, place: spot.place.of_key() });
        for member in &family.members {
            let name = member.name();
            let rules = Rules::position("a position").si(Dimension::LENGTH);
            let at = self.item(name.clone(), position.clone(), rules, Want::Vector, &member.locals);
            let angle = turns.is_some().then(|| {
                let rules = Rules::position("an angle").si(Dimension::ONE);
                self.item(format!("{name}'s angle"), angle.clone(), rules, Want::Scalar, &member.locals)
            });
            let place = self.scope.bodies.len();
            if self.declare(Section::Body, member, Member::Body(place), &spot.place) {
                self.scope.bodies.push(BodyNames { name, position: at, angle });
                bodies.push(DeclaredBody { text: Rc::clone(&text), locals: Rc::clone(&member.locals) });
            }
        }
    }

    /// Names of sections that are refused as a whole, so that their uses are not reported too.
    pub fn refused_names(&mut self) {
        let Some(balances) = self.root.get("balances") else { return };
        let Node::Map(systems) = balances.node else { return };
        let nested = systems.iter().map(|(_, node)| node).chain([balances.node]);
        for system in nested {
            let Node::Map(keys) = system else { continue };
            for (_, reactions) in keys.iter().filter(|(key, _)| key == "reactions") {
                let Node::Map(reactions) = reactions else { continue };
                for (key, _) in reactions {
                    let Ok(key) = parse_key(key) else { continue };
                    let entry = Entry { refused: true, ..Entry::new(Section::Reaction, key.indices.len()) };
                    self.scope.names.entry(key.name).or_insert(entry);
                }
            }
        }
    }

    /// Indices of families may not have the names of other things.
    pub fn check_index_names(&mut self) {
        for (name, place) in std::mem::take(&mut self.index_names) {
            if self.scope.names.contains_key(&name) {
                self.builder.problems.push(names::index_hides_name(place, name));
            }
        }
    }

    /// A text and its indices, for what is evaluated later.
    pub fn no_locals() -> Rc<Vec<(String, Local)>> {
        Rc::new(Vec::new())
    }
}

/// Two or three, whichever most vectors of the file have.
pub fn dimension(root: &Node) -> usize {
    let mut votes = [0_usize; 2];
    let Node::Map(entries) = root else { return 2 };
    let mut stack: Vec<(&str, &Node)> = entries
        .iter()
        .filter(|(key, _)| {
            !matches!(key.as_str(), "parameters" | "phases" | "scene" | "scenes" | "sample" | "about" | "sizes")
        })
        .map(|(key, node)| (key.as_str(), node))
        .collect();
    while let Some((key, node)) = stack.pop() {
        match node {
            Node::Map(entries) => {
                let inherit = matches!(key, "points" | "define" | "outputs" | "conserved" | "constraints");
                stack.extend(
                    entries.iter().map(|(name, node)| (if inherit { "position" } else { name.as_str() }, node)),
                );
            }
            Node::List(nodes) => {
                let vector = matches!(key, "position" | "gravity" | "force" | "at" | "along" | "value");
                if let (true, 2 | 3) = (vector, nodes.len()) {
                    votes[nodes.len() - 2] += 1;
                }
                stack.extend(nodes.iter().map(|node| ("", node)));
            }
            Node::Scalar(text) if text.contains('[') => {
                if let Ok(ast) = crate::language::parse_equation(text) {
                    count_vectors(&ast, &mut votes);
                }
            }
            Node::Scalar(_) | Node::Null => {}
        }
    }
    if votes[1] > votes[0] { 3 } else { 2 }
}

/// Counts vectors in a syntax tree, which is at most 1000 levels deep.
fn count_vectors(ast: &Ast, votes: &mut [usize; 2]) {
    use crate::language::AstKind;
    match &ast.kind {
        AstKind::Vector(parts) => {
            if let 2 | 3 = parts.len() {
                votes[parts.len() - 2] += 1;
            }
            parts.iter().for_each(|part| count_vectors(part, votes));
        }
        AstKind::Negate(inner) | AstKind::Component(inner, _) => count_vectors(inner, votes),
        AstKind::Binary(_, left, right) => {
            count_vectors(left, votes);
            count_vectors(right, votes);
        }
        AstKind::Call { arguments, .. } => arguments.iter().for_each(|part| count_vectors(part, votes)),
        AstKind::Sum(body, _) | AstKind::Integral(body, _) => count_vectors(body, votes),
        AstKind::Number(_) | AstKind::Name { .. } => {}
    }
}
