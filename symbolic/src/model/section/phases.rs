//! `phases`, and the key `phase` wherever it stands (LANGUAGE, sections 5 and 6).

use rustc_hash::FxHashSet as HashSet;

use crate::diagnose::catalogue::{names, sections};
use crate::expr::Id;
use crate::file::{Spot, Text};
use crate::language::parse;
use crate::model::expression::families::Locals;
use crate::model::expression::lower::Lower;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Entry, Member, Section};
use crate::model::resolved::Phase;
use crate::model::resolver::Resolver;

/// Names in lists are looked up, not evaluated.
const LOOKED_UP: Rules = Rules::constant("a list of names");

impl Resolver<'_> {
    /// All phases: one without a name and with all constraints where the file has none.
    pub fn phases(&mut self) {
        if self.phases_of_contacts() {
            return;
        }
        let Some(root) = self.root.get("phases") else {
            let constraints = (0..self.scope.constraints.len()).collect();
            self.model.phases = vec![Phase { name: String::new(), constraints, place: self.root.place.clone() }];
            return;
        };
        let before = self.builder.problems.len();
        for (key, spot) in self.section("phases") {
            let family = self.expand(key, &spot);
            let base = key.split('[').next().unwrap_or(key).trim().to_owned();
            let indices = family.as_ref().map_or(0, |family| family.key.indices.len());
            let reserved = family.is_some() && self.is_no_label(&base, &["stop", "record"], &spot);
            let entry = Entry { refused: family.is_none() || reserved, ..Entry::new(Section::Phase, indices) };
            self.scope.phase_names.entry(base).or_insert(entry);
            if reserved {
                continue;
            }
            let items = spot.list(&mut self.builder.problems);
            for member in family.iter().flat_map(|family| &family.members) {
                let name = member.name();
                let place = self.model.phases.len();
                let entry = self.scope.phase_names.get_mut(&member.base);
                if !entry.is_some_and(|entry| entry.add(&member.indices, Member::Phase(place))) {
                    self.builder.problems.push(sections::duplicate_label(spot.place.of_key(), name, "`phases`"));
                    break;
                }
                let constraints = self.places(&items, &name, &member.locals, Section::Constraint);
                self.model.phases.push(Phase { name, constraints, place: spot.place.clone() });
            }
        }
        if self.model.phases.is_empty() && self.builder.problems.len() == before {
            self.builder.problems.push(sections::empty_list(root.place.of_key(), "phases", "phase"));
        }
        if self.model.phases.is_empty() {
            // So that what follows finds one.
            self.model.phases = vec![Phase { name: String::new(), constraints: Vec::new(), place: root.place }];
        }
    }

    /// Reports a label that expressions and lists cannot name, such as that of a function.
    pub fn is_no_label(&mut self, base: &str, reserved: &[&str], spot: &Spot<'_>) -> bool {
        let refused = reserved.contains(&base) || parse(base).is_err();
        if refused {
            self.builder.problems.push(names::reserved_name(spot.place.of_key(), base, format!("{base}_")));
        }
        refused
    }

    /// The phases that the key `phase` of an entry names: one, or a list; inside, `None`: it has no such key.
    /// Outside, `None`: it is wrong (reported).
    pub fn phase_key(&mut self, entry: &Spot<'_>, locals: &Locals) -> Option<Option<Vec<usize>>> {
        let Some(spot) = entry.get("phase") else { return Some(None) };
        if !self.has_named_phases(&spot) {
            return None;
        }
        let before = self.builder.problems.len();
        let items = spot.items().unwrap_or_else(|| vec![spot.clone()]);
        let mut phases = self.places(&items, "phase", locals, Section::Phase);
        phases.sort_unstable();
        if phases.is_empty() && self.builder.problems.len() == before && items.is_empty() {
            self.builder.problems.push(sections::empty_list(spot.place.of_key(), "phase", "phase"));
        }
        (!phases.is_empty()).then_some(Some(phases))
    }

    /// The phases in which an entry is claimed, as [`Resolver::phase_key`]; where contacts make the phases, those in which contacts do what
    /// it says: `rub sticks`.
    pub fn claimed_phases(&mut self, entry: &Spot<'_>, locals: &Locals) -> Option<Option<Vec<usize>>> {
        match entry.get("phase").filter(|_| !self.contacts.is_empty()) {
            Some(spot) => self.phases_in_words(&spot).map(Some),
            None => self.phase_key(entry, locals),
        }
    }

    /// Whether the file has phases by name (reported where not).
    fn has_named_phases(&mut self, spot: &Spot<'_>) -> bool {
        let place = spot.place.of_key();
        match (self.root.get("phases").is_some(), self.contacts.is_empty()) {
            (_, false) => self.builder.problems.push(sections::acts_in_all_phases(place)),
            (false, true) => self.builder.problems.push(sections::no_phases(place)),
            (true, true) => return true,
        }
        false
    }

    /// The phase that a single name stands for.
    pub fn one_phase(&mut self, spot: &Spot<'_>, locals: &Locals) -> Option<usize> {
        if !self.has_named_phases(spot) {
            return None;
        }
        let text = spot.text(&mut self.builder.problems)?;
        self.place(&text, locals, Section::Phase)
    }

    /// The constraint or phase that a name stands for.
    pub fn place(&mut self, text: &Text, locals: &Locals, section: Section) -> Option<usize> {
        Lower::new(&mut self.builder, &self.scope, text, LOOKED_UP, locals).labelled(&text.ast, section)
    }

    /// The constraint, joint or phase that a name stands for.
    fn member(&mut self, text: &Text, locals: &Locals, section: Section) -> Option<Member> {
        Lower::new(&mut self.builder, &self.scope, text, LOOKED_UP, locals).label(&text.ast, section)
    }

    /// What a list names, families included, each thing once; a joint stands for all its rows.
    fn places(&mut self, items: &[Spot<'_>], list: &str, locals: &Locals, section: Section) -> Vec<usize> {
        let mut places = Vec::new();
        let mut seen: HashSet<Member> = HashSet::default();
        for item in items {
            let texts: Vec<Text> = self.listed(item, locals);
            for text in texts {
                let Some(member) = self.member(&text, locals, section) else { continue };
                if !seen.insert(member) {
                    let problem = sections::twice_in_list(item.place.clone(), &text.source, list);
                    self.builder.problems.push(problem);
                    continue;
                }
                match member {
                    Member::Constraint(place) | Member::Phase(place) => places.push(place),
                    Member::Joint(place) => places.extend(self.scope.joints[place].rows.iter().map(|(row, _)| *row)),
                    _ => {}
                }
            }
        }
        places
    }

    /// 1 in these phases, 0 in all others.
    pub fn indicator(&mut self, phases: &[usize]) -> Id {
        self.builder.graph.in_phases(phases, self.model.phases.len())
    }
}
