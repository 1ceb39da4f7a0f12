//! Directions without stiffness: families of equilibria and degenerate equilibria.

use nalgebra::DMatrix;

use super::point::LinearisationPoint;
use super::search::least_step;
use crate::linear::matrices::{Scaled, null_space};
use crate::linear::{LinearError, SparseMatrix};
use crate::matrix::svd;

/// Newton steps after which what still moves falls back.
pub(in crate::linear) const RELAXATIONS: usize = 40;

/// What becomes of the directions in which the stiffness K vanishes.
///
/// Their number is n less the rank of K.  A step along each, relaxed by Newton steps of least norm, either ends
/// in a neighbouring equilibrium (a family: rigid motions, finite mechanisms) or falls back (a degenerate
/// equilibrium such as x'' = −x³, which the linear model cannot describe; catalogue L13).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ZeroStiffness {
    /// Rank of K.
    pub rank: usize,
    /// Dimension of the family of equilibria through this one.
    pub family: usize,
    /// Directions without stiffness and without neighbouring equilibria.
    pub degenerate: Vec<Vec<f64>>,
}

impl ZeroStiffness {
    pub(super) fn of(base: &LinearisationPoint, q: &[f64], linear: bool) -> Result<ZeroStiffness, LinearError> {
        let [mass, _, stiffness] = base.cleaned(q);
        // In a linear mechanism every such direction leads to equilibria.
        ZeroStiffness::along(&mass, &stiffness, |direction| match linear {
            true => Ok(direction.to_vec()),
            false => relax(base, &mass, q, direction),
        })
    }

    /// From M and K, and where the state relaxes to after a step along a direction, as a departure in units of the step.
    ///
    /// # Errors
    /// Those of relaxing; decompositions that do not converge.
    pub(in crate::linear) fn along(
        mass: &SparseMatrix,
        stiffness: &SparseMatrix,
        relax: impl Fn(&[f64]) -> Result<Vec<f64>, LinearError>,
    ) -> Result<ZeroStiffness, LinearError> {
        let scaled = Scaled::new(mass);
        let failed = LinearError::NoConvergence { what: "the singular value decomposition of K" };
        let null = null_space(&scaled.stiffness(&stiffness.to_dense())).ok_or(failed)?;
        let (rank, free) = (mass.rows - null.ncols(), null.ncols());
        if free == 0 {
            return Ok(ZeroStiffness { rank, family: 0, degenerate: Vec::new() });
        }
        let mut reached = DMatrix::zeros(free, free);
        for k in 0..free {
            let moved = scaled.coordinates(&relax(&scaled.step(&null.column(k).into_owned()))?);
            let moved = moved.map(|x| if x.is_finite() { x.clamp(-2.0, 2.0) } else { 0.0 });
            reached.set_column(k, &(null.transpose() * moved));
        }
        let svd = svd(reached, false, true);
        let svd = svd.ok_or(LinearError::NoConvergence { what: "the singular value decomposition of a family" })?;
        let v_t = svd.v_t.unwrap_or_else(|| DMatrix::identity(free, free));
        let fallen: Vec<usize> = (0..free).filter(|k| svd.singular_values[*k] < 0.3).collect();
        let degenerate = fallen.iter().map(|k| scaled.step(&(&null * v_t.row(*k).transpose()))).collect();
        Ok(ZeroStiffness { rank, family: free - fallen.len(), degenerate })
    }
}

/// A step along a direction that is a part of the state's extent, and its length as a part of the direction.
pub(in crate::linear) fn beside(q: &[f64], direction: &[f64]) -> (Vec<f64>, f64) {
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let extent = if largest(q) > 0.0 { largest(q) } else { 1.0 };
    let length = 0.1 * extent / largest(direction).max(f64::MIN_POSITIVE);
    (q.iter().zip(direction).map(|(q, d)| q + length * d).collect(), length)
}

/// Where a step along a direction relaxes to.
fn relax(
    base: &LinearisationPoint,
    mass: &SparseMatrix,
    q: &[f64],
    direction: &[f64],
) -> Result<Vec<f64>, LinearError> {
    let scaled = Scaled::new(mass);
    let (mut point, length) = beside(q, direction);
    for _ in 0..RELAXATIONS {
        let force = base.force(&point);
        if force.iter().any(|f| !f.is_finite()) {
            break;
        }
        let step = least_step(mass, &base.stiffness(&point), &force)?;
        for (x, s) in point.iter_mut().zip(&step) {
            *x += s;
        }
        if scaled.norm(&step) <= 1e-12 * length * scaled.norm(direction) {
            break;
        }
    }
    Ok(point.iter().zip(q).map(|(x, q)| (x - q) / length).collect())
}
