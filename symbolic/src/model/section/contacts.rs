//! `friction`, `contacts` and `impacts`: what sticks, opens and strikes by itself (LANGUAGE, section 6).
//!
//! A contact becomes what a person would write by hand: constraints for its gap and its sliding rate, a phase for every combination of what
//! all contacts do, friction that acts while it slides, and the events at which one of them changes.

use std::collections::BTreeSet;

use super::ends::End;
use super::loads::{AttachedTo, Draft, DraftPush, Drafts};
use super::resolve_values::Want;
use super::rubbing::Rub;
use super::springs::Placement;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{contacts, names, sections};
use crate::diagnose::did_you_mean_or;
use crate::expr::{Id, Symbol, vectors};
use crate::file::{Quantity, Spot, Text, Written};
use crate::model::contact::{Contact, ContactMode, ImpactLaw, are_single, modes_of_phases};
use crate::model::event::{Event, EventAction, Trigger};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Locals;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{ConstraintNames, Entry, JointRow, Member, Section};
use crate::model::resolved::{Phase, Work};
use crate::model::resolver::Resolver;

/// Each contact is derived and judged by itself, in time that grows faster than their number: so many take minutes.
const MOST_CONTACTS: usize = 500;

/// A force that is at its limit but for this part of it sticks, some thirty roundings: blocks on each other that are equally rough reach their
/// limits together, and rounding of forces must not decide which slips.
const AT_THE_LIMIT: f64 = 32.0 * f64::EPSILON;

const POINT: Rules = Rules::joint("a point of a contact").si(Dimension::LENGTH);
const NORMAL: Rules = Rules::joint("a contact's normal");
const COEFFICIENT: Rules = Rules::velocity("a coefficient of friction").si(Dimension::ONE);

/// An entry as it was read.
#[derive(Clone)]
pub struct ContactText {
    /// Its expanded name.
    pub(super) name: String,
    /// Its places among the constraints.
    pub(super) normal: Option<usize>,
    pub(super) tangent: Option<usize>,
    /// The first of the held values that are its direction of sliding in space.
    pub(super) direction: Option<usize>,
    /// The item of the rate along the normal.
    pub(super) approach: Option<usize>,
    kind: Kind,
    locals: Locals,
    pub(super) place: Place,
}

impl ContactText {
    /// Whether the file says at which point it acts.
    pub fn says_where(&self) -> bool {
        matches!(&self.kind, Kind::Contact(touching) if touching.at.is_some())
    }
}

/// The items of how the sides of a contact move on each other, and of its normal.
#[derive(Clone, Copy)]
struct ContactRates {
    sliding: usize,
    approach: usize,
    normal: usize,
}

#[derive(Clone)]
enum Kind {
    /// `friction`.
    Friction(Box<FrictionText>),
    /// `contacts`.
    Contact(Box<Touching>),
}

#[derive(Clone)]
struct FrictionText {
    rate: Text,
    limit: Text,
    greatest: Option<Text>,
    placement: Placement,
}

#[derive(Clone)]
struct Touching {
    on: Text,
    from: Option<Text>,
    at: Option<Written>,
    normal: Written,
    friction: Option<Text>,
    greatest: Option<Text>,
    restitution: Option<Quantity>,
}

impl ContactText {
    /// Its constraints, by their places.
    pub fn constraints(&self) -> impl Iterator<Item = usize> {
        [self.normal, self.tangent].into_iter().flatten()
    }

    fn modes(&self) -> &'static [ContactMode] {
        ContactMode::of(self.normal.is_some(), self.tangent.is_some(), self.direction.is_some())
    }
}

