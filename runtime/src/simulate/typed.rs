//! What every mechanism that `model!` makes can do.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::builder::{Simulation, derivation, no_balances};
use crate::error::Error;
use crate::mechanism::{At, Balances, Dynamic, Mechanism, Singular, System, choose_sides};

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

    /// M(t, q), of a state at rest; NaN where states of first order are in masses.
    fn mass_matrix_at(&self, t: f64, q: &[f64; N]) -> SMatrix<f64, N, N> {
        let pattern = &Self::description().mass_pattern;
        let mut values = vec![f64::NAN; pattern.len()];
        if let Ok(system) = on_sides(self, t, q, &[0.0; N]) {
            system.mass_matrix(At::place(t, q), &mut values);
        }
        let mut matrix: SMatrix<f64, N, N> = scatter(pattern, &values);
        matrix.fill_upper_triangle_with_lower_triangle();
        matrix
    }

    /// h(t, q, q'), so that M q'' + h = 0, on the sides of discontinuities where the state is; NaN where these cannot be told.
    fn bias_at(&self, t: f64, q: &[f64; N], v: &[f64; N]) -> SVector<f64, N> {
        let mut h = SVector::<f64, N>::from_element(f64::NAN);
        if let Ok(system) = on_sides(self, t, q, v) {
            system.bias(At::new(t, q, v), h.as_mut_slice());
        }
        h
    }

    /// q'' = −M⁻¹h, on the sides of discontinuities where the state is (on its surface `sign` is 0), in the file's first phase, and without what
    /// constraints and contacts make of it: a run knows all of these.
    ///
    /// # Errors
    /// [`Singular`] names the coordinate whose pivot vanishes.
    fn accelerations_at(&self, t: f64, q: &[f64; N], v: &[f64; N]) -> Result<SVector<f64, N>, Singular> {
        let mut a = SVector::<f64, N>::zeros();
        on_sides(self, t, q, v)?.accelerations(At::new(t, q, v), a.as_mut_slice())?;
        Ok(a)
    }

    /// A and b of a system of balances, so that A·[q''; reactions] = b; rows and columns are named by
    /// `description().balances`; on the sides of discontinuities where the state is, NaN where these cannot be told.
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
        let index = derivation(Self::description(), name)?;
        let sides = on_sides(self, t, q, v);
        let unknown = if sides.is_err() { f64::NAN } else { 0.0 };
        let system = sides.unwrap_or_else(|_| self.system());
        let Some(mut balances) = index.and_then(|index| Balances::new(&system, index)) else {
            return Err(no_balances(system.description(), name));
        };
        balances.evaluate(&system, At::new(t, q, v));
        let size = balances.size();
        let matrix = DMatrix::from_row_slice(size, size, balances.matrix());
        Ok((matrix.add_scalar(unknown), DVector::from_column_slice(balances.right()).add_scalar(unknown)))
    }

    /// F(t, q, q', q'') = M q'' + h, on the sides of discontinuities where the state is; NaN where these cannot be told.
    fn residual_at(&self, t: f64, q: &[f64; N], v: &[f64; N], a: &[f64; N]) -> SVector<f64, N> {
        let mut f = SVector::<f64, N>::from_element(f64::NAN);
        if let Ok(system) = on_sides(self, t, q, v) {
            system.residual(At::new(t, q, v).accelerated(a), f.as_mut_slice());
        }
        f
    }

    /// (∂F/∂q, ∂F/∂q') on the sides of discontinuities where the state is; NaN where these cannot be told.
    fn jacobians_at(
        &self,
        t: f64,
        q: &[f64; N],
        v: &[f64; N],
        a: &[f64; N],
    ) -> (SMatrix<f64, N, N>, SMatrix<f64, N, N>) {
        let description = Self::description();
        let mut dq = vec![f64::NAN; description.stiffness_pattern.len()];
        let mut dv = vec![f64::NAN; description.damping_pattern.len()];
        if let Ok(system) = on_sides(self, t, q, v) {
            system.jacobians(At::new(t, q, v).accelerated(a), &mut dq, &mut dv);
        }
        (scatter(&description.stiffness_pattern, &dq), scatter(&description.damping_pattern, &dv))
    }
}

/// A mechanism on the sides of its discontinuities where a state is.
fn on_sides<M, const N: usize, const C: usize>(
    mechanism: &M,
    t: f64,
    q: &[f64; N],
    v: &[f64; N],
) -> Result<Dynamic<M, N, C>, Singular>
where
    M: Simulate<N, C>,
{
    let mut system = mechanism.system();
    choose_sides(&mut system, t, &[q.as_slice(), v.as_slice()].concat())?;
    Ok(system)
}

impl<M: Mechanism<N, C> + 'static, const N: usize, const C: usize> Simulate<N, C> for M {}

fn scatter<const N: usize>(pattern: &[(u32, u32)], values: &[f64]) -> SMatrix<f64, N, N> {
    let mut matrix = SMatrix::zeros();
    for ((row, column), value) in pattern.iter().zip(values) {
        matrix[(*row as usize, *column as usize)] = *value;
    }
    matrix
}
