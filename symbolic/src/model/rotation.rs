//! How bodies and frames turn.

use super::gimbals::Turns;
use crate::expr::{Graph, Id, Unary, vectors};

/// How a frame in space is turned against the ground, and how it turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Orientation {
    /// Its unit vectors, in ground axes.
    pub axes: [[Id; 3]; 3],
    /// Its angular velocity along its own axes.
    pub own_velocity: [Id; 3],
    /// The same in ground axes, summed on its own way.
    pub velocity: [Id; 3],
    /// Which rotations turn it, by their places.
    pub rotations: Vec<usize>,
    /// Its turns by coordinates, in numbers.
    pub turns: Turns,
    /// How many turns that move stand between the ground and it.
    pub depth: usize,
    /// Its turns, one after the other, from the ground on.
    pub stages: Vec<Stage>,
}

/// One turn of a frame, as seen from what it turns.
#[derive(Clone, Debug, PartialEq)]
pub struct Stage {
    /// The new unit vectors along the old axes.
    pub columns: [[Id; 3]; 3],
    /// The angular velocity of the new axes against the old ones, along the new ones.
    pub rate: [Id; 3],
    /// The rotation that it is, by its place; none of other turns.
    pub rotation: Option<usize>,
    /// What it was made from.
    pub given: Given,
}

/// How a turn is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Given {
    /// About a direction of length 1 along the old axes, by an angle.
    About([Id; 3], Id),
    /// By a quaternion of any length but 0.
    By(Quaternion),
}

impl Given {
    fn ids(&self) -> impl Iterator<Item = Id> + '_ {
        let (first, second) = match self {
            Given::About(axis, angle) => (axis.as_slice(), std::slice::from_ref(angle)),
            Given::By(q) => (q.0.as_slice(), &[][..]),
        };
        first.iter().chain(second).copied()
    }

    fn map(&self, f: &mut impl FnMut(Id) -> Id) -> Given {
        match self {
            Given::About(axis, angle) => Given::About(axis.map(&mut *f), f(*angle)),
            Given::By(q) => Given::By(Quaternion(q.0.map(f))),
        }
    }

    /// As a quaternion of length 1.
    fn quaternion(&self, graph: &mut Graph) -> Quaternion {
        match self {
            Given::About(axis, angle) => Quaternion::of_turn(graph, *axis, *angle),
            Given::By(q) => q.unit(graph),
        }
    }
}

impl Stage {
    /// Components along the new axes of a vector along the old ones.
    pub fn turned_back(&self, graph: &mut Graph, vector: &[Id; 3]) -> [Id; 3] {
        self.columns.map(|column| vectors::dot(graph, &column, vector))
    }

    /// Components along the old axes of a vector along the new ones.
    pub fn turned_out(&self, graph: &mut Graph, vector: &[Id; 3]) -> [Id; 3] {
        let row = |i: usize| self.columns.map(|column| column[i]);
        [0, 1, 2].map(|i| vectors::dot(graph, &row(i), vector))
    }

    /// All its expressions, in an order that [`Stage::map`] keeps.
    pub fn ids(&self) -> impl Iterator<Item = Id> + '_ {
        self.columns.iter().flatten().chain(&self.rate).copied().chain(self.given.ids())
    }

    /// With every expression replaced.
    #[must_use]
    pub fn map(&self, f: &mut impl FnMut(Id) -> Id) -> Stage {
        let columns = self.columns.map(|column| column.map(&mut *f));
        Stage { columns, rate: self.rate.map(&mut *f), given: self.given.map(f), ..*self }
    }
}

/// The unit vectors of axes that are not turned.
pub const UNTURNED: [[Id; 3]; 3] =
    [[Id::ONE, Id::ZERO, Id::ZERO], [Id::ZERO, Id::ONE, Id::ZERO], [Id::ZERO, Id::ZERO, Id::ONE]];

/// A turn about one axis.
#[derive(Clone, Copy, Debug)]
pub struct Turn {
    angle: Id,
    rate: Id,
    sine: Id,
    cosine: Id,
}

