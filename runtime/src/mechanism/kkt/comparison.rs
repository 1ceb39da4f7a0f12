//! Other ways to accelerations than elimination, from the same M, J and γ: for comparison only, dense, with room of their own.

use nalgebra::{DMatrix, DVector};

use super::{KktSolver, Solutions, add, packed};
use crate::mechanism::{At, Singular, SingularMass, System};
use crate::mechanism::{factor_packed, substitute_back, substitute_forward};

impl KktSolver {
    /// The accelerations by the null space of J, and the multipliers that go with them; dense, for comparison only.
    ///
    /// # Errors
    /// M singular on the motions that the constraints leave.
    pub fn by_null_space<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        alpha: f64,
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let n = system.len();
        self.take(system, at);
        system.bias(at, &mut self.h);
        self.load_gamma(system, at, alpha, lambda);
        let rows = DMatrix::from_row_slice(self.active.len(), n, &self.rows);
        let right: Vec<f64> = self.gamma.iter().map(|gamma| -gamma).collect();
        let Solutions { particular, basis, independent, pivots } = Solutions::of(&rows, &right);
        let mass = DMatrix::from_fn(n, n, |i, j| self.mass[packed(i, j)]);
        let h = DVector::from_column_slice(&self.h);
        let reduced = basis.tr_mul(&mass) * &basis;
        let force = -basis.tr_mul(&(&mass * &particular + &h));
        let nothing = || SingularMass { coordinate: independent.first().copied().unwrap_or(0) };
        let free = reduced.cholesky().ok_or_else(nothing)?.solve(&force);
        let found = particular + basis * free;
        a.copy_from_slice(found.as_slice());
        // λ from the pivots' coordinates, where their rows are independent.
        let left = mass * found + h;
        let count = pivots.len();
        let transposed = DMatrix::from_fn(count, count, |i, k| rows[(pivots[k].0, pivots[i].1)]);
        let carried = DVector::from_fn(count, |i, _| left[pivots[i].1]);
        lambda.fill(0.0);
        if let Some(solved) = transposed.lu().solve(&carried) {
            pivots.iter().zip(solved.iter()).for_each(|((row, _), x)| lambda[self.active[*row]] = *x);
        }
        Ok(())
    }

    /// The accelerations with springs and dampers in the place of constraints, λ = −(k c + d c').
    ///
    /// # Errors
    /// M singular: what has no inertia of its own is held by constraints only.
    pub fn by_springs<S: System + ?Sized>(
        &mut self,
        system: &S,
        at: At<'_>,
        (stiffness, damping): (f64, f64),
        a: &mut [f64],
        lambda: &mut [f64],
    ) -> Result<(), Singular> {
        let n = system.len();
        self.take(system, at);
        factor_packed(&mut self.mass, n)?;
        system.bias(at, &mut self.h);
        a.iter_mut().zip(&self.h).for_each(|(a, h)| *a = -h);
        let mut triples = vec![0.0; 3 * system.description().rows.len()];
        system.constraints(at, &mut triples);
        lambda.fill(0.0);
        for (k, &row) in self.active.iter().enumerate() {
            let c = if system.description().rows[row].holonomic { triples[3 * row] } else { 0.0 };
            lambda[row] = -(stiffness * c + damping * triples[3 * row + 1]);
            add(a, lambda[row], &self.rows[k * n..][..n]);
        }
        let pattern = &system.description().friction_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.friction(at, &mut self.values);
        for ((coordinate, row), value) in pattern.iter().zip(&self.values) {
            a[*coordinate as usize] += value * lambda[*row as usize];
        }
        substitute_forward(&self.mass, a);
        substitute_back(&self.mass, a);
        Ok(())
    }
}
