//! Slow motions beside fast ones about rests with constraints that contain speeds.
//!
//! At rest departures are δq = Z_h x, where J_h Z_h = 0 of the rows that hold a place, and δq' = Z y with J Z = 0, and
//!
//! x' = Z|_h y,  y' = −M_z⁻¹ Zᵀ (∂F/∂q Z_h x + ∂F/∂q' Z y),  M_z = Zᵀ M Z,
//!
//! Z|_h being the rows of Z of the coordinates that Z_h leaves independent.  These are coordinates and speeds of the file, so that nothing slow is
//! mixed with what is fast, as it is in an orthonormal basis of all departures.

use nalgebra::{Complex, DMatrix, DVector};

use super::state::{CANCELLED, ConstrainedState, State};
use crate::linear::matrices::balanced;
use crate::linear::modes::doubted_modes;
use crate::linear::{FirstOrder, LinearError};
use crate::matrix::solve_least;
use crate::mechanism::{Solutions, System};

impl<S: System + ?Sized> ConstrainedState<'_, S> {
    /// The analysis of departures from a rest, with shapes by those of `departures`, and the size of eigenvalue that is not told from 0 in it; `None`
    /// where it is none of this kind, or rounding hides some.
    ///
    /// # Errors
    /// [`LinearError::NonFinite`], [`LinearError::NoConvergence`].
    pub fn slow_and_fast(
        &self,
        state: &State,
        departures: &DMatrix<f64>,
    ) -> Result<(Option<FirstOrder>, Option<f64>), LinearError> {
        let jacobian = self.jacobian(state);
        let still = state.v.iter().all(|v| *v == 0.0) && state.turn.is_none();
        let plain = self.system.description().rotations.is_empty() && self.effects(state) == jacobian.transpose();
        if !still || !plain || self.rate_jacobian(state).iter().any(|x| *x != 0.0) {
            return Ok((None, None));
        }
        let Solutions { basis: speeds, .. } = Solutions::of(&jacobian, &[]);
        let Solutions { basis: places, independent, .. } = Solutions::of(&self.closed_jacobian(&jacobian), &[]);
        let (x, y) = (places.ncols(), speeds.ncols());
        let Some((accelerations, doubts)) = self.accelerations_by(state, [&places, &speeds]) else {
            return Ok((None, None));
        };
        let (mut matrix, mut doubt) = (DMatrix::zeros(x + y, x + y), DMatrix::zeros(x + y, x + y));
        matrix.view_mut((0, x), (x, y)).copy_from(&speeds.select_rows(&independent));
        matrix.rows_mut(x, y).copy_from(&accelerations);
        doubt.rows_mut(x, y).copy_from(&doubts);
        let (matrix, scales) = balanced(&matrix);
        let doubt = DMatrix::from_fn(x + y, x + y, |i, j| doubt[(i, j)] * (scales[j] / scales[i]));
        let (found, lost) = doubted_modes(&matrix, &doubt)?;
        if lost.is_some() {
            return Ok((None, lost));
        }
        let n = self.n;
        let mut basis = DMatrix::zeros(2 * n, x + y);
        basis.view_mut((0, 0), (n, x)).copy_from(&places);
        basis.view_mut((n, x), (n, y)).copy_from(&speeds);
        basis.column_iter_mut().zip(&scales).for_each(|(mut column, scale)| column *= *scale);
        let failed = LinearError::NoConvergence { what: "the shapes of small motions" };
        let turned = solve_least(departures, &basis).ok_or(failed)?;
        Ok((Some(in_basis(found, &turned)), None))
    }

    /// −M_z⁻¹ Zᵀ [∂F/∂q Z_h, ∂F/∂q' Z], and by how much rounding may have moved its elements; `None` where M_z has no inverse.
    fn accelerations_by(
        &self,
        state: &State,
        [places, speeds]: [&DMatrix<f64>; 2],
    ) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
        let (n, slopes, mass) = (self.n, self.slopes(state), self.mass(state));
        let [by_place, by_speed] = self.slopes_of_terms(state);
        let by_place = by_place + self.terms_of_multipliers(state);
        let reduced = |matrix: &DMatrix<f64>, terms: &DMatrix<f64>, right: &DMatrix<f64>| {
            let sums = speeds.abs().transpose() * (matrix.abs() + terms) * right.abs();
            (speeds.transpose() * matrix * right, sums * CANCELLED)
        };
        let [stiffness, damping] = [0, n].map(|first| slopes.view((0, first), (n, n)).into_owned());
        let (mass, of_mass) = reduced(&mass, &DMatrix::zeros(n, n), speeds);
        let (stiffness, of_stiffness) = reduced(&stiffness, &by_place, places);
        let (damping, of_damping) = reduced(&damping, &by_speed, speeds);
        let side = |left: &DMatrix<f64>, right: &DMatrix<f64>| {
            DMatrix::from_fn(left.nrows(), left.ncols() + right.ncols(), |i, j| match j.checked_sub(left.ncols()) {
                None => left[(i, j)],
                Some(j) => right[(i, j)],
            })
        };
        let inverse = if mass.is_empty() { mass } else { mass.try_inverse()? };
        let accelerations = -&inverse * side(&stiffness, &damping);
        let doubts = inverse.abs() * (side(&of_stiffness, &of_damping) + of_mass * accelerations.abs());
        Some((accelerations, doubts))
    }
}

/// An analysis whose variables are sums of others, by these columns.
fn in_basis(found: FirstOrder, turned: &DMatrix<f64>) -> FirstOrder {
    let complex = turned.map(Complex::from);
    let neutral: Vec<DVector<f64>> = found.neutral.iter().map(|direction| turned * direction).collect();
    let neutral = match neutral.is_empty() {
        true => neutral,
        false => DMatrix::from_columns(&neutral).qr().q().column_iter().map(|column| column.into_owned()).collect(),
    };
    FirstOrder { shapes: found.shapes.iter().map(|shape| (&complex * shape).normalize()).collect(), neutral, ..found }
}
