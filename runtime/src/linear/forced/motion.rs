//! Motions of the linear model by the matrix exponential, whatever its eigenvectors.

use nalgebra::{DMatrix, DVector};

use super::Motion;
use crate::linear::{LinearError, Linearised, Mode, Reduction, expm, normal_modes};

impl Linearised {
    /// The modes: normal ones where nothing but M and a symmetric K acts, else complex ones.
    ///
    /// # Errors
    /// As [`normal_modes`] and `complex_modes`; [`LinearError::NeedsFeature`] for complex modes in a crate built
    /// without the feature `modal`.
    pub fn modes(&self) -> Result<Vec<Mode>, LinearError> {
        let mut modes = match self.damping.is_zero() && self.circulatory().is_zero() {
            true => normal_modes(self, Reduction::Cholesky)?,
            #[cfg(feature = "modal")]
            false => crate::linear::complex_modes(self)?.modes,
            #[cfg(not(feature = "modal"))]
            false => return Err(LinearError::NeedsFeature { feature: "modal" }),
        };
        Mode::note_uncertainties(&mut modes, self);
        Ok(modes)
    }

    /// Departures x(t) and speeds x'(t) without forces, from x₀ and v₀ at t = 0: z(t) = e^(At) z₀.
    ///
    /// Exact to rounding for defective matrices too: critical damping, rigid motions A + B t (catalogue L1, L2).
    ///
    /// # Errors
    /// [`LinearError::SingularMass`] and wrong sizes.
    pub fn free_motion(&self, x0: &[f64], v0: &[f64], times: &[f64]) -> Result<Motion, LinearError> {
        let n = self.len();
        let start = self.start(x0, v0)?;
        let a = self.state_matrix()?;
        let mut motion = Motion { x: DMatrix::zeros(times.len(), n), v: DMatrix::zeros(times.len(), n) };
        for (row, t) in times.iter().enumerate() {
            let state = expm(&(&a * *t)) * &start;
            motion.set(row, &state);
        }
        Ok(motion)
    }

    /// (x₀, v₀) as one column.
    pub(super) fn start(&self, x0: &[f64], v0: &[f64]) -> Result<DVector<f64>, LinearError> {
        let n = self.len();
        for (what, list) in [("x0", x0), ("v0", v0)] {
            if list.len() != n {
                return Err(LinearError::WrongSize { what, given: list.len(), expected: n });
            }
        }
        Ok(DVector::from_iterator(2 * n, x0.iter().chain(v0).copied()))
    }
}

impl Motion {
    /// Writes a state (x, x') into a row.
    pub(super) fn set(&mut self, row: usize, state: &DVector<f64>) {
        let n = self.x.ncols();
        for i in 0..n {
            self.x[(row, i)] = state[i];
            self.v[(row, i)] = state[n + i];
        }
    }
}
