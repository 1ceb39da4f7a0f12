//! Momentum, angular momentum, and the components of a vector along a frame's axes.

use super::dimension::{Dimension, Measure};
use super::lower::Lower;
use super::names::Solid;
use super::value::Value;
use crate::diagnose::catalogue::names;
use crate::expr::{Binary, Id, Unary, vectors};
use crate::language::{Ast, AstKind};
use crate::model::rotation::Quaternion;

impl Lower<'_> {
    /// `components(v, B)` = [v·B.x, v·B.y, v·B.z].
    pub(super) fn components(&mut self, vector: &Ast, frame: &Ast) -> Value {
        let solid = self.solid_argument("components", frame, "a body or frame");
        let vector = self.vector_argument("components", vector);
        let (Some(solid), Some(vector)) = (solid, vector) else { return Value::Poison };
        let mut components = Vec::new();
        for axis in 0..self.scope.dimension as u8 {
            let Value::Vector(unit) = self.unit_vector(solid, "", axis, frame.span) else { return Value::Poison };
            components.push(vectors::dot(&mut self.builder.graph, &vector, &unit));
        }
        Value::Vector(components)
    }

    /// `angles(B, zxz)`: the angles of the intrinsic sequence of turns that gives a frame in space; the first and the third from −π to π,
    /// the middle one from 0 to π where the first and the third axis are the same, else from −π/2 to π/2.
    pub(super) fn angles(&mut self, frame: &Ast, sequence: &Ast) -> Value {
        if !self.rules.energy || self.scope.dimension == 2 {
            return self.refuse(names::wrong_place(self.place(frame.span), "angles", self.rules.what));
        }
        let words = self.text.words(sequence.span).to_owned();
        let axes: Vec<usize> =
            words.bytes().filter_map(|axis| b"xyz".iter().position(|known| *known == axis)).collect();
        let &[i, j, k] = axes.as_slice() else { return self.not_a_sequence(sequence) };
        if words.len() != 3 || i == j || j == k {
            return self.not_a_sequence(sequence);
        }
        let Some(solid) = self.solid_argument("angles", frame, "a body or frame") else { return Value::Poison };
        let mut columns = Vec::new();
        for axis in 0..3 {
            let Value::Vector(column) = self.unit_vector(solid, "", axis, frame.span) else { return Value::Poison };
            columns.push(column);
        }
        let graph = &mut self.builder.graph;
        // R[m][n] = e_m·B_n, of R = R_i(a) R_j(b) R_k(c); `last` is the third axis of a sequence such as zxz.
        let last = 3 - i - j;
        let cyclic = (i + 1) % 3 == j;
        let mut signed = |x: Id, minus: bool| if minus { graph.neg(x) } else { x };
        let element = |m: usize, n: usize| columns[n][m];
        let (first, middle) = if i == k {
            let first = [element(j, i), signed(element(last, i), cyclic)];
            (first, [[element(i, j), element(i, last)], [element(i, i); 2]])
        } else {
            let first = [signed(element(j, k), cyclic), element(k, k)];
            (first, [[element(i, i), element(i, j)], [signed(element(i, k), !cyclic); 2]])
        };
        let across = vectors::norm(graph, &middle[0]);
        let middle = if i == k { [across, middle[1][0]] } else { [middle[1][0], across] };
        let [first, middle] = [first, middle].map(|[y, x]| graph.binary(Binary::Atan2, y, x));
        // Row j of R_i(−a) R is that of R_k(c): where the first and the third turn are about one line, and the first angle is any, the third
        // goes with it (Shoemake, Graphics Gems IV, 1994, p. 222).
        let (sine, cosine) = (graph.unary(Unary::Sin, first), graph.unary(Unary::Cos, first));
        let mut turned_back = |n: usize| {
            let (kept, swept) = (graph.mul(cosine, element(j, n)), graph.mul(sine, element(last, n)));
            if cyclic { graph.add(kept, swept) } else { graph.sub(kept, swept) }
        };
        let (x, y) = (turned_back(j), turned_back(3 - j - k));
        let y = if (k + 1) % 3 == j { graph.neg(y) } else { y };
        Value::Vector(vec![first, middle, graph.binary(Binary::Atan2, y, x)])
    }

    /// `quaternion(B)` = [w, x, y, z] of length 1: how a frame in space is turned against the ground.
    pub(super) fn quaternion(&mut self, frame: &Ast) -> Value {
        if !self.rules.energy || self.scope.dimension == 2 {
            return self.refuse(names::wrong_place(self.place(frame.span), "quaternion", self.rules.what));
        }
        let Some(solid) = self.solid_argument("quaternion", frame, "a body or frame") else { return Value::Poison };
        // A particle, which has no axes, is refused here.
        let Value::Vector(_) = self.unit_vector(solid, "", 0, frame.span) else { return Value::Poison };
        let item = match solid {
            Solid::Ground => None,
            Solid::Frame(item) => Some(item),
            Solid::Body(body) => self.scope.bodies[body].orientation,
        };
        match item.map(|item| self.item(item)) {
            None => Value::Vector(Quaternion::ONE.0.to_vec()),
            Some(Value::Orientation(frame)) => Value::Vector(frame.quaternion(&mut self.builder.graph).0.to_vec()),
            Some(_) => Value::Poison,
        }
    }

    fn not_a_sequence(&mut self, sequence: &Ast) -> Value {
        let words = self.text.words(sequence.span).to_owned();
        let mut problem =
            names::argument_kind(self.place(sequence.span), "angles", "a sequence of axes", "something else");
        problem.help = format!("three letters of x, y, z, neighbours different: `angles(B, zxz)`; not `{words}`");
        self.refuse(problem)
    }

    /// `momentum(B)` = Σ m v of a body, or of `all`.
    pub(super) fn momentum(&mut self, of: &Ast) -> Value {
        let Some(bodies) = self.bodies_of("momentum", of) else { return Value::Poison };
        self.momentum_of(&bodies)
    }

    /// Σ m v of these bodies.
    pub(super) fn momentum_of(&mut self, bodies: &[usize]) -> Value {
        let mut total = vec![Id::ZERO; self.scope.dimension];
        for body in bodies {
            let body = &self.scope.massive[*body];
            let velocity = self.builder.rates(&body.position);
            total = vectors::add_scaled(&mut self.builder.graph, &total, body.mass, &velocity);
        }
        Value::Vector(total)
    }

    /// Σ ((r − P) × m v + R I Rᵀ ω): `angular_momentum(B)` of a body about its centre of mass, `angular_momentum(B, P)` of a body or of
    /// `all` about P, `angular_momentum(P)` of all bodies about P.
    pub(super) fn angular_momentum(&mut self, of: &Ast, about: Option<&Ast>) -> Value {
        let function = "angular_momentum";
        if !self.has_masses(function, of) {
            return Value::Poison;
        }
        let (bodies, about) = match about {
            Some(point) => (self.bodies_of(function, of), self.vector_argument(function, point)),
            None if self.names_bodies(of) => {
                let bodies = self.bodies_of(function, of);
                let centre = bodies.as_ref().and_then(|bodies| bodies.first());
                let centre = centre.map(|body| self.scope.massive[*body].position.clone());
                (bodies, centre)
            }
            None => (Some((0..self.scope.massive.len()).collect()), self.vector_argument(function, of)),
        };
        let (Some(bodies), Some(about)) = (bodies, about) else { return Value::Poison };
        let mut total = vec![Id::ZERO; vectors::moment_size(self.scope.dimension)];
        for body in bodies {
            let body = &self.scope.massive[body];
            let builder = &mut *self.builder;
            let velocity = builder.rates(&body.position);
            let spin =
                body.rotation.as_ref().map(|rotation| (rotation, rotation.angular_velocity(|x| builder.rate(x))));
            let graph = &mut builder.graph;
            let arm = vectors::difference(graph, &about, &body.position);
            let momentum = vectors::scaled(graph, body.mass, &velocity);
            let moment = vectors::moment(graph, &arm, &momentum);
            total = vectors::add(graph, &total, &moment);
            if let Some((rotation, omega)) = spin {
                let own = rotation.angular_momentum(graph, &omega);
                total = vectors::add(graph, &total, &own);
            }
        }
        match total.as_slice() {
            [scalar] => Value::Scalar(*scalar),
            _ => Value::Vector(total),
        }
    }

    /// Whether masses are known where this stands; reports where they are not.
    fn has_masses(&mut self, function: &str, at: &Ast) -> bool {
        let known = self.rules.energy && self.scope.energies.is_some();
        if !self.rules.energy {
            self.refuse(names::wrong_place(self.place(at.span), function, self.rules.what));
        }
        known
    }

    fn names_bodies(&self, of: &Ast) -> bool {
        use super::scope::Section;
        matches!(&of.kind, AstKind::Name { name, primes: 0, .. } if self.scope.names.get(name).is_some_and(|entry| entry.section == Section::Body))
    }

    /// The bodies that an argument names: one, or `all`.
    fn bodies_of(&mut self, function: &str, of: &Ast) -> Option<Vec<usize>> {
        if !self.has_masses(function, of) {
            return None;
        }
        if matches!(&of.kind, AstKind::Name { name, indices, primes: 0 } if name == "all" && indices.is_empty()) {
            return Some((0..self.scope.massive.len()).collect());
        }
        match self.solid_argument(function, of, "a body or `all`")? {
            Solid::Body(body) => Some(vec![body]),
            Solid::Ground => Some(Vec::new()),
            Solid::Frame(_) => {
                let words = self.text.words(of.span);
                self.refuse(names::wrong_thing(self.place(of.span), words, "a body", "a frame"));
                None
            }
        }
    }

    /// The unit of a momentum (N s), or of an angular momentum (N m s).
    pub(super) fn measure_of_momentum(&self, angular: bool) -> Measure {
        let units = &self.scope.units;
        let of = units.of(if angular { Dimension::ENERGY } else { Dimension::FORCE });
        of.over(units.rate(Measure::ONE))
    }
}
