//! What generated code implements, and what is built on it: scalars, mechanisms, systems, descriptions.

mod at;
mod balances;
pub(crate) mod dense;
mod dual;
mod dynamic;
mod enforcement;
#[cfg(feature = "interpret")]
mod interpreted;
mod kkt;
mod method;
#[cfg(feature = "modal")]
mod noise;
mod phased;
mod rates;
mod series;
mod singular;
pub(crate) mod sliding;
mod slopes;
mod subsystem;
mod system;

pub use at::At;
pub use balances::Balances;
pub use dynamic::Dynamic;
pub use enforcement::{Enforcement, Stabilisation};
#[cfg(feature = "interpret")]
pub(crate) use interpreted::ExtendedAt;
#[cfg(feature = "interpret")]
pub use interpreted::Interpreted;
pub(crate) use kkt::{KktSolver, Solutions};
pub use method::{Method, ParseMethodError};
#[cfg(feature = "modal")]
pub(crate) use noise::is_of_noise;
pub use phased::RowHistory;
pub use rates::{choose_sides, rate_jacobian};
pub(crate) use series::{Jets, MotionJets, dot};
pub use singular::Singular;
pub(crate) use slopes::AccelerationSlopes;
pub(crate) use subsystem::OfPart;
pub(crate) use system::rows_in_force;
pub use system::{Along, Function, Signal, System};

#[doc(inline)]
pub use dalembert_mechanism::*;
