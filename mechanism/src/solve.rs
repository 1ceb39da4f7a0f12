//! Solving M a = f where M is too large to be factored by straight-line code.

use super::Real;

/// M has no inverse: this coordinate's pivot vanishes to rounding, or is not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SingularMass {
    /// Index of the coordinate.
    pub coordinate: usize,
}

/// Overwrites f with M⁻¹(−f): LDLᵀ of the packed lower triangle `m` (row by row, n(n+1)/2 numbers), in place.
///
/// # Errors
/// [`SingularMass`] where a pivot vanishes beside M's diagonal, or is not finite.
pub fn solve_packed<S: Real, const N: usize>(m: &mut [S], f: &mut [S; N]) -> Result<(), SingularMass> {
    solve_packed_slice(m, f)
}

/// As [`solve_packed`], of a size that is not known when compiling.
///
/// # Errors
/// [`SingularMass`] where a pivot vanishes beside M's diagonal, or is not finite.
#[inline]
pub fn solve_packed_slice<S: Real>(m: &mut [S], f: &mut [S]) -> Result<(), SingularMass> {
    factor_packed(m, f.len())?;
    f.iter_mut().for_each(|f| *f = -*f);
    substitute_forward(m, f);
    substitute_back(m, f);
    Ok(())
}

/// L D Lᵀ of a packed lower triangle, in place: L below the diagonal, the reciprocals of D on it.
///
/// # Errors
/// [`SingularMass`] where a pivot vanishes beside M's diagonal, or is not finite.
#[inline]
pub fn factor_packed<S: Real>(m: &mut [S], size: usize) -> Result<(), SingularMass> {
    let row = |i: usize| i * (i + 1) / 2;
    for i in 0..size {
        let diagonal = m[row(i) + i];
        // L_ij d_j for j < i, then L_ij, then the pivot d_i.
        for j in 0..i {
            let mut sum = m[row(i) + j];
            for k in 0..j {
                sum = sum - m[row(i) + k] * m[row(j) + k];
            }
            m[row(i) + j] = sum;
        }
        let mut pivot = diagonal;
        for j in 0..i {
            let scaled = m[row(i) + j];
            let factor = scaled * m[row(j) + j];
            pivot = pivot - factor * scaled;
            m[row(i) + j] = factor;
        }
        if !pivot.abs().exceeds(diagonal.abs() * S::pivot_floor()) {
            return Err(SingularMass { coordinate: i });
        }
        m[row(i) + i] = S::ratio(1.0, 1.0) / pivot;
    }
    Ok(())
}

/// f becomes L⁻¹ f.
#[inline]
pub fn substitute_forward<S: Real>(m: &[S], f: &mut [S]) {
    for i in 0..f.len() {
        let line = &m[i * (i + 1) / 2..][..i];
        let mut sum = f[i];
        for (l, f) in line.iter().zip(f.iter()) {
            sum = sum - *l * *f;
        }
        f[i] = sum;
    }
}

/// f becomes L⁻ᵀ D⁻¹ f.
#[inline]
pub fn substitute_back<S: Real>(m: &[S], f: &mut [S]) {
    let row = |i: usize| i * (i + 1) / 2;
    for i in (0..f.len()).rev() {
        let mut sum = f[i] * m[row(i) + i];
        for j in i + 1..f.len() {
            sum = sum - m[row(j) + i] * f[j];
        }
        f[i] = sum;
    }
}

#[cfg(test)]
mod tests {
    use super::solve_packed;

    #[test]
    fn solves_and_names_the_singular_coordinate() {
        let mut m = [4.0, 2.0, 3.0, 1.0, 0.5, 2.0];
        // M x = −f for x = (1, −2, 3)
        let mut f = [-(4.0 - 4.0 + 3.0), -(2.0 - 6.0 + 1.5), -(1.0 - 1.0 + 6.0)];
        solve_packed(&mut m, &mut f).unwrap();
        for (x, expected) in f.iter().zip([1.0_f64, -2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14, "{f:?}");
        }
        let mut singular = [1.0, 1.0, 1.0];
        assert_eq!(solve_packed(&mut singular, &mut [0.0, 0.0]).unwrap_err().coordinate, 1);
    }
}
