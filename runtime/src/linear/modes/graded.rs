//! Systems z' = A z whose motions are of very different speeds, as of filters of nanoseconds beside what warms up in an hour.
//!
//! Rounding of the fastest motions is much beside the slowest ones, but nothing in A says so: its elements are known each to its own digits.
//! So variables that act on each other in no circle are taken apart, ranks are those of A with rows and columns of one size (D A E has the rank of A),
//! and slow eigenvalues are those of A⁻¹.

use std::collections::BTreeSet;

use nalgebra::{Complex, DMatrix, DVector};

use super::first_order::{FirstOrder, Level, Pair, first_order_modes, of_pairs, plain_pairs};
use crate::linear::LinearError;
use crate::linear::matrices::{Eigen, Scaled, Singular, condition, symmetric_eigen};

/// Sweeps that bring rows and columns to one size.
const SWEEPS: u32 = 6;
/// Slowest and fastest eigenvalues at this distance have digits enough in one decomposition.
const SPREAD: f64 = 1e-4;

/// As [`first_order_modes`](super::first_order_modes), of a matrix of which each element is known to its own digits and what is 0 is exactly that.
///
/// # Errors
/// [`LinearError::NonFinite`], [`LinearError::NoConvergence`].
pub(crate) fn graded_modes(a: &DMatrix<f64>) -> Result<FirstOrder, LinearError> {
    Ok(Graded::of(a)?.analysis())
}

/// The same of a matrix whose elements may each be off by so much, and `None`, where all eigenvalues are told from 0; else those of
/// [`first_order_modes`], and the size of eigenvalue that is not told from 0 there.
///
/// To first order an eigenvalue is off by |w| δA |v|/|w v| at most, w and v its left and right vectors (Wilkinson, The algebraic eigenvalue problem,
/// 1965, 2.5).
///
/// # Errors
/// [`LinearError::NonFinite`], [`LinearError::NoConvergence`].
pub(crate) fn doubted_modes(a: &DMatrix<f64>, doubt: &DMatrix<f64>) -> Result<(FirstOrder, Option<f64>), LinearError> {
    let known = a.zip_map(doubt, |x, doubt| if x.abs() <= doubt { 0.0 } else { x });
    let [mut right, left] = [Graded::of(&known)?, Graded::of(&known.transpose())?];
    let mut lost = None;
    for pair in &mut right.pairs {
        let far = |other: &&Pair| (other.value - pair.value).norm();
        let nearest = left.pairs.iter().min_by(|x, y| far(x).total_cmp(&far(y)));
        let moved = nearest.map_or(f64::INFINITY, |left| {
            let sizes = [&left.shape, &pair.shape].map(|shape| shape.map(|x| x.norm()));
            sizes[0].dot(&(doubt * &sizes[1])) / left.shape.dot(&pair.shape).norm()
        });
        pair.error = pair.error.max(moved);
        // What is no number is not known either.
        if moved.is_nan() || moved >= pair.value.norm() {
            lost = Some(lost.map_or(moved, |most: f64| most.max(moved)));
        }
    }
    match lost {
        None => Ok((right.analysis(), None)),
        Some(_) => Ok((first_order_modes(a)?, lost)),
    }
}

/// The eigenvalues of A by those of the sets of variables that act on each other in a circle, where there are several: rounding of one set does not split
/// what another one has alike, as oscillators of one frequency in a row that each drive the next one.
///
/// # Errors
/// [`LinearError::NoConvergence`].
pub(super) fn by_circles(a: &DMatrix<f64>) -> Result<Option<Eigen>, LinearError> {
    if in_circles(a).len() < 2 {
        return Ok(None);
    }
    let Graded { size, zeros, neutral, pairs, .. } = Graded::of(a)?;
    let mut solved = Eigen { values: vec![Complex::from(0.0); size], vectors: DMatrix::zeros(size, size) };
    // What is missing of the shapes of zeros repeats one of them.
    let still = neutral.iter().cycle().take(zeros).map(|shape| shape.map(Complex::from));
    for (k, shape) in still.chain(pairs.iter().map(|pair| pair.shape.normalize())).enumerate().take(size) {
        solved.vectors.set_column(k, &shape);
    }
    pairs.iter().enumerate().for_each(|(k, pair)| solved.values[zeros + k] = pair.value);
    Ok(Some(solved))
}

