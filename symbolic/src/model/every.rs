//! Every expression of a model.

use rustc_hash::FxHashMap as HashMap;

use super::event::EventAction;
use super::resolved::{Model, Shape, Work};
use crate::expr::{Id, Symbol, substitute};

impl Model {
    /// Puts values in the place of symbols wherever states of first order may stand: in all but positions, inertias, constraints and what
    /// is of parameters only.
    pub(crate) fn substitute(&mut self, values: &HashMap<Symbol, Id>) {
        let mut graph = std::mem::take(&mut self.graph);
        let places = self.expressions();
        let old: Vec<Id> = places.iter().map(|id| **id).collect();
        let new = substitute(&mut graph, &old, values);
        places.into_iter().zip(new).for_each(|(place, id)| *place = id);
        self.graph = graph;
    }

    fn expressions(&mut self) -> Vec<&mut Id> {
        let mut found: Vec<&mut Id> =
            vec![&mut self.raw_kinetic_energy, &mut self.raw_potential_energy, &mut self.dissipation];
        found.extend(self.states.iter_mut().map(|state| &mut state.rate));
        for load in &mut self.loads {
            match &mut load.work {
                Work::Potential(v) => found.push(v),
                Work::Resistance { rate, tension } => found.extend([rate, tension]),
                Work::Pushes => {}
            }
            found.extend(load.pushes.iter_mut().flat_map(|push| push.force.iter_mut().chain(&mut push.couple)));
        }
        found.extend(self.generalized_forces.iter_mut().map(|given| &mut given.force));
        found.extend(self.kinetic_terms.iter_mut().chain(&mut self.potential_terms));
        for system in &mut self.balances {
            let parts =
                system.balances.iter_mut().flat_map(|balance| balance.parts.iter_mut().chain(&mut balance.terms));
            found.extend(parts.flat_map(|part| &mut part.value));
            found.extend(&mut system.bodies);
        }
        found.extend(self.shared_ends.iter_mut().flat_map(|end| &mut end.changes).map(|change| &mut change.value));
        for conserved in &mut self.conserved {
            found.extend(conserved.value.iter_mut().chain(conserved.terms.iter_mut().flatten()));
        }
        found.extend(self.checks.iter_mut().flat_map(|check| check.left.iter_mut().chain(&mut check.right)));
        found.extend(self.outputs.iter_mut().flat_map(|output| &mut output.value));
        for event in &mut self.events {
            found.push(&mut event.when);
            found.extend(&mut event.condition);
            found.extend(event.actions.iter_mut().filter_map(|action| match action {
                EventAction::Impact { restitution, .. } => Some(restitution),
                _ => None,
            }));
        }
        found.extend(self.contacts.iter_mut().filter_map(|contact| contact.restitution.as_mut()));
        found.extend(self.sets.iter_mut().flat_map(|set| &mut set.values).map(|(_, value)| value));
        found.extend(self.draw.iter_mut().flat_map(of_shape));
        let motions = self.motions.iter_mut().map(|motion| &mut motion.scene);
        let scenes = self.scenes.iter_mut().chain(motions);
        found.extend(scenes.flat_map(|scene| &mut scene.start_conditions).map(|(quantity, _)| quantity));
        found.extend(self.equilibrium.iter_mut().flatten());
        found
    }
}

fn of_shape(shape: &mut Shape) -> Vec<&mut Id> {
    match shape {
        Shape::Line(points) | Shape::Curve(points) => points.iter_mut().flatten().collect(),
        Shape::Circle { at, radius } => at.iter_mut().chain([radius]).collect(),
        Shape::Spring(from, to) => from.iter_mut().chain(to).collect(),
        Shape::Trace(_, point) => point.iter_mut().collect(),
        Shape::Solid(_, numbers) => numbers.iter_mut().collect(),
    }
}
