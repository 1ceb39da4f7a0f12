//! Balances of many bodies from sums over blocks of bodies, which balances share.
//!
//! Bodies stand in the order of the file; blocks are halves of it, halves of these and so on.  Each block has one force, inertia less
//! loads, and one moment about the place of its first body.  A set of neighbours is made of a few blocks, so that n balances of up to n bodies
//! take n log n operations and not n².

use std::collections::HashMap;
use std::ops::Range;

use super::balances::Sums;
use crate::expr::{Id, vectors};
use crate::model::resolved::Part;
use crate::model::resolver::Resolver;

/// Up to so many bodies each is a part of its own, which is told by its name where a balance does not hold.
const EACH: usize = 16;

/// Force and moment of a block, and the place about which that is.
#[derive(Clone, Debug)]
struct Block {
    force: Vec<Id>,
    moment: Vec<Id>,
    about: Vec<Id>,
}

/// The blocks that were needed, by their first body and that after their last one.
#[derive(Clone, Debug, Default)]
pub struct Blocks(HashMap<(usize, usize), Block>);

/// What of a set of bodies is asked for.
pub enum Asked<'a> {
    Force,
    MomentAbout(&'a [Id]),
}

impl Resolver<'_> {
    /// Force or moment of a set of bodies, all in one; none where the bodies are few, or one stands there twice, or parts are asked for by name.
    pub fn running_sum(&mut self, set: &[usize], asked: &Asked<'_>, sums: &Sums<'_>) -> Option<Part> {
        let free = self.model.constraints.is_empty() && self.model.states.is_empty() && sums.has_no_unknowns();
        if self.in_parts || !free || set.len() <= EACH || self.model.coordinates.len() <= EACH {
            return None;
        }
        // How many of the set come before each body.
        let mut before = vec![0; self.model.bodies.len() + 1];
        for body in set {
            if std::mem::replace(&mut before[body + 1], 1) == 1 {
                return None;
            }
        }
        (0..self.model.bodies.len()).for_each(|body| before[body + 1] += before[body]);
        let components = match asked {
            Asked::Force => self.scope.dimension,
            Asked::MomentAbout(_) => vectors::moment_size(self.scope.dimension),
        };
        let mut value = vec![Id::ZERO; components];
        let mut open: Vec<Range<usize>> = std::iter::once(0..self.model.bodies.len()).collect();
        while let Some(range) = open.pop() {
            let count = before[range.end] - before[range.start];
            if count == range.len() {
                let block = self.block(range);
                let graph = &mut self.builder.graph;
                let more = match asked {
                    Asked::Force => block.force,
                    Asked::MomentAbout(about) => {
                        let arm = vectors::difference(graph, about, &block.about);
                        let moved = vectors::moment(graph, &arm, &block.force);
                        vectors::add(graph, &block.moment, &moved)
                    }
                };
                value = vectors::add(graph, &value, &more);
            } else if count > 0 {
                open.extend(halves(&range));
            }
        }
        Some(Part { name: format!("what moves {} bodies", set.len()), value })
    }

    fn block(&mut self, range: Range<usize>) -> Block {
        let key = (range.start, range.end);
        if let Some(known) = self.blocks.0.get(&key) {
            return known.clone();
        }
        let block = match range.len() {
            1 => self.body_alone(range.start),
            _ => {
                let [first, second] = halves(&range).map(|half| self.block(half));
                let graph = &mut self.builder.graph;
                let arm = vectors::difference(graph, &first.about, &second.about);
                let moved = vectors::moment(graph, &arm, &second.force);
                let moment = vectors::add(graph, &second.moment, &moved);
                Block {
                    force: vectors::add(graph, &first.force, &second.force),
                    moment: vectors::add(graph, &first.moment, &moment),
                    about: first.about,
                }
            }
        };
        self.blocks.0.insert(key, block.clone());
        block
    }

    /// m (a − g) and I α less all loads, about the place of the body.
    fn body_alone(&mut self, b: usize) -> Block {
        let body = self.model.bodies[b].clone();
        let mut force = self.mass_times_acceleration(b);
        let mut moment = match &body.rotation {
            Some(rotation) => self.rate_of_turning(rotation),
            None => vec![Id::ZERO; vectors::moment_size(self.scope.dimension)],
        };
        if let Some(gravity) = self.model.gravity.clone() {
            let weight: Vec<Id> = gravity.iter().map(|g| self.builder.graph.mul(body.mass, *g)).collect();
            force = vectors::difference(&mut self.builder.graph, &weight, &force);
        }
        let pushes = self.model.loads.iter().filter(|load| !load.is_moved()).flat_map(|load| &load.pushes);
        let own: Vec<_> = pushes.filter(|push| push.body == Some(b)).cloned().collect();
        let graph = &mut self.builder.graph;
        for push in own {
            let arm = vectors::difference(graph, &body.position, &push.at);
            let turning = vectors::moment(graph, &arm, &push.force);
            force = vectors::difference(graph, &push.force, &force);
            moment = vectors::difference(graph, &turning, &moment);
            moment = moment
                .iter()
                .zip(push.couple.iter().chain(std::iter::repeat(&Id::ZERO)))
                .map(|(moment, couple)| graph.sub(*moment, *couple))
                .collect();
        }
        Block { force, moment, about: body.position }
    }
}

