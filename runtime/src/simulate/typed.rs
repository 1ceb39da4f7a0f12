//! What every mechanism that `model!` makes can do.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::builder::{Simulation, derivation, no_balances};
use crate::error::Error;
use crate::mechanism::{At, Balances, Dynamic, Mechanism, Singular, System};

/// Runs and single evaluations of a mechanism with N coordinates, on static sizes.
///
/// Dense matrices are for small N: they live on the stack.  In a loop, make the [`Dynamic`] once by
/// [`Simulate::system`] and use [`System`].
pub trait Simulate<const N: usize, const C: usize>: Mechanism<N, C> + 'static {
    /// The mechanism with its constants computed, behind slices.
    fn system(&self) -> Dynamic<Self, N, C> {
        Dynamic::new(self.clone())
    }

    /// Begins to describe a run.
    fn simulate(&self) -> Simulation<Dynamic<Self, N, C>> {
        Simulation::new(self.system())
    }

    /// M(t, q); NaN where states of first order are in masses.
    fn mass_matrix_at(&self, t: f64, q: &[f64; N]) -> SMatrix<f64, N, N> {
        let pattern = &Self::description().mass_pattern;
        let mut values = vec![0.0; pattern.len()];
        self.system().mass_matrix(At::place(t, q), &mut values);
        let mut matrix: SMatrix<f64, N, N> = scatter(pattern, &values);
        matrix.fill_upper_triangle_with_lower_triangle();
        matrix
    }

    /// h(t, q, q'), so that M q'' + h = 0.
    fn bias_at(&self, t: f64, q: &[f64; N], v: &[f64; N]) -> SVector<f64, N> {
        let mut h = SVector::<f64, N>::zeros();
        self.system().bias(At::new(t, q, v), h.as_mut_slice());
        h
    }

    /// q'' = −M⁻¹h.
    ///
    /// # Errors
    /// [`Singular`] names the coordinate whose pivot vanishes.
    fn accelerations_at(&self, t: f64, q: &[f64; N], v: &[f64; N]) -> Result<SVector<f64, N>, Singular> {
        let mut a = SVector::<f64, N>::zeros();
        self.system().accelerations(At::new(t, q, v), a.as_mut_slice())?;
        Ok(a)
    }

    /// A and b of a system of balances, so that A·[q''; reactions] = b; rows and columns are named by
    /// `description().balances`.
    ///
    /// # Errors
    /// [`Error::UnknownName`]: no system of balances has this name.
    fn balances_at(
        &self,
        name: &str,
        t: f64,
        q: &[f64; N],
        v: &[f64; N],
    ) -> Result<(DMatrix<f64>, DVector<f64>), Error> {
        let system = self.system();
        let index = derivation(system.description(), name)?;
        let Some(mut balances) = index.and_then(|index| Balances::new(&system, index)) else {
            return Err(no_balances(system.description(), name));
        };
        balances.evaluate(&system, At::new(t, q, v));
        let size = balances.size();
        Ok((DMatrix::from_row_slice(size, size, balances.matrix()), DVector::from_column_slice(balances.right())))
    }

    /// F(t, q, q', q'') = M q'' + h.
    fn residual_at(&self, t: f64, q: &[f64; N], v: &[f64; N], a: &[f64; N]) -> SVector<f64, N> {
        let mut f = SVector::<f64, N>::zeros();
        self.system().residual(At::new(t, q, v).accelerated(a), f.as_mut_slice());
        f
    }

    /// (∂F/∂q, ∂F/∂q').
    fn jacobians_at(
        &self,
        t: f64,
        q: &[f64; N],
        v: &[f64; N],
        a: &[f64; N],
    ) -> (SMatrix<f64, N, N>, SMatrix<f64, N, N>) {
        let description = Self::description();
        let mut dq = vec![0.0; description.stiffness_pattern.len()];
        let mut dv = vec![0.0; description.damping_pattern.len()];
        self.system().jacobians(At::new(t, q, v).accelerated(a), &mut dq, &mut dv);
        (scatter(&description.stiffness_pattern, &dq), scatter(&description.damping_pattern, &dv))
    }
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> Simulate<N, C> for M {}

fn scatter<const N: usize>(pattern: &[(u32, u32)], values: &[f64]) -> SMatrix<f64, N, N> {
    let mut matrix = SMatrix::zeros();
    for ((row, column), value) in pattern.iter().zip(values) {
        matrix[(*row as usize, *column as usize)] = *value;
    }
    matrix
}
