//! Lists of names, in which `"tip[i in 0..n]"` stands for its members.

use std::rc::Rc;

use super::families::{Locals, as_range};
use super::index::{self, Indices};
use super::scope::expanded;
use crate::diagnose::catalogue::names;
use crate::file::{Spot, Text};
use crate::language::{Ast, AstKind, KeyIndex, Range, Span, parse_key};
use crate::model::resolver::Resolver;

impl Resolver<'_> {
    /// The expressions that one entry of a list stands for: itself, or the members of a family.
    pub fn listed(&mut self, spot: &Spot<'_>, locals: &Locals) -> Vec<Text> {
        let problems = &mut self.builder.problems;
        let Some(words) = spot.words(problems) else { return Vec::new() };
        let family = parse_key(words)
            .ok()
            .filter(|key| key.primes == 0 && key.indices.iter().any(|index| matches!(index, KeyIndex::Range(_))));
        let Some(key) = family else { return spot.text(problems).into_iter().collect() };
        let ranges: Vec<Range> = key.indices.iter().map(as_range).collect();
        for range in &ranges {
            let hides =
                self.scope.names.contains_key(&range.name) || locals.iter().any(|(name, _)| *name == range.name);
            if hides {
                problems.push(names::index_hides_name(spot.place.at(range.name_span), &range.name));
                return Vec::new();
            }
        }
        let at = Indices { scope: &self.scope, source: words, place: &spot.place };
        let mut known = locals.to_vec();
        let rows = match index::members(&at, &mut self.builder, &mut known, &ranges) {
            Ok(rows) => rows,
            Err(refusal) => {
                self.builder.told(refusal);
                return Vec::new();
            }
        };
        let place = Rc::new(spot.place.clone());
        let span = Span::new(0, words.len());
        let member = |row: Vec<i64>| {
            let source = expanded(&key.name, &row);
            let indices = row.into_iter().map(|value| number(value, span)).collect();
            let kind = AstKind::Name { name: key.name.clone(), indices, primes: 0 };
            Text { source: source.into(), ast: Rc::new(Ast { kind, span }), unit: None, place: Rc::clone(&place) }
        };
        rows.into_iter().map(member).collect()
    }
}

fn number(value: i64, span: Span) -> Ast {
    let digits = Ast { kind: AstKind::Number(value.unsigned_abs().to_string()), span };
    if value < 0 { Ast { kind: AstKind::Negate(Box::new(digits)), span } } else { digits }
}
