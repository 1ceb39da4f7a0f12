//! Expressions that YAML took apart because they were not quoted.

use super::Node;
use crate::diagnose::{Place, Problem, catalogue::yaml};

/// Keys and items of lists with half of a bracket: `{force: dot(a, b)}` is `force: dot(a` and `b)`.
pub(super) fn taken_apart(root: &Node) -> Vec<Problem> {
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
                problems.push(yaml::taken_apart(place.index(first), HELP));
                return;
            }
            for (index, item) in items.iter().enumerate() {
                look(item, &place.index(index), problems);
            }
        }
        Node::Map(entries) => {
            for (at, (key, value)) in entries.iter().enumerate() {
                if balance(key) != 0 {
                    let before = at.checked_sub(1).and_then(|at| entries.get(at));
                    let place = match before {
                        Some((before, Node::Scalar(text))) if balance(text) > 0 => place.key(before),
                        _ => place.key(key).of_key(),
                    };
                    problems.push(yaml::taken_apart(place, HELP));
                    continue;
                }
                look(value, &place.key(key), problems);
            }
        }
    }
}

const HELP: &str = "put the expression in double quotes";

/// Opening less closing brackets.
fn balance(text: &str) -> i32 {
    text.chars().fold(0, |balance, c| match c {
        '(' | '[' | '{' => balance + 1,
        ')' | ']' | '}' => balance - 1,
        _ => balance,
    })
}
