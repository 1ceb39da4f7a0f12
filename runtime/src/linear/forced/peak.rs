//! The largest size of an answer over a range of frequencies, to rounding: where 1/|Y|² has no slope, between the samples of a response.

use nalgebra::{Complex, DVector};

use super::response::ROUNDING;
use super::{Drive, Observed, Response};
use crate::linear::{LinearError, Linearised};

/// The largest size of an answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Where it is, rad/s.
    pub omega: f64,
    /// The size.
    pub size: f64,
    /// How far from there rounding lets the size be as large, rad/s; 0 at an end of the range, all of the range where the size never changes.
    pub width: f64,
}

/// What a sampled maximum may be below its peak, in parts of that: samples stand a seventh of half a peak's width apart
/// ([`Linearised::telling_frequencies`]), which leaves 1/200, and ones that are straight within 2e-3 of a figure of two decades 1/100.  A
/// sampled maximum below this part of the largest is none.
const RIVALS: f64 = 0.9;
/// Steps in which a root is bracketed to the last digit: bisection alone needs 53 and some for the exponent.
const MOST_STEPS: usize = 80;

/// An answer at a frequency.
#[derive(Clone, Copy)]
struct Slope {
    omega: f64,
    size: f64,
    /// The slope of 1/|Y|² by Ω: beside a resonance that is nearly a parabola, of which |Y| itself has nothing.
    slope: f64,
    /// What of it is rounding.
    noise: f64,
}

impl Linearised {
    /// The largest size of each answer of a response; `None` where it has no value.  Beside undamped modes it is that of a sample.
    ///
    /// # Errors
    /// As [`Linearised::answers`].
    pub fn peaks(
        &self,
        drive: &Drive,
        observed: &Observed,
        response: &Response,
    ) -> Result<Vec<Option<Peak>>, LinearError> {
        (0..response.names.len()).map(|k| self.peak(drive, observed, (response, k))).collect()
    }

