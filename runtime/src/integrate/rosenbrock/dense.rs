//! Dense output of a Rosenbrock method.

use super::step::Rosenbrock;

impl Rosenbrock {
    /// y + θ(Δ + (1−θ)(k₁ + θ(k₂ + θ k₃))), in the nested form that [`crate::integrate::Segment`] evaluates: the last θ is
    /// 1 − (1−θ).
    pub(super) fn write_dense(&mut self) {
        let width = 2 * self.ends.n;
        for j in 0..width {
            let [k1, k2, k3] =
                self.tableau.dense.map(|line| line.iter().zip(&self.stages).map(|(d, u)| d * u[j]).sum());
            let pieces = [self.ends.y[j], self.ends.end[j] - self.ends.y[j], k1, k2 + k3, -k3];
            pieces.iter().enumerate().for_each(|(k, piece): (usize, &f64)| self.pieces[k * width + j] = *piece);
        }
    }
}
