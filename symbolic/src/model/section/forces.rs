//! `forces` and `torques`.

use super::ends::End;
use super::loads::{AttachedTo, Draft, DraftPush, Drafts};
use crate::diagnose::Place;
use crate::diagnose::catalogue::{names, sections};
use crate::expr::{Id, vectors};
use crate::file::{Spot, Text, Written};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::{Family, Locals};
use crate::model::expression::rules::Rules;
use crate::model::resolved::Work;
use crate::model::resolver::Resolver;

impl Resolver<'_> {
    /// One entry of `forces`.
    pub fn force(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        if !self.load_keys(spot, &["on", "at", "force", "from", "reaction"], "a force", family) {
            return;
        }
        let problems = &mut self.builder.problems;
        if let (Some(_), Some(reaction)) = (spot.get("from"), spot.get("reaction")) {
            problems.push(sections::conflicting_keys(reaction.place.of_key(), "from", "reaction", "a force"));
            return;
        }
        let on = spot.need("on", "a force", problems).and_then(|on| on.written(problems));
        let force = spot.need("force", "a force", problems).and_then(|force| force.written(problems));
        let mut given = |key: &str| spot.optional(key, |spot| spot.written(problems));
        let (at, reaction) = (given("at"), given("reaction"));
        let from = spot.optional("from", |from| from.text(problems));
        let (Some(on), Some(force), Some(at), Some(reaction), Some(from)) = (on, force, at, reaction, from) else {
            return;
        };
        for member in &family.members {
            let locals = &member.locals;
            let end = self.force_end(&on, at.as_ref(), locals, drafts);
            let force = self.vector(&force, Rules::load("a force").si(Dimension::FORCE), locals);
            let (Some(end), Some(force)) = (end, force) else { continue };
            let opposite = match (&from, &reaction) {
                (Some(from), _) => self.opposite(from, &end.at, locals),
                (None, Some(reaction)) => self.point_or_body(reaction, locals, drafts),
                (None, None) => Some(End { attached: AttachedTo::Ground, at: end.at.clone() }),
            };
            let Some(opposite) = opposite else { continue };
            let minus = vectors::negative(&mut self.builder.graph, &force);
            let mut pushes = vec![DraftPush { attached: end.attached, at: end.at, force, couple: Vec::new() }];
            if from.is_some() || reaction.is_some() {
                pushes.push(DraftPush {
                    attached: opposite.attached,
                    at: opposite.at,
                    force: minus,
                    couple: Vec::new(),
                });
            }
            let place = spot.place.clone();
            drafts.loads.push(Draft { name: member.name(), work: Work::Pushes, pushes, place });
        }
    }

    /// `on: B` with or without `at`, or `on: P`.
    fn force_end(&mut self, on: &Written, at: Option<&Written>, locals: &Locals, drafts: &mut Drafts) -> Option<End> {
        match (on, at) {
            (Written::One(text), at) if self.is_solid(text) => self.placed(text, at, locals, drafts),
            // With `at` the name must be a body's; this reports that it is none.
            (Written::One(text), Some(at)) => self.placed(text, Some(at), locals, drafts),
            (_, _) => self.point_or_body(on, locals, drafts),
        }
    }

    /// One entry of `torques`.
    pub fn torque(&mut self, spot: &Spot<'_>, family: &Family, drafts: &mut Drafts) {
        if !self.load_keys(spot, &["on", "torque", "from"], "a torque", family) {
            return;
        }
        let problems = &mut self.builder.problems;
        let on = spot.need("on", "a torque", problems).and_then(|on| on.text(problems));
        let torque = spot.need("torque", "a torque", problems).and_then(|torque| torque.written(problems));
        let from = spot.optional("from", |from| from.text(problems));
        let (Some(on), Some(torque), Some(from)) = (on, torque, from) else { return };
        for member in &family.members {
            let torque = self.moment_of_couple(&torque, &member.locals);
            let on = self.couple_holder(&on, &member.locals);
            let from = match &from {
                Some(from) => self.couple_holder(from, &member.locals),
                None => Some(None),
            };
            let (Some(torque), Some(on), Some(from)) = (torque, on, from) else { continue };
            let minus = vectors::negative(&mut self.builder.graph, &torque);
            let pushes = [(on, torque), (from, minus)]
                .into_iter()
                .filter_map(|(body, couple)| body.map(|(body, at)| self.couple(body, at, couple)))
                .collect();
            let place = spot.place.clone();
            drafts.loads.push(Draft { name: member.name(), work: Work::Pushes, pushes, place });
        }
    }

    /// The rigid body that takes a couple, with its centre of mass; inside, `None` is the ground.
    fn couple_holder(&mut self, text: &Text, locals: &Locals) -> Option<Option<(usize, Vec<Id>)>> {
        match self.rigid_body(text, "a torque", locals)? {
            None => Some(None),
            Some(body) => Some(Some((body, self.centre(body)?))),
        }
    }

    /// One component in the plane, three in space.
    fn moment_of_couple(&mut self, torque: &Written, locals: &Locals) -> Option<Vec<Id>> {
        let rules = Rules::load("a torque").si(Dimension::ENERGY);
        match torque {
            _ if self.scope.dimension == 3 => self.vector(torque, rules, locals),
            Written::One(text) => Some(vec![self.scalar(text, rules, locals)?]),
            Written::List(_, place) => {
                self.builder.problems.push(names::not_a_scalar(Place::clone(place), "a list"));
                None
            }
        }
    }

    fn couple(&self, body: usize, at: Vec<Id>, couple: Vec<Id>) -> DraftPush {
        DraftPush { attached: AttachedTo::Body(body), at, force: vec![Id::ZERO; self.scope.dimension], couple }
    }
}
