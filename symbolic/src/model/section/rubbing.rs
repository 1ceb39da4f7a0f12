//! Contacts of space that rub: two sliding rates, a direction that is held, and friction against it (LANGUAGE, section 6).
//!
//! With the rates s along two directions t across the normal, friction is -mu N u, u = s/|s|.  Where sliding begins or ends s is zero and has no direction;
//! where a straight motion stops it turns round.  So a unit vector d is held beside it, and u is the direction of the line of s on the side of d,
//! u = (d + r d')/sqrt(1 + r^2) with d' across d and r = (s.d')(s.d)/((s.d)^2 + e^2): smooth through s = 0 along d, and d itself where |s| is far below e,
//! which is what rounding makes of s.  s.d falls to zero where the motion stops, and where it has turned through a right angle.

use super::contacts::ContactText;
use crate::diagnose::Place;
use crate::expr::{Id, Symbol, Unary, vectors};
use crate::model::contact::ContactMode;
use crate::model::event::HeldValue;
use crate::model::expression::dimension::Measure;
use crate::model::expression::joints;
use crate::model::resolved::Work;
use crate::model::resolver::Resolver;

/// Keeps r, and its derivatives, from being 0/0; it vanishes in rounding beside the square of any rate.
const NO_RATE: f64 = 1e-90;

/// A force of friction, and its work.
pub(super) struct Rub {
    /// As a vector.
    pub force: Vec<Id>,
    pub work: Work,
}

impl Resolver<'_> {
    /// Held values for the direction in which a contact slides, and for the rate below which s has none of its own; the place of the first.
    pub(super) fn hold_direction(&mut self, name: &str, place: &Place) -> usize {
        let first = self.model.memory.len();
        for (what, start) in [("sliding.1", Id::ONE), ("sliding.2", Id::ZERO), ("sliding.least", Id::ZERO)] {
            let place = place.of_key();
            self.model.memory.push(HeldValue { name: format!("{name}.{what}"), unit: None, start, place });
            self.scope.units.memory.push(Measure::Unknown);
        }
        first
    }

    /// s.d in space, s in the plane.
    pub(super) fn rate_of_sliding(&mut self, contact: &ContactText, tangent: usize) -> Option<Id> {
        let Some(direction) = contact.direction else { return self.value_of(tangent) };
        let rates = self.model.constraints.get(tangent)?.value.clone();
        let [first, second, _] = self.held_direction(direction);
        Some(vectors::dot(&mut self.builder.graph, &rates, &[first, second]))
    }

    /// What a contact that sticks holds with, and what it rubs with while it slides and `tension` is the size of that: along both directions.
    pub(super) fn rub_in_space(
        &mut self,
        (k, contact): (usize, &ContactText),
        tangent: usize,
        normal: &[Id],
        tension: Id,
    ) -> Option<[Rub; 2]> {
        let constraint = self.model.constraints.get(tangent)?.clone();
        let [first, second] = constraint.value.as_slice() else { return None };
        let slides = self.phases_with(k, |mode| mode == ContactMode::Slides);
        let slides = self.indicator(&slides);
        let along = self.direction_of_sliding([*first, *second], contact.direction?);
        let across = joints::across(&mut self.builder, normal);
        let graph = &mut self.builder.graph;
        let tension = graph.mul(slides, tension);
        let rub = |place: usize| {
            let held = graph.symbol(Symbol::Multiplier((constraint.first + place) as u32));
            let tension = graph.mul(tension, along[place]);
            let whole = graph.sub(held, tension);
            let force = vectors::scaled(graph, whole, &across[place]);
            Rub { force, work: Work::Resistance { rate: constraint.value[place], tension } }
        };
        Some([0, 1].map(rub))
    }

    fn held_direction(&mut self, first: usize) -> [Id; 3] {
        [0, 1, 2].map(|k| self.builder.graph.symbol(Symbol::Memory((first + k) as u32)))
    }

    /// u, of any held d but 0.
    fn direction_of_sliding(&mut self, rates: [Id; 2], direction: usize) -> [Id; 2] {
        let [d1, d2, least] = self.held_direction(direction);
        let graph = &mut self.builder.graph;
        let d = [d1, d2];
        let beside = [graph.neg(d2), d1];
        let (forwards, sideways) = (vectors::dot(graph, &rates, &d), vectors::dot(graph, &rates, &beside));
        let (square, length) = (graph.mul(forwards, forwards), vectors::dot(graph, &d, &d));
        let least = graph.mul(least, least);
        let (least, none) = (graph.mul(least, length), graph.float(NO_RATE));
        let square = graph.add(square, least);
        let square = graph.add(square, none);
        let product = graph.mul(sideways, forwards);
        let ratio = graph.div(product, square);
        let turned = vectors::add_scaled(graph, &d, ratio, &beside);
        let ratio = graph.mul(ratio, ratio);
        let longer = graph.add(Id::ONE, ratio);
        let size = graph.mul(length, longer);
        let size = graph.unary(Unary::Sqrt, size);
        [graph.div(turned[0], size), graph.div(turned[1], size)]
    }
}
