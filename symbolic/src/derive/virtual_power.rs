//! Virtual power from the bodies: d'Alembert's principle by one reverse pass.
//!
//! With the generalized accelerations as inputs, one reverse pass over the bodies' positions and angles
//! with the wrenches (m a − F, I α − M) as cotangents gives Σ (∂r/∂q)·(m a − F) + (∂φ/∂q)(I α − M), that is
//! the residual F(q, q', q''), in O(n) operations and without knowing what is hinged to what.
//! M is its derivative by q'', h its value at q'' = 0.  (Lanczos, The Variational Principles of Mechanics, ch. IV.)

use super::{Dynamics, Equations, Inertial, bias_rates, lagrange, mass_entries, rates};
use crate::expr::{Graph, Id, Symbol, reverse};

/// M, h and F from the bodies.
pub(crate) fn equations(graph: &mut Graph, dynamics: &Dynamics) -> Equations {
    let with_accelerations = residual(graph, dynamics, rates);
    let bias = residual(graph, dynamics, bias_rates);
    let mass = mass_entries(graph, &with_accelerations, |s| match s {
        Symbol::Acceleration(j) => Some(j as usize),
        _ => None,
    });
    Equations { name: "virtual power", mass, bias, residual: with_accelerations }
}

/// The reverse pass; `second` differentiates velocities once more, with or without accelerations.
fn residual(graph: &mut Graph, dynamics: &Dynamics, second: fn(&mut Graph, &[Id]) -> Vec<Id>) -> Vec<Id> {
    let mut seeds: Vec<(Id, Id)> = vec![(dynamics.potential, Id::ONE)];
    // Of all bodies together, since a body's position mostly contains that of another.
    let places = dynamics.bodies.iter().flat_map(|b| b.position.iter().copied().chain(b.rotation.map(|r| r.0)));
    let velocities = rates(graph, &places.collect::<Vec<_>>());
    let mut accelerations = second(graph, &velocities).into_iter();
    let wrenches = wrenches(graph, dynamics);
    for (body, wrench) in dynamics.bodies.iter().zip(wrenches) {
        for (axis, position) in body.position.iter().enumerate() {
            // m (a − g) − F
            let acceleration = accelerations.next().unwrap_or(Id::ZERO);
            let falling = graph.sub(acceleration, dynamics.gravity[axis]);
            let inertial = graph.mul(body.mass, falling);
            seeds.push((*position, graph.sub(inertial, wrench.force[axis])));
        }
        if let Some((angle, inertia)) = body.rotation {
            let alpha = accelerations.next().unwrap_or(Id::ZERO);
            let spin = graph.mul(inertia, alpha);
            seeds.push((angle, graph.sub(spin, wrench.moment)));
        }
    }
    // What no body carries: raw kinetic energies, dampers, forces as written.
    if dynamics.raw_kinetic != Id::ZERO {
        seeds.push((dynamics.raw_kinetic, graph.integer(-1)));
    }
    let gradient = reverse(graph, &seeds, |s| matches!(s, Symbol::Coordinate(_)));
    let momenta = lagrange::speed_gradient(graph, dynamics.n, &[(dynamics.raw_kinetic, Id::ONE)]);
    let momentum_rates = second(graph, &momenta);
    let resisting = lagrange::speed_gradient(graph, dynamics.n, &lagrange::speed_seeds(dynamics));
    let resisting = lagrange::with_generalized(graph, dynamics, resisting);
    (0..dynamics.n)
        .map(|i| {
            let sum = graph.add(lagrange::coordinate_entry(&gradient, i), momentum_rates[i]);
            graph.add(sum, resisting[i])
        })
        .collect()
}

/// What acts on a body, all loads together.
struct Wrench {
    force: Vec<Id>,
    /// About the centre of mass.
    moment: Id,
}

/// Every body's loads, reduced to its centre of mass.
fn wrenches(graph: &mut Graph, dynamics: &Dynamics) -> Vec<Wrench> {
    let free = |body: &Inertial| Wrench { force: vec![Id::ZERO; body.position.len()], moment: Id::ZERO };
    let mut wrenches: Vec<Wrench> = dynamics.bodies.iter().map(free).collect();
    for push in &dynamics.pushes {
        let (body, wrench) = (&dynamics.bodies[push.body], &mut wrenches[push.body]);
        for (sum, (_, force)) in wrench.force.iter_mut().zip(&push.force) {
            *sum = graph.add(*sum, *force);
        }
        let mut moment = push.couple;
        if body.rotation.is_some()
            && let [(x, along), (y, up)] = push.force[..]
        {
            let (arm_x, arm_y) = (graph.sub(x, body.position[0]), graph.sub(y, body.position[1]));
            let (turning, back) = (graph.mul(arm_x, up), graph.mul(arm_y, along));
            let turning = graph.sub(turning, back);
            moment = graph.add(moment, turning);
        }
        wrench.moment = graph.add(wrench.moment, moment);
    }
    wrenches
}
