//! Frequencies in Hz that enter an angle without the factor 2π.

use std::collections::HashSet;
use std::f64::consts::PI;

use crate::diagnose::catalogue::units;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};
use crate::model::expression::rules::Counts;
use crate::model::resolver::Resolver;
use crate::model::rotation::Rotation;

/// How near a factor must be to a multiple of π to stand for one: `6.28` does, and `22/7`.
const NEAR: f64 = 0.01;

/// What an angle is made of, outside the functions in it.
#[derive(Default)]
struct Angle {
    parameters: Vec<usize>,
    turned: bool,
}

impl Resolver<'_> {
    /// Warns where a parameter in Hz, times t, is an angle as it stands.
    pub fn cycles(&mut self) {
        let counted = |unit: Option<&str>| Counts::of(unit) == Counts::Cycles;
        let hertz: Vec<bool> = self.model.parameters.iter().map(|p| counted(p.unit.as_deref())).collect();
        if !hertz.contains(&true) {
            return;
        }
        let graph = &self.builder.graph;
        let timed = graph.contains(|symbol| matches!(symbol, Symbol::Time));
        let mut found = vec![false; hertz.len()];
        for angle in angles(graph).into_iter().chain(self.angles_of_bodies()) {
            let angle = self.signal_of(angle).unwrap_or(angle);
            if !timed[angle.index()] {
                continue;
            }
            let made = self.made_of(angle);
            for place in made.parameters.into_iter().filter(|_| !made.turned) {
                found[place] |= hertz[place];
            }
        }
        for (parameter, _) in self.model.parameters.iter().zip(found).filter(|(_, found)| *found) {
            self.model.warnings.push(units::cycles_in_angle(parameter.place.clone(), &parameter.name));
        }
    }

    fn angles_of_bodies(&self) -> Vec<Id> {
        let rotations = self.model.bodies.iter().filter_map(|body| body.rotation.as_ref());
        let angle = |rotation: &Rotation| match rotation {
            Rotation::Plane { angle, .. } => Some(*angle),
            // In space angles stand in sines and cosines.
            Rotation::Space { .. } => None,
        };
        rotations.filter_map(angle).collect()
    }

    /// The function of time that an input is.
    fn signal_of(&self, id: Id) -> Option<Id> {
        match self.builder.graph.node(id) {
            Node::Symbol(Symbol::Input(place, 0)) => Some(self.model.inputs[place as usize].signal[0]),
            _ => None,
        }
    }

    /// What an angle is made of by sums, products and quotients.
    fn made_of(&self, angle: Id) -> Angle {
        let graph = &self.builder.graph;
        let (mut made, mut seen, mut open) = (Angle::default(), HashSet::new(), vec![angle]);
        while let Some(id) = open.pop() {
            if !seen.insert(id) {
                continue;
            }
            match graph.node(id) {
                Node::Number(_) => made.turned |= graph.number(id).is_some_and(|number| is_turn(number.to_f64())),
                Node::Symbol(Symbol::Parameter(place)) => {
                    let parameter = &self.model.parameters[place as usize];
                    let pure = matches!(parameter.unit.as_deref(), None | Some("1"));
                    made.turned |= pure && is_turn(parameter.default);
                    made.parameters.push(place as usize);
                }
                Node::Symbol(_) => open.extend(self.signal_of(id)),
                Node::Unary(Unary::Neg, x) => open.push(x),
                Node::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Div, x, y) => open.extend([x, y]),
                Node::Unary(..) | Node::Binary(..) => {}
            }
        }
        made
    }
}

/// Arguments of sines, cosines and tangents.
fn angles(graph: &Graph) -> Vec<Id> {
    let nodes = (0..graph.len()).map(|place| graph.node(graph.id_at(place)));
    nodes
        .filter_map(|node| match node {
            Node::Unary(Unary::Sin | Unary::Cos | Unary::Tan, x) => Some(x),
            _ => None,
        })
        .collect()
}

/// Near a multiple of π; of large numbers all are.
fn is_turn(factor: f64) -> bool {
    let half_turns = factor.abs() / PI;
    (1.0..10.0).contains(&half_turns.round()) && (half_turns / half_turns.round() - 1.0).abs() < NEAR
}
