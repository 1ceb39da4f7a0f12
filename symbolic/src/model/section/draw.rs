//! `draw`: what to animate.

use std::rc::Rc;

use crate::diagnose::catalogue::{names, sections};
use crate::expr::{Id, Rational, Symbol};
use crate::file::{Spot, Text, Written};
use crate::language::{is_reserved, parse_bounds};
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::lower::Local;
use crate::model::expression::rules::Rules;
use crate::model::expression::substitute::substitute;
use crate::model::resolved::{Shape, Vector};
use crate::model::resolver::Resolver;

/// Stretches into which a curve is divided.
const STRETCHES: i64 = 100;

const RULES: Rules = Rules::velocity("a drawing").numbers_fit();

impl Resolver<'_> {
    /// Every shape.
    pub fn draw(&mut self) {
        let Some(spot) = self.root.get("draw") else { return };
        for item in spot.list(&mut self.bench.problems) {
            self.shape(&item);
        }
    }

    fn shape(&mut self, spot: &Spot<'_>) {
        let kinds = ["line", "circle", "spring", "curve", "trace"];
        let found: Vec<&str> = kinds.into_iter().filter(|kind| spot.get(kind).is_some()).collect();
        let problems = &mut self.bench.problems;
        if found.first() != Some(&"curve") && !spot.only(&kinds, "a shape", problems) {
            return;
        }
        let [kind] = found.as_slice() else {
            match found.as_slice() {
                [first, second, ..] => {
                    problems.push(sections::conflicting_keys(spot.place.clone(), first, second, "a shape"));
                }
                _ if spot.misspelt(problems) => {}
                _ => {
                    let kinds = kinds.map(|kind| format!("`{kind}`")).join(", ");
                    problems.push(sections::needs_one_of(spot.place.clone(), kinds, "a shape"));
                }
            }
            return;
        };
        let Some(what) = spot.get(kind) else { return };
        match *kind {
            "line" => {
                let points = self.points(&what);
                self.model.draw.push(Shape::Line(points.into_iter().map(|(_, point)| point).collect()));
            }
            "spring" => {
                let points = self.points(&what);
                match <[(String, Vector); 2]>::try_from(points) {
                    Ok([(_, from), (_, to)]) => self.model.draw.push(Shape::Spring(from, to)),
                    Err(points) if self.bench.problems.is_empty() => {
                        self.bench.problems.push(sections::list_length(what.place.clone(), "spring", 2, points.len()));
                    }
                    Err(_) => {}
                }
            }
            "trace" => {
                let traces = self.points(&what).into_iter().map(|(name, point)| Shape::Trace(name, point));
                self.model.draw.extend(traces);
            }
            "circle" => self.circle(&what),
            _ => self.curve(spot, &what),
        }
    }

    /// The points of a list, or of one entry, families put in.
    fn points(&mut self, spot: &Spot<'_>) -> Vec<(String, Vector)> {
        let no_locals = Self::no_locals();
        let items = spot.items().unwrap_or_else(|| vec![spot.clone()]);
        let mut points = Vec::new();
        for item in items {
            if item.items().is_some() {
                // `[[0, 0], P]`: a list that is a vector.
                if let Some(written) = item.written(&mut self.bench.problems)
                    && let Some(point) = self.vector(&written, RULES, &no_locals)
                {
                    points.push((String::new(), point));
                }
                continue;
            }
            for text in self.listed(&item, &no_locals) {
                let name = text.source.to_string();
                if let Some(point) = self.vector(&Written::One(text), RULES, &no_locals) {
                    points.push((name, point));
                }
            }
        }
        points
    }

    fn circle(&mut self, spot: &Spot<'_>) {
        let problems = &mut self.bench.problems;
        if !spot.only(&["at", "radius"], "a circle", problems) {
            return;
        }
        let radius = spot.need("radius", "a circle", problems).and_then(|radius| radius.quantity(problems));
        let Some(at) = spot.need("at", "a circle", &mut self.bench.problems) else { return };
        let vector = matches!(at.items(), Some(items) if items.iter().all(|item| item.items().is_none()));
        let centres = match (vector, at.written(&mut Vec::new())) {
            (true, Some(written)) => self.vector(&written, RULES, &Self::no_locals()).into_iter().collect(),
            _ => self.points(&at).into_iter().map(|(_, point)| point).collect::<Vec<_>>(),
        };
        let radius = radius.and_then(|radius| self.setting(&radius, RULES.si(Dimension::LENGTH), &Self::no_locals()));
        let Some(radius) = radius else { return };
        self.model.draw.extend(centres.into_iter().map(|at| Shape::Circle { at, radius }));
    }

    /// `{curve: "[s, c*s^2]", s: -2..2}`: sampled at equal steps of its parameter.
    fn curve(&mut self, spot: &Spot<'_>, what: &Spot<'_>) {
        let Some(written) = what.written(&mut self.bench.problems) else { return };
        let entries = spot.entries(&mut self.bench.problems);
        let others: Vec<_> = entries.into_iter().filter(|(key, _)| *key != "curve").collect();
        let [(name, range)] = others.as_slice() else {
            let problem = sections::missing_key(what.place.of_key(), "s: a..b", "a curve");
            self.bench.problems.push(problem);
            return;
        };
        if self.scope.names.contains_key(*name) || is_reserved(name) {
            self.bench.problems.push(names::index_hides_name(range.place.of_key(), name));
            return;
        }
        let Some(([from, to], measure)) = self.range(range) else { return };
        let symbol = Symbol::Dummy(0);
        let locals = vec![((*name).to_owned(), Local::Symbol(symbol, measure))];
        let Some(curve) = self.bench.vector(&self.scope, &written, RULES, &locals) else { return };
        let points = (0..=STRETCHES).map(|k| self.on_curve(&curve, symbol, from, to, k, what)).collect();
        self.model.draw.push(Shape::Curve(points));
    }

    fn on_curve(&mut self, curve: &[Id], symbol: Symbol, from: Id, to: Id, k: i64, what: &Spot<'_>) -> Vector {
        let bench = &mut self.bench;
        let share = bench.graph.rational(Rational::new(i128::from(k), i128::from(STRETCHES)).unwrap_or(Rational::ONE));
        let width = bench.graph.sub(to, from);
        let offset = bench.graph.mul(share, width);
        let at = bench.graph.add(from, offset);
        let mut point = Vec::new();
        for component in curve {
            let (value, visited) = substitute(&mut bench.graph, &mut bench.facts, *component, symbol, at);
            bench.spend(visited, &what.place);
            point.push(value);
        }
        point
    }

    /// `-2..2`.
    fn range(&mut self, spot: &Spot<'_>) -> Option<([Id; 2], Measure)> {
        let words = spot.words(&mut self.bench.problems)?;
        let (from, to) = match parse_bounds(words) {
            Ok(bounds) => bounds,
            Err(found) => {
                self.bench.problems.extend(found.into_iter().map(|problem| problem.moved_to(&spot.place)));
                return None;
            }
        };
        let (mut ends, mut measure) = ([Id::ZERO; 2], Measure::Unknown);
        for (end, ast) in ends.iter_mut().zip([from, to]) {
            let text = Text { source: words.into(), ast: Rc::new(ast), unit: None, place: Rc::new(spot.place.clone()) };
            *end = self.scalar(&text, RULES, &Self::no_locals())?;
            // A bare number is in the unit of what is drawn.
            if self.bench.measured != Measure::ONE {
                measure = self.bench.measured;
            }
        }
        Some((ends, measure))
    }
}
