//! The generalized force of every entry of a file, one by one.

use crate::derive::lagrange::{coordinate_entry, speed_gradient};
use crate::derive::rates;
use crate::diagnose::Place;
use crate::expr::{Graph, Id, Symbol, reverse, vectors};
use crate::model::{Body, Load, Model, Work};

/// What an entry is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// An entry of `forces`, `torques` or `generalized_forces`.
    Force,
    /// A damper, or a spring whose tension has no potential.
    Resistance,
    /// `dissipation`.
    Dissipation,
    /// Gravity on one body.
    Gravity,
    /// A spring.
    Spring,
    /// `potential_energy`.
    RawPotential,
}

/// What one entry does.
#[derive(Clone, Debug)]
pub(super) struct Effect {
    /// Its label, or the coordinate on which it acts.
    pub name: String,
    /// What it is called in messages: `push`, the generalized force on `x`.
    pub words: String,
    /// What it is.
    pub kind: Kind,
    /// Where it stands.
    pub place: Place,
    /// Its generalized force Q, by coordinate.
    pub force: Vec<Id>,
    /// The one coordinate on which an entry of `generalized_forces` acts.
    pub coordinate: Option<usize>,
}

impl Kind {
    /// Whether `energy` counts a potential of it.
    pub fn counted(self) -> bool {
        matches!(self, Kind::Gravity | Kind::Spring | Kind::RawPotential)
    }
}

/// A force or a couple of size 1 in the place of an entry of `forces` or `torques`: at the same material, and with the same
/// opposite.
#[derive(Clone, Debug)]
pub struct UnitPush {
    /// The graph of the expressions.
    pub graph: Graph,
    /// The components of the entry's own force or couple.
    pub given: Vec<Id>,
    /// For each of them, the generalized forces Q of 1 along its axis, by coordinate.
    pub along: Vec<Vec<Id>>,
    /// Whether it is a couple.
    pub couple: bool,
}

/// What 1 in the place of this entry does; `None` where no force or torque has this name.
pub fn unit_push(model: &Model, name: &str) -> Option<UnitPush> {
    let load = model.loads.iter().find(|load| load.name == name && load.work == Work::Pushes)?;
    let couple = load.pushes.iter().all(|push| push.force.iter().all(|f| *f == Id::ZERO));
    let first = load.pushes.first()?;
    let given = if couple { first.couple.clone() } else { first.force.clone() };
    let mut graph = model.graph.clone();
    let (velocities, angular) = velocities(&mut graph, model);
    let mut along = Vec::new();
    for k in 0..given.len() {
        let mut unit = load.clone();
        for (place, push) in unit.pushes.iter_mut().enumerate() {
            // After the entry's own push comes its opposite.
            let one = if place == 0 { Id::ONE } else { graph.integer(-1) };
            push.force.iter_mut().chain(&mut push.couple).for_each(|component| *component = Id::ZERO);
            let component = if couple { &mut push.couple[k] } else { &mut push.force[k] };
            *component = one;
        }
        along.push(pushed(&mut graph, model, &unit, &velocities, &angular));
    }
    Some(UnitPush { graph, given, along, couple })
}

/// Velocities of all bodies' centres of mass, and angular velocities.
fn velocities(graph: &mut Graph, model: &Model) -> (Vec<Vec<Id>>, Vec<Vec<Id>>) {
    let places: Vec<Id> = model.bodies.iter().flat_map(|body| body.position.iter().copied()).collect();
    let mut rest = rates(graph, &places).into_iter();
    let linear = model.bodies.iter().map(|body| rest.by_ref().take(body.position.len()).collect()).collect();
    let turning = |body: &Body| match &body.rotation {
        Some(rotation) => rotation.angular_velocity(|angle| rates(graph, &[angle])[0]),
        None => Vec::new(),
    };
    (linear, model.bodies.iter().map(turning).collect())
}

