//! The names that a program with a mechanism needs: `use dalembert::prelude::*;`.

pub use crate::cause::Cause;
pub use crate::error::Error;
pub use crate::linear::{Guess, Linearise, Linearised, Mode};
pub use crate::mechanism::{At, Equations, Mechanism, Method, System};
pub use crate::run::{Run, State};
pub use crate::simulate::{Settings, Simulate, Simulation, simulate};
