//! Constraints, joints and phases in expressions: labels, and the reactions of constraints.

use super::dimension::{Dimension, Measure};
use super::facts::Depends;
use super::lower::Lower;
use super::scope::{Member, Section};
use super::value::Value;
use crate::diagnose::catalogue::{contacts, names};
use crate::diagnose::did_you_mean_or;
use crate::expr::Symbol;
use crate::language::{Ast, AstKind, FRICTION, Span};

impl Lower<'_> {
    /// The place of the constraint, or of the phase, that an expression names; `None` where it names none (reported) or
    /// was refused.
    pub fn labelled(&mut self, ast: &Ast, section: Section) -> Option<usize> {
        match self.label(ast, section)? {
            Member::Constraint(place) | Member::Phase(place) => Some(place),
            Member::Joint(_) => {
                let (place, words) = (self.place(ast.span), self.text.words(ast.span));
                self.refuse(names::wrong_thing(place, words, section.noun(), Section::Joint.noun()));
                None
            }
            _ => None,
        }
    }

    /// The phase, or the constraint or joint, that an expression names; `None` where it names none (reported).
    pub fn label(&mut self, ast: &Ast, section: Section) -> Option<Member> {
        if let AstKind::Component(contact, FRICTION) = &ast.kind
            && section == Section::Constraint
        {
            return self.friction_of(contact);
        }
        let scope = self.scope;
        let AstKind::Name { name, indices, primes: 0 } = &ast.kind else {
            let (place, words) = (self.place(ast.span), self.text.words(ast.span));
            self.refuse(names::wrong_thing(place, words, section.noun(), "an expression"));
            return None;
        };
        let labels = if section == Section::Phase { &scope.phase_names } else { &scope.constraint_names };
        match labels.get(name) {
            Some(entry) => self.member_of(entry, name, indices, ast.span).filter(|member| *member != Member::Refused),
            None => {
                let known: Vec<&str> = labels.keys().map(String::as_str).collect();
                let help = match known.is_empty() {
                    true => format!("the model has no {}", section.key()),
                    false => did_you_mean_or(name, &known),
                };
                let unknown = if section == Section::Phase { names::unknown_phase } else { names::unknown_constraint };
                self.refuse(unknown(self.place(ast.span), name, help));
                None
            }
        }
    }

    /// The constraint that holds the sliding of a contact.
    fn friction_of(&mut self, contact: &Ast) -> Option<Member> {
        let member = self.label(contact, Section::Constraint)?;
        let constraints = &self.scope.constraints;
        let Member::Constraint(place) = member else { return None };
        let name = constraints[place].name.clone();
        if constraints.get(place + 1).is_some_and(|next| next.name == format!("{name}.friction")) {
            return Some(Member::Constraint(place + 1));
        }
        let problem = contacts::no_friction_there(self.place(contact.span), name);
        self.refuse(problem);
        None
    }

    /// The multiplier of a constraint, one for each of its components; the force of a joint on its first side.
    pub(super) fn reaction(&mut self, constraint: &Ast, span: Span) -> Value {
        if self.rules.refused.meets(Depends::MULTIPLIER) {
            let (place, words) = (self.place(span), self.text.words(span));
            return self.refuse(names::reaction_misplaced(place, words, self.rules.what));
        }
        match self.label(constraint, Section::Constraint) {
            Some(Member::Constraint(place)) => self.reaction_of(place),
            Some(Member::Joint(place)) => self.force_of_joint(place, span),
            _ => Value::Poison,
        }
    }

    /// What a constraint holds with: its multipliers, or in space the force along a contact that sticks.
    fn reaction_of(&mut self, place: usize) -> Value {
        let multipliers = self.multipliers(place);
        let Some(normal) = self.scope.constraints[place].across else { return multipliers };
        match multipliers {
            Value::Vector(along) => self.force_along(normal, &along).map_or(Value::Poison, Value::Vector),
            other => other,
        }
    }

    /// The multipliers of a constraint's components.
    pub(super) fn multipliers(&mut self, place: usize) -> Value {
        let scope = self.scope;
        let value = self.item(scope.constraints[place].item);
        let first = match scope.constraints[place].first {
            Some(first) => Some(first),
            None if !self.builder.spend(1 + place as u64 / 64, &self.text.place) => None,
            // Definitions may need it before all constraints have been counted.
            None => scope.constraints[..place].iter().try_fold(0, |rows, before| match self.item(before.item) {
                Value::Poison => None,
                value => Some(rows + value.components().len()),
            }),
        };
        let Some(first) = first else { return Value::Poison };
        let (mut row, scale) = (first as u32, scope.constraints[place].scale);
        let graph = &mut self.builder.graph;
        value.map(|_| {
            row += 1;
            let multiplier = graph.symbol(Symbol::Multiplier(row - 1));
            scale.map_or(multiplier, |scale| graph.div(multiplier, scale))
        })
    }

    /// The unit of a multiplier: work per unit of what has no speeds in it, else power; of a joint that of a force.
    pub(super) fn measure_of_reaction(&mut self, constraint: &Ast) -> Measure {
        let member = self.label(constraint, Section::Constraint);
        let scope = self.scope;
        let units = &scope.units;
        if units.pure {
            return Measure::ONE;
        }
        let energy = self.measure_of_work();
        let place = match member {
            Some(Member::Constraint(place)) => place,
            Some(Member::Joint(_)) => return energy.over(Measure::Of(Dimension::LENGTH)),
            _ => return Measure::Unknown,
        };
        let item = scope.constraints[place].item;
        let values = scope.value(item).map(Value::components).unwrap_or_default();
        let holonomic = !self.builder.depends(values).meets(Depends::SPEED);
        let work = if holonomic { energy } else { units.rate(energy) };
        match units.items.get(item).copied().unwrap_or_default() {
            Measure::Zero => Measure::Unknown,
            measure => work.over(measure),
        }
    }

    /// The unit of work, as of a couple per radian.
    pub(super) fn measure_of_work(&self) -> Measure {
        let units = &self.scope.units;
        match units.energy {
            _ if units.pure => Measure::ONE,
            // Raw energies, which may be per unit mass, are not read yet.
            Measure::Unknown if self.scope.bodies.is_empty() => Measure::Unknown,
            Measure::Unknown => units.of(Dimension::ENERGY),
            known => known,
        }
    }
}
