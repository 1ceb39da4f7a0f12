//! The matrix exponential.

use nalgebra::DMatrix;

/// Degrees of the Padé approximants, the norms up to which their backward error is below rounding, and the
/// leading coefficients of that error (Al-Mohy and Higham 2009, table 3.1 and eq. 4.3).
const APPROXIMANTS: [(usize, f64, f64); 5] = [
    (3, 1.495585217958292e-2, 1.0 / 100800.0),
    (5, 2.53939833006323e-1, 1.0 / 10059033600.0),
    (7, 9.504178996162932e-1, 1.0 / 4487938430976000.0),
    (9, 2.097847961257068, 1.0 / 5914384781877411840000.0),
    (13, 4.25, 1.0 / 113250775606021113483283660800000000.0),
];

/// e^A by scaling, Padé approximation and squaring.
///
/// e^A = (r_m(A/2ˢ))^(2ˢ) with m ≤ 13 and s from the norms of powers of A rather than of A, so that a large
/// element off the diagonal does not cost digits.  A is balanced by a diagonal matrix of powers of two first.  The
/// error is some units of rounding times the condition of the problem: an oscillation e^(iωt) loses the digits of
/// the phase, ωt ε (catalogue L16); slow motions lose none beside fast ones that die out.  No eigenvectors are needed, so defective matrices are no exception.
///
/// Source: Al-Mohy and Higham, A new scaling and squaring algorithm for the matrix exponential, SIAM J. Matrix
/// Anal. Appl. 31 (2009), algorithm 5.1; Higham, the same journal 26 (2005).
///
/// # Panics
/// If A is not square.
///
/// ```
/// use dalembert::linear::expm;
/// use nalgebra::DMatrix;
/// let drift = DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
/// assert_eq!(expm(&drift).as_slice(), [1.0, 0.0, 1.0, 1.0]);
/// ```
pub fn expm(a: &DMatrix<f64>) -> DMatrix<f64> {
    let n = a.nrows();
    assert_eq!(n, a.ncols(), "only square matrices have an exponential");
    if a.iter().any(|x| !x.is_finite()) {
        return DMatrix::from_element(n, n, f64::NAN);
    }
    let (scales, balanced) = balance(a);
    let exponential = scaled_and_squared(&balanced);
    DMatrix::from_fn(n, n, |i, j| exponential[(i, j)] * (scales[i] / scales[j]))
}

fn scaled_and_squared(a: &DMatrix<f64>) -> DMatrix<f64> {
    let square = a * a;
    let fourth = &square * &square;
    let sixth = &square * &fourth;
    let root = |matrix: &DMatrix<f64>, power: f64| norm(matrix).powf(1.0 / power);
    let (d4, d6) = (root(&fourth, 4.0), root(&sixth, 6.0));
    let low = d4.max(d6);
    for approximant in &APPROXIMANTS[..2] {
        if low <= approximant.1 && extra_squarings(a, approximant) == 0 {
            return one_more(&pade_less_one(a, &[&square, &fourth, &sixth], approximant.0));
        }
    }
    let eighth = &fourth * &fourth;
    let d8 = root(&eighth, 8.0);
    let middle = d6.max(d8);
    for approximant in &APPROXIMANTS[2..4] {
        if middle <= approximant.1 && extra_squarings(a, approximant) == 0 {
            return one_more(&pade_less_one(a, &[&square, &fourth, &sixth, &eighth], approximant.0));
        }
    }
    let d10 = root(&(&fourth * &sixth), 10.0);
    let eta = middle.min(d8.max(d10));
    let last = &APPROXIMANTS[4];
    let first = if eta > last.1 { (eta / last.1).log2().ceil() as i32 } else { 0 };
    let squarings = first + extra_squarings(&(a * 0.5_f64.powi(first)), last);
    let factor = 0.5_f64.powi(squarings);
    let scaled = a * factor;
    let powers = [&square * factor.powi(2), &fourth * factor.powi(4), &sixth * factor.powi(6)];
    doubled(pade_less_one(&scaled, &[&powers[0], &powers[1], &powers[2]], 13), squarings)
}

/// (1 + E)^(2ˢ).
///
/// Squares of 1 + E double the rounding of what is near 1 each time, 2ˢ ε in all; 2 E + E² does not.  But elements that die out end in rounding of
/// 1 there: each is taken from where it has more digits.
fn doubled(less_one: DMatrix<f64>, squarings: i32) -> DMatrix<f64> {
    let mut squared = one_more(&less_one);
    let mut less_one = less_one;
    for _ in 0..squarings {
        squared = &squared * &squared;
        less_one = &less_one * 2.0 + &less_one * &less_one;
    }
    let grown = 2.0_f64.powi(squarings);
    let best = |squared: f64, other: f64| if squared.abs() * grown < 1.0 { squared } else { other };
    squared.zip_map(&one_more(&less_one), best)
}

fn one_more(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    matrix + DMatrix::identity(matrix.nrows(), matrix.nrows())
}

