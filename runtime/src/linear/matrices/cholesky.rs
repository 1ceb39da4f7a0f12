//! M = L Lᵀ, and the first-order form that needs it.

use nalgebra::DMatrix;

/// [[0, I], [−M⁻¹K, −M⁻¹C]]; the index of a pivot of M that is not positive.
pub fn first_order(m: &DMatrix<f64>, c: &DMatrix<f64>, k: &DMatrix<f64>) -> Result<DMatrix<f64>, usize> {
    let n = m.nrows();
    let factor = cholesky(m)?;
    let mut a = DMatrix::zeros(2 * n, 2 * n);
    a.view_mut((0, n), (n, n)).fill_with_identity();
    for (matrix, first) in [(k, 0), (c, n)] {
        a.view_mut((n, first), (n, n)).copy_from(&-solve_cholesky(&factor, matrix));
    }
    Ok(a)
}

/// L of M = L Lᵀ; the index of the first pivot that is not positive beside its diagonal element.
pub fn cholesky(m: &DMatrix<f64>) -> Result<DMatrix<f64>, usize> {
    let n = m.nrows();
    if let Some(factor) = m.clone().cholesky() {
        let l = factor.unpack();
        let weak = |i: &usize| l[(*i, *i)] * l[(*i, *i)] <= 4.0 * n as f64 * f64::EPSILON * m[(*i, *i)];
        return match (0..n).find(weak) {
            Some(i) => Err(i),
            None => Ok(l),
        };
    }
    Err((1..=n)
        .find(|size| m.view((0, 0), (*size, *size)).into_owned().cholesky().is_none())
        .map_or(0, |size| size - 1))
}

/// M⁻¹ B.
pub fn solve_cholesky(l: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut x = b.clone();
    // The diagonal of L is positive, so neither substitution can fail.
    l.solve_lower_triangular_mut(&mut x);
    l.tr_solve_lower_triangular_mut(&mut x);
    x
}
