//! `reactions` of `balances`: unknown forces and couples by name.

use std::collections::BTreeMap;

use super::loads::{AttachedTo, Drafts};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{names, sections};
use crate::expr::{Id, vectors};
use crate::file::{Node, Spot};
use crate::model::expression::families::Locals;
use crate::model::expression::radians;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::resolved::{Push, Reaction};
use crate::model::resolver::Resolver;

/// A reaction of one system, as pushes on bodies.
pub struct Unknown {
    /// Its expanded name.
    pub name: String,
    /// The reaction, and its opposite where it has one.
    pub pushes: Vec<Push>,
    /// Its components along the directions in which it is free: zero.
    pub free: Vec<Id>,
    /// Where it stands.
    pub place: Place,
}

impl<'a> Resolver<'a> {
    /// The names of unknown reactions.
    pub fn reactions(&mut self) {
        let mut declared: BTreeMap<String, &Node> = BTreeMap::new();
        let mut symbols = 0;
        for (_, system) in self.balance_systems() {
            let Some(list) = system.get("reactions") else { continue };
            for (key, spot) in list.entries(&mut self.builder.problems) {
                if let Some(known) = declared.get(key) {
                    if *known != spot.node {
                        self.builder.problems.push(names::duplicate_name(spot.place.of_key(), key, "reactions"));
                    }
                    continue;
                }
                declared.insert(key.to_owned(), spot.node);
                let Some(family) = self.expand_declared(key, &spot, Section::Reaction) else { continue };
                let couple = spot.get("couple").is_some();
                let scalar = spot.get("along").is_some() || (couple && self.scope.dimension == 2);
                let components = if scalar { 1 } else { self.scope.dimension };
                for member in &family.members {
                    let place = self.scope.reactions.len();
                    if self.declare(Section::Reaction, member, Member::Reaction(place), &spot.place) {
                        if couple {
                            self.scope.units.radians.insert(member.base.clone(), radians::TORQUE);
                        }
                        let reaction = Reaction { name: member.name(), first: symbols, components, scalar, couple };
                        self.scope.reactions.push(reaction);
                        symbols += components as u32;
                    }
                }
            }
        }
        self.model.reactions.clone_from(&self.scope.reactions);
    }

    /// A system's reactions as pushes of their symbols.
    pub fn unknowns(&mut self, system: &Spot<'a>) -> Vec<Unknown> {
        let (mut unknowns, mut drafts) = (Vec::new(), Drafts::default());
        let Some(list) = system.get("reactions") else { return unknowns };
        for (key, spot) in list.entries(&mut self.builder.problems) {
            if !spot.only(&["on", "at", "along", "from", "couple", "free"], "a reaction", &mut self.builder.problems) {
                continue;
            }
            let Some(family) = self.expand(key, &spot) else { continue };
            for member in &family.members {
                unknowns.extend(self.unknown(&spot, &member.name(), &member.locals, &mut drafts));
            }
        }
        self.carried(&drafts.wanted);
        unknowns
    }

    fn unknown(&mut self, spot: &Spot<'_>, name: &str, locals: &Locals, drafts: &mut Drafts) -> Option<Unknown> {
        let reaction = self.scope.reactions.iter().find(|r| r.name == name)?.clone();
        let problems = &mut self.builder.problems;
        let on = spot.need("on", "a reaction", problems)?.text(problems)?;
        let mut written = |key: &str| spot.optional(key, |spot| spot.written(problems));
        let (at, along) = (written("at")?, written("along")?);
        let from = spot.optional("from", |from| from.text(problems))?;
        let symbols: Vec<Id> = reaction.symbols().map(|symbol| self.builder.graph.symbol(symbol)).collect();
        let couple = spot.get("couple").is_some();
        let end = self.placed(&on, at.as_ref(), locals, drafts)?;
        let opposite = match &from {
            Some(from) => Some(self.opposite(from, &end.at, locals)?),
            None => None,
        };
        let direction = match &along {
            Some(along) => {
                let vector = self.vector(along, Rules::velocity("a direction"), locals)?;
                Some(vectors::unit(&mut self.builder.graph, &vector))
            }
            None => None,
        };
        if direction.is_none() && reaction.scalar && !(couple && self.scope.dimension == 2) {
            // Another system describes it otherwise (reported).
            return None;
        }
        let full = match direction {
            Some(direction) => direction.iter().map(|e| self.builder.graph.mul(symbols[0], *e)).collect(),
            None => symbols,
        };
        let free = self.free(spot, &full, locals)?;
        let minus = vectors::negative(&mut self.builder.graph, &full);
        let zero = vec![Id::ZERO; self.scope.dimension];
        let mut pushes = Vec::new();
        for (end, load) in std::iter::once((end, full)).chain(opposite.map(|end| (end, minus))) {
            let AttachedTo::Body(body) = end.attached else { continue };
            let (force, couple) = if couple { (zero.clone(), load) } else { (load, Vec::new()) };
            pushes.push(Push { body: Some(body), at: end.at, force, couple });
        }
        Some(Unknown { name: name.to_owned(), pushes, free, place: spot.place.clone() })
    }

    /// The components of a reaction along the directions of `free`, one or a list of them.
    fn free(&mut self, spot: &Spot<'_>, reaction: &[Id], locals: &Locals) -> Option<Vec<Id>> {
        let Some(free) = spot.get("free") else { return Some(Vec::new()) };
        if spot.get("along").is_some() || reaction.len() < self.scope.dimension {
            let place = free.place.of_key();
            self.builder.problems.push(match spot.get("along") {
                Some(_) => sections::conflicting_keys(place, "along", "free", "a reaction"),
                None => sections::unknown_key(place, "free", "a couple in the plane", String::new()),
            });
            return None;
        }
        let mut rows = Vec::new();
        // A list of expressions is a list of directions; one of numbers would be a direction, which an expression can say as well.
        for direction in free.items().unwrap_or_else(|| vec![free.clone()]) {
            let written = direction.written(&mut self.builder.problems)?;
            let direction = self.vector(&written, Rules::velocity("a direction"), locals)?;
            let unit = vectors::unit(&mut self.builder.graph, &direction);
            rows.push(vectors::dot(&mut self.builder.graph, reaction, &unit));
        }
        Some(rows)
    }
}
