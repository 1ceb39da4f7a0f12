//! `constraints`: what holds the coordinates together (LANGUAGE, section 6).

use super::attachment::states;
use super::resolve_values::Want;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, sections};
use crate::expr::{DoubleDouble, Id, Symbol, Tape, jacobian};
use crate::file::{Node, Written};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::facts::Depends;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{ConstraintNames, Entry, Member, Section};
use crate::model::expression::value::Value;
use crate::model::resolved::Constraint;
use crate::model::resolver::Resolver;

/// A derivative that does not exceed so many roundings of its terms vanishes.
const ROUNDINGS: f64 = 1e10;

impl Resolver<'_> {
    /// The names of constraints, which are labels; their values follow when all names are known.  Returns where they
    /// stand.
    pub fn declare_constraints(&mut self) -> Vec<Place> {
        let mut places = Vec::new();
        for (key, spot) in self.section("constraints") {
            let Some(family) = self.expand(key, &spot) else {
                let base = key.split('[').next().unwrap_or(key).trim().to_owned();
                let entry = Entry { refused: true, ..Entry::new(Section::Constraint, 0) };
                self.scope.constraint_names.entry(base).or_insert(entry);
                continue;
            };
            let problems = &mut self.builder.problems;
            let written = match spot.node {
                Node::List(_) => spot.written(problems),
                _ => spot.equation(problems).map(Written::One),
            };
            let base = family.key.name.clone();
            let refused = self.is_no_label(&base, &[], &spot);
            let entry = Entry { refused, ..Entry::new(Section::Constraint, family.key.indices.len()) };
            self.scope.constraint_names.entry(base).or_insert(entry);
            for member in &family.members {
                let name = member.name();
                let place = self.scope.constraints.len();
                let entry = self.scope.constraint_names.get_mut(&member.base);
                if !entry.is_some_and(|entry| entry.add(&member.indices, Member::Constraint(place))) {
                    self.builder.problems.push(sections::duplicate_label(spot.place.of_key(), name, "`constraints`"));
                    break;
                }
                let (rules, written) = (Rules::constraint(), written.clone());
                let item = self.item(name.clone(), written, rules, Want::Equation, &member.locals);
                self.scope.constraints.push(ConstraintNames { name, item, first: None, scale: None, across: None });
                places.push(spot.place.clone());
            }
        }
        self.declare_joints(&mut places);
        self.declare_contacts(&mut places);
        places
    }

    /// Constraints, now that they have values: rows, kinds and units.
    pub fn finish_constraints(&mut self, places: Vec<Place>) {
        let mut rows = 0;
        for (names, place) in self.scope.constraints.iter_mut().zip(places) {
            let value = self.scope.values.get(names.item).and_then(Option::as_ref).unwrap_or(&Value::Poison);
            // The sum of nothing is 0.
            let components = if *value == Value::Nothing { vec![Id::ZERO] } else { value.components().to_vec() };
            let known = self.scope.units.items.get(names.item).and_then(|measure| measure.dimension());
            let unit = known.filter(|dimension| *dimension != Dimension::ONE).map(|dimension| dimension.to_string());
            names.first = Some(rows);
            self.model.constraints.push(Constraint {
                name: names.name.clone(),
                scalar: !matches!(value, Value::Vector(_)),
                holonomic: !self.builder.facts.of_all(&self.builder.graph, &components).meets(Depends::SPEED),
                first: rows,
                unit,
                place,
                value: components,
            });
            rows += self.model.constraints.last().map_or(0, |constraint| constraint.value.len());
        }
        self.judge_constraints();
        self.measure_gaps();
        self.judge_joints();
    }

    /// Refuses what is no constraint on the motion, and what is not affine in the velocities.
    fn judge_constraints(&mut self) {
        let constraints = std::mem::take(&mut self.model.constraints);
        let values: Vec<Id> = constraints.iter().flat_map(|c| c.value.iter().copied()).collect();
        let speeds = jacobian(&mut self.builder.graph, &values, |symbol| match symbol {
            Symbol::Speed(i) => Some(i as usize),
            _ => None,
        });
        let slopes = jacobian(&mut self.builder.graph, &values, |symbol| match symbol {
            Symbol::Coordinate(i) => Some(i as usize),
            _ => None,
        });
        let derivatives: Vec<Vec<Id>> = constraints
            .iter()
            .flat_map(|c| std::iter::repeat_n(c.holonomic, c.value.len()))
            .zip(slopes.into_iter().zip(speeds))
            .map(|(holonomic, (slopes, speeds))| if holonomic { slopes } else { speeds })
            .map(|row| row.into_iter().map(|(_, derivative)| derivative).collect())
            .collect();
        let still = self.still(&derivatives);
        // What is true anyway follows from the others: which rows do is decided at states.
        let zero = self.still(&values.iter().map(|value| vec![*value]).collect::<Vec<_>>());
        for constraint in &constraints {
            for (k, value) in constraint.value.iter().enumerate() {
                let row = constraint.first + k;
                let (name, place) = (constraint.component(k), constraint.place.clone());
                let problem = if still[row] && !zero[row] {
                    mechanics::constraint_without_motion(place, name)
                } else if !constraint.holonomic && self.builder.depends(&derivatives[row]).meets(Depends::SPEED) {
                    mechanics::not_affine(place, name)
                } else if constraint.holonomic && self.builder.depends(&[*value]).meets(Depends::VELOCITY) {
                    mechanics::input_rate_in_constraint(place, name)
                } else {
                    continue;
                };
                self.builder.problems.push(problem);
                break;
            }
        }
        self.model.constraints = constraints;
    }

    /// For each row, whether all of it vanishes at all random states at which it is finite.
    pub fn still(&mut self, rows: &[Vec<Id>]) -> Vec<bool> {
        let all: Vec<Id> = rows.iter().flatten().copied().collect();
        let tape = Tape::new(&self.builder.graph, &all);
        let mut verdicts: Vec<Option<bool>> = rows.iter().map(|row| row.is_empty().then_some(true)).collect();
        for state in states(&self.builder, &self.model) {
            if verdicts.iter().all(|verdict| *verdict == Some(false)) {
                break;
            }
            let found = tape.measured(|symbol| DoubleDouble::from(state.value(symbol)));
            let mut rest = found.as_slice();
            for (row, verdict) in rows.iter().zip(&mut verdicts) {
                let (found, others) = rest.split_at(row.len());
                rest = others;
                if !found.is_empty() && found.iter().all(|value| value.value.is_finite()) {
                    let vanishes = found.iter().all(|value| value.vanishes(ROUNDINGS));
                    *verdict = Some(verdict.unwrap_or(true) && vanishes);
                }
            }
        }
        verdicts.into_iter().map(|verdict| verdict.unwrap_or(false)).collect()
    }
}
