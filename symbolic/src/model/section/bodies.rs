//! Masses, gravity, energies.

use std::collections::BTreeSet;

use super::declare::{BodyText, DeclaredBody};
use super::inertia::{Moments, nine, tensor};
use super::resolve_values::has_direction;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{mechanics, names};
use crate::expr::{Id, Node, Rational, Symbol, vectors};
use crate::file::{Quantity, Text};
use crate::language::AstKind;
use crate::model::expression::dimension::{Dimension, Measure};
use crate::model::expression::families::Locals;
use crate::model::expression::quantities::stands_alone;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::Energies;
use crate::model::expression::value::Value;
use crate::model::resolved::{Body, GeneralizedForce};
use crate::model::resolver::Resolver;
use crate::model::rotation::Rotation;

/// An energy written by hand.
struct Raw {
    text: Option<Text>,
    value: Id,
    measure: Measure,
    what: &'static str,
}

impl Resolver<'_> {
    /// Inputs with their derivatives.
    pub fn finish_inputs(&mut self) {
        let items: Vec<(u32, usize)> = self
            .scope
            .names
            .values()
            .flat_map(|entry| entry.members.values())
            .filter_map(|member| match member {
                crate::model::expression::scope::Member::Input(place, item) => Some((*place, *item)),
                _ => None,
            })
            .collect();
        for (place, item) in items {
            let Some(Value::Scalar(value)) = self.scope.value(item) else { continue };
            let value = *value;
            let rate = self.builder.rate(value);
            self.model.inputs[place as usize].signal = [value, rate, self.builder.rate(rate)];
        }
    }

    /// Bodies, now that positions and angles have values.
    pub fn finish_bodies(&mut self, declared: &[DeclaredBody]) {
        let mut spatial = Vec::new();
        for (place, body) in declared.iter().enumerate() {
            let names = &self.scope.bodies[place];
            let (name, position, orientation) = (names.name.clone(), names.position, names.orientation);
            let rules = Rules::inertial("a mass").si(Dimension::MASS);
            let mass = self.mass_or_inertia(body.text.mass.as_ref(), rules, &body.locals);
            let written = body.text.inertia.as_deref().unwrap_or_default();
            let moments = self.moments(written, &body.locals);
            let position = match self.scope.value(position) {
                Some(Value::Vector(position)) => position.clone(),
                _ => vec![Id::ZERO; self.scope.dimension],
            };
            let rotation = orientation.and_then(|item| match self.scope.value(item).cloned() {
                Some(Value::Orientation(frame)) => {
                    let place = written.first().map(|first| Place::clone(&first.text.place)).unwrap_or_default();
                    let written = tensor(&moments);
                    let arm = self.arm(body, &name, &position, Some(&frame));
                    let less = arm.map(|arm| self.steiner(mass, &arm));
                    let inertia = less.map_or(written, |less| self.differences(&written, &less));
                    let values = if less.is_some() { nine(&inertia) } else { moments.clone() };
                    let about = less.map(|less| [nine(&written), nine(&less)]);
                    spatial.push(Moments { name: name.clone(), place, values, about });
                    Some(Rotation::Space { frame, inertia })
                }
                Some(Value::Scalar(angle)) => {
                    let mut inertia = moments.first().copied().unwrap_or(Id::ZERO);
                    if let Some(arm) = self.arm(body, &name, &position, None) {
                        let place = written.first().map(|first| Place::clone(&first.text.place)).unwrap_or_default();
                        let [_, _, less, ..] = self.steiner(mass, &arm);
                        let about = Some([vec![inertia], vec![less]]);
                        inertia = self.builder.graph.sub(inertia, less);
                        spatial.push(Moments { name: name.clone(), place, values: vec![inertia], about });
                    }
                    Some(Rotation::Plane { angle, inertia })
                }
                _ => None,
            });
            self.kinetic_energy(mass, &position, rotation.as_ref());
            let ways = self.builder.along.ways(&position);
            self.model.bodies.push(Body { name, mass, position, ways, rotation, place: body.text.place.clone() });
        }
        self.changing_masses(declared);
        self.radial_energy();
        self.axes_with_direction();
        self.positive_masses();
        self.possible_inertias(&spatial);
    }

    /// Notes whether some coordinate moves points alone whose mass is written as 0.
    pub fn look_for_knots(&mut self, declared: &[DeclaredBody]) {
        let mut moved = [BTreeSet::new(), BTreeSet::new()];
        for (body, names) in declared.iter().zip(&self.scope.bodies) {
            let BodyText { mass, inertia, .. } = &*body.text;
            let is_zero = |mass: &Quantity| matches!(&mass.text.ast.kind, AstKind::Number(number) if number.parse::<f64>() == Ok(0.0));
            let resists = inertia.is_some() || !mass.as_ref().is_none_or(is_zero);
            let Some(Value::Vector(position)) = self.scope.value(names.position) else { continue };
            let symbols = self.builder.graph.symbols(position.iter().copied());
            moved[usize::from(resists)].extend(symbols.into_iter().filter(|s| matches!(s, Symbol::Coordinate(_))));
        }
        self.has_knots = moved[0].difference(&moved[1]).next().is_some();
    }

    /// ½ m v·v and ½ I ω².
    fn kinetic_energy(&mut self, mass: Id, position: &[Id], rotation: Option<&Rotation>) {
        let half = self.half();
        let velocity = self.builder.rates(position);
        let square = vectors::dot(&mut self.builder.graph, &velocity, &velocity);
        let mut doubled = vec![self.builder.graph.mul(mass, square)];
        if let Some(rotation) = rotation {
            let omega = rotation.own_angular_velocity(|x| self.builder.rate(x));
            doubled.push(rotation.doubled_energy(&mut self.builder.graph, &omega));
        }
        for doubled in doubled {
            let term = self.builder.graph.mul(half, doubled);
            if term != Id::ZERO {
                self.model.kinetic_terms.push(term);
            }
        }
    }

    /// Refuses axes whose length is 0 or infinite by the parameters of a scene.
    fn axes_with_direction(&mut self) {
        let lengths = std::mem::take(&mut self.builder.lengths);
        let squares: Vec<Id> = lengths.iter().map(|(square, _)| *square).collect();
        for scene in &self.model.scenes {
            let parameters = self.scene_parameters(scene);
            let numbers = crate::model::command::evaluate_all(&self.builder.graph, &squares, &parameters);
            for ((_, place), _) in lengths.iter().zip(numbers).filter(|(_, square)| !has_direction(*square)) {
                self.builder.problems.push(mechanics::no_axis(place.clone()));
            }
        }
    }

    /// Refuses masses and inertias that are negative by the parameters of a scene, at the parameter where it is one.
    fn positive_masses(&mut self) {
        let masses = std::mem::take(&mut self.masses);
        let values: Vec<Id> = masses.iter().map(|(value, ..)| *value).collect();
        for scene in &self.model.scenes {
            let parameters = self.scene_parameters(scene);
            let numbers = crate::model::command::evaluate_all(&self.builder.graph, &values, &parameters);
            for ((value, what, place), number) in masses.iter().zip(numbers).filter(|(_, number)| *number < 0.0) {
                let place = match self.builder.graph.node(*value) {
                    Node::Symbol(Symbol::Parameter(k)) if !scene.set.iter().any(|(set, _)| *set == k as usize) => {
                        &self.model.parameters[k as usize].place
                    }
                    _ => place,
                };
                let problem = mechanics::value_out_of_range(place.clone(), what, "positive or 0", number);
                self.builder.problems.push(problem);
            }
        }
    }

    /// A mass or moment of inertia; 0 where absent.
    pub fn mass_or_inertia(&mut self, quantity: Option<&Quantity>, rules: Rules, locals: &Locals) -> Id {
        let Some(quantity) = quantity else { return Id::ZERO };
        let Some(value) = self.quantity(quantity, rules, locals) else { return Id::ZERO };
        let place = quantity.text.place.at(quantity.text.ast.span);
        self.masses.push((value, rules.what, place));
        value
    }

    /// A value in SI: its unit converts it where it is a pure number.
    pub fn quantity(&mut self, quantity: &Quantity, rules: Rules, locals: &Locals) -> Option<Id> {
        self.builder.quantity(&self.scope, quantity, rules, locals)
    }

    /// `gravity`, with −m g·r for each body.
    pub fn gravity(&mut self) {
        let Some(spot) = self.root.get("gravity") else { return };
        let Some(written) = spot.written(&mut self.builder.problems) else { return };
        let Some(gravity) =
            self.vector(&written, Rules::of_time("gravity").si(Dimension::ACCELERATION), &Self::no_locals())
        else {
            return;
        };
        for body in &self.model.bodies {
            let graph = &mut self.builder.graph;
            let along = vectors::dot(graph, &gravity, &body.position);
            let product = graph.mul(body.mass, along);
            let term = graph.neg(product);
            if term != Id::ZERO {
                self.model.potential_terms.push(term);
            }
        }
        for (usual, component) in gravity.iter().enumerate() {
            self.model.usual_gravity[usual] = self.default_value(*component).unwrap_or(0.0);
        }
        self.model.gravity = Some(gravity);
    }

    /// `kinetic_energy`, `potential_energy`, `dissipation`, `generalized_forces`.
    pub fn raw_energies(&mut self) {
        let kinetic = self.raw("kinetic_energy", Rules::mechanical("the kinetic energy"));
        let potential = self.raw("potential_energy", Rules::potential("the potential energy"));
        let energy = self.energy_unit(&[&kinetic, &potential]);
        self.scope.units.energy = energy;
        let dissipation = self.raw("dissipation", Rules::mechanical("the dissipation function"));
        for (raw, wanted) in [(&kinetic, energy), (&potential, energy), (&dissipation, self.scope.units.rate(energy))] {
            if let Some(text) = &raw.text {
                self.builder.measured = raw.measure;
                let place = text.place.at(text.ast.span);
                self.builder.expect_unit(wanted, raw.what, stands_alone(text, &[]), text.words(text.ast.span), &place);
            }
        }
        let [kinetic, potential, dissipation] = [kinetic, potential, dissipation].map(|raw| raw.value);
        self.model.raw_kinetic_energy = kinetic;
        self.model.raw_potential_energy = potential;
        self.model.dissipation = dissipation;
        for (term, terms) in [(kinetic, &mut self.model.kinetic_terms), (potential, &mut self.model.potential_terms)] {
            if term != Id::ZERO {
                terms.push(term);
            }
        }
        let mut given = vec![false; self.model.coordinates.len()];
        for (key, spot) in self.section("generalized_forces") {
            let Some(family) = self.expand(key, &spot) else { continue };
            let text = spot.text(&mut self.builder.problems);
            for member in &family.members {
                let Some(coordinate) = self.coordinate(member, &spot.place) else { break };
                if std::mem::replace(&mut given[coordinate], true) {
                    self.builder.problems.push(names::member_twice(spot.place.of_key(), member.name()));
                    break;
                }
                let Some(text) = &text else { continue };
                let unit = energy.over(self.scope.units.coordinates[coordinate]);
                let rules = Rules::velocity("the generalized force here").like(unit);
                if let Some(force) = self.scalar(text, rules, &member.locals) {
                    let place = spot.place.clone();
                    self.model.generalized_forces.push(GeneralizedForce { coordinate, force, place });
                }
            }
        }
    }

    fn raw(&mut self, key: &str, rules: Rules) -> Raw {
        let text = self.root.get(key).and_then(|spot| spot.text(&mut self.builder.problems));
        let value = text.as_ref().and_then(|text| self.scalar(text, rules, &Self::no_locals()));
        let measure = if value.is_some() { self.builder.measured } else { Measure::Unknown };
        Raw { text, value: value.unwrap_or(Id::ZERO), measure, what: rules.what }
    }

    /// J; in a model of raw energies alone, which may be per unit mass or moment of inertia, what these are in.
    fn energy_unit(&self, raw: &[&Raw]) -> Measure {
        let units = &self.scope.units;
        if units.pure {
            return Measure::ONE;
        }
        let joule = units.of(Dimension::ENERGY);
        let reduced = [Dimension::MASS, Dimension::INERTIA].map(|by| joule.over(units.of(by)));
        let known = || raw.iter().map(|raw| raw.measure).filter(|measure| matches!(measure, Measure::Of(_)));
        let alone = self.model.bodies.is_empty() && self.model.loads.is_empty() && !known().any(|m| m == joule);
        known().next().filter(|first| alone && reduced.contains(first)).unwrap_or(joule)
    }

    /// The coordinate that a key names; reports when it names none.
    pub fn coordinate(
        &mut self,
        member: &crate::model::expression::families::Expanded,
        place: &Place,
    ) -> Option<usize> {
        let place = place.of_key();
        let Some(entry) = self.scope.names.get(&member.base) else {
            let own = &self.model.coordinates[..self.model.mechanical()];
            let known = own.iter().map(|c| c.name.split('[').next().unwrap_or(&c.name));
            let help = crate::diagnose::did_you_mean(&member.base, known);
            self.builder.problems.push(names::unknown_name(place, &member.base, help));
            return None;
        };
        if entry.refused {
            return None;
        }
        if entry.section != crate::model::expression::scope::Section::Coordinate {
            let found = entry.section.noun();
            self.builder.problems.push(names::wrong_thing(place, &member.base, "a coordinate", found));
            return None;
        }
        match entry.members.get(&member.indices) {
            Some(crate::model::expression::scope::Member::Coordinate(coordinate)) => Some(*coordinate as usize),
            Some(crate::model::expression::scope::Member::Rotation(_)) => {
                self.builder.problems.push(names::wrong_thing(place, &member.base, "a number", "a rotation"));
                None
            }
            _ => {
                let problem = if entry.indices == member.indices.len() {
                    let listed: Vec<String> = member.indices.iter().map(i64::to_string).collect();
                    names::index_out_of_range(place, &member.base, listed.join(","), entry.range(&member.base))
                } else if entry.indices == 0 {
                    names::not_indexed(place, &member.base)
                } else {
                    let found = member.indices.len();
                    names::index_count(place, &member.base, format!("{} index(es)", entry.indices), found)
                };
                self.builder.problems.push(problem);
                None
            }
        }
    }

    /// T and V of the whole model, which expressions may name from now on.
    pub fn energies(&mut self) {
        let graph = &mut self.builder.graph;
        let mut sum = |terms: &[Id]| terms.iter().fold(Id::ZERO, |sum, term| graph.add(sum, *term));
        let (kinetic, potential) = (sum(&self.model.kinetic_terms), sum(&self.model.potential_terms));
        self.scope.energies = Some(Energies { kinetic, potential });
        self.scope.massive.clone_from(&self.model.bodies);
    }

    /// ½.
    pub fn half(&mut self) -> Id {
        self.builder.graph.rational(Rational::new(1, 2).unwrap_or(Rational::ONE))
    }
}
