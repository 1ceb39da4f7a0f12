//! Lagrange's equations from the energies.
//!
//! With p = ∂T/∂q' (one reverse pass), M = ∂p/∂q' (one forward pass) and
//! h = dp/dt at q'' = 0 − ∂T/∂q + ∂V/∂q − Q.  Christoffel symbols are never formed.  Masses that change are held meanwhile: look in
//! `changing_mass`.

use rustc_hash::FxHashMap as HashMap;

use super::changing_mass::HeldMasses;
use super::{Acting, Dynamics, Energies, Equations, bias_rates, mass_entries, rates};
use crate::expr::{Forward, Graph, Id, Number, Rational, Symbol, Unary, reverse, terms, vectors};
use crate::model::{Model, Rotation};

/// M and h, where they are to be `formed`, and F from the energies; and for each coordinate its momentum and minus the rate of that,
/// −∂L/∂q − Q (less what masses that change add).
pub(crate) fn equations(graph: &mut Graph, dynamics: &Dynamics, formed: bool) -> (Equations, Vec<(Id, Id)>) {
    let n = dynamics.n;
    let mut held = dynamics.clone();
    let masses = HeldMasses::hold(graph, &mut held);
    let dynamics = &held;
    let velocities = Velocities::of(graph, dynamics);
    let kinetic = kinetic_energy(graph, dynamics, &velocities);
    let potential = potential_energy(graph, dynamics);

    let momenta = speed_gradient(graph, n, &[(kinetic, Id::ONE)]);
    let speed = |s: Symbol| if let Symbol::Speed(j) = s { Some(j as usize) } else { None };
    let mut mass = if formed { mass_entries(graph, &momenta, speed) } else { Vec::new() };

    let minus = graph.integer(-1);
    let gradient = reverse(graph, &[(kinetic, minus), (potential, Id::ONE)], |s| matches!(s, Symbol::Coordinate(_)));
    let resisting = resisting_forces(graph, dynamics, &velocities);
    let rest: Vec<Id> = (0..n).map(|i| graph.add(coordinate_entry(&gradient, i), resisting[i])).collect();

    let bias = if formed { bias_rates(graph, &momenta) } else { Vec::new() };
    let full = rates(graph, &momenta);
    let mut complete = |momentum_rates: Vec<Id>| -> Vec<Id> {
        momentum_rates.iter().zip(&rest).map(|(&p, &r)| graph.add(p, r)).collect()
    };
    let (mut bias, mut residual) = (complete(bias), complete(full));
    let less_gained = |(&momentum, &rest): (&Id, &Id)| {
        let gained = masses.rate_by_masses(graph, momentum);
        (momentum, graph.sub(rest, gained))
    };
    let mut balances: Vec<(Id, Id)> = momenta.iter().zip(&rest).map(less_gained).collect();
    let of_motion = mass.iter_mut().map(|entry| &mut entry.2).chain(&mut bias).chain(&mut residual);
    masses.put_in(graph, of_motion.chain(balances.iter_mut().flat_map(|(momentum, rest)| [momentum, rest])));
    (Equations { name: "Lagrange", mass, bias, residual }, balances)
}

