//! Elements and attributes with their places, and numbers read from them.

use dalembert_symbolic::diagnose::{Place, Problem};
use roxmltree::{Document, Error, Node, ParsingOptions};

use super::problems;

/// The largest file, in bytes: the largest robots have some 10⁵.
const LARGEST: usize = 32 << 20;

/// Most elements, texts and comments; a robot of 400 joints has some 10⁴.
const NODES: u32 = 1_000_000;

/// The document.
///
/// # Errors
/// It is no XML, or larger than any robot.
pub fn parse(text: &str) -> Result<Document<'_>, Problem> {
    if text.len() > LARGEST {
        return Err(problems::too_large(Place::in_file(0, 1), &format!("more than {} MB", LARGEST >> 20)));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| refused(text, &error))
}

fn refused(text: &str, error: &Error) -> Problem {
    match error {
        Error::DtdDetected => {
            let start = text.find("<!DOCTYPE").unwrap_or(0);
            problems::document_type(Place::in_file(start, start + 9))
        }
        Error::NodesLimitReached | Error::AttributesLimitReached | Error::NamespacesLimitReached => {
            problems::too_large(Place::in_file(0, 1), &format!("more than {NODES} elements"))
        }
        // The parser has no place for a file that ends inside the robot.
        Error::NoRootNode | Error::UnclosedRootNode | Error::UnexpectedEndOfStream => {
            let end = text.trim_end().len();
            let last = text[..end].char_indices().next_back().map_or(0, |(start, _)| start);
            problems::no_xml(Place::in_file(last, end), &without_position(error))
        }
        _ => {
            let position = error.pos();
            let start = offset(text, position.row as usize, position.col as usize);
            problems::no_xml(Place::in_file(start, start), &without_position(error))
        }
    }
}

/// The parser's message; lines and columns are told by the place.
fn without_position(error: &Error) -> String {
    let text = error.to_string();
    let kept = text.rsplit_once(" at ").map_or(text.as_str(), |(before, _)| before);
    problems::shown(kept)
}

/// The byte of a line and a column that count characters from 1.
fn offset(text: &str, row: usize, column: usize) -> usize {
    let lines = text.split_inclusive('\n');
    let before: usize = lines.clone().take(row.saturating_sub(1)).map(str::len).sum();
    let line = lines.clone().nth(row.saturating_sub(1)).unwrap_or("");
    before + line.char_indices().nth(column.saturating_sub(1)).map_or(line.trim_end().len(), |(byte, _)| byte)
}

/// An element's first tag, up to its name.
pub fn place(node: Node<'_, '_>) -> Place {
    let start = node.range().start;
    Place::in_file(start, start + 1 + node.tag_name().name().len())
}

/// An attribute's value.
pub fn place_of(node: Node<'_, '_>, name: &str) -> Place {
    node.attribute_node(name).map_or_else(
        || place(node),
        |attribute| {
            let range = attribute.range_value();
            Place::in_file(range.start, range.end)
        },
    )
}

/// The first element of that name inside.
pub fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|inner| inner.has_tag_name(name))
}

/// Numbers of an attribute, all told when they are none; absent: `None`.
pub fn numbers<const N: usize>(node: Node<'_, '_>, name: &str, problems: &mut Vec<Problem>) -> Option<[f64; N]> {
    let text = node.attribute(name)?;
    let mut values = [0.0; N];
    let mut words = text.split_whitespace();
    let read = values.iter_mut().all(|value| match words.next().and_then(number) {
        Some(number) => {
            *value = number;
            true
        }
        None => false,
    });
    if read && words.next().is_none() {
        return Some(values);
    }
    let wanted = if N == 1 { "a number" } else { "three numbers" };
    problems.push(problems::bad_number(place_of(node, name), name, text, wanted));
    None
}

/// One number of an attribute.
pub fn number_of(node: Node<'_, '_>, name: &str, problems: &mut Vec<Problem>) -> Option<f64> {
    numbers::<1>(node, name, problems).map(|[value]| value)
}

/// The largest number that means something in a robot, in SI units: beyond it products of a few overflow.
const HUGE: f64 = 1e30;

fn number(text: &str) -> Option<f64> {
    text.parse().ok().filter(|value: &f64| value.abs() < HUGE)
}
