//! Forces that act at points, for pictures: of constraints and joints, contacts and friction, reactions of balances and loads.
//!
//! A joint, a contact, a reaction and a load say where they act.  A constraint acts at the points that it names: with such a point P moved
//! by e, its force there is λ ∂c/∂e, or λ ∂c/∂e' of a constraint on velocities.

use std::collections::BTreeSet;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use super::resolve_values::Item;
use crate::expr::{Id, Node, Symbol, jacobian, substitute, vectors};
use crate::file::{Text, Written};
use crate::language::{Ast, AstKind, parse};
use crate::model::expression::dimension::Measure;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{JointRow, Member, Scope, Section};
use crate::model::expression::value::{self, Value};
use crate::model::resolved::{Output, Push, Vector};
use crate::model::resolver::Resolver;

/// A force, and where it acts.
struct PointForce {
    name: String,
    /// The body on which it acts, where that is known.
    body: Option<usize>,
    at: Vector,
    force: Vector,
}

/// On which body, where that is known, at which point, and how large.
type Acting = (Option<usize>, Vector, Vector);

/// Forces on their way.
#[derive(Default)]
struct Found {
    forces: Vec<PointForce>,
    elsewhere: Vec<String>,
}

impl Found {
    fn add(&mut self, resolver: &mut Resolver<'_>, new: PointForce) {
        if new.force.iter().all(|x| *x == Id::ZERO) {
            return;
        }
        match self.forces.iter_mut().find(|known| known.name == new.name && known.at == new.at) {
            Some(known) if known.body == new.body => {
                known.force = vectors::add(&mut resolver.builder.graph, &known.force, &new.force);
            }
            // Of a pair at one point the first is shown.
            Some(_) => {}
            None => self.forces.push(new),
        }
    }

    /// What a load or a reaction does to bodies.
    fn add_pushes(&mut self, resolver: &mut Resolver<'_>, name: &str, pushes: &[Push]) {
        for push in pushes.iter().filter(|push| push.body.is_some()) {
            let Push { body, at, force, .. } = push.clone();
            self.add(resolver, PointForce { name: name.to_owned(), body, at, force });
        }
        self.note(name);
    }

    /// Remembers a name of which no point is known.
    fn note(&mut self, name: &str) {
        let placed = self.forces.iter().any(|force| force.name == name);
        if !placed && !self.elsewhere.iter().any(|known| known == name) {
            self.elsewhere.push(name.to_owned());
        }
    }
}

/// The names of a model with every point and body moved by a coordinate of its own for each component.
struct Moved {
    scope: Scope,
    /// Where they are when nothing is moved, and the body if it is one.
    places: Vec<(Option<usize>, Vector)>,
    /// The first of those coordinates.
    first: usize,
}

impl Moved {
    /// The place and the component that a coordinate moves.
    fn component(&self, coordinate: u32) -> Option<usize> {
        (coordinate as usize).checked_sub(self.first)
    }
}

