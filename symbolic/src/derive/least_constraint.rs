//! What accelerations make least: Gauss's principle in the form of Gibbs and Appell.
//!
//! With velocities yₖ that are linear in the speeds (components of velocities of centres of mass, and of angular velocities along a body's own
//! axes), yₖ' = Lₖ q'' + bₖ, where bₖ is what is left at q'' = 0, and the accelerations make
//!
//! G(q'') = ½ Σ wₖₗ (Lₖ q'') (Lₗ q'') + Σ gₖ Lₖ q'' + Σ hᵢ qᵢ''
//!
//! least: wₖₖ is a mass or moment of inertia, gₖ = Σ wₖₗ bₗ less what acts (gravity, loads, the moment that a turning body's own spin
//! asks for), and hᵢ is what acts on coordinates: slopes of potentials, dampers, forces as written.  ∂G/∂q'' = M q'' + h without M being
//! formed.  A kinetic energy that the file writes out is a sum of products of linear velocities, which are the w; what it adds to h
//! is d/dt ∂T/∂q' − ∂T/∂q at q'' = 0.
//! Constraints hold accelerations by J q'' + γ = 0: with multipliers, ∂(G + λ·(J q'' + γ))/∂q'' = 0.
//! (Gibbs, American Journal of Mathematics 2 (1879) 49; Appell, Journal für die reine und angewandte Mathematik 121 (1900) 310.)

use super::angular::{ByAngularVelocities, Turning};
use super::body_axes::{self, Moving};
use super::virtual_power::{Wrench, wrenches};
use super::{Dynamics, Inertial, Rows, bias_rates, lagrange, rates};
use crate::expr::{Graph, Id, Symbol, reverse};
use crate::model::Rotation;

/// The function of the accelerations that the motion makes least.
#[derive(Clone, Debug, Default)]
pub(crate) struct LeastConstraint {
    /// (wₖₗ, yₖ, yₗ, the body): ½ w y² where both are the same, w yₖ yₗ where they are not.
    pub products: Vec<(Id, Id, Id, usize)>,
    /// (yₖ, gₖ).
    pub linear: Vec<(Id, Id)>,
    /// hᵢ.
    pub forces: Vec<Id>,
    /// The kinetic energy that the file writes out, which is no list of products yet.
    pub kinetic: Id,
    /// The rotations whose angular velocities are in the place of their numbers' rates.
    pub turning: Vec<Turning>,
    /// (c', γ) of the constraints' rows, c'' = J q'' + γ = 0 holding the accelerations.
    pub rows: Vec<(Id, Id)>,
}

impl LeastConstraint {
    /// From bodies, loads and energies; by angular velocities of rotations where these do.
    pub(crate) fn of(graph: &mut Graph, dynamics: &Dynamics) -> LeastConstraint {
        LeastConstraint::by_angular_velocities(graph, dynamics)
            .unwrap_or_else(|| LeastConstraint::by_speeds(graph, dynamics))
    }

    /// What accelerations make least that meet constraints: rows contain rates of rotations' numbers, which stay.
    pub(crate) fn constrained(graph: &mut Graph, dynamics: &Dynamics, rows: &Rows) -> LeastConstraint {
        let mut least = LeastConstraint::by_speeds(graph, dynamics);
        least.rows = rows.rate.iter().copied().zip(rows.bias.iter().copied()).collect();
        least
    }

    fn by_angular_velocities(graph: &mut Graph, dynamics: &Dynamics) -> Option<LeastConstraint> {
        let by = ByAngularVelocities::of(graph, dynamics)?;
        let mut least = LeastConstraint::default();
        for (k, moving) in body_axes::motions(graph, &by.dynamics, bias_rates).into_iter().enumerate() {
            least.body_in_space(dynamics, (k, moving));
        }
        let (velocities, forces): (Vec<Id>, Vec<Id>) = least.linear.iter().copied().unzip();
        let seconds = least.products.iter().flat_map(|product| [product.1, product.2]);
        let all: Vec<Id> = velocities.into_iter().chain(seconds).chain([dynamics.written_kinetic]).collect();
        let mut all = by.velocities(graph, &all)?.into_iter();
        let mut next = || all.next().unwrap_or(Id::ZERO);
        least.linear = by.forces(graph, &forces).into_iter().map(|force| (next(), force)).collect();
        least.products.iter_mut().for_each(|product| (product.1, product.2) = (next(), next()));
        least.kinetic = next();
        let forces = forces_beside_bodies(graph, dynamics, dynamics.written_kinetic);
        least.forces = by.moments(graph, forces);
        least.turning = by.turning;
        Some(least)
    }

