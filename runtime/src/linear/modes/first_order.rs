//! Systems of first order, z' = A z: reduced equations of nonholonomic mechanisms, and whatever else has no M, C, K.

use nalgebra::{Complex, DMatrix, DVector};

use crate::linear::LinearError;
use crate::linear::matrices::{Eigen, Scaled, Singular};

/// What happens to small departures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    /// All die out.
    Asymptotic,
    /// None grows; some stay as they are or oscillate for ever.
    Neutral,
    /// None grows by itself, but zeros without an eigenvector of their own let some go on at a constant rate, A + B t:
    /// neighbouring steady motions move away from each other, as with another speed or another heading.
    Drifting,
    /// Some grow as e^(λt).
    Unstable,
}

/// The analysis of z' = A z.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrder {
    /// All eigenvalues, 1/s: zeros first, exactly 0; then by rising size, with a real part of 0 where rounding hides its sign.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Eigenvectors of the eigenvalues that are not 0, of unit length: z = Re(shape · e^(λt)).
    pub shapes: Vec<DVector<Complex<f64>>>,
    /// The rank of A.
    pub rank: usize,
    /// How many eigenvalues are 0, by ranks.
    pub zeros: usize,
    /// Directions to neighbouring steady states, orthonormal, as many as A has columns less its rank: a manifold of
    /// equilibria, neither rigid motions nor instabilities.
    pub neutral: Vec<DVector<f64>>,
    /// Condition number of the eigenvectors of the eigenvalues that are not 0.
    pub condition: f64,
    /// True where the zeros have fewer eigenvectors than their number, or the others none to speak of: motions are then
    /// to be computed by [`expm`](crate::linear::expm).
    pub defective: bool,
    /// What happens to small departures.
    pub stability: Stability,
}

/// Eigenvalues of z' = A z, zeros counted by ranks (catalogue L17, L19).
///
/// A null space N of A belongs to zeros; what A does beyond N, RᵀAR with R orthogonal to N, is treated in the same way
/// until its rank is full: so zeros are counted though rounding would split a defective one by ε^(1/k).  Ranks count
/// singular values above 16 n ε ‖A‖: give z units in which the elements of A are of similar size.
///
/// # Errors
/// [`LinearError::WrongSize`] for a matrix that is not square, [`LinearError::NonFinite`],
/// [`LinearError::NoConvergence`].
///
/// ```
/// use dalembert::linear::{Stability, first_order_modes};
/// // A mass that coasts to rest: x' = v, v' = -2 v.  Where it stops is free.
/// let a = nalgebra::DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, -2.0]);
/// let found = first_order_modes(&a)?;
/// assert_eq!((found.zeros, found.neutral.len(), found.stability), (1, 1, Stability::Neutral));
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn first_order_modes(a: &DMatrix<f64>) -> Result<FirstOrder, LinearError> {
    let n = a.nrows();
    if a.ncols() != n {
        return Err(LinearError::WrongSize { what: "the columns of A", given: a.ncols(), expected: n });
    }
    if a.iter().any(|x| !x.is_finite()) {
        return Err(LinearError::NonFinite { what: "A".to_owned() });
    }
    let threshold = Scaled::threshold(n, a.norm());
    let (mut left, mut levels) = (a.clone(), Vec::<Level>::new());
    while left.nrows() > 0 {
        let level = Level::new(&left, threshold)?;
        if level.null.ncols() == 0 {
            break;
        }
        left = level.beyond.transpose() * left * &level.beyond;
        levels.push(level);
    }
    let zeros = levels.iter().map(|level| level.null.ncols()).sum();
    let neutral: Vec<DVector<f64>> =
        levels.first().map_or_else(Vec::new, |level| level.null.column_iter().map(|c| c.into_owned()).collect());
    let (others, condition) = plain_pairs(&left)?;
    let error = threshold * condition.min(1e6);
    let back = |pair: Pair| Pair { shape: Level::all_back(&levels, &pair), error, ..pair };
    Ok(of_pairs(n, (zeros, neutral), others.into_iter().map(back).collect(), condition))
}

/// The analysis, of so many variables, from the number of zeros with their directions, and the other eigenvalues, whose shapes have this condition.
pub(super) fn of_pairs(
    n: usize,
    (zeros, neutral): (usize, Vec<DVector<f64>>),
    mut others: Vec<Pair>,
    condition: f64,
) -> FirstOrder {
    others.sort_by(|x, y| x.value.norm().total_cmp(&y.value.norm()).then(x.value.im.total_cmp(&y.value.im)));
    let stability = match () {
        () if others.iter().any(|pair| pair.value.re > pair.error) => Stability::Unstable,
        () if zeros > neutral.len() => Stability::Drifting,
        () if zeros > 0 || others.iter().any(|pair| pair.value.re >= -pair.error) => Stability::Neutral,
        () => Stability::Asymptotic,
    };
    // A real part that is not told from 0 says nothing of what grows.
    others.iter_mut().filter(|pair| pair.value.re.abs() <= pair.error).for_each(|pair| pair.value.re = 0.0);
    let zero = std::iter::repeat_n(Complex::new(0.0, 0.0), zeros);
    FirstOrder {
        eigenvalues: zero.chain(others.iter().map(|pair| pair.value)).collect(),
        shapes: others.iter().map(|pair| pair.shape.normalize()).collect(),
        rank: n - neutral.len(),
        zeros,
        defective: zeros > neutral.len() || condition.is_nan() || condition > 1e6,
        neutral,
        condition,
        stability,
    }
}

