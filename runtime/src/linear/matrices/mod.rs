//! Matrices: sparse ones, dense decompositions, scaling, ranks, the exponential, and mechanisms given by matrices.

mod balanced;
mod cholesky;
#[cfg(feature = "modal")]
mod eigen;
mod expm;
mod mechanism;
mod scaled;
mod singular;
mod sparse;
mod symmetric;
mod tridiagonal;

pub(super) use balanced::balanced;
pub(super) use cholesky::{cholesky, first_order, solve_cholesky};
#[cfg(feature = "modal")]
pub(super) use eigen::{Eigen, condition};
pub use expm::expm;
pub use mechanism::LinearMechanism;
pub(super) use scaled::{NO_ANGLE, Scaled, first_part, is_lost, natural_sizes, null_space, tried_parts};
pub(super) use singular::Singular;
pub use sparse::SparseMatrix;
pub(super) use symmetric::symmetric_eigen;
