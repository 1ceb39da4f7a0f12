//! Integrating the equations of motion in time.
//!
//! 1. A family of one-step methods, each in its folder with the files `tableau`, `step`, `dense`,
//!    implements [`OneStep`]: look in `explicit/`, `nystrom/`, `symplectic/`, `implicit/`, `rosenbrock/`, `exact/`, `taylor/` and `moreau/`, and for which name means which in `choose.rs`.
//! 2. Methods are written once over [`Block`]s, whose size the compiler knows or not: look in `block.rs`.
//!    Those that go from one end of a step to the other in one piece share [`ends::Ends`].
//! 3. [`StepControl`] chooses steps against a [`Tolerance`]: look in `control.rs`.
//! 4. Between its ends a step is a [`Segment`]: look in `segment.rs`.
//!
//! What puts steps together to a motion: look in `crate::driver`.

mod block;
mod choose;
mod clock;
mod control;
mod ends;
mod exact;
mod explicit;
mod hermite;
mod implicit;
mod linear;
mod moreau;
mod nystrom;
mod rest;
mod rosenbrock;
mod segment;
mod stability;
mod stiffness;
mod symplectic;
mod taylor;
#[cfg(test)]
pub(crate) mod test_problems;
mod tolerance;
#[cfg(test)]
mod trees;

pub(crate) use block::Block;
pub(crate) use choose::{order, stability, stepper};

pub(crate) use clock::Clock;
pub(crate) use exact::{LENGTHS as LENGTHS_OF_EXACT, fastest_rate, longest_step, operations as operations_of_exact};

pub(crate) use control::{Control, NO_CONTROL, SAFETY, StepControl, first_step, radians};
#[cfg(feature = "ensemble")]
pub(crate) use explicit::{DOP853, Dop853, Stage, Term, stages};
pub(crate) use moreau::{ContactTally, Tally, Unsolved, Wrong, made_of_reactions};
#[cfg(feature = "ensemble")]
pub(crate) use nystrom::{RKN8, Stage as NystromStage};
pub(crate) use rest::AtRest;
pub(crate) use segment::Segment;
pub(crate) use stability::{Rational, Stability};
pub(crate) use stiffness::StiffnessDetector;
#[cfg(feature = "ensemble")]
pub(crate) use tolerance::LEAST;
pub(crate) use tolerance::{PERTURBATION, Tolerance, larger};

use crate::cause::{Cause, NoSeries};
use crate::mechanism::{Description, Singular, System};

/// A method of integration at work: it holds a motion's state, tries steps from it, and takes them.
///
/// States are [q; q'], so that a method that solves equations can solve for q'' alone.
pub(crate) trait OneStep: Send {
    /// Constants of the step-size control.
    fn control(&self) -> Control;

    /// Evaluations so far.
    fn counters(&self) -> Counters;

    /// Where the next step begins.
    fn start(&self) -> Endpoint<'_>;

    /// The state where the next step begins, to be changed before [`OneStep::begin`].
    fn state_mut(&mut self) -> &mut [f64];

    /// Where the step that was tried ends.
    fn end(&self) -> Endpoint<'_>;

    /// Where the step that was tried ends, to be changed before [`OneStep::conclude`].
    fn end_mut(&mut self) -> &mut [f64];

    /// Begins at the present state, after it or the equations changed.
    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure>;

    /// The rate of a state that need not lie on the motion.
    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure>;

