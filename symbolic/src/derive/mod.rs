//! Equations of motion from a resolved model.
//!
//! 1. Discontinuities become modes: look in `switches`.
//! 2. Sums get one order: look in `expr/canonical`.
//! 3. Lagrange's equations from the energies: look in `lagrange`.
//! 4. Virtual power from the bodies: look in `virtual_power`.
//! 5. Momentum balances as linear equations for accelerations and reactions: look in `momentum`.
//!
//! Every derivation gives the same [`Equations`]; `gate` compares them, `lower` picks the cheapest.

pub(crate) mod lagrange;
pub(crate) mod momentum;
mod reactions;
mod switches;
mod virtual_power;

use crate::diagnose::Problem;
use crate::diagnose::catalogue::mechanics;
use crate::expr::{Forward, Graph, Id, Symbol, canonical};
use crate::model::{Load, Model, Work};

pub use momentum::Momentum;
pub(crate) use switches::introduce;
pub use switches::{Switch, SwitchKind, remove as without_modes};

/// M q'' + h = 0 as one derivation gives it.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Which derivation.
    pub name: &'static str,
    /// The non-zeros of M's lower triangle, row by row: (row, column, value).
    pub mass: Vec<(usize, usize, Id)>,
    /// h.
    pub bias: Vec<Id>,
    /// F(t, q, q', q'') = M q'' + h.
    pub residual: Vec<Id>,
}

/// What the energy balance needs.
#[derive(Clone, Copy, Debug)]
pub struct Energies {
    /// T.
    pub kinetic: Id,
    /// V.
    pub potential: Id,
    /// q'·∂T/∂q' − T + V.
    pub jacobi: Id,
    /// q'·Q − ∂T/∂t + ∂V/∂t.
    pub power: Id,
    /// Σ |terms of T and V|.
    pub scale: Id,
}

/// The outcome of deriving.
#[derive(Clone, Debug)]
pub struct Derivation {
    /// The model; its graph holds all results.
    pub model: Model,
    /// Equations by every derivation that applies; never empty.
    pub equations: Vec<Equations>,
    /// Systems of momentum balances, in the order of the model's.
    pub momentum: Vec<Momentum>,
    /// Output components, by place, that are a component of a reaction as it stands.
    pub named_reactions: Vec<(usize, Symbol)>,
    /// Energies for the balance.
    pub energies: Energies,
    /// Each coordinate's momentum, and the rate of that, −∂L/∂q − Q.
    pub momenta: Vec<(Id, Id)>,
    /// Inputs as functions of time, (u, u', u''), with modes.
    pub signals: Vec<[Id; 3]>,
    /// Discontinuities of the equations of motion and of inputs.
    pub switches: Vec<Switch>,
}

/// More coordinates than this would need a dense mass matrix beyond the limit of the graph.
const COORDINATE_LIMIT: usize = 2000;
/// More discontinuities than this cannot be located in reasonable time.
const SWITCH_LIMIT: usize = 1000;

/// Derives.
///
/// # Errors
/// The model is too large.
pub fn derive(mut model: Model) -> Result<Derivation, Vec<Problem>> {
    if let Some(extra) = model.coordinates.get(COORDINATE_LIMIT) {
        return Err(vec![mechanics::too_many_coordinates(extra.place.clone(), COORDINATE_LIMIT)]);
    }
    let dynamics = Dynamics::of(&mut model);
    if model.graph.overflowed() || dynamics.switches.len() > SWITCH_LIMIT {
        return Err(vec![too_large()]);
    }
    let (lagrange, momenta) = lagrange::equations(&mut model.graph, &dynamics);
    let mut equations = vec![lagrange];
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    if !dynamics.bodies.is_empty() {
        equations.push(virtual_power::equations(&mut model.graph, &dynamics));
    }
    let energies = lagrange::energies(&mut model, &dynamics);
    let (switches, signals) = (dynamics.switches, dynamics.signals);
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    let momentum = momentum::systems(&mut model, &switches);
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    let named_reactions = reactions::put_in(&mut model);
    Ok(Derivation { model, equations, momentum, named_reactions, energies, momenta, signals, switches })
}

/// What enters the equations of motion: the model's expressions in canonical form, with modes for
/// discontinuities.
pub(crate) struct Dynamics {
    /// How many coordinates there are.
    pub n: usize,
    /// Bodies: mass, position, and angle with inertia.
    pub bodies: Vec<Inertial>,
    /// Gravity's acceleration, zeros if absent.
    pub gravity: Vec<Id>,
    /// Potential of everything but gravity on bodies.
    pub potential: Id,
    /// Kinetic energy beside the bodies'.
    pub raw_kinetic: Id,
    /// Rayleigh's function.
    pub dissipation: Id,
    /// (rate, tension) of dampers.
    pub resistances: Vec<(Id, Id)>,
    /// Force and couple on each body, all loads together: (body, force, moment about the centre of mass).
    pub wrenches: Vec<(usize, Vec<Id>, Id)>,
    /// Generalized forces as written.
    pub generalized: Vec<(usize, Id)>,
    /// Inputs as functions of time, (u, u', u'').
    pub signals: Vec<[Id; 3]>,
    /// Discontinuities.
    pub switches: Vec<Switch>,
}

/// A body's inertia and where it is.
pub(crate) struct Inertial {
    pub mass: Id,
    pub position: Vec<Id>,
    pub rotation: Option<(Id, Id)>,
}

