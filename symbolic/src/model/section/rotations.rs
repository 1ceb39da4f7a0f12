//! Coordinates of kind `rotation`: a quaternion of any length each, its start, and the inertia of its length.
//!
//! R = R(q)/|q|² and ω do not depend on the length r = |q|, so that no constraint keeps it.  With a kinetic energy of its own, 2 ρ (r'/r)²,
//! the mass matrix is regular, and the motion of the length, (ln r)'' = 0, is decoupled from all else.

use super::resolve_values::Axis;
use crate::diagnose::catalogue::{mechanics, names, sections};
use crate::expr::{Id, Symbol, vectors};
use crate::file::{Node, Quantity, Spot, describe};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Expanded;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::resolved::{Balance, Coordinate, Part, RotationCoordinate, Scene, Spin};
use crate::model::resolver::Resolver;
use crate::model::rotation::{Orientation, Quaternion, Rotation, Turn};

/// The kind of coordinate, as written in the place of a unit.
pub const ROTATION: &str = "rotation";

/// So many are derived: with more the equations of free bodies alone are beyond the limit of the graph.
const MOST_ROTATIONS: usize = 64;
/// A number of a quaternion.
const NUMBER: Rules = Rules::constant("a start of it").si(Dimension::ONE);
/// A component of axis times angle, rad.
const ANGLE: Rules = Rules::constant("an angle of the start").si(Dimension::ONE);
/// A component of an angular velocity, or the rate of an angle, rad/s.
const TURNING: Rules = Rules::constant("a start of it").si(Dimension::RATE);

/// The components of a quaternion, scalar first.
const COMPONENTS: [&str; 4] = ["w", "x", "y", "z"];

