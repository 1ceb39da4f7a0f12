//! One step of a Runge–Kutta–Nyström method.

use super::rkn8::RKN8;
use super::tableau::{END, STAGES};
use crate::integrate::explicit::Term;
use crate::integrate::hermite::BY_MIDDLE;
use crate::integrate::tolerance::larger;
use crate::integrate::{Block, Control, Counters, Endpoint, OneStep, Segment, StepFailure, Tolerance, Trial};
use crate::mechanism::{At, Singular, System};

/// The method [`RKN8`], on blocks of any size.
pub(crate) struct Nystrom<Y> {
    pub(super) n: usize,
    y: Y,
    /// What rounding took from y in the last step.
    pub(super) carry: Y,
    end: Y,
    /// What the step that was tried adds to y, what was left over from the step before included.
    pub(super) increment: Y,
    /// The estimate of the error per step.
    estimate: Y,
    /// Rates [q'; q''] of all stages, the first that of y; of those between the ends of the step only q'' is read.
    pub(super) stages: [Y; STAGES],
    /// The places of the last stage.  No acceleration depends on the speeds beside them, which are those of y.
    argument: Y,
    work: Option<Box<Quadrature<Y>>>,
    pub(super) pieces: Vec<f64>,
    evaluations: u64,
}

/// W = ∫P dt beside the state: P is linear in the speeds of a separable mechanism.
struct Quadrature<Y> {
    done: f64,
    /// What the step that was tried adds.
    increment: f64,
    /// Places of the stages, with their speeds as soon as they are known.
    states: [Y; END],
}

/// Node and row of a stage, those for dense output after the end, as constants.
pub(crate) struct Stage<const I: usize>;

impl<const I: usize> Stage<I> {
    pub const NODE: f64 = Self::OF.0;
    pub const ROW: &'static [Term] = Self::OF.1;
    const OF: (f64, &'static [Term]) = if I < END { RKN8.rows[I] } else { RKN8.dense_rows[I - END - 1] };
}

impl<Y: Block> Nystrom<Y> {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        let zeros = || Y::zeros(n);
        let quadrature =
            || Box::new(Quadrature { done: 0.0, increment: 0.0, states: std::array::from_fn(|_| zeros()) });
        Nystrom {
            n,
            y: zeros(),
            carry: zeros(),
            end: zeros(),
            increment: zeros(),
            estimate: zeros(),
            stages: std::array::from_fn(|_| zeros()),
            argument: zeros(),
            work: work.then(quadrature),
            pieces: vec![0.0; 2 * n * BY_MIDDLE],
            evaluations: 0,
        }
    }

    /// gᵢ = a(t + cᵢh, q + cᵢh q' + h² Σ aᵢⱼgⱼ).
    #[inline(always)]
    fn stage<const I: usize>(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), Singular> {
        // Two numbers travel together on every processor of 64 bits.
        let n = self.y.all().len() / 2;
        for k in 0..n / 2 {
            self.place::<I, 2>(2 * k, h);
        }
        if n % 2 == 1 {
            self.place::<I, 1>(n - 1, h);
        }
        let argument = self.argument.all();
        self.evaluations += 1;
        system.rate(t + Stage::<I>::NODE * h, argument, self.stages[I].all_mut())?;
        if let Some(work) = self.work.as_mut().filter(|_| I < END) {
            work.states[I].clone_from(&self.argument);
        }
        Ok(())
    }

    /// The places of a stage from here on, the last term last: little waits for the acceleration just evaluated.  Each is rounded
    /// once beside y, since its differences are all that small motions are made of.
    #[inline(always)]
    fn place<const I: usize, const LANES: usize>(&mut self, at: usize, h: f64) {
        let [earlier @ .., last] = Stage::<I>::ROW else { return };
        let n = self.y.all().len() / 2;
        let sum = sum::<Y, LANES>(h * h, earlier, &self.stages, n + at);
        let (y, latest, factor) = (self.y.all(), self.stages[last.stage].all(), h * h * last.value);
        let argument = self.argument.all_mut();
        for (lane, sum) in sum.into_iter().enumerate() {
            let i = at + lane;
            argument[i] = y[i] + ((Stage::<I>::NODE * h * y[n + i] + sum) + factor * latest[n + i]);
        }
    }

