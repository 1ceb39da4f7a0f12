//! Which bodies pins, rods and contacts that nobody named may connect.

use super::results::{SAME, Velocities};
use super::state::State;
use crate::expr::{Id, Tape};
use crate::model::Model;
use crate::number::DoubleDouble;

/// Which bodies may push each other in a direction in which one of them does not move.
pub(super) struct Links<'a> {
    velocities: &'a Velocities,
    /// Of each direction which component of its body's place it is; nothing for turns.
    axes: Vec<Option<usize>>,
    /// Whether each body turns.
    turns: Vec<bool>,
    /// Pairs of bodies whose distance stays, at every state.
    rods: Vec<(usize, usize)>,
}

impl<'a> Links<'a> {
    pub fn new(model: &Model, velocities: &'a Velocities, states: &[State]) -> Links<'a> {
        let turns: Vec<bool> = model.bodies.iter().map(|body| body.rotation.is_some()).collect();
        let axis = |d: usize| {
            let first = velocities.owners.iter().position(|owner| *owner == velocities.owners[d])?;
            Some(d - first).filter(|axis| *axis < model.bodies[velocities.owners[d]].position.len())
        };
        let axes: Vec<Option<usize>> = (0..velocities.owners.len()).map(axis).collect();
        let pairs = (0..turns.len()).flat_map(|b| (0..b).map(move |c| (b, c)));
        let mut rods: Vec<(usize, usize)> = pairs.filter(|(b, c)| !turns[*b] && !turns[*c]).collect();
        // Constraints may keep any distance.
        if model.constraints.is_empty() {
            let places: Vec<Id> = model.bodies.iter().flat_map(|body| body.position.iter().copied()).collect();
            let (tape, dimension) = (Tape::new(&model.graph, &places), places.len() / turns.len().max(1));
            for state in states {
                let at = tape.evaluate(|s| state.value(s));
                let mut slopes = vec![vec![DoubleDouble::ZERO; model.coordinates.len()]; places.len()];
                for ((d, i), slope) in velocities.places.iter().zip(velocities.tape.evaluate(|s| state.value(s))) {
                    if let Some(axis) = axes[*d] {
                        slopes[dimension * velocities.owners[*d] + axis][*i] = slope;
                    }
                }
                rods.retain(|(b, c)| {
                    (0..model.coordinates.len()).all(|i| {
                        let terms = (0..dimension).map(|axis| {
                            let [b, c] = [b, c].map(|body| dimension * body + axis);
                            (at[b] - at[c]) * (slopes[b][i] - slopes[c][i])
                        });
                        let (sum, size) = terms.fold((DoubleDouble::ZERO, 0.0), |(sum, size), term| {
                            (sum + term, size + term.abs().to_f64())
                        });
                        sum.abs().to_f64() <= SAME * size
                    })
                });
            }
        }
        Links { velocities, axes, turns, rods }
    }

    /// Whether a body that nothing moves in some directions, and another body, which has others, may do so: pins push bodies that turn anyhow,
    /// rods push two that stay at their distance, and two that both do not move in a direction touch.
    pub fn between(&self, directions: &[usize], others: &[usize]) -> bool {
        let owners = &self.velocities.owners;
        directions.iter().any(|d| {
            others.iter().any(|e| {
                let (b, c) = (owners[*d], owners[*e]);
                let rod = self.rods.contains(&(b.max(c), b.min(c)));
                let touch = self.axes[*d] == self.axes[*e] && !self.velocities.moves(*e);
                b != c && (self.turns[b] || self.turns[c] || rod || touch)
            })
        })
    }
}