/// The largest column sum of absolute values.
fn norm(matrix: &DMatrix<f64>) -> f64 {
    matrix.column_iter().fold(0.0, |most, column| column.iter().map(|x| x.abs()).sum::<f64>().max(most))
}

/// How many more squarings the error's leading term c ‖|A|^(2m+1)‖ asks for.
fn extra_squarings(a: &DMatrix<f64>, (degree, _, coefficient): &(usize, f64, f64)) -> i32 {
    let (size, absolute) = (norm(a), a.abs().transpose());
    if size == 0.0 {
        return 0;
    }
    let mut sums = nalgebra::DVector::from_element(a.nrows(), 1.0);
    for _ in 0..2 * degree + 1 {
        sums = &absolute * sums;
    }
    let ratio = coefficient * sums.max() / (size * 0.5 * f64::EPSILON);
    if ratio > 1.0 && ratio.is_finite() { (ratio.log2() / (2 * degree) as f64).ceil() as i32 } else { 0 }
}

/// r_m(A) − 1, `powers` being A², A⁴, A⁶ and, up to degree 9, A⁸.
fn pade_less_one(a: &DMatrix<f64>, powers: &[&DMatrix<f64>], degree: usize) -> DMatrix<f64> {
    let n = a.nrows();
    let b = coefficients(degree);
    let one = DMatrix::identity(n, n);
    let (odd, even) = if degree < 13 {
        let (mut odd, mut even) = (&one * b[1], &one * b[0]);
        for (k, power) in powers.iter().enumerate().take(degree / 2) {
            odd += *power * b[2 * k + 3];
            even += *power * b[2 * k + 2];
        }
        (odd, even)
    } else {
        let [p2, p4, p6] = [powers[0], powers[1], powers[2]];
        let odd = p6 * (p6 * b[13] + p4 * b[11] + p2 * b[9]) + p6 * b[7] + p4 * b[5] + p2 * b[3] + &one * b[1];
        let even = p6 * (p6 * b[12] + p4 * b[10] + p2 * b[8]) + p6 * b[6] + p4 * b[4] + p2 * b[2] + &one * b[0];
        (odd, even)
    };
    let odd = a * odd;
    // The denominator is far from singular within the bounds on the norm.
    (&even - &odd).lu().solve(&(odd * 2.0)).unwrap_or_else(|| DMatrix::from_element(n, n, f64::NAN))
}

/// b₀ … b_m of the numerator: b_j = (2m − j)! m!/((2m)! (m − j)! j!), times (2m)!/m!.
fn coefficients(degree: usize) -> Vec<f64> {
    let mut b = vec![1.0; degree + 1];
    for j in (0..degree).rev() {
        // b_j = b_(j+1) (2m − j)(j + 1)/(m − j), whole numbers all of them.
        b[j] = b[j + 1] * (2 * degree - j) as f64 * (j + 1) as f64 / (degree - j) as f64;
    }
    b
}

/// D and D⁻¹ A D with rows and columns of similar size, D a diagonal of powers of two.
fn balance(a: &DMatrix<f64>) -> (Vec<f64>, DMatrix<f64>) {
    let n = a.nrows();
    let (mut scales, mut b) = (vec![1.0; n], a.clone());
    for _ in 0..100 {
        let mut done = true;
        for i in 0..n {
            let others = |j: &usize| *j != i;
            let row: f64 = (0..n).filter(others).map(|j| b[(i, j)].abs()).sum();
            let column: f64 = (0..n).filter(others).map(|j| b[(j, i)].abs()).sum();
            if row == 0.0 || column == 0.0 {
                continue;
            }
            let factor = 2.0_f64.powi((0.5 * (row / column).log2()).round() as i32);
            if column * factor + row / factor < 0.95 * (column + row) {
                done = false;
                scales[i] *= factor;
                b.row_mut(i).scale_mut(1.0 / factor);
                b.column_mut(i).scale_mut(factor);
            }
        }
        if done {
            break;
        }
    }
    (scales, b)
}

#[cfg(test)]
#[expect(clippy::excessive_precision, reason = "reference numbers as they were given")]
mod tests {
    use super::{coefficients, expm};
    use nalgebra::DMatrix;

    fn close(a: &DMatrix<f64>, b: &DMatrix<f64>, tolerance: f64) {
        let off = (a - b).amax() / b.amax().max(1.0);
        assert!(off <= tolerance, "{a}{b}off by {off:e}");
    }

    #[test]
    fn the_approximants_are_padé_s() {
        assert_eq!(coefficients(3), [120.0, 60.0, 12.0, 1.0]);
        assert_eq!(coefficients(13)[..2], [64764752532480000.0, 32382376266240000.0]);
    }

    #[test]
    fn every_degree_gives_rotations_and_decays() {
        for exponent in -8..7 {
            let t = 1.7 * 2.0_f64.powi(exponent);
            let (sin, cos) = t.sin_cos();
            close(&expm(&(dmatrix![0.0, 1.0; -1.0, 0.0] * t)), &dmatrix![cos, sin; -sin, cos], 4e-15 * t.max(1.0));
            close(&expm(&dmatrix![-t]), &dmatrix![(-t).exp()], 1e-15);
        }
    }

