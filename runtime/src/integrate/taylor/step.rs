//! One step of Taylor's method.

use super::ORDER;
use super::dense::nest;
use super::expansion::Expansion;
use crate::integrate::ends::{Ends, between_ends};
use crate::integrate::{Control, Counters, Endpoint, OneStep, Segment, StepFailure, Tolerance, Trial};
use crate::mechanism::dense::ROUNDING;
use crate::mechanism::{At, SERIES_TERMS, System};

/// A step that is refused costs a few sums, and its length is known from the series: there is little to be careful about.
const CONTROL: Control = Control {
    exponent: 1.0 / ORDER as f64,
    safety: 0.95,
    shrink: 0.1,
    grow: 10.0,
    at_first: 10.0,
    stiff: f64::INFINITY,
};
/// So many of the last coefficients tell the error: some motions have only every second one, or every fourth.
const LAST: usize = 4;
/// At a tolerance of some roundings, which count for none elsewhere, what is left out of a step is to be less than a hundredth of one: it has always the
/// same sign along a motion that repeats, so that its sum goes with the time, and stays below that of roundings, which goes with the root, for 10⁴ steps.
const FINER: f64 = 100.0 * ROUNDING / f64::EPSILON;
/// Gauss's nodes and weights on [−1, 1], exact up to degree 19; the others mirror them.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_2, 0.295_524_224_714_752_9),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// The method, which keeps the series at the start of a step while its length is found.
pub(crate) struct Taylor {
    ends: Ends,
    expansion: Expansion,
    /// Whether the series is that of the start.
    expanded: bool,
    /// Where the step that was tried starts, and its length, s.
    tried: (f64, f64),
    /// Whether the rate at its end is known.
    concluded: bool,
    /// Of the step that was tried.
    errors: Vec<f64>,
    pieces: Vec<f64>,
    /// Room for a state inside the step.
    between: Vec<f64>,
    evaluations: u64,
}

impl Taylor {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Taylor {
        Taylor {
            ends: Ends::new(n, work),
            expansion: Expansion::new(n),
            expanded: false,
            tried: (0.0, 0.0),
            concluded: false,
            errors: vec![0.0; 2 * n],
            pieces: vec![0.0; 2 * n * SERIES_TERMS],
            between: vec![0.0; 2 * n],
            evaluations: 0,
        }
    }

    /// The error in units of the tolerance: as large as the last term, or as one before it that terms which fall as the tolerance has it leave.
    fn error(&mut self, theta: f64, h: f64, tolerance: &Tolerance) -> f64 {
        let falls = tolerance.relative.powf(1.0 / ORDER as f64);
        let finer = if tolerance.relative <= ROUNDING { FINER } else { 1.0 };
        let powers: [f64; LAST] =
            std::array::from_fn(|back| theta.powi((ORDER - back) as i32) * falls.powi(back as i32));
        for (i, error) in self.errors.iter_mut().enumerate() {
            let terms = self.expansion.of(i).iter().rev().zip(powers).map(|(term, power)| (term * power).abs());
            *error = terms.fold(0.0, |most, term| if term > most || term.is_nan() { term } else { most });
        }
        finer * self.ends.in_units(&self.errors, h, tolerance)
    }

    /// What the series misses the rates at its end by, over the step, in units of the tolerance, as an error of its last term makes it: where what comes
    /// next is nothing yet, as before and behind a narrow well, the terms tell nothing.
    fn defect(&mut self, theta: f64, h: f64, tolerance: &Tolerance) -> f64 {
        let n = self.ends.n;
        for i in 0..n {
            let terms = self.expansion.of(n + i)[1..].iter().enumerate().rev();
            let slope = terms.fold(0.0, |sum, (k, c)| sum * theta + (k + 1) as f64 * c) / self.expansion.unit;
            self.between[n + i] = h * (slope - self.ends.end_rate[n + i]) / ORDER as f64;
            self.between[i] = h * self.between[n + i] / ORDER as f64;
        }
        // What is more than the last term tells is an error as well, or the rounding of the rates.
        for (error, missed) in self.errors.iter_mut().zip(&self.between) {
            *error = error.max(missed.abs());
        }
        self.ends.in_units(&self.between, h, tolerance)
    }

    /// ∫P dt over the step that was tried.
    fn integrate_power(&mut self, system: &dyn System) {
        let (n, (t, h)) = (self.ends.n, self.tried);
        let mut sum = 0.0;
        for (node, weight) in GAUSS.iter().flat_map(|(node, weight)| [(-node, weight), (*node, weight)]) {
            let part = 0.5 * (1.0 + node);
            let theta = part * h / self.expansion.unit;
            for (i, y) in self.between.iter_mut().enumerate() {
                *y = self.expansion.of(i).iter().rev().fold(0.0, |sum, c| sum * theta + c);
            }
            sum += weight * system.energy(At::packed(t + part * h, &self.between, n)).power;
        }
        self.ends.add_work(0.5 * h * sum);
    }
}

impl OneStep for Taylor {
    fn control(&self) -> Control {
        CONTROL
    }

    fn counters(&self) -> Counters {
        Counters {
            evaluations: self.evaluations + self.ends.evaluations,
            factorizations: self.expansion.factorizations,
            ..Counters::default()
        }
    }

    between_ends!();

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.expanded = false;
        self.ends.begin(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        self.evaluations += 1;
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Trial { t, h, tolerance } = trial;
        (self.tried, self.concluded) = ((t, h), false);
        if !self.expanded {
            self.expansion.expand(system, t, &self.ends.y, h)?;
            self.evaluations += ORDER as u64;
            // In another unit of time its coefficients may be finite.
            self.expanded = self.expansion.is_finite();
            if !self.expanded {
                self.ends.end.fill(f64::NAN);
                return Ok(f64::NAN);
            }
        }
        let theta = h / self.expansion.unit;
        for i in 0..self.ends.y.len() {
            let terms = self.expansion.of(i)[1..].iter().rev();
            self.ends.increment[i] = terms.fold(0.0, |sum, c| (sum + c) * theta) + self.ends.carry[i];
        }
        self.ends.add_up();
        let Some(tolerance) = tolerance else { return Ok(0.0) };
        let error = self.error(theta, h, tolerance);
        if error > 1.0 || error.is_nan() {
            return Ok(error);
        }
        self.concluded = self.ends.conclude(system, t + h, false)?;
        let defect = self.defect(theta, h, tolerance);
        Ok(if defect.is_nan() { defect } else { error.max(defect) })
    }

    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure> {
        if self.ends.works() {
            self.integrate_power(system);
        }
        if self.concluded && !moved { Ok(true) } else { self.ends.conclude(system, t, moved) }
    }

    fn errors(&self) -> &[f64] {
        &self.errors
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
        self.expanded = false;
    }

    fn stiffness(&self, _h: f64, _least: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, h: f64) -> Result<(), StepFailure> {
        let width = 2 * self.ends.n;
        let theta = h / self.expansion.unit;
        for i in 0..width {
            let mut power = 1.0;
            let mut c = [0.0; SERIES_TERMS];
            for (c, coefficient) in c.iter_mut().zip(self.expansion.of(i)) {
                *c = coefficient * power;
                power *= theta;
            }
            c[0] = self.ends.y[i];
            nest(c, self.ends.end[i] - self.ends.y[i], width, &mut self.pieces[i..]);
        }
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces }
    }
}
