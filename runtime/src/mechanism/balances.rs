//! Systems of momentum balances at work: A·[q''; reactions] = b, solved and judged.

use super::{At, Description, Singular, System};

/// Refuses a system of balances in a phase to which it does not belong: its equations do not hold there.
pub(super) fn belongs(mechanism: &Description, system: usize, phase: usize) -> Result<(), Singular> {
    let phases = mechanism.balances.get(system).map(|system| &system.phases);
    match phases.is_none_or(|phases| phases.is_empty() || phases.contains(&(phase as u32))) {
        true => Ok(()),
        false => Err(Singular::OtherPhase { system, phase }),
    }
}

/// One system of balances of a mechanism at one state after another; it allocates when it is made and never again.
///
/// The unknowns are the accelerations and the components of the reactions that the system names; rows are equations.
/// Nothing here comes from Lagrange's equations.
#[derive(Clone, Debug)]
pub struct Balances {
    system: usize,
    matrix: Vec<f64>,
    right: Vec<f64>,
    scratch: Vec<f64>,
    inverse: Vec<f64>,
    scales: Vec<f64>,
}

impl Balances {
    /// For the system of this index among `description().balances`; `None` if there is none.
    pub fn new<S: System + ?Sized>(mechanism: &S, system: usize) -> Option<Self> {
        let size = mechanism.description().balances.get(system)?.unknowns.len();
        Some(Balances {
            system,
            matrix: vec![0.0; size * size],
            right: vec![0.0; size],
            scratch: vec![0.0; size * size],
            inverse: vec![0.0; size * size],
            scales: vec![0.0; size],
        })
    }

    /// Evaluates A and b at a state.
    pub fn evaluate<S: System + ?Sized>(&mut self, mechanism: &S, at: At<'_>) {
        mechanism.balances(self.system, at, &mut self.matrix, &mut self.right);
    }

    /// How many equations and unknowns there are.
    pub fn size(&self) -> usize {
        self.right.len()
    }

    /// A, row by row.
    pub fn matrix(&self) -> &[f64] {
        &self.matrix
    }

    /// b.
    pub fn right(&self) -> &[f64] {
        &self.right
    }

    /// Writes the unknowns: accelerations, then reactions.
    ///
    /// # Errors
    /// [`Singular`]: A has no inverse here.
    ///
    /// # Panics
    /// If `unknowns` has another length than [`Balances::size`].
    pub fn solve(&mut self, unknowns: &mut [f64]) -> Result<(), Singular> {
        unknowns.copy_from_slice(&self.right);
        self.scratch.copy_from_slice(&self.matrix);
        solve_rows(&mut self.scratch, unknowns, &mut self.scales).map_err(|fault| fault.of(self.system))
    }

    /// 1/(‖A‖₁ ‖A⁻¹‖₁) of A with its rows, then its columns, divided by their largest entries; 0 where it is singular.
    ///
    /// The scaling takes out the units in which equations and unknowns happen to be written, so that newtons and
    /// radians per second squared can stand side by side (Higham, Accuracy and Stability of Numerical Algorithms,
    /// 2nd ed. 2002, §7.3).  Of sixteen digits a system loses about as many as 1/this has.
    pub fn reciprocal_condition(&mut self) -> f64 {
        let n = self.size();
        if n == 0 {
            return 1.0;
        }
        self.scratch.copy_from_slice(&self.matrix);
        for row in self.scratch.chunks_exact_mut(n) {
            let largest = row.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            row.iter_mut().for_each(|x| *x /= largest);
        }
        for j in 0..n {
            let largest = (0..n).fold(0.0_f64, |m, i| m.max(self.scratch[i * n + j].abs()));
            (0..n).for_each(|i| self.scratch[i * n + j] /= largest);
        }
        let norm = largest_column(&self.scratch, n);
        self.inverse.fill(0.0);
        self.inverse.iter_mut().step_by(n + 1).for_each(|x| *x = 1.0);
        if solve_rows(&mut self.scratch, &mut self.inverse, &mut self.scales).is_err() {
            return 0.0;
        }
        let reciprocal = 1.0 / (norm * largest_column(&self.inverse, n));
        if reciprocal.is_finite() { reciprocal } else { 0.0 }
    }
}

/// ‖·‖₁ of a matrix, row by row.
fn largest_column(matrix: &[f64], n: usize) -> f64 {
    let column = |j: usize| matrix.iter().skip(j).step_by(n).map(|x| x.abs()).sum::<f64>();
    (0..n).map(column).fold(0.0, f64::max)
}

/// Writes reactions where they are outputs as they stand.
pub(crate) fn put_reactions(pairs: &[(u32, u32)], unknowns: &[f64], outputs: &mut [f64]) {
    for &(output, unknown) in pairs {
        outputs[output as usize] = unknowns[unknown as usize];
    }
}

