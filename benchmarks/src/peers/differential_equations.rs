use differential_equations::prelude::*;
use ode_solvers::SVector;

use super::{Jacobian, Problem, Program, Rates, STEPS};

struct Explicit<F, const D: usize>(Problem<F, D>);

impl<F: Rates<D>, const D: usize> ODE<f64, [f64; D]> for Explicit<F, D> {
    fn diff(&self, _: f64, y: &[f64; D], rate: &mut [f64; D]) {
        self.0.rates(y, rate);
    }
}

struct Implicit<F, const D: usize>(Problem<F, D>, Jacobian<D>);

impl<F: Rates<D>, const D: usize> ODE<f64, [f64; D]> for Implicit<F, D> {
    fn diff(&self, _: f64, y: &[f64; D], rate: &mut [f64; D]) {
        self.0.rates(y, rate);
    }

    fn jacobian(&self, _: f64, y: &[f64; D], matrix: &mut Matrix<f64>) {
        for (i, row) in (self.1)(&SVector::from(*y)).iter().enumerate() {
            for (j, &entry) in row.iter().enumerate() {
                matrix[(i, j)] = entry;
            }
        }
    }
}

/// Keeps the end alone.
struct End(f64);

impl<Y: Clone> Solout<f64, Y> for End
where
    Y: differential_equations::traits::State<f64>,
{
    fn solout<I>(
        &mut self,
        t: f64,
        _: f64,
        y: &Y,
        _: &Y,
        _: &mut I,
        solution: &mut Solution<f64, Y>,
    ) -> ControlFlag<f64, Y>
    where
        I: Interpolation<f64, Y> + ?Sized,
    {
        if t >= self.0 {
            solution.push(t, y.clone());
        }
        ControlFlag::Continue
    }
}

pub fn dop853<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> Program {
    Program::new("differential-equations", "dop853", move |tolerance| {
        let method = ExplicitRungeKutta::dop853().rtol(tolerance).atol(tolerance).max_steps(STEPS);
        let equations = Explicit(problem);
        let problem =
            IVP::ode(&equations, 0.0, problem.until, problem.start).solout(End(problem.until * (1.0 - 1e-12)));
        Some(problem.method(method).solve().ok()?.y.last()?.to_vec())
    })
}

pub fn radau5<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    Program::new("differential-equations", "radau5", move |tolerance| {
        let method = ImplicitRungeKutta::radau5().rtol(tolerance).atol(tolerance).max_steps(STEPS);
        let equations = Implicit(problem, jacobian);
        let problem =
            IVP::ode(&equations, 0.0, problem.until, problem.start).solout(End(problem.until * (1.0 - 1e-12)));
        Some(problem.method(method).solve().ok()?.y.last()?.to_vec())
    })
}