/// Eigenvalues of a graded matrix with their shapes.
struct Graded {
    size: usize,
    zeros: usize,
    neutral: Vec<DVector<f64>>,
    pairs: Vec<Pair>,
    condition: f64,
}

impl Graded {
    fn analysis(self) -> FirstOrder {
        of_pairs(self.size, (self.zeros, self.neutral), self.pairs, self.condition)
    }

    fn of(a: &DMatrix<f64>) -> Result<Graded, LinearError> {
        let n = a.nrows();
        if a.iter().any(|x| !x.is_finite()) {
            return Err(LinearError::NonFinite { what: "A".to_owned() });
        }
        let null = kernel(a)?;
        let neutral = null.column_iter().map(|column| column.into_owned()).collect();
        let parts = in_circles(a);
        let (mut zeros, mut pairs) = (0, Vec::new());
        for (k, part) in parts.iter().enumerate() {
            let (own_zeros, own) = of_part(&a.select_rows(part).select_columns(part))?;
            zeros += own_zeros;
            for pair in own {
                pairs.push(Pair { shape: extended(a, &parts[k..], &pair)?, ..pair });
            }
        }
        let shapes: Vec<DVector<Complex<f64>>> = pairs.iter().map(|pair| pair.shape.normalize()).collect();
        let condition = if shapes.is_empty() { 1.0 } else { condition(&DMatrix::from_columns(&shapes)) };
        Ok(Graded { size: n, zeros, neutral, pairs, condition })
    }
}

/// Sets of variables that act on each other in a circle, each after those on which it depends.
fn in_circles(a: &DMatrix<f64>) -> Vec<Vec<usize>> {
    let n = a.nrows();
    let acts: Vec<Vec<usize>> = (0..n).map(|i| (0..n).filter(|j| a[(i, *j)] != 0.0).collect()).collect();
    // All on which a variable depends, itself among them.
    let reached: Vec<BTreeSet<usize>> = (0..n)
        .map(|first| {
            let (mut seen, mut next) = (BTreeSet::from([first]), vec![first]);
            while let Some(i) = next.pop() {
                next.extend(acts[i].iter().copied().filter(|j| seen.insert(*j)));
            }
            seen
        })
        .collect();
    let circle = |i: usize| -> Vec<usize> { reached[i].iter().copied().filter(|j| reached[*j].contains(&i)).collect() };
    let mut parts: Vec<Vec<usize>> = (0..n).map(circle).filter(|part| !part.is_empty()).collect();
    // What depends on others reaches more than they do.
    parts.sort_by_key(|part| (reached[part[0]].len(), part[0]));
    parts.dedup();
    parts
}

/// D A E with rows and columns of one size, and D and E.
fn equilibrated(a: &DMatrix<f64>) -> (DMatrix<f64>, [Vec<f64>; 2]) {
    let n = a.nrows();
    let (mut scaled, mut rows, mut columns) = (a.clone(), vec![1.0; n], vec![1.0; n]);
    let factor = |size: f64| if size > 0.0 { (-0.5 * size.log2()).round().exp2() } else { 1.0 };
    for _ in 0..SWEEPS {
        for (mut column, scale) in scaled.column_iter_mut().zip(&mut columns) {
            let factor = factor(column.amax());
            column *= factor;
            *scale *= factor;
        }
        for (mut row, scale) in scaled.row_iter_mut().zip(&mut rows) {
            let factor = factor(row.amax());
            row *= factor;
            *scale *= factor;
        }
    }
    (scaled, [rows, columns])
}

