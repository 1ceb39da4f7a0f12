//! Records that a motion follows.

use nalgebra::{DMatrix, DVector};

use super::found::Found;
use super::least::{Spread, in_units};
use super::newton::{GAP, Linearised};
use super::search::{Equations, Seeker};
use super::trial::Trial;
use crate::error::{Error, NotFound};
use crate::mechanism::{List, Text};

/// Measured values at some times.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Times in order, s.
    pub times: Vec<f64>,
    /// Coordinates, rates or outputs with their values, SI, one for each time.
    pub columns: Vec<(String, Vec<f64>)>,
}

impl Record {
    /// Of the columns of a file, of which one is `t`.
    pub(super) fn of(columns: &[(Text, List<f64>)]) -> Record {
        let times = columns.iter().find(|(name, _)| name == "t");
        let others = columns.iter().filter(|(name, _)| name != "t");
        Record {
            times: times.map_or_else(Vec::new, |(_, times)| times.to_vec()),
            columns: others.map(|(name, values)| (name.to_string(), values.to_vec())).collect(),
        }
    }
}

/// How well a record determines what was unknown.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Fit {
    /// √(Σ r²/(N − k)): the standard deviation of a measured value, SI where there is one column, else in parts of each column's range.
    pub sigma: f64,
    /// Names of the columns that were compared.
    pub columns: Vec<String>,
    /// N − k.
    pub freedoms: usize,
    /// Standard errors of the values that were found, SI.
    pub standard_errors: Vec<f64>,
    /// How far these, and sigma as the last of all, may be off, in parts of each, by what runs at another tolerance and the last step say.
    pub uncertain: Vec<f64>,
    /// Half the width of the intervals that hold 95 % of the probability, by Student's t, SI.
    pub within: Vec<f64>,
    /// Their covariances, SI.
    pub covariance: DMatrix<f64>,
    /// What is left: measured values less the motion's, column by column, SI.
    pub residuals: Vec<Vec<f64>>,
    /// The record.
    pub record: Record,
}

/// Least squares of a record.
///
/// Source: Bates and Watts, Nonlinear Regression Analysis and Its Applications (1988), sections 1.3 and 2.2.
///
/// # Errors
/// A record without meaning; unknowns that it cannot tell apart; [`NotFound`].
pub(super) fn fit(seeker: &mut Seeker, guess: &[f64], record: &Record, places: &[usize]) -> Result<Found, Error> {
    check(seeker, guess, record)?;
    let scales = seeker.scales(guess, guess);
    let sizes = sizes(record);
    let equations =
        |seeker: &Seeker, trial: Trial, scales: &[f64]| residuals(seeker, trial, record, places, (&sizes, scales));
    let solution = seeker.newton(guess, &scales, &equations)?;
    // In logarithms of the unknowns, but of those that are next to nothing.
    let own = measures(&solution.equations.j, &seeker.scales(&solution.values, &solution.values), &scales);
    let factors = own.iter().zip(&scales).map(|(own, scale)| own / scale).collect::<Vec<f64>>();
    let linear = Linearised::new(&in_units(&solution.equations.j, &factors));
    if let Some(direction) = linear.free().first() {
        let direction = seeker.names.iter().cloned().zip(direction.iter().copied()).collect();
        return Err(NotFound::NotIdentified { direction }.into());
    }
    let spread = |equations: &Equations| Spread::of(equations, &factors, &own);
    let (solution, least) = seeker.least(solution, &scales, (&equations, &spread));
    let (errors, uncertain) = seeker.errors_of_least(&solution, &scales, &least, (&equations, &spread));
    let Spread { variance, covariance, standard_errors } = spread(&solution.equations);
    let freedoms = solution.equations.r.len() - guess.len();
    let quantile = student(freedoms);
    let length = record.times.len();
    let left = sizes
        .iter()
        .enumerate()
        .map(|(c, size)| (0..length).map(|k| -size * solution.equations.r[c * length + k]).collect());
    let fit = Fit {
        sigma: variance.sqrt() * if sizes.len() == 1 { sizes[0] } else { 1.0 },
        columns: record.columns.iter().map(|(name, _)| name.clone()).collect(),
        freedoms,
        within: standard_errors.iter().map(|error| quantile * error).collect(),
        standard_errors,
        uncertain,
        covariance,
        residuals: left.collect(),
        record: record.clone(),
    };
    Ok(Found { fit: Some(fit), ..seeker.found(solution, errors) })
}

