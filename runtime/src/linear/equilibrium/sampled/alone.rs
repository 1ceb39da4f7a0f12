//! Motions of a sampled loop whose |z| is 1 whatever the period: nothing damps them, and ticks do not see them, or do not move them.
//!
//! With x' = F x between ticks and x ↦ J x at them, a vector u with F u = λ u and J u = u for every J gives z = e^(λT), and so does a row w with
//! w F = λ w and w J = w (Popov, Belevitch and Hautus).  Across u, and across w, the others obey equations of their own.

use nalgebra::{Complex, DMatrix};

use super::Flow;
use crate::linear::matrices::{Eigen, Scaled, balanced};
use crate::linear::modes::kernel;
use crate::matrix::svd;

/// F, and J − 1 of every J, in scaled variables.
struct Changes {
    field: DMatrix<f64>,
    changes: Vec<DMatrix<f64>>,
}

/// Directions, and their eigenvalues of F.
type Alone = (DMatrix<f64>, Vec<Complex<f64>>);

impl Flow {
    /// What is left without motions that nothing damps and that ticks leave alone, and the exponents λ of these, 0 or ±iω; `None` where
    /// a decomposition does not end.
    pub fn without_alone(&self) -> Option<(Flow, Vec<Complex<f64>>)> {
        let n = self.field.nrows();
        let one = DMatrix::identity(n, n);
        let mut changes: Vec<DMatrix<f64>> = Vec::new();
        for change in self.jumps.iter().map(|jump| jump - &one) {
            if !changes.contains(&change) {
                changes.push(change);
            }
        }
        let sizes = changes.iter().fold(self.field.abs(), |sum, change| sum + change.abs());
        let (_, scales) = balanced(&sizes);
        let scaled = |matrix: &DMatrix<f64>| DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] * (scales[j] / scales[i]));
        let whole = Changes { field: scaled(&self.field), changes: changes.iter().map(scaled).collect() };
        let (mut left, mut basis, mut found) = (whole.within(&one), one, Vec::new());
        while left.field.nrows() > 0 {
            let unseen = left.unseen()?;
            let alone = if unseen.is_some() { unseen } else { left.transposed().unseen()? };
            let Some((directions, exponents)) = alone else { break };
            // What is rounding beside unit length is 0, or ranks would count it.
            let rounding = Scaled::threshold(n, 1.0);
            basis = (basis * across(&directions)).map(|x| if x.abs() <= rounding { 0.0 } else { x });
            left = whole.within(&basis);
            found.extend(exponents);
        }
        if found.is_empty() {
            return Some((self.clone(), found));
        }
        let jumps = self.jumps.iter().map(|jump| basis.transpose() * scaled(jump) * &basis).collect();
        Some((Flow { field: left.field, jumps, turning: self.turning }, found))
    }
}

impl Changes {
    fn within(&self, basis: &DMatrix<f64>) -> Changes {
        let rounding = Scaled::threshold(basis.nrows(), 1.0);
        let within = |matrix: &DMatrix<f64>| {
            let terms = basis.abs().transpose() * matrix.abs() * basis.abs();
            let found = basis.transpose() * matrix * basis;
            found.zip_map(&terms, |x, terms| if x.abs() <= rounding * terms { 0.0 } else { x })
        };
        Changes { field: within(&self.field), changes: self.changes.iter().map(within).collect() }
    }

    fn transposed(&self) -> Changes {
        Changes { field: self.field.transpose(), changes: self.changes.iter().map(DMatrix::transpose).collect() }
    }

