//! `joints`: rows of constraints by the name of the joint that they make (LANGUAGE, section 6).
//!
//! What is read here; the rows are those of `joint_rows.rs`.

use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::file::{Node, Spot, Text, Written, describe};
use crate::language::AstKind;
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Lower;
use crate::model::expression::names::Solid;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Entry, Member, Section};
use crate::model::resolver::Resolver;

/// A kind of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The two points are one.
    Ball,
    /// And the two axes are parallel.
    Hinge,
    /// The two points are one, the two axes perpendicular.
    Universal,
    /// The axes are one line.
    Cylinder,
    /// And the sides do not turn about it.
    Slider,
    /// And what they turn moves them along it.
    Screw,
    /// The points stay in a plane across the axes, which are parallel.
    Plane,
    /// Nothing moves.
    Weld,
    /// Everything does: no row.
    Free,
}

/// The kinds, by the key that names them.
const KINDS: [(&str, Kind); 9] = [
    ("ball", Kind::Ball),
    ("hinge", Kind::Hinge),
    ("universal", Kind::Universal),
    ("cylinder", Kind::Cylinder),
    ("slider", Kind::Slider),
    ("screw", Kind::Screw),
    ("plane", Kind::Plane),
    ("weld", Kind::Weld),
    ("free", Kind::Free),
];

impl Kind {
    fn in_plane(self) -> bool {
        matches!(self, Kind::Hinge | Kind::Slider | Kind::Weld | Kind::Free)
    }

    /// Whether its axes are named; in the plane a hinge has but one.
    fn has_axes(self, dimension: usize) -> bool {
        match self {
            Kind::Ball | Kind::Weld | Kind::Free => false,
            Kind::Hinge => dimension == 3,
            _ => true,
        }
    }

    /// Whether rows are left where both sides meet in one point by the coordinates.
    fn may_have_one_point(self, dimension: usize) -> bool {
        match self {
            Kind::Hinge | Kind::Universal => dimension == 3,
            Kind::Weld => true,
            _ => false,
        }
    }
}

/// The points of a joint.
pub enum At {
    /// One on each side.
    Two([Written; 2]),
    /// One that both sides have by the coordinates.
    One(Written),
    /// None: a joint that is free.
    None,
}

/// The entry of a joint, read once for all members of a family.
pub struct JointText {
    /// What it is.
    pub kind: Kind,
    /// The bodies or frames that it joins.
    pub sides: [Text; 2],
    /// Its points.
    pub at: At,
    /// Its axis on each side.
    pub axes: Option<[Text; 2]>,
    /// Of a screw.
    pub pitch: Option<Text>,
}

/// What a joint holds, to be looked at when values are known: a point or direction and the side in which it rests.
#[derive(Clone, Debug)]
pub struct Fixed {
    /// The item.
    pub item: usize,
    /// Whether it is a direction.
    pub direction: bool,
    /// The side.
    pub side: Solid,
    /// Both as written, and where that stands.
    pub words: [String; 2],
    /// Where the item stands.
    pub place: Place,
}

