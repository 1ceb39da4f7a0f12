//! One step of a Rosenbrock method.

use super::tableau::{STAGES, Tableau};
use crate::integrate::ends::{Ends, between_ends};
use crate::integrate::linear::Pencil;
use crate::integrate::{Control, Counters, Endpoint, OneStep, Segment, StepFailure, Trial};
use crate::mechanism::{AccelerationSlopes, At, System};

/// Any method that is given by a [`Tableau`].
pub(crate) struct Rosenbrock {
    pub(super) tableau: &'static Tableau,
    pub(super) ends: Ends,
    /// U of all stages; the last is the error.
    pub(super) stages: Vec<Vec<f64>>,
    slopes: AccelerationSlopes,
    /// Where the slopes were evaluated; `None`: nowhere.
    known: Option<f64>,
    pencil: Pencil<f64>,
    /// The step that the pencil is factored for.
    factored: f64,
    room: Vec<f64>,
    pub(super) pieces: Vec<f64>,
    counters: Counters,
}

/// Nodes and weights of Lobatto's rule of five points, by which W = ∫P dt is had from the dense output.
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
            ends: Ends::new(n, work),
            stages: (0..STAGES).map(|_| state()).collect(),
            slopes: AccelerationSlopes::new(n),
            known: None,
            pencil: Pencil::new(n),
            factored: 0.0,
            room: state(),
            pieces: vec![0.0; 2 * n * PIECES],
            counters: Counters::default(),
        }
    }

    /// The derivatives at the start of the step, and the matrix of all its stages.
    fn prepare(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        let at = At::packed(t, &self.ends.y, self.ends.n);
        if self.known != Some(t) {
            self.slopes.evaluate_finite(system, at)?;
            self.counters.jacobians += 1;
            (self.known, self.factored) = (Some(t), 0.0);
        }
        self.slopes.evaluate_time(system, at, h);
        self.slopes.leave_out_poles();
        if self.factored != h {
            self.factored = h;
            self.counters.factorizations += 1;
            if !self.pencil.factor(&self.slopes, self.tableau.gamma * h) {
                self.factored = 0.0;
                self.stages[STAGES - 1].fill(f64::NAN);
                return Err(StepFailure::Stalled { h });
            }
        }
        Ok(())
    }

    /// U of a stage.
    fn stage(&mut self, system: &dyn System, t: f64, h: f64, i: usize) -> Result<(), StepFailure> {
        let n = self.ends.n;
        let Tableau { gamma, arguments, couplings, nodes, times, .. } = self.tableau;
        let (before, rest) = self.stages.split_at_mut(i);
        let u = &mut rest[0];
        if i == 0 {
            u.copy_from_slice(&self.ends.rate);
        } else {
            add(&mut self.room, &self.ends.y, arguments[i], before);
            self.counters.evaluations += 1;
            system.rate(t + nodes[i] * h, &self.room, u)?;
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

    /// W at the end of the step.
    fn weigh(&mut self, system: &dyn System, t: f64, h: f64) {
        self.write_dense();
        let segment = Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces };
        let mut sum = 0.0;
        for (node, weight) in LOBATTO {
            segment.evaluate(node, &mut self.room);
            sum += weight * system.energy(At::packed(t + node * h, &self.room, self.ends.n)).power;
        }
        self.ends.add_work(h * sum);
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
        Counters { evaluations: self.counters.evaluations + self.ends.evaluations, ..self.counters }
    }

    between_ends!();

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.known = None;
        self.ends.begin(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.ends.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Trial { t, h, tolerance } = trial;
        self.prepare(system, t, h)?;
        (0..STAGES).try_for_each(|i| self.stage(system, t, h, i))?;
        add(&mut self.ends.increment, &self.ends.carry, self.tableau.arguments[STAGES], &self.stages);
        self.ends.add_up();
        if self.ends.works() {
            self.weigh(system, t, h);
        }
        Ok(tolerance.map_or(0.0, |tolerance| self.ends.in_units(self.errors(), h, tolerance)))
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        self.ends.conclude(system, t, moved)
    }

    fn errors(&self) -> &[f64] {
        &self.stages[STAGES - 1]
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
        self.known = None;
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn damp(&self, defect: &mut [f64]) -> Option<f64> {
        let gamma = self.tableau.gamma;
        self.pencil.solve_pair(&self.slopes, gamma * self.factored, defect);
        Some(gamma)
    }

    fn damps(&self) -> bool {
        true
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, _: f64) -> Result<(), StepFailure> {
        self.write_dense();
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces }
    }
}