/// Where a system of equations is singular.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// This equation has no coefficients.
    Void(usize),
    /// This unknown is not determined.
    Undetermined(usize),
}

impl Fault {
    pub(super) fn of(self, system: usize) -> Singular {
        match self {
            Fault::Void(equation) => Singular::VoidBalance { system, equation },
            Fault::Undetermined(unknown) => Singular::Balances { system, unknown },
        }
    }
}

/// Overwrites B with A⁻¹B, and A with what is left of it: Gaussian elimination with partial pivoting of rows scaled to
/// a largest entry of 1.  A has as many rows as `scales` numbers, B as many columns as fit; both row by row.
///
/// Where numbers are not finite the result is not finite.
pub(super) fn solve_rows(a: &mut [f64], b: &mut [f64], scales: &mut [f64]) -> Result<(), Fault> {
    let n = scales.len();
    let width = b.len() / n.max(1);
    scales.fill(0.0);
    for i in 0..n {
        let row = &mut a[i * n..][..n];
        let largest = row.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        if largest == 0.0 && row.iter().all(|x| *x == 0.0) {
            return Err(Fault::Void(i));
        }
        let factor = 1.0 / largest;
        for (x, scale) in row.iter_mut().zip(scales.iter_mut()) {
            *x *= factor;
            *scale = scale.max(x.abs());
        }
        b[i * width..][..width].iter_mut().for_each(|x| *x *= factor);
    }
    for k in 0..n {
        let pivot = (k..n).fold(k, |best, i| if a[i * n + k].abs() > a[best * n + k].abs() { i } else { best });
        // What rounding leaves of a column that depends on those before.
        if a[pivot * n + k].abs() <= n as f64 * f64::EPSILON * scales[k] {
            return Err(Fault::Undetermined(k));
        }
        if pivot != k {
            (k..n).for_each(|j| a.swap(k * n + j, pivot * n + j));
            (0..width).for_each(|j| b.swap(k * width + j, pivot * width + j));
        }
        let (above, below) = a.split_at_mut((k + 1) * n);
        let (known, rest) = b.split_at_mut((k + 1) * width);
        let (top, top_right) = (&above[k * n..], &known[k * width..]);
        for (row, right) in below.chunks_exact_mut(n).zip(rest.chunks_exact_mut(width)) {
            let factor = row[k] / top[k];
            if factor != 0.0 {
                row[k + 1..].iter_mut().zip(&top[k + 1..]).for_each(|(x, y)| *x -= factor * y);
                right.iter_mut().zip(top_right).for_each(|(x, y)| *x -= factor * y);
            }
        }
    }
    for k in (0..n).rev() {
        let reciprocal = 1.0 / a[k * n + k];
        let (known, solved) = b.split_at_mut((k + 1) * width);
        let right = &mut known[k * width..];
        for (j, x) in (k + 1..n).zip(solved.chunks_exact(width)) {
            let factor = a[k * n + j];
            if factor != 0.0 {
                right.iter_mut().zip(x).for_each(|(r, x)| *r -= factor * x);
            }
        }
        right.iter_mut().for_each(|r| *r *= reciprocal);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_exchanged_and_their_scale_does_not_matter() {
        // x = (1, −2, 3); the first pivot is 0, the rows differ by twelve orders of magnitude.
        let mut a = [0.0, 2e6, 1e6, 1e-6, 1e-6, 0.0, 3.0, 0.0, 1.0];
        let mut b = [-1e6, -1e-6, 6.0];
        solve_rows(&mut a, &mut b, &mut [0.0; 3]).unwrap();
        for (x, expected) in b.iter().zip([1.0, -2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14, "{b:?}");
        }
    }

    #[test]
    fn a_singular_system_says_which_equation_or_unknown() {
        let solve = |mut a: [f64; 4]| solve_rows(&mut a, &mut [1.0, 1.0], &mut [0.0; 2]);
        assert_eq!(solve([1.0, 2.0, 0.0, 0.0]), Err(Fault::Void(1)));
        assert_eq!(solve([1.0, 2.0, 3.0, 6.0]), Err(Fault::Undetermined(1)));
        assert_eq!(solve([0.0, 2.0, 0.0, 6.0]), Err(Fault::Undetermined(0)));
        assert_eq!(solve([1.0, 2.0, 3.0, 6.1]), Ok(()));
        // A small unknown in large units is not a singular one.
        assert_eq!(solve([1.0, 1e-14, 1.0, 2e-14]), Ok(()));
    }

    #[test]
    fn what_is_not_finite_stays_not_finite() {
        let mut b = [1.0, 1.0];
        assert!(solve_rows(&mut [1.0, f64::NAN, 3.0, 1.0], &mut b, &mut [0.0; 2]).is_err() || b[0].is_nan());
    }
}
