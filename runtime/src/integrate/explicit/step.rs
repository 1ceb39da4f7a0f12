//! One step of an explicit Runge–Kutta method.

use super::dense::write_dense;
use super::tableau::{Estimate, Tableau, Term};
use crate::integrate::{OneStep, Rates, Tolerance};
use crate::mechanism::{Singular, System};

/// Any method that is given by a [`Tableau`].
pub(crate) struct ExplicitRungeKutta {
    tableau: &'static Tableau,
    width: usize,
    /// Rates of all stages, one after the other.
    stages: Vec<f64>,
    /// The argument of the present stage.
    argument: Vec<f64>,
    /// The argument of the stage before the last, for the stiffness test.
    earlier: Vec<f64>,
    scratch: Vec<f64>,
    increment: Vec<f64>,
}

impl ExplicitRungeKutta {
    /// Makes room for the stages.
    pub fn new(tableau: &'static Tableau, width: usize) -> Self {
        let count = tableau.end_stage() + 1 + tableau.dense_rows.len();
        ExplicitRungeKutta {
            tableau,
            width,
            stages: vec![0.0; count * width],
            argument: vec![0.0; width],
            earlier: vec![0.0; width],
            scratch: vec![0.0; width],
            increment: vec![0.0; width],
        }
    }

    fn stage(&self, index: usize) -> &[f64] {
        &self.stages[index * self.width..][..self.width]
    }

    fn stage_mut(&mut self, index: usize) -> &mut [f64] {
        &mut self.stages[index * self.width..][..self.width]
    }

    /// kᵢ = f(t + cᵢh, y + h Σ aᵢⱼkⱼ).
    fn evaluate_stage<S: System + ?Sized>(
        &mut self,
        index: usize,
        (node, row): (f64, &[Term]),
        rates: &mut Rates,
        system: &S,
        (t, h, y): (f64, f64, &[f64]),
    ) -> Result<(), Singular> {
        std::mem::swap(&mut self.argument, &mut self.earlier);
        combine(&mut self.argument, h, row, &self.stages, self.width);
        for (argument, y) in self.argument.iter_mut().zip(y) {
            *argument += y;
        }
        let slot = &mut self.stages[index * self.width..][..self.width];
        rates.evaluate(system, t + node * h, &self.argument, slot)
    }

    /// The error estimate in units of the tolerance (root mean square over the components).
    fn error(&mut self, h: f64, y: &[f64], tolerance: &Tolerance) -> f64 {
        let (stages, width, increment) = (&self.stages, self.width, &self.increment);
        let mean_square = |terms: &[Term], work: &mut [f64]| {
            combine(work, 1.0, terms, stages, width);
            tolerance.mean_square(work, y, increment)
        };
        match self.tableau.estimate {
            Estimate::None => 0.0,
            Estimate::Single(terms) => h.abs() * mean_square(terms, &mut self.scratch).sqrt(),
            Estimate::Pair { higher, lower } => {
                let five = mean_square(higher, &mut self.scratch);
                let three = mean_square(lower, &mut self.scratch);
                let both = five + 0.01 * three;
                if both == 0.0 { 0.0 } else { h.abs() * five / both.sqrt() }
            }
        }
    }
}

/// out = h Σ aⱼkⱼ.
pub(super) fn combine(out: &mut [f64], h: f64, terms: &[Term], stages: &[f64], width: usize) {
    for (block, out) in out.chunks_exact_mut(4).enumerate() {
        let mut sum = [0.0; 4];
        for term in terms {
            let rates = &stages[term.stage * width + 4 * block..][..4];
            for lane in 0..4 {
                sum[lane] += term.value * rates[lane];
            }
        }
        for lane in 0..4 {
            out[lane] = h * sum[lane];
        }
    }
}

impl<S: System + ?Sized> OneStep<S> for ExplicitRungeKutta {
    fn tableau(&self) -> &'static Tableau {
        self.tableau
    }

    fn attempt(
        &mut self,
        rates: &mut Rates,
        system: &S,
        (t, h, y): (f64, f64, &[f64]),
        rate: &[f64],
        tolerance: Option<&Tolerance>,
    ) -> Result<f64, Singular> {
        self.stage_mut(0).copy_from_slice(rate);
        self.argument.copy_from_slice(y);
        for (index, &(node, row)) in self.tableau.rows.iter().enumerate().skip(1) {
            self.evaluate_stage(index, (node, row), rates, system, (t, h, y))?;
        }
        combine(&mut self.increment, h, self.tableau.weights, &self.stages, self.width);
        Ok(tolerance.map_or(0.0, |tolerance| self.error(h, y, tolerance)))
    }

    fn increment(&self) -> &[f64] {
        &self.increment
    }

    fn end_rate(&mut self, rates: &mut Rates, system: &S, t: f64, y: &[f64]) -> Result<&[f64], Singular> {
        let end = self.tableau.end_stage();
        if !self.tableau.first_same_as_last {
            let slot = &mut self.stages[end * self.width..][..self.width];
            rates.evaluate(system, t, y, slot)?;
        }
        Ok(self.stage(end))
    }

    fn last_rate(&self) -> &[f64] {
        self.stage(self.tableau.end_stage())
    }

    fn stiffness(&self, h: f64, end: &[f64]) -> f64 {
        let index = self.tableau.end_stage();
        if index == 0 {
            return 0.0;
        }
        let (last, before) = (self.stage(index), self.stage(index - 1));
        let argument = if self.tableau.first_same_as_last { &self.earlier } else { &self.argument };
        let mut above = 0.0;
        let mut below = 0.0;
        for i in 0..self.width {
            above += (last[i] - before[i]).powi(2);
            below += (end[i] - argument[i]).powi(2);
        }
        if below > 0.0 { h.abs() * (above / below).sqrt() } else { 0.0 }
    }

    fn pieces(&self) -> usize {
        4 + self.tableau.dense.len()
    }

    fn dense(
        &mut self,
        rates: &mut Rates,
        system: &S,
        (t, h, y): (f64, f64, &[f64]),
        end: &[f64],
        pieces: &mut [f64],
    ) -> Result<(), Singular> {
        let first = self.tableau.end_stage() + 1;
        for (offset, &(node, row)) in self.tableau.dense_rows.iter().enumerate() {
            self.evaluate_stage(first + offset, (node, row), rates, system, (t, h, y))?;
        }
        write_dense(self.tableau, h, y, end, &self.stages, self.width, pieces);
        Ok(())
    }
}
