//! Edits of a model file that leave everything else as its author wrote it.

use std::ops::Range;

use super::spans::{Outline, Shape, Style, spans};
use crate::place::Step;

/// The keys of the mapping at a path, in the file's order; none where there is no mapping.
pub fn keys(text: &str, path: &[Step]) -> Vec<String> {
    let Some(root) = spans(text).0 else { return Vec::new() };
    match at(&root, path).map(|node| &node.shape) {
        Some(Shape::Map(entries)) => entries.iter().filter_map(|(key, _)| scalar(key)).map(str::to_owned).collect(),
        _ => Vec::new(),
    }
}

/// The scalar at a path, as YAML gives it.
pub fn value(text: &str, path: &[Step]) -> Option<String> {
    at(&spans(text).0?, path).and_then(scalar).map(str::to_owned)
}

/// What stands at a path, as it is written.
pub fn source<'t>(text: &'t str, path: &[Step]) -> Option<&'t str> {
    let node = at(&spans(text).0?, path)?.clone();
    text.get(node.range.start..end(text, &node))
}

/// The file without what stands at a path, comments on its lines included; a mapping or list that would be empty goes too.
/// `None` where nothing stands there, or not so that it can be taken out.
pub fn without(text: &str, path: &[Step]) -> Option<String> {
    let root = spans(text).0?;
    let (last, above) = path.split_last()?;
    let parent = at(&root, above)?;
    let children: Vec<(Range<usize>, bool)> = match &parent.shape {
        Shape::Scalar(..) => return None,
        Shape::List(items) => {
            let own =
                |(index, item): (usize, &Outline)| (item.range.start..end(text, item), *last == Step::Index(index));
            items.iter().enumerate().map(own).collect()
        }
        Shape::Map(entries) => {
            let own = |(key, value): &(Outline, Outline)| {
                let is = matches!((last, scalar(key)), (Step::Key(name), Some(key)) if name == key);
                (key.range.start..end(text, value).max(key.range.end), is)
            };
            entries.iter().map(own).collect()
        }
    };
    let place = children.iter().position(|(_, is)| *is)?;
    if children.len() == 1 && !above.is_empty() {
        return without(text, above);
    }
    let (range, _) = &children[place];
    let gone = if flows(text, parent) {
        match (children.get(place + 1), place.checked_sub(1).and_then(|before| children.get(before))) {
            (Some((next, _)), _) => range.start..next.start,
            (None, Some((before, _))) => before.end..range.end,
            (None, None) => range.clone(),
        }
    } else {
        let start = text[..range.start].rfind('\n').map_or(0, |newline| newline + 1);
        // A mapping that begins behind the dash of a list.
        if !text[start..range.start].chars().all(|c| c.is_whitespace() || c == '-' && matches!(last, Step::Index(_))) {
            return None;
        }
        start..text[range.end..].find('\n').map_or(text.len(), |newline| range.end + newline + 1)
    };
    Some([&text[..gone.start], &text[gone.end..]].concat())
}

/// The file with an entry more in a section of the root, first in it; a section that is not there comes after `behind`, or at
/// the end.  `None` where the root is not written in lines, or the section is no mapping.
pub fn with(text: &str, section: &str, behind: &str, key: &str, value: &str) -> Option<String> {
    let root = spans(text).0?;
    if flows(text, &root) {
        return None;
    }
    match at(&root, &[Step::Key(section.to_owned())]) {
        Some(node) => entered(text, node, key, value),
        None => Some(lined(text, &root, behind, &format!("{section}: {{{key}: {value}}}"))),
    }
}

/// The file with a section more that is one scalar, after `behind` or at the end.  `None` where the root is not written in lines.
pub fn with_scalar(text: &str, behind: &str, section: &str, value: &str) -> Option<String> {
    let root = spans(text).0?;
    (!flows(text, &root)).then(|| lined(text, &root, behind, &format!("{section}: {value}")))
}

