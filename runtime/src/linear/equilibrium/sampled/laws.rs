//! Laws that a sampled loop closes by, where they have a linear model: no time in them, no jump or kink at the rest, the same at every cycle.

use super::rest::{Assignment, BESIDE, Search};
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
    /// [`LinearError::Counted`], [`LinearError::DependsOnTime`], [`LinearError::VariesWithTime`], [`LinearError::LawNotSmooth`].
    pub fn laws_are_linear(&mut self) -> Result<(), LinearError> {
        self.count_nothing()?;
        let laws = self.equations();
        if let Some(target) = self.timed(&laws) {
            return Err(LinearError::DependsOnTime { coordinate: self.name(target) });
        }
        if let Some(target) = self.timed_beside(&laws) {
            return Err(LinearError::VariesWithTime { coordinate: self.name(target) });
        }
        for variable in self.variables() {
            self.smooth_along(&laws, variable)?;
        }
        Ok(())
    }

    /// What is set to something that contains time, by its slope.
    fn timed(&self, laws: &[Assignment]) -> Option<Target> {
        TIMES.into_iter().find_map(|t| {
            let slopes = self.assignments_at(t, &Along { t: 1.0, ..Along::default() });
            laws.iter().find(|law| slopes[law.place] != 0.0).map(|law| law.target)
        })
    }

    /// The same beside the rest, where what multiplies time does not vanish.
    fn timed_beside(&mut self, laws: &[Assignment]) -> Option<Target> {
        self.beside(|k| BESIDE / (1.0 + k as f64), |search| search.timed(laws))
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

    /// Does something a little beside the rest where slopes of laws at it are not those around it, as of `abs(x)*sign(x)`, which is x but has no
    /// slope by its factors at 0; else at the rest.
    pub fn where_slopes_are<T>(&mut self, find: impl FnOnce(&Search) -> T) -> T {
        if !self.hides_slopes() {
            return find(self);
        }
        self.beside(|k| NEAR[1] / (1.0 + k as f64).sqrt(), find)
    }

    /// Does something where all that a law may read is so far beside the rest, in parts of 1 and its size there.
    fn beside<T>(&mut self, by: impl Fn(usize) -> f64, find: impl FnOnce(&Search) -> T) -> T {
        let variables = self.variables();
        let rest: Vec<f64> = variables.iter().map(|variable| *self.variable(*variable)).collect();
        for (k, (variable, x)) in variables.iter().zip(&rest).enumerate() {
            *self.variable(*variable) = x + by(k) * (1.0 + x.abs());
        }
        self.put_memory();
        let found = find(self);
        for (variable, x) in variables.iter().zip(rest) {
            *self.variable(*variable) = x;
        }
        self.put_memory();
        found
    }

    /// Whether a slope at the rest is none, or not that of a chord through it.
    fn hides_slopes(&mut self) -> bool {
        let (laws, n) = (self.equations(), self.place.base.n);
        let rest = self.assignments();
        self.variables().into_iter().any(|variable| {
            let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
            let slopes = match variable {
                Variable::Place(i) => self.assignments_along(&Along { q: &unit(i), ..Along::default() }),
                Variable::Rate(i) => self.assignments_along(&Along { v: &unit(i), ..Along::default() }),
                Variable::Held(j) => self.assignments_along(&Along { memory: Some(j), ..Along::default() }),
            };
            let here = *self.variable(variable);
            let away = NEAR[0] * (1.0 + here.abs());
            let [above, below] = [away, -away].map(|by| self.assignments_at_value(variable, here + by));
            self.assignments_at_value(variable, here);
            laws.iter().any(|law| {
                let chord = (above[law.place] - below[law.place]) / (2.0 * away);
                let slope = slopes[law.place];
                let same = DIFFER * slope.abs().max(chord.abs()) + NOISE * rest[law.place].abs();
                slope.is_nan() || (slope - chord).abs() > same
            })
        })
    }

    /// What is set where a variable has this value from now on.
    fn assignments_at_value(&mut self, variable: Variable, value: f64) -> Vec<f64> {
        *self.variable(variable) = value;
        self.put_memory();
        self.assignments()
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
        let mut at = |x: f64| self.assignments_at_value(variable, x);
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
