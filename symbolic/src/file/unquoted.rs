//! Expressions that YAML took apart because they were not quoted.

use super::node::Node;
use crate::diagnose::catalogue::{syntax, yaml};
use crate::diagnose::{Place, Problem};
use crate::language::shorten;

/// Keys and items of lists with half of a bracket: `{force: dot(a, b)}` is `force: dot(a` and `b)`.
pub(super) fn unquoted(root: &Node) -> Vec<Problem> {
    let mut problems = Vec::new();
    look(root, &Place::default(), &mut problems);
    problems
}

fn look(node: &Node, place: &Place, problems: &mut Vec<Problem>) {
    match node {
        Node::Null | Node::Scalar(_) => {}
        Node::List(items) => {
            let broken = |item: &Node| matches!(item, Node::Scalar(text) if balance(text) != 0);
            let place_of_first = items.iter().position(broken).filter(|_| items.len() > 1);
            if let Some(first) = place_of_first {
                let texts = items[first..].iter().map_while(scalar);
                problems.push(yaml::unquoted(place.index(first), help(texts)));
                return;
            }
            for (index, item) in items.iter().enumerate() {
                look(item, &place.index(index), problems);
            }
        }
        Node::Map(entries) => {
            for (at, (key, value)) in entries.iter().enumerate() {
                if balance(key) != 0 {
                    problems.push(half_key(place, &entries[..at], &entries[at..], key));
                    return;
                }
                if *value == Node::Null {
                    let before = at.checked_sub(1).map(|at| &entries[at]);
                    if let Some(problem) = one_text(place, before, key) {
                        problems.push(problem);
                        continue;
                    }
                }
                look(value, &place.key(key), problems);
            }
        }
    }
}

/// A key without a value that is a key with its value, `l:8 m`, or what a decimal comma cuts off, `l: 8,5 m`.
fn one_text(place: &Place, before: Option<&(String, Node)>, key: &str) -> Option<Problem> {
    if let Some((_, meant)) = pair(key) {
        return Some(yaml::no_pair(place.key(key).of_key(), shorten(key), shorten(&meant)));
    }
    let is_digits = |text: &str| text.parse::<i64>().is_ok();
    match before {
        Some((name, Node::Scalar(whole))) if is_digits(whole) && key.starts_with(|c: char| c.is_ascii_digit()) => {
            Some(syntax::decimal_comma(place.key(name), format!("{whole}.{key}")))
        }
        _ => None,
    }
}

/// How many bytes the key of `key:value` or `key = value` takes with what follows it, and both as they are meant.
pub(super) fn pair(text: &str) -> Option<(usize, String)> {
    let is_key = |c: char| c.is_alphanumeric() || "_'[]".contains(c);
    let (key, rest) = text.split_at(text.find(|c| !is_key(c))?);
    let blanks = rest.len() - rest.trim_start().len();
    let value =
        rest[blanks..].strip_prefix('=').or_else(|| rest.strip_prefix(':').filter(|value| !value.starts_with(' ')));
    let value = value.map(str::trim).filter(|value| !value.is_empty() && !key.is_empty())?;
    Some((key.len() + blanks + 1, format!("{key}: {value}")))
}

/// A key with half of a bracket.  The other half is mostly the value before it, or before keys without values:
/// `{f: max(a, b, c)}` is `f: max(a`, `b` and `c)`.
fn half_key(place: &Place, before: &[(String, Node)], from: &[(String, Node)], key: &str) -> Problem {
    let start = before.iter().rposition(|(_, value)| *value != Node::Null);
    match start.map(|at| (&before[at], &before[at + 1..])) {
        Some(((name, Node::Scalar(text)), between)) if balance(text) > 0 => {
            let keys = between.iter().chain(from).map(|(key, _)| key.as_str());
            yaml::unquoted(place.key(name), help(std::iter::once(text.as_str()).chain(keys)))
        }
        _ => yaml::unquoted(place.key(key).of_key(), HELP),
    }
}

const HELP: &str = "put the expression in double quotes";

/// With the expression put together again from as many pieces as close its brackets.
fn help<'a>(pieces: impl Iterator<Item = &'a str>) -> String {
    let mut whole = String::new();
    for piece in pieces.take(8) {
        whole += if whole.is_empty() { "" } else { ", " };
        whole += piece;
        if balance(&whole) == 0 && whole.len() < 80 && !whole.contains('"') {
            return format!("{HELP}: `\"{whole}\"`");
        }
    }
    HELP.to_owned()
}

fn scalar(node: &Node) -> Option<&str> {
    match node {
        Node::Scalar(text) => Some(text),
        _ => None,
    }
}

/// Opening less closing brackets.
fn balance(text: &str) -> i32 {
    text.chars().fold(0, |balance, c| match c {
        '(' | '[' | '{' => balance + 1,
        ')' | ']' | '}' => balance - 1,
        _ => balance,
    })
}
