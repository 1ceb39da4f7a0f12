//! Loads at points that several bodies carry: what the balances would be if another body took them.

use crate::diagnose::Place;
use crate::expr::vectors;
use crate::model::resolved::{Change, Load, Push, Work};
use crate::model::resolver::Resolver;

impl Resolver<'_> {
    /// Fills in what each other choice of a body would change.
    ///
    /// A change is itself a load: the force on the other body, and its opposite on the body that takes it now.  With
    /// all of these beside the model's own loads the systems are formed once more, and what they contribute is kept.
    pub fn shared_ends(&mut self) {
        if self.model.balances.is_empty() || self.model.shared_ends.is_empty() {
            return;
        }
        let own = self.model.loads.len();
        let mut moved = Vec::new();
        for (k, end) in self.model.shared_ends.iter().enumerate() {
            let push = self.model.loads[end.load].pushes[end.push].clone();
            for &body in end.bodies.iter().skip(1) {
                let minus = vectors::negative(&mut self.builder.graph, &push.force);
                let pushes = vec![Push { body: Some(body), ..push.clone() }, Push { force: minus, ..push.clone() }];
                // No label of a file starts so.
                let name = format!("\0{}", moved.len());
                self.model.loads.push(Load { name: name.clone(), work: Work::Pushes, pushes, place: Place::default() });
                moved.push((name, k, body));
            }
        }
        let systems = self.systems();
        self.model.loads.truncate(own);
        for (s, system) in systems.iter().enumerate() {
            let mut first = 0;
            for balance in &system.balances {
                for part in &balance.parts {
                    let Some((_, k, body)) = moved.iter().find(|m| m.0 == part.name) else { continue };
                    for (row, value) in part.value.iter().enumerate() {
                        let change = Change { body: *body, system: s, equation: first + row, value: *value };
                        self.model.shared_ends[*k].changes.push(change);
                    }
                }
                first += balance.components;
            }
        }
    }
}
