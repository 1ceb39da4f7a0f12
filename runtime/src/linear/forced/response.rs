//! Frequency responses of coordinates and outputs, sampled so that their curves are whole.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::{Drive, Observed};
use crate::linear::modes::Kind;
use crate::linear::{LinearError, Linearised};
use crate::show::Figure;

/// Complex amplitudes of some answers to a drive, against its frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// What drives, in words.
    pub drive: String,
    /// The unit of what drives, where the amplitudes are those per unit of it; empty where they are amplitudes.
    pub per: String,
    /// Names of the answers.
    pub names: Vec<String>,
    /// Their units, SI, not yet per unit of what drives.
    pub units: Vec<String>,
    /// Frequencies Ω, rad/s, rising.
    pub omegas: Vec<f64>,
    /// The answers' amplitudes at each frequency; `None` on an undamped mode.
    pub answers: Vec<Option<Vec<Complex<f64>>>>,
    /// Frequencies of undamped modes within the range, rad/s: there answers that the drive reaches have no bound.
    pub poles: Vec<f64>,
}

/// Pixels along the axis of frequencies of a figure.
const PIXELS: f64 = 700.0;
/// Curves are sampled until straight pieces between samples are off by less than this, of all that a figure shows of
/// sizes, or in radians of the phase.
const STRAIGHT: f64 = 2e-3;
const TURNING: f64 = 0.02;
/// Samples stand no closer than this part of a pixel, but beside poles.
const CLOSEST: f64 = 0.125;
/// Nor closer than this beside what vanishes.
const NARROWEST: f64 = 1e-6;
/// Distances from a pole, in pixels.
const BESIDE: [f64; 5] = [1.0, 0.5, 0.25, 0.1, 0.01];
/// What is smaller beside an answer's largest size is rounding.
pub(super) const ROUNDING: f64 = 1e-13;

impl Linearised {
    /// Amplitudes of these answers at each frequency Ω, rad/s: Y = (C_q + iΩ C_v − Ω² C_a) X + D (U, iΩU, −Ω²U), with X of
    /// [`Linearised::frequency_response`]; `None` where an undamped mode makes it infinite.
    ///
    /// # Errors
    /// As [`Linearised::driving_force`]; [`LinearError::ReactionToForce`] for reactions to generalized forces.
    pub fn answers(
        &self,
        drive: &Drive,
        observed: &Observed,
        omegas: &[f64],
    ) -> Result<Vec<Option<Vec<Complex<f64>>>>, LinearError> {
        observed.admits(drive)?;
        let found = self.frequency_response(drive, omegas)?.into_iter().zip(omegas);
        Ok(found.map(|(x, omega)| Some(observed.without_rounding((&x?, None), drive, *omega))).collect())
    }

    /// The response of some answers over a range of frequencies, rad/s (`None`: about those of the modes), sampled as
    /// closely as its curves ask for: peaks and antiresonances too, on both sides of what has no bound.
    ///
    /// # Errors
    /// As [`Linearised::answers`] and [`Linearised::modes`].
    ///
    /// # Example
    /// ```
    /// use dalembert::linear::{Guess, LinearMechanism, Observed, Source, equilibrium_near, linearise};
    /// use nalgebra::DMatrix;
    /// let springs = DMatrix::from_row_slice(2, 2, &[2.0, -1.0, -1.0, 1.0]);
    /// let absorber = LinearMechanism::new(DMatrix::identity(2, 2), DMatrix::zeros(2, 2), springs)?;
    /// let linear = linearise(&absorber, &equilibrium_near(&absorber, &Guess::at(&[0.0, 0.0]))?)?;
    /// let drive = Source::Force(0).into();
    /// let response = linear.response(&drive, &Observed::coordinates(&linear), None)?;
    /// // The second mass takes all motion off the first at √(k₂/m₂).
    /// let size = |x: &Option<Vec<_>>| x.as_ref().map_or(f64::INFINITY, |x: &Vec<nalgebra::Complex<f64>>| x[0].norm());
    /// let least = response.answers.iter().map(size).fold(f64::INFINITY, f64::min);
    /// assert!(least < 1e-3 && response.poles.len() == 2);
    /// # Ok::<(), dalembert::linear::LinearError>(())
    /// ```
    pub fn response(
        &self,
        drive: &Drive,
        observed: &Observed,
        range: Option<(f64, f64)>,
    ) -> Result<Response, LinearError> {
        observed.admits(drive)?;
        let mut omegas = self.telling_frequencies(range)?;
        let (low, high) = (omegas[0], omegas[omegas.len() - 1]);
        let pixel = (high / low).ln() / PIXELS;
        let modes = self.modes()?;
        let undamped = modes.iter().filter(|mode| mode.kind == Kind::Oscillating).map(|mode| mode.omega);
        let mut poles: Vec<f64> = undamped.filter(|omega| (low..=high).contains(omega)).collect();
        poles.sort_by(f64::total_cmp);
        // On a pole there is nothing to see.
        omegas.retain(|omega| !poles.iter().any(|pole| apart(*omega, *pole) < 0.5 * BESIDE[4] * pixel));
        let beside = poles.iter().flat_map(|pole| {
            BESIDE.map(|part| [-part, part]).concat().into_iter().map(move |part| pole * (part * pixel).exp())
        });
        omegas.extend(beside.filter(|omega| (low..=high).contains(omega)));
        omegas.sort_by(f64::total_cmp);
        omegas.dedup();
        let answers = self.answers(drive, observed, &omegas)?;
        let mut samples: Vec<Sample> = omegas.into_iter().zip(answers).collect();
        let scale = Scale::of(&samples, &poles, pixel);
        let mut fine: Vec<Sample> = Vec::with_capacity(2 * samples.len());
        let mut left: Vec<Sample> = Vec::new();
        samples.reverse();
        while let Some(next) = left.pop().or_else(|| samples.pop()) {
            let Some(last) = fine.last() else {
                fine.push(next);
                continue;
            };
            if let Some(between) = self.needed(drive, observed, (last, &next), &scale)? {
                left.extend([next, between]);
            } else {
                fine.push(next);
            }
        }
        let (omegas, answers) = fine.into_iter().unzip();
        let (names, units) = (observed.names.clone(), observed.units.clone());
        Ok(Response { drive: String::new(), per: String::new(), names, units, omegas, answers, poles })
    }

