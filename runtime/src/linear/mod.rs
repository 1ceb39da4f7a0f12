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

#[cfg(feature = "modal")]
mod damped;
mod dense;
mod discontinuity;
mod drive;
mod equilibrium;
mod expm;
mod family;
#[cfg(feature = "modal")]
mod first_order;
mod forced;
mod initial_value;
mod linearise;
mod measured;
mod mechanism;
mod mode;
mod motion;
mod normal;
mod pictures;
mod probe;
mod proportional;
mod sparse;
mod typed;

#[cfg(all(test, feature = "modal"))]
mod damped_tests;
#[cfg(test)]
mod forced_tests;
#[cfg(test)]
mod steady_tests;
#[cfg(test)]
mod tests;

pub use crate::error::{LinearError, Residual};
pub use crate::numbers::{short, short_beside};
#[cfg(feature = "modal")]
pub use damped::{ComplexModes, complex_modes};
pub use discontinuity::Jump;
pub use drive::{Drive, Source, Steady};
pub use equilibrium::{Equilibrium, Guess, equilibria, equilibrium_here, equilibrium_near};
pub use expm::expm;
pub use family::Freedom;
#[cfg(feature = "modal")]
pub use first_order::{FirstOrder, Stability, first_order_modes};
pub use forced::{Harmonic, beat};
pub use initial_value::{Motion, solvemode, solvenorm, solvenum};
pub use linearise::{Linearised, linearise, state_matrix};
pub use measured::{Measured, measure};
pub use mechanism::LinearMechanism;
pub use mode::{Kind, Mode};
pub use normal::{Reduction, normal_modes};
#[cfg(feature = "cli")]
pub(crate) use pictures::matched;
pub use pictures::{animate_mode, bode, draw_modes, root_locus};
pub use proportional::{DiagonalDamping, proportional_damping};
pub use sparse::SparseMatrix;
pub use typed::Linearise;
