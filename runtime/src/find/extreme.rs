//! Largest and smallest values.

use nalgebra::{DMatrix, DVector};

use super::errors::{end_time, value_list};
use super::found::Found;
use super::newton::Linearised;
use super::search::{HALVES, MISSED, STEPS, Seeker};
use super::trial::Trial;
use crate::error::{Error, NotFound};
use crate::mechanism::Extreme;
use crate::vary::Second;

/// By what part of itself an unknown is moved to see how slopes change.  Slopes are known to some eleven digits, so that five of the second
/// derivatives are right: they decide how fast the search converges, not where it ends.
const MOVE: f64 = 1e-6;
/// Curvatures below this part of the value, or of the largest curvature, are none: second derivatives are known to five digits.
const FLAT: f64 = 1e-5;
/// By what part of itself the gain of a step may differ from what was foretold: the curvature on the way has the same sign as here, as a rule.
const FORETOLD: f64 = 0.5;
/// The longest step along a direction that leads to no top, in parts of the unknowns: they at most lose half of themselves.
const WITHOUT_TOP: f64 = 0.5;

/// The extreme, its gradient and the conditions at some values of the unknowns, in their scales.
struct Place {
    trial: Trial,
    value: f64,
    gradient: DVector<f64>,
    c: DVector<f64>,
    j: DMatrix<f64>,
}

/// A step, and what it was made of.
struct Step {
    x: DVector<f64>,
    /// Eigenvalues of the second derivatives along the conditions.
    curvatures: DVector<f64>,
}

/// Finds an extreme value near a guess, under the conditions there are.
///
/// # Errors
/// [`NotFound`]; what ends the first run early.
pub(super) fn find(
    seeker: &mut Seeker,
    guess: &[f64],
    (column, name, extreme): &(usize, String, Extreme),
) -> Result<Found, Error> {
    if guess.is_empty() {
        return Err(NotFound::NothingWanted.into());
    }
    let sign = if *extreme == Extreme::Largest { 1.0 } else { -1.0 };
    let scales = seeker.scales(guess, guess);
    let mut values = guess.to_vec();
    let first = seeker.try_at(&values)?;
    let mut now = place(seeker, first, *column, sign, &scales);
    let mut before = f64::INFINITY;
    for steps in 0..STEPS {
        let hessian = second_derivatives(seeker, &values, &now, (*column, sign), &scales)?;
        let step = step(&now, &hessian);
        let size = step.x.norm();
        let rounding = seeker.source.settings.tolerance.sqrt();
        if size <= 1e-13 || size < rounding && size > 0.5 * before {
            return finish(seeker, (values, now, step), (*column, name, sign), &scales, steps);
        }
        let Some((next, tried)) = shortened(seeker, &values, (&now, &hessian, &step), (*column, sign), &scales)? else {
            if size < rounding {
                return finish(seeker, (values, now, step), (*column, name, sign), &scales, steps);
            }
            return Err(seeker.stuck(&now.trial, &values).into());
        };
        (values, now, before) = (next, tried, size);
    }
    Err(NotFound::NoExtreme { name: name.clone(), values: seeker.named(&values) }.into())
}

fn place(seeker: &Seeker, trial: Trial, column: usize, sign: f64, scales: &[f64]) -> Place {
    let (value, slopes) = match trial.end() {
        Some(end) => (end.values[column], trial.slopes(&seeker.source.sought, end, column)),
        None => (f64::NAN, vec![f64::NAN; scales.len()]),
    };
    let gradient = slopes.iter().zip(scales).map(|(slope, scale)| sign * slope * scale);
    let gradient = DVector::from_iterator(scales.len(), gradient);
    let equations = seeker.conditions_of(trial, scales);
    Place { trial: equations.trial, value: sign * value, gradient, c: equations.r, j: equations.j }
}

/// Multipliers μ with which the gradient is nearest to Jᵀ μ.
fn multipliers(place: &Place) -> DVector<f64> {
    if place.c.is_empty() {
        return DVector::zeros(0);
    }
    Linearised::new(&place.j.transpose()).step(&-&place.gradient)
}

/// Second derivatives of the extreme less μ times the conditions, by differences of exact slopes.
fn second_derivatives(
    seeker: &mut Seeker,
    values: &[f64],
    now: &Place,
    (column, sign): (usize, f64),
    scales: &[f64],
) -> Result<DMatrix<f64>, Error> {
    let mu = multipliers(now);
    let along = |place: &Place| &place.gradient - place.j.transpose() * &mu;
    let here = along(now);
    let mut hessian = DMatrix::zeros(scales.len(), scales.len());
    for k in 0..scales.len() {
        let mut moved = values.to_vec();
        moved[k] += MOVE * scales[k];
        let trial = seeker.try_at(&moved)?;
        let there = along(&place(seeker, trial, column, sign, scales));
        hessian.set_column(k, &((there - &here) / MOVE));
    }
    Ok(0.5 * (&hessian + hessian.transpose()))
}

