//! The numbers that decide on stability, such that they move smoothly with a parameter.

use nalgebra::{Complex, DMatrix};

use super::{BranchPoint, State};
use crate::linear::matrices::{Scaled, cholesky, null_space, symmetric_eigen};
use crate::linear::{LinearError, Linearised};
use crate::matrix::is_symmetric;

/// Parts of an eigenvalue below this are what rounding makes of a double one.
const SPLIT: f64 = 1e-7;
/// Parts below this are rounding of eigenvalues that are not double.
const ROUNDING: f64 = 1e-12;

/// λ, or where no force depends on speed κ = −λ², the eigenvalues of M⁻¹K: these do not turn back where two meet.
#[derive(Clone, Debug)]
pub(in crate::linear) struct Spectrum {
    /// Sorted; those that are 0 by rank are left out.
    pub values: Vec<Complex<f64>>,
    squares: bool,
    /// Symmetric: eigenvalues are real, and may pass each other.
    symmetric: bool,
    /// Real parts up to this are rounding.
    floor: f64,
    /// All λ.
    pub eigenvalues: Vec<Complex<f64>>,
}

impl Spectrum {
    pub fn of(linear: &Linearised) -> Result<Spectrum, LinearError> {
        let stiffness = linear.k();
        let squares = linear.damping.is_zero();
        let mut free = 0;
        let (mut values, symmetric) = if squares {
            let failed = || LinearError::NoConvergence { what: "the singular value decomposition of K" };
            free = null_space(&Scaled::new(&linear.mass).stiffness(&stiffness)).ok_or_else(failed)?.ncols();
            let factor = cholesky(&linear.m()).map_err(|index| linear.singular(index))?;
            let mut half = stiffness;
            factor.solve_lower_triangular_mut(&mut half);
            let mut whole = half.transpose();
            factor.solve_lower_triangular_mut(&mut whole);
            let symmetric = linear.circulatory().is_zero();
            (of_matrix(whole.transpose(), symmetric)?, symmetric)
        } else {
            (linear.eigenvalues()?.into_iter().filter(|x| x.norm() > 0.0).collect(), false)
        };
        // Those that are 0 by rank stay what they are.
        values.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        values.drain(..free.min(values.len()));
        let norm = values.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
        let eigenvalues: Vec<Complex<f64>> = match squares {
            true => {
                let zeros = std::iter::repeat_n(Complex::new(0.0, 0.0), 2 * free);
                zeros.chain(values.iter().flat_map(|kappa| both_roots(*kappa))).collect()
            }
            false => linear.eigenvalues()?,
        };
        let dissipates = !linear.dissipative().is_zero();
        let floor = if dissipates { 64.0 * linear.len() as f64 * f64::EPSILON } else { SPLIT };
        values
            .sort_by(|a, b| a.im.abs().total_cmp(&b.im.abs()).then(a.re.total_cmp(&b.re)).then(a.im.total_cmp(&b.im)));
        if symmetric {
            values.sort_by(|a, b| a.re.total_cmp(&b.re));
        }
        let floor = if squares { SPLIT } else { floor * norm };
        Ok(Spectrum { values, squares, symmetric, floor, eigenvalues })
    }

    /// The state of a branch that it belongs to.
    pub(super) fn point(self, State { q, value }: State, folded: bool) -> BranchPoint {
        BranchPoint { value, q, growing: self.growing(), eigenvalues: self.eigenvalues, folded }
    }

    /// How many modes grow.
    pub fn growing(&self) -> usize {
        self.values.iter().filter(|x| self.grows(x, SPLIT)).count()
    }

    /// The same by a finer measure of κ, which double ones with one shape may not bear.
    pub fn finely_growing(&self) -> usize {
        self.values.iter().filter(|x| self.grows(x, ROUNDING)).count()
    }

