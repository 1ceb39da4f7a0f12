//! Expressions that YAML took apart because they were not quoted.

use super::node::Node;
use crate::diagnose::{Place, Problem, catalogue::yaml};

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
                look(value, &place.key(key), problems);
            }
        }
    }
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
