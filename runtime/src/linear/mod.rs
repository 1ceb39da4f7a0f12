//! Small motions: equilibria, linearisation to M, C and K, and modes.
//!
//! 1. [`equilibrium_near`] searches, [`equilibrium_here`] verifies: look in `equilibrium.rs`; what directions
//!    without stiffness are (families, degenerate equilibria): look in `family.rs`; dry friction and contacts: look in
//!    `discontinuity.rs`.
//! 2. [`linearise`] gives M, C and K there as [`Linearised`]: look in `linearise.rs`.
//! 3. Undamped: [`normal_modes`]; look in `normal.rs`, and for starting from given states
//!    ([`solvenum`], [`solvemode`], [`solvenorm`]) in `initial_value.rs`.
//! 4. Damped, gyroscopic, circulatory: [`Linearised::modes`]; complex modes need the feature `modal`: look in
//!    `damped.rs`; systems z' = A z of first order: look in `first_order.rs`.  Motions by the matrix exponential [`expm`]: look in `motion.rs`.
//! 5. Forced: steady states, resonance, steps, impulses, any input: look in `forced.rs`; frequency responses, by
//!    modes: look in `drive.rs`.
//! 6. Proportional and diagonal damping: look in `proportional.rs`.
//! 7. Measuring frequency and damping of a run: look in `measured.rs`.
//! 8. Pictures: look in `pictures.rs`.
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
mod equilibrium;
mod error;
mod forced;
mod matrices;
mod modes;
mod numbers;
mod rigid;
mod typed;

pub use branch::{Branch, BranchPoint, Change, Threshold, ThresholdKind, follow};
pub use equilibrium::{
    Equilibrium, Freedom, Guess, Jump, Linearised, equilibria, equilibrium_here, equilibrium_near, linearise,
    state_matrix,
};
pub use error::{LinearError, Residual};
pub use forced::{
    Drive, Harmonic, Measured, Motion, Source, Steady, beat, bode, measure, solvemode, solvenorm, solvenum,
};
pub use matrices::{LinearMechanism, SparseMatrix, expm};
#[cfg(feature = "modal")]
pub use modes::{ComplexModes, FirstOrder, Stability, complex_modes, first_order_modes};
pub use modes::{
    DiagonalDamping, Kind, Mode, Reduction, animate_mode, draw_modes, normal_modes, proportional_damping, root_locus,
};
pub use numbers::{short, short_beside};
pub use rigid::{Part, name_free_modes};
pub use typed::Linearise;