impl Resolver<'_> {
    /// Adds all forces that act at points to the outputs.
    pub fn point_forces(&mut self, items: &[Item]) {
        if !self.builder.problems.is_empty() {
            return;
        }
        let mut found = Found::default();
        self.forces_of_constraints(items, &mut found);
        self.forces_of_joints(&mut found);
        // Several systems name one reaction, of which each says the same.
        let mut told = BTreeSet::new();
        for (name, pushes) in std::mem::take(&mut self.reaction_pushes) {
            if told.insert(name.clone()) {
                found.add_pushes(self, &name, &pushes);
            }
        }
        for load in self.model.loads.clone().iter().filter(|load| !load.is_moved()) {
            found.add_pushes(self, &load.name, &load.pushes);
        }
        // What means nothing once points are moved has no force here; it is no mistake of the file.
        self.builder.problems.clear();
        let Found { forces, mut elsewhere } = found;
        elsewhere.retain(|name| forces.iter().all(|force| force.name != *name));
        self.model.point_forces.elsewhere = elsewhere;
        for PointForce { name, at, force, .. } in forces {
            let value = [at, force].concat();
            let place = self.model.point_forces.names.len();
            self.model.point_forces.names.push(name);
            let name = format!("\0force {place}");
            self.model.outputs.push(Output { name, value, unit: None, measure: Measure::Unknown, of_reactions: false });
        }
    }

    /// Of constraints that are no rows of joints and contacts.
    fn forces_of_constraints(&mut self, items: &[Item], found: &mut Found) {
        let of_joints = self.scope.joints.iter().flat_map(|joint| joint.rows.iter().map(|(place, _)| *place));
        let of_contacts = self.model.contacts.iter().flat_map(|contact| [contact.normal, contact.tangent]);
        let others: Vec<usize> = of_joints.chain(of_contacts.flatten()).collect();
        let own: Vec<usize> = (0..self.model.constraints.len()).filter(|place| !others.contains(place)).collect();
        if own.is_empty() {
            return;
        }
        let moved = self.moved();
        for place in own {
            let name = self.model.constraints[place].name.clone();
            let forces = match items.get(self.scope.constraints[place].item) {
                Some(item) => self.forces_of_constraint(place, item, &moved),
                None => Vec::new(),
            };
            for (body, at, force) in forces {
                found.add(self, PointForce { name: name.clone(), body, at, force });
            }
            found.note(&name);
        }
    }

    /// The names of the model with all points and bodies moved.
    fn moved(&mut self) -> Moved {
        let points = self.scope.names.values().filter(|entry| entry.section == Section::Point);
        let points = points.flat_map(|entry| entry.members.values()).filter_map(|member| match member {
            Member::Item(item) => Some((None, *item)),
            _ => None,
        });
        let bodies = self.scope.bodies.iter().enumerate().map(|(body, names)| (Some(body), names.position));
        let movable: Vec<(Option<usize>, usize)> = bodies.chain(points).collect();
        let first = self.model.coordinates.len();
        let mut moved = Moved { scope: self.scope.clone(), places: Vec::new(), first };
        for (body, item) in movable {
            let Some(Value::Vector(at)) = self.scope.value(item).cloned() else { continue };
            let graph = &mut self.builder.graph;
            let begin = first + moved.places.len() * at.len();
            let by: Vec<Id> = (0..at.len()).map(|k| graph.symbol(Symbol::Coordinate((begin + k) as u32))).collect();
            moved.scope.values[item] = Some(Value::Vector(vectors::add(graph, &at, &by)));
            moved.places.push((body, at));
        }
        moved
    }

    /// The forces of a constraint: on which body, where, and how large.
    fn forces_of_constraint(&mut self, place: usize, item: &Item, moved: &Moved) -> Vec<Acting> {
        let constraint = self.model.constraints[place].clone();
        let lambda: Vec<Id> =
            constraint.rows().map(|row| self.builder.graph.symbol(Symbol::Multiplier(row as u32))).collect();
        let named = self.forces_on_points(&lambda, (item, constraint.holonomic), moved);
        if !constraint.scalar
            && constraint.holonomic
            && let Some(force) = self.force_where_points_meet(&lambda, &constraint.value, &named)
        {
            return vec![force];
        }
        let material = self.material_points(item);
        let at_material = |(body, at, force): Acting| {
            let point = material.iter().find(|(known, _)| Some(*known) == body);
            (body, point.map_or(at, |(_, point)| point.clone()), force)
        };
        let moving = named.into_iter().filter(|(_, at, _)| self.moves(at)).map(at_material).collect::<Vec<_>>();
        if !moving.is_empty() {
            return moving;
        }
        self.forces_by_coordinates(&lambda, &constraint.value, constraint.holonomic, moved)
    }

    /// Whether something contains coordinates.
    fn moves(&self, value: &[Id]) -> bool {
        let symbols = self.builder.graph.symbols(value.iter().copied());
        symbols.into_iter().any(|symbol| matches!(symbol, Symbol::Coordinate(_)))
    }

    /// The force of a constraint on each of the points that it names.
    fn forces_on_points(&mut self, lambda: &[Id], (item, holonomic): (&Item, bool), moved: &Moved) -> Vec<Acting> {
        let Some(value) = self.value_when_moved(item, moved) else { return Vec::new() };
        let d = self.scope.dimension;
        let graph = &mut self.builder.graph;
        let work = vectors::dot(graph, lambda, &value);
        let slopes = jacobian(graph, &[work], |symbol| match symbol {
            Symbol::Coordinate(k) if holonomic => moved.component(k),
            Symbol::Speed(k) if !holonomic => moved.component(k),
            _ => None,
        });
        let size = (moved.places.len() * d) as u32;
        let own = (0..size).flat_map(|k| [Symbol::Coordinate, Symbol::Speed].map(|of| of(moved.first as u32 + k)));
        let unmoved: FxHashMap<Symbol, Id> = own.map(|symbol| (symbol, Id::ZERO)).collect();
        let mut forces: Vec<Acting> = Vec::new();
        let mut last = None;
        for (component, slope) in slopes.into_iter().flatten() {
            let slope = substitute(graph, &[slope], &unmoved)[0];
            if last != Some(component / d) {
                let (body, at) = moved.places[component / d].clone();
                forces.push((body, at, vec![Id::ZERO; d]));
                last = Some(component / d);
            }
            if let Some((_, _, force)) = forces.last_mut() {
                force[component % d] = slope;
            }
        }
        forces
    }

    fn value_when_moved(&mut self, item: &Item, moved: &Moved) -> Option<Vec<Id>> {
        let value = match item.written.as_ref()? {
            Written::One(text) => {
                let (left, right) = self.builder.sides(&moved.scope, text, item.rules, &item.locals)?;
                value::add(&mut self.builder.graph, &left, &right, true)?
            }
            written => self.builder.written(&moved.scope, written, item.rules, &item.locals),
        };
        Some(value.components().to_vec()).filter(|components| !components.is_empty())
    }

    /// The force λ of P − Q = 0 on what P is of, at Q, where both are; on Q if the rest does not move; at P where Q has no name.
    fn force_where_points_meet(&mut self, lambda: &[Id], value: &[Id], named: &[Acting]) -> Option<Acting> {
        let minus = vectors::negative(&mut self.builder.graph, lambda);
        if let Some((body, at, _)) = named.iter().find(|(_, _, force)| *force == minus) {
            let rest = vectors::add(&mut self.builder.graph, value, at);
            return match self.moves(&rest) || !self.moves(at) {
                true => Some((None, at.clone(), lambda.to_vec())),
                false => Some((*body, at.clone(), minus)),
            };
        }
        named.iter().find(|(_, _, force)| force == lambda).cloned()
    }

    /// The points P of `velocity(B, P)` in a constraint, by the body B, where each is the only one of its body.
    fn material_points(&mut self, item: &Item) -> Vec<(usize, Vector)> {
        let texts = match &item.written {
            Some(Written::One(text)) => std::slice::from_ref(text),
            Some(Written::List(texts, _)) => texts,
            None => &[],
        };
        let mut points: Vec<(usize, Vector)> = Vec::new();
        let mut several = Vec::new();
        for text in texts {
            let mut pairs = Vec::new();
            material_calls(&text.ast, &mut pairs);
            for (body, point) in pairs {
                let part = Text { ast: Rc::new(point.clone()), unit: None, ..text.clone() };
                let at = self.builder.vector(&self.scope, &Written::One(part), item.rules, &item.locals);
                let (Some(at), Some(body)) = (at, self.body_named(body, text, item)) else { continue };
                match points.iter().find(|(known, _)| *known == body) {
                    Some((_, known)) if *known == at => {}
                    Some(_) => several.push(body),
                    None => points.push((body, at)),
                }
            }
        }
        points.retain(|(body, _)| !several.contains(body));
        points
    }

    fn body_named(&mut self, ast: &Ast, text: &Text, item: &Item) -> Option<usize> {
        let part = Text { ast: Rc::new(ast.clone()), unit: None, ..text.clone() };
        let at = self.builder.vector(&self.scope, &Written::One(part), item.rules, &item.locals)?;
        let AstKind::Name { name, .. } = &ast.kind else { return None };
        let of_name = |body: &str| body.split('[').next() == Some(name.as_str());
        let is = |names: &crate::model::expression::scope::BodyNames| {
            of_name(&names.name)
                && matches!(self.scope.value(names.position), Some(Value::Vector(known)) if *known == at)
        };
        self.scope.bodies.iter().position(is)
    }

    /// The forces of a constraint that is written in coordinates, where all of these are places of bodies or points as they stand.
    fn forces_by_coordinates(&mut self, lambda: &[Id], value: &[Id], holonomic: bool, moved: &Moved) -> Vec<Acting> {
        let d = self.scope.dimension;
        let work = vectors::dot(&mut self.builder.graph, lambda, value);
        let slopes = jacobian(&mut self.builder.graph, &[work], |symbol| match symbol {
            Symbol::Coordinate(k) if holonomic => Some(k as usize),
            Symbol::Speed(k) if !holonomic => Some(k as usize),
            _ => None,
        });
        let mut forces: Vec<(usize, Vector)> = Vec::new();
        for (coordinate, slope) in slopes.into_iter().flatten() {
            let symbol = Symbol::Coordinate(coordinate as u32);
            let is = |id: &Id| matches!(self.builder.graph.node(*id), Node::Symbol(known) if known == symbol);
            let of = |(place, (_, at)): (usize, &(Option<usize>, Vector))| Some((place, at.iter().position(is)?));
            let Some((place, component)) = moved.places.iter().enumerate().find_map(of) else { return Vec::new() };
            match forces.iter_mut().find(|(known, _)| *known == place) {
                Some((_, force)) => force[component] = slope,
                None => {
                    let mut force = vec![Id::ZERO; d];
                    force[component] = slope;
                    forces.push((place, force));
                }
            }
        }
        let placed = |(place, force): (usize, Vector)| {
            let (body, at) = moved.places[place].clone();
            (body, at, force)
        };
        forces.into_iter().map(placed).collect()
    }

    /// The force of each joint on its first side, where its second side has its point.
    fn forces_of_joints(&mut self, found: &mut Found) {
        for joint in self.scope.joints.clone() {
            let point = joint.rows.iter().find_map(|(_, row)| match row {
                JointRow::Meet { points } | JointRow::Keep { points, .. } => Some(points[1]),
                _ => None,
            });
            let at = point.and_then(|item| self.scope.value(item)).map(|value| value.components().to_vec());
            let force = self.force_of(&joint.name).filter(|_| !joint.one_point);
            if let (Some(at), Some(force)) = (at, force) {
                found.add(self, PointForce { name: joint.name.clone(), body: None, at, force });
            }
            found.note(&joint.name);
        }
    }

    /// `reaction(joint)`.
    fn force_of(&mut self, joint: &str) -> Option<Vector> {
        let source = format!("reaction({joint})");
        let ast = Rc::new(parse(&source).ok()?);
        let text = Text { source: source.into(), ast, unit: None, place: Rc::default() };
        match self.builder.value(&self.scope, &text, Rules::anything("a force"), &[]) {
            Value::Vector(force) => Some(force),
            _ => None,
        }
    }
}

/// B and P of each `velocity(B, P)`.
fn material_calls<'a>(ast: &'a Ast, found: &mut Vec<(&'a Ast, &'a Ast)>) {
    match &ast.kind {
        AstKind::Number(_) | AstKind::Name { .. } => {}
        AstKind::Negate(inner) | AstKind::Component(inner, _) => material_calls(inner, found),
        AstKind::Binary(_, left, right) => [left, right].into_iter().for_each(|side| material_calls(side, found)),
        AstKind::Vector(parts) => parts.iter().for_each(|part| material_calls(part, found)),
        AstKind::Call { function, arguments, .. } => {
            if let ("velocity", [body, point]) = (function.as_str(), arguments.as_slice()) {
                found.push((body, point));
            }
            arguments.iter().for_each(|argument| material_calls(argument, found));
        }
        AstKind::Sum(body, _) | AstKind::Integral(body, _) => material_calls(body, found),
    }
}