    /// x' = −λ x + v beside v' = −c v: e^(At) in closed form, 10¹³ apart.
    #[test]
    fn slow_motions_keep_their_digits_beside_fast_ones() {
        let (fast, slow, t) = (1e9, 1e-4, 0.1);
        let e = expm(&(dmatrix![-fast, 1.0; 0.0, -slow] * t));
        let expected = (-slow * t).exp();
        assert!((e[(1, 1)] - expected).abs() <= 2.0 * f64::EPSILON, "{}", e[(1, 1)] - expected);
        assert!((e[(0, 1)] * (fast - slow) / expected - 1.0).abs() < 1e-15 * fast * t, "{}", e[(0, 1)]);
        // What dies out dies out.
        let small = expm(&dmatrix![-40.0, 1.0; -1.0, -40.0])[(0, 0)];
        assert!((small / ((-40.0_f64).exp() * 1.0_f64.cos()) - 1.0).abs() < 1e-13, "{small}");
    }

    /// B18, one damper 0.5 on mass 1: e^A at t = 1, first and fourth columns of `expm_A_t_1_one_damper_rows`.
    #[test]
    fn b18_matrix_exponential() {
        let a = dmatrix![
            0.0, 0.0, 0.0, 1.0, 0.0, 0.0; 0.0, 0.0, 0.0, 0.0, 1.0, 0.0; 0.0, 0.0, 0.0, 0.0, 0.0, 1.0;
            -2.0, 1.0, 0.0, -0.5, 0.0, 0.0; 1.0, -2.0, 1.0, 0.0, 0.0, 0.0; 0.0, 1.0, -2.0, 0.0, 0.0, 0.0
        ];
        let e = expm(&a);
        let first = [
            0.3071447909710980368031024,
            0.3582019072703575069877294,
            0.0341170781812077031345744,
            -0.9928456040161627681911337,
            0.4711661192311675046599401,
            0.1226690921835589238153037,
        ];
        let fourth = [
            0.5567111643628479120689012,
            0.1205767247095330559466687,
            0.006651631829590214977178768,
            0.0287892087896740807686518,
            0.2979135449155909790143951,
            0.03079126226641259564598502,
        ];
        for i in 0..6 {
            assert!((e[(i, 0)] - first[i]).abs() < 1e-14 && (e[(i, 3)] - fourth[i]).abs() < 1e-14, "{e}");
        }
    }

    /// Catalogue L1 and L2: critical damping and Jordan blocks, where eigenvectors fail.
    #[test]
    fn l2_defective_matrices_are_no_exception() {
        let critical = expm(&(dmatrix![0.0, 1.0; -1.0, -2.0] * 5.0));
        let decay = (-5.0_f64).exp();
        close(&critical, &(dmatrix![6.0, 5.0; -5.0, -4.0] * decay), 1e-15);
        let block = dmatrix![-1.0, 1.0, 0.0, 0.0; 0.0, -1.0, 1.0, 0.0; 0.0, 0.0, -1.0, 1.0; 0.0, 0.0, 0.0, -1.0];
        let t = 2.0_f64;
        let row = [1.0, t, t * t / 2.0, t * t * t / 6.0];
        let exact = DMatrix::from_fn(4, 4, |i, j| if j >= i { row[j - i] * (-t).exp() } else { 0.0 });
        close(&expm(&(&block * t)), &exact, 1e-15);
        let s = 0.6;
        let mut turn = DMatrix::identity(4, 4);
        (turn[(0, 0)], turn[(0, 3)], turn[(3, 0)], turn[(3, 3)]) = (0.8, s, -s, 0.8);
        close(&expm(&(&turn * &block * turn.transpose() * t)), &(&turn * exact * turn.transpose()), 6e-15);
    }

    /// Catalogue L16: badly scaled matrices.
    #[test]
    fn l16_scaling() {
        let e = expm(&dmatrix![-1.0, 1e6; 0.0, -2.0]);
        let exact = [(-1.0_f64).exp(), 1e6 * ((-1.0_f64).exp() - (-2.0_f64).exp()), (-2.0_f64).exp()];
        for (value, exact) in [e[(0, 0)], e[(0, 1)], e[(1, 1)]].iter().zip(exact) {
            assert!((value / exact - 1.0).abs() < 1e-14, "{e}");
        }
        let fast = expm(&dmatrix![0.0, 1.0; -1e12, 0.0]);
        assert!((fast[(0, 0)] - 1e6_f64.cos()).abs() < 1e-8, "{}", fast[(0, 0)] - 1e6_f64.cos());
    }

    #[test]
    fn zero_infinite_and_empty() {
        assert_eq!(expm(&DMatrix::zeros(3, 3)), DMatrix::identity(3, 3));
        assert!(expm(&dmatrix![f64::INFINITY])[(0, 0)].is_nan());
        assert_eq!(expm(&DMatrix::zeros(0, 0)).nrows(), 0);
    }
}
