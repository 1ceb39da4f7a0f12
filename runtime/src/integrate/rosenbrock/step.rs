//! One step of a Rosenbrock method.

use super::tableau::{STAGES, Tableau};
use crate::integrate::linear::Pencil;
use crate::integrate::{Control, Counters, OneStep, Reached, Segment, Setback, Tolerance, Trial};
use crate::mechanism::{AccelerationSlopes, At, System};

/// Any method that is given by a [`Tableau`].
pub(crate) struct Rosenbrock {
    pub(super) tableau: &'static Tableau,
    pub(super) n: usize,
    pub(super) y: Vec<f64>,
    carry: Vec<f64>,
    rate: Vec<f64>,
    pub(super) end: Vec<f64>,
    end_rate: Vec<f64>,
    increment: Vec<f64>,
    /// U of all stages; the last is the error.
    pub(super) stages: Vec<Vec<f64>>,
    slopes: AccelerationSlopes,
    /// Where the slopes were evaluated; `None`: nowhere.
    known: Option<f64>,
    pencil: Pencil<f64>,
    /// The step that the pencil is factored for.
    factored: f64,
    room: Vec<f64>,
    work: Option<Quadrature>,
    pub(super) pieces: Vec<f64>,
    counters: Counters,
}

/// W = ∫P dt over the dense output of the step, by Lobatto's rule of five points.
#[derive(Clone, Copy, Default)]
struct Quadrature {
    done: f64,
    increment: f64,
}

const LOBATTO: [(f64, f64); 5] = [
    (0.0, 0.05),
    (0.172_673_164_646_011_43, 49.0 / 180.0),
    (0.5, 16.0 / 45.0),
    (0.827_326_835_353_988_6, 49.0 / 180.0),
    (1.0, 0.05),
];

/// Pieces of the dense output.
const PIECES: usize = 5;

impl Rosenbrock {
    /// Makes room for n coordinates.
    pub fn new(tableau: &'static Tableau, n: usize, work: bool) -> Self {
        let state = || vec![0.0; 2 * n];
        Rosenbrock {
            tableau,
            n,
            y: state(),
            carry: state(),
            rate: state(),
            end: state(),
            end_rate: state(),
            increment: state(),
            stages: (0..STAGES).map(|_| state()).collect(),
            slopes: AccelerationSlopes::new(n),
            known: None,
            pencil: Pencil::new(n),
            factored: 0.0,
            room: state(),
            work: work.then(Quadrature::default),
            pieces: vec![0.0; 2 * n * PIECES],
            counters: Counters::default(),
        }
    }

    /// The derivatives at the start of the step, and the matrix of all its stages.
    fn prepare(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), Setback> {
        let at = At::packed(t, &self.y, self.n);
        if self.known != Some(t) {
            self.slopes.evaluate(system, at)?;
            self.counters.jacobians += 1;
            (self.known, self.factored) = (Some(t), 0.0);
        }
        self.slopes.evaluate_time(system, at, h);
        if self.factored != h {
            self.factored = h;
            self.counters.factorizations += 1;
            if !self.pencil.factor(&self.slopes, self.tableau.gamma * h) {
                self.factored = 0.0;
                return Err(Setback::Stalled { h });
            }
        }
        Ok(())
    }

    /// U of a stage.
    fn stage(&mut self, system: &dyn System, t: f64, h: f64, i: usize) -> Result<(), Setback> {
        let n = self.n;
        let Tableau { gamma, arguments, couplings, nodes, times, .. } = self.tableau;
        let (before, rest) = self.stages.split_at_mut(i);
        let u = &mut rest[0];
        if i == 0 {
            u.copy_from_slice(&self.rate);
        } else {
            add(&mut self.room, &self.y, arguments[i], before);
            self.counters.evaluations += 1;
            let at = At::packed(t + nodes[i] * h, &self.room, n);
            let (speeds, accelerations) = u.split_at_mut(n);
            speeds.copy_from_slice(at.v);
            system.accelerations(at, accelerations)?;
        }
        for (u, by_time) in u[n..].iter_mut().zip(self.slopes.by_time()) {
            *u += h * times[i] * by_time;
        }
        for (j, u) in u.iter_mut().enumerate() {
            let coupled: f64 = couplings[i].iter().zip(before.iter()).map(|(c, before)| c * before[j]).sum();
            *u = gamma * (h * *u + coupled);
        }
        self.pencil.solve_pair(&self.slopes, gamma * h, u);
        Ok(())
    }

