//! Lists of names, in which `"tip[i in 0..n]"` stands for its members.

use std::rc::Rc;

use super::families::{Locals, as_range};
use super::index::{self, Indices};
use super::scope::{Member, expanded};
use crate::diagnose::catalogue::names;
use crate::file::{Spot, Text};
use crate::language::{Ast, AstKind, Key, KeyIndex, Range, Span, parse_key};
use crate::model::resolver::Resolver;

/// What an entry of a list is.
enum Entry {
    /// One expression.
    One,
    /// A family, and the indices of its members.
    Family(Key, Vec<Vec<i64>>),
    /// A family that is wrong (reported).
    Refused,
}

impl Resolver<'_> {
    /// The expressions that one entry of a list stands for: itself, or the members of a family.
    pub fn listed(&mut self, spot: &Spot<'_>, locals: &Locals) -> Vec<Text> {
        let Some(words) = spot.words(&mut self.builder.problems) else { return Vec::new() };
        let (key, rows) = match self.entry(words, spot, locals) {
            Entry::One => return spot.text(&mut self.builder.problems).into_iter().collect(),
            Entry::Refused => return Vec::new(),
            Entry::Family(key, rows) => (key, rows),
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

    /// The bodies of an entry that is a family of bodies; `None` for any other, and where something is wrong, which [`Resolver::listed`] tells.
    pub fn bodies_of_family(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Vec<usize>> {
        let told = self.builder.problems.len();
        let words = spot.words(&mut self.builder.problems)?;
        let entry = self.entry(words, spot, locals);
        self.builder.problems.truncate(told);
        let Entry::Family(key, rows) = entry else { return None };
        let family = self.scope.names.get(&key.name)?;
        let body = |row: &Vec<i64>| match family.members.get(row) {
            Some(Member::Body(body)) => Some(*body),
            _ => None,
        };
        rows.iter().map(body).collect()
    }

    fn entry(&mut self, words: &str, spot: &Spot<'_>, locals: &Locals) -> Entry {
        let family = parse_key(words)
            .ok()
            .filter(|key| key.primes == 0 && key.indices.iter().any(|index| matches!(index, KeyIndex::Range(_))));
        let Some(key) = family else { return Entry::One };
        let ranges: Vec<Range> = key.indices.iter().map(as_range).collect();
        for range in &ranges {
            let hides =
                self.scope.names.contains_key(&range.name) || locals.iter().any(|(name, _)| *name == range.name);
            if hides {
                let problem = names::index_hides_name(spot.place.at(range.name_span), &range.name);
                self.builder.problems.push(problem);
                return Entry::Refused;
            }
        }
        let at = Indices { scope: &self.scope, source: words, place: &spot.place };
        match index::members(&at, &mut self.builder, &mut locals.to_vec(), &ranges) {
            Ok(rows) => Entry::Family(key, rows),
            Err(refusal) => {
                self.builder.told(refusal);
                Entry::Refused
            }
        }
    }
}

fn number(value: i64, span: Span) -> Ast {
    let digits = Ast { kind: AstKind::Number(value.unsigned_abs().to_string()), span };
    if value < 0 { Ast { kind: AstKind::Negate(Box::new(digits)), span } } else { digits }
}
