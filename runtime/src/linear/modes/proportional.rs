//! Proportional damping αM + βK, and what is lost where damping is treated as diagonal.

use nalgebra::DMatrix;

use super::{Fault, Reduction, Spectrum};
use crate::linear::{LinearError, Linearised};

/// α and β of C = αM + βK that damps two frequencies by given ratios: ζ = α/(2ω) + βω/2.
///
/// α in 1/s, β in s; ω in rad/s, both positive and different.  Between the two frequencies the damping is weaker,
/// outside them stronger; a negative α or β means negative damping somewhere.
///
/// # Errors
/// [`LinearError::NonFinite`] where the frequencies are equal or not positive.
///
/// Source: Rayleigh, Theory of Sound, §97; Clough and Penzien, Dynamics of Structures, §12-5.
///
/// ```
/// let (alpha, beta) = dalembert::linear::proportional_damping((1.0, 0.05), (4.0, 0.05))?;
/// assert!((alpha - 0.08).abs() < 1e-15 && (beta - 0.02).abs() < 1e-15);
/// # Ok::<(), dalembert::linear::LinearError>(())
/// ```
pub fn proportional_damping(
    (omega1, zeta1): (f64, f64),
    (omega2, zeta2): (f64, f64),
) -> Result<(f64, f64), LinearError> {
    let gap = (omega2 - omega1) * (omega2 + omega1);
    let beta = 2.0 * (zeta2 * omega2 - zeta1 * omega1) / gap;
    let alpha = 2.0 * omega1 * omega2 * (zeta1 * omega2 - zeta2 * omega1) / gap;
    if omega1 > 0.0 && omega2 > 0.0 && alpha.is_finite() && beta.is_finite() {
        Ok((alpha, beta))
    } else {
        Err(LinearError::NonFinite { what: "proportional damping fitted to these frequencies".to_owned() })
    }
}

/// Damping in normal coordinates with what is off the diagonal left out, and how wrong that is.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagonalDamping {
    /// φᵢᵀ C φᵢ of every normal mode, 1/s, in rising order of ω².
    pub damping: Vec<f64>,
    /// ζᵢ = φᵢᵀCφᵢ/(2ωᵢ); `None` where ω² is not positive.
    pub zeta: Vec<Option<f64>>,
    /// The largest |φᵢᵀCφⱼ| ω/|ωⱼ² − ωᵢ²|, ω the lower of the two: the first-order error of the shapes, and about
    /// the error of free motions (catalogue L10: 0.002 → 0.8 %, 0.034 → 7 %, 0.17 → 28 %, 0.69 → 66 %).  Above 0.01
    /// use complex modes.
    pub error: f64,
    /// ‖C M⁻¹ K − K M⁻¹ C‖/‖C M⁻¹ K‖: 0 exactly where normal modes decouple (Caughey and O'Kelly 1965).
    pub commutator: f64,
    /// C with what is off the diagonal left out, in the given coordinates.
    pub matrix: DMatrix<f64>,
}

impl Linearised {
    /// Treats damping as diagonal in normal coordinates.
    ///
    /// # Errors
    /// As [`super::normal_modes`].
    pub fn diagonal_damping(&self) -> Result<DiagonalDamping, LinearError> {
        let spectrum = Spectrum::new(&self.mass, &self.conservative(), Reduction::Cholesky);
        let Spectrum { squares, shapes, .. } = spectrum.map_err(|fault: Fault| fault.named(self))?;
        let n = self.len();
        let (m, c, k) = (self.m(), self.c(), self.k());
        let modal = shapes.transpose() * &c * &shapes;
        let mut error = 0.0_f64;
        for i in 0..n {
            for j in 0..n {
                if i != j && modal[(i, j)].abs() > 1e-14 * modal.amax() {
                    let omega = squares[i].abs().min(squares[j].abs()).sqrt();
                    error = error.max(modal[(i, j)].abs() * omega / (squares[j] - squares[i]).abs());
                }
            }
        }
        // M⁻¹ = Φ Φᵀ.
        let inverse = &shapes * shapes.transpose();
        let (one, other) = (&c * &inverse * &k, &k * &inverse * &c);
        let scale = one.norm().max(f64::MIN_POSITIVE);
        let diagonal = DMatrix::from_diagonal(&modal.diagonal());
        let zeta = |i: usize| (squares[i] > 0.0).then(|| modal[(i, i)] / (2.0 * squares[i].sqrt()));
        Ok(DiagonalDamping {
            damping: modal.diagonal().iter().copied().collect(),
            zeta: (0..n).map(zeta).collect(),
            error,
            commutator: (one - other).norm() / scale,
            matrix: &m * &shapes * diagonal * shapes.transpose() * &m,
        })
    }
}