/// All entries that act, in the file's order of sections; the true functions, without modes.  They live in a copy of
/// the model's graph: what is formed to judge forces by is no part of the equations.
pub(super) fn effects(model: &Model) -> (Graph, Vec<Effect>) {
    let mut copy = model.graph.clone();
    let graph = &mut copy;
    let n = model.coordinates.len();
    let (velocities, angular) = velocities(graph, model);
    let mut found = Vec::new();
    for load in &model.loads {
        let (kind, force) = match load.work {
            Work::Potential(potential) => (Kind::Spring, downhill(graph, n, potential)),
            Work::Resistance { rate, tension } => {
                let minus = graph.neg(tension);
                (Kind::Resistance, speed_gradient(graph, n, &[(rate, minus)]))
            }
            Work::Pushes => (Kind::Force, pushed(graph, model, load, &velocities, &angular)),
        };
        let (name, words) = (load.name.clone(), format!("`{}`", load.name));
        found.push(Effect { name, words, kind, place: load.place.clone(), force, coordinate: None });
    }
    for given in &model.generalized_forces {
        let mut force = vec![Id::ZERO; n];
        force[given.coordinate] = given.force;
        let name = model.coordinates[given.coordinate].name.clone();
        let words = format!("the generalized force on `{name}`");
        let (coordinate, place) = (Some(given.coordinate), given.place.clone());
        found.push(Effect { name, words, kind: Kind::Force, place, force, coordinate });
    }
    if model.dissipation != Id::ZERO {
        let minus = graph.integer(-1);
        let force = speed_gradient(graph, n, &[(model.dissipation, minus)]);
        found.push(whole("dissipation", Kind::Dissipation, force));
    }
    if let Some(gravity) = &model.gravity {
        for body in &model.bodies {
            // m g·∂r/∂q, with a mass that may change too.
            let weight = |g: &Id| graph.mul(body.mass, *g);
            let weight: Vec<Id> = gravity.iter().map(weight).collect();
            let seeds: Vec<(Id, Id)> = body.position.iter().copied().zip(weight).collect();
            let gradient = reverse(graph, &seeds, |s| matches!(s, Symbol::Coordinate(_)));
            let force = (0..n).map(|i| coordinate_entry(&gradient, i)).collect();
            let words = format!("gravity on `{}`", body.name);
            found.push(Effect { words, ..whole("gravity", Kind::Gravity, force) });
        }
    }
    if model.raw_potential_energy != Id::ZERO {
        let force = downhill(graph, n, model.raw_potential_energy);
        found.push(whole("potential_energy", Kind::RawPotential, force));
    }
    (copy, found)
}

fn whole(key: &str, kind: Kind, force: Vec<Id>) -> Effect {
    let (name, words) = (key.to_owned(), format!("`{key}`"));
    Effect { name, words, kind, place: Place::default().key(key), force, coordinate: None }
}

/// −∂V/∂q.
pub(super) fn downhill(graph: &mut Graph, n: usize, potential: Id) -> Vec<Id> {
    let minus = graph.integer(-1);
    let gradient = reverse(graph, &[(potential, minus)], |s| matches!(s, Symbol::Coordinate(_)));
    (0..n).map(|i| coordinate_entry(&gradient, i)).collect()
}

/// Σ F·∂v/∂q' + M ∂ω/∂q' over a load's pushes, each force taken to the centre of mass.
fn pushed(graph: &mut Graph, model: &Model, load: &Load, velocities: &[Vec<Id>], angular: &[Vec<Id>]) -> Vec<Id> {
    let mut seeds = Vec::new();
    for push in &load.pushes {
        let Some(b) = push.body else { continue };
        seeds.extend(velocities[b].iter().copied().zip(push.force.iter().copied()));
        if model.bodies[b].rotation.is_none() {
            continue;
        }
        let arm = vectors::difference(graph, &model.bodies[b].position, &push.at);
        let mut moment = vectors::moment(graph, &arm, &push.force);
        if !push.couple.is_empty() {
            moment = vectors::add(graph, &moment, &push.couple);
        }
        seeds.extend(angular[b].iter().copied().zip(moment));
    }
    seeds.retain(|seed| seed.1 != Id::ZERO);
    speed_gradient(graph, model.coordinates.len(), &seeds)
}
