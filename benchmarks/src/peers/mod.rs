//! Other programs behind one interface: a tolerance in, the state at the end out.

mod curve;
mod differential_equations;
mod diffsol;
mod ode_solvers;
mod russell;

use ::ode_solvers::SVector;
pub use curve::Curve;

/// Steps are not limited by number.
const STEPS: usize = 100_000_000;

/// What everybody integrates: y' = f(y) from `start`, until then.
#[derive(Clone, Copy)]
pub struct Problem<F, const D: usize> {
    pub f: F,
    pub start: [f64; D],
    pub until: f64,
}

/// Rates of a state, as a person writes them.
pub trait Rates<const D: usize>: Fn(&SVector<f64, D>, &mut SVector<f64, D>) + Copy + Send + Sync + 'static {}

impl<F, const D: usize> Rates<D> for F where F: Fn(&SVector<f64, D>, &mut SVector<f64, D>) + Copy + Send + Sync + 'static
{}

/// ∂f/∂y, row by row.
pub type Jacobian<const D: usize> = fn(&SVector<f64, D>) -> [[f64; D]; D];

/// A method of a program.
pub struct Program {
    pub name: &'static str,
    pub method: &'static str,
    /// The state at the end for a tolerance, relative and absolute; nothing where the program gives up.
    pub run: Box<dyn Fn(f64) -> Option<Vec<f64>>>,
}

impl Program {
    pub fn new(name: &'static str, method: &'static str, run: impl Fn(f64) -> Option<Vec<f64>> + 'static) -> Self {
        Program { name, method, run: Box::new(run) }
    }
}

/// Explicit methods of every program.
pub fn explicit<F: Rates<D>, const D: usize>(problem: Problem<F, D>) -> Vec<Program> {
    vec![
        ode_solvers::dop853(problem),
        differential_equations::dop853(problem),
        russell::dopri8(problem),
        diffsol::tsit45(problem),
    ]
}

/// Implicit methods of every program that has one.
pub fn implicit<F: Rates<D>, const D: usize>(problem: Problem<F, D>, jacobian: Jacobian<D>) -> Vec<Program> {
    vec![
        differential_equations::radau5(problem, jacobian),
        russell::radau5(problem, jacobian),
        russell::radau5_threads(problem, jacobian),
        diffsol::bdf(problem, jacobian),
        diffsol::tr_bdf2(problem, jacobian),
        diffsol::esdirk34(problem, jacobian),
    ]
}

impl<F: Rates<D>, const D: usize> Problem<F, D> {
    /// The rates of a state that is a slice.
    fn rates(&self, y: &[f64], rate: &mut [f64]) {
        let mut rates = SVector::zeros();
        (self.f)(&SVector::from_column_slice(y), &mut rates);
        rate.copy_from_slice(rates.as_slice());
    }
}