/// Newton's step on the conditions, and along them one that leads uphill in every direction: g/|λ|.  A direction that is curved downhill has a
/// top, and the step leads there however far it is; others have none, and no unknown moves by more than [`WITHOUT_TOP`] along them.
fn step(now: &Place, hessian: &DMatrix<f64>) -> Step {
    let n = now.gradient.len();
    let linear = Linearised::new(&if now.c.is_empty() { DMatrix::zeros(1, n) } else { now.j.clone() });
    let met = if now.c.is_empty() { DVector::zeros(n) } else { linear.step(&now.c) };
    let free = linear.free();
    if free.is_empty() {
        return Step { x: met, curvatures: DVector::zeros(0) };
    }
    let z = DMatrix::from_columns(&free);
    let reduced = (z.transpose() * hessian * &z).symmetric_eigen();
    let slope = z.transpose() * (&now.gradient + hessian * &met);
    let flat = flat(now, &reduced.eigenvalues);
    let mut along = DVector::zeros(free.len());
    for (k, curvature) in reduced.eigenvalues.iter().enumerate() {
        let direction = reduced.eigenvectors.column(k);
        let step = direction.dot(&slope) / curvature.abs().max(f64::MIN_POSITIVE);
        let has_top = *curvature < -flat;
        along.axpy(if has_top { step } else { step.clamp(-WITHOUT_TOP, WITHOUT_TOP) }, &direction, 1.0);
    }
    Step { x: met + z * along, curvatures: reduced.eigenvalues }
}

/// Curvatures of this size are none.
fn flat(now: &Place, curvatures: &DVector<f64>) -> f64 {
    FLAT * curvatures.iter().fold(now.value.abs(), |most, x| most.max(x.abs()))
}

/// The first of a step's halves whose gain the slopes and the curvature foretold to within [`FORETOLD`] of it; where conditions act, or where the
/// gain is rounding, after which the next step would be shorter.
///
/// Source: Conn, Gould, Toint, Trust-Region Methods (2000), section 6.1, for the test of the gain.
fn shortened(
    seeker: &mut Seeker,
    values: &[f64],
    (now, hessian, taken): (&Place, &DMatrix<f64>, &Step),
    (column, sign): (usize, f64),
    scales: &[f64],
) -> Result<Option<(Vec<f64>, Place)>, Error> {
    let mut part = 1.0;
    (seeker.fault, seeker.other_event) = (None, None);
    let rounding = seeker.source.settings.tolerance * now.trial.size(column).max(now.value.abs());
    for _ in 0..HALVES {
        let way = part * &taken.x;
        let next: Vec<f64> =
            values.iter().zip(scales).zip(way.iter()).map(|((x, scale), step)| x + scale * step).collect();
        if let Some(trial) = seeker.unless_broken_off(&next, values)?
            && trial.varied.agrees(&now.trial.varied)
        {
            let tried = place(seeker, trial, column, sign, scales);
            let (gain, foretold) = (tried.value - now.value, now.gradient.dot(&way) + 0.5 * (hessian * &way).dot(&way));
            let better = if now.c.is_empty() && foretold > rounding {
                (gain - foretold).abs() <= FORETOLD * foretold
            } else {
                step(&tried, hessian).x.norm() <= (1.0 - 0.5 * part) * taken.x.norm()
            };
            if better {
                return Ok(Some((next, tried)));
            }
        }
        part *= 0.5;
    }
    Ok(None)
}

fn finish(
    seeker: &mut Seeker,
    (values, now, step): (Vec<f64>, Place, Step),
    (column, name, sign): (usize, &str, f64),
    scales: &[f64],
    steps: usize,
) -> Result<Found, Error> {
    if now.c.iter().any(|c| c.abs() > MISSED) {
        let residuals = seeker.residuals(&now.trial);
        return Err(NotFound::Contradictory { residuals, values: seeker.named(&values) }.into());
    }
    if step.curvatures.is_empty() {
        return Err(NotFound::NothingFree { name: name.to_owned(), values: seeker.named(&values) }.into());
    }
    let flat = flat(&now, &step.curvatures);
    if step.curvatures.iter().any(|curvature| *curvature > -flat) {
        return Err(NotFound::NoExtreme { name: name.to_owned(), values: seeker.named(&values) }.into());
    }
    // A second run has its gradient vanish elsewhere.
    seeker.runs += 1;
    let columns: Vec<usize> = seeker.conditions.iter().map(|condition| condition.column).chain([column]).collect();
    let (errors, off, later) = match seeker.source.second(&values, &now.trial) {
        Some(Second { run: other, told }) => {
            let later = told * seeker.end_difference(&now.trial, &other);
            let off: Vec<f64> =
                columns.iter().map(|k| told * (other.at_end(*k) - now.trial.at_end(*k)).abs()).collect();
            let other = place(seeker, other, column, sign, scales);
            let moved = told * (&other.gradient - &now.gradient).norm();
            let least = step.curvatures.iter().fold(f64::INFINITY, |least, x| least.min(x.abs()));
            let error = moved / least + step.x.norm();
            (scales.iter().map(|scale| scale * error).collect::<Vec<f64>>(), off, later)
        }
        None => (vec![f64::NAN; scales.len()], vec![f64::NAN; columns.len()], f64::NAN),
    };
    let end = end_time(&now.trial, later + seeker.end_error(&now.trial, &errors));
    let told: Vec<String> =
        seeker.conditions.iter().map(|condition| condition.name.clone()).chain([name.to_owned()]).collect();
    let reached: Vec<f64> = columns.iter().map(|k| now.trial.at_end(*k)).collect();
    Ok(Found {
        values: value_list(&seeker.names, &values, &errors),
        reached: value_list(&told, &reached, &off),
        end_time: end,
        run: now.trial.varied.run,
        steps,
        runs: seeker.runs,
        free: Vec::new(),
        multiplicity: 1,
        multiple_in: Vec::new(),
        fit: None,
    })
}
