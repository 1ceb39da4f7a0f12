//! `events`: what happens along a run, and what follows (LANGUAGE, section 6).

use std::collections::BTreeMap;

use crate::diagnose::catalogue::{mechanics, memory, names, sections};
use crate::diagnose::{Place, did_you_mean_or, nearest, quoted};
use crate::expr::Id;
use crate::file::{Node, Quantity, Spot, Text};
use crate::language::{AstKind, parse};
use crate::model::event::{Event, EventAction, Trigger};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Section;
use crate::model::resolver::Resolver;

/// When an event happens, as written.
enum Cause<'a> {
    /// Where a function is zero.
    Zero(Text),
    /// At the ticks of a period, with the first of them.
    Ticks(Spot<'a>, Option<Spot<'a>>),
    /// When something was set.
    Set(Spot<'a>),
}

const RESTITUTION: Rules = Rules::constant("a coefficient of restitution").si(Dimension::ONE);

impl Resolver<'_> {
    /// `events`.
    pub fn events(&mut self) {
        let mut seen = BTreeMap::new();
        for (key, spot) in self.section("events") {
            let Some(family) = self.expand(key, &spot) else { continue };
            let problems = &mut self.builder.problems;
            if !spot.only(
                &["when", "every", "on_set", "direction", "from", "if", "then", "phase"],
                "an event",
                problems,
            ) {
                continue;
            }
            let condition = spot.get("if").and_then(|condition| condition.text(problems));
            let direction = spot.get("direction").map_or(0, |direction| self.direction(&direction));
            let Some(cause) = self.cause(&spot, &family.key.name) else { continue };
            let then = spot.need("then", "an event", &mut self.builder.problems);
            for member in &family.members {
                let name = member.name();
                if self.scope.names.get(&member.base).is_some_and(|entry| entry.section == Section::Noise) {
                    let problem = sections::duplicate_label(spot.place.of_key(), &name, "`noise` and `events`");
                    self.builder.problems.push(problem);
                    break;
                }
                if !self.unique(&mut seen, &name, "`events`", &spot.place) {
                    break;
                }
                let rules = Rules::anything("an event");
                let phases = self.phase_key(&spot, &member.locals);
                let active = phases.clone().flatten().unwrap_or_else(|| (0..self.model.phases.len()).collect());
                let actions = then.as_ref().map(|then| self.actions(then, &active, &member.locals));
                let happens = self.happens(&cause, &name, &member.locals);
                let condition = condition.as_ref().and_then(|text| self.scalar(text, rules, &member.locals));
                let (Some((trigger, when)), Some(phases)) = (happens, phases) else { continue };
                let actions = actions.unwrap_or_default();
                let place = spot.place.clone();
                self.model.events.push(Event { name, trigger, when, condition, direction, phases, actions, place });
            }
        }
    }

    /// What an entry says of when it happens; a key of another kind of event is reported.
    fn cause<'a>(&mut self, spot: &Spot<'a>, name: &str) -> Option<Cause<'a>> {
        let problems = &mut self.builder.problems;
        let (when, every, on_set) = (spot.get("when"), spot.get("every"), spot.get("on_set"));
        let cause = match (when, every, on_set) {
            (Some(when), None, None) => Cause::Zero(when.text(problems)?),
            (None, Some(every), None) => Cause::Ticks(every, spot.get("from")),
            (None, None, Some(on_set)) => Cause::Set(on_set),
            (None, None, None) if spot.misspelt(problems) => return None,
            (None, None, None) => {
                problems.push(sections::missing_key(spot.place.of_key(), "when", "an event"));
                return None;
            }
            _ => {
                problems.push(memory::unclear_trigger(spot.place.of_key(), name));
                return None;
            }
        };
        for (key, of, fits) in [
            ("direction", "when", matches!(cause, Cause::Zero(_))),
            ("from", "every", matches!(cause, Cause::Ticks(..))),
        ] {
            if let Some(other) = spot.get(key).filter(|_| !fits) {
                problems.push(memory::key_of_other_trigger(other.place.of_key(), key, of));
            }
        }
        Some(cause)
    }

    /// What makes a member of a family of events happen, and its function.
    fn happens(&mut self, cause: &Cause<'_>, name: &str, locals: &Locals) -> Option<(Trigger, Id)> {
        match cause {
            Cause::Zero(when) => {
                let value = self.scalar(when, Rules::anything("an event"), locals)?;
                if !self.builder.graph.symbols([value]).iter().any(|symbol| symbol.may_change()) {
                    let place = when.place.at(when.ast.span);
                    self.builder.problems.push(mechanics::never_happens(place, name));
                    return None;
                }
                Some((Trigger::Zero, value))
            }
            Cause::Ticks(every, from) => Some((Trigger::Tick(self.clock(every, from.as_ref(), locals)?), Id::ONE)),
            Cause::Set(names) => Some((Trigger::Set(self.set_names(names, locals)?), Id::ONE)),
        }
    }

    fn direction(&mut self, spot: &Spot<'_>) -> i8 {
        match spot.words(&mut self.builder.problems) {
            Some("rising") => 1,
            Some("falling") => -1,
            Some("both") | None => 0,
            Some(other) => {
                let help = did_you_mean_or(other, &["rising", "falling", "both"]);
                let problem = sections::unknown_choice(spot.place.clone(), other, "a direction", help);
                self.builder.problems.push(problem);
                0
            }
        }
    }

    /// What an event that counts in some phases does.
    fn actions(&mut self, then: &Spot<'_>, active: &[usize], locals: &Locals) -> Vec<EventAction> {
        let items = then.items().unwrap_or_else(|| vec![then.clone()]);
        if items.is_empty() {
            self.builder.problems.push(sections::empty_list(then.place.of_key(), "then", "action"));
        }
        let mut actions: Vec<EventAction> = Vec::new();
        for item in items {
            let action = match item.node {
                Node::Map(_) if item.get("set").is_some() => self.set_action(&item, locals),
                Node::Map(_) => self.impact(&item, active, locals),
                _ => self.action(&item, locals),
            };
            let goes_on = |action: &EventAction| matches!(action, EventAction::Phase(_));
            if action.as_ref().is_some_and(goes_on) && actions.iter().any(goes_on) {
                self.builder.problems.push(sections::two_phases(item.place.clone()));
            }
            actions.extend(action);
        }
        actions
    }

    /// `stop`, `record` or a phase.
    fn action(&mut self, item: &Spot<'_>, locals: &Locals) -> Option<EventAction> {
        let words = item.words(&mut self.builder.problems)?;
        match words {
            "stop" => return Some(EventAction::Stop),
            "record" => return Some(EventAction::Record),
            _ => {}
        }
        let phase = parse(words).is_ok_and(|ast| match &ast.kind {
            AstKind::Name { name, .. } => self.scope.phase_names.contains_key(name),
            _ => false,
        });
        if phase {
            return self.one_phase(item, locals).map(EventAction::Phase);
        }
        let phases = self.scope.phase_names.keys().map(String::as_str);
        let known: Vec<&str> = ["stop", "record"].into_iter().chain(phases).collect();
        let near = nearest(words, known.iter().copied()).map(|near| format!("did you mean `{near}`?"));
        let help = near.unwrap_or_else(|| {
            let words = quoted(&known);
            format!("it is one of {words}, or `{{impact: e, along: c}}` where something strikes, or `{{set: {{name: value}}}}`")
        });
        let what = "something that an event can do";
        self.builder.problems.push(sections::unknown_choice(item.place.clone(), words, what, help));
        None
    }

    /// `{impact: e, along: c}`.
    fn impact(&mut self, item: &Spot<'_>, active: &[usize], locals: &Locals) -> Option<EventAction> {
        let problems = &mut self.builder.problems;
        item.only(&["impact", "along"], "an impact", problems);
        let restitution = item.need("impact", "an impact", problems);
        let along = item.need("along", "an impact", problems);
        let restitution = restitution.and_then(|spot| self.restitution(&spot, locals));
        let along = along.and_then(|spot| {
            let text = spot.text(&mut self.builder.problems)?;
            let along = self.place(&text, locals, Section::Constraint)?;
            let looked_at: usize = active.iter().map(|phase| self.model.phases[*phase].constraints.len()).sum();
            if !self.builder.spend(looked_at as u64 / 64, &spot.place) {
                return None;
            }
            let constraint = self.model.constraints.get(along)?;
            let held = active.iter().all(|phase| self.model.phases[*phase].constraints.contains(&along));
            let problem = if !constraint.holonomic {
                mechanics::impact_along_velocity(spot.place, &constraint.name)
            } else if held {
                mechanics::impact_along_active(spot.place, &constraint.name)
            } else {
                return Some(along);
            };
            self.builder.problems.push(problem);
            None
        });
        Some(EventAction::Impact { restitution: restitution?, along: along? })
    }

    fn restitution(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<Id> {
        let quantity = spot.quantity(&mut self.builder.problems)?;
        self.coefficient_of_restitution(&quantity, locals)
    }

    /// A coefficient of restitution: of parameters, and in 0..1 in every scene.
    pub fn coefficient_of_restitution(&mut self, quantity: &Quantity, locals: &Locals) -> Option<Id> {
        let value = self.setting(quantity, RESTITUTION, locals)?;
        let at = &quantity.text.place;
        let constant = self.builder.graph.number(value).is_some();
        for scene in 0..if constant { 1 } else { self.model.scenes.len() } {
            if !self.builder.spend(1 + self.builder.graph.len() as u64 / 1024, at) {
                return None;
            }
            let parameters = if constant { Vec::new() } else { self.scene_parameters(&self.model.scenes[scene]) };
            let problem = match crate::model::command::evaluate(&self.builder.graph, value, &parameters) {
                Some(e) if (0.0..=1.0).contains(&e) => continue,
                Some(e) => mechanics::value_out_of_range(Place::clone(at), RESTITUTION.what, "in 0..1", e),
                None => names::undefined_value(Place::clone(at), &quantity.text.source),
            };
            self.builder.problems.push(problem);
            return None;
        }
        Some(value)
    }

    /// Constraints that act in no phase, nor in an impact, are doubtful.
    pub fn idle_constraints(&mut self) {
        let mut idle = vec![true; self.model.constraints.len()];
        for place in self.model.phases.iter().flat_map(|phase| &phase.constraints) {
            idle[*place] = false;
        }
        for action in self.model.events.iter().flat_map(|event| &event.actions) {
            if let EventAction::Impact { along, .. } = action {
                idle[*along] = false;
            }
        }
        for (constraint, _) in self.model.constraints.iter().zip(idle).filter(|(_, idle)| *idle) {
            let place = constraint.place.of_key();
            // Members of a family are told of once.
            if self.model.warnings.last().is_none_or(|last| last.place != place) {
                self.model.warnings.push(mechanics::idle_constraint(place, &constraint.name));
            }
        }
    }
}