    /// Directions of eigenvectors of F without damping in which no J changes anything, and their eigenvalues; `None` in them where there are none.
    fn unseen(&self) -> Option<Option<Alone>> {
        let n = self.field.nrows();
        let still = kernel(&self.field).ok()?;
        let kept = self.left_alone(&still.map(Complex::from), 1.0)?;
        if kept.ncols() > 0 {
            let exponents = vec![Complex::ZERO; kept.ncols()];
            return Some(Some((kept.map(|x| x.re), exponents)));
        }
        let eigen = Eigen::of(&self.field)?;
        let condition = eigen.condition().min(f64::EPSILON.sqrt().recip());
        let error = Scaled::threshold(n, self.field.norm()) * condition;
        for value in eigen.values.iter().filter(|value| value.im > error && value.re.abs() <= error) {
            let alike: Vec<usize> = (0..n).filter(|k| (eigen.values[*k] - value).norm() <= error).collect();
            let kept = self.left_alone(&eigen.vectors.select_columns(&alike), condition)?;
            if kept.ncols() > 0 {
                let both = DMatrix::from_fn(n, 2 * kept.ncols(), |i, k| match k.checked_sub(kept.ncols()) {
                    None => kept[(i, k)].re,
                    Some(k) => kept[(i, k)].im,
                });
                let exponent = Complex::new(0.0, value.im);
                let exponents = (0..kept.ncols()).flat_map(|_| [exponent, exponent.conj()]).collect();
                return Some(Some((both, exponents)));
            }
        }
        Some(None)
    }

    /// The sums of these directions, known with this condition, that no J changes.
    fn left_alone(&self, directions: &DMatrix<Complex<f64>>, condition: f64) -> Option<DMatrix<Complex<f64>>> {
        let (n, m) = directions.shape();
        if m == 0 {
            return Some(directions.clone());
        }
        let mut rows = DMatrix::zeros(n * self.changes.len(), m);
        for (k, change) in self.changes.iter().enumerate() {
            // Directions of unit length, of which parts that should be 0 are rounding.
            let changed = change.map(Complex::from) * directions;
            for i in 0..n {
                let most = change.row(i).abs().sum();
                if most > 0.0 {
                    rows.set_row(k * n + i, &(changed.row(i) / Complex::from(most)));
                }
            }
        }
        let found = svd(rows, false, true)?;
        let nothing = Scaled::threshold(n, 1.0) * condition;
        let kept: Vec<usize> = (0..m).filter(|k| found.singular_values[*k] <= nothing).collect();
        Some(directions * found.v_t?.select_rows(&kept).adjoint())
    }
}

/// An orthonormal basis of what is across some directions.
fn across(directions: &DMatrix<f64>) -> DMatrix<f64> {
    let (n, m) = directions.shape();
    // Reflections, which leave alone what has nothing to do with the directions.
    let q = directions.clone().resize_horizontally(n, 0.0).qr().q();
    q.columns(m, n - m).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two alike vibrations of 3 rad/s, of which ticks see and move the sum only, a free mass that they do not see, and a held value.
    #[test]
    fn what_ticks_leave_alone_is_found_in_sums_too() {
        let mut field = DMatrix::zeros(7, 7);
        for i in 0..3 {
            field[(i, 3 + i)] = 1.0;
        }
        for i in 0..2 {
            (field[(3 + i, i)], field[(3 + i, 6)]) = (-9.0, 1.0);
        }
        let mut jump = DMatrix::identity(7, 7);
        jump.row_mut(6).copy_from_slice(&[0.0; 7]);
        (jump[(6, 0)], jump[(6, 1)]) = (0.3, 0.3);
        let flow = Flow { field, jumps: vec![jump.clone(), jump], turning: 3.0 };
        let (rest, alone) = flow.without_alone().unwrap();
        assert_eq!((rest.field.nrows(), alone.len()), (3, 4));
        assert_eq!(alone.iter().filter(|value| **value == Complex::ZERO).count(), 2);
        assert!(alone.iter().any(|value| (value - Complex::new(0.0, 3.0)).norm() < 1e-14), "{alone:?}");
        // Another law sees the difference, too.
        let mut all = flow.jumps[0].clone();
        all[(6, 1)] = 0.2;
        assert_eq!(Flow { jumps: vec![all], ..flow.clone() }.without_alone().unwrap().1.len(), 4, "moves the sum only");
    }
}
