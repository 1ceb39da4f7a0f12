//! Speed against accuracy: what each method costs for the error that it leaves, on one scene.
//!
//! 1. Who takes part, and how each is told to be more accurate: look in `candidate.rs`.
//! 2. What errors are measured from: two different methods that agree: look in `reference.rs`; in double-double where they agree with
//!    that too: in `extended.rs`, by the method in `extrapolation.rs`.
//! 3. One run's error, cost and failure: look in `point.rs`; a whole curve: in `curve.rs`; what work is counted in: in `work.rs`.
//! 4. What follows from it, in a sentence: look in `verdict.rs`; over many scenes: in `profile.rs`.
//! 5. The charts and the table: look in `picture.rs`.
//! 6. What a scene can do without, on the same axes: look in `fidelity.rs`.
//! 7. Where each method is stable: look in `map.rs`.
//! 8. Error against step size, down to rounding: look in `steps.rs`.

mod arithmetic;
mod candidate;
mod curve;
#[cfg(feature = "interpret")]
mod extended;
#[cfg(all(test, feature = "interpret"))]
mod extended_tests;
#[cfg(feature = "interpret")]
mod extrapolation;
mod fidelity;
mod map;
mod picture;
mod point;
mod profile;
pub(crate) mod reference;
mod steps;
#[cfg(test)]
mod tests;
mod verdict;
mod work;

pub use arithmetic::{Arithmetic, DoubleOnly};
pub use candidate::Candidate;
pub use curve::Curve;
#[cfg(feature = "interpret")]
pub(crate) use extended::{SCHEMES, extended_motion, smooth_model};
#[cfg(feature = "interpret")]
pub(crate) use extrapolation::Scheme;
pub use fidelity::{Fidelity, Verified};
pub use map::{Limit, StabilityMap};
pub use point::{AccuracyControl, Measured, Point};
pub use profile::Profile;
pub use reference::Reference;
pub use steps::{Convergence, StepCurve, StepPoint};
pub use verdict::Band;
pub use work::WorkUnits;

use std::ops::ControlFlow;

use crate::error::Error;
#[cfg(feature = "interpret")]
use crate::mechanism::Interpreted;

/// Speed against accuracy of one scene: a curve for each candidate.
///
/// Errors are the largest, over 200 times of the scene and over all that is compared, of |y − y_ref| beside the range that
/// y goes through; cost is counted in evaluations of the accelerations and measured in time on one thread, the least of several runs, both of runs that report and
/// watch nothing.  After Mazzia, Cash and Soetaert (J. Comput. Appl. Math. 236, 2012), whose charts these are.
///
/// ```
/// # use dalembert::prelude::*;
/// # use dalembert::precision::{Candidate, Plan, WorkPrecision};
/// # dalembert::model!(yaml = r#"
/// # name: Swing
/// # coordinates: {theta: rad}
/// # kinetic_energy: theta'^2/2
/// # potential_energy: -9.81*cos(theta)
/// # scene: {start: {theta: 2}, until: 3}
/// # "#);
/// let swing = Swing::default().system();
/// let candidates = Candidate::methods(&swing, &Settings::new(&swing.scene(0)));
/// let found = WorkPrecision::measure(&candidates, &Plan::default(), &mut |_| std::ops::ControlFlow::Continue(()))?;
/// println!("{}", found.sentence());
/// std::fs::write(std::env::temp_dir().join("swing.svg"), found.figure().to_svg())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct WorkPrecision {
    /// What the charts are called.
    pub title: String,
    /// What errors are measured from.
    pub reference: Reference,
    /// Curves of those that suit the scene, in the order of the candidates.
    pub curves: Vec<Curve>,
    /// Who does not, and why.
    pub refused: Vec<(String, String)>,
}