/// An orthonormal basis of what A takes to 0.
///
/// # Errors
/// [`LinearError::NoConvergence`].
pub(crate) fn kernel(a: &DMatrix<f64>) -> Result<DMatrix<f64>, LinearError> {
    let n = a.nrows();
    let (scaled, [_, columns]) = equilibrated(a);
    let threshold = Scaled::threshold(n, scaled.norm());
    let failed = LinearError::NoConvergence { what: "the singular value decomposition of A" };
    let mut null = Singular::of(&scaled).ok_or(failed)?.directions(|value| value <= threshold);
    null.row_iter_mut().zip(&columns).for_each(|(mut row, scale)| row *= *scale);
    Ok(if null.is_empty() { null } else { null.qr().q() })
}

/// How many eigenvalues of a part are 0, and the others.
fn of_part(a: &DMatrix<f64>) -> Result<(usize, Vec<Pair>), LinearError> {
    let (mut left, mut levels) = (a.clone(), Vec::<Level>::new());
    while left.nrows() > 0 {
        let null = kernel(&left)?;
        if null.is_empty() {
            break;
        }
        let across = DMatrix::identity(left.nrows(), left.nrows()) - &null * null.transpose();
        let failed = LinearError::NoConvergence { what: "the complement of a null space" };
        let (sizes, vectors) = symmetric_eigen(across).ok_or(failed)?;
        let kept: Vec<usize> = (0..sizes.len()).filter(|k| sizes[*k] > 0.5).collect();
        let level = Level::of(&left, null, vectors.select_columns(&kept));
        left = level.beyond.transpose() * left * &level.beyond;
        levels.push(level);
    }
    let zeros = a.nrows() - left.nrows();
    let pairs = slow_and_fast(&left)?;
    let back = |pair: Pair| Pair { shape: Level::all_back(&levels, &pair), ..pair };
    Ok((zeros, pairs.into_iter().map(back).collect()))
}

/// Fast eigenvalues from A, slow ones from A⁻¹, where they are far apart.
fn slow_and_fast(a: &DMatrix<f64>) -> Result<Vec<Pair>, LinearError> {
    let (mut fast, _) = plain_pairs(a)?;
    fast.sort_by(|x, y| x.value.norm().total_cmp(&y.value.norm()));
    let [Some(least), Some(most)] = [fast.first(), fast.last()].map(|pair| pair.map(|pair| pair.value.norm())) else {
        return Ok(fast);
    };
    if least > SPREAD * most {
        return Ok(fast);
    }
    let Some(slow) = by_inverse(a) else { return Ok(fast) };
    let middle = slow.first().map_or(0.0, |pair| (pair.value.norm() * most).sqrt());
    let count = slow.iter().take_while(|pair| pair.value.norm() < middle).count();
    // What is left of a pair would not be real.
    let whole = |pairs: &[Pair]| pairs.iter().map(|pair| pair.value.im).sum::<f64>() == 0.0;
    if whole(&slow[..count]) && whole(&fast[count..]) {
        fast.splice(..count, slow.into_iter().take(count));
    }
    Ok(fast)
}

/// The eigenvalues of A by those of A⁻¹, by rising size; `None` where A has no inverse, or they do not converge.
fn by_inverse(a: &DMatrix<f64>) -> Option<Vec<Pair>> {
    let n = a.nrows();
    let (scaled, [rows, columns]) = equilibrated(a);
    let regular = scaled.clone().try_inverse()?;
    let doubt = regular.norm() * scaled.norm();
    let inverse = DMatrix::from_fn(n, n, |i, j| columns[i] * regular[(i, j)] * rows[j]);
    let found = Eigen::of(&inverse)?;
    let error = Scaled::threshold(n, inverse.norm()) * found.condition().min(1e6) * doubt;
    let pair = |k: usize| {
        let value = match found.values[k] {
            real if real.im == 0.0 => Complex::from(1.0 / real.re),
            value => without_rounding(value.inv(), n),
        };
        Pair { value, shape: found.vectors.column(k).into_owned(), error: error * value.norm_sqr() }
    };
    let mut pairs: Vec<Pair> = (0..n).map(pair).collect();
    pairs.sort_by(|x, y| x.value.norm().total_cmp(&y.value.norm()));
    Some(pairs)
}

/// An eigenvalue of n without what rounding alone makes of its real part.
fn without_rounding(value: Complex<f64>, n: usize) -> Complex<f64> {
    let rounding = value.re.abs() <= Scaled::threshold(n, value.norm());
    if rounding { Complex::new(0.0, value.im) } else { value }
}