    /// The sample between two, where a straight piece would not do.
    fn needed(
        &self,
        drive: &Drive,
        observed: &Observed,
        ((low, before), (high, after)): (&Sample, &Sample),
        scale: &Scale,
    ) -> Result<Option<Sample>, LinearError> {
        let vanishes =
            |k: usize, a: Complex<f64>, b: Complex<f64>| is_opposite(a, b) && a.norm().max(b.norm()) > scale.floor[k];
        let sides = before.iter().flatten().zip(after.iter().flatten()).enumerate();
        // Antiresonances are followed down to where nothing is seen.
        let narrow = if sides.into_iter().any(|(k, (a, b))| vanishes(k, *a, *b)) { NARROWEST } else { CLOSEST };
        if apart(*low, *high) <= narrow * scale.pixel || scale.poles.iter().any(|pole| (*low..=*high).contains(pole)) {
            return Ok(None);
        }
        let omega = (low * high).sqrt();
        if omega <= *low || omega >= *high {
            return Ok(None);
        }
        let answer = self.answers(drive, observed, &[omega])?.swap_remove(0);
        let (Some(a), Some(b), Some(middle)) = (before, after, &answer) else { return Ok(None) };
        let bends = |k: usize| {
            let size = |x: Complex<f64>| x.norm().max(scale.floor[k]).ln();
            let off = size(middle[k]) - 0.5 * (size(a[k]) + size(b[k]));
            let turns = |x: Complex<f64>, y: Complex<f64>| (y * x.conj()).arg();
            let seen = [a[k], middle[k], b[k]].iter().all(|x| x.norm() > scale.floor[k]);
            off.abs() > STRAIGHT * scale.height
                || seen && (turns(a[k], middle[k]) - turns(middle[k], b[k])).abs() > TURNING
        };
        Ok((0..middle.len()).any(bends).then_some((omega, answer)))
    }
}

/// A frequency and the answers there.
type Sample = (f64, Option<Vec<Complex<f64>>>);

/// How far apart two frequencies are on a logarithmic axis.
pub(super) fn apart(a: f64, b: f64) -> f64 {
    (a / b).ln().abs()
}

/// What a figure can show.
struct Scale {
    /// Of the logarithm of frequencies.
    pixel: f64,
    poles: Vec<f64>,
    /// Of the logarithm of sizes.
    height: f64,
    /// Sizes of each answer below which nothing is seen.
    floor: Vec<f64>,
}

