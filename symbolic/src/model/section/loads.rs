//! `springs`, `dampers`, `forces` and `torques`: what they do, and to which bodies.

use std::collections::BTreeMap;

use super::attachment::{belongs_to_ground, carriers};
use super::declare::DeclaredBody;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, names};
use crate::expr::Id;
use crate::file::Spot;
use crate::model::expression::families::Family;
use crate::model::expression::index::MEMBER_LIMIT;
use crate::model::resolved::{Load, Push, SharedEnd, Work};
use crate::model::resolver::Resolver;

/// The body that takes a push.
#[derive(Clone, Debug, PartialEq)]
pub enum AttachedTo {
    /// The ground.
    Ground,
    /// A body.
    Body(usize),
    /// Whatever carries this point.
    Carrier(usize),
}

/// A push whose body may still have to be found.
#[derive(Clone, Debug)]
pub struct DraftPush {
    /// Who takes it.
    pub attached: AttachedTo,
    /// Where.
    pub at: Vec<Id>,
    /// The force.
    pub force: Vec<Id>,
    /// The couple.
    pub couple: Vec<Id>,
}

/// A load whose bodies may still have to be found.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Its label.
    pub name: String,
    /// How it does work.
    pub work: Work,
    /// What it does to bodies.
    pub pushes: Vec<DraftPush>,
    /// Where it stands.
    pub place: Place,
}

/// A point whose carrier is wanted.
#[derive(Clone, Debug)]
pub struct Wanted {
    /// The point.
    pub point: Vec<Id>,
    /// As written.
    pub words: String,
    /// Where that stands.
    pub place: Place,
    /// A particle that the point must coincide with.
    pub particle: Option<usize>,
}

/// Loads on their way.
#[derive(Clone, Debug, Default)]
pub struct Drafts {
    /// In the file's order.
    pub loads: Vec<Draft>,
    /// Points whose carriers are wanted.
    pub wanted: Vec<Wanted>,
}

impl Resolver<'_> {
    /// All loads, with their bodies found.
    pub fn loads(&mut self, bodies: &[DeclaredBody]) {
        let mut drafts = Drafts::default();
        let mut families = Vec::new();
        for section in ["springs", "dampers", "forces", "torques"] {
            let mut seen = BTreeMap::new();
            for (key, spot) in self.section(section) {
                let Some(family) = self.expand(key, &spot) else { continue };
                let fresh = family.members.iter().all(|m| {
                    let name = m.name();
                    self.unique(&mut seen, &name, &format!("`{section}`"), &spot.place)
                });
                if fresh {
                    families.push((section, family, spot));
                }
            }
        }
        for (section, family, spot) in &families {
            let first = drafts.loads.len();
            match *section {
                "springs" => self.spring(spot, family, &mut drafts),
                "dampers" => self.damper(spot, family, &mut drafts),
                "forces" => self.force(spot, family, &mut drafts),
                _ => self.torque(spot, family, &mut drafts),
            }
            for member in &family.members {
                let Some(Some(phases)) = self.phase_key(spot, &member.locals) else { continue };
                let name = member.name();
                for draft in drafts.loads[first..].iter_mut().filter(|draft| draft.name == name) {
                    self.switch(draft, &phases);
                }
            }
        }
        self.exchanges(bodies, &mut drafts);
        self.contact_loads(&mut drafts);
        self.place_loads(drafts);
    }

    /// Lets a load act in these phases only.
    fn switch(&mut self, draft: &mut Draft, phases: &[usize]) {
        let active = self.indicator(phases);
        let graph = &mut self.builder.graph;
        let loaded = match &mut draft.work {
            Work::Potential(energy) => Some(energy),
            Work::Resistance { tension, .. } => Some(tension),
            Work::Pushes => None,
        };
        let pushed = draft.pushes.iter_mut().flat_map(|push| push.force.iter_mut().chain(&mut push.couple));
        for value in loaded.into_iter().chain(pushed) {
            *value = graph.mul(active, *value);
        }
    }

    /// Checks the keys of an entry; false when it is no mapping.
    pub fn load_keys(&mut self, spot: &Spot<'_>, keys: &[&str], section: &str, family: &Family) -> bool {
        let known: Vec<&str> = keys.iter().copied().chain(["phase"]).collect();
        let problems = &mut self.builder.problems;
        if !spot.only(&known, section, problems) {
            return false;
        }
        !family.members.is_empty()
    }

    /// The bodies that carry each of these points; says where there is none that should.  `None`: too many to compare (reported).
    pub fn carried(&mut self, wanted: &[Wanted]) -> Option<Vec<Vec<usize>>> {
        if wanted.is_empty() {
            return Some(Vec::new());
        }
        let points: Vec<Vec<Id>> = wanted.iter().map(|wanted| wanted.point.clone()).collect();
        let model = std::mem::take(&mut self.model);
        let found = carriers(&mut self.builder, &model, &points);
        self.model = model;
        let Some(found) = found else {
            self.builder.problems.push(names::too_many_names(Place::default(), MEMBER_LIMIT));
            return None;
        };
        for (wanted, bodies) in wanted.iter().zip(&found.bodies) {
            match wanted.particle {
                Some(particle) if !bodies.contains(&particle) => {
                    let name = &self.model.bodies[particle].name;
                    self.builder.problems.push(mechanics::at_on_particle(wanted.place.clone(), name));
                }
                None if bodies.is_empty() => {
                    self.builder.problems.push(mechanics::no_body(wanted.place.clone(), &wanted.words));
                }
                _ => {}
            }
        }
        Some(found.bodies)
    }

    /// Finds who carries the wanted points and finishes the loads.
    fn place_loads(&mut self, drafts: Drafts) {
        let Some(found) = self.carried(&drafts.wanted) else { return };
        for draft in drafts.loads {
            let mut pushes = Vec::new();
            for push in draft.pushes {
                let body = match push.attached {
                    AttachedTo::Ground => None,
                    AttachedTo::Body(body) => Some(body),
                    AttachedTo::Carrier(wanted) => match found.get(wanted).map(Vec::as_slice) {
                        Some([body]) => Some(*body),
                        Some(bodies @ [body, ..]) => {
                            let (load, push) = (self.model.loads.len(), pushes.len());
                            let Wanted { words, place, .. } = &drafts.wanted[wanted];
                            let (bodies, point, place) = (bodies.to_vec(), words.clone(), place.clone());
                            let end = SharedEnd { load, push, bodies, point, place, changes: Vec::new() };
                            self.model.shared_ends.push(end);
                            Some(*body)
                        }
                        _ => continue,
                    },
                };
                pushes.push(Push { body, at: push.at, force: push.force, couple: push.couple });
            }
            if draft.work == Work::Pushes && pushes.iter().all(|push| push.body.is_none()) {
                self.model.warnings.push(mechanics::does_nothing(draft.place.clone(), &draft.name));
            }
            let Draft { name, work, place, .. } = draft;
            if let Work::Potential(energy) = work
                && energy != Id::ZERO
            {
                self.model.potential_terms.push(energy);
            }
            self.model.loads.push(Load { name, work, pushes, place });
        }
    }

    /// Who takes a force at a point.
    pub fn attached(&mut self, point: &[Id], words: &str, place: Place, drafts: &mut Drafts) -> AttachedTo {
        if belongs_to_ground(&mut self.builder, point) {
            return AttachedTo::Ground;
        }
        let wanted = Wanted { point: point.to_vec(), words: words.to_owned(), place, particle: None };
        drafts.wanted.push(wanted);
        AttachedTo::Carrier(drafts.wanted.len() - 1)
    }
}
