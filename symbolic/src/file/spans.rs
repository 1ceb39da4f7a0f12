//! Where everything stands in a model file: its tree with byte ranges, by `saphyr-parser`.
//!
//! Walked only when something is wrong, or when the file holds signs of what model files do not use.

use saphyr_parser::{Event, Parser, ScalarStyle};
use std::ops::Range;

use crate::diagnose::{Place, Problem, catalogue::yaml};

/// One node and the bytes it covers.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    pub shape: Shape,
    pub range: Range<usize>,
}

/// What a node is.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Scalar(String, Style),
    List(Vec<Outline>),
    Map(Vec<(Outline, Outline)>),
}

/// How a scalar is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    /// Plain, or a block after `|` or `>`.
    Bare,
    /// In single quotes.
    Single,
    /// In double quotes.
    Double,
}

/// Deepest nesting of lists and mappings, the same as serde_yaml's.
const DEEPEST: usize = 128;

/// The tree and what in it is refused, as far as the file is YAML; and where it ceases to be.
pub(crate) fn spans(text: &str) -> (Option<Outline>, Vec<Problem>, Option<(usize, String)>) {
    let bytes: Vec<usize> = text.char_indices().map(|(byte, _)| byte).chain([text.len()]).collect();
    let byte = |index: usize| bytes.get(index).copied().unwrap_or(text.len());
    let mut builder = Builder { text, ..Builder::default() };
    for event in Parser::new_from_str(text) {
        match event {
            Ok((event, span)) => {
                let range = byte(span.start.index())..byte(span.end.index());
                if !builder.take(event, range) {
                    break;
                }
            }
            Err(error) if error.info().contains("unknown anchor") => {
                let at = byte(error.marker().index());
                let end = text[at..].find([' ', ',', ']', '}', '\n']).map_or(text.len(), |length| at + length);
                builder.problems.push(yaml::alias(Place::in_file(at, end)));
                break;
            }
            Err(error) if error.info().contains("recursion limit") => {
                let at = byte(error.marker().index());
                builder.problems.push(yaml::nested_too_deeply(Place::in_file(at, at), DEEPEST));
                break;
            }
            Err(error) => {
                let failure = Some((byte(error.marker().index()), error.info().to_owned()));
                return (builder.root(), builder.problems, failure);
            }
        }
    }
    (builder.root(), builder.problems, None)
}

#[derive(Default)]
struct Builder<'a> {
    text: &'a str,
    /// Lists and mappings still open, from the outermost; a mapping with a key that waits for its value.
    open: Vec<(Outline, Option<Outline>)>,
    root: Option<Outline>,
    documents: usize,
    problems: Vec<Problem>,
}