    fn grows(&self, x: &Complex<f64>, part: f64) -> bool {
        let real = x.im.abs() <= part * x.norm();
        match self.squares {
            // √−κ has a positive real part: κ < 0, or a pair off the axis.
            true => (real && x.re < 0.0) || (!real && x.im > 0.0),
            // Between two that are δ apart rounding leaves real parts of ε/δ: no measure is finer than √ε.
            false => x.re > self.floor && x.im >= 0.0,
        }
    }

    /// Im λ of the growing mode that is nearest to the border; 0 where it does not oscillate.
    pub fn border(&self) -> Option<f64> {
        let lambda = |x: &Complex<f64>| if self.squares { both_roots(*x)[0] } else { *x };
        let growing = self.values.iter().filter(|x| self.grows(x, ROUNDING)).map(lambda);
        let nearest = growing.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))?;
        Some(if nearest.im.abs() <= SPLIT * nearest.norm() { 0.0 } else { nearest.im.abs() })
    }

    /// True where nothing can have happened on the way to another spectrum: no value has moved by more than a part of
    /// its distance from the others and from the border of stability.
    pub fn is_near(&self, other: &Spectrum) -> bool {
        if self.values.len() != other.values.len() || self.squares != other.squares || self.symmetric != other.symmetric
        {
            return false;
        }
        if self.symmetric {
            let pairs = self.values.iter().zip(&other.values);
            return pairs
                .into_iter()
                .all(|(a, b)| (a - b).norm() <= 0.5 * a.norm().max(b.norm()) && a.re * b.re >= 0.0);
        }
        self.all_near(other) && other.all_near(self)
    }

    fn all_near(&self, other: &Spectrum) -> bool {
        self.values.iter().enumerate().all(|(k, x)| {
            let apart = |y: &Complex<f64>| (y - x).norm();
            let moved = other.values.iter().map(apart).fold(f64::INFINITY, f64::min);
            let others = self.values.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, y)| apart(y));
            // Double ones stay double, or part by more than rounding.
            let gap = others.filter(|gap| *gap > SPLIT * x.norm()).fold(f64::INFINITY, f64::min);
            let border = match self.squares {
                true => x.norm(),
                // What lies on the axis for want of damping has no distance from it.
                false if x.re.abs() <= self.floor.max(SPLIT * x.norm() * f64::from(u8::from(self.floor == 0.0))) => {
                    f64::INFINITY
                }
                false => x.re.abs(),
            };
            let across = match self.squares {
                true => moved,
                false => other
                    .values
                    .iter()
                    .min_by(|a, b| apart(a).total_cmp(&apart(b)))
                    .map_or(f64::INFINITY, |y| (y.re - x.re).abs()),
            };
            moved <= 0.3 * gap && across <= 0.5 * border
        })
    }
}

/// The square roots of −κ, that with a positive real part (or on the upper axis) first.
fn both_roots(kappa: Complex<f64>) -> [Complex<f64>; 2] {
    let root = match (kappa.im == 0.0, kappa.re > 0.0) {
        (true, true) => Complex::new(0.0, kappa.re.sqrt()),
        (true, false) => Complex::new((-kappa.re).sqrt(), 0.0),
        (false, _) => (-kappa).sqrt(),
    };
    [root, -root]
}

fn of_matrix(matrix: DMatrix<f64>, symmetric: bool) -> Result<Vec<Complex<f64>>, LinearError> {
    let failed = LinearError::NoConvergence { what: "the eigenvalue iteration" };
    if symmetric || is_symmetric(&matrix) {
        let (values, _) = symmetric_eigen((&matrix + matrix.transpose()) * 0.5).ok_or(failed)?;
        return Ok(values.iter().map(|x| Complex::from(*x)).collect());
    }
    #[cfg(feature = "modal")]
    return crate::linear::matrices::Eigen::of(&matrix).map(|found| found.values).ok_or(failed);
    #[cfg(not(feature = "modal"))]
    Err(LinearError::NeedsFeature { feature: "modal" })
}
