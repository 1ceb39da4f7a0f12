//! Joints by name: the values of their rows, and the force and the couple that the multipliers of these rows are.

use super::builder::ExprBuilder;
use super::dimension::{Dimension, Measure};
use super::facts::Depends;
use super::lower::Lower;
use super::scope::{JointRow, Member, Scope, Section};
use super::value::Value;
use crate::diagnose::catalogue::{mechanics, names};
use crate::expr::{Id, Symbol, Tape, vectors};
use crate::language::{Ast, Span};

/// What a row states: a value that is to vanish, and in the builder its unit.
pub fn value(builder: &mut ExprBuilder, scope: &Scope, row: JointRow) -> Value {
    let way = |builder: &mut ExprBuilder, [p, q]: [usize; 2]| {
        let (p, q) = (vector(builder, scope, p), vector(builder, scope, q));
        Some(vectors::difference(&mut builder.graph, &q?, &p?))
    };
    let (found, unit) = match row {
        JointRow::Meet { points } => (way(builder, points).map(Value::Vector), scope.units.of(Dimension::LENGTH)),
        JointRow::Keep { points, along } => {
            let (way, along) = (way(builder, points), vector(builder, scope, along));
            (component(builder, way, along), scope.units.of(Dimension::LENGTH))
        }
        JointRow::Turn { across: [u, v] } => {
            let (u, v) = (vector(builder, scope, u), vector(builder, scope, v));
            (component(builder, u, v), Measure::ONE)
        }
        JointRow::Advance { points: [p, q], axis, turned, pitch } => {
            let (way, axis) = (way(builder, [q, p]), vector(builder, scope, axis));
            let omega = turned.map(|item| angular_velocity(builder, scope, item));
            let pitch = scalar(builder, scope, pitch);
            let unit = scope.units.rate(scope.units.of(Dimension::LENGTH));
            (advance(builder, (way, axis), omega, pitch), unit)
        }
        JointRow::Slide { bodies, at, normal } => {
            let velocities = bodies.map(|body| material_velocity(builder, scope, body, at));
            let normal = vector(builder, scope, normal);
            (slide(builder, velocities, normal), scope.units.rate(scope.units.of(Dimension::LENGTH)))
        }
        JointRow::Approach { bodies, at, normal } => {
            let [first, second] = bodies.map(|body| material_velocity(builder, scope, body, at));
            let normal = vector(builder, scope, normal).map(|normal| vectors::unit(&mut builder.graph, &normal));
            let velocity = second.zip(first).map(|(w, v)| vectors::difference(&mut builder.graph, &w, &v));
            (component(builder, velocity, normal), scope.units.rate(scope.units.of(Dimension::LENGTH)))
        }
    };
    builder.measured = unit;
    found.unwrap_or(Value::Poison)
}

/// d/dt w·a − h (ω₂ − ω₁)·a.
fn advance(
    builder: &mut ExprBuilder,
    (way, axis): (Option<Vec<Id>>, Option<Vec<Id>>),
    [first, second]: [Option<Vec<Id>>; 2],
    pitch: Option<Id>,
) -> Option<Value> {
    let (axis, pitch) = (axis?, pitch?);
    let way = vectors::dot(&mut builder.graph, &way?, &axis);
    let rate = builder.rate(way);
    let graph = &mut builder.graph;
    let turning = vectors::difference(graph, &first?, &second?);
    let turning = vectors::dot(graph, &turning, &axis);
    let turning = graph.mul(pitch, turning);
    Some(Value::Scalar(graph.sub(rate, turning)))
}

/// (v₁ − v₂) × n for the unit normal n; in space its components along two directions across n.
fn slide(builder: &mut ExprBuilder, [first, second]: [Option<Vec<Id>>; 2], normal: Option<Vec<Id>>) -> Option<Value> {
    let (first, second, normal) = (first?, second?, normal?);
    let graph = &mut builder.graph;
    let normal = vectors::unit(graph, &normal);
    let velocity = vectors::difference(graph, &second, &first);
    if normal.len() == 3 {
        let directions = across(builder, &normal);
        return Some(Value::Vector(directions.map(|t| vectors::dot(&mut builder.graph, &velocity, &t)).to_vec()));
    }
    let (&[u, v], &[x, y]) = (velocity.as_slice(), normal.as_slice()) else { return None };
    let graph = &mut builder.graph;
    let (along, across) = (graph.mul(u, y), graph.mul(v, x));
    Some(Value::Scalar(graph.sub(along, across)))
}