impl Turn {
    /// By an angle that grows at a rate.
    pub fn by(graph: &mut Graph, angle: Id, rate: Id) -> Turn {
        Turn { angle, rate, sine: graph.unary(Unary::Sin, angle), cosine: graph.unary(Unary::Cos, angle) }
    }
}

impl Orientation {
    /// Of the ground.
    pub fn ground() -> Orientation {
        Orientation {
            axes: UNTURNED,
            own_velocity: [Id::ZERO; 3],
            velocity: [Id::ZERO; 3],
            rotations: Vec::new(),
            turns: Turns::none(),
            depth: 0,
            stages: Vec::new(),
        }
    }

    /// Turned further about its own axis `k`, right-handed: with i, j, k in cyclic order eᵢ → cos eᵢ + sin eⱼ, eⱼ → cos eⱼ − sin eᵢ.
    ///
    /// Along the new axes the angular velocity has the old components turned back, and the rate of the angle along k.
    pub fn turned(&self, graph: &mut Graph, k: usize, turn: Turn) -> Orientation {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let Turn { angle, rate, sine, cosine } = turn;
        let mut mixed = |a: Id, b: Id| {
            let (ca, sb) = (graph.mul(cosine, a), graph.mul(sine, b));
            let (cb, sa) = (graph.mul(cosine, b), graph.mul(sine, a));
            (graph.add(ca, sb), graph.sub(cb, sa))
        };
        let mut new = self.clone();
        for m in 0..3 {
            (new.axes[i][m], new.axes[j][m]) = mixed(self.axes[i][m], self.axes[j][m]);
        }
        (new.own_velocity[i], new.own_velocity[j]) = mixed(self.own_velocity[i], self.own_velocity[j]);
        new.own_velocity[k] = graph.add(self.own_velocity[k], rate);
        new.spun(graph, rate, &self.axes[k]);
        let given = Given::About(UNTURNED[k], angle);
        let mut stage = Stage { columns: UNTURNED, rate: [Id::ZERO; 3], rotation: None, given };
        (stage.columns[i][i], stage.columns[i][j]) = (cosine, sine);
        (stage.columns[j][i], stage.columns[j][j]) = (graph.neg(sine), cosine);
        stage.rate[k] = rate;
        new.stages.push(stage);
        new
    }

    /// Turned further about a direction n fixed in it, given by its components along its own axes, of length 1, by Rodrigues' formula:
    /// e → cos e + sin n × e + (1 − cos) (n·e) n.
    pub fn turned_about(&self, graph: &mut Graph, n: [Id; 3], turn: Turn) -> Orientation {
        let Turn { angle, rate, sine, cosine } = turn;
        let rest = graph.sub(Id::ONE, cosine);
        let columns: [[Id; 3]; 3] = std::array::from_fn(|k| {
            let e: [Id; 3] = std::array::from_fn(|i| if i == k { Id::ONE } else { Id::ZERO });
            let across = vectors::cross_space(graph, &n, &e);
            std::array::from_fn(|i| {
                let (kept, swept) = (graph.mul(cosine, e[i]), graph.mul(sine, across[i]));
                let along = graph.mul(n[k], n[i]);
                let along = graph.mul(rest, along);
                let sum = graph.add(kept, swept);
                graph.add(sum, along)
            })
        });
        let axis = self.in_ground(graph, n);
        let axes = columns.map(|column| self.in_ground(graph, column));
        let own_velocity = std::array::from_fn(|k| {
            let before = vectors::dot(graph, &columns[k], &self.own_velocity);
            let gained = graph.mul(rate, n[k]);
            graph.add(before, gained)
        });
        let mut new = Orientation { axes, own_velocity, ..self.clone() };
        new.spun(graph, rate, &axis);
        let rate = n.map(|component| graph.mul(rate, component));
        new.stages.push(Stage { columns, rate, rotation: None, given: Given::About(n, angle) });
        new
    }

