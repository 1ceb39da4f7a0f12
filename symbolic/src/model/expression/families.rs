//! Keys: names, families and their members.

use std::rc::Rc;

use super::builder::ExprBuilder;
use super::index::{self, Indices, MEMBER_LIMIT};
use super::lower::Local;
use super::scope::{Scope, expanded};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{names, syntax};
use crate::language::{Key, KeyIndex, Range, Span, is_reserved, parse_key};

/// Indices and bound variables by name.
pub type Locals = Rc<Vec<(String, Local)>>;

/// One member of a key.
#[derive(Clone, Debug)]
pub struct Expanded {
    /// The family's name.
    pub base: String,
    /// Its indices.
    pub indices: Vec<i64>,
    /// What the names of its indices stand for.
    pub locals: Locals,
}

impl Expanded {
    /// `x[2]`.
    pub fn name(&self) -> String {
        expanded(&self.base, &self.indices)
    }
}

/// All members of a key.
#[derive(Clone, Debug)]
pub struct Family {
    /// The key.
    pub key: Key,
    /// True when it has a range.
    pub ranged: bool,
    /// Its members, the last index running fastest.
    pub members: Vec<Expanded>,
}

/// Indices of keys, to be compared with all names once these are known.
pub type IndexNames = Vec<(String, Place)>;

/// Reads a key and expands it; `place` is where the key stands.  `None` when it is wrong (reported).
pub fn expand(
    builder: &mut ExprBuilder,
    scope: &Scope,
    indices: &mut IndexNames,
    words: &str,
    place: &Place,
) -> Option<Family> {
    expand_inside(builder, scope, indices, (words, place), &Rc::default())
}

/// As [`expand`], inside an entry whose indices it may name.
pub fn expand_inside(
    builder: &mut ExprBuilder,
    scope: &Scope,
    indices: &mut IndexNames,
    (words, place): (&str, &Place),
    outer: &Locals,
) -> Option<Family> {
    let key = match parse_key(words) {
        Ok(key) => key,
        Err(found) => {
            builder.problems.extend(found.into_iter().map(|problem| problem.moved_to(place)));
            return None;
        }
    };
    let mut seen: Vec<&str> = Vec::new();
    for index in &key.indices {
        let KeyIndex::Range(range) = index else { continue };
        let at = place.at(range.name_span);
        if is_reserved(&range.name) || seen.contains(&range.name.as_str()) {
            builder.problems.push(names::index_hides_name(at, &range.name));
            return None;
        }
        seen.push(&range.name);
        indices.push((range.name.clone(), at));
    }
    let ranges: Vec<Range> = key.indices.iter().map(as_range).collect();
    let at = Indices { scope, source: words, place };
    let rows = match index::members(&at, builder, &mut outer.to_vec(), &ranges) {
        Ok(rows) => rows,
        Err(refusal) => {
            builder.told(refusal);
            return None;
        }
    };
    if rows.len() > MEMBER_LIMIT {
        builder.problems.push(names::too_many_names(place.clone(), MEMBER_LIMIT));
        return None;
    }
    let ranged = key.indices.iter().any(|index| matches!(index, KeyIndex::Range(_)));
    let member = |row: Vec<i64>| {
        let named = ranges.iter().zip(&row).filter(|(range, _)| !range.name.is_empty());
        let own = named.map(|(range, value)| (range.name.clone(), Local::Integer(*value)));
        let locals = outer.iter().cloned().chain(own).collect();
        Expanded { base: key.name.clone(), indices: row, locals: Rc::new(locals) }
    };
    let members = rows.into_iter().map(member).collect();
    Some(Family { key, ranged, members })
}

/// As [`expand`], and the key must not have primes.
pub fn expand_name(
    builder: &mut ExprBuilder,
    scope: &Scope,
    indices: &mut IndexNames,
    words: &str,
    place: &Place,
) -> Option<Family> {
    let family = expand(builder, scope, indices, words, place)?;
    if family.key.primes > 0 {
        builder.problems.push(syntax::bad_key(place.at(Span::new(0, words.len())), words));
        return None;
    }
    Some(family)
}

/// A fixed index is a range of one value without a name.
pub fn as_range(index: &KeyIndex) -> Range {
    match index {
        KeyIndex::Range(range) => range.clone(),
        KeyIndex::Fixed(ast) => Range { name: String::new(), name_span: ast.span, from: ast.clone(), to: ast.clone() },
    }
}
