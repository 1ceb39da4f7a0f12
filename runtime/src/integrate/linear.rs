//! The linear systems of implicit methods, of the size of the accelerations.

use nalgebra::ComplexField;

use crate::matrix::{factor_lu, solve_lu};
use crate::mechanism::AccelerationSlopes;

/// P = 1 − τ ∂a/∂q' − τ² ∂a/∂q, factored: what is left of 1 − τ ∂(q', a)/∂(q, q') once places are eliminated.
///
/// τ = hμ for an eigenvalue μ of the method's coefficients, real or complex.
#[derive(Clone, Debug)]
pub(crate) struct Pencil<T> {
    n: usize,
    /// L below the diagonal, U on it and above, row by row.
    factors: Vec<T>,
    /// Which row was exchanged with this one.
    pivots: Vec<usize>,
}

impl<T: ComplexField<RealField = f64> + Copy> Pencil<T> {
    /// Room for n coordinates.
    pub fn new(n: usize) -> Self {
        Pencil { n, factors: vec![T::zero(); n * n], pivots: vec![0; n] }
    }

    /// Factors P; false where it is singular or not finite.
    pub fn factor(&mut self, slopes: &AccelerationSlopes, tau: T) -> bool {
        let n = self.n;
        let (places, speeds) = (slopes.by_place(), slopes.by_speed());
        for (k, p) in self.factors.iter_mut().enumerate() {
            let unit = if k % (n + 1) == 0 { T::one() } else { T::zero() };
            *p = unit - tau * (T::from_real(speeds[k]) + tau * T::from_real(places[k]));
        }
        factor_lu(&mut self.factors, &mut self.pivots)
    }

    /// x becomes P⁻¹ x.
    pub fn solve(&self, x: &mut [T]) {
        solve_lu(&self.factors, &self.pivots, x);
    }
}

impl Pencil<f64> {
    /// Overwrites [x; w] with (1 − τ ∂(q', a)/∂(q, q'))⁻¹ [x; w], P being factored for τ.
    pub fn solve_pair(&self, slopes: &AccelerationSlopes, tau: f64, pair: &mut [f64]) {
        let (places, speeds) = pair.split_at_mut(self.n);
        slopes.add_by_place(tau, places, speeds);
        self.solve(speeds);
        places.iter_mut().zip(speeds.iter()).for_each(|(x, w)| *x += tau * w);
    }
}
