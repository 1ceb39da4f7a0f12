//! Small motions: equilibria, linearisation to M, C and K, and modes.
//!
//! 1. [`equilibrium_near`] searches, [`equilibrium_here`] verifies, each row by its own terms; what directions without
//!    stiffness are, dry friction, contacts, dependence on time, and M, C and K as [`Linearised`]: look in
//!    `equilibrium/`; rests with coordinates held and inputs, parameters or held values found ([`trim`]): in `equilibrium/trim/`.
//! 2. Modes: normal ([`normal_modes`]), damped, gyroscopic and circulatory ([`Linearised::modes`], `complex_modes`),
//!    of systems z' = A z, secular pairs, proportional damping, pictures: look in `modes/`.
//! 3. Rigid motions told apart from mechanisms ([`name_free_modes`]): look in `rigid.rs`.
//! 4. A branch of equilibria or steady motions as a parameter or speed changes, its folds and thresholds ([`follow`]): look in `branch/`.
//! 5. Motions of the linear model: from given states, by the matrix exponential [`expm`], forced, steady, measured:
//!    look in `forced/`.
//! 6. With constraints: at rest and in steady motion in independent coordinates ([`linearise_constrained`]), with what drives and answers
//!    ([`Constrained::observe`]), otherwise on the states that the constraints leave (`linearise_tangent`): look in
//!    `constrained/`.
//!    With states of first order the rest and x' = A x are found together (`linearise_states`): look in `equilibrium/state_space.rs`;
//!    with values that ticks set the loop's map over a period (`linearise_sampled`): in `equilibrium/sampled`.
//! 7. Decompositions, scaling and ranks: look in `matrices/`.
//!
//! Matrices stay sparse until an eigenproblem or a factorization needs them dense, on the heap.

/// `dmatrix![1.0, 2.0; 3.0, 4.0]`, row by row.
#[cfg(test)]
macro_rules! dmatrix {
    ($($($x:expr),+);+ $(;)?) => {{
        let rows = [$(vec![$($x),+]),+];
        nalgebra::DMatrix::from_fn(rows.len(), rows[0].len(), |i, j| -> f64 { rows[i][j] })
    }};
}

mod branch;
mod constrained;
mod equilibrium;
mod forced;
mod matrices;
mod modes;
mod rigid;
mod typed;

use crate::mechanism::{At, System};

pub use crate::error::{LinearError, Residual};
pub use crate::numbers::{short, short_beside, short_within};
pub use branch::{Branch, BranchPoint, Change, CriticalSpeed, Threshold, ThresholdKind, Varied, follow};
#[cfg(feature = "cli")]
pub(crate) use constrained::lone_steady_coordinates;
#[cfg(all(feature = "modal", feature = "cli"))]
pub(crate) use constrained::turns_as_a_whole;
pub use constrained::{Constrained, linearise_constrained, linearise_driven, steady_coordinates};
#[cfg(feature = "modal")]
pub use constrained::{Tangent, linearise_tangent, turning_coordinates};
#[cfg(feature = "cli")]
pub(crate) use equilibrium::force_unit;
pub use equilibrium::{
    Equilibrium, Guess, Jump, Linearised, Trimmed, TrimmedValue, Unknown, ZeroStiffness, equilibria, equilibrium_here,
    equilibrium_near, linearise, state_matrix, trim, trim_steady,
};
#[cfg(feature = "modal")]
pub use equilibrium::{SampledLoop, StateSpace, linearise_sampled, linearise_states};
#[cfg(all(feature = "cli", feature = "modal"))]
pub(crate) use equilibrium::{periods, ticking};
#[cfg(feature = "cli")]
pub(crate) use forced::turned;
pub use forced::{
    Drive, Harmonic, InputOutput, Measured, Motion, NamedDrive, Observed, Peak, Response, Source, Steady, Unreached,
    beat, bode, linearise_instant, measure, observe, solvemode, solvenorm, solvenum,
};
pub use matrices::{LinearMechanism, SparseMatrix, expm};
#[cfg(feature = "modal")]
pub use modes::{ComplexModes, FirstOrder, Stability, complex_modes, first_order_modes};
pub use modes::{
    DiagonalDamping, Kind, Mode, Reduction, animate_mode, campbell, draw_modes, normal_modes, proportional_damping,
    root_locus,
};
pub use rigid::{Part, name_free_modes};
pub use typed::Linearise;

/// Whether coordinates depend on each other: where constraints act, and where some are the numbers of a rotation.  Such a mechanism is
/// linearised by [`linearise_constrained`].
pub fn has_dependent_coordinates<S: System + ?Sized>(system: &S) -> bool {
    !system.active_rows().is_empty() || !system.description().rotations.is_empty()
}

/// Where a search for rest starts: the file's guess; where it gives none a motion's start where constraints must be met, or forces have no value
/// at 0, as that of a spring whose ends meet; else 0.
pub(crate) fn guess_of_rest<S: System + ?Sized>(system: &S, start: &[f64]) -> Vec<f64> {
    let absent = || {
        let (origin, mut forces) = (vec![0.0; system.len()], vec![0.0; system.len()]);
        system.bias(At::new(0.0, &origin, &origin), &mut forces);
        let serves = !has_dependent_coordinates(system) && forces.iter().all(|force| force.is_finite());
        if serves { origin } else { start.to_vec() }
    };
    system.equilibrium_guess().unwrap_or_else(absent)
}
