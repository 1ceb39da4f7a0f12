//! One step of a collocation method.

use super::dense::Interpolation;
use super::stages::{From, Newton, Stages};
use super::tableau::{Tableau, sum};
use crate::integrate::{Control, Counters, OneStep, Reached, Segment, Setback, Trial};
use crate::mechanism::{At, System};

/// Any method that is given by a [`Tableau`].
pub(crate) struct Collocation {
    pub(super) tableau: &'static Tableau,
    pub(super) n: usize,
    pub(super) y: Vec<f64>,
    /// What rounding took from y in the last step.
    pub(super) carry: Vec<f64>,
    pub(super) rate: Vec<f64>,
    pub(super) end: Vec<f64>,
    pub(super) end_rate: Vec<f64>,
    /// What the step that was tried adds to y, what was left over from the step before included.
    increment: Vec<f64>,
    pub(super) newton: Newton,
    pub(super) stages: Stages,
    /// Accelerations of the stages of the last step, and its length; 0: there is none.
    previous: Vec<f64>,
    previous_step: f64,
    pub(super) errors: Vec<f64>,
    pub(super) room: Vec<f64>,
    pub(super) interpolation: Interpolation,
    work: Option<Quadrature>,
    pub(super) evaluations: u64,
}

/// W = ∫P dt by the method's own weights.
#[derive(Clone, Copy, Default)]
struct Quadrature {
    done: f64,
    /// What the step that was tried adds.
    increment: f64,
}

impl Collocation {
    /// Makes room for n coordinates.
    pub fn new(tableau: &'static Tableau, n: usize, work: bool) -> Self {
        let state = || vec![0.0; 2 * n];
        Collocation {
            tableau,
            n,
            y: state(),
            carry: state(),
            rate: state(),
            end: state(),
            end_rate: state(),
            increment: state(),
            newton: Newton::new(tableau, n),
            stages: Stages::new(tableau.stages(), n),
            previous: vec![0.0; tableau.stages() * n],
            previous_step: 0.0,
            errors: state(),
            room: state(),
            interpolation: Interpolation::new(tableau, n),
            work: work.then(Quadrature::default),
            evaluations: 0,
        }
    }

    /// Accelerations of the stages as the last step's polynomial has them, through the rate where it ended.
    fn guess(&mut self, h: f64) {
        let (n, s) = (self.n, self.tableau.stages());
        let (ratio, start) = (h / self.previous_step, &self.rate[n..]);
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
        let (n, s) = (self.n, self.tableau.stages());
        for j in 0..n {
            let k = |stage: usize| self.stages.accelerations[stage * n + j];
            let place = h * (self.y[n + j] + h * sum(self.tableau.place_weights, k));
            self.increment[j] = self.carry[j] + place;
            self.increment[n + j] = self.carry[n + j] + h * sum(self.tableau.speed_weights, k);
        }
        for ((end, y), increment) in self.end.iter_mut().zip(&self.y).zip(&self.increment) {
            *end = y + increment;
        }
        let Some(work) = &mut self.work else { return };
        work.increment = 0.0;
        for i in 0..s {
            for j in 0..n {
                self.room[j] = self.y[j] + self.stages.places[i * n + j];
                self.room[n + j] = self.y[n + j] + self.stages.speeds[i * n + j];
            }
            let t = t + self.tableau.nodes[i].value() * h;
            let power = system.energy(At::packed(t, &self.room, n)).power;
            work.increment += h * self.tableau.speed_weights[i].value() * power;
        }
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
            evaluations: self.evaluations + newtons().map(|newton| newton.evaluations).sum::<u64>(),
            jacobians: newtons().map(|newton| newton.jacobians).sum(),
            factorizations: newtons().map(|newton| newton.factorizations).sum(),
        }
    }

    fn start(&self) -> Reached<'_> {
        Reached { y: &self.y, rate: &self.rate, work: self.work.map_or(0.0, |work| work.done) }
    }

    fn state_mut(&mut self) -> &mut [f64] {
        &mut self.y
    }

    fn end(&self) -> Reached<'_> {
        let work = self.work.map_or(0.0, |work| work.done + work.increment);
        Reached { y: &self.end, rate: &self.end_rate, work }
    }

    fn end_mut(&mut self) -> &mut [f64] {
        &mut self.end
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), Setback> {
        self.carry.fill(0.0);
        self.newton.forget();
        self.interpolation.forget();
        self.previous_step = 0.0;
        let (y, mut rate) = (std::mem::take(&mut self.y), std::mem::take(&mut self.rate));
        let outcome = self.evaluate(system, t, &y, &mut rate);
        (self.y, self.rate) = (y, rate);
        outcome
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), Setback> {
        self.evaluations += 1;
        let at = At::packed(t, y, self.n);
        let (speeds, accelerations) = rate.split_at_mut(self.n);
        speeds.copy_from_slice(at.v);
        Ok(system.accelerations(at, accelerations)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, Setback> {
        let Trial { t, h, tolerance } = trial;
        self.guess(h);
        let from = From { t, h, y: &self.y, carry: &self.carry };
        let solved = self.newton.solve(system, from, &mut self.stages, tolerance, &mut self.room);
        if let Err(setback) = solved {
            self.errors.fill(f64::NAN);
            self.previous_step = 0.0;
            return Err(setback);
        }
        self.finish(system, t, h);
        match (tolerance, self.tableau.estimate) {
            (Some(tolerance), Some(weights)) => self.error(system, (t, h), weights, tolerance),
            _ => Ok(0.0),
        }
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, Setback> {
        if moved {
            // What was lost to rounding lies beside the constraints.
            let ends = self.end.iter().zip(&self.y);
            self.increment.iter_mut().zip(ends).for_each(|(increment, (end, y))| *increment = end - y);
        }
        let (end, mut rate) = (std::mem::take(&mut self.end), std::mem::take(&mut self.end_rate));
        let outcome = self.evaluate(system, t, &end, &mut rate);
        (self.end, self.end_rate) = (end, rate);
        outcome?;
        Ok(self.end_rate.iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        &self.errors
    }

    fn accept(&mut self, compensated: bool) {
        for (i, carry) in self.carry.iter_mut().enumerate() {
            *carry = if compensated { self.increment[i] - (self.end[i] - self.y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        std::mem::swap(&mut self.rate, &mut self.end_rate);
        std::mem::swap(&mut self.previous, &mut self.stages.accelerations);
        self.previous_step = self.newton.step();
        if let Some(work) = &mut self.work {
            work.done += work.increment;
        }
    }

    fn stiffness(&self, _: f64) -> f64 {
        0.0
    }

    fn damp(&self, defect: &mut [f64]) {
        if let Some((mu, ..)) = self.tableau.real {
            self.newton.real.solve_pair(&self.newton.slopes, mu * self.newton.step(), defect);
        }
    }

    fn dense_is_free(&self) -> bool {
        self.interpolation.newton().is_none()
    }

    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), Setback> {
        self.write_dense(system, t, h)
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.n, pieces: self.interpolation.pieces() }
    }
}