    fn peak(
        &self,
        drive: &Drive,
        observed: &Observed,
        (response, k): (&Response, usize),
    ) -> Result<Option<Peak>, LinearError> {
        let size = |answer: &Option<Vec<Complex<f64>>>| answer.as_ref().map_or(0.0, |answer| answer[k].norm());
        let sizes: Vec<f64> = response.answers.iter().map(size).collect();
        let sampled = |at: usize| Peak { omega: response.omegas[at], size: sizes[at], width: 0.0 };
        let Some(largest) = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b])) else { return Ok(None) };
        let mut best = sampled(largest);
        if best.size == 0.0 {
            return Ok(Some(best));
        }
        let last = sizes.len() - 1;
        if sizes.iter().all(|size| best.size - size <= ROUNDING * best.size) {
            best.width = response.omegas[last] - response.omegas[0];
            return Ok(Some(best));
        }
        for at in (0..=last).filter(|at| sizes[*at] >= RIVALS * sizes[largest]) {
            let (before, after) = (at.saturating_sub(1), (at + 1).min(last));
            if sizes[before] > sizes[at] || sizes[after] > sizes[at] {
                continue;
            }
            let (low, high) = (response.omegas[before], response.omegas[after]);
            if response.poles.iter().any(|pole| (low..=high).contains(pole)) {
                continue;
            }
            let found = self.between(|omega| self.slope(drive, observed, k, omega), (low, high))?;
            best = found.filter(|found| found.size >= best.size).unwrap_or(best);
        }
        Ok(Some(best))
    }

    /// The largest size between two frequencies, between which 1/|Y|² falls first and then rises; `None` where it has no slope.
    fn between(
        &self,
        at: impl Fn(f64) -> Result<Option<Slope>, LinearError>,
        (low, high): (f64, f64),
    ) -> Result<Option<Peak>, LinearError> {
        let (Some(mut a), Some(mut b)) = (at(low)?, at(high)?) else { return Ok(None) };
        let end = |x: Slope| Some(Peak { omega: x.omega, size: x.size, width: 0.0 });
        match (a.slope < 0.0, b.slope > 0.0) {
            (false, _) => return Ok(end(a)),
            (true, false) => return Ok(end(b)),
            (true, true) => {}
        }
        let mut best = if a.size > b.size { a } else { b };
        // The method of false position, which halves the weight of an end that stays (Illinois), and the interval where that leaves it.
        let (mut of_a, mut of_b) = (a.slope, b.slope);
        for step in 0..MOST_STEPS {
            let wide = b.omega - a.omega;
            let secant = (a.omega * of_b - b.omega * of_a) / (of_b - of_a);
            let middle = 0.5 * (a.omega + b.omega);
            let inside = secant > a.omega && secant < b.omega && step % 4 != 3;
            let omega = if inside { secant } else { middle };
            if wide <= 2.0 * f64::EPSILON * b.omega || omega <= a.omega || omega >= b.omega {
                break;
            }
            let Some(found) = at(omega)? else { break };
            best = found;
            if found.slope.abs() <= found.noise {
                break;
            }
            if found.slope < 0.0 {
                (a, of_a, of_b) = (found, found.slope, 0.5 * of_b);
            } else {
                (b, of_b, of_a) = (found, found.slope, 0.5 * of_a);
            }
        }
        // As far as rounding hides the slope.
        let mut width = 2.0 * f64::EPSILON * best.omega;
        let hidden = |omega: f64| Ok(at(omega)?.is_some_and(|found| found.slope.abs() <= found.noise));
        while width < high - low && (hidden(best.omega - width)? || hidden(best.omega + width)?) {
            width *= 2.0;
        }
        Ok(Some(Peak { omega: best.omega, size: best.size, width }))
    }

    /// An answer with the slope of 1/|Y|²; `None` on an undamped mode and where the answer vanishes.
    ///
    /// With Z X = F, Z X' = F' − Z' X.  Z, F, and at a fixed X also Y, are polynomials of degree 2 in Ω, whose slopes are their exact
    /// quotients of differences between 2 Ω and 0.
    fn slope(&self, drive: &Drive, observed: &Observed, k: usize, omega: f64) -> Result<Option<Slope>, LinearError> {
        let solved = |force: &[Complex<f64>]| match self.steady_state(force, omega) {
            Err(LinearError::Resonance { .. }) => Ok(None),
            other => other.map(Some),
        };
        let Some(x) = solved(&self.driving_force(drive, omega)?)? else { return Ok(None) };
        let per = 1.0 / (2.0 * omega);
        let turning =
            (self.dynamic_stiffness(2.0 * omega) - self.dynamic_stiffness(0.0)) * DVector::from_column_slice(&x);
        let forces = self.driving_force(drive, 2.0 * omega)?.into_iter().zip(self.driving_force(drive, 0.0)?);
        let right: Vec<Complex<f64>> =
            forces.zip(turning.iter()).map(|((there, here), turned)| (there - here - turned) * per).collect();
        let Some(rate) = solved(&right)? else { return Ok(None) };
        let [there, here] = [2.0 * omega, 0.0].map(|omega| observed.of(&x, drive, omega)[k]);
        let y = observed.of(&x, drive, omega)[k];
        let parts = [observed.of(&rate, &Drive::default(), omega)[k], (there - here) * per];
        let (slope, size) = (parts[0] + parts[1], y.norm());
        let square = y.norm_sqr();
        let by = -2.0 / (square * square);
        // As much as of its terms, and as of a power of Ω.
        let terms = (parts[0].norm() + parts[1].norm()).max(size / omega);
        let noise = ROUNDING * 2.0 * terms / (square * size);
        let found = Slope { omega, size, slope: by * (y.conj() * slope).re, noise };
        Ok((square > 0.0 && found.slope.is_finite()).then_some(found))
    }
}