impl Scale {
    fn of(samples: &[Sample], poles: &[f64], pixel: f64) -> Scale {
        let far = |omega: f64| poles.iter().all(|pole| apart(omega, *pole) > 0.9 * pixel);
        let all: Vec<&Vec<Complex<f64>>> =
            samples.iter().filter(|sample| far(sample.0)).filter_map(|sample| sample.1.as_ref()).collect();
        let count = all.first().map_or(0, |answer| answer.len());
        let largest = |k: usize| all.iter().fold(0.0_f64, |most, answer| most.max(answer[k].norm()));
        let most = (0..count).map(largest).fold(0.0, f64::max);
        let sizes = all.iter().flat_map(|answer| answer.iter()).map(|x| x.norm()).filter(|x| *x > ROUNDING * most);
        let least = sizes.fold(most, f64::min);
        let height = (most / least).ln().max(1.0);
        // A curve that leaves the figure downwards needs no samples there.
        let floor = (0..count).map(|k| (1e-2 * least).max(ROUNDING * largest(k)).max(f64::MIN_POSITIVE));
        Scale { pixel, poles: poles.to_vec(), height, floor: floor.collect() }
    }
}

impl Response {
    /// The same response with what drives it in words, and the unit of that, of which the amplitudes are per unit; empty:
    /// they are amplitudes.
    pub fn to(self, drive: impl Into<String>, per: impl Into<String>) -> Response {
        Response { drive: drive.into(), per: per.into(), ..self }
    }

    /// The unit of an answer's amplitude: `m/N`.
    pub fn unit(&self, answer: usize) -> String {
        let unit = self.units.get(answer).map_or("", String::as_str);
        quotient(unit, &self.per)
    }

    /// Size and phase of all answers over the frequency in rad/s.
    ///
    /// Phases are in degrees, negative where the answer comes late, and continuous along a curve, but that they fall by
    /// half a turn at an undamped mode.  Curves that have no bound leave the frame, one pixel from the pole.
    pub fn figure(&self) -> Figure {
        super::bode::figure(self, 1.0)
    }

    /// As [`Response::figure`], over the frequency in Hz.
    pub fn figure_in_hertz(&self) -> Figure {
        super::bode::figure(self, TAU)
    }

    /// The ends of a frame that curves leave one pixel from a pole or a zero; `None` where there are none.
    pub(super) fn frame(&self) -> Option<(f64, f64)> {
        let (low, high) = (self.omegas.first()?, self.omegas.last()?);
        let pixel = (high / low).ln() / PIXELS;
        let mut seen = self.poles.clone();
        let poles = seen.len();
        seen.extend(self.zeros());
        if seen.is_empty() {
            return None;
        }
        let far = |omega: &f64, from: &[f64]| from.iter().all(|place| apart(*omega, *place) > 0.9 * pixel);
        let sizes = |from: &[f64]| {
            let from = from.to_vec();
            self.omegas
                .iter()
                .zip(&self.answers)
                .filter(move |(omega, _)| far(omega, &from))
                .flat_map(|(_, answer)| answer.iter().flatten().map(|x| x.norm()))
        };
        let top = sizes(&seen[..poles]).fold(0.0, f64::max);
        let bottom = sizes(&seen).filter(|size| *size > ROUNDING * top).fold(top, f64::min);
        (bottom > 0.0 && bottom < top).then_some((bottom, top))
    }

    /// Where an answer vanishes on its way to the opposite, rad/s.
    fn zeros(&self) -> Vec<f64> {
        let pairs = self.omegas.windows(2).zip(self.answers.windows(2));
        let crossed = pairs.filter_map(|(omega, answer)| match answer {
            [Some(a), Some(b)] if !self.poles.iter().any(|pole| (omega[0]..=omega[1]).contains(pole)) => {
                a.iter().zip(b).any(|(a, b)| is_opposite(*a, *b)).then(|| 0.5 * (omega[0] + omega[1]))
            }
            _ => None,
        });
        crossed.collect()
    }
}

/// Whether two neighbouring answers are half a turn apart, as only undamped ones are.
pub(super) fn is_opposite(a: Complex<f64>, b: Complex<f64>) -> bool {
    let product = b * a.conj();
    product.re < 0.0 && product.im.abs() <= 1e-9 * product.re.abs()
}

/// One unit per another: `m/N`, `1/m`, `rad/(N m)`.
fn quotient(unit: &str, per: &str) -> String {
    let pure = |unit: &str| matches!(unit, "" | "1");
    let joined = |unit: &str| unit.contains([' ', '*', '/']);
    match (pure(unit), pure(per)) {
        (true, true) => String::new(),
        (false, true) => unit.to_owned(),
        (true, false) if joined(per) => format!("1/({per})"),
        (true, false) => format!("1/{per}"),
        (false, false) if joined(per) => format!("{unit}/({per})"),
        (false, false) => format!("{unit}/{per}"),
    }
}
