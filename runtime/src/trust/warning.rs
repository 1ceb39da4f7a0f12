//! What the user should know about a run that succeeded.

use std::fmt;
use std::mem;

use crate::mechanism::Method;

/// A reason to trust a run less.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The tolerance was below what rounding allows; a larger one was used.
    ToleranceTooTight {
        /// What was asked for.
        asked: f64,
        /// What was used.
        used: f64,
    },
    /// The energy balance drifted by more than the method and the tolerance let expect.
    EnergyBudgetExceeded {
        /// Its drift.
        drift: f64,
        /// What would have been usual.
        limit: f64,
    },
    /// The energy balance jumped within one step.
    EnergyJump {
        /// When, s.
        t: f64,
        /// By how much, relative to the scale of the energies.
        jump: f64,
    },
    /// The fixed step is beyond the method's stability limit for a mode of the system linearised at some state of the run.
    StepExceedsStability {
        /// The method.
        method: Method,
        /// The step, s.
        step: f64,
        /// The largest stable step, s.
        limit: f64,
        /// Real part of the mode's eigenvalue, 1/s.
        real: f64,
        /// Imaginary part of the mode's eigenvalue, rad/s.
        imaginary: f64,
        /// By which factor the method amplifies the mode over the run.
        growth: f64,
    },
    /// The run has too many steps to keep dense output of them all.
    DenseOutputEnds {
        /// Until when there is dense output, s.
        t: f64,
    },
    /// The step is limited by stability, not by accuracy: an implicit method would need far fewer.
    Stiff {
        /// When it was noticed, s.
        t: f64,
        /// The estimate of h|λ| that stays at the limit.
        step_times_rate: f64,
    },
}

impl Warning {
    /// True when the other warning says the same, with other numbers.
    pub fn same_kind(&self, other: &Warning) -> bool {
        mem::discriminant(self) == mem::discriminant(other)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::ToleranceTooTight { asked, used } => {
                write!(f, "tolerance too tight: {asked:e} is below rounding; {used:e} was used")
            }
            Warning::EnergyBudgetExceeded { drift, limit } => {
                write!(f, "energy budget exceeded: the balance drifts by {drift:.1e}, where {limit:.1e} would be usual")
            }
            Warning::EnergyJump { t, jump } => {
                write!(f, "energy jumps by {jump:.1e} of its scale in the step that ends at t = {t} s")
            }
            Warning::StepExceedsStability { method, step, limit, real, imaginary, growth } => {
                write!(
                    f,
                    "step exceeds stability: `{method}` at a step of {step} s amplifies the mode with eigenvalue \
                     {real:.4} ± {imaginary:.4}i 1/s by {growth:.2e} over the run"
                )?;
                if *limit > 0.0 {
                    write!(f, "; its limit is {limit:.4e} s")
                } else {
                    write!(f, ", as it does at any step")
                }
            }
            Warning::DenseOutputEnds { t } => write!(f, "dense output ends at t = {t} s: it would fill the memory"),
            Warning::Stiff { t, step_times_rate } => write!(
                f,
                "stiff: from about t = {t} s on the step is limited by stability (h|λ| ≈ {step_times_rate:.1}), not by accuracy"
            ),
        }
    }
}
