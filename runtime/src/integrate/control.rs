//! Choosing the step.

/// Constants of the step-size control.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// 1/(q + 1), q the order of the error estimate.
    pub exponent: f64,
    /// Which part of the step is tried that the error foretells.
    pub safety: f64,
    /// The smallest factor.
    pub shrink: f64,
    /// The largest factor.
    pub grow: f64,
    /// By how many times more the first step may grow, and be longer than usual where accelerations change little.
    pub at_first: f64,
    /// h|λ| above this is near the stability limit.
    pub stiff: f64,
}

/// At 0.9 fewer steps are taken and more rejected: over the scenes of the library the same error then costs 1 to 4 % more.
pub(crate) const SAFETY: f64 = 0.8;

/// For methods that have no error estimate.
pub(crate) const NO_CONTROL: Control =
    Control { exponent: 0.0, safety: 1.0, shrink: 1.0, grow: 1.0, at_first: 1.0, stiff: f64::INFINITY };

/// The step a method proposes next, from the errors of the last steps.
///
/// With err the error in units of the tolerance and p = 1/(q + 1),
///
/// h ← 0.8 h / max(errᵖ, errᵖ · (err/err₀)ᵖ · h₀/h):
///
/// the second expects that the error of a step of the same length grows once more as it grew from the last step, of h₀
/// with the error err₀, to this one; where it falls the first alone counts.
///
/// Source: Gustafsson, ACM TOMS 20 (1994) 496; Hairer, Wanner, Solving Ordinary Differential Equations II (1996),
/// section IV.8, who give it for implicit methods.  It spares explicit ones rejected steps as well: on Kepler's orbit of
/// eccentricity 0.6 a quarter of all steps at order 8.
#[derive(Clone, Debug)]
pub(crate) struct StepControl {
    constants: Control,
    /// errᵖ of the last accepted step, and its length; 0: none.
    previous: (f64, f64),
    /// What counts as errᵖ at least: smaller errors foretell nothing.
    least: f64,
    /// The error below which a step may be followed by a longer one.
    growing: f64,
    rejected: bool,
    /// True until a step was accepted.
    first: bool,
}

impl StepControl {
    /// At the start.
    pub fn new(constants: Control) -> Self {
        let least = 1e-4_f64.powf(constants.exponent);
        let growing = constants.safety.powf(1.0 / constants.exponent);
        StepControl { constants, previous: (0.0, 0.0), least, growing, rejected: false, first: true }
    }

    /// After a restart.
    pub fn restart(&mut self) {
        (self.previous, self.rejected) = ((0.0, 0.0), false);
    }

    /// The next step after one of h was accepted with this error (at most 1).
    pub fn accepted(&mut self, h: f64, error: f64) -> f64 {
        let Control { safety, shrink, grow, at_first, .. } = self.constants;
        // As a first step may be too long by orders of magnitude, it may be too short.
        let grow = if self.first { at_first * grow } else { grow };
        let (own, (before, step)) = (self.power(error), self.previous);
        let grew = if step > 0.0 { (own * (step / (before * h))).max(1.0) } else { 1.0 };
        let least = if self.rejected { 1.0 } else { 1.0 / grow };
        let factor = (own * grew * (1.0 / safety)).clamp(least, 1.0 / shrink);
        self.previous = (own.max(self.least), h);
        (self.rejected, self.first) = (false, false);
        h / factor
    }

    /// The part of a step whose dense output would be good to the tolerance, beside which its error is `size`.
    pub fn between_ends(&self, size: f64) -> f64 {
        self.constants.safety * size.powf(-BETWEEN_ENDS).max(self.constants.shrink)
    }

    /// The error below which a step may be followed by a longer one.
    pub fn growing(&self) -> f64 {
        self.growing
    }

    /// The step to try after one of h was rejected with this error (more than 1, or not finite).
    pub fn rejected(&mut self, h: f64, error: f64) -> f64 {
        // A first step is no more than a guess, and may be wrong by orders of magnitude.
        let shrink = if self.first { FIRST_SHRINK } else { self.constants.shrink };
        self.rejected = true;
        if error.is_finite() { h / (self.power(error) / self.constants.safety).min(1.0 / shrink) } else { h * shrink }
    }

    /// The step to try after an iteration in one of h did not converge.
    pub fn stalled(&mut self, h: f64) -> f64 {
        self.rejected = true;
        if self.first { h * FIRST_SHRINK } else { 0.5 * h }
    }

    /// errᵖ; by roots where p is 1/8.
    fn power(&self, error: f64) -> f64 {
        match self.constants.exponent {
            0.125 => error.sqrt().sqrt().sqrt(),
            exponent => error.powf(exponent),
        }
    }
}

/// The first step to try on a way of this many seconds.
pub(crate) fn first_step(control: &Control, tolerance: f64, way: f64) -> f64 {
    FIRST * (tolerance / USUAL).powf(control.exponent) * way
}

/// 1/(q + 1), q = 3 the least order of the dense output of methods for stiff motions.
const BETWEEN_ENDS: f64 = 0.25;

/// How many radians of a vibration a step may be long at a tolerance, about.
pub(crate) fn radians(control: &Control, tolerance: f64) -> f64 {
    RADIANS * tolerance.powf(control.exponent)
}

/// Those of a step at a tolerance of 1.
const RADIANS: f64 = 2.0;

/// The first step is tried at this part of the way, at the usual tolerance.
const FIRST: f64 = 1e-3;
const USUAL: f64 = 1e-10;

/// A first step that fails is shortened to this part at most.
const FIRST_SHRINK: f64 = 0.02;