impl Builder<'_> {
    /// False when there is no sense in going on.
    fn take(&mut self, event: Event<'_>, range: Range<usize>) -> bool {
        match event {
            Event::DocumentStart(_) => {
                self.documents += 1;
                if self.documents == 2 {
                    self.problems.push(yaml::several_documents(Place::in_file(range.start, range.end)));
                    return false;
                }
            }
            Event::Alias(_) => {
                self.problems.push(yaml::alias(Place::in_file(range.start, range.end)));
                self.put(Outline { shape: Shape::Scalar(String::new(), Style::Bare), range });
            }
            Event::Scalar(value, style, anchor, tag) => {
                self.refuse(anchor, tag.is_some(), range.start);
                let style = match style {
                    ScalarStyle::SingleQuoted => Style::Single,
                    ScalarStyle::DoubleQuoted => Style::Double,
                    ScalarStyle::Plain | ScalarStyle::Literal | ScalarStyle::Folded => Style::Bare,
                };
                if style == Style::Bare {
                    self.refuse_number(&value, &range);
                }
                let end = range.start + self.text[range.clone()].trim_end().len();
                self.put(Outline { shape: Shape::Scalar(value.into_owned(), style), range: range.start..end });
            }
            Event::SequenceStart(anchor, tag) => {
                self.refuse(anchor, tag.is_some(), range.start);
                return self.start(Shape::List(Vec::new()), range);
            }
            Event::MappingStart(anchor, tag) => {
                self.refuse(anchor, tag.is_some(), range.start);
                return self.start(Shape::Map(Vec::new()), range);
            }
            Event::SequenceEnd | Event::MappingEnd => {
                if let Some((mut node, _)) = self.open.pop() {
                    node.range.end = range.end.max(node.range.end);
                    self.put(node);
                }
            }
            Event::Nothing | Event::StreamStart | Event::StreamEnd | Event::DocumentEnd => {}
        }
        true
    }

    fn start(&mut self, shape: Shape, range: Range<usize>) -> bool {
        if self.open.len() >= DEEPEST {
            self.problems.push(yaml::nested_too_deeply(Place::in_file(range.start, range.end), DEEPEST));
            return false;
        }
        self.open.push((Outline { shape, range }, None));
        true
    }

    fn put(&mut self, node: Outline) {
        let Some((parent, key)) = self.open.last_mut() else {
            self.root = Some(node);
            return;
        };
        match (&mut parent.shape, key.take()) {
            (Shape::List(items), _) => items.push(node),
            (Shape::Map(entries), Some(name)) => entries.push((name, node)),
            (Shape::Map(_), None) => *key = Some(node),
            (Shape::Scalar(..), _) => {}
        }
    }

    /// The tree, closed where the file broke off.
    fn root(&mut self) -> Option<Outline> {
        while let Some((node, _)) = self.open.pop() {
            self.put(node);
        }
        self.root.take()
    }

    /// Anchors and tags stand before their node; the parser's range may start with them or after them.
    fn refuse(&mut self, anchor: usize, tag: bool, start: usize) {
        if anchor == 0 && !tag {
            return;
        }
        let marked = |text: &str| text.starts_with(['&', '!']);
        let mut start = start;
        while !marked(&self.text[start..]) {
            let before = self.text[..start].trim_end();
            let word = before.rfind(|c: char| c.is_whitespace() || "[{,".contains(c)).map_or(0, |at| at + 1);
            if !marked(&before[word..]) {
                break;
            }
            start = word;
        }
        let mut rest = &self.text[start..];
        while marked(rest) {
            let word = &rest[..rest.find(|c: char| c.is_whitespace() || ",]}".contains(c)).unwrap_or(rest.len())];
            let at = self.text.len() - rest.len();
            let place = Place::in_file(at, at + word.len());
            let problem = if word.starts_with('&') { yaml::anchor(place) } else { yaml::tag(place, word) };
            self.problems.push(problem);
            rest = rest[word.len()..].trim_start();
        }
    }

    fn refuse_number(&mut self, value: &str, range: &Range<usize>) {
        let place = || Place::in_file(range.start, range.end);
        let unsigned = value.trim_start_matches(['+', '-']).to_ascii_lowercase();
        let digits = |radix: u32, prefix: &str| {
            unsigned
                .strip_prefix(prefix)
                .is_some_and(|rest| rest.chars().all(|c| c.is_digit(radix)) && !rest.is_empty())
        };
        if unsigned == ".inf" || unsigned == ".nan" {
            self.problems.push(yaml::not_finite(place(), value));
        } else if digits(16, "0x") || digits(8, "0o") || digits(2, "0b") {
            self.problems.push(yaml::not_decimal(place(), value));
        } else if value == "<<" {
            self.problems.push(yaml::merge_key(place()));
        }
    }
}

/// True of what YAML took for a key and is the end of an expression with commas: `a)`.
fn is_end_of_call(key: &str) -> bool {
    key.matches([')', ']']).count() > key.matches(['(', '[']).count()
}

/// Keys given twice in one mapping.
pub(crate) fn duplicates(text: &str, node: &Outline, problems: &mut Vec<Problem>) {
    match &node.shape {
        Shape::Scalar(..) => {}
        Shape::List(items) => items.iter().for_each(|item| duplicates(text, item, problems)),
        Shape::Map(entries) => {
            let mut seen = std::collections::BTreeMap::new();
            for (key, value) in entries {
                if let Shape::Scalar(name, _) = &key.shape {
                    let first = *seen.entry(name).or_insert(key.range.start);
                    if first != key.range.start {
                        let line = text[..first].matches('\n').count() + 1;
                        let place = Place::in_file(key.range.start, key.range.end);
                        problems.push(match is_end_of_call(name) {
                            true => yaml::unquoted(place, "put the expression in double quotes"),
                            false => yaml::duplicate_key(place, name, line),
                        });
                    }
                }
                duplicates(text, value, problems);
            }
        }
    }
}
