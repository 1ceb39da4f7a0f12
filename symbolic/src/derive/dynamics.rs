//! What the equations of motion are derived from: all expressions of the model that enter them, in canonical order and with modes.

use super::rates;
use super::switches::{self, Switch};
use crate::expr::{Graph, Id, canonical_sums, vectors};
use crate::model::{Model, Push, Rotation, Ways, Work};

/// What enters the equations of motion: the model's expressions in canonical form, with modes for
/// discontinuities.
#[derive(Clone, Debug)]
pub(crate) struct Dynamics {
    /// How many coordinates there are.
    pub n: usize,
    /// Bodies: mass, position, and how they turn.
    pub bodies: Vec<Inertial>,
    /// Gravity's acceleration, zeros if absent.
    pub gravity: Vec<Id>,
    /// Potential of everything but gravity on bodies.
    pub potential: Id,
    /// Kinetic energy beside the bodies'.
    pub raw_kinetic: Id,
    /// The same without that of rotations' lengths.
    pub written_kinetic: Id,
    /// The places of rotations' first numbers.
    pub rotations: Vec<usize>,
    /// Rayleigh's function.
    pub dissipation: Id,
    /// (rate, tension) of dampers.
    pub resistances: Vec<(Id, Id)>,
    /// Forces and couples on bodies as the file states them; each derivation reduces them by itself.
    pub pushes: Vec<Acting>,
    /// Generalized forces as written.
    pub generalized: Vec<(usize, Id)>,
    /// Rates of states of first order.
    pub state_rates: Vec<Id>,
    /// Inputs as functions of time, (u, u', u'').
    pub signals: Vec<[Id; 3]>,
    /// Discontinuities.
    pub switches: Vec<Switch>,
}

/// A body's inertia and where it is.
#[derive(Clone, Debug)]
pub(crate) struct Inertial {
    pub mass: Id,
    pub position: Vec<Id>,
    /// The same in space, along the axes of frames.
    pub ways: Ways,
    pub rotation: Option<Rotation>,
}

/// What a load does to a body.
#[derive(Clone, Debug)]
pub(crate) struct Acting {
    pub body: usize,
    /// The force, with the point at which it acts; empty for a couple alone.
    pub force: Vec<(Id, Id)>,
    /// The couple: one component in the plane, three in space; zeros if absent.
    pub couple: Vec<Id>,
}

impl Acting {
    /// A push whose numbers are taken from a list in turn: its point, force and couple; `None` on ground, where it does nothing.
    fn of(push: &Push, bodies: &[Inertial], dimension: usize, take: &mut impl FnMut() -> Id) -> Option<Acting> {
        let at: Vec<Id> = push.at.iter().map(|_| take()).collect();
        let force: Vec<Id> = push.force.iter().map(|_| take()).collect();
        let couple: Vec<Id> = push.couple.iter().map(|_| take()).collect();
        let body = push.body?;
        let at = if at.is_empty() { bodies[body].position.clone() } else { at };
        let force = at.into_iter().zip(force).collect();
        let none = vec![Id::ZERO; vectors::moment_size(dimension)];
        Some(Acting { body, force, couple: if couple.is_empty() { none } else { couple } })
    }
}

impl Dynamics {
    pub(super) fn of(model: &mut Model) -> Dynamics {
        let roots = expressions(model);
        let graph = &mut model.graph;
        let roots = canonical_sums(graph, &roots);
        let (roots, switches) = switches::introduce(graph, &roots, model.inputs.len());

        let mut next = roots.into_iter();
        let mut take = || next.next().unwrap_or(Id::ZERO);
        let (mut potential, raw_kinetic, written_kinetic, dissipation) = (take(), take(), take(), take());
        let bodies: Vec<Inertial> = model
            .bodies
            .iter()
            .map(|body| Inertial {
                mass: take(),
                position: body.position.iter().map(|_| take()).collect(),
                ways: body.ways.map(|_| take()),
                rotation: body.rotation.as_ref().map(|rotation| rotation.map(|_| take())),
            })
            .collect();
        let gravity = match &model.gravity {
            Some(g) => g.iter().map(|_| take()).collect(),
            None => vec![Id::ZERO; model.dimension],
        };
        let mut resistances = Vec::new();
        let mut pushes = Vec::new();
        for load in &model.loads {
            match load.work {
                Work::Potential(_) => {
                    let v = take();
                    potential = graph.add(potential, v);
                }
                Work::Resistance { .. } => resistances.push((take(), take())),
                Work::Pushes => {
                    let of_push = |push| Acting::of(push, &bodies, model.dimension, &mut take);
                    pushes.extend(load.pushes.iter().filter_map(of_push));
                }
            }
        }
        let generalized = model.generalized_forces.iter().map(|f| (f.coordinate, take())).collect();
        let state_rates = model.states.iter().map(|_| take()).collect();
        let values: Vec<Id> = model.inputs.iter().map(|_| take()).collect();
        let signals = with_rates(graph, &values);
        Dynamics {
            n: model.coordinates.len(),
            bodies,
            gravity,
            potential,
            raw_kinetic,
            written_kinetic,
            rotations: model.rotations.iter().map(|rotation| rotation.first).collect(),
            dissipation,
            resistances,
            pushes,
            generalized,
            state_rates,
            signals,
            switches,
        }
    }
}

/// Everything that enters the equations of motion, in one list, so that canonical order and modes are found for all together.
fn expressions(model: &mut Model) -> Vec<Id> {
    let kinetic = model.graph.add(model.raw_kinetic_energy, model.radial_energy);
    let mut roots: Vec<Id> = vec![model.raw_potential_energy, kinetic, model.raw_kinetic_energy, model.dissipation];
    for body in &model.bodies {
        roots.push(body.mass);
        roots.extend(&body.position);
        roots.extend(body.ways.ids());
        roots.extend(body.rotation.iter().flat_map(Rotation::ids));
    }
    roots.extend(model.gravity.iter().flatten());
    for load in &model.loads {
        match load.work {
            Work::Potential(v) => roots.push(v),
            Work::Resistance { rate, tension } => roots.extend([rate, tension]),
            Work::Pushes => {
                for push in &load.pushes {
                    roots.extend(push.at.iter().chain(&push.force).chain(&push.couple));
                }
            }
        }
    }
    roots.extend(model.generalized_forces.iter().map(|f| f.force));
    roots.extend(model.states.iter().map(|state| state.rate));
    roots.extend(model.inputs.iter().map(|input| input.signal[0]));
    roots
}

/// Functions of time with their first and second rates.
fn with_rates(graph: &mut Graph, values: &[Id]) -> Vec<[Id; 3]> {
    let first = rates(graph, values);
    let second = rates(graph, &first);
    values.iter().zip(first.iter().zip(&second)).map(|(u, (v, w))| [*u, *v, *w]).collect()
}