/// Two directions across a unit normal of space, smooth about where it points with default parameters and all coordinates 0; upwards where that is
/// nowhere.
pub fn across(builder: &mut ExprBuilder, normal: &[Id]) -> [Vec<Id>; 2] {
    let defaults = &builder.defaults;
    let known = Tape::new(&builder.graph, normal).evaluate(|symbol| match symbol {
        Symbol::Parameter(k) => defaults.get(k as usize).copied().unwrap_or(0.0),
        _ => 0.0,
    });
    let larger = |nearest: usize, k: usize| if known[k].abs() > known[nearest].abs() { k } else { nearest };
    let nearest = if known.iter().all(|x| x.is_finite()) { [1, 0].into_iter().fold(2, larger) } else { 2 };
    vectors::across(&mut builder.graph, normal, (nearest, known[nearest] >= 0.0 || known[nearest].is_nan()))
}

/// The velocity of the material of a body at a point, v + ω × (P − r); of the ground it is 0.
fn material_velocity(builder: &mut ExprBuilder, scope: &Scope, body: Option<usize>, at: usize) -> Option<Vec<Id>> {
    let at = vector(builder, scope, at);
    let Some(body) = body else { return Some(vec![Id::ZERO; scope.dimension]) };
    let centre = vector(builder, scope, scope.bodies[body].position);
    let orientation = scope.bodies[body].orientation;
    let omega = orientation.map(|item| turning(builder, scope, item));
    let centre = centre?;
    let velocity = builder.rates(&centre);
    let Some(omega) = omega else { return Some(velocity) };
    let graph = &mut builder.graph;
    let arm = vectors::difference(graph, &centre, &at?);
    let turning = vectors::swept(graph, &omega?, &arm);
    Some(vectors::add(graph, &velocity, &turning))
}

/// ω of what has this angle, or is turned so: one component in the plane.
fn turning(builder: &mut ExprBuilder, scope: &Scope, item: usize) -> Option<Vec<Id>> {
    if scope.dimension == 3 {
        return angular_velocity(builder, scope, Some(item));
    }
    let angle = scalar(builder, scope, item)?;
    Some(vec![builder.rate(angle)])
}

/// ω in space of what is turned so; of the ground it is 0.
fn angular_velocity(builder: &mut ExprBuilder, scope: &Scope, turned: Option<usize>) -> Option<Vec<Id>> {
    let Some(turned) = turned else { return Some(vec![Id::ZERO; 3]) };
    match known(builder, scope, turned)? {
        Value::Orientation(frame) => Some(frame.velocity.to_vec()),
        _ => None,
    }
}

/// The value of an item; a note that it is needed where it is not known yet.
fn known<'a>(builder: &mut ExprBuilder, scope: &'a Scope, item: usize) -> Option<&'a Value> {
    let value = scope.value(item);
    if value.is_none() {
        builder.needs.push(item);
    }
    value
}

fn vector(builder: &mut ExprBuilder, scope: &Scope, item: usize) -> Option<Vec<Id>> {
    match known(builder, scope, item)? {
        Value::Vector(v) => Some(v.clone()),
        _ => None,
    }
}

fn scalar(builder: &mut ExprBuilder, scope: &Scope, item: usize) -> Option<Id> {
    match known(builder, scope, item)? {
        Value::Scalar(x) => Some(*x),
        _ => None,
    }
}

fn component(builder: &mut ExprBuilder, a: Option<Vec<Id>>, b: Option<Vec<Id>>) -> Option<Value> {
    Some(Value::Scalar(vectors::dot(&mut builder.graph, &a?, &b?)))
}

