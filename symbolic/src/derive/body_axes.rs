//! Virtual power along the axes of frames.
//!
//! In space velocities and accelerations are shorter along the axes in which a way is written than along those of the ground: from frame to
//! frame, with C the rotation back into the new axes and u a way that is passed along them (Luh, Walker and Paul, J. Dyn. Syst. Meas. Control
//! 102, 1980, 69),
//!
//! ```text
//! ω ← C ω + ω_r,  α ← C α + ω_r' + C ω × ω_r,  v ← v + ω × u + u',  a ← a + α × u + ω × (ω × u) + 2 ω × u' + u''
//! ```
//!
//! beginning with a = −g.  The residual is Σ (∂v/∂q')·(m a − F) + (∂ω/∂q')·(I α + ω × I ω − M), by one reverse pass over v and ω, which hands
//! forces and moments back from frame to frame.

use super::virtual_power::{Wrench, beside_bodies, wrenches};
use super::{Derivative, Dynamics, Equations, Inertial, lagrange, rates};
use crate::expr::{Graph, Id, vectors};
use crate::model::{Rotation, Stage, Way, product};

/// A body's velocities, along the axes in which it is placed and along its own, each with the force or moment that is missing for its motion.
pub(super) struct Moving {
    /// (v, m a − F), three of them.
    pub linear: Vec<(Id, Id)>,
    /// (ω, I α + ω × I ω − M), three of them; none of a particle.
    pub angular: Vec<(Id, Id)>,
}

/// Whether any body turns in space.
pub(super) fn applies(dynamics: &Dynamics) -> bool {
    dynamics.bodies.iter().any(|body| matches!(body.rotation, Some(Rotation::Space { .. })))
}

/// M and h, where they are to be `formed`, and F; nothing where no body turns in space.
pub(super) fn equations(graph: &mut Graph, dynamics: &Dynamics, formed: bool) -> Option<Equations> {
    if !applies(dynamics) {
        return None;
    }
    let name = "virtual power along the bodies' axes";
    Some(Equations::of_residual(graph, name, formed, |graph, second| residual(graph, dynamics, second)))
}

fn residual(graph: &mut Graph, dynamics: &Dynamics, second: Derivative) -> Vec<Id> {
    let moving = motions(graph, dynamics, second);
    let seeds: Vec<(Id, Id)> =
        moving.into_iter().flat_map(|body| body.linear.into_iter().chain(body.angular)).collect();
    let of_bodies = lagrange::speed_gradient(graph, dynamics.n, &seeds);
    let others = beside_bodies(graph, dynamics, second, Vec::new());
    vectors::add(graph, &of_bodies, &others)
}

/// How all bodies move.
pub(super) fn motions(graph: &mut Graph, dynamics: &Dynamics, second: Derivative) -> Vec<Moving> {
    let wrenches = wrenches(graph, dynamics);
    let bodies = dynamics.bodies.iter().zip(&wrenches);
    let moving = |(body, wrench): (&Inertial, &Wrench)| Moving {
        linear: translation(graph, (dynamics, body), wrench, second),
        angular: match &body.rotation {
            Some(Rotation::Space { frame, inertia }) => rotation(graph, (&frame.stages, inertia), wrench, second),
            _ => Vec::new(),
        },
    };
    bodies.map(moving).collect()
}

/// The angular velocity of a body along its own axes, with I α + ω × I ω − M.
fn rotation(
    graph: &mut Graph,
    (stages, inertia): (&[Stage], &[Id; 6]),
    wrench: &Wrench,
    second: Derivative,
) -> Vec<(Id, Id)> {
    let (mut turning, mut moment) = (Turning::default(), spatial(&wrench.moment));
    for stage in stages {
        turning = turning.along(graph, stage, second);
        moment = stage.turned_back(graph, &moment);
    }
    let Turning { omega, alpha } = turning;
    let (momentum, gained) = (product(graph, inertia, &omega), product(graph, inertia, &alpha));
    let gyroscopic = vectors::cross_space(graph, &omega, &momentum);
    let rate = vectors::add(graph, &gained, &gyroscopic);
    let missing = vectors::difference(graph, &moment, &rate);
    omega.into_iter().zip(missing).collect()
}

