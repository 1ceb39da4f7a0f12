//! M x'' + K x = 0 from given states, three ways (TAM 4735, problem 28).

use nalgebra::{DMatrix, DVector};

use crate::linear::modes::{Fault, Spectrum};
use crate::linear::{LinearError, LinearMechanism, Reduction, SparseMatrix};
use crate::matrix::is_symmetric;
use crate::mechanism::Scene;
use crate::{Error, Method, Settings, simulate};

/// x and x' at some times.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// x, a row for each time, m (or the coordinates' units).
    pub x: DMatrix<f64>,
    /// x', a row for each time.
    pub v: DMatrix<f64>,
}

/// By integrating the equations of motion numerically (order 8, relative tolerance 10⁻¹³).
///
/// K may be anything; times are counted from 0, where x = x₀ and x' = v₀, and must not be negative.
///
/// # Errors
/// Wrong sizes, a mass matrix that is not positive definite, or a run that fails.
pub fn solvenum(m: &DMatrix<f64>, k: &DMatrix<f64>, x0: &[f64], v0: &[f64], times: &[f64]) -> Result<Motion, Error> {
    let n = m.nrows();
    let mut system = LinearMechanism::new(m.clone(), DMatrix::zeros(n, n), k.clone())?;
    let mut order: Vec<usize> = (0..times.len()).collect();
    order.sort_by(|a, b| times[*a].total_cmp(&times[*b]));
    let (mut x, mut v) = (DMatrix::zeros(times.len(), n), DMatrix::zeros(times.len(), n));
    let scene = Scene { q: x0.to_vec(), v: v0.to_vec(), until: 0.0, tolerance: 1e-13, every: None, ..Scene::default() };
    let mut settings = Settings { method: Method::Dop853, dense: false, watch: false, ..Settings::new(&scene) };
    for index in order {
        settings.until = times[index];
        let end = simulate(&mut system, &settings)?.last();
        x.row_mut(index).copy_from_slice(&end.q);
        v.row_mut(index).copy_from_slice(&end.v);
        (settings.from, settings.q, settings.v) = (times[index], end.q, end.v);
    }
    Ok(Motion { x, v })
}

/// By the eigenvectors of M⁻¹K: x = Σ φᵢ ηᵢ(t), ηᵢ = aᵢ cos ωᵢt + (bᵢ/ωᵢ) sin ωᵢt.
///
/// Where ω² = 0 (by the rank of K) ηᵢ = aᵢ + bᵢ t; where K is indefinite and ω² = −γ², ηᵢ = aᵢ cosh γt +
/// (bᵢ/γ) sinh γt.  M must be symmetric and positive definite, K symmetric.
///
/// # Errors
/// Wrong sizes, and matrices that are not what they must be.
///
/// # Example
/// ```
/// use dalembert::linear::solvemode;
/// use nalgebra::DMatrix;
/// // Two free masses with a spring: they drift and oscillate.
/// let (m, k) = (DMatrix::identity(2, 2), DMatrix::from_row_slice(2, 2, &[1.0, -1.0, -1.0, 1.0]));
/// let motion = solvemode(&m, &k, &[0.0, 0.0], &[1.0, 0.0], &[2.0])?;
/// let root2 = 2.0_f64.sqrt();
/// assert!((motion.x[(0, 0)] - (1.0 + (2.0 * root2).sin() / (2.0 * root2))).abs() < 1e-14);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn solvemode(
    m: &DMatrix<f64>,
    k: &DMatrix<f64>,
    x0: &[f64],
    v0: &[f64],
    times: &[f64],
) -> Result<Motion, LinearError> {
    superpose(m, k, x0, v0, times, Reduction::Cholesky)
}

/// As [`solvemode`], by the orthonormal eigenvectors of M^(-1/2) K M^(-1/2).
///
/// # Errors
/// As [`solvemode`].
pub fn solvenorm(
    m: &DMatrix<f64>,
    k: &DMatrix<f64>,
    x0: &[f64],
    v0: &[f64],
    times: &[f64],
) -> Result<Motion, LinearError> {
    superpose(m, k, x0, v0, times, Reduction::SquareRoot)
}

fn superpose(
    m: &DMatrix<f64>,
    k: &DMatrix<f64>,
    x0: &[f64],
    v0: &[f64],
    times: &[f64],
    reduction: Reduction,
) -> Result<Motion, LinearError> {
    let n = m.nrows();
    // Sizes, numbers and M are checked there.
    LinearMechanism::new(m.clone(), DMatrix::zeros(n, n), k.clone())?;
    for (what, list) in [("x0", x0), ("v0", v0)] {
        if list.len() != n {
            return Err(LinearError::WrongSize { what, given: list.len(), expected: n });
        }
    }
    if !is_symmetric(k) {
        return Err(LinearError::NotSymmetric { what: "K" });
    }
    let spectrum = Spectrum::new(&SparseMatrix::from_dense(m), &SparseMatrix::from_dense(k), reduction);
    let Spectrum { squares, shapes, .. } = spectrum.map_err(Fault::numbered)?;
    let weights = shapes.transpose() * m;
    let start = &weights * DVector::from_column_slice(x0);
    let speed = &weights * DVector::from_column_slice(v0);
    let (mut x, mut v) = (DMatrix::zeros(times.len(), n), DMatrix::zeros(times.len(), n));
    for (row, t) in times.iter().enumerate() {
        let parts: Vec<[f64; 3]> = squares.iter().map(|square| propagator(*square, *t)).collect();
        let eta = DVector::from_fn(n, |i, _| start[i] * parts[i][0] + speed[i] * parts[i][1]);
        let rate = DVector::from_fn(n, |i, _| start[i] * parts[i][2] + speed[i] * parts[i][0]);
        x.row_mut(row).copy_from(&(&shapes * eta).transpose());
        v.row_mut(row).copy_from(&(&shapes * rate).transpose());
    }
    Ok(Motion { x, v })
}

/// c, s and c' of η'' + ω² η = 0: η = η(0) c + η'(0) s, with c = cos ωt, s = sin(ωt)/ω or what becomes of them.
pub(super) fn propagator(square: f64, t: f64) -> [f64; 3] {
    let omega = square.abs().sqrt();
    if square > 0.0 {
        let (sin, cos) = (omega * t).sin_cos();
        [cos, sin / omega, -omega * sin]
    } else if square < 0.0 {
        let (sinh, cosh) = ((omega * t).sinh(), (omega * t).cosh());
        [cosh, sinh / omega, omega * sinh]
    } else {
        [1.0, t, 0.0]
    }
}
