//! One step of a collocation method.

use super::dense::Interpolation;
use super::stages::{From, Newton, Stages};
use super::tableau::{Tableau, sum};
use crate::integrate::ends::{Ends, between_ends};
use crate::integrate::{Control, Counters, Endpoint, OneStep, Segment, StepFailure, Trial};
use crate::mechanism::{At, System};

/// Any method that is given by a [`Tableau`].
pub(crate) struct Collocation {
    pub(super) tableau: &'static Tableau,
    pub(super) ends: Ends,
    pub(super) newton: Newton,
    pub(super) stages: Stages,
    /// Accelerations of the stages of the last step, and its length; 0: there is none.
    previous: Vec<f64>,
    previous_step: f64,
    pub(super) errors: Vec<f64>,
    pub(super) room: Vec<f64>,
    pub(super) interpolation: Interpolation,
}

impl Collocation {
    /// Makes room for n coordinates.
    pub fn new(tableau: &'static Tableau, n: usize, work: bool) -> Self {
        let state = || vec![0.0; 2 * n];
        Collocation {
            tableau,
            ends: Ends::new(n, work),
            newton: Newton::new(tableau, n),
            stages: Stages::new(tableau.stages(), n),
            previous: vec![0.0; tableau.stages() * n],
            previous_step: 0.0,
            errors: state(),
            room: state(),
            interpolation: Interpolation::new(tableau, n),
        }
    }

    /// Accelerations of the stages as the last step's polynomial has them, through the rate where it ended.
    fn guess(&mut self, h: f64) {
        let (n, s) = (self.ends.n, self.tableau.stages());
        let (ratio, start) = (h / self.previous_step, &self.ends.rate[n..]);
        // A polynomial of the last step says nothing far beyond it.
        if self.previous_step == 0.0 || ratio > FAR {
            self.stages.accelerations.chunks_exact_mut(n.max(1)).for_each(|k| k.copy_from_slice(start));
            return;
        }
        let node = |j: usize| if j < s { self.tableau.nodes[j].value() } else { 1.0 };
        // Radau's last stage is where the step ended.
        let count = if node(s - 1) == 1.0 { s } else { s + 1 };
        for i in 0..s {
            let x = 1.0 + ratio * node(i);
            let line = &mut self.stages.accelerations[i * n..][..n];
            line.fill(0.0);
            for j in 0..count {
                let others = (0..count).filter(|l| *l != j);
                let weight: f64 = others.map(|l| (x - node(l)) / (node(j) - node(l))).product();
                let known = if j < s { &self.previous[j * n..][..n] } else { start };
                line.iter_mut().zip(known).for_each(|(k, known)| *k += weight * known);
            }
        }
    }

    /// y and W at the end of the step.
    fn finish(&mut self, system: &dyn System, t: f64, h: f64) {
        let n = self.ends.n;
        for j in 0..n {
            let k = |stage: usize| self.stages.accelerations[stage * n + j];
            let place = h * (self.ends.y[n + j] + h * sum(self.tableau.place_weights, k));
            self.ends.increment[j] = self.ends.carry[j] + place;
            self.ends.increment[n + j] = self.ends.carry[n + j] + h * sum(self.tableau.speed_weights, k);
        }
        self.ends.add_up();
        if self.ends.works() {
            self.weigh(system, t, h);
        }
    }

    /// W at the end of the step, by the method's own weights.
    fn weigh(&mut self, system: &dyn System, t: f64, h: f64) {
        let (n, y) = (self.ends.n, &self.ends.y);
        let mut sum = 0.0;
        for (i, (node, weight)) in self.tableau.nodes.iter().zip(self.tableau.speed_weights).enumerate() {
            for j in 0..n {
                self.room[j] = y[j] + self.stages.places[i * n + j];
                self.room[n + j] = y[n + j] + self.stages.speeds[i * n + j];
            }
            sum += weight.value() * system.energy(At::packed(t + node.value() * h, &self.room, n)).power;
        }
        self.ends.add_work(h * sum);
    }
}

/// A step so many times longer than the last one begins with accelerations that do not change.
const FAR: f64 = 4.0;

impl OneStep for Collocation {
    fn control(&self) -> Control {
        self.tableau.control
    }

    fn counters(&self) -> Counters {
        let newtons = || [Some(&self.newton), self.interpolation.newton()].into_iter().flatten();
        Counters {
            evaluations: self.ends.evaluations + newtons().map(|newton| newton.evaluations).sum::<u64>(),
            jacobians: newtons().map(|newton| newton.jacobians).sum(),
            factorizations: newtons().map(|newton| newton.factorizations).sum(),
        }
    }

    between_ends!();

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.newton.forget();
        self.interpolation.forget();
        self.previous_step = 0.0;
        self.ends.begin(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.ends.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Trial { t, h, tolerance } = trial;
        self.guess(h);
        let from = From { t, h, y: &self.ends.y, carry: &self.ends.carry };
        let solved = self.newton.solve(system, from, &mut self.stages, tolerance, &mut self.room);
        if let Err(failure) = solved {
            match failure {
                // What corrections still change may be rounding.
                StepFailure::Stalled { .. } => self.stages.corrected(h, &mut self.errors),
                _ => self.errors.fill(f64::NAN),
            }
            self.ends.end.copy_from_slice(&self.ends.y);
            self.previous_step = 0.0;
            return Err(failure);
        }
        self.finish(system, t, h);
        match (tolerance, self.tableau.estimate) {
            (Some(tolerance), Some(weights)) => self.error(system, (t, h), weights, tolerance),
            _ => Ok(0.0),
        }
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        self.ends.conclude(system, t, moved)
    }

    fn errors(&self) -> &[f64] {
        &self.errors
    }

    fn convergent(&self) -> f64 {
        self.newton.longest()
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
        std::mem::swap(&mut self.previous, &mut self.stages.accelerations);
        self.previous_step = self.newton.step();
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn damp(&self, defect: &mut [f64]) -> Option<f64> {
        let (gamma, ..) = self.tableau.real?;
        self.newton.real.solve_pair(&self.newton.slopes, gamma * self.newton.step(), defect);
        Some(gamma)
    }

    fn damps(&self) -> bool {
        self.tableau.real.is_some()
    }

    fn dense_is_free(&self) -> bool {
        self.interpolation.newton().is_none()
    }

    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        self.write_dense(system, t, h)
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: self.interpolation.pieces() }
    }
}
