//! `draw`: what to animate.

use std::rc::Rc;

use crate::diagnose::catalogue::{names, sections};
use crate::expr::{Id, Rational, Symbol};
use crate::file::{Spot, Text, Written};
use crate::language::{is_reserved, parse_bounds};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Local;
use crate::model::expression::rules::Rules;
use crate::model::expression::substitute::substitute;
use crate::model::resolved::{Shape, Solid, Vector};
use crate::model::resolver::Resolver;
use crate::model::section::solids;

/// Stretches into which a curve is divided.
const STRETCHES: i64 = 100;

/// Shapes in the plane and in space; those of space alone are in `solids.rs`.
const FLAT: [&str; 5] = ["line", "circle", "spring", "curve", "trace"];

/// Makes a family of a shape.
const EACH: &str = "each";

pub(super) const RULES: Rules = Rules::velocity("a drawing").numbers_fit();

impl Resolver<'_> {
    /// Every shape.
    pub fn draw(&mut self) {
        let Some(spot) = self.root.get("draw") else { return };
        for item in spot.list(&mut self.builder.problems) {
            let members = match item.get(EACH) {
                None => vec![Self::no_locals()],
                Some(each) => self.each(&each),
            };
            // What is wrong with one member is wrong with all.
            let before = self.builder.problems.len();
            for locals in members {
                if self.builder.problems.len() == before {
                    self.shape(&item, &locals);
                }
            }
        }
    }

    /// `each: i in 1..n, j in i+1..n`: what the indices stand for in every member.
    fn each(&mut self, spot: &Spot<'_>) -> Vec<Locals> {
        let Some(words) = spot.words(&mut self.builder.problems) else { return Vec::new() };
        let before = self.builder.problems.len();
        let family = self.expand(&format!("s[{words}]"), spot);
        // They stand where the ranges do, without the name that makes a key of them.
        for problem in &mut self.builder.problems[before..] {
            problem.place.key = false;
            if let Some(span) = &mut problem.place.span {
                (span.start, span.end) =
                    (span.start.saturating_sub(2), span.end.saturating_sub(2).min(words.len() as u32));
            }
        }
        let members: Vec<Locals> =
            family.into_iter().flat_map(|family| family.members).map(|member| member.locals).collect();
        let hides = |(name, _): &&(String, Local)| self.scope.names.contains_key(name);
        if let Some((name, _)) = members.first().and_then(|locals| locals.iter().find(hides)) {
            self.builder.problems.push(names::index_hides_name(spot.place.clone(), name));
            return Vec::new();
        }
        members
    }

    fn shape(&mut self, spot: &Spot<'_>, locals: &Locals) {
        let kinds: Vec<&str> = FLAT.into_iter().chain(solids::KINDS).collect();
        let found: Vec<&str> = kinds.iter().copied().filter(|kind| spot.get(kind).is_some()).collect();
        let problems = &mut self.builder.problems;
        let known: Vec<&str> = kinds.iter().copied().chain([EACH]).collect();
        if found.first() != Some(&"curve") && !spot.only(&known, "a shape", problems) {
            return;
        }
        let [kind] = found.as_slice() else {
            match found.as_slice() {
                [first, second, ..] => {
                    problems.push(sections::conflicting_keys(spot.place.clone(), first, second, "a shape"));
                }
                _ if spot.misspelt(problems) => {}
                _ => {
                    let kinds: Vec<String> = kinds.iter().map(|kind| format!("`{kind}`")).collect();
                    problems.push(sections::needs_one_of(spot.place.clone(), kinds.join(", "), "a shape"));
                }
            }
            return;
        };
        let Some(what) = spot.get(kind) else { return };
        match *kind {
            "line" => {
                let points = self.points(&what, locals);
                self.model.draw.push(Shape::Line(points.into_iter().map(|(_, point)| point).collect()));
            }
            "spring" => {
                let points = self.points(&what, locals);
                match <[(String, Vector); 2]>::try_from(points) {
                    Ok([(_, from), (_, to)]) => self.model.draw.push(Shape::Spring(from, to)),
                    Err(points) if self.builder.problems.is_empty() => {
                        self.builder.problems.push(sections::list_length(
                            what.place.clone(),
                            "spring",
                            2,
                            points.len(),
                        ));
                    }
                    Err(_) => {}
                }
            }
            "trace" => {
                let traces = self.points(&what, locals).into_iter().map(|(name, point)| Shape::Trace(name, point));
                self.model.draw.extend(traces);
            }
            "circle" => self.circle(&what, locals),
            "curve" => self.curve(spot, &what, locals),
            kind if self.scope.dimension == 2 => {
                self.builder.problems.push(solids::not_in_the_plane(&what, kind));
            }
            kind => self.solid(kind, &what, locals),
        }
    }

    /// The points of a list, or of one entry, families put in.
    fn points(&mut self, spot: &Spot<'_>, locals: &Locals) -> Vec<(String, Vector)> {
        let items = spot.items().unwrap_or_else(|| vec![spot.clone()]);
        let mut points = Vec::new();
        for item in items {
            if item.items().is_some() {
                // `[[0, 0], P]`: a list that is a vector.
                if let Some(written) = item.written(&mut self.builder.problems)
                    && let Some(point) = self.vector(&written, RULES, locals)
                {
                    points.push((String::new(), point));
                }
                continue;
            }
            for text in self.listed(&item, locals) {
                let name = text.source.to_string();
                if let Some(point) = self.vector(&Written::One(text), RULES, locals) {
                    points.push((name, point));
                }
            }
        }
        points
    }

    fn circle(&mut self, spot: &Spot<'_>, locals: &Locals) {
        if let Some(axis) = spot.get("axis") {
            match self.scope.dimension {
                2 => self.builder.problems.push(solids::not_in_the_plane(&axis, "axis")),
                _ => {
                    let ring = self.round(spot, Solid::Ring, locals);
                    self.model.draw.extend(ring);
                }
            }
            return;
        }
        let problems = &mut self.builder.problems;
        let known: &[&str] = if self.scope.dimension == 2 { &["at", "radius"] } else { &["at", "axis", "radius"] };
        if !spot.only(known, "a circle", problems) {
            return;
        }
        let radius = spot.need("radius", "a circle", problems).and_then(|radius| radius.quantity(problems));
        let Some(at) = spot.need("at", "a circle", &mut self.builder.problems) else { return };
        let vector = matches!(at.items(), Some(items) if items.iter().all(|item| item.items().is_none()));
        let centres = match (vector, at.written(&mut Vec::new())) {
            (true, Some(written)) => self.vector(&written, RULES, locals).into_iter().collect(),
            _ => self.points(&at, locals).into_iter().map(|(_, point)| point).collect::<Vec<_>>(),
        };
        let radius = radius.and_then(|radius| self.setting(&radius, RULES.si(Dimension::LENGTH), locals));
        let Some(radius) = radius else { return };
        self.model.draw.extend(centres.into_iter().map(|at| Shape::Circle { at, radius }));
    }

    /// `{curve: "[s, c*s^2]", s: -2..2}`: sampled at equal steps of its parameter.
    fn curve(&mut self, spot: &Spot<'_>, what: &Spot<'_>, locals: &Locals) {
        let Some(written) = what.written(&mut self.builder.problems) else { return };
        let entries = spot.entries(&mut self.builder.problems);
        let others: Vec<_> = entries.into_iter().filter(|(key, _)| *key != "curve" && *key != EACH).collect();
        let [(name, range)] = others.as_slice() else {
            let problem = sections::missing_key(what.place.of_key(), "s: a..b", "a curve");
            self.builder.problems.push(problem);
            return;
        };
        if self.scope.names.contains_key(*name) || is_reserved(name) {
            self.builder.problems.push(names::index_hides_name(range.place.of_key(), name));
            return;
        }
        let Some(([from, to], measure)) = self.range(range, locals) else { return };
        let symbol = Symbol::Dummy(0);
        let dummy = ((*name).to_owned(), Local::Symbol(symbol, measure));
        let locals: Vec<_> = locals.iter().cloned().chain([dummy]).collect();
        let Some(curve) = self.builder.vector(&self.scope, &written, RULES, &locals) else { return };
        let points = (0..=STRETCHES).map(|k| self.on_curve(&curve, symbol, from, to, k, what)).collect();
        self.model.draw.push(Shape::Curve(points));
    }

    fn on_curve(&mut self, curve: &[Id], symbol: Symbol, from: Id, to: Id, k: i64, what: &Spot<'_>) -> Vector {
        let builder = &mut self.builder;
        let share =
            builder.graph.rational(Rational::new(i128::from(k), i128::from(STRETCHES)).unwrap_or(Rational::ONE));
        let width = builder.graph.sub(to, from);
        let offset = builder.graph.mul(share, width);
        let at = builder.graph.add(from, offset);
        let mut point = Vec::new();
        for component in curve {
            let (value, visited) = substitute(&mut builder.graph, &mut builder.facts, *component, symbol, at);
            builder.spend(visited, &what.place);
            point.push(value);
        }
        point
    }

    /// `-2..2`.
    fn range(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<([Id; 2], Measure)> {
        let words = spot.words(&mut self.builder.problems)?;
        let (from, to) = match parse_bounds(words) {
            Ok(bounds) => bounds,
            Err(found) => {
                self.builder.problems.extend(found.into_iter().map(|problem| problem.moved_to(&spot.place)));
                return None;
            }
        };
        let (mut ends, mut measure) = ([Id::ZERO; 2], Measure::Unknown);
        for (end, ast) in ends.iter_mut().zip([from, to]) {
            let text = Text { source: words.into(), ast: Rc::new(ast), unit: None, place: Rc::new(spot.place.clone()) };
            *end = self.scalar(&text, RULES, locals)?;
            // A bare number is in the unit of what is drawn.
            if self.builder.measured != Measure::ONE {
                measure = self.builder.measured;
            }
        }
        Some((ends, measure))
    }
}
