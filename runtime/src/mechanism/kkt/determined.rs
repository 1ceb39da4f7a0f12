//! Accelerations that the rows determine by themselves: without the rounding of forces, which a block that sticks would otherwise be moved by.

use super::KktSolver;
use crate::matrix::{factor_lu, solve_lu};

impl KktSolver {
    /// Puts J a = −γ in the place of accelerations that kept rows determine: one after the other where a row has one unknown left, or all
    /// where there are as many rows as coordinates.  Forces cancel in them but for their rounding.
    pub(super) fn determine(&self, a: &mut [f64]) {
        let n = self.n;
        let kept = &self.order[..self.rank];
        let mut known = vec![false; n];
        let mut left: Vec<usize> = kept.to_vec();
        while let Some(place) = left.iter().position(|k| self.unknown(*k, &known).is_some()) {
            let k = left.swap_remove(place);
            let Some(i) = self.unknown(k, &known) else { break };
            let row = &self.rows[k * n..][..n];
            let others: f64 = (0..n).filter(|j| *j != i && row[*j] != 0.0).map(|j| row[j] * a[j]).sum();
            a[i] = -(self.gamma[k] + others) / row[i];
            known[i] = true;
        }
        if kept.len() == n && !left.is_empty() {
            let mut matrix: Vec<f64> = kept.iter().flat_map(|k| self.rows[k * n..][..n].iter().copied()).collect();
            let mut pivots = vec![0; n];
            let mut right: Vec<f64> = kept.iter().map(|k| -self.gamma[*k]).collect();
            if factor_lu(&mut matrix, &mut pivots) {
                solve_lu(&matrix, &pivots, &mut right);
                a.copy_from_slice(&right);
            }
        }
    }

    /// The one coordinate of a row whose acceleration is not known; `None` where there are none or several.
    fn unknown(&self, k: usize, known: &[bool]) -> Option<usize> {
        let row = &self.rows[k * self.n..][..self.n];
        let mut unknown = (0..self.n).filter(|i| row[*i] != 0.0 && !known[*i]);
        let first = unknown.next()?;
        unknown.next().is_none().then_some(first)
    }
}
