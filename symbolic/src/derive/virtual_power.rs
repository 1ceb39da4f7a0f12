//! Virtual power from the bodies: d'Alembert's principle by one reverse pass.
//!
//! With the generalized accelerations as inputs, one reverse pass over the bodies' positions and angles
//! with the wrenches (m a − F, I α − M) as cotangents gives Σ (∂r/∂q)·(m a − F) + (∂φ/∂q)(I α − M), that is
//! the residual F(q, q', q''), in O(n) operations and without knowing what is hinged to what.
//! M is its derivative by q'', h its value at q'' = 0.  (Lanczos, The Variational Principles of Mechanics, ch. IV.)

use super::{Dynamics, Equations, bias_rates, lagrange, mass_entries, rates};
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
    for (k, body) in dynamics.bodies.iter().enumerate() {
        let wrench = dynamics.wrenches.iter().find(|w| w.0 == k);
        let velocity = rates(graph, &body.position);
        let acceleration = second(graph, &velocity);
        for (axis, position) in body.position.iter().enumerate() {
            // m (a − g) − F
            let falling = graph.sub(acceleration[axis], dynamics.gravity[axis]);
            let inertial = graph.mul(body.mass, falling);
            let force = wrench.map_or(Id::ZERO, |w| w.1[axis]);
            seeds.push((*position, graph.sub(inertial, force)));
        }
        if let Some((angle, inertia)) = body.rotation {
            let omega = rates(graph, &[angle]);
            let alpha = second(graph, &omega)[0];
            let spin = graph.mul(inertia, alpha);
            let moment = wrench.map_or(Id::ZERO, |w| w.2);
            seeds.push((angle, graph.sub(spin, moment)));
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