impl Dynamics {
    fn of(model: &mut Model) -> Dynamics {
        // Everything in one list, so that canonical order and modes are found for all together.
        let mut roots: Vec<Id> = vec![model.raw_potential_energy, model.raw_kinetic_energy, model.dissipation];
        for body in &model.bodies {
            roots.push(body.mass);
            roots.extend(&body.position);
            if let Some(rotation) = body.rotation {
                roots.extend([rotation.angle, rotation.inertia]);
            }
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
        roots.extend(model.inputs.iter().map(|input| input.signal[0]));
        let graph = &mut model.graph;
        let roots = canonical(graph, &roots);
        let (roots, switches) = switches::introduce(graph, &roots, model.inputs.len());

        let mut next = roots.into_iter();
        let mut take = || next.next().unwrap_or(Id::ZERO);
        let (mut potential, raw_kinetic, dissipation) = (take(), take(), take());
        let bodies: Vec<Inertial> = model
            .bodies
            .iter()
            .map(|body| Inertial {
                mass: take(),
                position: body.position.iter().map(|_| take()).collect(),
                rotation: body.rotation.map(|_| (take(), take())),
            })
            .collect();
        let gravity = match &model.gravity {
            Some(g) => g.iter().map(|_| take()).collect(),
            None => vec![Id::ZERO; model.dimension],
        };
        let mut resistances = Vec::new();
        let mut wrenches: Vec<(usize, Vec<Id>, Id)> = Vec::new();
        for load in &model.loads {
            match load.work {
                Work::Potential(_) => {
                    let v = take();
                    potential = graph.add(potential, v);
                }
                Work::Resistance { .. } => resistances.push((take(), take())),
                Work::Pushes => collect_pushes(graph, load, &bodies, &mut wrenches, &mut take),
            }
        }
        let generalized = model.generalized_forces.iter().map(|f| (f.coordinate, take())).collect();
        let values: Vec<Id> = model.inputs.iter().map(|_| take()).collect();
        let first = rates(graph, &values);
        let second = rates(graph, &first);
        let signals = values.iter().zip(first.iter().zip(&second)).map(|(u, (v, w))| [*u, *v, *w]).collect();
        Dynamics {
            n: model.coordinates.len(),
            bodies,
            gravity,
            potential,
            raw_kinetic,
            dissipation,
            resistances,
            wrenches,
            generalized,
            signals,
            switches,
        }
    }
}

/// Adds a load's pushes to the wrenches on bodies; what acts on ground does nothing.
fn collect_pushes(
    graph: &mut Graph,
    load: &Load,
    bodies: &[Inertial],
    wrenches: &mut Vec<(usize, Vec<Id>, Id)>,
    take: &mut impl FnMut() -> Id,
) {
    for push in &load.pushes {
        let at: Vec<Id> = push.at.iter().map(|_| take()).collect();
        let force: Vec<Id> = push.force.iter().map(|_| take()).collect();
        let couple: Vec<Id> = push.couple.iter().map(|_| take()).collect();
        let Some(body) = push.body else { continue };
        let mut moment = couple.first().copied().unwrap_or(Id::ZERO);
        if bodies[body].rotation.is_some() && !force.is_empty() && !at.is_empty() {
            let arm: Vec<Id> = at.iter().zip(&bodies[body].position).map(|(p, r)| graph.sub(*p, *r)).collect();
            let a = graph.mul(arm[0], force[1]);
            let b = graph.mul(arm[1], force[0]);
            let turning = graph.sub(a, b);
            moment = graph.add(moment, turning);
        }
        match wrenches.iter_mut().find(|w| w.0 == body) {
            Some((_, total, total_moment)) => {
                for (sum, f) in total.iter_mut().zip(&force) {
                    *sum = graph.add(*sum, *f);
                }
                *total_moment = graph.add(*total_moment, moment);
            }
            None => {
                let force = if force.is_empty() { vec![Id::ZERO; bodies[body].position.len()] } else { force };
                wrenches.push((body, force, moment));
            }
        }
    }
}

/// The problem of a graph that has reached its limit.
pub(crate) fn too_large() -> Problem {
    let place = crate::diagnose::Place::default().key("coordinates");
    crate::diagnose::catalogue::names::too_many_nodes(place, "1 000 000")
}

/// The total time derivative along the motion; accelerations appear where speeds are differentiated.
pub fn rate(graph: &mut Graph, root: Id) -> Id {
    rates(graph, &[root])[0]
}

/// Total time derivatives of several expressions.
pub fn rates(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    roots.iter().map(|r| forward.of(graph, *r)).collect()
}

/// Total time derivatives at zero generalized accelerations.
pub(crate) fn bias_rates(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        Symbol::Speed(_) => Id::ZERO,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    roots.iter().map(|r| forward.of(graph, *r)).collect()
}

/// M's lower triangle as the Jacobian of momenta (or of a residual) by the symbols that `column` numbers.
pub(crate) fn mass_entries(
    graph: &mut Graph,
    roots: &[Id],
    column: impl Fn(Symbol) -> Option<usize>,
) -> Vec<(usize, usize, Id)> {
    let rows = crate::expr::jacobian(graph, roots, column);
    let entries = rows.into_iter().enumerate();
    entries.flat_map(|(i, row)| row.into_iter().filter(move |e| e.0 <= i).map(move |(j, m)| (i, j, m))).collect()
}
