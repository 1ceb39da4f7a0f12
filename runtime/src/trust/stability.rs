//! Whether a fixed step is stable.

use nalgebra::{Complex, DMatrix, Schur};

use super::Warning;
use crate::integrate::{Stability, stability};
use crate::mechanism::{AccelerationSlopes, At, Enforcement, Method, System};

/// More coordinates than this are not looked at: the eigenvalues would cost more than they tell.
const LARGEST: usize = 40;
/// Growth over the run that is worth a warning.
const GROWTH: f64 = 1.01;

/// Warns if a method at a fixed step amplifies a mode of the system linearised at the start by more than the
/// mechanism itself does.
///
/// With F(q, q', q'') = 0 linearised at the start, λ are the eigenvalues of [0 1; ∂a/∂q ∂a/∂q'], and a
/// step multiplies a mode by R(hλ), R the method's stability function (catalogue A1–A4).  [`Watchman`] repeats
/// the check along the motion.
pub(crate) fn check_step(
    system: &dyn System,
    (t, q, v): (f64, &[f64], &[f64]),
    method: Method,
    step: f64,
    span: f64,
) -> Option<Warning> {
    let stability = stability(method);
    let mut worst: Option<(f64, Complex<f64>)> = None;
    // A mode that grows by itself hides what the method adds to it.
    let bounded = |rate: &Complex<f64>| rate.re <= 1e-3 * rate.norm();
    for rate in rates(system, t, q, v)?.into_iter().filter(bounded) {
        let growth = excess(&stability, rate, step) * span;
        if growth > GROWTH.ln() && worst.is_none_or(|(known, _)| growth > known) {
            worst = Some((growth, rate));
        }
    }
    let (growth, rate) = worst?;
    Some(Warning::StepExceedsStability {
        method,
        step,
        limit: limit(&stability, rate, step),
        real: rate.re,
        imaginary: rate.im.abs(),
        growth: growth.exp(),
    })
}

/// Repeats [`check_step`] along a run.
#[derive(Clone, Debug)]
pub(crate) struct Watchman {
    method: Method,
    step: f64,
    span: f64,
    next: f64,
}

/// How often a run is checked, and for how many coordinates at most.
const CHECKS: f64 = 16.0;
const LARGEST_REPEATED: usize = 10;

impl Watchman {
    /// A watchman over a run of `span` seconds from t; `None` for a mechanism that is too large.
    pub fn new(system: &dyn System, method: Method, step: f64, t: f64, span: f64) -> Option<Self> {
        (system.len() <= LARGEST_REPEATED).then_some(Watchman { method, step, span, next: t })
    }

    /// Checks the state y at time t, if it is time to.
    pub fn check(&mut self, system: &dyn System, t: f64, y: &[f64]) -> Option<Warning> {
        if t < self.next {
            return None;
        }
        self.next = t + self.span / CHECKS;
        let n = system.len();
        check_step(system, (t, &y[..n], &y[n..2 * n]), self.method, self.step, self.span)
    }
}

/// By how much faster a mode grows than it should, 1/s: ln|R(hλ)|/h − max(Re λ, 0).
///
/// A step of a splitting or of Nyström's method multiplies λ and −λ together, of which one grows.
fn excess(stability: &Stability, rate: Complex<f64>, step: f64) -> f64 {
    let own = match stability {
        Stability::Splitting(_) | Stability::Nystrom(_) => rate.re.abs(),
        _ => rate.re.max(0.0),
    };
    stability.amplification(rate * step).ln() / step - own
}

/// The largest step below `step` up to which the mode does not grow faster than it should.
fn limit(stability: &Stability, rate: Complex<f64>, step: f64) -> f64 {
    const PARTS: u32 = 1000;
    // A part of round-off per step is no growth.
    let stable = |h: f64| excess(stability, rate, h) * h <= 1e-14;
    let part = |k: u32| step * f64::from(k) / f64::from(PARTS);
    let Some(first) = (1..=PARTS).find(|k| !stable(part(*k))) else { return step };
    if first == 1 {
        return 0.0;
    }
    let (mut low, mut high) = (part(first - 1), part(first));
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    low
}

/// The eigenvalues of the system linearised at a state, 1/s; `None` where they cannot be had.
pub(crate) fn rates(system: &dyn System, t: f64, q: &[f64], v: &[f64]) -> Option<Vec<Complex<f64>>> {
    // With constraints not all are of motions that remain; springs in their place are forces like others.
    let springs = matches!(system.enforcement(), Enforcement::Springs { .. });
    if !system.active_rows().is_empty() && !springs { None } else { all_rates(system, t, q, v) }
}

/// The same with constraints: to those of the motions that remain come zeros, of what the constraints do not let move.
pub(crate) fn all_rates(system: &dyn System, t: f64, q: &[f64], v: &[f64]) -> Option<Vec<Complex<f64>>> {
    if system.len() > LARGEST { None } else { rates_however_many(system, t, q, v) }
}

/// The same of any number of coordinates n, which takes some 200 n³ operations.
pub(crate) fn rates_however_many(system: &dyn System, t: f64, q: &[f64], v: &[f64]) -> Option<Vec<Complex<f64>>> {
    let n = system.len();
    if n == 0 {
        return None;
    }
    let mut slopes = AccelerationSlopes::new(n);
    slopes.evaluate(system, At::new(t, q, v)).ok()?;
    let mut matrix = DMatrix::zeros(2 * n, 2 * n);
    // In a unit of time of the mechanism's own, so that places and speeds count alike.
    let fastest = slopes.by_place().iter().fold(0.0_f64, |most, slope| most.max(slope.abs())).sqrt();
    let fastest = if fastest > 0.0 && fastest.is_finite() { fastest } else { 1.0 };
    (0..n).for_each(|i| matrix[(i, n + i)] = fastest);
    matrix.view_mut((n, 0), (n, n)).copy_from(&(DMatrix::from_row_slice(n, n, slopes.by_place()) / fastest));
    matrix.view_mut((n, n), (n, n)).copy_from(&DMatrix::from_row_slice(n, n, slopes.by_speed()));
    if matrix.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(matrix, f64::EPSILON, 100 * n)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}
