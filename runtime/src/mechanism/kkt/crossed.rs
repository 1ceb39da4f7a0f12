//! Places brought to the constraints by the constraints' forces at another place, as RATTLE does.

use std::mem::{replace, take};

use super::{KktSolver, add, weighted};
use crate::matrix::{factor_lu, solve_lu};
use crate::mechanism::{At, System};
use crate::mechanism::{substitute_back, substitute_forward};

impl KktSolver {
    /// Takes J at another place, J₁, and factors J₁ M⁻¹ J₀ᵀ, J₀ being that of [`KktSolver::factor`], of the rows that are kept there;
    /// false where it is singular or not finite.
    pub fn cross<S: System + ?Sized>(&mut self, system: &S, at: At<'_>) -> bool {
        let (n, m, rank) = (self.n, self.active.len(), self.rank);
        self.ahead.resize(m * n, 0.0);
        let here = replace(&mut self.rows, take(&mut self.ahead));
        self.load_rows(system, at);
        self.ahead = replace(&mut self.rows, here);
        for line in self.ahead.chunks_exact_mut(n.max(1)) {
            substitute_forward(&self.mass, line);
        }
        self.crossed.clear();
        for &k in &self.order[..rank] {
            for &l in &self.order[..rank] {
                let s = weighted(&self.mass, &self.ahead[k * n..][..n], &self.half[l * n..][..n]);
                self.crossed.push(s / (self.norms[k] * self.norms[l]));
            }
        }
        self.pivots.resize(rank, 0);
        factor_lu(&mut self.crossed, &mut self.pivots)
    }

    /// By how much multipliers change c'' of their active rows, at the most: Σ |J M⁻¹ Jᵀ| |λ|; both are of rows of the mechanism.
    pub fn held(&self, lambda: &[f64], changes: &mut [f64]) {
        let rows = || self.active.iter().zip(&self.norms);
        let sum: f64 = rows().map(|(row, norm)| norm * lambda[*row].abs()).sum();
        rows().for_each(|(row, norm)| changes[*row] = norm * sum);
    }

    /// Overwrites δ with M⁻¹ J₀ᵀ μ such that J₁ δ = g in the rows that are kept, after [`KktSolver::cross`]; g is of rows of the
    /// mechanism.
    pub fn steer(&mut self, g: impl Fn(usize) -> f64, delta: &mut [f64]) {
        let (n, rank) = (self.n, self.rank);
        let mu = &mut self.right[..rank];
        for (mu, &k) in mu.iter_mut().zip(&self.order) {
            *mu = g(self.active[k]) / self.norms[k];
        }
        solve_lu(&self.crossed, &self.pivots, mu);
        delta.fill(0.0);
        for (mu, &k) in mu.iter().zip(&self.order) {
            add(delta, mu / self.norms[k], &self.half[k * n..][..n]);
        }
        substitute_back(&self.mass, delta);
    }
}