/// The file with a line more of its own, after a section or at the end.
fn lined(text: &str, root: &Outline, behind: &str, line: &str) -> String {
    let after = at(root, &[Step::Key(behind.to_owned())]).map(|node| end(text, node));
    let newline = |from: usize| text[from..].find('\n').map_or(text.len(), |newline| from + newline + 1);
    let (before, rest) = text.split_at(after.map_or(text.len(), newline));
    let gap = if before.is_empty() || before.ends_with('\n') { "" } else { "\n" };
    format!("{before}{gap}{line}\n{rest}")
}

/// The file with an entry more in the mapping at a path, first in it.  `None` where there is none, or none that has entries in lines.
pub fn with_at(text: &str, path: &[Step], key: &str, value: &str) -> Option<String> {
    entered(text, at(&spans(text).0?, path)?, key, value)
}

/// The file with an entry more in a mapping.
fn entered(text: &str, node: &Outline, key: &str, value: &str) -> Option<String> {
    let Shape::Map(entries) = &node.shape else { return None };
    let first = entries.first().map(|(key, _)| key.range.start);
    let (at, entry) = match (flows(text, node), first) {
        (true, None) => (node.range.start + 1, format!("{key}: {value}")),
        (true, Some(first)) => (first, format!("{key}: {value}, ")),
        (false, Some(first)) => {
            let line = text[..first].rfind('\n').map_or(0, |newline| newline + 1);
            (line, format!("{}{key}: {value}\n", &text[line..first]))
        }
        (false, None) => return None,
    };
    Some([&text[..at], &entry, &text[at..]].concat())
}

/// The file with another scalar at a path; written as given.
pub fn replaced(text: &str, path: &[Step], value: &str) -> Option<String> {
    let root = spans(text).0?;
    let node = at(&root, path)?;
    let range = node.range.start..end(text, node);
    matches!(node.shape, Shape::Scalar(..)).then(|| [&text[..range.start], value, &text[range.end..]].concat())
}

/// The file with its plain and double-quoted scalars, keys too, changed as `change` says; what stands in single quotes stays.
pub fn rewritten(text: &str, change: impl Fn(&str) -> String) -> Option<String> {
    let mut ranges = Vec::new();
    scalars(&spans(text).0?, &mut ranges);
    let (mut new, mut done) = (String::with_capacity(text.len()), 0);
    for range in ranges {
        new += &text[done..range.start];
        new += &change(&text[range.clone()]);
        done = range.end;
    }
    Some(new + &text[done..])
}

/// Where the scalars stand that are not in single quotes, in the file's order.
fn scalars(node: &Outline, found: &mut Vec<Range<usize>>) {
    match &node.shape {
        Shape::Scalar(_, Style::Single) => {}
        Shape::Scalar(..) => found.push(node.range.clone()),
        Shape::List(items) => items.iter().for_each(|item| scalars(item, found)),
        Shape::Map(entries) => entries.iter().for_each(|(key, value)| {
            scalars(key, found);
            scalars(value, found);
        }),
    }
}

fn at<'a>(root: &'a Outline, path: &[Step]) -> Option<&'a Outline> {
    path.iter().try_fold(root, |node, step| match (step, &node.shape) {
        (Step::Key(name), Shape::Map(entries)) => {
            entries.iter().find(|(key, _)| scalar(key) == Some(name)).map(|(_, value)| value)
        }
        (Step::Index(index), Shape::List(items)) => items.get(*index),
        _ => None,
    })
}

fn scalar(node: &Outline) -> Option<&str> {
    match &node.shape {
        Shape::Scalar(text, _) => Some(text),
        _ => None,
    }
}

/// Whether a mapping or list stands in brackets.
fn flows(text: &str, node: &Outline) -> bool {
    text[node.range.clone()].starts_with(['{', '['])
}