    /// The quaternion of length 1 that turns the ground to it: the product of those of its turns, so that it changes continuously along
    /// every motion.
    pub fn quaternion(&self, graph: &mut Graph) -> Quaternion {
        self.stages.iter().fold(Quaternion::ONE, |q, stage| {
            let further = stage.given.quaternion(graph);
            q.times(graph, further)
        })
    }

    fn spun(&mut self, graph: &mut Graph, rate: Id, axis: &[Id; 3]) {
        for (sum, part) in self.velocity.iter_mut().zip(axis) {
            let gained = graph.mul(rate, *part);
            *sum = graph.add(*sum, gained);
        }
    }

    /// A vector of these components along its axes, in ground axes.
    pub fn in_ground(&self, graph: &mut Graph, components: [Id; 3]) -> [Id; 3] {
        std::array::from_fn(|m| {
            let rows: [Id; 3] = std::array::from_fn(|k| self.axes[k][m]);
            vectors::dot(graph, &rows, &components)
        })
    }

    /// The components along its axes of a vector in ground axes.
    pub fn along_axes(&self, graph: &mut Graph, vector: &[Id]) -> [Id; 3] {
        self.axes.map(|axis| vectors::dot(graph, &axis, vector))
    }

    fn ids(&self) -> impl Iterator<Item = Id> + '_ {
        let whole = self.axes.iter().flatten().chain(&self.own_velocity).chain(&self.velocity).copied();
        whole.chain(self.stages.iter().flat_map(Stage::ids))
    }

    fn map(&self, f: &mut impl FnMut(Id) -> Id) -> Orientation {
        let axes = self.axes.map(|axis| axis.map(&mut *f));
        let own_velocity = self.own_velocity.map(&mut *f);
        let velocity = self.velocity.map(&mut *f);
        let stages = self.stages.iter().map(|stage| stage.map(f)).collect();
        Orientation { axes, own_velocity, velocity, stages, ..self.clone() }
    }
}

/// The moments of inertia of a body about its centre of mass, along the axes of its frame: Ixx, Iyy, Izz and the tensor's elements Ixy,
/// Ixz, Iyz (Ixy = −∫ x y dm).
pub type Tensor = [Id; 6];

/// The product of a tensor and a vector.
pub fn product(graph: &mut Graph, tensor: &Tensor, v: &[Id; 3]) -> [Id; 3] {
    let [xx, yy, zz, xy, xz, yz] = *tensor;
    [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|row| vectors::dot(graph, &row, v))
}

/// How a rigid body turns.
#[derive(Clone, Debug, PartialEq)]
pub enum Rotation {
    /// In the plane.
    Plane {
        /// Its angle, counterclockwise.
        angle: Id,
        /// Moment of inertia about the centre of mass.
        inertia: Id,
    },
    /// In space.
    Space {
        /// Its frame.
        frame: Box<Orientation>,
        /// Its moments of inertia along the frame's axes.
        inertia: Tensor,
    },
}

impl Rotation {
    /// All its expressions, in an order that [`Rotation::map`] keeps.
    pub fn ids(&self) -> Vec<Id> {
        match self {
            Rotation::Plane { angle, inertia } => vec![*angle, *inertia],
            Rotation::Space { frame, inertia } => frame.ids().chain(inertia.iter().copied()).collect(),
        }
    }

    /// With every expression replaced.
    #[must_use]
    pub fn map(&self, mut f: impl FnMut(Id) -> Id) -> Rotation {
        match self {
            Rotation::Plane { angle, inertia } => Rotation::Plane { angle: f(*angle), inertia: f(*inertia) },
            Rotation::Space { frame, inertia } => {
                Rotation::Space { frame: Box::new(frame.map(&mut f)), inertia: inertia.map(f) }
            }
        }
    }

    /// The moments of inertia.
    pub fn inertias(&self) -> &[Id] {
        match self {
            Rotation::Plane { inertia, .. } => std::slice::from_ref(inertia),
            Rotation::Space { inertia, .. } => inertia,
        }
    }

