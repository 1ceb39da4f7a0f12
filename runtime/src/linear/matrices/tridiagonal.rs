//! Eigenvalues of large symmetric tridiagonal matrices, as chains have them: n² operations instead of n³.

use nalgebra::{DMatrix, DVector};

/// Eigenvectors whose eigenvalues are nearer than this part of the norm are made orthogonal one by one; of others,
/// inverse iteration leaves products of some ε over it.
const CLUSTER: f64 = 1e-4;

/// Eigenvalues in rising order and orthonormal eigenvectors; `None` where the matrix has other elements or the
/// iteration does not end.
pub fn tridiagonal_eigen(matrix: &DMatrix<f64>) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = matrix.nrows();
    let is_tridiagonal = (0..n).all(|j| (0..n).all(|i| i.abs_diff(j) <= 1 || matrix[(i, j)] == 0.0));
    if n < 2 || !is_tridiagonal {
        return None;
    }
    let diagonal: Vec<f64> = (0..n).map(|i| matrix[(i, i)]).collect();
    let beside: Vec<f64> = (1..n).map(|i| matrix[(i, i - 1)]).collect();
    let norm = matrix.amax().max(f64::MIN_POSITIVE);
    let values = eigenvalues(diagonal.clone(), beside.clone())?;
    let mut vectors = DMatrix::zeros(n, n);
    let mut first = 0;
    let mut before = f64::NEG_INFINITY;
    for (k, value) in values.iter().enumerate() {
        if k > 0 && value - values[k - 1] > CLUSTER * norm {
            first = k;
        }
        // Equal eigenvalues are shifted apart by rounding, so that each solve is another one.
        let shift = value.max(before + 4.0 * f64::EPSILON * norm);
        before =
            if k + 1 < n && values[k + 1] - value <= 4.0 * f64::EPSILON * norm { shift } else { f64::NEG_INFINITY };
        let shifted = Shifted::new(&diagonal, &beside, shift, norm);
        let mut x = DVector::from_fn(n, |i, _| 1.0 + 0.5 * ((i as f64 + 1.3) * (k as f64 + 0.7)).sin());
        for _ in 0..4 {
            shifted.solve(x.as_mut_slice());
            for _ in 0..2 {
                for j in first..k {
                    let part = vectors.column(j).dot(&x);
                    x.axpy(-part, &vectors.column(j), 1.0);
                }
            }
            let length = x.norm();
            if !(length > 0.0 && length.is_finite()) {
                return None;
            }
            x /= length;
        }
        vectors.set_column(k, &x);
    }
    Some((DVector::from_vec(values), vectors))
}

/// Implicit QL iterations with Wilkinson's shift (Bowdler, Martin, Reinsch and Wilkinson 1968), without vectors.
fn eigenvalues(mut d: Vec<f64>, mut e: Vec<f64>) -> Option<Vec<f64>> {
    let n = d.len();
    e.push(0.0);
    for l in 0..n {
        for iteration in 0.. {
            let negligible = |m: &usize| e[*m].abs() <= 0.5 * f64::EPSILON * (d[*m].abs() + d[*m + 1].abs());
            let m = (l..n - 1).find(negligible).unwrap_or(n - 1);
            if m == l {
                break;
            }
            if iteration == 60 {
                return None;
            }
            let mut g = (d[l + 1] - d[l]) / (2.0 * e[l]);
            let r = g.hypot(1.0);
            g = d[m] - d[l] + e[l] / (g + if g < 0.0 { -r } else { r });
            let (mut sine, mut cosine, mut p) = (1.0, 1.0, 0.0);
            let mut broken = false;
            for i in (l..m).rev() {
                let (f, b) = (sine * e[i], cosine * e[i]);
                let r = f.hypot(g);
                e[i + 1] = r;
                if r == 0.0 {
                    d[i + 1] -= p;
                    e[m] = 0.0;
                    broken = true;
                    break;
                }
                (sine, cosine) = (f / r, g / r);
                g = d[i + 1] - p;
                let r = (d[i] - g) * sine + 2.0 * cosine * b;
                p = sine * r;
                d[i + 1] = g + p;
                g = cosine * r - b;
            }
            if !broken {
                d[l] -= p;
                e[l] = g;
                e[m] = 0.0;
            }
        }
    }
    d.sort_by(f64::total_cmp);
    Some(d)
}

