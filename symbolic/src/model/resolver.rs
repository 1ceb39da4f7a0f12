//! What resolving a model carries from section to section.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::expression::builder::ExprBuilder;
use super::expression::families::{self, Expanded, Family, IndexNames, Locals};
use super::expression::index::MEMBER_LIMIT;
use super::expression::rules::Rules;
use super::expression::scope::{Entry, Member, Scope, Section};
use super::files::Files;
use super::resolved::{Model, Push};
use super::section::contacts::ContactText;
use super::section::joints::Fixed;
use super::section::resolve_values::{Item, Want};
use super::section::running_sums::Blocks;
use super::section::watched::Watched;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{names, sections};
use crate::expr::Id;
use crate::file::{Node, Spot, Text, Written};
use crate::language::is_reserved;

/// Sections whose keys are names that stand in expressions.
const DECLARING: [&str; 10] =
    ["sizes", "parameters", "coordinates", "states", "inputs", "define", "frames", "points", "bodies", "memory"];

/// A model half resolved.
pub struct Resolver<'a> {
    /// The file.
    pub root: Spot<'a>,
    /// Where expressions are made.
    pub builder: ExprBuilder,
    /// All names.
    pub scope: Scope,
    /// What has a value.
    pub items: Vec<Item>,
    /// Names of indices in keys, and where they stand.
    pub index_names: IndexNames,
    /// What `conserved` and `outputs` name, none where it was refused.
    pub watched: BTreeMap<String, Vec<Option<Watched>>>,
    /// What joints hold, to be looked at when values are known.
    pub fixed: Vec<Fixed>,
    /// Masses and moments of inertia: values, what they are, where they stand.
    pub masses: Vec<(Id, &'static str, Place)>,
    /// Whether a coordinate moves points without mass alone, which are where the forces on them balance: that is searched for.
    pub has_knots: bool,
    /// Files that the model names.
    pub files: Files,
    /// What the reactions of balances do to bodies, by their names.
    pub reaction_pushes: Vec<(String, Vec<Push>)>,
    /// Contacts, to be looked at when values are known.
    pub contacts: Vec<ContactText>,
    /// Sums over blocks of bodies.
    pub blocks: Blocks,
    /// Whether what every body does to a balance is to be a part of its own.
    pub in_parts: bool,
    /// Sections that are misspelt: as written, and as meant.
    pub slips: Vec<(String, &'static str)>,
    /// The result so far.
    pub model: Model,
    names: usize,
}

impl<'a> Resolver<'a> {
    /// For a file.
    pub fn new(root: Spot<'a>, files: &Files) -> Resolver<'a> {
        Resolver {
            root,
            builder: ExprBuilder::new(crate::expr::Graph::new()),
            scope: Scope::default(),
            items: Vec::new(),
            index_names: Vec::new(),
            watched: BTreeMap::new(),
            fixed: Vec::new(),
            masses: Vec::new(),
            has_knots: false,
            reaction_pushes: Vec::new(),
            contacts: Vec::new(),
            files: files.clone(),
            blocks: Blocks::default(),
            in_parts: false,
            slips: Vec::new(),
            model: Model::default(),
            names: 0,
        }
    }

    /// The entries of a section, empty where the file has none.
    pub fn section(&mut self, key: &str) -> Vec<(&'a str, Spot<'a>)> {
        match self.root.get(key) {
            Some(spot) => {
                if !spot.is_mapping() && DECLARING.contains(&key) {
                    self.refuse_words(spot.node);
                }
                spot.entries(&mut self.builder.problems)
            }
            None => Vec::new(),
        }
    }

    /// Makes the uses of names silent that a section of the wrong shape was to declare: `coordinates: x, y`, `[x, y]`, `- x: m`.
    fn refuse_words(&mut self, node: &Node) {
        let names = match node {
            Node::Null => Vec::new(),
            Node::Scalar(text) => text.split(',').collect(),
            Node::Map(entries) => entries.iter().map(|(key, _)| key.as_str()).collect(),
            Node::List(items) => return items.iter().for_each(|item| self.refuse_words(item)),
        };
        for name in names {
            let end = |c: char| !(c.is_alphanumeric() || c == '_');
            let name = name.trim().split(end).next().unwrap_or_default();
            if !name.is_empty() && !self.scope.names.contains_key(name) {
                self.refuse_name(name, Section::Definition);
            }
        }
    }

    /// Expands the key of an entry.
    pub fn expand(&mut self, words: &str, spot: &Spot<'_>) -> Option<Family> {
        if self.too_many_names() {
            return None;
        }
        let place = spot.place.of_key();
        let family = families::expand_name(&mut self.builder, &self.scope, &mut self.index_names, words, &place);
        if family.is_none() && self.builder.problems.last().is_some_and(|problem| problem.code == "E223") {
            self.names = MEMBER_LIMIT + 1;
        }
        family.filter(|family| self.count(family.members.len(), &place))
    }

    /// Expands a key inside an entry whose indices it may name.
    pub fn expand_in(&mut self, words: &str, spot: &Spot<'_>, outer: &Locals) -> Option<Family> {
        if self.too_many_names() {
            return None;
        }
        let place = spot.place.of_key();
        families::expand_inside(&mut self.builder, &self.scope, &mut self.index_names, (words, &place), outer)
    }

    /// The key of an entry that is one thing: a name, or one member of an indexed name.
    pub fn label(&mut self, words: &str, spot: &Spot<'_>, section: &str) -> Option<String> {
        let family = self.expand(words, spot)?;
        if family.ranged {
            self.builder.problems.push(sections::family_not_allowed(spot.place.of_key(), section));
            return None;
        }
        family.members.first().map(Expanded::name)
    }

    /// Expands the key of a declaration; when that is refused, so are the uses of its name, silently.
    pub fn expand_declared(&mut self, words: &str, spot: &Spot<'_>, section: Section) -> Option<Family> {
        let family = self.expand(words, spot);
        if family.is_none() {
            self.refuse_name(words.split(['[', '\'']).next().unwrap_or(words).trim(), section);
        }
        family
    }

    /// Makes the uses of a name silent.
    pub fn refuse_name(&mut self, name: &str, section: Section) {
        let entry = Entry { section, indices: 0, refused: true, members: BTreeMap::new() };
        self.scope.names.entry(name.to_owned()).or_insert(entry).refused = true;
    }

    /// Counts names; false (reported once) beyond the limit.
    pub fn count(&mut self, more: usize, place: &Place) -> bool {
        let before = self.names;
        self.names = before.saturating_add(more);
        if self.names <= MEMBER_LIMIT {
            return true;
        }
        if before <= MEMBER_LIMIT {
            self.builder.problems.push(names::too_many_names(place.clone(), MEMBER_LIMIT));
        }
        false
    }

    /// Whether a section of the file has such a key.
    fn is_written(&self, name: &str) -> bool {
        let Node::Map(sections) = self.root.node else { return false };
        sections.iter().any(|(_, section)| match section {
            Node::Map(entries) => entries.iter().any(|(key, _)| key.split('[').next() == Some(name)),
            _ => false,
        })
    }

    /// Whether the limit of names was met.
    pub fn too_many_names(&self) -> bool {
        self.names > MEMBER_LIMIT
    }

    /// Declares one member of a name; false (reported) when the name is taken.
    pub fn declare(&mut self, section: Section, expanded: &Expanded, member: Member, place: &Place) -> bool {
        let place = place.of_key();
        if is_reserved(&expanded.base) {
            let mut proposal = proposal(&expanded.base);
            while self.is_written(&proposal) {
                proposal.push('_');
            }
            self.builder.problems.push(names::reserved_name(place.clone(), &expanded.base, proposal));
            // Declared all the same, so that its uses are not reported too.
        }
        let indices = expanded.indices.len();
        let entry = self.scope.names.entry(expanded.base.clone()).or_insert_with(|| Entry {
            section,
            indices,
            refused: false,
            members: BTreeMap::new(),
        });
        if entry.section != section {
            self.builder.problems.push(names::duplicate_name(place, &expanded.base, entry.section.key()));
            return false;
        }
        if entry.indices != indices {
            self.builder.problems.push(names::duplicate_name(place, &expanded.base, section.key()));
            return false;
        }
        if entry.members.insert(expanded.indices.clone(), member).is_some() {
            self.builder.problems.push(names::member_twice(place, expanded.name()));
            return false;
        }
        true
    }

    /// A family that turned out to be empty still is a name.
    pub fn declare_empty(&mut self, section: Section, family: &Family) {
        let indices = family.key.indices.len();
        self.scope.names.entry(family.key.name.clone()).or_insert_with(|| Entry {
            section,
            indices,
            refused: false,
            members: BTreeMap::new(),
        });
    }

    /// Adds something with a value and returns its place.
    pub fn item(&mut self, name: String, written: Option<Written>, rules: Rules, want: Want, locals: &Locals) -> usize {
        let locals = Rc::clone(locals);
        self.items.push(Item { name, written, rules, want, locals, from: None, axes: Vec::new(), unit: None });
        self.items.len() - 1
    }

    /// A number.
    pub fn scalar(&mut self, text: &Text, rules: Rules, locals: &Locals) -> Option<Id> {
        self.builder.scalar(&self.scope, text, rules, locals)
    }

    /// A vector.
    pub fn vector(&mut self, written: &Written, rules: Rules, locals: &Locals) -> Option<Vec<Id>> {
        self.builder.vector(&self.scope, written, rules, locals)
    }

    /// Reports a label that stands twice in a section.
    pub fn unique(&mut self, seen: &mut BTreeMap<String, ()>, label: &str, section: &str, place: &Place) -> bool {
        if seen.insert(label.to_owned(), ()).is_none() {
            return true;
        }
        self.builder.problems.push(sections::duplicate_label(place.of_key(), label, section));
        false
    }
}

/// Another name for a reserved one.
fn proposal(name: &str) -> String {
    match name {
        "t" => "time".to_owned(),
        "ground" => "floor".to_owned(),
        "length" => "l".to_owned(),
        "energy" => "E".to_owned(),
        "kinetic_energy" => "T".to_owned(),
        "potential_energy" => "V".to_owned(),
        "in" => "inside".to_owned(),
        _ => format!("{name}_"),
    }
}
