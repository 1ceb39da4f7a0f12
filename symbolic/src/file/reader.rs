//! Nodes of the file as texts, lists and mappings, with a problem where the shape is wrong.

use std::rc::Rc;

use super::{Node, Text, Written};
use crate::diagnose::catalogue::{sections, syntax};
use crate::diagnose::{Place, Problem, did_you_mean_or};
use crate::language::{Ast, Unit, Valued, parse, parse_equation, parse_unit, parse_value_with_unit};

/// A node and where it stands.
#[derive(Clone, Debug)]
pub struct Spot<'a> {
    /// The node.
    pub node: &'a Node,
    /// Where it stands.
    pub place: Place,
    /// What it is called in messages: the last key above it.
    pub name: String,
}

/// A value with its unit.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// The value as written.
    pub text: Text,
    /// Its unit as written, and what it means.
    pub unit: Option<(String, Unit)>,
}

/// What is wrong.
pub type Problems = Vec<Problem>;

impl<'a> Spot<'a> {
    /// The whole file.
    pub fn root(node: &'a Node) -> Spot<'a> {
        Spot { node, place: Place::default(), name: "the model".to_owned() }
    }

    /// The entries of a mapping.
    pub fn entries(&self, problems: &mut Problems) -> Vec<(&'a str, Spot<'a>)> {
        match self.node {
            Node::Map(entries) => entries.iter().map(|(key, node)| (key.as_str(), self.under(key, node))).collect(),
            _ => {
                self.wrong_shape("a mapping `{key: value, …}`", problems);
                Vec::new()
            }
        }
    }

    fn under(&self, key: &str, node: &'a Node) -> Spot<'a> {
        Spot { node, place: self.place.key(key), name: key.to_owned() }
    }

    /// Whether it is a mapping.
    pub fn is_mapping(&self) -> bool {
        matches!(self.node, Node::Map(_))
    }

    /// The value of one key of a mapping.
    pub fn get(&self, key: &str) -> Option<Spot<'a>> {
        match self.node {
            Node::Map(entries) => {
                entries.iter().find(|(name, _)| name == key).map(|(name, node)| self.under(name, node))
            }
            _ => None,
        }
    }

    /// What is read of a key that may be left out: `Some(None)` where it is, `None` where it is there and wrong.
    pub fn optional<T>(&self, key: &str, read: impl FnOnce(Spot<'a>) -> Option<T>) -> Option<Option<T>> {
        match self.get(key) {
            Some(spot) => read(spot).map(Some),
            None => Some(None),
        }
    }

    /// The value of a key that must be there.
    pub fn need(&self, key: &str, section: &str, problems: &mut Problems) -> Option<Spot<'a>> {
        let found = self.get(key);
        if found.is_none() && matches!(self.node, Node::Map(_)) && !self.misspelt(problems) {
            problems.push(sections::missing_key(self.place.of_key(), key, section));
        }
        found
    }

    /// Whether an unknown key was reported here: what seems to be missing may be what was misspelt.
    pub fn misspelt(&self, problems: &[Problem]) -> bool {
        let here = &self.place.path;
        let inside = |p: &Problem| p.place.path.len() == here.len() + 1 && p.place.path.starts_with(here);
        problems.iter().rev().take(64).any(|problem| problem.code == "E301" && inside(problem))
    }

    /// Reports keys that are none of these; false when the node is no mapping.
    pub fn only(&self, known: &[&str], section: &str, problems: &mut Problems) -> bool {
        let Node::Map(entries) = self.node else {
            self.wrong_shape("a mapping `{key: value, …}`", problems);
            return false;
        };
        for (key, _) in entries {
            if !known.contains(&key.as_str()) {
                let place = self.place.key(key).of_key();
                problems.push(sections::unknown_key(place, key, section, did_you_mean_or(key, known)));
            }
        }
        true
    }

    /// The members of a list.
    pub fn list(&self, problems: &mut Problems) -> Vec<Spot<'a>> {
        match self.items() {
            Some(items) => items,
            None => {
                self.wrong_shape("a list", problems);
                Vec::new()
            }
        }
    }