/// A matrix A taken apart: orthonormal bases N of its null space and R of what is orthogonal to it.
pub(super) struct Level {
    null: DMatrix<f64>,
    pub beyond: DMatrix<f64>,
    /// Nᵀ A R.
    coupling: DMatrix<f64>,
}

impl Level {
    fn new(matrix: &DMatrix<f64>, threshold: f64) -> Result<Level, LinearError> {
        let failed = LinearError::NoConvergence { what: "the singular value decomposition of A" };
        let singular = Singular::of(matrix).ok_or(failed)?;
        let null = singular.directions(|value| value <= threshold);
        Ok(Level::of(matrix, null, singular.directions(|value| value > threshold)))
    }

    /// From N and R.
    pub fn of(matrix: &DMatrix<f64>, null: DMatrix<f64>, beyond: DMatrix<f64>) -> Level {
        let coupling = null.transpose() * matrix * &beyond;
        Level { null, beyond, coupling }
    }

    /// The eigenvector of A from that of what all of these levels leave.
    pub fn all_back(levels: &[Level], pair: &Pair) -> DVector<Complex<f64>> {
        levels.iter().rev().fold(pair.shape.clone(), |shape, level| level.back(pair.value, &shape))
    }

    /// From an eigenvector u of RᵀAR with λ ≠ 0 to that of A: N NᵀAR u/λ + R u.
    fn back(&self, value: Complex<f64>, u: &DVector<Complex<f64>>) -> DVector<Complex<f64>> {
        let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
        let along = complex(&self.coupling) * u / value;
        complex(&self.null) * along + complex(&self.beyond) * u
    }
}

/// An eigenvalue, its eigenvector, and by how much rounding may have moved it.
pub(super) struct Pair {
    pub value: Complex<f64>,
    pub shape: DVector<Complex<f64>>,
    pub error: f64,
}

