//! One step of a splitting method.

use super::rattle::{Part, Rattle, is_constrained};
use super::tableau::Splitting;
use crate::integrate::hermite::{BY_ENDS, BY_MIDDLE};
use crate::integrate::{Block, Control, Counters, Endpoint, NO_CONTROL, OneStep, Segment, StepFailure, Trial};
use crate::mechanism::{At, System};

/// Any method that is given by a [`Splitting`], on blocks of any size.
pub(crate) struct Symplectic<Y> {
    pub(super) scheme: &'static Splitting,
    n: usize,
    y: Y,
    /// What rounding took from y in the last step.
    carry: Y,
    /// The rate of y.
    rate: Y,
    /// The step that was tried, and one of half its length for dense output.
    pub(super) whole: Passage<Y>,
    pub(super) half: Passage<Y>,
    work: Option<Quadrature>,
    pub(super) pieces: Vec<f64>,
    pub(super) evaluations: u64,
}

/// A way through kicks and drifts.
pub(super) struct Passage<Y> {
    /// What it adds to y, what was left over from the step before included.
    increment: Y,
    pub end: Y,
    /// The rate at its end.
    pub rate: Y,
    /// What goes along constraints.
    rattle: Rattle,
    /// Evaluations of the accelerations on ways without constraints.
    evaluations: u64,
}

/// W = ∫P dt beside the state: P is linear in the speeds of a separable mechanism, so that the mean speed of a kick gives
/// its part exactly, and W has the order of the method.  Along constraints the mean of P at both ends of a part does as well: a
/// symmetric rule of order 2, as the part itself.
#[derive(Clone, Copy, Default)]
struct Quadrature {
    done: f64,
    /// What the step that was tried adds.
    increment: f64,
}

/// Where a passage begins.
struct From<'a, Y> {
    t: f64,
    y: &'a Y,
    rate: &'a Y,
    carry: &'a Y,
}

impl<Y: Block> Symplectic<Y> {
    /// Makes room for n coordinates.
    pub fn new(scheme: &'static Splitting, n: usize, work: bool) -> Self {
        let zeros = || Y::zeros(n);
        let passage =
            || Passage { increment: zeros(), end: zeros(), rate: zeros(), rattle: Rattle::default(), evaluations: 0 };
        Symplectic {
            scheme,
            n,
            y: zeros(),
            carry: zeros(),
            rate: zeros(),
            whole: passage(),
            half: passage(),
            work: work.then(Quadrature::default),
            pieces: vec![0.0; 2 * n * if scheme.needs_middle { BY_MIDDLE } else { BY_ENDS }],
            evaluations: 0,
        }
    }

    /// Goes half of a step of h, beside the motion.
    pub(super) fn pass_half(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        let from = From { t, y: &self.y, rate: &self.rate, carry: &self.carry };
        self.half.go(self.scheme, system, from, 0.5 * h, None)
    }
}

impl<Y: Block> Passage<Y> {
    fn go(
        &mut self,
        scheme: &Splitting,
        system: &dyn System,
        from: From<'_, Y>,
        h: f64,
        mut work: Option<&mut Quadrature>,
    ) -> Result<(), StepFailure> {
        self.increment.clone_from(from.carry);
        self.end.clone_from(from.y);
        self.rate.clone_from(from.rate);
        if is_constrained(system) {
            return self.go_constrained(scheme, system, from, h, work);
        }
        let From { t, y, .. } = from;
        let n = y.all().len() / 2;
        let (mut now, mut part) = (t, 0.0);
        self.evaluations += scheme.drifts.len() as u64;
        for (i, kick) in scheme.kicks.iter().enumerate() {
            let kicked = |part: f64, passage: &mut Self| {
                let (end, increment) = (passage.end.all_mut(), passage.increment.all_mut());
                for k in n..2 * n {
                    increment[k] += part * h * passage.rate.all()[k];
                    end[k] = y.all()[k] + increment[k];
                }
            };
            match &mut work {
                Some(work) => {
                    kicked(0.5 * kick, self);
                    work.increment += kick * h * system.energy(At::packed(now, self.end.all(), n)).power;
                    kicked(0.5 * kick, self);
                }
                None => kicked(*kick, self),
            }
            let Some(drift) = scheme.drifts.get(i) else { break };
            part += drift;
            now = if i + 1 == scheme.drifts.len() { t + h } else { t + part * h };
            let (end, increment) = (self.end.all_mut(), self.increment.all_mut());
            for k in 0..n {
                increment[k] += drift * h * end[n + k];
                end[k] = y.all()[k] + increment[k];
            }
            system.accelerations(At::packed(now, end, n), &mut self.rate.all_mut()[n..])?;
        }
        self.rate.all_mut()[..n].copy_from_slice(&self.end.all()[n..]);
        Ok(())
    }