/// What is compared, and how carefully time is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Coordinates, rates (`theta'`) or outputs (`tip.x`) that all candidates have; none: the coordinates of the first one.
    pub columns: Vec<String>,
    /// No run is repeated more often for the least of its times; 20 unless said otherwise.
    pub repetitions: usize,
}

impl Default for Plan {
    fn default() -> Plan {
        Plan { columns: Vec::new(), repetitions: 20 }
    }
}

impl WorkPrecision {
    /// Runs every candidate from coarse to fine; `progress` is told the name of each one, and may break off.
    ///
    /// # Errors
    /// A setting without meaning, an unknown column, or a scene of which no two methods agree ([`Error::NoReference`]).
    pub fn measure(
        candidates: &[Candidate],
        plan: &Plan,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<WorkPrecision, Error> {
        WorkPrecision::against(candidates, plan, |first| Reference::find(first, &plan.columns), progress)
    }

    /// The same with errors from a motion in double-double, where nothing that [`DoubleOnly`] names is in its way: `model` is the first
    /// candidate's, to be interpreted.  Curves then reach down to the methods' own rounding.
    ///
    /// # Errors
    /// Those of [`WorkPrecision::measure`].
    #[cfg(feature = "interpret")]
    pub fn measure_extended(
        candidates: &[Candidate],
        plan: &Plan,
        model: &Interpreted,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<WorkPrecision, Error> {
        let of = |first: &Candidate| Ok(Reference::find(first, &plan.columns)?.extended(first, Ok(model)));
        WorkPrecision::against(candidates, plan, of, progress)
    }

    /// The same with errors from a reference that is made of the first candidate.
    pub(crate) fn against(
        candidates: &[Candidate],
        plan: &Plan,
        reference: impl Fn(&Candidate) -> Result<Reference, Error>,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<WorkPrecision, Error> {
        let curve =
            |candidate: &Candidate, reference: &Reference| Curve::measure(candidate, reference, plan.repetitions);
        let Measurements { title, reference, curves, refused } =
            measurements(candidates, (&reference, &curve), progress)?;
        Ok(WorkPrecision { title, reference, curves, refused })
    }
}

/// Curves of all candidates that suit their scene, and why others do not.
struct Measurements<C> {
    title: String,
    reference: Reference,
    curves: Vec<C>,
    refused: Vec<(String, String)>,
}

/// The reference, of the first candidate.
type Refer<'a> = &'a dyn Fn(&Candidate) -> Result<Reference, Error>;

/// The curve of one candidate, judged by the reference.
type Measure<'a, C> = &'a dyn Fn(&Candidate, &Reference) -> Result<C, Error>;

/// Measures every candidate from a reference of the first one; `progress` is told the name of each one, and may break off.
fn measurements<C>(
    candidates: &[Candidate],
    (refer, measure): (Refer<'_>, Measure<'_, C>),
    progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
) -> Result<Measurements<C>, Error> {
    let Some(first) = candidates.first() else {
        return Err(Error::NoReference { why: "there is no candidate".into() });
    };
    let mut found = Measurements {
        title: first.system.description().name.to_string(),
        reference: refer(first)?,
        curves: Vec::new(),
        refused: Vec::new(),
    };
    for candidate in candidates {
        if progress(&candidate.name).is_break() {
            break;
        }
        let measured = measure(candidate, &found.reference);
        if candidate.settings.interruption.is_asked() {
            // What is left of its curve is none.
            break;
        }
        match measured {
            Ok(curve) => found.curves.push(curve),
            Err(error) => found.refused.push((candidate.name.clone(), unsuited(&error))),
        }
    }
    Ok(found)
}

/// Why a candidate does not suit a scene.
fn unsuited(error: &Error) -> String {
    match error {
        Error::NotSeparable { reason, .. } => format!("not separable, since {reason}"),
        Error::NoSeries { reason } => format!("no power series, since {reason}"),
        Error::NotLinear { reason } => format!("not linear, since {reason}"),
        error => error.to_string(),
    }
}
