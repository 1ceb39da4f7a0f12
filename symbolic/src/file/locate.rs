//! Where in the file's text a place is.

use std::ops::Range;

use super::spans::{Outline, Shape, Style, spans};
use crate::diagnose::{Place, Step};
use crate::language::Span;

/// The bytes of `text` that each of `places` means; the file is walked once.
///
/// What cannot be found (a key that is missing, say) is looked for as far as it exists.
pub fn locate(text: &str, places: &[&Place]) -> Vec<Range<usize>> {
    let in_file = |place: &Place| if place.path.is_empty() { place.span } else { None };
    let tree = if places.iter().all(|place| in_file(place).is_some()) { None } else { spans(text).0 };
    let found = |place: &&Place| match (in_file(place), &tree) {
        (Some(span), _) => span.range(),
        (None, Some(root)) => follow(text, root, place),
        (None, None) => 0..0,
    };
    places.iter().map(found).map(|range| within(text, range)).collect()
}

/// Down the path as far as it exists.
fn follow(text: &str, root: &Outline, place: &Place) -> Range<usize> {
    let mut node = root;
    let mut key: Option<&Outline> = None;
    for step in &place.path {
        let next = match (step, &node.shape) {
            (Step::Key(name), Shape::Map(entries)) => {
                entries.iter().find(|(key, _)| matches!(&key.shape, Shape::Scalar(text, _) if text == name))
            }
            (Step::Index(index), Shape::List(items)) => {
                let Some(item) = items.get(*index) else { return whole(text, node, key) };
                (node, key) = (item, None);
                continue;
            }
            _ => None,
        };
        let Some((name, value)) = next else { return whole(text, node, key) };
        (node, key) = (value, Some(name));
    }
    let target = match key {
        Some(key) if place.key => key,
        _ => node,
    };
    match (place.span, &target.shape) {
        (Some(span), Shape::Scalar(value, style)) => part(&text[target.range.clone()], value, *style, span)
            .map_or_else(
                || whole(text, target, key),
                |part| target.range.start + part.start..target.range.start + part.end,
            ),
        _ => whole(text, target, key),
    }
}

/// A scalar or what stands on one line; else its key, else its first line.
fn whole(text: &str, node: &Outline, key: Option<&Outline>) -> Range<usize> {
    let covered = text[node.range.clone()].trim_end();
    match key {
        Some(key) if covered.is_empty() || covered.contains('\n') => key.range.clone(),
        _ => node.range.start..node.range.start + covered.lines().next().map_or(0, str::len),
    }
}

/// The bytes of a scalar's source that give some bytes of its value; `None` where the two do not match.
fn part(source: &str, value: &str, style: Style, span: Span) -> Option<Range<usize>> {
    let quote = usize::from(style != Style::Bare);
    let mut at = if quote == 0 { block_start(source, value) } else { quote };
    let mut range = None;
    let mut end = at;
    for (byte, wanted) in value.char_indices().chain([(value.len(), '\0')]) {
        if byte >= span.start as usize && range.is_none() {
            let from = if byte < value.len() { skip_to(source, at, wanted, style) } else { at };
            range = Some(from);
        }
        if byte >= span.end as usize {
            let start = range?;
            return Some(start..end.max(start));
        }
        at = step(source, at, wanted, style)?;
        end = at;
    }
    range.map(|start| start..end.max(start))
}

/// After the header (`|`, `>-`) of a block scalar.
fn block_start(source: &str, value: &str) -> usize {
    let block = source.starts_with(['|', '>']) && !value.starts_with(['|', '>']);
    if block { source.find('\n').map_or(source.len(), |newline| newline + 1) } else { 0 }
}

/// Past white space that does not belong to the value.
fn skip_to(source: &str, at: usize, wanted: char, style: Style) -> usize {
    let mut at = at;
    while let Some(c) = source[at..].chars().next() {
        let continued =
            style == Style::Double && (source[at..].starts_with("\\\n") || source[at..].starts_with("\\\r\n"));
        if c == wanted || wanted == ' ' && c == '\n' || !(c.is_whitespace() || continued) {
            break;
        }
        at += c.len_utf8();
    }
    at
}

/// The position after the source of one character of the value.
fn step(source: &str, at: usize, wanted: char, style: Style) -> Option<usize> {
    let at = skip_to(source, at, wanted, style);
    let rest = &source[at..];
    let next = rest.chars().next();
    match style {
        Style::Single if wanted == '\'' => return rest.starts_with("''").then_some(at + 2),
        Style::Double if rest.starts_with('\\') => {
            let digits = match rest.chars().nth(1)? {
                'x' => 2,
                'u' => 4,
                'U' => 8,
                _ => 0,
            };
            let length = 1 + rest[1..].chars().next()?.len_utf8() + digits;
            return (length <= rest.len() && rest.is_char_boundary(length)).then_some(at + length);
        }
        _ => {}
    }
    let folded = wanted.is_whitespace() && next.is_some_and(char::is_whitespace);
    let matches = next == Some(wanted) || folded;
    next.filter(|_| matches).map(|c| at + c.len_utf8())
}

/// The range, moved to boundaries of characters inside the text.
fn within(text: &str, range: Range<usize>) -> Range<usize> {
    let floor = |at: usize| (0..=at.min(text.len())).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
    let start = floor(range.start);
    start..floor(range.end).max(start)
}