/// T and V with the true functions, since they are observed; the Jacobi function and its power with modes, since they
/// are integrated.
pub(crate) fn energies(model: &mut Model, dynamics: &Dynamics) -> Energies {
    let graph = &mut model.graph;
    let mut held = dynamics.clone();
    let masses = HeldMasses::hold(graph, &mut held);
    let dynamics = &held;
    let velocities = Velocities::of(graph, dynamics);
    let (mut kinetic, mut potential) =
        (kinetic_energy(graph, dynamics, &velocities), potential_energy(graph, dynamics));
    let [moving, lifted] = [kinetic, potential].map(|energy| without_time_alone(graph, energy));
    let momenta = speed_gradient(graph, dynamics.n, &[(moving, Id::ONE)]);
    let mut jacobi = Id::ZERO;
    for (i, p) in momenta.iter().enumerate() {
        let v = graph.symbol(Symbol::Speed(i as u32));
        let term = graph.mul(v, *p);
        jacobi = graph.add(jacobi, term);
    }
    jacobi = graph.sub(jacobi, moving);
    jacobi = graph.add(jacobi, lifted);

    // Explicit time, through t itself, inputs and states of first order.
    let lagrangian = graph.sub(lifted, moving);
    let mut power = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        Symbol::Input(..) | Symbol::State(_) => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
        _ => Id::ZERO,
    })
    .of(graph, lagrangian);
    for (i, resisting) in resisting_forces(graph, dynamics, &velocities).into_iter().enumerate() {
        let v = graph.symbol(Symbol::Speed(i as u32));
        let term = graph.mul(v, resisting);
        power = graph.sub(power, term);
    }
    let gained = masses.rate_by_masses(graph, jacobi);
    power = graph.add(power, gained);
    masses.put_in(graph, [&mut kinetic, &mut potential, &mut jacobi, &mut power]);

    let mut scale = Id::ZERO;
    for term in model.kinetic_terms.iter().chain(&model.potential_terms) {
        let size = graph.unary(Unary::Abs, *term);
        scale = graph.add(scale, size);
    }
    let observed = super::switches::remove(graph, &[kinetic, potential], &dynamics.switches);
    Energies { kinetic: observed[0], potential: observed[1], jacobi, power, scale }
}

/// An energy without terms that time or inputs alone change, as that of a body which an input moves: they act on no coordinate, and steps that follow
/// the motion would not see how fast they change.
fn without_time_alone(graph: &mut Graph, energy: Id) -> Id {
    let of_time = |symbol: Symbol| matches!(symbol, Symbol::Time | Symbol::Input(..));
    let [timed, other] = [true, false].map(|wants| {
        graph.contains(|symbol| if wants { of_time(symbol) } else { symbol.may_change() && !of_time(symbol) })
    });
    let all = terms(graph, energy);
    let acts = |(term, _): &&(Id, Number)| other[term.index()] || !timed[term.index()];
    let kept: Vec<(Id, Number)> = all.iter().filter(acts).copied().collect();
    if kept.len() == all.len() {
        return energy;
    }
    kept.into_iter().fold(Id::ZERO, |sum, (term, coefficient)| {
        let factor = graph.constant(coefficient);
        let product = graph.mul(factor, term);
        graph.add(sum, product)
    })
}

/// Velocities of centres of mass and angular velocities.
struct Velocities {
    linear: Vec<Vec<Id>>,
    /// In ground axes; empty for particles.
    angular: Vec<Vec<Id>>,
}

impl Velocities {
    fn of(graph: &mut Graph, dynamics: &Dynamics) -> Velocities {
        // Of all bodies together, since a body's position mostly contains that of another.
        let places: Vec<Id> = dynamics.bodies.iter().flat_map(|b| b.position.iter().copied()).collect();
        let mut velocities = rates(graph, &places).into_iter();
        let linear = dynamics.bodies.iter().map(|b| velocities.by_ref().take(b.position.len()).collect()).collect();
        let angle = |b: &super::Inertial| match b.rotation {
            Some(Rotation::Plane { angle, .. }) => angle,
            _ => Id::ZERO,
        };
        let angles: Vec<Id> = dynamics.bodies.iter().map(angle).collect();
        let turning = |(b, omega): (&super::Inertial, Id)| match &b.rotation {
            Some(rotation) => rotation.angular_velocity(|_| omega),
            None => Vec::new(),
        };
        let angular = dynamics.bodies.iter().zip(rates(graph, &angles)).map(turning).collect();
        Velocities { linear, angular }
    }

    /// Of the body's material at the point where a force acts: v + ω × arm.
    fn of_material(&self, graph: &mut Graph, dynamics: &Dynamics, push: &Acting) -> Vec<Id> {
        let body = &dynamics.bodies[push.body];
        let centre = &self.linear[push.body];
        let omega = &self.angular[push.body];
        if omega.is_empty() || push.force.is_empty() {
            return centre.clone();
        }
        let at: Vec<Id> = push.force.iter().map(|(at, _)| *at).collect();
        let arm = vectors::difference(graph, &body.position, &at);
        let turning = vectors::swept(graph, omega, &arm);
        vectors::add(graph, centre, &turning)
    }
}

