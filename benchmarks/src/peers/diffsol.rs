use diffsol::{
    NalgebraContext, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeEquationsImplicit,
    OdeSolverMethod, OdeSolverProblem, OdeSolverStopReason, Vector,
};
use ode_solvers::SVector;

use super::{Jacobian, Problem, Program, Rates};

type Matrix = NalgebraMat<f64>;
type Lu = NalgebraLU<f64>;

pub fn tsit45<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> Program {
    Program::new("diffsol", "tsit45", move |tolerance| {
        let built = OdeBuilder::<Matrix>::new()
            .rtol(tolerance)
            .atol([tolerance])
            .rhs(move |y: &[f64], _: &[f64], _, rate: &mut [f64]| problem.rates(y, rate))
            .init(move |_: &[f64], _, y: &mut [f64]| y.copy_from_slice(&problem.start), D)
            .build()
            .ok()?;
        end(built.tsit45().ok()?, problem.until)
    })
}

pub fn bdf<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    Program::new("diffsol", "bdf", move |tolerance| {
        end(implicit(problem, jacobian, tolerance)?.bdf::<Lu>().ok()?, problem.until)
    })
}

pub fn tr_bdf2<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    Program::new("diffsol", "tr_bdf2", move |tolerance| {
        end(implicit(problem, jacobian, tolerance)?.tr_bdf2::<Lu>().ok()?, problem.until)
    })
}

pub fn esdirk34<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    Program::new("diffsol", "esdirk34", move |tolerance| {
        end(implicit(problem, jacobian, tolerance)?.esdirk34::<Lu>().ok()?, problem.until)
    })
}

fn implicit<F: Rates<D>, const D: usize>(
    problem: Problem<F, D>,
    jacobian: Jacobian<D>,
    tolerance: f64,
) -> Option<OdeSolverProblem<impl OdeEquationsImplicit<M = Matrix, V = NalgebraVec<f64>, T = f64, C = NalgebraContext>>>
{
    let product = move |y: &[f64], _: &[f64], _: f64, v: &[f64], product: &mut [f64]| {
        let rows = jacobian(&SVector::from_column_slice(y));
        for (entry, row) in product.iter_mut().zip(rows) {
            *entry = row.iter().zip(v).map(|(a, b)| a * b).sum();
        }
    };
    let mut built = OdeBuilder::<Matrix>::new()
        .rtol(tolerance)
        .atol([tolerance])
        .rhs_implicit(move |y: &[f64], _: &[f64], _, rate: &mut [f64]| problem.rates(y, rate), product)
        .init(move |_: &[f64], _, y: &mut [f64]| y.copy_from_slice(&problem.start), D)
        .build()
        .ok()?;
    // It would stop after fifty of them.
    built.ode_options.max_nonlinear_solver_failures = usize::MAX;
    Some(built)
}

fn end<'a, E>(mut solver: impl OdeSolverMethod<'a, E>, until: f64) -> Option<Vec<f64>>
where
    E: OdeEquations<T = f64> + 'a,
    E::V: Vector<T = f64>,
{
    solver.set_stop_time(until).ok()?;
    while !matches!(solver.step().ok()?, OdeSolverStopReason::TstopReached) {}
    Some(solver.state().y.clone_as_vec())
}
