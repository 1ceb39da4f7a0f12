use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector, System};

use super::{Problem, Program, Rates, STEPS};

impl<F: Rates<D>, const D: usize> System<f64, SVector<f64, D>> for Problem<F, D> {
    fn system(&self, _: f64, y: &SVector<f64, D>, rate: &mut SVector<f64, D>) {
        (self.f)(y, rate);
    }
}

pub fn dop853<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> Program {
    Program::new("ode_solvers", "Dop853", move |tolerance| {
        let mut solver = Dop853::from_param(
            problem,
            0.0,
            problem.until,
            problem.until,
            problem.start.into(),
            tolerance,
            tolerance,
            0.9,
            0.0,
            0.333,
            6.0,
            problem.until,
            0.0,
            STEPS as u32,
            1000,
            OutputType::Sparse,
        );
        solver.integrate().ok()?;
        Some(solver.y_out().last()?.iter().copied().collect())
    })
}
