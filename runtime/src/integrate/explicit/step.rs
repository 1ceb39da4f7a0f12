//! One step of an explicit Runge–Kutta method.

use std::marker::PhantomData;

use super::dense::write_dense;
use super::sums::{argument, sum};
use super::tableau::{Estimate, Scheme, Stage, stages};
use crate::integrate::tolerance::larger;
use crate::integrate::{Block, Control, Counters, Endpoint, OneStep, Segment, StepFailure, Tolerance, Trial};
use crate::mechanism::{At, Singular, System};

/// Any method that is given by a [`Scheme`], on blocks of any size.
pub(crate) struct ExplicitRungeKutta<T, Y> {
    scheme: PhantomData<T>,
    n: usize,
    y: Y,
    /// What rounding took from y in the last step.
    carry: Y,
    end: Y,
    /// What the step that was tried adds to y, what was left over from the step before included.
    increment: Y,
    /// The estimate of the error.
    errors: Y,
    /// Rates of all stages; the first is that of y.
    stages: [Y; STAGES],
    /// The arguments of the last two stages, even ones first.
    arguments: [Y; 2],
    work: Option<Quadrature>,
    pieces: Vec<f64>,
    evaluations: u64,
}

/// No method here has more, those for dense output and the rate at the end of the step included.
const STAGES: usize = 16;

/// W = ∫P dt beside the state: no rate depends on it, so that it is a sum over the stages.
#[derive(Clone, Copy, Default)]
struct Quadrature {
    done: f64,
    /// What the step that was tried adds.
    increment: f64,
    powers: [f64; STAGES],
}

impl<T: Scheme, Y: Block> ExplicitRungeKutta<T, Y> {
    const END: usize = T::TABLEAU.end_stage();

    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        let zeros = || Y::zeros(n);
        ExplicitRungeKutta {
            scheme: PhantomData,
            n,
            y: zeros(),
            carry: zeros(),
            end: zeros(),
            increment: zeros(),
            errors: zeros(),
            stages: std::array::from_fn(|_| zeros()),
            arguments: [zeros(), zeros()],
            work: work.then(Quadrature::default),
            pieces: vec![0.0; 2 * n * (4 + T::TABLEAU.dense.len())],
            evaluations: 0,
        }
    }

    /// kᵢ = f(t + cᵢh, y + h Σ aᵢⱼkⱼ), and the power there where it is wanted.
    #[inline(always)]
    fn stage<const I: usize>(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), Singular> {
        let at = &mut self.arguments[I % 2];
        argument(at, &self.y, h, Stage::<T, I>::ROW, &self.stages);
        let t = t + Stage::<T, I>::NODE * h;
        self.evaluations += 1;
        system.rate(t, at.all(), self.stages[I].all_mut())?;
        if let Some(work) = self.work.as_mut().filter(|_| Stage::<T, I>::WEIGHS) {
            work.powers[I] = system.energy(At::packed(t, at.all(), self.n)).power;
        }
        Ok(())
    }

    /// The rate and the power at a state that a step ends or begins with.
    fn rate_of(&mut self, system: &dyn System, t: f64, stage: usize, known: bool) -> Result<(), Singular> {
        let y = if stage == Self::END { &self.end } else { &self.y };
        if !known {
            self.evaluations += 1;
            system.rate(t, y.all(), self.stages[stage].all_mut())?;
        }
        if let Some(work) = &mut self.work {
            work.powers[stage] = system.energy(At::packed(t, y.all(), self.n)).power;
        }
        Ok(())
    }

    /// y + h Σ bᵢkᵢ with what rounding took from the step before, and W with its part.
    #[inline(always)]
    fn finish(&mut self, h: f64) {
        let (y, carry, increment) = (self.y.all(), self.carry.all(), self.increment.all_mut());
        let end = self.end.all_mut();
        for k in 0..y.len() / 2 {
            let sum = sum(T::TABLEAU.weights, &self.stages, 2 * k);
            for (lane, sum) in sum.iter().enumerate() {
                let i = 2 * k + lane;
                increment[i] = h * sum + carry[i];
                end[i] = y[i] + increment[i];
            }
        }
        if let Some(work) = &mut self.work {
            let powers = T::TABLEAU.weights.iter().map(|term| term.value * work.powers[term.stage]);
            work.increment = h * powers.sum::<f64>();
        }
    }

    /// The error estimate in units of the tolerance: a root mean square over the components.
    #[inline(always)]
    fn error(&mut self, h: f64, tolerance: &Tolerance) -> f64 {
        let (higher, lower) = T::TABLEAU.estimate.terms();
        let (increment, rate) = (self.increment.all(), self.stages[0].all());
        let (mut five, mut three) = (0.0, 0.0);
        for (k, errors) in self.errors.all_mut().chunks_exact_mut(2).enumerate() {
            let (higher, lower) = (sum(higher, &self.stages, 2 * k), sum(lower, &self.stages, 2 * k));
            for (lane, error) in errors.iter_mut().enumerate() {
                let i = 2 * k + lane;
                let change = larger(increment[i].abs(), (h * rate[i]).abs());
                let steps = h / tolerance.unit(i, h, change);
                five += (higher[lane] * steps).powi(2);
                three += (lower[lane] * steps).powi(2);
                *error = h * higher[lane];
            }
        }
        let mean = 1.0 / increment.len().max(1) as f64;
        match T::TABLEAU.estimate {
            Estimate::None => 0.0,
            Estimate::Single(_) => (five * mean).sqrt(),
            Estimate::Pair { .. } => {
                // Squares of what is as small as that are not told apart, and their quotient would be no number.
                let both = (five + 0.01 * three).max(f64::MIN_POSITIVE);
                five * (mean / both).sqrt()
            }
        }
    }
}