impl Resolver<'_> {
    /// The constraints of all contacts, and where they stand.
    pub fn declare_contacts(&mut self, places: &mut Vec<Place>) {
        for section in ["friction", "contacts"] {
            let taken: BTreeSet<String> = self.scope.constraint_names.keys().cloned().collect();
            for (key, spot) in self.section(section) {
                let family = self.expand(key, &spot);
                let base = key.split('[').next().unwrap_or(key).trim().to_owned();
                let reserved = family.is_some() && self.is_no_label(&base, &[], &spot);
                let read = if section == "friction" { self.friction_text(&spot) } else { self.touching(&spot) };
                let indices = family.as_ref().map_or(0, |family| family.key.indices.len());
                let refused = family.is_none() || read.is_none() || reserved;
                let entry = Entry { refused, ..Entry::new(Section::Constraint, indices) };
                self.scope.constraint_names.entry(base.clone()).or_insert(entry);
                if taken.contains(&base) {
                    let sections = "`constraints`, `joints`, `friction` and `contacts`";
                    self.builder.problems.push(sections::duplicate_label(spot.place.of_key(), &base, sections));
                    continue;
                }
                let (Some(family), Some(kind), false) = (family, read, reserved) else { continue };
                for member in &family.members {
                    let name = member.name();
                    let place = self.scope.constraints.len();
                    let entry = self.scope.constraint_names.get_mut(&member.base);
                    if !entry.is_some_and(|entry| entry.add(&member.indices, Member::Constraint(place))) {
                        let section = format!("`{section}`");
                        self.builder.problems.push(sections::duplicate_label(spot.place.of_key(), name, &section));
                        break;
                    }
                    self.declare_contact((&spot, name), kind.clone(), &member.locals);
                    places.extend((place..self.scope.constraints.len()).map(|_| spot.place.clone()));
                }
            }
        }
    }

    fn declare_contact(&mut self, (spot, name): (&Spot<'_>, String), kind: Kind, locals: &Locals) {
        let first = self.scope.constraints.len();
        let (mut approach, mut direction) = (None, None);
        let (normal, tangent) = match &kind {
            Kind::Friction(text) => {
                let written = Some(Written::One(text.rate.clone()));
                let item = self.item(name.clone(), written, Rules::constraint(), Want::Scalar, locals);
                self.scope.constraints.push(ConstraintNames {
                    name: name.clone(),
                    item,
                    first: None,
                    scale: None,
                    across: None,
                });
                (None, Some(first))
            }
            Kind::Contact(text) => {
                let gap = spot.get("gap").and_then(|gap| gap.text(&mut Vec::new()));
                let item = self.item(name.clone(), gap.map(Written::One), Rules::joint("a gap"), Want::Scalar, locals);
                self.scope.constraints.push(ConstraintNames {
                    name: name.clone(),
                    item,
                    first: None,
                    scale: None,
                    across: None,
                });
                let in_space = self.scope.dimension == 3;
                let measured = !in_space || text.friction.is_some();
                let rates = measured.then(|| self.contact_rates(&name, text, locals)).flatten();
                approach = rates.map(|ContactRates { approach, .. }| approach);
                let tangent = text.friction.as_ref().map(|_| {
                    let row = format!("{name}.friction");
                    // Without a value where what is wrong was reported.
                    let unknown = |resolver: &mut Self| {
                        resolver.item(row.clone(), None, Rules::constraint(), Want::Scalar, locals)
                    };
                    let item = rates.map_or_else(|| unknown(self), |ContactRates { sliding, .. }| sliding);
                    let across = rates.filter(|_| in_space).map(|ContactRates { normal, .. }| normal);
                    self.scope.constraints.push(ConstraintNames { name: row, item, first: None, scale: None, across });
                    direction = in_space.then(|| self.hold_direction(&name, &spot.place));
                    first + 1
                });
                (Some(first), tangent)
            }
        };
        let (locals, place) = (locals.clone(), spot.place.clone());
        self.contacts.push(ContactText { name, normal, tangent, direction, approach, kind, locals, place });
    }

    /// The items of a contact's sliding rate and of the rate at which it opens: across and along the normal, of the material of `on` less that
    /// of `from`.
    fn contact_rates(&mut self, name: &str, text: &Touching, locals: &Locals) -> Option<ContactRates> {
        let on = self.body(&text.on, locals);
        let from = text.from.as_ref().map_or(Some(None), |from| self.body(from, locals));
        let at = text.at.clone().unwrap_or_else(|| Written::One(text.on.clone()));
        let at = self.item(format!("the point of {name}"), Some(at), POINT, Want::Vector, locals);
        let normal = Some(text.normal.clone());
        let normal = self.item(format!("the normal of {name}"), normal, NORMAL, Want::Vector, locals);
        let bodies = [on?, from?];
        let rows = [JointRow::Slide { bodies, at, normal }, JointRow::Approach { bodies, at, normal }];
        let rules = Rules::constraint();
        let items = rows.map(|row| self.item(format!("{name}.friction"), None, rules, Want::Joint(row), locals));
        let [sliding, approach] = items;
        Some(ContactRates { sliding, approach, normal })
    }

    /// `{rate: x' - belt, on: block, along: "[1, 0]", limit: F, static: F_s}`.
    fn friction_text(&mut self, spot: &Spot<'_>) -> Option<Kind> {
        let keys = ["rate", "on", "from", "at", "along", "axis", "limit", "static"];
        let problems = &mut self.builder.problems;
        if !spot.only(&keys, "a friction", problems) {
            return None;
        }
        let rate = spot.need("rate", "a friction", problems).and_then(|rate| rate.text(problems));
        let limit = spot.need("limit", "a friction", problems).and_then(|limit| limit.text(problems));
        let greatest = spot.get("static").map(|greatest| greatest.text(problems));
        let placement = self.placement(spot);
        let (rate, limit, placement) = (rate?, limit?, placement?);
        let greatest = match greatest {
            Some(greatest) => Some(greatest?),
            None => None,
        };
        Some(Kind::Friction(Box::new(FrictionText { rate, limit, greatest, placement })))
    }

    /// `{gap: left.y, on: block, at: left, normal: "[0, 1]", friction: mu, restitution: e}`.
    fn touching(&mut self, spot: &Spot<'_>) -> Option<Kind> {
        let keys = ["gap", "on", "from", "at", "normal", "friction", "static", "restitution"];
        let problems = &mut self.builder.problems;
        if !spot.only(&keys, "a contact", problems) {
            return None;
        }
        if let (None, Some(greatest)) = (spot.get("friction"), spot.get("static")) {
            problems.push(sections::needs_another_key(greatest.place.of_key(), "static", "friction", "this entry"));
            return None;
        }
        let gap = spot.need("gap", "a contact", problems).and_then(|gap| gap.text(problems));
        let on = spot.need("on", "a contact", problems).and_then(|on| on.text(problems));
        let normal = spot.need("normal", "a contact", problems).and_then(|normal| normal.written(problems));
        let mut text = |key: &str| spot.optional(key, |spot| spot.text(problems));
        let (from, friction, greatest) = (text("from"), text("friction"), text("static"));
        let restitution = spot.optional("restitution", |restitution| restitution.quantity(problems));
        let at = spot.optional("at", |at| at.written(problems));
        gap?;
        Some(Kind::Contact(Box::new(Touching {
            on: on?,
            from: from?,
            at: at?,
            normal: normal?,
            friction: friction?,
            greatest: greatest?,
            restitution: restitution?,
        })))
    }

    /// A phase for each combination of what the contacts do, or where these are too many for what each does alone, with the constraints that hold
    /// then; false where the file has no contacts.
    pub fn phases_of_contacts(&mut self) -> bool {
        let Some(first) = ["friction", "contacts"].into_iter().find_map(|key| self.root.get(key)) else { return false };
        let place = first.place.of_key();
        if let Some(phases) = self.root.get("phases") {
            self.builder.problems.push(contacts::phases_beside_contacts(phases.place.of_key()));
        }
        let of = self.modes_of_contacts();
        let always = |place: &usize| {
            !self.contacts.iter().any(|contact| [contact.normal, contact.tangent].contains(&Some(*place)))
        };
        let always: Vec<usize> = (0..self.scope.constraints.len()).filter(always).collect();
        if self.contacts.len() > MOST_CONTACTS {
            let count = self.contacts.len();
            self.builder.problems.push(contacts::too_many_contacts(place.clone(), count, MOST_CONTACTS));
            self.model.phases = vec![Phase { name: String::new(), constraints: always, place }];
            self.contacts.clear();
            return true;
        }
        let single = are_single(&of);
        self.model.phases.clear();
        for modes in modes_of_phases(&of) {
            let all = self.contacts.iter().zip(&modes).zip(&of);
            // Of single contacts only what one does otherwise than at first is said.
            let said = all.filter(|((_, mode), of)| !single || **mode != of[0]);
            let mut name: Vec<String> = said.map(|((c, mode), _)| format!("{} {}", c.name, mode.words())).collect();
            if name.is_empty() {
                name.push("all open".to_owned());
            }
            let mut constraints = always.clone();
            for (contact, mode) in self.contacts.iter().zip(&modes) {
                constraints.extend(contact.normal.filter(|_| mode.touches()));
                constraints.extend(contact.tangent.filter(|_| *mode == ContactMode::Sticks));
            }
            let place = place.clone();
            self.model.phases.push(Phase { name: name.join(", "), constraints, place });
        }
        true
    }

    fn modes_of_contacts(&self) -> Vec<&'static [ContactMode]> {
        self.contacts.iter().map(ContactText::modes).collect()
    }

    /// The phases in which a contact is in one of these modes.
    pub(super) fn phases_with(&self, contact: usize, is: impl Fn(ContactMode) -> bool) -> Vec<usize> {
        let phases = modes_of_phases(&self.modes_of_contacts()).into_iter().enumerate();
        phases.filter(|(_, modes)| is(modes[contact])).map(|(phase, _)| phase).collect()
    }

    /// The phases that an entry names by what contacts do in them: `rub sticks`, or `rub sticks, left slips forwards`, or a list of these.
    pub(super) fn phases_in_words(&mut self, spot: &Spot<'_>) -> Option<Vec<usize>> {
        let mut found = Vec::new();
        for item in spot.items().unwrap_or_else(|| vec![spot.clone()]) {
            let words = item.words(&mut self.builder.problems)?;
            let mut phases: Vec<usize> = (0..self.model.phases.len()).collect();
            for said in words.split(',').map(str::trim) {
                let with = self.phases_in_which(said, &item.place)?;
                phases.retain(|phase| with.contains(phase));
            }
            if phases.is_empty() {
                self.builder.problems.push(sections::two_modes(item.place.clone(), words));
                return None;
            }
            found.extend(phases);
        }
        found.sort_unstable();
        found.dedup();
        if found.is_empty() {
            self.builder.problems.push(sections::empty_list(spot.place.of_key(), "phase", "phase"));
        }
        (!found.is_empty()).then_some(found)
    }

    /// The phases in which one contact is as `rub sticks` says.
    fn phases_in_which(&mut self, said: &str, place: &Place) -> Option<Vec<usize>> {
        let all: Vec<(usize, ContactMode)> =
            self.contacts.iter().enumerate().flat_map(|(k, c)| c.modes().iter().map(move |mode| (k, *mode))).collect();
        let names: Vec<String> =
            all.iter().map(|(k, mode)| format!("{} {}", self.contacts[*k].name, mode.words())).collect();
        if let Some(found) = names.iter().position(|name| name == said) {
            let (contact, mode) = all[found];
            return Some(self.phases_with(contact, |other| other == mode));
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let help = did_you_mean_or(said, &names);
        self.builder.problems.push(names::unknown_phase(place.clone(), said, help));
        None
    }

    /// The sign of the sliding rate while it slides, else 0.
    fn sign_of_sliding(&mut self, contact: usize) -> Id {
        let forwards = self.phases_with(contact, |mode| mode == ContactMode::SlipsForwards);
        let backwards = self.phases_with(contact, |mode| mode == ContactMode::SlipsBackwards);
        let (forwards, backwards) = (self.indicator(&forwards), self.indicator(&backwards));
        self.builder.graph.sub(forwards, backwards)
    }

    /// The multiplier of a constraint with one row.
    pub(super) fn multiplier_of(&mut self, constraint: usize) -> Id {
        let row = self.model.constraints.get(constraint).map_or(0, |constraint| constraint.first);
        self.builder.graph.symbol(Symbol::Multiplier(row as u32))
    }

    /// The forces of all contacts: friction that slides, and for balances what constraints push with.
    pub fn contact_loads(&mut self, drafts: &mut Drafts) {
        for k in 0..self.contacts.len() {
            let contact = self.contacts[k].clone();
            let draft = match &contact.kind {
                Kind::Friction(text) => self.friction_load((k, &contact), text, drafts),
                Kind::Contact(text) => self.touching_load((k, &contact), text, drafts),
            };
            drafts.loads.extend(draft);
        }
    }

    /// The two limits of a friction: while it slides, and while it sticks.
    fn limits(&mut self, text: &FrictionText, locals: &Locals) -> Option<[Id; 2]> {
        let rules = Rules::mechanical("a rate").like(self.scope.units.rate(text.placement.unit(self)));
        self.scalar(&text.rate, rules, locals)?;
        let unit = self.scope.units.of(Dimension::POWER).over(self.builder.measured);
        let rules = Rules::load("the limit of a friction").like(unit);
        let limit = self.scalar(&text.limit, rules, locals);
        let greatest = text.greatest.as_ref().map_or(limit, |greatest| self.scalar(greatest, rules, locals));
        Some([limit?, greatest?])
    }

    fn friction_load(
        &mut self,
        (k, contact): (usize, &ContactText),
        text: &FrictionText,
        drafts: &mut Drafts,
    ) -> Option<Draft> {
        let [limit, _] = self.limits(text, &contact.locals)?;
        let (sign, held) = (self.sign_of_sliding(k), self.multiplier_of(contact.tangent?));
        let rate = self.value_of(contact.tangent?)?;
        let tension = self.builder.graph.mul(sign, limit);
        let whole = self.builder.graph.sub(tension, held);
        let pushes = self.placed_pushes(&text.placement, whole, &contact.locals, drafts)?;
        let work = Work::Resistance { rate, tension };
        Some(Draft { name: contact.name.clone(), work, pushes, place: contact.place.clone() })
    }

    fn touching_load(
        &mut self,
        (k, contact): (usize, &ContactText),
        text: &Touching,
        drafts: &mut Drafts,
    ) -> Option<Draft> {
        let locals = &contact.locals;
        let across = self.force_across(contact.normal?);
        let normal = self.vector(&text.normal, NORMAL, locals)?;
        let normal = vectors::unit(&mut self.builder.graph, &normal);
        let mut force = vectors::scaled(&mut self.builder.graph, across, &normal);
        let mut beside = None;
        let work = match (contact.tangent, &text.friction) {
            (Some(tangent), Some(friction)) if contact.direction.is_some() => {
                let coefficient = self.scalar(friction, COEFFICIENT, locals)?;
                let tension = self.builder.graph.mul(coefficient, across);
                let [first, second] = self.rub_in_space((k, contact), tangent, &normal, tension)?;
                force = vectors::add(&mut self.builder.graph, &force, &first.force);
                beside = Some(second);
                first.work
            }
            (Some(tangent), Some(friction)) => {
                let coefficient = self.scalar(friction, COEFFICIENT, locals)?;
                let (sign, held) = (self.sign_of_sliding(k), self.multiplier_of(tangent));
                let rate = self.value_of(tangent)?;
                let graph = &mut self.builder.graph;
                let tension = graph.mul(coefficient, across);
                let tension = graph.mul(sign, tension);
                let along = graph.sub(held, tension);
                let &[x, y] = normal.as_slice() else { return None };
                let tangent = [y, graph.neg(x)];
                let rub = vectors::scaled(graph, along, &tangent);
                force = vectors::add(graph, &force, &rub);
                Work::Resistance { rate, tension }
            }
            _ => Work::Resistance { rate: Id::ZERO, tension: Id::ZERO },
        };
        let end = self.placed(&text.on, text.at.as_ref(), locals, drafts)?;
        if let Some(Rub { force, work }) = beside {
            let pushes = self.both_sides(text.from.as_ref(), &end, force, locals)?;
            drafts.loads.push(Draft { name: contact.name.clone(), work, pushes, place: contact.place.clone() });
        }
        let pushes = self.both_sides(text.from.as_ref(), &end, force, locals)?;
        Some(Draft { name: contact.name.clone(), work, pushes, place: contact.place.clone() })
    }

    /// A force at one end, and its opposite on what is across.
    fn both_sides(
        &mut self,
        from: Option<&Text>,
        end: &End,
        force: Vec<Id>,
        locals: &Locals,
    ) -> Option<Vec<DraftPush>> {
        let minus = vectors::negative(&mut self.builder.graph, &force);
        let push = |attached: AttachedTo, at: Vec<Id>, force| DraftPush { attached, at, force, couple: Vec::new() };
        let mut pushes = vec![push(end.attached.clone(), end.at.clone(), force)];
        if let Some(from) = from {
            let opposite = self.opposite(from, &end.at, locals)?;
            pushes.push(push(opposite.attached, opposite.at, minus));
        }
        Some(pushes)
    }

    /// The value of a constraint with one row.
    pub(super) fn value_of(&self, constraint: usize) -> Option<Id> {
        self.model.constraints.get(constraint)?.value.first().copied()
    }

    /// `impacts`, and the events at which contacts change.
    pub fn contact_events(&mut self) {
        self.impact_law();
        for k in 0..self.contacts.len() {
            let contact = self.contacts[k].clone();
            let first_event = self.model.events.len();
            if let Some(normal) = contact.normal {
                let open = self.phases_with(k, |mode| !mode.touches());
                let touching = self.phases_with(k, ContactMode::touches);
                let (Some(gap), force) = (self.value_of(normal), self.multiplier_of(normal)) else { continue };
                self.contact_event((k, &contact, "lands"), (gap, -1), open);
                self.contact_event((k, &contact, "lifts"), (force, -1), touching);
            }
            if let Some(tangent) = contact.tangent {
                let Some(rate) = self.rate_of_sliding(&contact, tangent) else { continue };
                let Some(margin) = self.margin(&contact) else { continue };
                let sliding = self.phases_with(k, ContactMode::slips);
                let sticking = self.phases_with(k, |mode| mode == ContactMode::Sticks);
                self.contact_event((k, &contact, "stops"), (rate, 0), sliding);
                self.contact_event((k, &contact, "slips"), (margin, -1), sticking);
            }
            let restitution = match &contact.kind {
                Kind::Friction(_) => None,
                Kind::Contact(text) => Some(match &text.restitution {
                    None => Id::ZERO,
                    Some(text) => match self.coefficient_of_restitution(text, &contact.locals) {
                        Some(e) => e,
                        None => continue,
                    },
                }),
            };
            let ContactText { name, normal, tangent, direction, place, .. } = contact;
            self.model.contacts.push(Contact { name, normal, tangent, direction, restitution, first_event, place });
        }
    }

    /// L₀² − T², with a limit that is larger by [`AT_THE_LIMIT`].
    fn margin(&mut self, contact: &ContactText) -> Option<Id> {
        let greatest = match &contact.kind {
            Kind::Friction(text) => self.limits(text, &contact.locals)?[1],
            Kind::Contact(text) => {
                let coefficient = text.greatest.as_ref().or(text.friction.as_ref())?;
                let coefficient = self.scalar(coefficient, COEFFICIENT, &contact.locals)?;
                let across = self.force_across(contact.normal?);
                self.builder.graph.mul(coefficient, across)
            }
        };
        let tangent = contact.tangent?;
        let held = self.model.constraints.get(tangent)?.rows().map(|row| Symbol::Multiplier(row as u32));
        let graph = &mut self.builder.graph;
        let held: Vec<Id> = held.map(|multiplier| graph.symbol(multiplier)).collect();
        let (greatest, held) = (graph.mul(greatest, greatest), vectors::dot(graph, &held, &held));
        let beyond = graph.float(1.0 + 2.0 * AT_THE_LIMIT);
        let greatest = graph.mul(beyond, greatest);
        Some(graph.sub(greatest, held))
    }

    fn contact_event(
        &mut self,
        (k, contact, what): (usize, &ContactText, &str),
        (when, direction): (Id, i8),
        phases: Vec<usize>,
    ) {
        let name = format!("{} {what}", contact.name);
        self.model.events.push(Event {
            name,
            trigger: Trigger::Zero,
            when,
            condition: None,
            direction,
            phases: Some(phases),
            actions: vec![EventAction::Contact(k)],
            place: contact.place.clone(),
        });
    }

    fn impact_law(&mut self) {
        let Some(spot) = self.root.get("impacts") else { return };
        let laws =
            [("sequential", ImpactLaw::Sequential), ("together", ImpactLaw::Together), ("poisson", ImpactLaw::Poisson)];
        let Some(words) = spot.words(&mut self.builder.problems) else { return };
        match laws.iter().find(|(name, _)| *name == words) {
            Some((_, law)) => self.model.impacts = Some(*law),
            None => {
                let help = did_you_mean_or(words, &laws.map(|(name, _)| name));
                let problem = sections::unknown_choice(spot.place.clone(), words, "a law of impacts", help);
                self.builder.problems.push(problem);
            }
        }
    }
}
