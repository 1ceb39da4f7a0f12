//! Choosing the step.

/// Constants of the step-size control h ← h·clamp(0.9·err₀^β/err^α), α = exponent − 3β/4.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Control {
    /// 1/(q + 1), q the order of the error estimate.
    pub exponent: f64,
    /// Weight of the previous step's error (the integral part).
    pub beta: f64,
    /// The smallest factor.
    pub shrink: f64,
    /// The largest factor.
    pub grow: f64,
    /// h|λ| above this is near the stability limit.
    pub stiff: f64,
    /// Whether the last two steps foretell the next one's error (for implicit methods, whose steps are better not rejected).
    pub predictive: bool,
}

/// For methods that have no error estimate.
pub(crate) const NO_CONTROL: Control =
    Control { exponent: 0.0, beta: 0.0, shrink: 1.0, grow: 1.0, stiff: f64::INFINITY, predictive: false };

/// The step a method proposes next, from the errors of the last steps.
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.4;
/// Gustafsson, ACM TOMS 17 (1991) 533, for the proportional–integral form, and 20 (1994) 496 for the predictive one.
#[derive(Clone, Debug)]
pub(crate) struct StepControl {
    constants: Control,
    previous_error: f64,
    /// The last accepted step; 0: none.
    previous_step: f64,
    rejected: bool,
    /// True until a step was accepted.
    first: bool,
}

impl StepControl {
    const SAFETY: f64 = 0.9;

    /// At the start.
    pub fn new(constants: Control) -> Self {
        StepControl { constants, previous_error: 1e-4, previous_step: 0.0, rejected: false, first: true }
    }

    /// After a restart.
    pub fn restart(&mut self) {
        (self.previous_error, self.previous_step, self.rejected) = (1e-4, 0.0, false);
    }

    /// The next step after one of h was accepted with this error (at most 1).
    pub fn accepted(&mut self, h: f64, error: f64) -> f64 {
        let Control { beta, shrink, grow, .. } = self.constants;
        let mut factor = self.proportional(error) / Self::SAFETY;
        if beta > 0.0 {
            factor /= self.previous_error.powf(beta);
        }
        if self.constants.predictive && self.previous_step > 0.0 {
            // As the error grew from the last step to this one, so it will to the next (Gustafsson 1994).
            let grew = (error / self.previous_error).powf(self.constants.exponent) * self.previous_step / h;
            factor = factor.max(factor * grew);
        }
        let factor = factor.clamp(1.0 / grow, 1.0 / shrink);
        let limit = if self.rejected { 1.0 } else { f64::INFINITY };
        (self.previous_error, self.previous_step) = (error.max(1e-4), h);
        (self.rejected, self.first) = (false, false);
        h * (1.0 / factor).min(limit)
    }

    /// The step to try after one of h was rejected with this error (more than 1, or not finite).
    pub fn rejected(&mut self, h: f64, error: f64) -> f64 {
        // A first step is no more than a guess, and may be wrong by orders of magnitude.
        let shrink = if self.first { FIRST_SHRINK } else { self.constants.shrink };
        self.rejected = true;
        if error.is_finite() { h / (self.proportional(error) / Self::SAFETY).min(1.0 / shrink) } else { h * shrink }
    }

    /// error^(exponent − 3β/4); by roots where that is 1/8.
    fn proportional(&self, error: f64) -> f64 {
        match self.constants.exponent - 0.75 * self.constants.beta {
            0.125 => error.sqrt().sqrt().sqrt(),
            exponent => error.powf(exponent),
        }
    }
}

/// A first step that fails is shortened to this part at most.
const FIRST_SHRINK: f64 = 0.02;