impl Resolver<'_> {
    /// Declares the rows of all joints as constraints, and adds where they stand.
    pub fn declare_joints(&mut self, places: &mut Vec<Place>) {
        for (key, spot) in self.section("joints") {
            let family = self.expand(key, &spot);
            let base = key.split('[').next().unwrap_or(key).trim().to_owned();
            let read = self.joint(&spot);
            let reserved = family.is_some() && self.is_no_label(&base, &[], &spot);
            let indices = family.as_ref().map_or(0, |family| family.key.indices.len());
            let refused = family.is_none() || read.is_none() || reserved;
            let entry = Entry { refused, ..Entry::new(Section::Joint, indices) };
            let known = self.scope.constraint_names.entry(base.clone()).or_insert(entry);
            if known.section != Section::Joint {
                self.builder.problems.push(sections::duplicate_label(
                    spot.place.of_key(),
                    &base,
                    "`constraints` and `joints`",
                ));
                continue;
            }
            let (Some(family), Some(read), false) = (family, read, reserved) else { continue };
            for member in &family.members {
                let name = member.name();
                let place = self.scope.joints.len();
                let entry = self.scope.constraint_names.get_mut(&member.base);
                if !entry.is_some_and(|entry| entry.add(&member.indices, Member::Joint(place))) {
                    self.builder.problems.push(sections::duplicate_label(spot.place.of_key(), name, "`joints`"));
                    break;
                }
                let sides = self.joined(&read.sides, &member.locals);
                let before = self.scope.constraints.len();
                self.joint_rows(&read, sides, name, &member.locals);
                places.extend((before..self.scope.constraints.len()).map(|_| spot.place.of_key()));
            }
        }
    }

    /// An entry: `{hinge: [A, B], at: [P, Q], axis: [A.z, B.z]}`.
    fn joint(&mut self, spot: &Spot<'_>) -> Option<JointText> {
        let before = self.builder.problems.len();
        let problems = &mut self.builder.problems;
        let known: Vec<&str> = KINDS.iter().map(|(key, _)| *key).chain(["at", "axis", "pitch"]).collect();
        if !spot.only(&known, "a joint", problems) {
            return None;
        }
        let mut kinds = KINDS.into_iter().filter_map(|(key, kind)| Some((key, kind, spot.get(key)?)));
        let Some((key, kind, sides)) = kinds.next() else {
            if !spot.misspelt(problems) {
                let keys = KINDS.map(|(key, _)| format!("`{key}`")).join(", ");
                problems.push(sections::needs_one_of(spot.place.of_key(), keys, "a joint"));
            }
            return None;
        };
        if let Some((other, _, second)) = kinds.next() {
            problems.push(sections::conflicting_keys(second.place.of_key(), key, other, "a joint"));
        }
        let dimension = self.scope.dimension;
        if dimension == 2 && !kind.in_plane() {
            problems.push(mechanics::joint_of_space(sides.place.of_key(), key));
            return None;
        }
        let sides = self.two_texts(&sides, "[A, B]");
        let at = self.at(spot, key, kind);
        let axes =
            self.key_of(spot, "axis", key, kind.has_axes(dimension)).map(|axis| self.two_texts(&axis, "[A.z, B.z]"));
        let pitch = self.key_of(spot, "pitch", key, kind == Kind::Screw);
        let pitch = pitch.map(|pitch| pitch.text(&mut self.builder.problems));
        if self.builder.problems.len() > before {
            return None;
        }
        Some(JointText { kind, sides: sides?, at: at?, axes: axes.flatten(), pitch: pitch.flatten() })
    }

    /// A key that this kind of joint must have, or must not.
    fn key_of<'s>(&mut self, spot: &Spot<'s>, key: &str, kind: &str, wanted: bool) -> Option<Spot<'s>> {
        if wanted {
            return spot.need(key, &format!("a `{kind}`"), &mut self.builder.problems);
        }
        if let Some(found) = spot.get(key) {
            let place = found.place.of_key();
            self.builder.problems.push(sections::conflicting_keys(place, kind, key, "a joint"));
        }
        None
    }

    fn at(&mut self, spot: &Spot<'_>, key: &str, kind: Kind) -> Option<At> {
        let Some(at) = self.key_of(spot, "at", key, kind != Kind::Free) else {
            return (kind == Kind::Free).then_some(At::None);
        };
        let problems = &mut self.builder.problems;
        match at.items().as_deref() {
            Some([p, q]) => {
                let [p, q] = [p.written(problems), q.written(problems)];
                Some(At::Two([p?, q?]))
            }
            _ if kind.may_have_one_point(self.scope.dimension) => at.written(problems).map(At::One),
            _ => {
                problems.push(mechanics::joint_at_one_point(at.place.clone(), key));
                None
            }
        }
    }

    /// The two items of a list, one for each side.
    fn two_texts(&mut self, spot: &Spot<'_>, example: &str) -> Option<[Text; 2]> {
        let problems = &mut self.builder.problems;
        match spot.items().as_deref() {
            Some([first, second]) => {
                let [first, second] = [first.text(problems), second.text(problems)];
                Some([first?, second?])
            }
            found => {
                let found = match (found, spot.node) {
                    (Some([_]), _) => "a list of one".to_owned(),
                    (Some(items), _) => format!("a list of {}", items.len()),
                    (None, Node::Scalar(_)) => "one expression".to_owned(),
                    (None, node) => describe(node).to_owned(),
                };
                problems.push(mechanics::not_two(spot.place.clone(), &spot.name, found, example));
                None
            }
        }
    }

    /// The bodies or frames that a joint joins; none that is wrong (reported).
    fn joined(&mut self, texts: &[Text; 2], locals: &Locals) -> [Option<Solid>; 2] {
        let sides = [0, 1].map(|k| self.side(&texts[k], locals));
        if let [Some(first), Some(second)] = sides
            && first == second
        {
            let place = texts[1].place.at(texts[1].ast.span);
            self.builder.problems.push(mechanics::own_joint(place, &texts[1].source));
        }
        sides
    }

    fn side(&mut self, text: &Text, locals: &Locals) -> Option<Solid> {
        let rules = Rules::joint("a side of a joint");
        let mut lower = Lower::new(&mut self.builder, &self.scope, text, rules, locals);
        match &text.ast.kind {
            AstKind::Name { name, indices, primes: 0 } => lower.solid(name, indices, text.ast.span),
            _ => {
                let place = text.place.at(text.ast.span);
                lower.refuse(names::wrong_thing(place, &text.source, "a body or frame", "an expression"));
                None
            }
        }
    }
}

/// What is written, for messages.
pub fn words(written: &Written) -> String {
    match written {
        Written::One(text) => text.source.to_string(),
        Written::List(texts, _) => {
            let texts: Vec<&str> = texts.iter().map(|text| &*text.source).collect();
            format!("[{}]", texts.join(", "))
        }
    }
}

/// Where that stands.
pub fn place_of(written: &Written) -> Place {
    match written {
        Written::One(text) => text.place.at(text.ast.span),
        Written::List(_, place) => Place::clone(place),
    }
}