/// An eigenvector of the first of these parts as one of the whole: what depends on it follows.
fn extended(a: &DMatrix<f64>, parts: &[Vec<usize>], pair: &Pair) -> Result<DVector<Complex<f64>>, LinearError> {
    let n = a.nrows();
    let zero = Complex::new(0.0, 0.0);
    let mut whole = DVector::from_element(n, zero);
    parts[0].iter().zip(pair.shape.iter()).for_each(|(i, x)| whole[*i] = *x);
    for part in &parts[1..] {
        let driven = DVector::from_iterator(
            part.len(),
            part.iter().map(|i| -(0..n).map(|j| whole[j] * a[(*i, j)]).sum::<Complex<f64>>()),
        );
        if driven.iter().all(|x| *x == zero) {
            continue;
        }
        let own = a.select_rows(part).select_columns(part);
        // In resonance it goes on growing by itself: all but its own shape vanishes beside that.  Rounding moves a simple eigenvalue by ε, a double one by √ε.
        let size = own.norm().max(pair.value.norm());
        let shifted = |by: f64| own.map(Complex::from) - DMatrix::identity(part.len(), part.len()) * (pair.value + by);
        let solve = |by: f64| shifted(by).lu().solve(&driven).filter(|x| x.iter().all(|x| x.is_finite()));
        let failed = LinearError::NoConvergence { what: "the shape of an eigenvalue" };
        let nudges = [0.0, f64::EPSILON, f64::EPSILON.sqrt()].map(|part| part * size);
        let found = nudges.into_iter().find_map(solve).ok_or(failed)?;
        part.iter().zip(found.iter()).for_each(|(i, x)| whole[*i] = *x);
    }
    Ok(whole)
}

#[cfg(test)]
mod tests {
    use super::super::Stability;
    use super::*;

    fn check(a: &DMatrix<f64>, expected: &[Complex<f64>]) -> FirstOrder {
        let found = graded_modes(a).unwrap();
        assert_eq!(found.eigenvalues.len(), expected.len());
        for expected in expected {
            let near = |value: &&Complex<f64>| (*value - expected).norm() <= 1e-12 * expected.norm();
            assert!(
                found.eigenvalues.iter().any(|value| near(&value)),
                "no {expected} of {a}: {:?}",
                found.eigenvalues
            );
        }
        for (value, shape) in found.eigenvalues[found.zeros..].iter().zip(&found.shapes) {
            let left = a.map(Complex::from) * shape - shape * *value;
            assert!(left.norm() <= 1e-12 * (a.abs() * shape.map(|x| x.norm())).norm(), "{value} leaves {left}");
        }
        found
    }

    fn real(values: &[f64]) -> Vec<Complex<f64>> {
        values.iter().map(|x| Complex::from(*x)).collect()
    }

    #[test]
    fn slow_eigenvalues_keep_their_digits_beside_fast_ones() {
        let unstable = check(&dmatrix![1e-5, 0.0; 0.0, -1e11], &real(&[1e-5, -1e11]));
        assert_eq!((unstable.zeros, unstable.stability), (0, Stability::Unstable));
        let follows = check(&dmatrix![-1e-3, 0.0; 1e9, -1e9], &real(&[-1e-3, -1e9]));
        assert!(!follows.defective && follows.stability == Stability::Asymptotic);
        // x'' = 1e-6 s, s' = 1e10 (x - s): a circle, λ² (1 + λ/1e10) = 1e-6.
        let slow = 1e-3 / (1.0 + 1e-13_f64).sqrt();
        let circle = dmatrix![0.0, 1.0, 0.0; 0.0, 0.0, 1e-6; 1e10, 0.0, -1e10];
        assert_eq!(check(&circle, &real(&[-slow, slow, -1e10])).stability, Stability::Unstable);
        let oscillates = check(
            &dmatrix![0.0, 1.0, 0.0; -1e-6, -1e-3, 0.0; 1e9, 0.0, -1e9],
            &[Complex::new(-5e-4, -0.75e-6_f64.sqrt()), Complex::new(-5e-4, 0.75e-6_f64.sqrt()), Complex::from(-1e9)],
        );
        assert_eq!(oscillates.stability, Stability::Asymptotic);
    }