/// What changes of the unknowns are measured by: the values that were found; of one that is found next to 0, whose own size would change
/// nothing in the record, by what changes as much in it as the others' sizes do.  One of which the size of its guess changes nothing either
/// keeps its own.
fn measures(j: &DMatrix<f64>, sizes: &[f64], scales: &[f64]) -> Vec<f64> {
    let slopes: Vec<f64> = j.column_iter().zip(scales).map(|(column, scale)| column.norm() / scale).collect();
    let most = slopes.iter().zip(sizes).fold(0.0_f64, |most, (slope, size)| most.max(slope * size));
    let measure = |((slope, size), scale): ((&f64, &f64), &f64)| {
        let is_next_to_nothing = slope * size < GAP * most && slope * scale >= GAP * most;
        if is_next_to_nothing { most / slope } else { *size }
    };
    slopes.iter().zip(sizes).zip(scales).map(measure).collect()
}

fn check(seeker: &Seeker, guess: &[f64], record: &Record) -> Result<(), Error> {
    let count = record.times.len() * record.columns.len();
    let settings = &seeker.source.settings;
    let ordered = record.times.windows(2).all(|pair| pair[0] < pair[1]);
    let within = record.times.iter().all(|t| *t >= settings.from && *t <= settings.until);
    let finite = record.columns.iter().all(|(_, values)| values.iter().all(|x| x.is_finite()));
    let even = record.columns.iter().all(|(_, values)| values.len() == record.times.len());
    let why = match (ordered && even && finite, within, count > guess.len() && !guess.is_empty()) {
        (false, ..) => "its times must rise, and every time must have a number in every column",
        (_, false, _) => "its times must lie between the start and the end of the run",
        (.., false) => "it must have more numbers than there are unknowns, and there must be one",
        _ => return Ok(()),
    };
    Err(NotFound::BadRecord { why }.into())
}

/// What values of a column are measured by: 1 of one alone, else the range of each.
fn sizes(record: &Record) -> Vec<f64> {
    let range = |(_, values): &(String, Vec<f64>)| {
        let [low, high] =
            values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
        Some(high - low).filter(|range| *range > 0.0).unwrap_or(1.0)
    };
    record.columns.iter().map(range).collect()
}

fn residuals(
    seeker: &Seeker,
    trial: Trial,
    record: &Record,
    places: &[usize],
    (sizes, scales): (&[f64], &[f64]),
) -> Equations {
    let (length, n) = (record.times.len(), scales.len());
    let (mut r, mut j) =
        (DVector::from_element(length * places.len(), f64::NAN), DMatrix::zeros(length * places.len(), n));
    for (k, point) in trial.varied.points.iter().enumerate().take(length) {
        for (c, (column, (_, values))) in places.iter().zip(&record.columns).enumerate() {
            r[c * length + k] = (point.values[*column] - values[k]) / sizes[c];
            for (i, slope) in trial.slopes(&seeker.source.sought, point, *column).iter().enumerate() {
                j[(c * length + k, i)] = slope * scales[i] / sizes[c];
            }
        }
    }
    let units = DVector::from_element(r.len(), 1.0);
    Equations { trial, r, j, units }
}

/// t with P(|T| < t) = 0.95 of Student's distribution with ν degrees of freedom, by bisection: over the angle θ with t = √ν tan θ its density is
/// ∝ cos^(ν − 1) θ, which Simpson's rule integrates.
fn student(freedoms: usize) -> f64 {
    let nu = freedoms as f64;
    const PARTS: usize = 2000;
    let density = |theta: f64| theta.cos().powf(nu - 1.0);
    let integral = |to: f64| {
        let h = to / PARTS as f64;
        let weight = |k: usize| {
            if k == 0 || k == PARTS {
                1.0
            } else if k % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        (0..=PARTS).map(|k| weight(k) * density(h * k as f64)).sum::<f64>() * h / 3.0
    };
    let whole = integral(std::f64::consts::FRAC_PI_2);
    let [mut low, mut high] = [0.0, std::f64::consts::FRAC_PI_2];
    while high - low > 1e-13 {
        let middle = 0.5 * (low + high);
        if integral(middle) < 0.95 * whole { low = middle } else { high = middle }
    }
    nu.sqrt() * low.tan()
}

#[cfg(test)]
mod tests {
    /// Tables of Student's distribution.
    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedoms, t) in [(1, 12.7062), (2, 4.30265), (10, 2.22814), (197, 1.97208)] {
            assert!((super::student(freedoms) - t).abs() < 1e-4 * t, "{freedoms}: {}", super::student(freedoms));
        }
    }
}