impl<T: Scheme, Y: Block> OneStep for ExplicitRungeKutta<T, Y> {
    fn control(&self) -> Control {
        T::TABLEAU.control
    }

    fn slides(&self) -> bool {
        true
    }

    fn counters(&self) -> Counters {
        Counters { evaluations: self.evaluations, ..Counters::default() }
    }

    fn start(&self) -> Endpoint<'_> {
        let work = self.work.map_or(0.0, |work| work.done);
        Endpoint { y: self.y.all(), rate: self.stages[0].all(), work }
    }

    fn state_mut(&mut self) -> &mut [f64] {
        self.y.all_mut()
    }

    fn end(&self) -> Endpoint<'_> {
        let work = self.work.map_or(0.0, |work| work.done + work.increment);
        Endpoint { y: self.end.all(), rate: self.stages[Self::END].all(), work }
    }

    fn end_mut(&mut self) -> &mut [f64] {
        self.end.all_mut()
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.carry.all_mut().fill(0.0);
        Ok(self.rate_of(system, t, 0, false)?)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Trial { t, h, tolerance } = trial;
        // A method of one stage has y as its last argument.
        stages!(self.stage(system, t, h) for 1 2 3 4 5 6 7 8 9 10 11 below T::TABLEAU.rows.len(), from 1);
        self.finish(h);
        Ok(tolerance.map_or(0.0, |tolerance| self.error(h, tolerance)))
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        if moved {
            // What was lost to rounding lies beside the constraints.
            let (y, end) = (self.y.all(), self.end.all());
            let increment = self.increment.all_mut().iter_mut();
            increment.zip(end.iter().zip(y)).for_each(|(increment, (end, y))| *increment = end - y);
        }
        self.rate_of(system, t, Self::END, T::TABLEAU.first_same_as_last && !moved)?;
        Ok(self.stages[Self::END].all().iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        self.errors.all()
    }

    fn accept(&mut self, compensated: bool) {
        let (y, end, increment) = (self.y.all(), self.end.all(), self.increment.all());
        for (i, carry) in self.carry.all_mut().iter_mut().enumerate() {
            *carry = if compensated { increment[i] - (end[i] - y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.end);
        self.stages.swap(0, Self::END);
        if let Some(work) = &mut self.work {
            work.done += work.increment;
            work.powers[0] = work.powers[Self::END];
        }
    }

    fn stiffness(&self, h: f64, least: f64) -> f64 {
        let Some(before) = Self::END.checked_sub(1).filter(|before| *before > 0) else { return 0.0 };
        let (last, rates) = (self.stages[Self::END].all(), self.stages[before].all());
        let (end, argument) = (self.end.all(), self.arguments[before % 2].all());
        let [mut above, mut below] = [[0.0; 2]; 2];
        for i in 0..end.len() {
            let kind = usize::from(i >= self.n);
            above[kind] += (last[i] - rates[i]).powi(2);
            below[kind] += (end[i] - argument[i]).powi(2);
        }
        // Speeds count as the way that they lead over the step: in a unit of time that is much shorter a place that moves evenly would have
        // as large a rate as its speed is beside it.
        let [above, below] = [above, below].map(|[places, speeds]| places + h * h * speeds);
        let noticed = below > 0.0 && above * (h * h) > below * (least * least);
        if noticed { h.abs() * (above / below).sqrt() } else { 0.0 }
    }

    fn dense_is_free(&self) -> bool {
        T::TABLEAU.dense_rows.is_empty()
    }

    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        stages!(self.stage(system, t, h) for 13 14 15 below Self::END + 1 + T::TABLEAU.dense_rows.len(), from Self::END + 1);
        write_dense(T::TABLEAU, h, &self.y, &self.end, &self.stages, &mut self.pieces);
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.n, pieces: &self.pieces }
    }
}