    fn by_speeds(graph: &mut Graph, dynamics: &Dynamics) -> LeastConstraint {
        let mut least = LeastConstraint { kinetic: dynamics.raw_kinetic, ..LeastConstraint::default() };
        if body_axes::applies(dynamics) {
            for (k, moving) in body_axes::motions(graph, dynamics, bias_rates).into_iter().enumerate() {
                least.body_in_space(dynamics, (k, moving));
            }
        } else {
            let wrenches = wrenches(graph, dynamics);
            let velocities = Velocities::of(graph, dynamics);
            for (k, wrench) in wrenches.iter().enumerate() {
                least.body(graph, dynamics, (k, wrench), &velocities);
            }
        }
        least.forces = forces_beside_bodies(graph, dynamics, dynamics.raw_kinetic);
        least
    }

    /// A body of a mechanism in which bodies turn in space.
    fn body_in_space(&mut self, dynamics: &Dynamics, (k, moving): (usize, Moving)) {
        let body = &dynamics.bodies[k];
        self.products.extend(moving.linear.iter().map(|(velocity, _)| (body.mass, *velocity, *velocity, k)));
        if let Some(Rotation::Space { inertia, .. }) = &body.rotation {
            let omega = |i: usize| moving.angular[i].0;
            let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
            self.products.extend(inertia.iter().zip(places).map(|(w, (i, j))| (*w, omega(i), omega(j), k)));
        }
        self.linear.extend(moving.linear.into_iter().chain(moving.angular));
    }

    fn body(&mut self, graph: &mut Graph, dynamics: &Dynamics, (k, wrench): (usize, &Wrench), all: &Velocities) {
        let body = &dynamics.bodies[k];
        for (axis, (velocity, bias)) in all.linear[k].iter().enumerate() {
            // m (b − g) − F
            let falling = graph.sub(*bias, dynamics.gravity[axis]);
            let inertial = graph.mul(body.mass, falling);
            self.products.push((body.mass, *velocity, *velocity, k));
            self.linear.push((*velocity, graph.sub(inertial, wrench.force[axis])));
        }
        if let Some(Rotation::Plane { inertia, .. }) = &body.rotation
            && let Some((omega, bias)) = all.angular[k]
        {
            let spin = graph.mul(*inertia, bias);
            self.products.push((*inertia, omega, omega, k));
            self.linear.push((omega, graph.sub(spin, wrench.moment[0])));
        }
    }
}

/// Velocities of centres of mass, and angular velocities in the plane, each with its rate at q'' = 0.
struct Velocities {
    linear: Vec<Vec<(Id, Id)>>,
    angular: Vec<Option<(Id, Id)>>,
}

impl Velocities {
    fn of(graph: &mut Graph, dynamics: &Dynamics) -> Velocities {
        let angle = |body: &Inertial| match body.rotation {
            Some(Rotation::Plane { angle, .. }) => Some(angle),
            _ => None,
        };
        let places = dynamics.bodies.iter().flat_map(|body| body.position.iter().copied().chain(angle(body)));
        let velocities = rates(graph, &places.collect::<Vec<Id>>());
        let biases = bias_rates(graph, &velocities);
        let mut pairs = velocities.into_iter().zip(biases);
        let mut found = Velocities { linear: Vec::new(), angular: Vec::new() };
        for body in &dynamics.bodies {
            found.linear.push(pairs.by_ref().take(body.position.len()).collect());
            found.angular.push(angle(body).and_then(|_| pairs.next()));
        }
        found
    }
}

/// hᵢ of what no body carries, with this kinetic energy.
fn forces_beside_bodies(graph: &mut Graph, dynamics: &Dynamics, kinetic: Id) -> Vec<Id> {
    let seeds = [(dynamics.potential, Id::ONE), (kinetic, Id::MINUS_ONE)];
    let gradient = reverse(graph, &seeds, |s| matches!(s, Symbol::Coordinate(_)));
    let momenta = lagrange::speed_gradient(graph, dynamics.n, &[(kinetic, Id::ONE)]);
    let momentum_rates = bias_rates(graph, &momenta);
    let resisting = lagrange::speed_gradient(graph, dynamics.n, &lagrange::speed_seeds(dynamics));
    let resisting = lagrange::with_generalized(graph, dynamics, resisting);
    let sum = |(i, (rate, resisting)): (usize, (Id, Id))| {
        let sum = graph.add(lagrange::coordinate_entry(&gradient, i), rate);
        graph.add(sum, resisting)
    };
    momentum_rates.into_iter().zip(resisting).enumerate().map(sum).collect()
}