/// The velocity of a body's centre of mass with m a − F along the same axes: those at the end of its way, or the ground's where it has several.
fn translation(
    graph: &mut Graph,
    (dynamics, body): (&Dynamics, &Inertial),
    wrench: &Wrench,
    second: Derivative,
) -> Vec<(Id, Id)> {
    let falling = spatial(&vectors::negative(graph, &dynamics.gravity));
    let mut moved = Moved { velocity: [Id::ZERO; 3], acceleration: falling };
    let mut force = spatial(&wrench.force);
    if let [way] = body.ways.0.as_slice() {
        moved = moved.along(graph, way, second);
        force = way.stages.iter().fold(force, |force, stage| stage.turned_back(graph, &force));
    } else {
        for way in &body.ways.0 {
            let own = Moved::default().along(graph, way, second);
            let outwards = |old: [Id; 3], graph: &mut Graph| {
                way.stages.iter().rev().fold(old, |old, stage| stage.turned_out(graph, &old))
            };
            let (velocity, acceleration) = (outwards(own.velocity, graph), outwards(own.acceleration, graph));
            moved = moved.and(graph, &velocity, &acceleration);
        }
    }
    let inertial = vectors::scaled(graph, body.mass, &moved.acceleration);
    let missing = vectors::difference(graph, &force, &inertial);
    moved.velocity.into_iter().zip(missing).collect()
}

/// How the end of a way moves, along axes there.
#[derive(Clone, Copy)]
struct Moved {
    velocity: [Id; 3],
    acceleration: [Id; 3],
}

impl Default for Moved {
    fn default() -> Moved {
        Moved { velocity: [Id::ZERO; 3], acceleration: [Id::ZERO; 3] }
    }
}

impl Moved {
    fn and(self, graph: &mut Graph, velocity: &[Id], acceleration: &[Id]) -> Moved {
        let velocity = spatial(&vectors::add(graph, &self.velocity, velocity));
        Moved { velocity, acceleration: spatial(&vectors::add(graph, &self.acceleration, acceleration)) }
    }

    /// At the end of a way that begins where this was.
    fn along(mut self, graph: &mut Graph, way: &Way, second: Derivative) -> Moved {
        let mut turning = Turning::default();
        let mut pieces = way.pieces.iter().peekable();
        for after in 0..=way.stages.len() {
            if let Some((_, piece)) = pieces.next_if(|(stage, _)| *stage == after) {
                let rate = spatial(&rates(graph, piece));
                let swept = vectors::cross_space(graph, &turning.omega, piece);
                let gained = vectors::add(graph, &swept, &rate);
                let twice = vectors::add(graph, &gained, &rate);
                let parts = [
                    vectors::cross_space(graph, &turning.alpha, piece),
                    vectors::cross_space(graph, &turning.omega, &twice),
                    second(graph, &rate),
                ];
                self = self.and(graph, &gained, &parts[0]);
                for part in &parts[1..] {
                    self.acceleration = spatial(&vectors::add(graph, &self.acceleration, part));
                }
            }
            let Some(stage) = way.stages.get(after) else { break };
            turning = turning.along(graph, stage, second);
            let [velocity, acceleration] = [self.velocity, self.acceleration].map(|old| stage.turned_back(graph, &old));
            self = Moved { velocity, acceleration };
        }
        self
    }
}

fn spatial(vector: &[Id]) -> [Id; 3] {
    std::array::from_fn(|k| vector.get(k).copied().unwrap_or(Id::ZERO))
}

/// How axes turn, along themselves.
#[derive(Clone, Copy)]
struct Turning {
    omega: [Id; 3],
    alpha: [Id; 3],
}

impl Default for Turning {
    /// The ground's.
    fn default() -> Turning {
        Turning { omega: [Id::ZERO; 3], alpha: [Id::ZERO; 3] }
    }
}

impl Turning {
    /// That of axes that turn against these.
    fn along(&self, graph: &mut Graph, stage: &Stage, second: Derivative) -> Turning {
        let [before, carried] = [self.omega, self.alpha].map(|old| stage.turned_back(graph, &old));
        let omega = vectors::add(graph, &before, &stage.rate);
        let gained = second(graph, &stage.rate);
        let across = vectors::cross_space(graph, &before, &stage.rate);
        let alpha = vectors::add(graph, &carried, &gained);
        let alpha = vectors::add(graph, &alpha, &across);
        Turning { omega: spatial(&omega), alpha: spatial(&alpha) }
    }
}
