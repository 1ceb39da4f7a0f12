//! A model file's text to a tree; the one module that names `serde_yaml`.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeSet;
use std::fmt;

use super::node::Node;
use super::quotes::folded_primes;
use super::spans::{duplicates, spans};
use super::unquoted::unquoted;
use super::yaml_error::{complex_key, yaml_error};
use crate::diagnose::{Place, Problem, catalogue::yaml};

/// Largest file in bytes.
const LARGEST: usize = 1 << 20;

/// Reads YAML and refuses what model files do not use: anchors, aliases, merge keys, tags, numbers that are not
/// finite or not decimal, keys given twice, several documents, deep nesting, files above 1 MiB.
///
/// # Errors
/// Everything found wrong; an error of YAML's syntax alone.
pub fn read(text: &str) -> Result<Node, Vec<Problem>> {
    if text.len() > LARGEST {
        return Err(vec![yaml::too_large(Place::in_file(0, 0), text.len(), LARGEST)]);
    }
    // Before serde_yaml, so that it never sees an alias that it would expand, nor lists so deep that its time,
    // which goes with the square of the depth, would run away.
    let opening = text.bytes().filter(|byte| matches!(byte, b'[' | b'{')).count();
    if opening > MANY || SIGNS.iter().any(|sign| text.contains(sign)) {
        let (_, problems, failure) = spans(text);
        if !problems.is_empty() {
            return Err(problems);
        }
        if let Some((at, what)) = failure {
            return Err(vec![yaml_error(text, at, &what)]);
        }
    }
    // serde_yaml takes a byte order mark for a document of its own.
    match serde_yaml::from_str::<Loaded>(text.strip_prefix(MARK).unwrap_or(text)) {
        Ok(Loaded(node @ Node::Map(_))) => {
            let mut problems = unquoted(&node);
            if problems.is_empty() && text.contains("''") {
                problems = folded_primes(text);
            }
            if problems.is_empty() { Ok(node) } else { Err(problems) }
        }
        Ok(Loaded(node)) => Err(vec![yaml::not_a_mapping(Place::in_file(0, 0), kind(&node))]),
        Err(error) => Err(explain(text, &error)),
    }
}

/// So many opening brackets may be a hostile nest.
const MANY: usize = 2000;

/// Byte order mark.
const MARK: char = '\u{feff}';

/// Without one of these no anchor, tag, merge key or number of another base can be in the text.
const SIGNS: &[&str] = &["&", "!", "<<", "0x", "0o", "0b", "0X", "0O", "0B"];

fn kind(node: &Node) -> &'static str {
    match node {
        Node::Null => "empty",
        Node::Scalar(_) => "a single text",
        Node::List(_) => "a list",
        Node::Map(_) => "a mapping",
    }
}

/// The second look at a file that was not read.
fn explain(text: &str, error: &serde_yaml::Error) -> Vec<Problem> {
    let (root, mut problems, failure) = spans(text);
    if let (Some(root), None) = (&root, &failure) {
        duplicates(text, root, &mut problems);
    }
    if !problems.is_empty() {
        return problems;
    }
    let what = error.to_string();
    let control = |c: char| c.is_control() && !"\t\n\r\u{85}".contains(c);
    // No place is told of these.
    let at = match text.find(control).filter(|_| what.contains("control characters")) {
        Some(at) => at,
        None => error.location().map_or(0, |place| byte_at(text, place.line(), place.column())),
    };
    if what.contains(KEY_WANTED) {
        return vec![complex_key(text, at)];
    }
    vec![yaml_error(text, at, &what)]
}

/// The byte at a line and column as YAML's libraries count them: both from 1, columns in characters.
pub(super) fn byte_at(text: &str, line: usize, column: usize) -> usize {
    let start = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum::<usize>();
    let column = if start == 0 && text.starts_with(MARK) { column + 1 } else { column };
    let rest = &text[start..];
    start + rest.char_indices().nth(column.saturating_sub(1)).map_or(rest.len(), |(byte, _)| byte)
}

/// What serde_yaml names in its error where a list or mapping stands in the place of a key.
const KEY_WANTED: &str = "text as a key";

struct Loaded(Node);

impl<'de> Deserialize<'de> for Loaded {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Loaded, D::Error> {
        deserializer.deserialize_any(NodeVisitor).map(Loaded)
    }
}

struct NodeVisitor;

impl NodeVisitor {
    fn number<E>(text: impl ToString) -> Result<Node, E> {
        Ok(Node::Scalar(text.to_string()))
    }
}

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a mapping, a list or text")
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_none<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Node, E> {
        NodeVisitor::number(value)
    }

    fn visit_i64<E>(self, value: i64) -> Result<Node, E> {
        NodeVisitor::number(value)
    }

    fn visit_u64<E>(self, value: u64) -> Result<Node, E> {
        NodeVisitor::number(value)
    }

    fn visit_i128<E>(self, value: i128) -> Result<Node, E> {
        NodeVisitor::number(value)
    }

    fn visit_u128<E>(self, value: u128) -> Result<Node, E> {
        NodeVisitor::number(value)
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Node, E> {
        if !value.is_finite() {
            return Err(E::custom("a number that is not finite"));
        }
        let plain = value.abs() < 1e15 && value.abs() >= 1e-5 || value == 0.0;
        Ok(Node::Scalar(if plain { format!("{value}") } else { format!("{value:e}") }))
    }

    fn visit_str<E>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Scalar(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Node, A::Error> {
        let mut list = Vec::new();
        while let Some(Loaded(item)) = items.next_element()? {
            list.push(item);
        }
        Ok(Node::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Node, A::Error> {
        let mut map = Vec::new();
        let mut seen = BTreeSet::new();
        while let Some(Text(key)) = entries.next_key()? {
            if !seen.insert(key.clone()) {
                return Err(A::Error::custom("a key given twice"));
            }
            let Loaded(value) = entries.next_value()?;
            map.push((key, value));
        }
        Ok(Node::Map(map))
    }
}

/// A key exactly as written, `on` and `1` too.
struct Text(String);

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Text, D::Error> {
        deserializer.deserialize_str(TextVisitor)
    }
}

struct TextVisitor;

impl<'de> Visitor<'de> for TextVisitor {
    type Value = Text;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(KEY_WANTED)
    }

    fn visit_str<E>(self, text: &str) -> Result<Text, E> {
        Ok(Text(text.to_owned()))
    }
}
