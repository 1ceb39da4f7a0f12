use ode_solvers::SVector;
use russell_lab::Vector;
use russell_ode::{Method, NoArgs, OdeSolver, Params, System};
use russell_sparse::{CooMatrix, Sym};

use super::{Jacobian, Problem, Program, Rates, STEPS};

pub fn dopri8<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> Program {
    Program::new("russell_ode", "DoPri8", move |tolerance| {
        solve(problem, Params::new(Method::DoPri8), system(problem), tolerance)
    })
}

/// Its two linear systems are factored one after the other.
pub fn radau5<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    let mut params = Params::new(Method::Radau5);
    params.radau5.concurrent = false;
    radau5_by("Radau5", params, problem, jacobian)
}

/// As it comes: its two linear systems are factored by two threads.
pub fn radau5_threads<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Program {
    radau5_by("Radau5, two threads", Params::new(Method::Radau5), problem, jacobian)
}

fn radau5_by<F: Rates<D>, const D: usize>(
    name: &'static str,
    params: Params,
    problem: Problem<F, D>,
    jacobian: Jacobian<D>,
) -> Program {
    let fill = move |matrix: &mut CooMatrix, alpha: f64, _: f64, y: &Vector, _: &mut NoArgs| {
        matrix.reset();
        for (i, row) in jacobian(&SVector::from_column_slice(y.as_data())).iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                matrix.put(i, j, alpha * entry)?;
            }
        }
        Ok(())
    };
    Program::new("russell_ode", name, move |tolerance| {
        let mut system = system(problem);
        system.set_jacobian(Some(D * D), Sym::No, fill).ok()?;
        solve(problem, params, system, tolerance)
    })
}

fn system<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> System<'static, NoArgs> {
    System::new(D, move |rate: &mut Vector, _, y: &Vector, _: &mut NoArgs| {
        problem.rates(y.as_data(), rate.as_mut_data());
        Ok(())
    })
}

fn solve<F, const D: usize>(
    problem: Problem<F, D>,
    mut params: Params,
    system: System<NoArgs>,
    tolerance: f64,
) -> Option<Vec<f64>> {
    params.step.n_step_max = STEPS;
    params.set_tolerances(tolerance, tolerance, None).ok()?;
    let mut y = Vector::from(&problem.start);
    OdeSolver::new(params, system).ok()?.solve(&mut y, 0.0, problem.until, None, &mut 0, None).ok()?;
    Some(y.as_data().clone())
}