    #[test]
    fn zeros_are_counted_in_circles_and_across_them() {
        // A free mass beside a slow state and a fast filter of its speed.
        let coasts = dmatrix![0.0, 1.0, 0.0, 0.0; 0.0, 0.0, 0.0, 0.0; 0.0, 0.0, -1e-7, 0.0; 0.0, 1e9, 0.0, -1e9];
        let found = check(&coasts, &real(&[0.0, 0.0, -1e-7, -1e9]));
        assert_eq!((found.zeros, found.neutral.len(), found.stability), (2, 1, Stability::Drifting));
        // Two masses on a spring, free in their line, by rates scaled to 1e12.
        let (s, k) = (1e12, 3.0);
        let free = dmatrix![0.0, 0.0, s, 0.0; 0.0, 0.0, 0.0, s; -k / s, k / s, 0.0, 0.0; k / s, -k / s, 0.0, 0.0];
        let root = 6.0_f64.sqrt();
        let found =
            check(&free, &[real(&[0.0, 0.0]), vec![Complex::new(0.0, -root), Complex::new(0.0, root)]].concat());
        assert_eq!((found.zeros, found.neutral.len()), (2, 1));
    }

    /// A slow and a fast state, 10¹⁷ apart, which are known or not by what elimination leaves of rounding.
    #[test]
    fn what_rounding_hides_is_not_told() {
        let a = dmatrix![-1e-5, 1e-5; 0.0, -1e12];
        let small = a.abs() * 1e-14;
        let (found, lost) = doubted_modes(&a, &small).unwrap();
        assert_eq!((found.zeros, found.stability, lost), (0, Stability::Asymptotic, None));
        assert!((found.eigenvalues[0].re / -1e-5 - 1.0).abs() < 1e-15, "{:?}", found.eigenvalues);
        // A rest of a difference beside the slow one, too large to tell its sign.
        let (found, lost) = doubted_modes(&a, &dmatrix![2e-5, 0.0; 0.0, 1e-2]).unwrap();
        assert_eq!((found.zeros, found.stability, lost), (1, Stability::Neutral, None), "0 to its digits");
        let (found, lost) = doubted_modes(&dmatrix![-1e-5, 1.0; 0.0, -1e12], &dmatrix![0.9e-5, 0.0; 1e7, 0.0]).unwrap();
        assert_eq!((found.zeros, found.stability), (1, Stability::Neutral));
        assert!((lost.unwrap() / 1.9e-5 - 1.0).abs() < 0.06, "{lost:?}");
    }

    /// A chain of masses with a filter each, all alike, of which eigenvalue iterations on the whole do not end.
    #[test]
    fn filters_that_are_alike_keep_an_eigenvalue_each() {
        let n = 10;
        let mut a = DMatrix::zeros(3 * n, 3 * n);
        for i in 0..n {
            a[(i, n + i)] = 1.0;
            for j in [i.wrapping_sub(1), i + 1].into_iter().filter(|j| *j < n) {
                a[(n + i, i)] -= 2.0;
                a[(n + i, j)] += 2.0;
            }
            a[(2 * n + i, n + i)] = 1.0 / 0.03;
            a[(2 * n + i, 2 * n + i)] = -1.0 / 0.03;
        }
        let found = graded_modes(&a).unwrap();
        let filters = found.eigenvalues.iter().filter(|value| (*value + 1.0 / 0.03).norm() < 1e-12).count();
        assert_eq!((found.zeros, found.neutral.len(), filters), (2, 1, n));
        for k in 1..n {
            let expected = 2.0 * 2.0_f64.sqrt() * (k as f64 * std::f64::consts::PI / (2 * n) as f64).sin();
            let near = |value: &&Complex<f64>| (*value - Complex::new(0.0, expected)).norm() < 1e-12;
            assert_eq!(found.eigenvalues.iter().filter(near).count(), 1, "{expected}");
        }
    }
}
