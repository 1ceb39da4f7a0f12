//! Virtual power from the bodies: d'Alembert's principle by one reverse pass.
//!
//! With the generalized accelerations as inputs, one reverse pass over the bodies' positions and angles
//! with the wrenches (m a − F, I α − M) as cotangents gives Σ (∂r/∂q)·(m a − F) + (∂φ/∂q)(I α − M), that is
//! the residual F(q, q', q''), in O(n) operations and without knowing what is hinged to what.
//! M is its derivative by q'', h its value at q'' = 0.  (Lanczos, The Variational Principles of Mechanics, ch. IV.)
//! In space the nine components of a body's unit vectors stand for its angle: how its frame is turned is not used, and the angular velocity
//! comes from these components alone, so that a mistake of the recursion that Lagrange's energies use shows.

use super::{Derivative, Dynamics, Equations, Inertial, lagrange, rates};
use crate::expr::{Graph, Id, Rational, Symbol, reverse, vectors};
use crate::model::{Rotation, product};

/// M and h, where they are to be `formed`, and F from the bodies.
pub(crate) fn equations(graph: &mut Graph, dynamics: &Dynamics, formed: bool) -> Equations {
    Equations::of_residual(graph, "virtual power", formed, |graph, second| residual(graph, dynamics, second))
}

/// The reverse pass; `second` differentiates velocities once more, with or without accelerations.
fn residual(graph: &mut Graph, dynamics: &Dynamics, second: Derivative) -> Vec<Id> {
    let mut seeds: Vec<(Id, Id)> = Vec::new();
    // Of all bodies together, since a body's position mostly contains that of another.
    let attitude = |b: &Inertial| b.rotation.as_ref().map(Rotation::attitude).unwrap_or_default();
    let places = dynamics.bodies.iter().flat_map(|b| b.position.iter().copied().chain(attitude(b)));
    let velocities = rates(graph, &places.collect::<Vec<_>>());
    let mut accelerations = second(graph, &velocities).into_iter();
    let mut velocities = velocities.into_iter();
    let wrenches = wrenches(graph, dynamics);
    for (body, wrench) in dynamics.bodies.iter().zip(wrenches) {
        for (axis, position) in body.position.iter().enumerate() {
            // m (a − g) − F
            velocities.next();
            let acceleration = accelerations.next().unwrap_or(Id::ZERO);
            let falling = graph.sub(acceleration, dynamics.gravity[axis]);
            let inertial = graph.mul(body.mass, falling);
            seeds.push((*position, graph.sub(inertial, wrench.force[axis])));
        }
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { angle, inertia }) => {
                velocities.next();
                let alpha = accelerations.next().unwrap_or(Id::ZERO);
                let spin = graph.mul(*inertia, alpha);
                seeds.push((*angle, graph.sub(spin, wrench.moment[0])));
            }
            Some(Rotation::Space { frame, inertia }) => {
                let columns = [(); 3].map(|()| [(); 3].map(|()| velocities.next().unwrap_or(Id::ZERO)));
                let second = [(); 3].map(|()| [(); 3].map(|()| accelerations.next().unwrap_or(Id::ZERO)));
                let rate = euler_moment(graph, [&frame.axes, &columns, &second], inertia);
                let moment = frame.in_ground(graph, rate);
                let missing = vectors::difference(graph, &wrench.moment, &moment);
                for axis in &frame.axes {
                    // ½ Σ (M × cᵢ)·δcᵢ = M·δφ, since δcᵢ = δφ × cᵢ.
                    for (component, pull) in axis.iter().zip(vectors::cross_space(graph, &missing, axis)) {
                        seeds.push((*component, halved(graph, pull)));
                    }
                }
            }
        }
    }
    beside_bodies(graph, dynamics, second, seeds)
}

/// Adds what no body carries: potentials, raw kinetic energies, dampers, forces as written.
pub(super) fn beside_bodies(
    graph: &mut Graph,
    dynamics: &Dynamics,
    second: Derivative,
    mut seeds: Vec<(Id, Id)>,
) -> Vec<Id> {
    seeds.push((dynamics.potential, Id::ONE));
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

/// I α + ω × I ω along a body's own axes, from its unit vectors cᵢ and their derivatives alone: ω = ½ Σ cᵢ × cᵢ', α = ½ Σ cᵢ × cᵢ''.
fn euler_moment(graph: &mut Graph, [axes, first, second]: [&[[Id; 3]; 3]; 3], inertia: &[Id; 6]) -> [Id; 3] {
    let [omega, alpha] = [first, second].map(|rates| {
        let mut sum = vec![Id::ZERO; 3];
        for (axis, rate) in axes.iter().zip(rates) {
            let product = vectors::cross_space(graph, axis, rate);
            sum = vectors::add(graph, &sum, &product);
        }
        let half: Vec<Id> = sum.into_iter().map(|x| halved(graph, x)).collect();
        axes.map(|axis| vectors::dot(graph, &axis, &half))
    });
    let (momentum, gained) = (product(graph, inertia, &omega), product(graph, inertia, &alpha));
    let gyroscopic = vectors::cross_space(graph, &omega, &momentum);
    std::array::from_fn(|k| graph.add(gained[k], gyroscopic[k]))
}

fn halved(graph: &mut Graph, x: Id) -> Id {
    let half = graph.rational(Rational::new(1, 2).unwrap_or(Rational::ONE));
    graph.mul(half, x)
}

/// What acts on a body, all loads together.
pub(super) struct Wrench {
    pub force: Vec<Id>,
    /// About the centre of mass: one component in the plane.
    pub moment: Vec<Id>,
}

/// Every body's loads, reduced to its centre of mass.
pub(super) fn wrenches(graph: &mut Graph, dynamics: &Dynamics) -> Vec<Wrench> {
    let free = |body: &Inertial| Wrench {
        force: vec![Id::ZERO; body.position.len()],
        moment: vec![Id::ZERO; vectors::moment_size(body.position.len())],
    };
    let mut wrenches: Vec<Wrench> = dynamics.bodies.iter().map(free).collect();
    for push in &dynamics.pushes {
        let (body, wrench) = (&dynamics.bodies[push.body], &mut wrenches[push.body]);
        let (at, force): (Vec<Id>, Vec<Id>) = push.force.iter().copied().unzip();
        if !force.is_empty() {
            wrench.force = vectors::add(graph, &wrench.force, &force);
        }
        let mut moment = push.couple.clone();
        if body.rotation.is_some() && !force.is_empty() {
            let arm = vectors::difference(graph, &body.position, &at);
            let turning = vectors::moment(graph, &arm, &force);
            moment = vectors::add(graph, &moment, &turning);
        }
        wrench.moment = vectors::add(graph, &wrench.moment, &moment);
    }
    wrenches
}
