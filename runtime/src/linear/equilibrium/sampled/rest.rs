//! Rests of sampled loops: places, states and held values at which every tick sets what it finds.

use nalgebra::DMatrix;

use crate::linear::equilibrium::Guess;
use crate::linear::equilibrium::candidate::Candidate;
use crate::linear::equilibrium::least_steps::Rest;
use crate::linear::{LinearError, Residual};
use crate::mechanism::{Action, Along, At, Function, System, Target, Trigger};

/// A slope that vanishes at the guess by accident does not vanish so far beside it too.
pub(super) const BESIDE: f64 = 0.37;

/// A value that a tick sets: of which event, what, and its place among all assignments.
pub(super) struct Assignment {
    pub target: Target,
    pub place: usize,
}

pub(super) struct Search {
    pub place: Candidate,
    pub memory: Vec<f64>,
    /// Held values that the loop reads, by their places.
    pub read: Vec<usize>,
}

impl Search {
    /// # Errors
    /// Those of [`Candidate::new`].
    pub fn new<S: System + ?Sized>(system: &S, guess: &Guess, memory: &[f64]) -> Result<Search, LinearError> {
        let mut system = system.boxed_clone();
        system.set_memory(memory);
        Ok(Search { place: Candidate::new(&*system, guess)?, memory: memory.to_vec(), read: Vec::new() })
    }