    /// Takes note that its end is another.
    fn moved(&mut self, system: &dyn System, t: f64, y: &Y) -> Result<(), StepFailure> {
        let ends = self.end.all().iter().zip(y.all());
        self.increment.all_mut().iter_mut().zip(ends).for_each(|(increment, (end, y))| *increment = end - y);
        let (n, end) = (y.all().len() / 2, self.end.all());
        let (speeds, accelerations) = self.rate.all_mut().split_at_mut(n);
        speeds.copy_from_slice(&end[n..]);
        Ok(self.rattle.begin(system, At::packed(t, end, n), accelerations)?)
    }

    /// The same in parts of RATTLE, for compositions of Verlet steps.
    fn go_constrained(
        &mut self,
        scheme: &Splitting,
        system: &dyn System,
        From { t, y, .. }: From<'_, Y>,
        h: f64,
        mut work: Option<&mut Quadrature>,
    ) -> Result<(), StepFailure> {
        let n = y.all().len() / 2;
        let power = |t: f64, end: &Y| system.energy(At::packed(t, end.all(), n)).power;
        let mut done = 0.0;
        let mut before = work.as_ref().map_or(0.0, |_| power(t, y));
        self.rattle.stand(system, At::place(t, &y.all()[..n]))?;
        for (i, drift) in scheme.drifts.iter().enumerate() {
            done += drift;
            let now = if i + 1 == scheme.drifts.len() { t + h } else { t + done * h };
            let part = Part { t: now, h: drift * h, y: y.all() };
            let state = (self.increment.all_mut(), self.end.all_mut());
            if !self.rattle.go(system, part, state, self.rate.all_mut())? {
                return Err(StepFailure::Stalled { h });
            }
            if let Some(work) = &mut work {
                let after = power(now, &self.end);
                work.increment += 0.5 * drift * h * (before + after);
                before = after;
            }
        }
        Ok(())
    }
}

impl<Y: Block> OneStep for Symplectic<Y> {
    fn control(&self) -> Control {
        NO_CONTROL
    }

    fn counters(&self) -> Counters {
        let ways = [&self.whole, &self.half];
        let evaluations = ways.map(|way| way.evaluations + way.rattle.evaluations).iter().sum::<u64>();
        let factorizations = ways.map(|way| way.rattle.factorizations).iter().sum();
        Counters { evaluations: self.evaluations + evaluations, factorizations, ..Counters::default() }
    }

    fn start(&self) -> Endpoint<'_> {
        let work = self.work.map_or(0.0, |work| work.done);
        Endpoint { y: self.y.all(), rate: self.rate.all(), work }
    }

    fn state_mut(&mut self) -> &mut [f64] {
        self.y.all_mut()
    }

    fn end(&self) -> Endpoint<'_> {
        let work = self.work.map_or(0.0, |work| work.done + work.increment);
        Endpoint { y: self.whole.end.all(), rate: self.whole.rate.all(), work }
    }

    fn end_mut(&mut self) -> &mut [f64] {
        self.whole.end.all_mut()
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.carry.all_mut().fill(0.0);
        let (y, n) = (self.y.all(), self.n);
        if !is_constrained(system) {
            self.evaluations += 1;
            return Ok(system.rate(t, y, self.rate.all_mut())?);
        }
        let (speeds, accelerations) = self.rate.all_mut().split_at_mut(n);
        speeds.copy_from_slice(&y[n..]);
        Ok(self.whole.rattle.begin(system, At::packed(t, y, n), accelerations)?)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let from = From { t: trial.t, y: &self.y, rate: &self.rate, carry: &self.carry };
        if let Some(work) = &mut self.work {
            work.increment = 0.0;
        }
        self.whole.go(self.scheme, system, from, trial.h, self.work.as_mut())?;
        Ok(0.0)
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        // The last kick had the acceleration at the end, and RATTLE ends on all constraints that it does not leave out.
        if moved {
            self.whole.moved(system, t, &self.y)?;
        }
        Ok(self.whole.rate.all().iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        &[]
    }

    fn accept(&mut self, compensated: bool) {
        let (y, end, increment) = (self.y.all(), self.whole.end.all(), self.whole.increment.all());
        for (i, carry) in self.carry.all_mut().iter_mut().enumerate() {
            *carry = if compensated { increment[i] - (end[i] - y[i]) } else { 0.0 };
        }
        std::mem::swap(&mut self.y, &mut self.whole.end);
        std::mem::swap(&mut self.rate, &mut self.whole.rate);
        self.whole.rattle.stands = true;
        if let Some(work) = &mut self.work {
            work.done += work.increment;
        }
    }

    fn keeps_constraints(&self) -> bool {
        true
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        !self.scheme.needs_middle
    }

    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure> {
        self.write_dense(system, t, h)
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.n, pieces: &self.pieces }
    }
}
