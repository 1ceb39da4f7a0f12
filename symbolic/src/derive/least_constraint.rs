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
//! (Gibbs, American Journal of Mathematics 2 (1879) 49; Appell, Journal für die reine und angewandte Mathematik 121 (1900) 310.)

use super::virtual_power::{Wrench, wrenches};
use super::{Dynamics, bias_rates, lagrange};
use crate::expr::{Forward, Graph, Id, Symbol, reverse, vectors};
use crate::model::{Orientation, Rotation, product};

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
}

impl LeastConstraint {
    /// From bodies, loads and energies.
    pub(crate) fn of(graph: &mut Graph, dynamics: &Dynamics) -> LeastConstraint {
        let mut least = LeastConstraint { kinetic: dynamics.raw_kinetic, ..LeastConstraint::default() };
        let wrenches = wrenches(graph, dynamics);
        let velocities = Velocities::of(graph, dynamics);
        for (k, wrench) in wrenches.iter().enumerate() {
            least.body(graph, dynamics, (k, wrench), &velocities);
        }
        least.forces = forces(graph, dynamics);
        least
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
        match &body.rotation {
            None => {}
            Some(Rotation::Plane { inertia, .. }) => {
                let (omega, bias) = all.angular[k][0];
                let spin = graph.mul(*inertia, bias);
                self.products.push((*inertia, omega, omega, k));
                self.linear.push((omega, graph.sub(spin, wrench.moment[0])));
            }
            Some(Rotation::Space { frame, inertia }) => {
                let [omega, bias] = [0, 1].map(|order: usize| {
                    let component = |pair: &(Id, Id)| if order == 0 { pair.0 } else { pair.1 };
                    let list: Vec<Id> = all.angular[k].iter().map(component).collect();
                    [list[0], list[1], list[2]]
                });
                let (momentum, gained) = (product(graph, inertia, &omega), product(graph, inertia, &bias));
                let gyroscopic = vectors::cross_space(graph, &omega, &momentum);
                let moment = frame.along_axes(graph, &wrench.moment);
                for (axis, y) in omega.iter().enumerate() {
                    let own = graph.add(gained[axis], gyroscopic[axis]);
                    self.linear.push((*y, graph.sub(own, moment[axis])));
                }
                for (w, (i, j)) in inertia.iter().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
                    self.products.push((*w, omega[i], omega[j], k));
                }
            }
        }
    }
}

/// Velocities of centres of mass, and angular velocities along bodies' own axes, each with its rate at q'' = 0.
struct Velocities {
    linear: Vec<Vec<(Id, Id)>>,
    angular: Vec<Vec<(Id, Id)>>,
}

impl Velocities {
    /// A unit vector c of a body's frame has the rate ω × c, so that what is fixed in a turning body has a velocity of the three components of ω
    /// and not of the nine of its unit vectors.
    fn of(graph: &mut Graph, dynamics: &Dynamics) -> Velocities {
        let frames = || {
            dynamics.bodies.iter().filter_map(|body| match &body.rotation {
                Some(Rotation::Space { frame, .. }) => Some(frame.as_ref()),
                _ => None,
            })
        };
        let turning = turning(graph, frames());
        let mut places: Vec<Id> = Vec::new();
        for body in &dynamics.bodies {
            places.extend(&body.position);
            if let Some(Rotation::Plane { angle, .. }) = &body.rotation {
                places.push(*angle);
            }
        }
        let mut rates = rates_of(graph, &places, &turning, false);
        for body in &dynamics.bodies {
            if let Some(Rotation::Space { frame, .. }) = &body.rotation {
                rates.extend(frame.along_axes(graph, &frame.velocity));
            }
        }
        let biases = rates_of(graph, &rates, &turning, true);
        let pairs: Vec<(Id, Id)> = rates.into_iter().zip(biases).collect();
        let (of_places, of_frames) = pairs.split_at(places.len());
        let (mut of_places, mut of_frames) = (of_places.iter().copied(), of_frames.iter().copied());
        let mut found = Velocities { linear: Vec::new(), angular: Vec::new() };
        for body in &dynamics.bodies {
            found.linear.push(of_places.by_ref().take(body.position.len()).collect());
            found.angular.push(match &body.rotation {
                None => Vec::new(),
                Some(Rotation::Plane { .. }) => of_places.by_ref().take(1).collect(),
                Some(Rotation::Space { .. }) => of_frames.by_ref().take(3).collect(),
            });
        }
        found
    }
}

/// The rate of every component of these frames' unit vectors that moves: ω × c.
fn turning<'a>(graph: &mut Graph, frames: impl Iterator<Item = &'a Orientation>) -> Vec<(Id, Id)> {
    let mut rates = Vec::new();
    for frame in frames {
        for axis in &frame.axes {
            rates.extend(axis.iter().copied().zip(vectors::cross_space(graph, &frame.velocity, axis)));
        }
    }
    let moves = graph.contains(|s| matches!(s, Symbol::Coordinate(_) | Symbol::Time | Symbol::Input(..)));
    rates.retain(|(component, _)| moves[component.index()]);
    rates
}

/// Total time derivatives, at zero accelerations or not, where some are known.
fn rates_of(graph: &mut Graph, roots: &[Id], known: &[(Id, Id)], bias: bool) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        Symbol::Speed(_) if bias => Id::ZERO,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    known.iter().for_each(|(id, rate)| forward.given(*id, *rate));
    roots.iter().map(|root| forward.of(graph, *root)).collect()
}

/// hᵢ of what no body carries.
fn forces(graph: &mut Graph, dynamics: &Dynamics) -> Vec<Id> {
    let seeds = [(dynamics.potential, Id::ONE), (dynamics.raw_kinetic, Id::MINUS_ONE)];
    let gradient = reverse(graph, &seeds, |s| matches!(s, Symbol::Coordinate(_)));
    let momenta = lagrange::speed_gradient(graph, dynamics.n, &[(dynamics.raw_kinetic, Id::ONE)]);
    let momentum_rates = bias_rates(graph, &momenta);
    let resisting = lagrange::speed_gradient(graph, dynamics.n, &lagrange::speed_seeds(dynamics));
    let resisting = lagrange::with_generalized(graph, dynamics, resisting);
    let sum = |(i, (rate, resisting)): (usize, (Id, Id))| {
        let sum = graph.add(lagrange::coordinate_entry(&gradient, i), rate);
        graph.add(sum, resisting)
    };
    momentum_rates.into_iter().zip(resisting).enumerate().map(sum).collect()
}