fn halves(range: &Range<usize>) -> [Range<usize>; 2] {
    let middle = range.start + range.len() / 2;
    [range.start..middle, middle..range.end]
}

#[cfg(test)]
mod tests {
    use crate::expr::{Graph, Id, Symbol, Tape};
    use crate::model::{Files, Model, load, load_in_parts};
    use crate::number::DoubleDouble;
    use crate::random::Random;

    /// Links with a spring, a damper and a force each, and balances of what hangs on each joint, of a few bodies, and of all.
    const LINKS: &str = r#"
name: Links
sizes: {n: 40}
parameters: {"m[i in 1..n]": 1 kg, l: 1 m, g: 10 m/s^2, F: 3 N, k: 2 N/m, c: 1 N*s/m}
coordinates: {"theta[i in 1..n]": rad}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]": {mass: "m[i]", inertia: "m[i]*l^2/12", angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
springs: {"spring[i in 1..n]": {between: ["bar[i]", ground], stiffness: k, rest: l}}
forces: {"push[i in 1..n]": {on: "bar[i]", at: "tip[i]", force: "[F*i, F]"}}
torques: {"twist[i in 1..n]": {on: "bar[i]", torque: F*l}}
balances:
  equations:
    "joint[i in 1..n-2]": {moment: {about: "tip[i-1]", of: ["bar[j in i..n]"]}}
    some: {moment: {about: "tip[3]", of: ["bar[j in 2..19]", "bar[j in 25..n]"]}}
    along: {force: {of: all, along: "[1, 0.5]"}}
"#;

    fn residuals(model: &mut Model) -> Vec<Id> {
        let sum = |graph: &mut Graph, values: Vec<Id>| values.into_iter().fold(Id::ZERO, |sum, x| graph.add(sum, x));
        let balances = model.balances[0].balances.clone();
        let parts = balances.iter().map(|balance| balance.parts.iter().map(|part| part.value[0]).collect());
        parts.map(|values| sum(&mut model.graph, values)).collect()
    }

    #[test]
    fn sums_over_blocks_are_those_of_all_bodies() {
        let [mut summed, mut parts] = [load(LINKS, &[]), load_in_parts(&Files::default(), LINKS, &[])]
            .map(|model| model.unwrap_or_else(|p| panic!("{p:?}")));
        assert!(summed.balances[0].balances[0].parts.len() == 1 && parts.balances[0].balances[0].parts.len() > 100);
        let mut random = Random::new();
        let numbers: Vec<f64> = (0..200).map(|_| random.between(0.5, 1.5)).collect();
        let value = |symbol| {
            let number = match symbol {
                Symbol::Coordinate(i) => numbers[i as usize],
                Symbol::Speed(i) => numbers[40 + i as usize],
                Symbol::Acceleration(i) => numbers[80 + i as usize],
                Symbol::Parameter(i) => numbers[120 + i as usize],
                _ => f64::NAN,
            };
            DoubleDouble::from(number)
        };
        let [first, second] = [&mut summed, &mut parts].map(|model| {
            let roots = residuals(model);
            Tape::new(&model.graph, &roots).evaluate(value)
        });
        assert_eq!(first.len(), 40);
        for (a, b) in first.iter().zip(&second) {
            assert!((*a - *b).abs().to_f64() < 1e-25 * b.abs().to_f64(), "{a:?} {b:?}");
        }
    }

    /// Sums of n balances of up to n bodies have few nodes more than n.
    #[test]
    fn sums_share_their_blocks() {
        let size = |n: i64| load(LINKS, &[("n".to_owned(), n)]).map_or(0, |model| model.graph.len());
        let [short, long] = [size(100), size(400)];
        assert!(long < 6 * short, "{short} {long}");
    }
}
