//! The linear systems of implicit methods, of the size of the accelerations.

use nalgebra::ComplexField;

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
        (0..n).all(|k| self.eliminate(k))
    }

    /// Gauss's elimination of a column, with the largest element of it as the pivot.
    fn eliminate(&mut self, k: usize) -> bool {
        let n = self.n;
        let size = |factors: &[T], i: usize| factors[i * n + k].norm1();
        let best = (k..n).fold(k, |best, i| if size(&self.factors, i) > size(&self.factors, best) { i } else { best });
        self.pivots[k] = best;
        if best != k {
            (0..n).for_each(|j| self.factors.swap(k * n + j, best * n + j));
        }
        let pivot = self.factors[k * n + k];
        if !(pivot.norm1() > 0.0 && pivot.is_finite()) {
            return false;
        }
        let (above, below) = self.factors.split_at_mut((k + 1) * n);
        let line = &above[k * n..];
        for row in below.chunks_exact_mut(n) {
            let factor = row[k] / pivot;
            row[k] = factor;
            if factor != T::zero() {
                row[k + 1..].iter_mut().zip(&line[k + 1..]).for_each(|(x, y)| *x -= factor * *y);
            }
        }
        true
    }

    /// x becomes P⁻¹ x.
    pub fn solve(&self, x: &mut [T]) {
        let n = self.n;
        for k in 0..n {
            x.swap(k, self.pivots[k]);
        }
        for i in 1..n {
            let sum = (0..i).fold(x[i], |sum, j| sum - self.factors[i * n + j] * x[j]);
            x[i] = sum;
        }
        for i in (0..n).rev() {
            let sum = (i + 1..n).fold(x[i], |sum, j| sum - self.factors[i * n + j] * x[j]);
            x[i] = sum / self.factors[i * n + i];
        }
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

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    #[test]
    fn factors_solve_with_exchanged_rows() {
        let mut pencil = Pencil::new(3);
        let matrix = [0.0, 2.0, 1.0, 4.0, 1.0, 0.0, 2.0, 3.0, 5.0].map(|x| Complex::new(x, 0.5 * x * x));
        pencil.factors.copy_from_slice(&matrix);
        assert!((0..3).all(|k| pencil.eliminate(k)));
        let expected = [Complex::new(1.0, -1.0), Complex::new(0.5, 2.0), Complex::new(-3.0, 0.0)];
        let mut x: Vec<Complex<f64>> =
            matrix.chunks(3).map(|row| row.iter().zip(&expected).map(|(a, x)| a * x).sum()).collect();
        pencil.solve(&mut x);
        assert!(x.iter().zip(&expected).all(|(x, expected)| (x - expected).norm() < 1e-13), "{x:?}");
    }
}
