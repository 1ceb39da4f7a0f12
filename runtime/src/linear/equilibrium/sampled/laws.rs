//! Laws that a sampled loop closes by, where they have a linear model: no time in them, no jump or kink at the rest, the same at every cycle.

use super::rest::{Assignment, Search};
use crate::linear::LinearError;
use crate::mechanism::{Along, Function, Target, Trigger};

/// Times at which a law is asked whether it contains time, s: its slope may vanish at some of them.
const TIMES: [f64; 3] = [0.0, 0.37, 1.9];
/// Departures at which laws are compared, in parts of what departs, or of 1 in its unit.
const NEAR: [f64; 2] = [1e-9, 1e-12];
/// What falls less than so many times from one departure to the other, which is a thousandth of it, jumps.
const FALLS: f64 = 2.0;
/// A law that jumps by less than this part of itself is rounded.
const ROUNDED: f64 = 1e-10;
/// Slopes on two sides that differ by this part of themselves, and of the law by so much a departure, are two.
const DIFFER: f64 = 1e-3;
const NOISE: f64 = 1e-5;

impl Search {
    /// # Errors
    /// [`LinearError::Counted`], [`LinearError::DependsOnTime`], [`LinearError::LawNotSmooth`].
    pub fn laws_are_linear(&mut self) -> Result<(), LinearError> {
        self.count_nothing()?;
        let laws = self.equations();
        for t in TIMES {
            let slopes = self.assignments_at(t, &Along { t: 1.0, ..Along::default() });
            if let Some(law) = laws.iter().find(|law| slopes[law.place] != 0.0) {
                return Err(LinearError::DependsOnTime { coordinate: self.name(law.target) });
            }
        }
        for variable in self.variables() {
            self.smooth_along(&laws, variable)?;
        }
        Ok(())
    }

    /// All that a law may read and that departs from the rest.
    fn variables(&self) -> Vec<Variable> {
        let places = (0..self.place.n).map(Variable::Place);
        let rates = (0..self.place.base.n).map(Variable::Rate);
        places.chain(rates).chain(self.read.iter().copied().map(Variable::Held)).collect()
    }

    fn variable(&mut self, variable: Variable) -> &mut f64 {
        match variable {
            Variable::Place(i) => &mut self.place.q[i],
            Variable::Rate(i) => &mut self.place.base.v[i],
            Variable::Held(j) => &mut self.memory[j],
        }
    }

    /// Refuses ticks that act only where a held value that ticks set, or time, says so.
    fn count_nothing(&self) -> Result<(), LinearError> {
        let set: Vec<usize> = self
            .all_assignments()
            .iter()
            .filter_map(|law| if let Target::Memory(j) = law.target { Some(j as usize) } else { None })
            .collect();
        let system = self.place.base.system.borrow();
        let (description, sampling) = (system.description(), system.sampling());
        let conditional = |event: &usize| {
            description.events[*event].conditional
                && matches!(sampling.trigger(*event), Trigger::Tick(_) | Trigger::Set(_))
        };
        let mut slopes = vec![0.0; 2 * description.events.len()];
        // What only counts changes nothing that the loop reads.
        let matters = |event: &usize| {
            let all = self.sets_of(*event);
            all.iter().flatten().any(|law| match law.target {
                Target::Memory(j) => self.read.contains(&(j as usize)),
                Target::State(_) => true,
            })
        };
        for event in (0..description.events.len()).filter(conditional).filter(matters) {
            let name = || description.events[event].name.to_string();
            for j in set.iter().copied() {
                let along = Along { memory: Some(j), ..Along::default() };
                system.slopes(Function::Events, self.at(), &along, &mut slopes);
                if slopes[2 * event + 1] != 0.0 {
                    return Err(LinearError::Counted { event: name(), held: sampling.memory[j].name.to_string() });
                }
            }
            system.slopes(Function::Events, self.at(), &Along { t: 1.0, ..Along::default() }, &mut slopes);
            if slopes[2 * event + 1] != 0.0 {
                return Err(LinearError::DependsOnTime { coordinate: name() });
            }
        }
        Ok(())
    }

    /// Refuses laws that jump or turn sharply where one variable departs from the rest.
    fn smooth_along(&mut self, laws: &[Assignment], variable: Variable) -> Result<(), LinearError> {
        let here = *self.variable(variable);
        let mut at = |x: f64| {
            *self.variable(variable) = x;
            self.put_memory();
            self.assignments()
        };
        let sides = NEAR.map(|part| {
            let away = part * (1.0 + here.abs());
            (away, at(here + away), at(here - away))
        });
        let rest = at(here);
        let rough = |law: &&Assignment| {
            let [(away, above, below), (_, nearer_above, nearer_below)] = &sides;
            let of = |values: &[f64]| values[law.place];
            let value = of(&rest);
            let [jump, nearer] = [of(above) - of(below), of(nearer_above) - of(nearer_below)].map(f64::abs);
            let [up, down] = [(of(above) - value) / away, (value - of(below)) / away];
            nearer > ROUNDED * value.abs() && nearer * FALLS > jump
                || (up - down).abs() > DIFFER * up.abs().max(down.abs()) + NOISE * value.abs()
        };
        match laws.iter().find(rough) {
            Some(law) => Err(LinearError::LawNotSmooth { held: self.name(law.target) }),
            None => Ok(()),
        }
    }
}

/// Something that departs from a rest, by its place.
#[derive(Clone, Copy)]
enum Variable {
    Place(usize),
    /// The rate of a coordinate, or a state.
    Rate(usize),
    Held(usize),
}