    /// The end, with what rounding took from the step before.
    #[inline(always)]
    fn finish(&mut self, h: f64) {
        let n = self.y.all().len() / 2;
        for k in 0..n / 2 {
            self.finish_at::<2>(2 * k, h);
        }
        if n % 2 == 1 {
            self.finish_at::<1>(n - 1, h);
        }
    }

    #[inline(always)]
    fn finish_at<const LANES: usize>(&mut self, at: usize, h: f64) {
        let n = self.y.all().len() / 2;
        let places = sum::<Y, LANES>(h * h, RKN8.places, &self.stages, n + at);
        let speeds = sum::<Y, LANES>(h, RKN8.speeds, &self.stages, n + at);
        let (y, carry) = (self.y.all(), self.carry.all());
        let (increment, end) = (self.increment.all_mut(), self.end.all_mut());
        for (lane, (place, speed)) in places.into_iter().zip(speeds).enumerate() {
            let i = at + lane;
            increment[i] = (h * y[n + i] + place) + carry[i];
            increment[n + i] = speed + carry[n + i];
            end[i] = y[i] + increment[i];
            end[n + i] = y[n + i] + increment[n + i];
        }
    }

    /// W's part of the step: Σ b'ᵢ P(t + cᵢh, qᵢ, q' + h Σ a'ᵢⱼgⱼ).
    fn add_work(&mut self, system: &dyn System, t: f64, h: f64) {
        let n = self.n;
        let Some(work) = &mut self.work else { return };
        work.states[0].clone_from(&self.y);
        work.increment = 0.0;
        for term in RKN8.speeds {
            let state = work.states[term.stage].all_mut();
            for (i, speed) in state.iter_mut().enumerate().skip(n) {
                *speed = self.y.all()[i] + sum::<Y, 1>(h, RKN8.speed_rows[term.stage], &self.stages, i)[0];
            }
            let power = system.energy(At::packed(t + RKN8.rows[term.stage].0 * h, state, n)).power;
            work.increment += term.value * h * power;
        }
    }

    /// The error estimate in units of the tolerance: a root mean square over the components.
    #[inline(always)]
    fn error(&mut self, h: f64, tolerance: &Tolerance) -> f64 {
        let n = self.y.all().len() / 2;
        for k in 0..n / 2 {
            self.estimate_at::<2>(2 * k, h);
        }
        if n % 2 == 1 {
            self.estimate_at::<1>(n - 1, h);
        }
        let (start, end, rate) = (self.y.all(), self.end.all(), self.stages[0].all());
        let mut squares = 0.0;
        for (i, error) in self.estimate.all().iter().enumerate() {
            let change = larger((end[i] - start[i]).abs(), (h * rate[i]).abs());
            squares += (error / tolerance.unit(i, h, change)).powi(2);
        }
        (squares / end.len().max(1) as f64).sqrt()
    }

    #[inline(always)]
    fn estimate_at<const LANES: usize>(&mut self, at: usize, h: f64) {
        let n = self.y.all().len() / 2;
        let [places, speeds] = RKN8.errors;
        let places = sum::<Y, LANES>(RKN8.counts * h * h, places, &self.stages, n + at);
        let speeds = sum::<Y, LANES>(RKN8.counts * h, speeds, &self.stages, n + at);
        let estimate = self.estimate.all_mut();
        estimate[at..at + LANES].copy_from_slice(&places);
        estimate[n + at..n + at + LANES].copy_from_slice(&speeds);
    }
}

