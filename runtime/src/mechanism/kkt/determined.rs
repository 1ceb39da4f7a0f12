//! Accelerations that the rows determine by themselves: without the rounding of forces, which a block that sticks would otherwise be moved by.

use super::KktSolver;
use crate::matrix::{factor_lu, solve_lu};

impl KktSolver {
    /// Puts J a = −γ in the place of accelerations that kept rows determine: one after the other where a row has one unknown left, or all
    /// where there are as many rows as coordinates.  Forces cancel in them but for their rounding.
    pub(super) fn determine(&mut self, a: &mut [f64]) {
        let (n, kept) = (self.n, self.rank);
        self.known.clear();
        self.known.resize(n, false);
        let mut left = kept;
        // What a row determines may leave one unknown in another.
        let mut goes_on = true;
        while goes_on {
            goes_on = false;
            for &k in &self.order[..kept] {
                let row = &self.rows[k * n..][..n];
                let mut unknown = (0..n).filter(|i| row[*i] != 0.0 && !self.known[*i]);
                let (Some(i), None) = (unknown.next(), unknown.next()) else { continue };
                let others: f64 = (0..n).filter(|j| *j != i && row[*j] != 0.0).map(|j| row[j] * a[j]).sum();
                a[i] = -(self.gamma[k] + others) / row[i];
                self.known[i] = true;
                left -= 1;
                goes_on = true;
            }
        }
        if kept < n || left == 0 {
            return;
        }
        self.square.clear();
        self.determined.clear();
        for &k in &self.order[..kept] {
            self.square.extend_from_slice(&self.rows[k * n..][..n]);
            self.determined.push(-self.gamma[k]);
        }
        self.exchanged.clear();
        self.exchanged.resize(n, 0);
        if factor_lu(&mut self.square, &mut self.exchanged) {
            solve_lu(&self.square, &self.exchanged, &mut self.determined);
            a.copy_from_slice(&self.determined);
        }
    }
}
