//! Sections that declare names: sizes, parameters, coordinates, inputs, definitions, frames, points, bodies.

use std::rc::Rc;

use super::changing_mass::Exchange;
use super::resolve_values::{Axis, Want};
use super::rotations::ROTATION;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::diagnose::{Place, Problem};
use crate::expr::Id;
use crate::file::{Node, Quantity, Spot, Text, Written, describe, unit_at};
use crate::language::{Ast, parse, parse_key};
use crate::model::expression::dimension::{Dimension, Measure, si};
use crate::model::expression::families::{Family, Locals};
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
    /// Its moments of inertia: one in the plane; in space three, or the nine elements of a tensor.
    pub inertia: Option<Vec<Quantity>>,
    /// The place of the point that its inertia is about, if not its centre of mass.
    pub about: Option<Place>,
    /// With which velocity mass leaves or comes.
    pub exchange: Option<Exchange>,
    /// Where it stands.
    pub place: Place,
}

/// How a frame is turned, as written.
#[derive(Clone, Debug)]
enum Turned {
    /// By an angle.
    Plane(Text),
    /// About axes in turn.
    Space(Vec<(Axis, Text)>),
}

/// A body as declared.
#[derive(Clone, Debug)]
pub struct DeclaredBody {
    /// Its entry.
    pub text: Rc<BodyText>,
    /// The item of the point that its inertia is about.
    pub about: Option<usize>,
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
            if matches!(spot.node, Node::Scalar(kind) if kind.trim() == ROTATION) {
                self.declare_empty(Section::Coordinate, &family);
                for member in &family.members {
                    self.declare_rotation(member, &spot);
                }
                continue;
            }
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
                    self.scope.units.note_radians(&member.base, unit.as_deref());
                    let coordinate = Coordinate { name: member.name(), unit: unit.clone(), place: spot.place.of_key() };
                    self.model.coordinates.push(coordinate);
                    self.scope.units.coordinates.push(measure);
                }
            }
        }
        let declared = self.root.get("coordinates").is_some() && self.root.get("states").is_none();
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
            spot.only(&["angle", "from", "rotate"], "a frame", &mut self.builder.problems);
            let from = spot.get("from").map(|from| from.text(&mut self.builder.problems));
            let turn = if self.scope.dimension == 3 { self.rotate(&spot) } else { self.angle(&spot) };
            for member in &family.members {
                let (Some(turn), None | Some(Some(_))) = (&turn, &from) else {
                    self.declare(Section::Frame, member, Member::Refused, &spot.place);
                    continue;
                };
                let item = self.turned(member.name(), turn.clone(), from.clone().flatten(), &member.locals);
                self.declare(Section::Frame, member, Member::Frame(item), &spot.place);
            }
        }
    }

    /// The angle of a frame in the plane.
    fn angle(&mut self, spot: &Spot<'_>) -> Option<Turned> {
        let angle = spot.need("angle", "a frame", &mut self.builder.problems)?.text(&mut self.builder.problems)?;
        Some(Turned::Plane(angle))
    }

    /// `rotate` of a frame in space: a turn `[axis, angle]`, or a list of them, each about an axis of the frame as already turned.
    fn rotate(&mut self, spot: &Spot<'_>) -> Option<Turned> {
        let problems = &mut self.builder.problems;
        if let Some(angle) = spot.get("angle") {
            problems.push(mechanics::angle_in_space(angle.place.of_key()));
            return None;
        }
        let rotate = spot.need("rotate", "a frame", problems)?;
        if let Node::Map(_) = rotate.node {
            return fixed(&rotate, problems).map(|turn| Turned::Space(vec![turn]));
        }
        if let Node::Scalar(_) = rotate.node {
            return Some(Turned::Space(vec![(Axis::Rotation, rotate.text(problems)?)]));
        }
        self.written_turns(&rotate).map(Turned::Space)
    }

    /// Turns as written: `[axis, angle]`, or a list of such.
    pub fn written_turns(&mut self, rotate: &Spot<'_>) -> Option<Vec<(Axis, Text)>> {
        let problems = &mut self.builder.problems;
        let items = rotate.items().unwrap_or_default();
        let single = matches!(items.as_slice(), [_, angle] if !matches!(angle.node, Node::List(_) | Node::Map(_)));
        let turns = if single { vec![rotate.clone()] } else { items };
        if turns.is_empty() {
            problems.push(mechanics::not_a_turn(rotate.place.clone(), describe(rotate.node)));
            return None;
        }
        let mut turned = Vec::new();
        for turn in turns {
            if let Node::Map(_) = turn.node {
                turned.push(fixed(&turn, problems)?);
                continue;
            }
            let items = turn.items().unwrap_or_default();
            let [axis, angle] = items.as_slice() else {
                problems.push(mechanics::not_a_turn(turn.place.clone(), describe(turn.node)));
                return None;
            };
            if is_axis(angle.node) && !is_axis(axis.node) {
                let mut problem = mechanics::not_a_turn(turn.place.clone(), "an angle and an axis");
                problem.help = "the axis comes first".to_owned();
                problems.push(problem);
                return None;
            }
            let axis = match axis.node {
                Node::Scalar(name) if is_axis(axis.node) => Axis::Own(usize::from(name.as_bytes()[0] - b'x')),
                _ => Axis::Direction(axis.written(problems)?),
            };
            turned.push((axis, angle.text(problems)?));
        }
        Some(turned)
    }

    /// The item that holds how a frame or body is turned.
    fn turned(&mut self, name: String, turn: Turned, from: Option<Text>, locals: &Locals) -> usize {
        let rules = Rules::position("an angle").si(Dimension::ONE);
        let (written, want, axes) = match turn {
            Turned::Plane(angle) => (Written::One(angle), Want::Scalar, Vec::new()),
            Turned::Space(turns) => {
                let place = turns.first().map(|(_, angle)| Rc::clone(&angle.place)).unwrap_or_default();
                let (axes, angles): (Vec<Axis>, Vec<Text>) = turns.into_iter().unzip();
                (Written::List(angles, place), Want::Orientation, axes)
            }
        };
        let item = self.item(name, Some(written), rules, want, locals);
        (self.items[item].from, self.items[item].axes) = (from, axes);
        item
    }

    /// `bodies`: their names, positions and orientations; masses follow when all names are known.
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
        let space = self.scope.dimension == 3;
        let problems = &mut self.builder.problems;
        let keys = ["mass", "position", "inertia", "about", "angle", "frame", "loses", "gains"];
        spot.only(&keys, "a body", problems);
        let mass = spot.need("mass", "a body", problems).and_then(|mass| mass.quantity(problems));
        let position = spot.need("position", "a body", problems).and_then(|spot| spot.written(problems));
        let (inertia, angle, frame) = (spot.get("inertia"), spot.get("angle"), spot.get("frame"));
        match (&angle, &frame) {
            (Some(angle), _) if space => problems.push(mechanics::angle_in_space(angle.place.of_key())),
            (Some(_), Some(frame)) => {
                problems.push(sections::conflicting_keys(frame.place.of_key(), "angle", "frame", "a body"));
            }
            _ => {}
        }
        let about = spot.get("about");
        if let (Some(about), None) = (&about, &inertia) {
            problems.push(sections::needs_another_key(about.place.of_key(), "about", "inertia", "a body"));
        }
        let turns = angle.as_ref().or(frame.as_ref());
        if let (Some(inertia), None) = (&inertia, &turns) {
            let missing = if space { "frame" } else { "angle" };
            problems.push(mechanics::incomplete_body(inertia.place.of_key(), &family.key.name, "inertia", missing));
        }
        if let (Some(turns), None) = (&turns, &inertia)
            && mass.as_ref().is_none_or(|mass| &*mass.text.source != "0")
        {
            let warning = mechanics::no_inertia(turns.place.of_key(), &family.key.name);
            self.model.warnings.push(warning);
        }
        let problems = &mut self.builder.problems;
        let turned = match (space, &frame) {
            (true, _) => Some(Turned::Space(Vec::new())),
            (false, Some(_)) => parse("0").ok().map(|ast| {
                let (ast, place) = (Rc::new(ast), Rc::new(spot.place.clone()));
                Turned::Plane(Text { source: "0".into(), ast, unit: None, place })
            }),
            (false, None) => angle.as_ref().and_then(|angle| angle.text(problems)).map(Turned::Plane),
        };
        let from = frame.as_ref().map(|frame| frame.text(problems));
        let turned = if matches!(from, Some(None)) { None } else { turned };
        let inertia = inertia.and_then(|inertia| {
            if space { moments(&inertia, problems) } else { inertia.quantity(problems).map(|moment| vec![moment]) }
        });
        for quantity in mass.iter().chain(inertia.iter().flatten()) {
            self.note_unit(quantity.unit.as_ref().map(|(_, unit)| unit));
        }
        let point = about.as_ref().and_then(|about| about.written(&mut self.builder.problems));
        let about = about.map(|about| about.place);
        let exchange = self.exchange_of(spot);
        let text = Rc::new(BodyText { mass, inertia, about, exchange, place: spot.place.of_key() });
        for member in &family.members {
            let name = member.name();
            let rules = Rules::position("a position").si(Dimension::LENGTH);
            let at = self.item(name.clone(), position.clone(), rules, Want::Vector, &member.locals);
            let about = point.as_ref().map(|point| {
                let name = format!("{name}'s point of inertia");
                self.item(name, Some(point.clone()), rules, Want::Vector, &member.locals)
            });
            let orientation = turns.is_some().then(|| {
                let name = if space { format!("{name}'s frame") } else { format!("{name}'s angle") };
                match &turned {
                    Some(turned) => self.turned(name, turned.clone(), from.clone().flatten(), &member.locals),
                    None => self.item(name, None, rules, Want::Scalar, &member.locals),
                }
            });
            let place = self.scope.bodies.len();
            if self.declare(Section::Body, member, Member::Body(place), &spot.place) {
                self.scope.bodies.push(BodyNames { name, position: at, orientation });
                bodies.push(DeclaredBody { text: Rc::clone(&text), about, locals: Rc::clone(&member.locals) });
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

/// Whether a node names an axis of a frame.
fn is_axis(node: &Node) -> bool {
    matches!(node, Node::Scalar(name) if matches!(name.as_str(), "x" | "y" | "z"))
}

/// A fixed turn, `{quaternion: [w, x, y, z]}`.
fn fixed(turn: &Spot<'_>, problems: &mut Vec<Problem>) -> Option<(Axis, Text)> {
    if !turn.only(&["quaternion"], "a fixed turn", problems) {
        return None;
    }
    let numbers = turn.need("quaternion", "a fixed turn", problems)?;
    let items = numbers.list(problems);
    let [w, x, y, z] = items.as_slice() else {
        if matches!(numbers.node, Node::List(_)) {
            problems.push(sections::list_length(numbers.place.clone(), &numbers.name, 4, items.len()));
        }
        return None;
    };
    let vector = [x.text(problems)?, y.text(problems)?, z.text(problems)?];
    Some((Axis::Quaternion(Box::new(vector)), w.text(problems)?))
}

/// The moments of inertia of a body in space: three principal ones, or the rows of a tensor.
fn moments(spot: &Spot<'_>, problems: &mut Vec<Problem>) -> Option<Vec<Quantity>> {
    let rows = spot.items().filter(|rows| rows.len() == 3);
    let Some(rows) = rows else {
        let mut problem = mechanics::not_moments(spot.place.clone(), describe(spot.node));
        if let Node::Scalar(text) = spot.node
            && text.trim_start().starts_with('[')
        {
            problem.help = format!("leave out the quotes: `{}`", text.trim());
        }
        problems.push(problem);
        return None;
    };
    let mut moments = Vec::new();
    for row in rows {
        match row.items() {
            None => moments.push(row.quantity(problems)?),
            Some(items) => {
                for item in items {
                    moments.push(item.quantity(problems)?);
                }
            }
        }
    }
    if !matches!(moments.len(), 3 | 9) {
        problems.push(mechanics::not_moments(spot.place.clone(), describe(spot.node)));
        return None;
    }
    Some(moments)
}

/// Two or three, whichever most vectors of the file have; three where a frame turns about axes.
pub fn dimension(root: &Node) -> usize {
    let mut votes = [0_usize; 2];
    let Node::Map(entries) = root else { return 2 };
    let frames = entries.iter().filter(|(key, _)| key == "frames").map(|(_, node)| node);
    let turned = |node: &Node| matches!(node, Node::Map(keys) if keys.iter().any(|(key, _)| key == "rotate"));
    if frames.into_iter().any(|node| matches!(node, Node::Map(frames) if frames.iter().any(|(_, frame)| turned(frame))))
    {
        return 3;
    }
    let mut stack: Vec<(&str, &Node)> = entries
        .iter()
        .filter(|(key, _)| {
            !matches!(
                key.as_str(),
                "parameters" | "tables" | "joints" | "phases" | "scene" | "scenes" | "sample" | "about" | "sizes"
            )
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
