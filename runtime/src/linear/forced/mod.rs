//! Motions of the linear model: free, forced, steady; frequency responses; and what is measured of a motion.

mod bode;
mod drive;
mod harmonic;
mod initial_value;
mod input_output;
mod instant;
mod measured;
mod motion;
mod observed;
mod peak;
mod response;

#[cfg(test)]
mod forced_tests;
#[cfg(test)]
mod steady_tests;

pub use bode::bode;
#[cfg(feature = "cli")]
pub(crate) use drive::turned;
pub use drive::{Drive, Source, Steady};
pub use harmonic::{Harmonic, beat};
pub use initial_value::{Motion, solvemode, solvenorm, solvenum};
pub use input_output::{InputOutput, NamedDrive, Unreached};
#[cfg(feature = "modal")]
pub(in crate::linear) use input_output::{Pushed, rated, together};
pub use instant::linearise_instant;
pub use measured::{Measured, measure};
#[cfg(feature = "modal")]
pub(in crate::linear) use observed::named_answers;
pub(in crate::linear) use observed::slopes_of;
pub use observed::{Observed, observe};
pub use peak::Peak;
pub use response::Response;