/// T − λ, factored with exchanged rows.
struct Shifted {
    pivots: Vec<f64>,
    first: Vec<f64>,
    second: Vec<f64>,
    factors: Vec<f64>,
    exchanged: Vec<bool>,
}

impl Shifted {
    fn new(diagonal: &[f64], beside: &[f64], shift: f64, norm: f64) -> Shifted {
        let n = diagonal.len();
        let mut pivots: Vec<f64> = diagonal.iter().map(|d| d - shift).collect();
        let mut first: Vec<f64> = beside.iter().copied().chain([0.0]).collect();
        let mut second = vec![0.0; n];
        let (mut factors, mut exchanged) = (vec![0.0; n], vec![false; n]);
        for i in 0..n - 1 {
            let below = beside[i];
            if pivots[i].abs() >= below.abs() {
                if pivots[i] != 0.0 {
                    factors[i] = below / pivots[i];
                    pivots[i + 1] -= factors[i] * first[i];
                }
            } else {
                exchanged[i] = true;
                factors[i] = pivots[i] / below;
                let next = first[i + 1];
                let (own, after) = (first[i], pivots[i + 1]);
                (pivots[i], first[i], second[i]) = (below, after, next);
                pivots[i + 1] = own - factors[i] * after;
                first[i + 1] = -factors[i] * next;
            }
        }
        let floor = f64::EPSILON * norm;
        for pivot in &mut pivots {
            if pivot.abs() < floor {
                *pivot = if *pivot < 0.0 { -floor } else { floor };
            }
        }
        Shifted { pivots, first, second, factors, exchanged }
    }

    fn solve(&self, x: &mut [f64]) {
        let n = x.len();
        for i in 0..n - 1 {
            if self.exchanged[i] {
                x.swap(i, i + 1);
            }
            x[i + 1] -= self.factors[i] * x[i];
        }
        for i in (0..n).rev() {
            let mut left = x[i];
            if i + 1 < n {
                left -= self.first[i] * x[i + 1];
            }
            if i + 2 < n {
                left -= self.second[i] * x[i + 2];
            }
            x[i] = left / self.pivots[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(matrix: &DMatrix<f64>, accuracy: f64) {
        let n = matrix.nrows();
        let (values, vectors) = tridiagonal_eigen(matrix).unwrap();
        assert!((matrix * &vectors - &vectors * DMatrix::from_diagonal(&values)).amax() < accuracy * matrix.amax());
        assert!((vectors.transpose() * &vectors - DMatrix::identity(n, n)).amax() < accuracy);
    }

    #[test]
    fn chains_alike_and_apart() {
        let chain = |n: usize, cut: usize| {
            DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 2.0,
                1 if i.max(j) == cut => 0.0,
                1 => -1.0,
                _ => 0.0,
            })
        };
        for n in [2, 70, 200] {
            check(&chain(n, n + 1), 1e-11);
        }
        // Two equal halves: every eigenvalue twice.
        check(&chain(100, 50), 1e-11);
        check(&DMatrix::identity(80, 80), 1e-13);
        // A free chain whose stiffnesses grow.
        check(
            &DMatrix::from_fn(90, 90, |i, j| match i.abs_diff(j) {
                0 => (i as f64 + 1.0).powi(3),
                1 => -(i.min(j) as f64 + 1.0),
                _ => 0.0,
            }),
            1e-11,
        );
        assert!(tridiagonal_eigen(&DMatrix::from_element(3, 3, 1.0)).is_none());
    }
}
