//! Gaps of contacts that are no distances: by how much what is across moves faster than they change.

use super::attachment::states;
use super::contacts::ContactText;
use crate::diagnose::catalogue::mechanics;
use crate::expr::{Graph, Id, Symbol, Tape, jacobian, substitute, vectors};
use crate::model::expression::value::Value;
use crate::model::resolver::Resolver;

/// Newton's steps by which a gap is closed at a random place.
const CLOSINGS: usize = 30;
/// A gap below this is closed, m: Newton's steps leave what double precision rounds of a metre.
const CLOSED: f64 = 1e-12;
/// A normal may be off by so much, rad: as far as numbers that are written out with six digits are.
const OFF: f64 = 1e-6;

/// A gap, and how it and its measure along the normal change with each speed.
struct Opening {
    gap: Id,
    across: Vec<Id>,
    slopes: Vec<Id>,
}

impl Resolver<'_> {
    /// Measures gaps along their normals, where they are written otherwise (`y - x/2` of a slope): what is across moves σ times as fast as the gap,
    /// so that the force across is the multiplier divided by σ.
    ///
    /// Balances ask for the force across on both sides, so that a wrong `from` shows where there are some.
    ///
    /// With constraints beside contacts coordinates may stand for each other, so that rates differ which are the same in every motion: a normal is
    /// not refused then.
    pub fn measure_gaps(&mut self) {
        let own: Vec<usize> = self.contacts.iter().flat_map(ContactText::constraints).collect();
        let alone = own.len() == self.model.constraints.len();
        let balanced = self.root.get("balances").is_some();
        for contact in self.contacts.clone() {
            let approach = contact.approach.and_then(|item| self.scope.values.get(item).cloned().flatten());
            let (Some(normal), Some(Value::Scalar(approach))) = (contact.normal, approach) else { continue };
            let Some(gap) = self.value_of(normal) else { continue };
            let Some(opening) = self.opening(gap, approach) else { continue };
            match self.scale_of(&opening) {
                Some(scale) => self.divide_multiplier(normal, scale),
                None if alone && (balanced || contact.tangent.is_some() || contact.says_where()) => {
                    self.builder.problems.push(mechanics::normal_not_across(contact.place.clone(), &contact.name));
                }
                // Without balances, and where nobody says at which point it acts, nothing asks for the force across.
                None => {}
            }
        }
    }

    /// Lets the multiplier of a constraint stand for a force, in what is known already too.
    fn divide_multiplier(&mut self, constraint: usize, scale: Id) {
        let symbol = Symbol::Multiplier(self.model.constraints[constraint].first as u32);
        let multiplier = self.builder.graph.symbol(symbol);
        self.scope.constraints[constraint].scale = Some(scale);
        let graph = &mut self.builder.graph;
        let force = [(symbol, graph.div(multiplier, scale))].into_iter().collect();
        for value in self.scope.values.iter_mut().flatten() {
            *value = value.map(|id| substitute(graph, &[id], &force)[0]);
        }
    }

    /// The force across a contact.
    pub fn force_across(&mut self, normal: usize) -> Id {
        let multiplier = self.multiplier_of(normal);
        let scale = self.scope.constraints.get(normal).and_then(|names| names.scale);
        scale.map_or(multiplier, |scale| self.builder.graph.div(multiplier, scale))
    }

    /// How a gap and its measure along the normal change with the speeds; `None` where they do alike.
    fn opening(&mut self, gap: Id, approach: Id) -> Option<Opening> {
        let graph = &mut self.builder.graph;
        let n = self.model.coordinates.len();
        let row = |graph: &mut Graph, value: Id, of: fn(Symbol) -> Option<usize>| {
            let mut row = vec![Id::ZERO; n];
            jacobian(graph, &[value], of).into_iter().flatten().for_each(|(i, slope)| row[i] = slope);
            row
        };
        let across = row(graph, approach, |symbol| match symbol {
            Symbol::Speed(i) => Some(i as usize),
            _ => None,
        });
        let slopes = row(graph, gap, |symbol| match symbol {
            Symbol::Coordinate(i) => Some(i as usize),
            _ => None,
        });
        let differences = vectors::difference(graph, &across, &slopes);
        (differences.iter().any(|x| *x != Id::ZERO) && !self.still(&[differences])[0]).then_some(Opening {
            gap,
            across,
            slopes,
        })
    }

    /// σ = a·b/b·b for the rates a·q' along the normal and b·q' of the gap; `None` where a is not σ b with a positive σ wherever the gap
    /// is closed, at random places.
    fn scale_of(&mut self, Opening { gap, across, slopes }: &Opening) -> Option<Id> {
        let graph = &mut self.builder.graph;
        let (product, square) = (vectors::dot(graph, across, slopes), vectors::dot(graph, slopes, slopes));
        let scale = graph.div(product, square);
        let tape = Tape::new(graph, &[&[*gap, scale][..], across, slopes].concat());
        for mut state in states(&self.builder, &self.model) {
            for _ in 0..CLOSINGS {
                let values: Vec<f64> = tape.evaluate(|symbol| state.value(symbol));
                let slopes = &values[2 + across.len()..];
                let square: f64 = slopes.iter().map(|slope| slope * slope).sum();
                state.shift(slopes.iter().map(|slope| -slope * values[0] / square));
            }
            let values: Vec<f64> = tape.evaluate(|symbol| state.value(symbol));
            let (across, slopes) = values[2..].split_at(across.len());
            let most = across.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            // Where the gap does not close, nothing is known.
            let reach = slopes.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if !(values[0].abs() <= CLOSED * reach && most.is_finite()) {
                continue;
            }
            let fits = across.iter().zip(slopes).all(|(a, b)| (a - values[1] * b).abs() <= OFF * most);
            if !fits || values[1] <= 0.0 {
                return None;
            }
        }
        Some(scale)
    }
}