    /// The members of a list; `None` if it is none.
    pub fn items(&self) -> Option<Vec<Spot<'a>>> {
        let Node::List(nodes) = self.node else { return None };
        let item =
            |(k, node)| Spot { node, place: self.place.index(k), name: format!("item {} of {}", k + 1, self.name) };
        Some(nodes.iter().enumerate().map(item).collect())
    }

    /// A scalar as written.
    pub fn words(&self, problems: &mut Problems) -> Option<&'a str> {
        match self.node {
            Node::Scalar(text) => Some(text),
            Node::Null => {
                problems.push(sections::missing_value(self.place.of_key(), &self.name));
                None
            }
            _ => {
                self.wrong_shape("an expression", problems);
                None
            }
        }
    }

    /// An expression.
    pub fn text(&self, problems: &mut Problems) -> Option<Text> {
        let words = self.words(problems)?;
        match with_unit(words) {
            Some((ast, unit)) => {
                let (source, place) = (words.into(), Rc::new(self.place.clone()));
                Some(Text { source, ast: Rc::new(ast), unit: Some(unit), place })
            }
            None => self.parsed(parse, problems),
        }
    }

    /// An expression or an equation.
    pub fn equation(&self, problems: &mut Problems) -> Option<Text> {
        self.parsed(parse_equation, problems)
    }

    fn parsed(&self, read: impl Fn(&str) -> Result<Ast, Vec<Problem>>, problems: &mut Problems) -> Option<Text> {
        let words = self.words(problems)?;
        match read(words) {
            Ok(ast) => {
                let (source, place) = (words.into(), Rc::new(self.place.clone()));
                Some(Text { source, ast: Rc::new(ast), unit: None, place })
            }
            Err(found) => {
                problems.extend(found.into_iter().map(|problem| problem.moved_to(&self.place)));
                None
            }
        }
    }

    /// An expression, or a list of two or three.
    pub fn written(&self, problems: &mut Problems) -> Option<Written> {
        let Some(items) = self.items() else { return self.text(problems).map(Written::One) };
        if !(2..=3).contains(&items.len()) {
            problems.push(syntax::vector_components(self.place.clone(), items.len()));
            return None;
        }
        let texts: Vec<Option<Text>> = items.iter().map(|item| item.text(problems)).collect();
        let texts: Option<Vec<Text>> = texts.into_iter().collect();
        texts.map(|texts| Written::List(texts, Rc::new(self.place.clone())))
    }

    /// An expression with a unit, or none, after it.
    pub fn quantity(&self, problems: &mut Problems) -> Option<Quantity> {
        let words = self.words(problems)?;
        match quantity(words, &self.place) {
            Ok(quantity) => Some(quantity),
            Err(found) => {
                problems.extend(found);
                None
            }
        }
    }

    /// Reports that something else stands here than what is wanted.
    pub fn wrong_shape(&self, wanted: &str, problems: &mut Problems) {
        let problem = match self.node {
            Node::Null => sections::missing_value(self.place.of_key(), &self.name),
            node => sections::wrong_shape(self.place.clone(), format!("`{}`", self.name), wanted, describe(node)),
        };
        problems.push(problem);
    }
}

/// A number with a unit after it, `5 N/m`; a unit after what names something would hide a forgotten operator.
fn with_unit(words: &str) -> Option<(Ast, Unit)> {
    // Most expressions are no number.
    if !words.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.(p".contains(c)) {
        return None;
    }
    let Valued { value, unit: Some((unit, _)) } = parse_value_with_unit(words).ok()? else { return None };
    let named = value.any_name(&mut |name| name != "pi");
    let unit = parse_unit(&unit).ok()?;
    (!named).then_some((value, unit))
}

/// Reads a value with a unit that stands at a place.
///
/// # Errors
/// What is wrong with either.
pub fn quantity(words: &str, place: &Place) -> Result<Quantity, Problems> {
    let moved = |found: Vec<Problem>, place: &Place| -> Problems {
        found.into_iter().map(|problem| problem.moved_to(place)).collect()
    };
    let Valued { value, unit } = parse_value_with_unit(words).map_err(|found| moved(found, place))?;
    let text = Text { source: words.into(), ast: Rc::new(value), unit: None, place: Rc::new(place.clone()) };
    let unit = match unit {
        None => None,
        Some((unit, span)) => Some((unit.clone(), unit_at(&unit, &place.at(span))?)),
    };
    Ok(Quantity { text, unit })
}

/// Reads a unit that stands at a place.
///
/// # Errors
/// What is wrong with it.
pub fn unit_at(words: &str, place: &Place) -> Result<Unit, Problems> {
    parse_unit(words).map_err(|found| found.into_iter().map(|problem| problem.moved_to(place)).collect())
}

/// What a node is, for messages.
pub fn describe(node: &Node) -> &'static str {
    match node {
        Node::Null => "nothing",
        Node::Scalar(_) => "text",
        Node::List(_) => "a list",
        Node::Map(_) => "a mapping",
    }
}
