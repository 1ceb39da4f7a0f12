//! Which rows count, and solutions with those that do.

use super::shares::Shares;
use super::{KktSolver, weighted, wrong};
use crate::mechanism::Singular;
use crate::mechanism::phased::RowHistory;

/// A row whose pivot, its distance from the rows before it, is below this part of its largest norm is left out, where rows have been independent.
const WEAK: f64 = 1e-3;
/// Rows are independent that are further than this from depending on each other: on the way to a singular position all of them are.
const INDEPENDENT: f64 = 0.01;
/// Rows that never were independent, as of guides under a small angle, are left out below this: of forces along them rounding leaves nothing.
const DEPENDENT: f64 = 1e-6;
/// A row that keeps less than this of its largest norm, and is soon left out, is asked for its entries.
const FADED: f64 = 0.01;
/// An entry that was never larger than this part of the largest of its row may be what errors of the motion make of 0, and does not keep the row from
/// vanishing.
const ERROR: f64 = 1e-4;
/// With more rows than this ordinary pivots are smaller: a straight chain of m rods has 1.1/m.
const MANY: f64 = 8.0;
/// Friction that leaves this part of a pivot, or less, lets the reaction grow without bound.
const PAINLEVE: f64 = 1e-9;

impl KktSolver {
    /// The rows that are kept, in the order of their pivots, among all rows of the mechanism.
    pub fn kept(&self) -> impl Iterator<Item = usize> + '_ {
        self.order[..self.rank].iter().map(|k| self.active[*k])
    }

    /// Rows that were chosen after so many others, in the order of the mechanism's.
    pub fn chosen_after(&self, count: usize) -> Vec<usize> {
        let mut rows: Vec<usize> = self.order.iter().skip(count).map(|k| self.active[*k]).collect();
        rows.sort_unstable();
        rows
    }

    /// The rows that were chosen first, so many, in the order of the mechanism's.
    pub fn chosen_first(&self, count: usize) -> Vec<usize> {
        let mut rows: Vec<usize> = self.order.iter().take(count).map(|k| self.active[*k]).collect();
        rows.sort_unstable();
        rows
    }

    /// What the rows in force keep of their largest norms.
    pub(super) fn lengths(&self) -> Vec<f64> {
        let norm = |k: usize| {
            let half = &self.half[k * self.n..][..self.n];
            weighted(&self.mass, half, half).sqrt()
        };
        self.norms.iter().enumerate().map(|(k, largest)| if *largest > 0.0 { norm(k) / largest } else { 0.0 }).collect()
    }

    /// The least pivot of the first so many rows, or that of the first row that was left out.
    pub(super) fn distance(&self, usual: usize) -> f64 {
        let m = self.active.len();
        if self.rank < usual {
            return self.weakest;
        }
        (0..usual).map(|k| self.schur[k * m + k]).fold(1.0, f64::min)
    }

    /// Which part of its largest norm a row has kept, this one and the largest before being given; of an entry of J that has become no smaller all.
    fn kept_of(&self, k: usize, (norm, largest): (f64, f64), entries: &[f64]) -> f64 {
        let kept = if largest > norm { norm / largest } else { 1.0 };
        if kept > FADED {
            return kept;
        }
        let known = || entries.iter().skip(self.active[k] * self.n).take(self.n);
        let nothing = ERROR * known().fold(0.0_f64, |most, entry| most.max(*entry));
        let of_entries = self.rows[k * self.n..][..self.n].iter().zip(known()).filter(|(_, most)| **most > nothing);
        of_entries.map(|(entry, largest)| (entry.abs() / largest).min(1.0)).fold(kept, f64::max)
    }

    /// Whether so many rows are clearly independent.
    pub fn are_independent(&self, count: usize) -> bool {
        self.rank >= count && self.distance(count) > INDEPENDENT * many(self.active.len())
    }

    /// S = J M⁻¹ Jᵀ, wrong by so many half units in the last place.
    pub(super) fn multiply_rows(&mut self, disturbance: f64) {
        let (n, m) = (self.n, self.active.len());
        for k in 0..m {
            for l in 0..=k {
                let s = weighted(&self.mass, &self.half[k * n..][..n], &self.half[l * n..][..n]);
                let s = wrong(s, k + l, disturbance);
                self.schur[k * m + l] = s;
                self.schur[l * m + k] = s;
            }
        }
    }

    /// Pivoted Cholesky of S, scaled by the largest norms before, or such that rows have these lengths; the pivots of some rows are
    /// chosen last.  So many rows are known to be independent elsewhere.
    pub(super) fn choose_rows(&mut self, history: &RowHistory, lengths: Option<&[f64]>, known: usize) {
        let m = self.active.len();
        for k in 0..m {
            let norm = self.schur[k * m + k].max(0.0).sqrt();
            let largest = history.norms.get(self.active[k]).copied().unwrap_or(0.0);
            self.norms[k] = match lengths.map(|lengths| lengths[k]) {
                None if norm > 0.0 => norm / self.kept_of(k, (norm, largest), &history.entries),
                None => largest,
                Some(length) if length > 0.0 => norm / length,
                Some(_) => 0.0,
            };
        }
        let scale = |k: usize| if self.norms[k] > 0.0 { 1.0 / self.norms[k] } else { 0.0 };
        for k in 0..m {
            for l in 0..m {
                self.schur[k * m + l] *= scale(k) * scale(l);
            }
        }
        self.order.clear();
        self.order.extend(0..m);
        (self.rank, self.weakest) = (m, 1.0);
        for k in 0..m {
            let weak = if k < known && !history.independent { DEPENDENT } else { WEAK } * many(m);
            let size = |place: usize| self.schur[place * m + place].max(0.0).sqrt();
            // What presses is chosen before what sticks, which may be shared otherwise.
            let turn = |place: usize| match self.order[place] {
                _ if size(place) <= weak => 0,
                row if self.along[row] => 1,
                row if history.last.contains(&self.active[row]) => 2,
                _ => 3,
            };
            let rated = |place: usize| (turn(place), size(place));
            let better = |a: &usize, b: &usize| {
                let (a, b) = (rated(*a), rated(*b));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
            };
            let best = (k..m).max_by(better).unwrap_or(k);
            let size = size(best);
            self.weakest = self.weakest.min(size);
            if size.is_nan() || size <= weak {
                self.rank = k;
                break;
            }
            exchange(&mut self.schur, m, k, best);
            self.order.swap(k, best);
            let reciprocal = 1.0 / size;
            self.schur[k * m + k] = size;
            for i in k + 1..m {
                self.schur[i * m + k] *= reciprocal;
            }
            for i in k + 1..m {
                let factor = self.schur[i * m + k];
                for j in k + 1..=i {
                    let change = factor * self.schur[j * m + k];
                    self.schur[i * m + j] -= change;
                    if i != j {
                        self.schur[j * m + i] = self.schur[i * m + j];
                    }
                }
            }
        }
    }

    /// S x = b with the rows that were kept, in place.
    pub(super) fn cholesky_solve(&mut self, b: &mut [f64]) {
        let m = b.len();
        let (rank, y) = (self.rank, &mut self.right);
        for (i, &row) in self.order[..rank].iter().enumerate() {
            let known: f64 = (0..i).map(|j| self.schur[i * m + j] * y[j]).sum();
            y[i] = (b[row] / self.norms[row] - known) / self.schur[i * m + i];
        }
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..rank).map(|j| self.schur[j * m + i] * y[j]).sum();
            y[i] = (y[i] - known) / self.schur[i * m + i];
        }
        b.fill(0.0);
        for (y, &row) in y.iter().zip(&self.order[..rank]) {
            b[row] = y / self.norms[row];
        }
    }

    /// J M⁻¹ (Jᵀ + B) x = b with the rows that were kept, in their order, or with all that share a force: every pivot must stay beside that without
    /// friction.
    pub(super) fn rub(&mut self, shares: Option<&Shares>, b: &mut [f64]) -> Result<(), Singular> {
        let (n, m, rank) = (self.n, self.active.len(), self.rank);
        let counted = if shares.is_some() { m } else { rank };
        let mut rubbed = std::mem::take(&mut self.rubbed);
        rubbed.clear();
        for &k in &self.order[..rank] {
            let scaled = |l: usize| {
                let s = weighted(&self.mass, &self.half[k * n..][..n], &self.pushed[l * n..][..n]);
                if self.norms[l] > 0.0 { s / (self.norms[k] * self.norms[l]) } else { 0.0 }
            };
            let start = rubbed.len();
            rubbed.extend(self.order[..counted].iter().map(|l| scaled(*l)));
            if let Some(shares) = shares {
                shares.of_kept(&mut rubbed[start..]);
                rubbed.truncate(start + rank);
            }
        }
        self.rubbed = rubbed;
        let x = &mut self.right;
        for (i, &row) in self.order[..rank].iter().enumerate() {
            x[i] = b[row] / self.norms[row];
        }
        for i in 0..rank {
            let (pivot, without) = (self.rubbed[i * rank + i], self.schur[i * m + i].powi(2));
            if pivot.is_nan() || pivot <= PAINLEVE * without {
                b.fill(0.0);
                return Err(Singular::Friction { row: self.active[self.order[i]] });
            }
            for k in i + 1..rank {
                let factor = self.rubbed[k * rank + i] / pivot;
                for l in i + 1..rank {
                    self.rubbed[k * rank + l] -= factor * self.rubbed[i * rank + l];
                }
                x[k] -= factor * x[i];
            }
        }
        for i in (0..rank).rev() {
            let known: f64 = (i + 1..rank).map(|k| self.rubbed[i * rank + k] * x[k]).sum();
            x[i] = (x[i] - known) / self.rubbed[i * rank + i];
        }
        b.fill(0.0);
        x[rank..m].fill(0.0);
        if let Some(shares) = shares {
            shares.share(&mut x[..m]);
        }
        for (x, &row) in x.iter().zip(&self.order) {
            b[row] = if self.norms[row] > 0.0 { x / self.norms[row] } else { 0.0 };
        }
        Ok(())
    }
}

/// Which part of usual pivots those of so many rows have.
fn many(rows: usize) -> f64 {
    (MANY / rows.max(1) as f64).min(1.0)
}

/// Exchanges two rows and columns of a symmetric matrix, and what is factored already of their rows.
fn exchange(matrix: &mut [f64], m: usize, k: usize, l: usize) {
    if k != l {
        (0..m).for_each(|c| matrix.swap(k * m + c, l * m + c));
        (0..m).for_each(|r| matrix.swap(r * m + k, r * m + l));
    }
}
