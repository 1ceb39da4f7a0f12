//! The names that a program with a mechanism needs: `use dalembert::prelude::*;`.

pub use crate::error::{Cause, Error};
pub use crate::integrate::Method;
pub use crate::linear::{Guess, Linearise, Linearised, Mode};
pub use crate::mechanism::{Mechanism, System};
pub use crate::run::{Run, State};
pub use crate::simulate::{Settings, Simulate, Simulation, simulate};
