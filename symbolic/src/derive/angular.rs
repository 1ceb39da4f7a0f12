//! Angular velocities as unknowns in the place of quaternions' rates.
//!
//! A rotation is kept as a quaternion q of any length, with q' = ½ q∘ω + σ q, ω along its own axes and σ = q·q'/|q|².  Nothing depends on the
//! length, whose equation is σ' = 0, so that three unknowns ω' do for four q'':
//!
//! q'' = ½ q'∘ω + ½ q∘ω' + σ q'.

use rustc_hash::FxHashMap as HashMap;

use super::Dynamics;
use crate::expr::{Graph, Id, Symbol, vectors};
use crate::model::{Quaternion, Rotation, Stage};

/// A rotation with its angular velocity, which the places of its last three numbers stand for.
#[derive(Clone, Debug)]
pub(crate) struct Turning {
    /// The place of its first number.
    pub first: usize,
    /// ω, by q and q'.
    pub omega: [Id; 3],
    q: Quaternion,
    v: Quaternion,
}

/// What moves by angular velocities that are symbols of their own.
pub(super) struct ByAngularVelocities {
    /// With these symbols as the rates of turns.
    pub dynamics: Dynamics,
    pub turning: Vec<Turning>,
}

impl ByAngularVelocities {
    /// Nothing without rotations, or where one turns no body.
    pub fn of(graph: &mut Graph, dynamics: &Dynamics) -> Option<ByAngularVelocities> {
        if dynamics.rotations.is_empty() {
            return None;
        }
        let mut new = ByAngularVelocities { dynamics: dynamics.clone(), turning: Vec::new() };
        for (index, &first) in dynamics.rotations.iter().enumerate() {
            let mut stages = stages(&mut new.dynamics).filter(|stage| stage.rotation == Some(index)).peekable();
            let omega = stages.peek()?.rate;
            let symbols = [0, 1, 2].map(|k| graph.symbol(own_symbol(dynamics.n, index, k)));
            stages.for_each(|stage| stage.rate = symbols);
            let components = |graph: &mut Graph, of: fn(u32) -> Symbol| {
                Quaternion([0, 1, 2, 3].map(|k| graph.symbol(of(first as u32 + k))))
            };
            let (q, v) = (components(graph, Symbol::Coordinate), components(graph, Symbol::Speed));
            new.turning.push(Turning { first, omega, q, v });
        }
        Some(new)
    }

    /// Velocities with the places of rotations' last three numbers in the place of the symbols; `None` where one depends on a quaternion's rate.
    pub fn velocities(&self, graph: &mut Graph, velocities: &[Id]) -> Option<Vec<Id>> {
        let of_quaternion = |symbol: &Symbol| match symbol {
            Symbol::Speed(i) => {
                self.turning.iter().any(|turning| (turning.first..turning.first + 4).contains(&(*i as usize)))
            }
            _ => false,
        };
        if graph.symbols(velocities.iter().copied()).iter().any(of_quaternion) {
            return None;
        }
        let places =
            self.put_in(graph, |graph, turning, k| graph.symbol(Symbol::Speed((turning.first + 1 + k) as u32)));
        Some(crate::expr::substitute(graph, velocities, &places))
    }

    /// Forces with the angular velocities by q and q' in the place of the symbols.
    pub fn forces(&self, graph: &mut Graph, forces: &[Id]) -> Vec<Id> {
        let values = self.put_in(graph, |_, turning, k| turning.omega[k]);
        crate::expr::substitute(graph, forces, &values)
    }

    fn put_in(&self, graph: &mut Graph, value: impl Fn(&mut Graph, &Turning, usize) -> Id) -> HashMap<Symbol, Id> {
        let places =
            self.turning.iter().enumerate().flat_map(|(index, turning)| (0..3).map(move |k| (index, turning, k)));
        places.map(|(index, turning, k)| (own_symbol(self.dynamics.n, index, k), value(graph, turning, k))).collect()
    }

    /// What acts on coordinates, as what acts on the angular velocities where these are.
    pub fn moments(&self, graph: &mut Graph, mut forces: Vec<Id>) -> Vec<Id> {
        for turning in &self.turning {
            let own = &mut forces[turning.first..turning.first + 4];
            let moments = [0, 1, 2].map(|k| {
                let column =
                    turning.half_turned(graph, std::array::from_fn(|i| if i == k { Id::ONE } else { Id::ZERO }));
                vectors::dot(graph, &column.0, own)
            });
            own[0] = Id::ZERO;
            own[1..].copy_from_slice(&moments);
        }
        forces
    }
}

impl Turning {
    /// q'' where the angular velocity has this rate.
    pub fn acceleration(&self, graph: &mut Graph, rate: [Id; 3]) -> [Id; 4] {
        let two = graph.integer(2);
        let along = vectors::dot(graph, &self.q.0, &self.v.0);
        let square = vectors::dot(graph, &self.q.0, &self.q.0);
        let growth = graph.div(along, square);
        let swept = self.v.times(graph, Quaternion::of_components(self.omega));
        let gained = self.half_turned(graph, rate);
        std::array::from_fn(|i| {
            let (half, grown) = (graph.div(swept.0[i], two), graph.mul(growth, self.v.0[i]));
            let sum = graph.add(half, gained.0[i]);
            graph.add(sum, grown)
        })
    }

    /// ½ q∘ω.
    fn half_turned(&self, graph: &mut Graph, omega: [Id; 3]) -> Quaternion {
        let two = graph.integer(2);
        let product = self.q.times(graph, Quaternion::of_components(omega));
        Quaternion(product.0.map(|x| graph.div(x, two)))
    }

    /// With every expression replaced.
    pub fn expressions(&mut self) -> impl Iterator<Item = &mut Id> {
        self.omega.iter_mut().chain(&mut self.q.0).chain(&mut self.v.0)
    }
}

/// The symbol of a component of a rotation's angular velocity, beyond those of speeds.
fn own_symbol(n: usize, index: usize, k: usize) -> Symbol {
    Symbol::Speed((n + 3 * index + k) as u32)
}

/// All turns of bodies and of ways.
fn stages(dynamics: &mut Dynamics) -> impl Iterator<Item = &mut Stage> {
    dynamics.bodies.iter_mut().flat_map(|body| {
        let own = match &mut body.rotation {
            Some(Rotation::Space { frame, .. }) => frame.stages.as_mut_slice(),
            _ => &mut [],
        };
        own.iter_mut().chain(body.ways.0.iter_mut().flat_map(|way| &mut way.stages))
    })
}