/// Where what is written of a node ends; the parser's mappings and lists in lines end with what comes after them.
fn end(text: &str, node: &Outline) -> usize {
    if flows(text, node) {
        return node.range.end;
    }
    let last = match &node.shape {
        Shape::Scalar(..) => return node.range.end,
        Shape::List(items) => items.last(),
        Shape::Map(entries) => entries.last().map(|(_, value)| value),
    };
    last.map_or(node.range.start, |last| end(text, last))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "name: Car   # a word
parameters: {m: 1 kg, 'k': 2 N/m, c: 3}
springs:
  # the first
  tyre: {between: [a, b], stiffness: k}   # soft
  seat:
    between: [b, c]
    stiffness: \"k\"
  pin: {along: [1, 0]}
checks: {only: 'x = x'}
draw:
  - {line: [a, b]}
  - {line: [b, c]}
scene:
  start: {x: 1}
  until: 3";

    fn path(steps: &[&str]) -> Vec<Step> {
        let step = |step: &&str| step.parse().map_or_else(|_| Step::Key((*step).to_owned()), Step::Index);
        steps.iter().map(step).collect()
    }

    #[test]
    fn entries_go_and_the_rest_stays_as_it_was() {
        for (gone, from, to) in [
            (&["parameters", "m"][..], "{m: 1 kg, 'k'", "{'k'"),
            (&["parameters", "k"], "'k': 2 N/m, ", ""),
            (&["parameters", "c"], ", c: 3}", "}"),
            (&["springs", "tyre"], "  tyre: {between: [a, b], stiffness: k}   # soft\n", ""),
            (&["springs", "seat"], "  seat:\n    between: [b, c]\n    stiffness: \"k\"\n", ""),
            (&["springs", "pin"], "  pin: {along: [1, 0]}\n", ""),
            (&["springs", "pin", "along", "1"], "[1, 0]", "[1]"),
            (&["checks", "only"], "checks: {only: 'x = x'}\n", ""),
            (&["draw", "0"], "  - {line: [a, b]}\n", ""),
            (&["scene", "start", "x"], "  start: {x: 1}\n", ""),
            (&["scene", "until"], "  until: 3", ""),
        ] {
            assert_eq!(without(FILE, &path(gone)).as_deref(), Some(FILE.replacen(from, to, 1).as_str()), "{gone:?}");
        }
        assert_eq!(without(FILE, &path(&["springs", "none"])), None);
    }

    #[test]
    fn entries_come_and_scalars_change() {
        for (section, from, to) in [
            ("parameters", "{m: 1", "{z: 1 m, m: 1"),
            ("springs", "  # the first\n", "  # the first\n  z: 1 m\n"),
            ("define", "c: 3}\n", "c: 3}\ndefine: {z: 1 m}\n"),
        ] {
            assert_eq!(with(FILE, section, "parameters", "z", "1 m"), Some(FILE.replacen(from, to, 1)), "{section}");
        }
        assert_eq!(with_at(FILE, &path(&["scene", "start"]), "y", "2"), Some(FILE.replace("{x: 1}", "{y: 2, x: 1}")));
        assert_eq!(
            with_at(FILE, &path(&["springs", "seat"]), "rest", "2")
                .map(|text| text.contains("    rest: 2\n    between")),
            Some(true)
        );
        assert_eq!(replaced(FILE, &path(&["scene", "until"]), "4"), Some(FILE.replace("until: 3", "until: 4")));
        let louder = rewritten(FILE, |scalar| scalar.replace('x', "y"));
        assert_eq!(louder, Some(FILE.replace("{x: 1}", "{y: 1}")));
        assert_eq!(value(FILE, &path(&["springs", "seat", "stiffness"])).as_deref(), Some("k"));
        assert_eq!(source(FILE, &path(&["springs", "pin"])), Some("{along: [1, 0]}"));
        assert_eq!(keys(FILE, &path(&["springs"])), ["tyre", "seat", "pin"]);
        assert!(keys(FILE, &path(&["name"])).is_empty());
    }
}