fn kinetic_energy(graph: &mut Graph, dynamics: &Dynamics, velocities: &Velocities) -> Id {
    let mut doubled = Id::ZERO;
    for (k, body) in dynamics.bodies.iter().enumerate() {
        let mut square = Id::ZERO;
        for v in &velocities.linear[k] {
            let term = graph.mul(*v, *v);
            square = graph.add(square, term);
        }
        let moving = graph.mul(body.mass, square);
        doubled = graph.add(doubled, moving);
        if let Some(rotation) = &body.rotation {
            let omega = match rotation {
                Rotation::Plane { .. } => velocities.angular[k].clone(),
                Rotation::Space { frame, .. } => frame.own_velocity.to_vec(),
            };
            let turning = rotation.doubled_energy(graph, &omega);
            doubled = graph.add(doubled, turning);
        }
    }
    let half = graph.rational(Rational::new(1, 2).unwrap_or(Rational::ONE));
    let kinetic = graph.mul(half, doubled);
    graph.add(kinetic, dynamics.raw_kinetic)
}

fn potential_energy(graph: &mut Graph, dynamics: &Dynamics) -> Id {
    let mut potential = dynamics.potential;
    for body in &dynamics.bodies {
        for (g, r) in dynamics.gravity.iter().zip(&body.position) {
            let height = graph.mul(*g, *r);
            let lift = graph.mul(body.mass, height);
            potential = graph.sub(potential, lift);
        }
    }
    potential
}

/// −Q of everything without a potential: Rayleigh's function, dampers, loads on bodies, forces as written.
fn resisting_forces(graph: &mut Graph, dynamics: &Dynamics, velocities: &Velocities) -> Vec<Id> {
    let mut seeds = speed_seeds(dynamics);
    for push in &dynamics.pushes {
        // Q = F·∂v/∂q' + M ∂ω/∂q', v of the body's material where the force acts.
        for (v, (_, force)) in velocities.of_material(graph, dynamics, push).into_iter().zip(&push.force) {
            seeds.push((v, graph.neg(*force)));
        }
        for (omega, couple) in velocities.angular[push.body].iter().zip(&push.couple) {
            seeds.push((*omega, graph.neg(*couple)));
        }
    }
    let forces = speed_gradient(graph, dynamics.n, &seeds);
    with_generalized(graph, dynamics, forces)
}

/// Seeds whose gradient by the speeds gives the resistance of dampers and of Rayleigh's function.
pub(crate) fn speed_seeds(dynamics: &Dynamics) -> Vec<(Id, Id)> {
    let mut seeds = vec![(dynamics.dissipation, Id::ONE)];
    seeds.extend(&dynamics.resistances);
    seeds
}

/// Subtracts the generalized forces as written.
pub(crate) fn with_generalized(graph: &mut Graph, dynamics: &Dynamics, mut forces: Vec<Id>) -> Vec<Id> {
    for (i, q) in &dynamics.generalized {
        forces[*i] = graph.sub(forces[*i], *q);
    }
    forces
}

/// The gradient of Σ seed·root by every speed.
pub(crate) fn speed_gradient(graph: &mut Graph, n: usize, seeds: &[(Id, Id)]) -> Vec<Id> {
    let gradient = reverse(graph, seeds, |s| matches!(s, Symbol::Speed(_)));
    (0..n).map(|i| gradient.get(&Symbol::Speed(i as u32)).copied().unwrap_or(Id::ZERO)).collect()
}

/// One component of a gradient by the coordinates.
pub(crate) fn coordinate_entry(gradient: &HashMap<Symbol, Id>, i: usize) -> Id {
    gradient.get(&Symbol::Coordinate(i as u32)).copied().unwrap_or(Id::ZERO)
}