    /// The same, to change them.
    pub fn inertias_mut(&mut self) -> &mut [Id] {
        match self {
            Rotation::Plane { inertia, .. } => std::slice::from_mut(inertia),
            Rotation::Space { inertia, .. } => inertia,
        }
    }

    /// Where it is turned to: the angle, or the components of its unit vectors.
    pub fn attitude(&self) -> Vec<Id> {
        match self {
            Rotation::Plane { angle, .. } => vec![*angle],
            Rotation::Space { frame, .. } => frame.axes.as_flattened().to_vec(),
        }
    }

    /// Its angular velocity in ground axes, with the time derivative of a planar angle.
    pub fn angular_velocity(&self, rate: impl FnOnce(Id) -> Id) -> Vec<Id> {
        match self {
            Rotation::Plane { angle, .. } => vec![rate(*angle)],
            Rotation::Space { frame, .. } => frame.velocity.to_vec(),
        }
    }

    /// I ω, or R I Rᵀ ω, in ground axes.
    pub fn angular_momentum(&self, graph: &mut Graph, omega: &[Id]) -> Vec<Id> {
        match self {
            Rotation::Plane { inertia, .. } => vec![graph.mul(*inertia, omega[0])],
            Rotation::Space { frame, inertia } => {
                let own = frame.along_axes(graph, omega);
                let momentum = product(graph, inertia, &own);
                frame.in_ground(graph, momentum).to_vec()
            }
        }
    }

    /// Its angular velocity along its own axes, with the time derivative of a planar angle.
    pub fn own_angular_velocity(&self, rate: impl FnOnce(Id) -> Id) -> Vec<Id> {
        match self {
            Rotation::Plane { angle, .. } => vec![rate(*angle)],
            Rotation::Space { frame, .. } => frame.own_velocity.to_vec(),
        }
    }

    /// ω·I ω of the angular velocity along its own axes.
    pub fn doubled_energy(&self, graph: &mut Graph, omega: &[Id]) -> Id {
        match (self, omega) {
            (Rotation::Space { inertia, .. }, &[x, y, z]) => {
                let momentum = product(graph, inertia, &[x, y, z]);
                vectors::dot(graph, omega, &momentum)
            }
            _ => {
                let square = graph.mul(omega[0], omega[0]);
                graph.mul(self.inertias()[0], square)
            }
        }
    }
}

/// A quaternion, scalar first, of any length but 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quaternion(pub [Id; 4]);

impl Quaternion {
    /// No turn.
    pub const ONE: Quaternion = Quaternion([Id::ONE, Id::ZERO, Id::ZERO, Id::ZERO]);

    /// Of a vector's components.
    pub fn of_components([x, y, z]: [Id; 3]) -> Quaternion {
        Quaternion([Id::ZERO, x, y, z])
    }

    /// Of a turn about an axis of length 1.
    pub fn of_turn(graph: &mut Graph, axis: [Id; 3], angle: Id) -> Quaternion {
        let two = graph.integer(2);
        let half = graph.div(angle, two);
        let (sine, cosine) = (graph.unary(Unary::Sin, half), graph.unary(Unary::Cos, half));
        let [x, y, z] = axis.map(|component| graph.mul(sine, component));
        Quaternion([cosine, x, y, z])
    }

    /// Of an axis times an angle.
    pub fn of_vector(graph: &mut Graph, vector: [Id; 3]) -> Quaternion {
        let angle = vectors::norm(graph, &vector);
        let unit = vectors::unit(graph, &vector);
        Quaternion::of_turn(graph, [unit[0], unit[1], unit[2]], angle)
    }

    /// Of length 1.
    pub fn unit(&self, graph: &mut Graph) -> Quaternion {
        let length = vectors::norm(graph, &self.0);
        Quaternion(self.0.map(|x| graph.div(x, length)))
    }