    pub fn at(&self) -> At<'_> {
        self.at_time(0.0)
    }

    fn at_time(&self, t: f64) -> At<'_> {
        self.place.base.at(t, &self.place.q, &self.place.base.v)
    }

    /// ∂F/∂m, a column for each held value.
    pub fn forces_by_memory(&self) -> DMatrix<f64> {
        let mut slopes = DMatrix::zeros(self.place.base.n, self.memory.len());
        let system = self.place.base.system.borrow();
        for (j, mut column) in slopes.column_iter_mut().enumerate() {
            let along = Along { memory: Some(j), ..Along::default() };
            system.slopes(Function::Residual, self.at(), &along, column.as_mut_slice());
        }
        slopes
    }

    /// The slopes of all assignments along a direction.
    pub fn assignments_along(&self, along: &Along<'_>) -> Vec<f64> {
        self.assignments_at(0.0, along)
    }

    /// The same at a time, s.
    pub fn assignments_at(&self, t: f64, along: &Along<'_>) -> Vec<f64> {
        let system = self.place.base.system.borrow();
        let mut slopes = vec![0.0; system.sampling().assignments()];
        system.slopes(Function::Assignments, self.at_time(t), along, &mut slopes);
        slopes
    }

    pub fn assignments(&self) -> Vec<f64> {
        let system = self.place.base.system.borrow();
        let mut values = vec![0.0; system.sampling().assignments()];
        system.assignments(self.at(), &mut values);
        values
    }

    /// Events that act at a tick of these clocks, in the order in which they do: those of the file, then those that follow what was set.
    pub fn acting(&self, ticking: &[bool]) -> Vec<usize> {
        let system = self.place.base.system.borrow();
        let (description, sampling) = (system.description(), system.sampling());
        let phase = system.phase() as u32;
        let mut pairs = vec![0.0; 2 * description.events.len()];
        system.events(self.at(), &mut pairs);
        let acts = |event: &usize| {
            let described = &description.events[*event];
            let counts = described.phases.as_ref().is_none_or(|phases| phases.contains(&phase));
            counts && (!described.conditional || pairs[2 * event + 1] > 0.0)
        };
        let ticks =
            |event: &usize| matches!(sampling.trigger(*event), Trigger::Tick(clock) if ticking[*clock as usize]);
        // Noise stays at its mean.
        let is_noise = |event: &usize| system.held_noise().iter().any(|noise| noise.event as usize == *event);
        let events = (0..description.events.len()).filter(|event| !is_noise(event));
        let first: Vec<usize> = events.filter(ticks).filter(acts).collect();
        let set: Vec<u32> = first
            .iter()
            .flat_map(|event| self.of_event(*event))
            .filter_map(|assignment| if let Target::Memory(place) = assignment.target { Some(place) } else { None })
            .collect();
        let follows = |event: &usize| matches!(sampling.trigger(*event), Trigger::Set(held) if held.iter().any(|j| set.contains(j)));
        let then: Vec<usize> = (0..description.events.len()).filter(follows).filter(acts).collect();
        first.into_iter().chain(then).collect()
    }

    /// What an event sets, set by set.
    pub fn sets_of(&self, event: usize) -> Vec<Vec<Assignment>> {
        let system = self.place.base.system.borrow();
        let sampling = system.sampling();
        let sets = system.description().events[event].actions.iter().filter_map(|action| match action {
            Action::Set(set) => Some(*set as usize),
            _ => None,
        });
        let of_set = |set: usize| {
            let targets = sampling.sets[set].iter().zip(sampling.first_of_set(set)..);
            targets.map(|(target, place)| Assignment { target: *target, place }).collect()
        };
        sets.map(of_set).collect()
    }

    fn of_event(&self, event: usize) -> Vec<Assignment> {
        self.sets_of(event).into_iter().flatten().collect()
    }

    /// Everything that any tick sets.
    pub fn all_assignments(&self) -> Vec<Assignment> {
        let clocks = self.place.base.system.borrow().sampling().clocks.len();
        self.acting(&vec![true; clocks]).into_iter().flat_map(|event| self.of_event(event)).collect()
    }

    /// Finds the held values that forces read, or what is set to these: at the guess, and beside it, since a slope may vanish by accident.
    pub fn find_read(&mut self) {
        let (q, memory) = (self.place.q.clone(), self.memory.clone());
        let mut read = vec![false; memory.len()];
        for beside in [0.0, BESIDE] {
            self.place
                .q
                .iter_mut()
                .zip(&q)
                .take(self.place.n)
                .enumerate()
                .for_each(|(i, (x, q))| *x = q + beside / (1.0 + i as f64));
            self.memory.iter_mut().zip(&memory).for_each(|(x, m)| *x = m + beside * (1.0 + m.abs()));
            self.put_memory();
            let forces = self.forces_by_memory();
            (0..read.len()).for_each(|j| read[j] |= forces.column(j).iter().any(|slope| *slope != 0.0));
            let assignments = self.all_assignments();
            let slopes: Vec<Vec<f64>> = (0..read.len())
                .map(|j| self.assignments_along(&Along { memory: Some(j), ..Along::default() }))
                .collect();
            // Each round finds what is read by what was found before.
            for _ in 0..read.len() {
                for Assignment { target, place } in &assignments {
                    let counts = match target {
                        Target::Memory(j) => read[*j as usize],
                        Target::State(_) => true,
                    };
                    (0..read.len()).filter(|_| counts).for_each(|j| read[j] |= slopes[j][*place] != 0.0);
                }
            }
        }
        (self.place.q, self.memory) = (q, memory);
        self.put_memory();
        let of_noise: Vec<u32> = {
            let system = self.place.base.system.borrow();
            system.held_noise().iter().flat_map(|noise| noise.held.iter().copied()).collect()
        };
        self.read = (0..read.len()).filter(|j| read[*j] && !of_noise.contains(&(*j as u32))).collect();
    }

    pub fn put_memory(&self) {
        self.place.base.system.borrow_mut().set_memory(&self.memory);
    }

    /// Assignments to what the loop reads, and to states.
    pub fn equations(&self) -> Vec<Assignment> {
        let counts = |assignment: &Assignment| match assignment.target {
            Target::Memory(j) => self.read.contains(&(j as usize)),
            Target::State(_) => true,
        };
        self.all_assignments().into_iter().filter(counts).collect()
    }

    /// The present value of what is set.
    fn held(&self, target: Target) -> f64 {
        match target {
            Target::Memory(j) => self.memory[j as usize],
            Target::State(i) => self.place.base.v[i as usize],
        }
    }

    pub fn named_place(&self) -> Vec<(String, f64)> {
        let system = self.place.base.system.borrow();
        let names = system.description().coordinates.iter().map(|c| c.state().unwrap_or(&c.name).to_owned());
        names.zip(self.place.unknowns()).collect()
    }

    pub fn held_values(&self) -> Vec<(String, f64)> {
        let system = self.place.base.system.borrow();
        let memory = &system.sampling().memory;
        self.read.iter().map(|j| (memory[*j].name.to_string(), self.memory[*j])).collect()
    }

    /// The name of what is set.
    pub fn name(&self, target: Target) -> String {
        let system = self.place.base.system.borrow();
        match target {
            Target::Memory(j) => system.sampling().memory[j as usize].name.to_string(),
            Target::State(i) => system.description().coordinate_name(i as usize),
        }
    }

    /// The state, and what is left there, by name.
    pub fn nowhere(&self, iterations: usize) -> LinearError {
        let left = self.left();
        let (force, set) = (&left[..self.place.base.n], &left[self.place.len()..]);
        let mut residual = self.place.base.forces(force);
        let named = self.equations().into_iter().zip(set).map(|(Assignment { target, .. }, left)| Residual {
            coordinate: self.name(target),
            force: *left,
            unit: String::new(),
        });
        residual.extend(named);
        let point = self.named_place().into_iter().chain(self.held_values()).collect();
        LinearError::NoEquilibrium { iterations, point, residual }
    }
}