impl<Y: Block> OneStep for Nystrom<Y> {
    fn control(&self) -> Control {
        RKN8.control
    }

    fn counters(&self) -> Counters {
        Counters { evaluations: self.evaluations, ..Counters::default() }
    }

    fn start(&self) -> Endpoint<'_> {
        let work = self.work.as_ref().map_or(0.0, |work| work.done);
        Endpoint { y: self.y.all(), rate: self.stages[0].all(), work }
    }

    fn state_mut(&mut self) -> &mut [f64] {
        self.y.all_mut()
    }

    fn end(&self) -> Endpoint<'_> {
        let work = self.work.as_ref().map_or(0.0, |work| work.done + work.increment);
        Endpoint { y: self.end.all(), rate: self.stages[END].all(), work }
    }

    fn end_mut(&mut self) -> &mut [f64] {
        self.end.all_mut()
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.carry.all_mut().fill(0.0);
        self.evaluations += 1;
        Ok(system.rate(t, self.y.all(), self.stages[0].all_mut())?)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Trial { t, h, tolerance } = trial;
        self.argument.clone_from(&self.y);
        self.stage::<1>(system, t, h)?;
        self.stage::<2>(system, t, h)?;
        self.stage::<3>(system, t, h)?;
        self.stage::<4>(system, t, h)?;
        self.stage::<5>(system, t, h)?;
        self.stage::<6>(system, t, h)?;
        self.stage::<7>(system, t, h)?;
        self.finish(h);
        // The embedded method takes the acceleration at the end.
        self.evaluations += 1;
        system.rate(t + h, self.end.all(), self.stages[END].all_mut())?;
        self.add_work(system, t, h);
        Ok(tolerance.map_or(0.0, |tolerance| self.error(h, tolerance)))
    }

    fn conclude(&mut self, _: &dyn System, _: f64, _: bool) -> Result<bool, StepFailure> {
        // No constraint moves a separable mechanism.
        Ok(self.stages[END].all().iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        self.estimate.all()
    }

    fn accept(&mut self, compensated: bool) {
        let (y, end, increment) = (self.y.all(), self.end.all(), self.increment.all());
        for (i, carry) in self.carry.all_mut().iter_mut().enumerate() {
            *carry = if compensated { increment[i] - (end[i] - y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        self.stages.swap(0, END);
        if let Some(work) = &mut self.work {
            work.done += work.increment;
        }
    }

    fn stiffness(&self, h: f64, least: f64) -> f64 {
        // λ² by the two last stages, both of which lie at the end.
        let n = self.n;
        let (last, before) = (self.stages[END].all(), self.stages[END - 1].all());
        let (end, argument) = (self.end.all(), self.argument.all());
        let (mut above, mut below) = (0.0, 0.0);
        for i in 0..n {
            above += (last[n + i] - before[n + i]).powi(2);
            below += (end[i] - argument[i]).powi(2);
        }
        let noticed = below > 0.0 && above * h.powi(4) > below * least.powi(4);
        if noticed { h.abs() * (above / below).sqrt().sqrt() } else { 0.0 }
    }

    fn dense_is_free(&self) -> bool {
        false
    }

    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        self.stage::<9>(system, t, h)?;
        self.stage::<10>(system, t, h)?;
        self.stage::<11>(system, t, h)?;
        self.write_dense(h);
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.n, pieces: &self.pieces }
    }
}

/// The factor times Σ aⱼkⱼ of neighbouring components, the factor folded into the coefficients.
#[inline(always)]
fn sum<Y: Block, const LANES: usize>(factor: f64, terms: &[Term], stages: &[Y], at: usize) -> [f64; LANES] {
    let mut sum = [0.0; LANES];
    for term in terms {
        let rates = &stages[term.stage].all()[at..at + LANES];
        let factor = factor * term.value;
        for lane in 0..LANES {
            sum[lane] += factor * rates[lane];
        }
    }
    sum
}
