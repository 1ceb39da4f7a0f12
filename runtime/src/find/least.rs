//! Least squares with residuals that stay: where their slopes vanish, and how far that may be off.
//!
//! Of S = |r|²/2 the gradient is g = Jᵀ r, and its slopes are H = JᵀJ + Σ r ∇²r.  Gauss-Newton steps leave the second part out, which makes them
//! shorter by the same factor each time where residuals stay, and what another run would change by another J as well (Bates and Watts,
//! Nonlinear Regression Analysis and Its Applications, 1988, section 2.2.1).  H comes from differences of g: it only steers, and tells errors.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::errors::Errors;
use super::newton::Linearised;
use super::search::{Equations, LEAST, Seeker, Solution};
use super::trial::Trial;
use crate::vary::Second;

/// Steps with one H: each is shorter than the one before by the error of H, 1e-4 and less, so that a few come to rounding.
const MOST_STEPS: usize = 8;

/// A column of J, or a number of a solution, in other units of each unknown.
pub(super) fn in_units(j: &DMatrix<f64>, factors: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(j.nrows(), factors.len(), |i, k| j[(i, k)] * factors[k])
}

/// How far unknowns are spread by what is left.
pub(super) struct Spread {
    /// Σ r²/(N − k).
    pub variance: f64,
    /// SI.
    pub covariance: DMatrix<f64>,
    /// SI.
    pub standard_errors: Vec<f64>,
}

impl Spread {
    /// Of residuals and their slopes, with the factors that bring the slopes' units to the unknowns' own sizes.
    pub fn of(equations: &Equations, factors: &[f64], own: &[f64]) -> Spread {
        let unknowns = own.len();
        let linear = Linearised::new(&in_units(&equations.j, factors));
        let variance = equations.r.norm_squared() / (equations.r.len() - unknowns) as f64;
        let sizes = DMatrix::from_fn(unknowns, unknowns, |i, k| own[i] * own[k]);
        let covariance = sizes.component_mul(&linear.covariance()) * variance;
        let standard_errors = (0..unknowns).map(|k| covariance[(k, k)].sqrt()).collect();
        Spread { variance, covariance, standard_errors }
    }

    /// Logarithms of the standard errors, and of sigma as the last.
    fn logarithms(&self) -> DVector<f64> {
        let sizes = self.standard_errors.iter().copied().chain([self.variance.sqrt()]);
        DVector::from_iterator(self.standard_errors.len() + 1, sizes.map(f64::ln))
    }
}

/// S near its least value.
pub(super) struct Least {
    /// H; `None` where it is not known, or S has no least value there.
    slopes: Option<Cholesky<f64, Dyn>>,
    /// Slopes of the logarithms of what is spread.
    spread: DMatrix<f64>,
}

impl Least {
    /// The step to where g vanishes.
    fn step(&self, equations: &Equations) -> Option<DVector<f64>> {
        self.slopes.as_ref().map(|slopes| -slopes.solve(&gradient(equations)))
    }
}

/// Equations of a trial, and what is spread by them.
type By<'a> = (&'a dyn Fn(&Seeker, Trial, &[f64]) -> Equations, &'a dyn Fn(&Equations) -> Spread);

impl Seeker {
    /// From where Gauss-Newton steps ended to where the gradient vanishes.
    pub fn least(&mut self, mut solution: Solution, scales: &[f64], (equations, spread): By<'_>) -> (Solution, Least) {
        let least = self.curvature(&solution, scales, (equations, spread));
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let Some(step) = least.step(&solution.equations) else { break };
            let size = step.norm();
            // Half as long at least, or rounding is all that is left.
            if size <= LEAST || size > 0.5 * before {
                break;
            }
            let next = moved(&solution.values, scales, &step);
            let Ok(trial) = self.try_at(&next) else { break };
            if !trial.varied.agrees(&solution.equations.trial.varied) {
                break;
            }
            let tried = equations(self, trial, scales);
            solution = Solution { linear: Linearised::new(&tried.j), values: next, equations: tried, ..solution };
            solution.steps += 1;
            before = size;
        }
        (solution, least)
    }

    /// H at a solution, by differences over the root of the tolerance, where truncation and errors of runs are alike.
    fn curvature(&mut self, solution: &Solution, scales: &[f64], (equations, spread): By<'_>) -> Least {
        let n = scales.len();
        let away = self.source.settings.tolerance.sqrt();
        let [here, spread_here] = [gradient(&solution.equations), spread(&solution.equations).logarithms()];
        let (mut slopes, mut spreads) = (DMatrix::zeros(n, n), DMatrix::zeros(n + 1, n));
        let mut known = true;
        for k in 0..n {
            let side = |away: f64| DVector::from_fn(n, |i, _| if i == k { away } else { 0.0 });
            let found = [away, -away].into_iter().find_map(|away| {
                let trial = self.try_at(&moved(&solution.values, scales, &side(away))).ok()?;
                trial.varied.agrees(&solution.equations.trial.varied).then_some((away, equations(self, trial, scales)))
            });
            let Some((away, there)) = found else {
                known = false;
                continue;
            };
            slopes.set_column(k, &((gradient(&there) - &here) / away));
            spreads.set_column(k, &((spread(&there).logarithms() - &spread_here) / away));
        }
        let slopes = 0.5 * (&slopes + slopes.transpose());
        Least { slopes: known.then(|| Cholesky::new(slopes)).flatten(), spread: spreads }
    }

    /// What the gradient of a second run would have the unknowns be otherwise, and the last step; and how far what is spread may be off, in parts.
    pub fn errors_of_least(
        &mut self,
        solution: &Solution,
        scales: &[f64],
        least: &Least,
        (equations, spread): By<'_>,
    ) -> (Errors, Vec<f64>) {
        self.runs += 1;
        let second = self.source.second(&solution.values, &solution.equations.trial);
        let (Some(Second { run: other, told }), Some(step)) = (second, least.step(&solution.equations)) else {
            let unknown = |count| vec![f64::NAN; count];
            let errors = Errors { values: unknown(scales.len()), reached: Vec::new(), end: f64::NAN };
            return (errors, unknown(scales.len() + 1));
        };
        let ends_alike = told * self.end_difference(&solution.equations.trial, &other);
        let other = equations(self, other, scales);
        let otherwise = least.step(&other).map_or_else(|| step.clone(), |there| there - &step);
        let off = (told * otherwise.abs()).add_scalar(step.norm());
        let spread = told * (spread(&other).logarithms() - spread(&solution.equations).logarithms()).abs()
            + least.spread.abs() * &off;
        let values: Vec<f64> = off.iter().zip(scales).map(|(off, scale)| off * scale).collect();
        let end = ends_alike + self.end_error(&solution.equations.trial, &values);
        (Errors { values, reached: Vec::new(), end }, spread.iter().copied().collect())
    }
}

/// g.
fn gradient(equations: &Equations) -> DVector<f64> {
    equations.j.tr_mul(&equations.r)
}

fn moved(values: &[f64], scales: &[f64], step: &DVector<f64>) -> Vec<f64> {
    values.iter().zip(scales).zip(step.iter()).map(|((x, scale), step)| x + scale * step).collect()
}
