//! Modes: normal ones, those of damped, gyroscopic and circulatory systems, what is wrong with them, and their pictures.

#[cfg(feature = "modal")]
mod classical;
#[cfg(feature = "modal")]
mod damped;
#[cfg(feature = "modal")]
mod deflation;
#[cfg(feature = "modal")]
mod dissipation;
#[cfg(feature = "modal")]
mod first_order;
#[cfg(feature = "modal")]
mod graded;
mod loci;
mod mode;
mod normal;
mod pictures;
mod proportional;
#[cfg(feature = "modal")]
mod secular;

#[cfg(all(test, feature = "modal"))]
mod damped_tests;

#[cfg(feature = "modal")]
pub use damped::{ComplexModes, complex_modes};
#[cfg(feature = "modal")]
pub(super) use deflation::{nullities, without_zeros};
#[cfg(feature = "modal")]
pub use first_order::{FirstOrder, Stability, first_order_modes};
#[cfg(feature = "modal")]
pub(super) use graded::{doubted_modes, graded_modes, kernel};
pub(super) use loci::matched;
pub use loci::{campbell, root_locus};
pub use mode::{Kind, Mode};
pub(super) use normal::{Fault, Spectrum};
pub use normal::{Reduction, normal_modes};
pub use pictures::{animate_mode, draw_modes};
pub use proportional::{DiagonalDamping, proportional_damping};
