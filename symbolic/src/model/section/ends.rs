//! Where loads act: ends of springs, bodies and points of forces.

use super::loads::{AttachedTo, Drafts, Wanted};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::expr::Id;
use crate::file::{Node, Spot, Text, Written};
use crate::language::AstKind;
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Lower;
use crate::model::expression::names::Solid;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Section;
use crate::model::expression::value::Value;
use crate::model::resolver::Resolver;

/// A point on the material of something.
#[derive(Clone, Debug)]
pub struct End {
    /// Whose material.
    pub attached: AttachedTo,
    /// The point.
    pub at: Vec<Id>,
}

/// What an end looks like in the file.
#[derive(Clone, Debug)]
pub enum EndText {
    /// A point or body.
    One(Written),
    /// `{on: B, at: P}`.
    On(Text, Option<Written>),
}

const POSITION: Rules = Rules::position("a position").si(Dimension::LENGTH);

impl Resolver<'_> {
    /// Both ends of `between`, as texts.
    pub fn between(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<[EndText; 2]> {
        let mut ends = Vec::new();
        for item in spot.items().unwrap_or_else(|| vec![spot.clone()]) {
            let problems = &mut self.builder.problems;
            match item.node {
                Node::Map(_) => {
                    item.only(&["on", "at"], "an end", problems);
                    let on = item.need("on", "an end", problems)?.text(problems)?;
                    let at = match item.get("at") {
                        Some(at) => Some(at.written(problems)?),
                        None => None,
                    };
                    ends.push(EndText::On(on, at));
                }
                Node::List(_) => ends.push(EndText::One(item.written(problems)?)),
                _ => ends.extend(self.listed(&item, locals).into_iter().map(|text| EndText::One(Written::One(text)))),
            }
        }
        let found = ends.len();
        match <[EndText; 2]>::try_from(ends) {
            Ok(ends) => Some(ends),
            Err(_) => {
                if self.builder.problems.is_empty() || spot.items().is_none_or(|items| items.len() != 2) {
                    self.builder.problems.push(sections::list_length(spot.place.clone(), "between", 2, found));
                }
                None
            }
        }
    }

    /// An end with its body, or a note to find it.
    pub fn end(&mut self, text: &EndText, locals: &Locals, drafts: &mut Drafts) -> Option<End> {
        match text {
            EndText::On(on, at) => self.placed(on, at.as_ref(), locals, drafts),
            EndText::One(written) => self.point_or_body(written, locals, drafts),
        }
    }

    /// A body's centre of mass, the ground, or a point with whatever carries it.
    pub fn point_or_body(&mut self, written: &Written, locals: &Locals, drafts: &mut Drafts) -> Option<End> {
        if let Written::One(text) = written
            && self.is_solid(text)
        {
            return self.placed(text, None, locals, drafts);
        }
        let at = self.vector(written, POSITION, locals)?;
        let words = match written {
            Written::One(text) => text.source.to_string(),
            Written::List(..) => "…".to_owned(),
        };
        let attached = self.attached(&at, &words, Place::clone(written.place()), drafts);
        Some(End { attached, at })
    }

    /// Point `at` (absent: the centre of mass) of the body `on`.
    pub fn placed(&mut self, on: &Text, at: Option<&Written>, locals: &Locals, drafts: &mut Drafts) -> Option<End> {
        let solid = self.body(on, locals);
        let point = match at {
            Some(at) => Some(self.vector(at, POSITION, locals)?),
            None => None,
        };
        match solid? {
            None => Some(End {
                attached: AttachedTo::Ground,
                at: point.unwrap_or_else(|| vec![Id::ZERO; self.scope.dimension]),
            }),
            Some(body) => match (point, at) {
                (Some(point), Some(at)) => self.own_point(body, point, at, drafts),
                _ => Some(End { attached: AttachedTo::Body(body), at: self.centre(body)? }),
            },
        }
    }

    /// A point of a body's material; for a particle, which has only one, a note to see whether it is that.
    pub fn own_point(&mut self, body: usize, point: Vec<Id>, at: &Written, drafts: &mut Drafts) -> Option<End> {
        let centre = self.centre(body)?;
        let attached = AttachedTo::Body(body);
        if self.scope.bodies[body].orientation.is_some() || point == centre {
            return Some(End { attached, at: point });
        }
        let place = Place::clone(at.place());
        drafts.wanted.push(Wanted { point, words: String::new(), place, particle: Some(body) });
        Some(End { attached, at: centre })
    }

    /// The opposite of a force: on a rigid body at the same point, on a particle at itself.
    pub fn opposite(&mut self, from: &Text, at: &[Id], locals: &Locals) -> Option<End> {
        match self.body(from, locals)? {
            None => Some(End { attached: AttachedTo::Ground, at: at.to_vec() }),
            Some(body) => {
                let rigid = self.scope.bodies[body].orientation.is_some();
                let at = if rigid { at.to_vec() } else { self.centre(body)? };
                Some(End { attached: AttachedTo::Body(body), at })
            }
        }
    }

    /// The body that a text names; inside, `None` is the ground.  Outside, `None`: it names none (reported).
    pub fn body(&mut self, text: &Text, locals: &Locals) -> Option<Option<usize>> {
        let mut lower = Lower::new(&mut self.builder, &self.scope, text, POSITION, locals);
        let AstKind::Name { name, indices, primes: 0 } = &text.ast.kind else {
            let place = text.place.at(text.ast.span);
            lower.refuse(names::wrong_thing(place, &text.source, "a body", "an expression"));
            return None;
        };
        match lower.solid(name, indices, text.ast.span)? {
            Solid::Ground => Some(None),
            Solid::Body(body) => Some(Some(body)),
            Solid::Frame(_) => {
                let place = text.place.at(text.ast.span);
                lower.refuse(names::wrong_thing(place, name, "a body", "a frame"));
                None
            }
        }
    }

    /// As [`Resolver::body`], and the body must have an orientation.
    pub fn rigid_body(&mut self, text: &Text, context: &str, locals: &Locals) -> Option<Option<usize>> {
        let body = self.body(text, locals)?;
        if let Some(body) = body
            && self.scope.bodies[body].orientation.is_none()
        {
            let name = &self.scope.bodies[body].name;
            let place = text.place.at(text.ast.span);
            self.builder.problems.push(mechanics::needs_orientation(place, name, context));
            return None;
        }
        Some(body)
    }

    /// Whether a text is the name of a body or of the ground.
    pub fn is_solid(&self, text: &Text) -> bool {
        match &text.ast.kind {
            AstKind::Name { name, primes: 0, .. } => {
                name == "ground" || self.scope.names.get(name).is_some_and(|entry| entry.section == Section::Body)
            }
            _ => false,
        }
    }

    /// A body's centre of mass.
    pub fn centre(&self, body: usize) -> Option<Vec<Id>> {
        match self.scope.value(self.scope.bodies[body].position) {
            Some(Value::Vector(position)) => Some(position.clone()),
            _ => None,
        }
    }
}