impl Lower<'_> {
    /// The force that two multipliers are along the directions across a normal.
    pub(super) fn force_along(&mut self, normal: usize, multipliers: &[Id]) -> Option<Vec<Id>> {
        let normal = vector(self.builder, self.scope, normal)?;
        let normal = vectors::unit(&mut self.builder.graph, &normal);
        let [first, second] = across(self.builder, &normal);
        let graph = &mut self.builder.graph;
        let first = vectors::scaled(graph, *multipliers.first()?, &first);
        Some(vectors::add_scaled(graph, &first, *multipliers.get(1)?, &second))
    }

    /// The force of a joint on its first side, where its second side has its point Q: λ of P − Q, λ u of (P − Q)·u and −λ a of a screw.
    pub(super) fn force_of_joint(&mut self, joint: usize, span: Span) -> Value {
        if self.scope.joints[joint].one_point {
            let (place, name) = (self.place(span), self.scope.joints[joint].name.clone());
            return self.refuse(mechanics::force_not_among_rows(place, name));
        }
        self.sum_of_rows(joint, self.scope.dimension, |lower, lambda, row| match row {
            JointRow::Meet { .. } => Some(lambda.to_vec()),
            JointRow::Keep { along, .. } => lower.scaled(lambda, along),
            JointRow::Advance { axis, .. } => {
                let force = lower.scaled(lambda, axis)?;
                Some(vectors::negative(&mut lower.builder.graph, &force))
            }
            JointRow::Turn { .. } | JointRow::Slide { .. } | JointRow::Approach { .. } => Some(Vec::new()),
        })
    }

    /// The couple of a joint on its first side: λ u × v of u·v, and λ h a of a screw.
    pub(super) fn moment(&mut self, joint: &Ast, span: Span) -> Value {
        if self.rules.refused.meets(Depends::MULTIPLIER) {
            let (place, words) = (self.place(span), self.text.words(span));
            return self.refuse(names::reaction_misplaced(place, words, self.rules.what));
        }
        let joint = match self.label(joint, Section::Constraint) {
            Some(Member::Joint(place)) => place,
            Some(_) => {
                let (place, words) = (self.place(joint.span), self.text.words(joint.span));
                return self.refuse(names::wrong_thing(
                    place,
                    words,
                    Section::Joint.noun(),
                    Section::Constraint.noun(),
                ));
            }
            None => return Value::Poison,
        };
        let size = vectors::moment_size(self.scope.dimension);
        let couple = self.sum_of_rows(joint, size, |lower, lambda, row| match row {
            JointRow::Turn { across: [u, v] } => {
                let [u, v] = [u, v].map(|item| vector(lower.builder, lower.scope, item));
                let across = vectors::moment(&mut lower.builder.graph, &u?, &v?);
                Some(vectors::scaled(&mut lower.builder.graph, lambda[0], &across))
            }
            JointRow::Advance { axis, pitch, .. } => {
                let pitch = scalar(lower.builder, lower.scope, pitch)?;
                let along = lower.scaled(lambda, axis)?;
                Some(vectors::scaled(&mut lower.builder.graph, pitch, &along))
            }
            JointRow::Meet { .. } | JointRow::Keep { .. } | JointRow::Slide { .. } | JointRow::Approach { .. } => {
                Some(Vec::new())
            }
        });
        match couple {
            Value::Vector(couple) if size == 1 => Value::Scalar(couple[0]),
            couple => couple,
        }
    }

    /// The sum of what the multipliers of a joint's rows are, each by its components.
    fn sum_of_rows(
        &mut self,
        joint: usize,
        size: usize,
        part: impl Fn(&mut Self, &[Id], JointRow) -> Option<Vec<Id>>,
    ) -> Value {
        let scope = self.scope;
        let mut sum = vec![Id::ZERO; size];
        for (constraint, row) in &scope.joints[joint].rows {
            let multipliers = self.multipliers(*constraint);
            let lambda = multipliers.components();
            if lambda.is_empty() {
                return Value::Poison;
            }
            let Some(part) = part(self, lambda, *row) else { return Value::Poison };
            for (sum, x) in sum.iter_mut().zip(part) {
                *sum = self.builder.graph.add(*sum, x);
            }
        }
        Value::Vector(sum)
    }

    fn scaled(&mut self, lambda: &[Id], direction: usize) -> Option<Vec<Id>> {
        let direction = vector(self.builder, self.scope, direction)?;
        Some(vectors::scaled(&mut self.builder.graph, lambda[0], &direction))
    }
}