    /// p ∘ q.
    pub fn times(&self, graph: &mut Graph, other: Quaternion) -> Quaternion {
        let ([a, p @ ..], [b, q @ ..]) = (self.0, other.0);
        let scalars = graph.mul(a, b);
        let dot = vectors::dot(graph, &p, &q);
        let across = vectors::cross_space(graph, &p, &q);
        let vector: [Id; 3] = std::array::from_fn(|k| {
            let (aq, bp) = (graph.mul(a, q[k]), graph.mul(b, p[k]));
            let sum = graph.add(aq, bp);
            graph.add(sum, across[k])
        });
        Quaternion([graph.sub(scalars, dot), vector[0], vector[1], vector[2]])
    }
}

impl Orientation {
    /// Turned further once and for all, by a quaternion of parameters, of any length but 0.
    pub fn set(&self, graph: &mut Graph, q: Quaternion) -> Orientation {
        let still = self.turned_by(graph, [q, Quaternion([Id::ZERO; 4])]);
        Orientation { turns: self.turns.clone(), depth: self.depth, ..still }
    }

    /// Turned further by a rotation, a quaternion q of any length with its rate.
    pub fn rotated(&self, graph: &mut Graph, index: usize, pair: [Quaternion; 2]) -> Orientation {
        let mut new = self.turned_by(graph, pair);
        new.rotations.push(index);
        new.stages.iter_mut().next_back().into_iter().for_each(|stage| stage.rotation = Some(index));
        new
    }

    /// Turned further by a quaternion q of any length, with its rate v: the columns of R(q)/|q|², ω = 2 (q̄ ∘ v)/|q|² along the new axes and
    /// 2 (v ∘ q̄)/|q|² along the old ones.
    fn turned_by(&self, graph: &mut Graph, [q, v]: [Quaternion; 2]) -> Orientation {
        let [w, x, y, z] = q.0;
        let square = vectors::dot(graph, &q.0, &q.0);
        let two = graph.integer(2);
        let factor = graph.div(two, square);
        let conjugate = Quaternion([w, graph.neg(x), graph.neg(y), graph.neg(z)]);
        // 1 − 2 (y² + z²)/|q|² and 2 (x y ± w z)/|q|².
        let mut element = |[a, b]: [Id; 2], [c, d]: [Id; 2], minus: bool| {
            let (first, second) = (graph.mul(a, b), graph.mul(c, d));
            let sum = if minus { graph.sub(first, second) } else { graph.add(first, second) };
            graph.mul(factor, sum)
        };
        let [exy, eyx] = [false, true].map(|minus| element([x, y], [w, z], minus));
        let [ezx, exz] = [false, true].map(|minus| element([x, z], [w, y], minus));
        let [eyz, ezy] = [false, true].map(|minus| element([y, z], [w, x], minus));
        let squares = [(y, z), (x, z), (x, y)].map(|(a, b)| element([a, a], [b, b], false));
        let [exx, eyy, ezz] = squares.map(|square| graph.sub(Id::ONE, square));
        let columns = [[exx, exy, exz], [eyx, eyy, eyz], [ezx, ezy, ezz]];
        let [own, outer] = [conjugate.times(graph, v), v.times(graph, conjugate)].map(|product| {
            let [_, vector @ ..] = product.0;
            vector.map(|component| graph.mul(factor, component))
        });
        let outer = self.in_ground(graph, outer);
        let axes = columns.map(|column| self.in_ground(graph, column));
        let own_velocity = std::array::from_fn(|k| {
            let before = vectors::dot(graph, &columns[k], &self.own_velocity);
            graph.add(before, own[k])
        });
        let velocity = std::array::from_fn(|m| graph.add(self.velocity[m], outer[m]));
        let mut stages = self.stages.clone();
        stages.push(Stage { columns, rate: own, rotation: None, given: Given::By(q) });
        Orientation {
            axes,
            own_velocity,
            velocity,
            turns: Turns::none(),
            depth: self.depth + 1,
            stages,
            ..self.clone()
        }
    }
}
