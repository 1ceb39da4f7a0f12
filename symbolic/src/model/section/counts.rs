//! Whether a system of balances has as many equations as unknowns, and what its constraints do.

use rustc_hash::FxHashMap as HashMap;

use crate::diagnose::catalogue::mechanics;
use crate::diagnose::counted;
use crate::expr::{Id, Symbol, substitute};
use crate::model::expression::facts::Depends;
use crate::model::resolve::leaves_equations;
use crate::model::resolved::{BalanceSystem, Constraint};
use crate::model::resolver::Resolver;
use crate::model::section::contacts::ContactText;

impl Resolver<'_> {
    /// Whether equations and active constraints are as many as accelerations, reactions and the multipliers that stand
    /// in the equations, in each phase; reports the first phase in which they are not.
    pub fn determines(&mut self, system: &BalanceSystem) -> bool {
        // What is not as it is meant is not counted.
        if !self.builder.problems.iter().all(leaves_equations) {
            return false;
        }
        let equations: usize = system.balances.iter().map(|b| b.components).sum();
        let reactions: usize = system.reactions.iter().map(|&k| self.scope.reactions[k].components).sum();
        let (accelerations, states) = (self.model.mechanical(), self.model.states.len());
        let contacts = self.rows_of_contacts();
        for &phase in &system.phases {
            // Each row of a contact gives one equation for its multiplier in every phase: it holds, or the multiplier is 0.
            let mut rows = self.active_rows(phase);
            rows.retain(|row| !contacts.contains(row));
            let multipliers = self.multipliers(system, phase, &rows);
            let (given, needed) = (equations + rows.len(), accelerations + states + reactions + multipliers.len());
            // Rows may depend on each other, and the force on a coordinate without mass is a constraint: this is told when states are known.
            let (surplus, missing) = (given.saturating_sub(needed), needed.saturating_sub(given));
            if surplus <= rows.len() && missing <= self.of_massless_bodies() {
                continue;
            }
            let name = &self.model.phases[phase].name;
            let place = if name.is_empty() { String::new() } else { format!(" in the phase `{name}`") };
            let mut given = counted(equations, "equation");
            if !rows.is_empty() {
                given = format!("{given} and {} of constraints{place}", counted(rows.len(), "row"));
            } else if !name.is_empty() {
                given += &place;
            }
            let mut wanted = counted(accelerations, "acceleration");
            if states > 0 {
                wanted += &format!(", {}", counted(states, "rate of a state"));
            }
            wanted += &format!(" and {}", counted(reactions, "reaction component"));
            if let Some(first) = multipliers.first() {
                let named = crate::model::text::multiplier(&self.model, *first);
                let others = if multipliers.len() > 1 { ", …" } else { "" };
                wanted += &format!(" and {} (`{named}`{others})", counted(multipliers.len(), "multiplier"));
            }
            let more = match multipliers.is_empty() {
                true => "",
                false => "; an `equation` says which named reaction a `reaction(c)` is",
            };
            let problem = mechanics::unequal_counts(system.place.clone(), &system.name, given, wanted, more);
            self.builder.problems.push(problem);
            return false;
        }
        true
    }

    /// How many equations a system needs in its first phase beside those for the rates of states.
    pub fn unknowns_beside_states(&mut self, system: &BalanceSystem) -> usize {
        let phase = system.phases.first().copied().unwrap_or_default();
        let reactions: usize = system.reactions.iter().map(|&k| self.scope.reactions[k].components).sum();
        let rows = self.active_rows(phase);
        let unknowns = self.model.mechanical() + reactions + self.multipliers(system, phase, &rows).len();
        unknowns.saturating_sub(rows.len())
    }

    /// How many coordinates move points without mass, which nothing else may resist.
    fn of_massless_bodies(&mut self) -> usize {
        let massless = self.model.bodies.iter().filter(|body| body.mass == Id::ZERO);
        let positions: Vec<Id> = massless.flat_map(|body| body.position.clone()).collect();
        let symbols = self.builder.graph.symbols(positions);
        symbols.into_iter().filter(|s| matches!(s, Symbol::Coordinate(_))).count()
    }

    /// The rows of all contacts.
    fn rows_of_contacts(&self) -> Vec<usize> {
        self.model.rows_of_contacts(self.contacts.iter().flat_map(ContactText::constraints))
    }

    /// The rows of the constraints that act in a phase.
    fn active_rows(&self, phase: usize) -> Vec<usize> {
        let active = self.model.phases[phase].constraints.iter().map(|c| &self.model.constraints[*c]);
        active.flat_map(Constraint::rows).collect()
    }

    /// Which of these rows have multipliers that stand in the equations of a system in a phase.
    fn multipliers(&mut self, system: &BalanceSystem, phase: usize, rows: &[usize]) -> Vec<usize> {
        let parts = system.balances.iter().flat_map(|balance| &balance.parts);
        let values: Vec<Id> = parts.flat_map(|part| part.value.iter().copied()).collect();
        if !self.builder.depends(&values).meets(Depends::MULTIPLIER) {
            return Vec::new();
        }
        let active = |k: usize| (Symbol::Phase(k as u32), if k == phase { Id::ONE } else { Id::ZERO });
        let active: HashMap<Symbol, Id> = (0..self.model.phases.len()).map(active).collect();
        let values = substitute(&mut self.builder.graph, &values, &active);
        let mut found: Vec<usize> = self.builder.graph.symbols(values).into_iter().filter_map(row).collect();
        found.retain(|row| rows.contains(row));
        found.sort_unstable();
        found
    }

    /// A constraint that does work in one of these phases, because time or an input moves it.
    pub fn driven(&mut self, phases: &[usize]) -> Option<String> {
        let still: HashMap<Symbol, Id> =
            (0..self.model.coordinates.len()).map(|i| (Symbol::Speed(i as u32), Id::ZERO)).collect();
        let active = phases.iter().flat_map(|phase| self.model.phases[*phase].constraints.clone());
        for place in active.collect::<Vec<_>>() {
            let constraint = self.model.constraints[place].clone();
            let driven = match constraint.holonomic {
                true => self.builder.depends(&constraint.value).meets(Depends::TIME.and(Depends::INPUT)),
                false => {
                    substitute(&mut self.builder.graph, &constraint.value, &still).iter().any(|rest| *rest != Id::ZERO)
                }
            };
            if driven {
                return Some(constraint.name);
            }
        }
        None
    }
}

fn row(symbol: Symbol) -> Option<usize> {
    match symbol {
        Symbol::Multiplier(row) => Some(row as usize),
        _ => None,
    }
}