impl Rest for Search {
    /// What is sought: coordinates, states, multipliers and held values.
    fn unknowns(&self) -> Vec<f64> {
        self.place.unknowns().into_iter().chain(self.read.iter().map(|j| self.memory[*j])).collect()
    }

    fn units(&self) -> Vec<String> {
        self.place.units()
    }

    fn set(&mut self, unknowns: &[f64]) {
        let (place, held) = unknowns.split_at(self.place.len());
        self.place.set(place);
        self.read.iter().zip(held).for_each(|(j, value)| self.memory[*j] = *value);
        self.put_memory();
    }

    /// F and c, then what is held less what it is set to.
    fn left(&self) -> Vec<f64> {
        let left = self.place.left();
        let values = self.assignments();
        let differences =
            self.equations().into_iter().map(|Assignment { target, place }| self.held(target) - values[place]);
        left.into_iter().chain(differences).collect()
    }

    fn measures(&self) -> Vec<f64> {
        let (slopes, unknowns) = (self.slopes(), self.unknowns());
        let place = self.place.measures();
        let by_memory: Vec<f64> = (0..slopes.nrows())
            .map(|row| (0..slopes.ncols()).map(|column| (slopes[(row, column)] * unknowns[column]).abs()).sum())
            .collect();
        let equations = self.equations();
        let values = self.assignments();
        let own = equations.iter().map(|assignment| values[assignment.place].abs());
        place.into_iter().chain(own).zip(by_memory).map(|(own, sum)| own + sum).collect()
    }

    fn slopes(&self) -> DMatrix<f64> {
        let (n, all, sought, equations) = (self.place.n, self.place.base.n, self.place.len(), self.equations());
        let by_memory = self.forces_by_memory();
        let mut slopes = DMatrix::zeros(sought + equations.len(), sought + self.read.len());
        slopes.view_mut((0, 0), (sought, sought)).copy_from(&self.place.slopes());
        for (k, j) in self.read.iter().enumerate() {
            slopes.view_mut((0, sought + k), (all, 1)).copy_from(&by_memory.column(*j));
        }
        let rows = self.place.rows();
        let (mut unit, mut of_row) = (vec![0.0; all], vec![0.0; self.place.base.lambda.len()]);
        for column in 0..slopes.ncols() {
            if column < all {
                unit[column] = 1.0;
            } else if column < sought {
                of_row[rows[column - all]] = 1.0;
            }
            let along = match column {
                column if column < n => Along { q: &unit, ..Along::default() },
                column if column < all => Along { v: &unit, ..Along::default() },
                column if column < sought => Along { lambda: &of_row, ..Along::default() },
                _ => Along { memory: Some(self.read[column - sought]), ..Along::default() },
            };
            let found = self.assignments_along(&along);
            for (row, Assignment { target, place }) in equations.iter().enumerate() {
                let own = match target {
                    Target::Memory(j) => column >= sought && self.read[column - sought] == *j as usize,
                    Target::State(i) => column < all && column == *i as usize,
                };
                slopes[(sought + row, column)] = f64::from(u8::from(own)) - found[*place];
            }
            unit.fill(0.0);
            of_row.fill(0.0);
        }
        slopes
    }
}