    /// Tries a step and returns its error in units of the tolerance, 0 without one.
    fn attempt(&mut self, system: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure>;

    /// The rate at the end of the step that was tried, which was `moved` or not; false where it is not finite.
    fn conclude(&mut self, system: &dyn System, t: f64, moved: bool) -> Result<bool, StepFailure>;

    /// The estimated errors of all components of the step that was tried with a tolerance.
    fn errors(&self) -> &[f64];

    /// The longest step that the method takes with a tolerance, s, where each length of a step costs something: the way to a stop is then
    /// divided into equal parts, which are halved so and so often.
    fn longest(&self, _relative: f64) -> f64 {
        f64::INFINITY
    }

    /// The longest step, s, that an iteration may be expected to solve after the one that was tried.
    fn convergent(&self) -> f64 {
        f64::INFINITY
    }

    /// Takes the step that was tried; adds what rounding took from it to the next one if `compensated`.
    fn accept(&mut self, compensated: bool);

    /// Whether steps end on the constraints by themselves: to bring them there would take from them what they are for.
    fn keeps_constraints(&self) -> bool {
        false
    }

    /// Whether it asks for accelerations alone, and may so stay on a discontinuity, where their derivatives are others.
    fn slides(&self) -> bool {
        false
    }

    /// h‖Δf‖/‖Δy‖ near the end of the step, an estimate of h|λ| of the stiffest mode, or 0 where that is less than `least`;
    /// after the rate at the end.
    fn stiffness(&self, h: f64, least: f64) -> f64;

    /// Overwrites h times a defect δ of the rate, [q; q'], with (1 − γhJ)⁻¹ hδ, and returns γ: γ times that is γhδ where nothing is stiff, and −J⁻¹δ,
    /// what the defect does to a state that follows, where everything is.  `None`, and nothing done, by a method that solves no such equations.
    fn damp(&self, defect: &mut [f64]) -> Option<f64> {
        let _ = defect;
        None
    }

    /// Whether [`OneStep::damp`] does anything.
    fn damps(&self) -> bool {
        false
    }

    /// What contacts did, where steps go over them: their events are not looked for then.
    fn tally(&self) -> Option<&Tally> {
        None
    }

    /// The mean accelerations and multipliers of the step that was tried, where steps go over contacts.
    fn means(&self) -> Option<[&[f64]; 2]> {
        None
    }

    /// True where dense output costs no evaluation.
    fn dense_is_free(&self) -> bool;

    /// Computes dense output of the step that was tried, of length h from t; after the rate at the end.
    fn dense(&mut self, system: &dyn System, t: f64, h: f64) -> Result<(), StepFailure>;

    /// The dense output, after [`OneStep::dense`].
    fn segment(&self, t: f64, h: f64) -> Segment<'_>;
}

/// A step to try.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<'a> {
    /// Where it starts, s.
    pub t: f64,
    /// Its length, s.
    pub h: f64,
    /// What its error is measured by.
    pub tolerance: Option<&'a Tolerance>,
}

/// A state on the motion with its rate, and the work of what has no potential until then, J.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Endpoint<'a> {
    /// [q; q'].
    pub y: &'a [f64],
    /// [q'; q''].
    pub rate: &'a [f64],
    /// W = ∫P dt; 0 where it is not wanted.
    pub work: f64,
}

/// Evaluations that a method made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Counters {
    /// Of the accelerations.
    pub evaluations: u64,
    /// Of the Jacobians.
    pub jacobians: u64,
    /// Factorizations of iteration matrices, those by which RATTLE meets constraints included.
    pub factorizations: u64,
}

/// Why a step could not be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum StepFailure {
    /// There are no accelerations at a state on the way.
    Singular(Singular),
    /// The iteration of an implicit method, or of one that meets constraints, does not come to an end.
    Stalled {
        /// The step, s.
        h: f64,
    },
    /// There is no power series.
    NoSeries(NoSeries),
    /// Friction is not as it should be.
    Contacts(Wrong),
    /// The laws of contact have no solution that is found.
    Unsolved(Unsolved),
}

impl From<Singular> for StepFailure {
    fn from(fault: Singular) -> Self {
        StepFailure::Singular(fault)
    }
}

impl StepFailure {
    /// The end of a run that cannot go round it.
    pub fn cause(self, mechanism: &Description) -> Cause {
        match self {
            StepFailure::Singular(fault) => fault.cause(mechanism),
            StepFailure::Stalled { h } => Cause::IterationStalled { h },
            StepFailure::NoSeries(reason) => Cause::NoSeries { reason },
            StepFailure::Contacts(wrong) => wrong.cause(mechanism),
            StepFailure::Unsolved(Unsolved { contact, residual, rounds }) => {
                Cause::UnsolvedContacts { contact: mechanism.rows[contact].name.to_string(), residual, rounds }
            }
        }
    }
}
