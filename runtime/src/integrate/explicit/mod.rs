//! Explicit Runge–Kutta methods, with a fixed step or with error control.

mod dense;
mod dop853;
mod dopri5;
mod euler;
mod midpoint;
mod rk4;
mod step;
mod sums;
mod tableau;
#[cfg(test)]
mod tests;

pub(crate) use dop853::{DOP853, Dop853};
pub(crate) use dopri5::{DOPRI5, Dopri5};
pub(crate) use euler::{EULER, Euler};
pub(crate) use midpoint::{MIDPOINT, Midpoint};
pub(crate) use rk4::{RK4, Rk4};
pub(crate) use step::ExplicitRungeKutta;
pub(crate) use tableau::{Scheme, Term};
#[cfg(feature = "ensemble")]
pub(crate) use tableau::{Stage, stages};
pub(super) use tableau::{r, x};