impl Resolver<'_> {
    /// Declares a rotation: four coordinates.
    pub fn declare_rotation(&mut self, member: &Expanded, spot: &Spot<'_>) {
        let (index, first) = (self.model.rotations.len(), self.model.coordinates.len());
        if index >= MOST_ROTATIONS {
            let limit = format!("a model may have {MOST_ROTATIONS} rotations");
            self.builder.problems.push(mechanics::too_many_turns(spot.place.of_key(), limit));
            self.declare(Section::Coordinate, member, Member::Refused, &spot.place);
            return;
        }
        if !self.declare(Section::Coordinate, member, Member::Rotation(index), &spot.place) {
            return;
        }
        let name = member.name();
        for component in COMPONENTS {
            let name = format!("{name}.{component}");
            self.model.coordinates.push(Coordinate { name, unit: Some("1".to_owned()), place: spot.place.of_key() });
            self.scope.units.coordinates.push(self.scope.units.of(Dimension::ONE));
        }
        self.scope.rotations.push(first);
        self.model.rotations.push(RotationCoordinate { name, first, place: spot.place.of_key() });
    }

    /// The quaternion of a rotation, and its rate, as symbols.
    fn quaternion(&mut self, first: usize) -> [Quaternion; 2] {
        let graph = &mut self.builder.graph;
        let components = |symbol: fn(u32) -> Symbol| [0, 1, 2, 3].map(|k| symbol(first as u32 + k));
        [components(Symbol::Coordinate), components(Symbol::Speed)]
            .map(|symbols| Quaternion(symbols.map(|symbol| graph.symbol(symbol))))
    }

    /// q·q'/|q|², the rate of the logarithm of a rotation's length.
    fn growth(&mut self, first: usize) -> Id {
        let [q, v] = self.quaternion(first);
        let graph = &mut self.builder.graph;
        let (rate, square) = (vectors::dot(graph, &q.0, &v.0), vectors::dot(graph, &q.0, &q.0));
        graph.div(rate, square)
    }

    /// The kinetic energy of all lengths, 2 ρ (r'/r)², with a third of the moments of inertia of what the rotation turns as ρ: a body with
    /// equal moments then has a mass matrix of one number.
    pub fn radial_energy(&mut self) {
        for index in 0..self.model.rotations.len() {
            let turned = self.model.bodies.iter().filter_map(|body| body.rotation.as_ref());
            let moments: Vec<Id> = turned
                .filter_map(|rotation| match rotation {
                    Rotation::Space { frame, inertia } if frame.rotations.contains(&index) => {
                        Some(inertia[..3].to_vec())
                    }
                    _ => None,
                })
                .flatten()
                .collect();
            let growth = self.growth(self.model.rotations[index].first);
            let graph = &mut self.builder.graph;
            let trace = moments.iter().fold(Id::ZERO, |sum, moment| graph.add(sum, *moment));
            let (two, three) = (graph.integer(2), graph.integer(3));
            let inertia = if trace == Id::ZERO { Id::ONE } else { graph.div(trace, three) };
            let square = graph.mul(growth, growth);
            let term = graph.mul(inertia, square);
            let doubled = graph.mul(two, term);
            self.model.radial_energy = graph.add(self.model.radial_energy, doubled);
        }
    }

    /// That the lengths of rotations grow by themselves, for a system of balances.
    pub fn radial_balances(&mut self) -> Vec<Balance> {
        let rotations = self.model.rotations.clone();
        let balance = |rotation: RotationCoordinate| {
            let growth = self.growth(rotation.first);
            let value = vec![self.builder.rate(growth)];
            let label = format!("the length of {}", rotation.name);
            let parts = vec![Part { name: label.clone(), value }];
            let (terms, products) = (Vec::new(), Vec::new());
            Balance {
                label,
                parts,
                terms,
                products,
                components: 1,
                void_at_rest: false,
                instantaneous: true,
                place: rotation.place,
            }
        };
        rotations.into_iter().map(balance).collect()
    }

    /// Puts unturned rotations where a scene begins unless it says otherwise.
    pub fn unturned(&self, q: &mut [Id]) {
        for rotation in &self.model.rotations {
            q[rotation.first] = Id::ONE;
        }
    }

    /// The start of a rotation: a sequence of turns as in `rotate`, `{quaternion: [w, x, y, z]}` of any length, or `{vector: [a, b, c]}`,
    /// axis times angle.
    pub fn start_of_rotation(&mut self, index: usize, spot: &Spot<'_>, scene: &mut Scene) {
        let first = self.model.rotations[index].first;
        if scene.held_q[first] {
            self.builder.problems.push(names::member_twice(spot.place.of_key(), &self.model.rotations[index].name));
            return;
        }
        let Some(q) = self.rotation_given(index, spot) else { return };
        scene.q[first..first + 4].copy_from_slice(&q.0);
        scene.held_q[first..first + 4].fill(true);
    }

    /// A rotation in one of these forms, as a quaternion.
    pub fn rotation_given(&mut self, index: usize, spot: &Spot<'_>) -> Option<Quaternion> {
        if matches!(spot.node, Node::Map(_))
            && !spot.only(&["quaternion", "vector"], "a start", &mut self.builder.problems)
        {
            return None;
        }
        match (spot.get("quaternion"), spot.get("vector")) {
            (Some(_), Some(vector)) => {
                let both = sections::conflicting_keys(vector.place.of_key(), "quaternion", "vector", "a start");
                self.builder.problems.push(both);
                None
            }
            (Some(numbers), None) => self.numbers::<4>(&numbers, NUMBER).and_then(|q| {
                let square = vectors::dot(&mut self.builder.graph, &q, &q);
                if self.builder.graph.number(square).is_some_and(|square| square.to_f64() == 0.0) {
                    self.builder.problems.push(mechanics::no_axis(numbers.place.clone()));
                    return None;
                }
                Some(Quaternion(q).unit(&mut self.builder.graph))
            }),
            (None, Some(numbers)) => {
                let components = self.numbers::<3>(&numbers, ANGLE)?;
                for component in numbers.items().unwrap_or_default() {
                    let angle = component.quantity(&mut self.builder.problems)?;
                    self.degrees(&angle, &self.model.rotations[index].name.clone());
                }
                Some(Quaternion::of_vector(&mut self.builder.graph, components))
            }
            _ => self.turns_of_start(index, spot).map(|turns| {
                let graph = &mut self.builder.graph;
                turns.iter().fold(Quaternion::ONE, |q, turn| q.times(graph, turn.quaternion))
            }),
        }
    }

    /// The start of a rotation's rate: its angular velocity along its own axes, `{ground: [a, b, c]}` along the axes from which it is
    /// turned, or `{angles: [a, b, c]}`, the rates of the angles of its start.
    pub fn start_of_rate(&mut self, index: usize, spot: &Spot<'_>, start: Option<&Spot<'_>>, scene: &mut Scene) {
        let first = self.model.rotations[index].first;
        if scene.held_v[first] {
            let name = format!("{}'", self.model.rotations[index].name);
            self.builder.problems.push(names::member_twice(spot.place.of_key(), name));
            return;
        }
        let (components, own) = match (spot.get("ground"), spot.get("angles")) {
            (Some(numbers), None) => (self.numbers::<3>(&numbers, TURNING), false),
            (None, Some(numbers)) => (self.rates_of_angles(index, &numbers, start), true),
            _ => (self.numbers::<3>(spot, TURNING), true),
        };
        let Some(components) = components else { return };
        scene.v[first..first + 4].copy_from_slice(&Quaternion::of_components(components).0);
        scene.held_v[first..first + 4].fill(true);
        scene.spins.push(Spin { first, own });
    }

    /// Makes the angular velocities of a scene rates of its rotations, now that their attitudes are known.
    pub fn rates_of_spins(&mut self, scene: &mut Scene) {
        let half = self.half();
        let graph = &mut self.builder.graph;
        for Spin { first, own } in scene.spins.clone() {
            let [q, components] = [&scene.q, &scene.v].map(|list| Quaternion([0, 1, 2, 3].map(|k| list[first + k])));
            let rate = if own { q.times(graph, components) } else { components.times(graph, q) };
            for k in 0..4 {
                scene.v[first + k] = graph.mul(half, rate.0[k]);
            }
        }
    }

    /// The angular velocity along the own axes, of the rates of the angles of a sequence.
    fn rates_of_angles(&mut self, index: usize, spot: &Spot<'_>, start: Option<&Spot<'_>>) -> Option<[Id; 3]> {
        let turns = start.and_then(|start| self.turns_of_start(index, start));
        let Some(turns) = turns else {
            self.builder.problems.push(sections::needs_another_key(
                spot.place.of_key(),
                "angles",
                "start",
                "a rotation that starts by a sequence of turns",
            ));
            return None;
        };
        let rates = self.list(spot, turns.len(), TURNING)?;
        let graph = &mut self.builder.graph;
        let mut frame = Orientation::ground();
        for (turn, rate) in turns.iter().zip(rates) {
            let by = Turn::by(graph, turn.angle, rate);
            frame = frame.turned_about(graph, turn.axis, by);
        }
        Some(frame.own_velocity)
    }

    fn turns_of_start(&mut self, index: usize, spot: &Spot<'_>) -> Option<Vec<StartTurn>> {
        let written = self.written_turns(spot)?;
        let mut turns = Vec::new();
        for (axis, angle) in written {
            let axis = match axis {
                Axis::Own(k) => std::array::from_fn(|i| if i == k { Id::ONE } else { Id::ZERO }),
                Axis::Direction(written) => {
                    let direction = self.vector(&written, Rules::constant("an axis"), &Self::no_locals())?;
                    let unit = vectors::unit(&mut self.builder.graph, &direction);
                    unit.try_into().ok()?
                }
                Axis::Rotation => return None,
                Axis::Quaternion(_) => {
                    let problem = mechanics::not_a_turn(spot.place.clone(), "a list with a quaternion");
                    self.builder.problems.push(problem);
                    return None;
                }
            };
            let angle = Quantity { text: angle, unit: None };
            self.degrees(&angle, &self.model.rotations[index].name.clone());
            let angle = self.setting(&angle, ANGLE, &Self::no_locals())?;
            let quaternion = Quaternion::of_turn(&mut self.builder.graph, axis, angle);
            turns.push(StartTurn { axis, angle, quaternion });
        }
        Some(turns)
    }

    fn numbers<const N: usize>(&mut self, spot: &Spot<'_>, rules: Rules) -> Option<[Id; N]> {
        self.list(spot, N, rules)?.try_into().ok()
    }

    /// A list of so many numbers of parameters; they turn in radians, not in cycles.
    fn list(&mut self, spot: &Spot<'_>, count: usize, rules: Rules) -> Option<Vec<Id>> {
        let items = spot.items().filter(|items| items.len() == count);
        let Some(items) = items else {
            let found = match spot.node {
                Node::List(items) => items.len(),
                _ => {
                    let what = format!("a list of {count} numbers");
                    self.builder.problems.push(sections::wrong_shape(
                        spot.place.clone(),
                        &spot.name,
                        what,
                        describe(spot.node),
                    ));
                    return None;
                }
            };
            self.builder.problems.push(sections::list_length(spot.place.clone(), &spot.name, count, found));
            return None;
        };
        let mut numbers = Vec::new();
        for item in items {
            let quantity = item.quantity(&mut self.builder.problems)?;
            numbers.push(self.setting(&quantity, rules.counting(Some("rad")), &Self::no_locals())?);
        }
        Some(numbers)
    }
}

/// A turn of the sequence in which a rotation starts.
struct StartTurn {
    axis: [Id; 3],
    angle: Id,
    quaternion: Quaternion,
}