/// Eigenvalues with eigenvectors, and the condition number of these; errors by Bauer's and Fike's bound.
pub(super) fn plain_pairs(matrix: &DMatrix<f64>) -> Result<(Vec<Pair>, f64), LinearError> {
    let n = matrix.nrows();
    if n == 0 {
        return Ok((Vec::new(), 1.0));
    }
    let solved = Eigen::of(matrix).ok_or(LinearError::NoConvergence { what: "the eigenvalue iteration" })?;
    let condition = solved.condition();
    let error = Scaled::threshold(n, matrix.norm()) * condition.min(1e6);
    let pair = |k: usize| Pair { value: solved.values[k], shape: solved.vectors.column(k).into_owned(), error };
    Ok(((0..n).map(pair).collect(), condition))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sleigh of Chaplygin with its state (x, y, θ, v, ω), linearised about v₀ along x.
    fn sleigh(a: f64, inertia: f64, mass: f64, v0: f64) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(5, 5);
        matrix[(0, 3)] = 1.0;
        matrix[(1, 2)] = v0;
        matrix[(2, 4)] = 1.0;
        matrix[(4, 4)] = -mass * a * v0 / (inertia + mass * a * a);
        matrix
    }

    /// Catalogue L17: four zeros and rank 3 of 5: straight motions with any place, heading and speed are steady, a
    /// manifold, and those beside each other drift apart; forwards the sleigh is not unstable, backwards it is.
    #[test]
    fn l17_zeros_of_a_nonholonomic_system_are_counted_by_rank() {
        let forwards = first_order_modes(&sleigh(0.3, 0.2, 1.0, 2.0)).unwrap();
        assert_eq!((forwards.zeros, forwards.rank, forwards.neutral.len()), (4, 3, 2));
        assert!(forwards.defective && forwards.stability == Stability::Drifting);
        assert!(forwards.eigenvalues[..4].iter().all(|x| x.norm() < 1e-12));
        assert!((forwards.eigenvalues[4] + 2.068965517241379).norm() < 1e-14, "{:?}", forwards.eigenvalues);
        let backwards = first_order_modes(&sleigh(0.3, 0.2, 1.0, -2.0)).unwrap();
        assert_eq!((backwards.zeros, backwards.stability), (4, Stability::Unstable));
        // In other coordinates too, where rounding splits what is defective.
        let mixing =
            DMatrix::from_fn(5, 5, |i, j| 1.0 / (1.0 + i as f64 + 2.0 * j as f64) + f64::from(u8::from(i == j)));
        let inverse = mixing.clone().try_inverse().unwrap();
        let mixed = first_order_modes(&(&mixing * sleigh(0.3, 0.2, 1.0, 2.0) * inverse)).unwrap();
        assert_eq!((mixed.zeros, mixed.rank, mixed.stability), (4, 3, Stability::Drifting));
    }

    /// A disc or hoop that rolls upright at a spin: lean φ, φ' and the turning rate ψ'.  A about a diameter, C about
    /// the axle; (A + m r²) φ'' = m g r φ − (C + m r²) ω ψ', A ψ'' = C ω φ'.
    fn rolling(a: f64, c: f64, spin: f64) -> DMatrix<f64> {
        let (m, g, r) = (1.0, 9.81, 1.0);
        let about_ground = a + m * r * r;
        dmatrix![
            0.0, 1.0, 0.0;
            m * g * r / about_ground, 0.0, -(c + m * r * r) * spin / about_ground;
            0.0, c * spin / a, 0.0
        ]
    }

    /// Catalogue L19: upright rolling is stable for spin² > A m g r/(C (C + m r²)): g/(3r) for a disc, g/(4r) for a hoop.
    #[test]
    fn l19_a_rolling_disc_and_hoop_are_stable_above_their_speeds() {
        for (a, c, square) in [(0.25, 0.5, 9.81 / 3.0), (0.5, 1.0, 9.81 / 4.0)] {
            let critical = f64::sqrt(a * 9.81 / (c * (c + 1.0)));
            assert!((critical * critical - square).abs() < 1e-14);
            let [slow, fast] = [0.99, 1.01].map(|f| first_order_modes(&rolling(a, c, f * critical)).unwrap());
            assert_eq!((slow.stability, fast.stability), (Stability::Unstable, Stability::Neutral));
            for found in [slow, fast] {
                // One zero: steady circling with a little lean.
                assert_eq!((found.zeros, found.neutral.len()), (1, 1));
                assert!(found.eigenvalues[0].norm() < 1e-12);
            }
        }
    }

    #[test]
    fn first_order_systems_without_zeros() {
        let found = first_order_modes(&dmatrix![0.0, 1.0; -4.0, 0.0]).unwrap();
        assert_eq!((found.zeros, found.stability), (0, Stability::Neutral));
        assert!((found.eigenvalues[0] - Complex::new(0.0, -2.0)).norm() < 1e-15);
        assert_eq!(first_order_modes(&dmatrix![-1.0, 3.0; 0.0, -2.0]).unwrap().stability, Stability::Asymptotic);
        let nothing = first_order_modes(&DMatrix::zeros(2, 2)).unwrap();
        assert_eq!((nothing.zeros, nothing.rank, nothing.stability), (2, 0, Stability::Neutral));
        assert!(first_order_modes(&DMatrix::zeros(2, 3)).is_err());
        assert!(first_order_modes(&dmatrix![f64::NAN]).is_err());
    }

    /// Problem 32: random A; z' = A z from the real part w of an eigenvector is Re(e^(λt) v), by integration and by the
    /// exponential.
    #[test]
    fn problem_32_a_random_matrix_moves_along_its_eigenvectors() {
        let mut seed = 4735_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        for n in [3, 7, 20] {
            let a = DMatrix::from_fn(n, n, |_, _| random());
            let found = first_order_modes(&a).unwrap();
            assert_eq!((found.zeros, found.eigenvalues.len(), found.shapes.len()), (0, n, n));
            for (value, v) in found.eigenvalues.iter().zip(&found.shapes) {
                let t = 3.0;
                let expected = (v * (value * t).exp()).map(|x| x.re);
                let w = v.map(|x| x.re);
                let by_exponential = crate::linear::expm(&(&a * t)) * &w;
                assert!((by_exponential - &expected).amax() < 1e-12 * (1.0 + expected.amax()), "{n} {value}");
                // Taylor steps of order 8.
                let mut z = w;
                for _ in 0..300 {
                    let mut term = z.clone();
                    for k in 1..=8 {
                        term = &a * term * (0.01 / f64::from(k));
                        z += &term;
                    }
                }
                assert!((z - &expected).amax() < 1e-11 * (1.0 + expected.amax()), "{n} {value}");
            }
        }
    }

    /// With zeros too, eigenvectors are those of A: A v = λ v, and A moves nothing along neutral directions.
    #[test]
    fn eigenvectors_beside_zeros() {
        let a = sleigh(0.3, 0.2, 1.0, 2.0);
        let found = first_order_modes(&a).unwrap();
        let (value, v) = (found.eigenvalues[4], &found.shapes[0]);
        assert!((a.map(Complex::from) * v - v * value).norm() < 1e-14);
        assert!(found.neutral.iter().all(|direction| (&a * direction).norm() < 1e-14));
    }
}