    /// The root mean square of the estimate in units of the tolerance.
    fn error(&self, h: f64, tolerance: &Tolerance) -> f64 {
        let (n, errors) = (self.n, &self.stages[STAGES - 1]);
        let sum: f64 = (0..n)
            .map(|j| {
                let changes = [self.end[j] - self.y[j], self.end[n + j] - self.y[n + j]];
                let [place, speed] = tolerance.units_by_change(j, h, changes);
                (errors[j] / place).powi(2) + (errors[n + j] / speed).powi(2)
            })
            .sum();
        (sum / (2 * n).max(1) as f64).sqrt()
    }

    /// W at the end of the step.
    fn weigh(&mut self, system: &dyn System, t: f64, h: f64) {
        self.write_dense();
        let segment = Segment { t, h, width: 2 * self.n, pieces: &self.pieces };
        let mut sum = 0.0;
        for (node, weight) in LOBATTO {
            segment.evaluate(node, &mut self.room);
            sum += weight * system.energy(At::packed(t + node * h, &self.room, self.n)).power;
        }
        if let Some(work) = &mut self.work {
            work.increment = h * sum;
        }
    }
}

/// out = y + Σ aⱼ Uⱼ.
fn add(out: &mut [f64], y: &[f64], weights: &[f64], stages: &[Vec<f64>]) {
    for (j, out) in out.iter_mut().enumerate() {
        *out = y[j] + weights.iter().zip(stages).map(|(a, u)| a * u[j]).sum::<f64>();
    }
}

impl OneStep for Rosenbrock {
    fn control(&self) -> Control {
        self.tableau.control
    }

    fn counters(&self) -> Counters {
        self.counters
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
        self.known = None;
        let (y, mut rate) = (std::mem::take(&mut self.y), std::mem::take(&mut self.rate));
        let outcome = self.evaluate(system, t, &y, &mut rate);
        (self.y, self.rate) = (y, rate);
        outcome
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), Setback> {
        self.counters.evaluations += 1;
        let at = At::packed(t, y, self.n);
        let (speeds, accelerations) = rate.split_at_mut(self.n);
        speeds.copy_from_slice(at.v);
        Ok(system.accelerations(at, accelerations)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, Setback> {
        let Trial { t, h, tolerance } = trial;
        self.prepare(system, t, h)?;
        (0..STAGES).try_for_each(|i| self.stage(system, t, h, i))?;
        add(&mut self.increment, &self.carry, self.tableau.arguments[STAGES], &self.stages);
        for ((end, y), increment) in self.end.iter_mut().zip(&self.y).zip(&self.increment) {
            *end = y + increment;
        }
        if self.work.is_some() {
            self.weigh(system, t, h);
        }
        Ok(tolerance.map_or(0.0, |tolerance| self.error(h, tolerance)))
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
        &self.stages[STAGES - 1]
    }

    fn accept(&mut self, compensated: bool) {
        for (i, carry) in self.carry.iter_mut().enumerate() {
            *carry = if compensated { self.increment[i] - (self.end[i] - self.y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        std::mem::swap(&mut self.rate, &mut self.end_rate);
        self.known = None;
        if let Some(work) = &mut self.work {
            work.done += work.increment;
        }
    }

    fn stiffness(&self, _: f64) -> f64 {
        0.0
    }

    fn damp(&self, defect: &mut [f64]) {
        self.pencil.solve_pair(&self.slopes, self.tableau.gamma * self.factored, defect);
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, _: f64) -> Result<(), Setback> {
        self.write_dense();
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.n, pieces: &self.pieces }
    }
}
