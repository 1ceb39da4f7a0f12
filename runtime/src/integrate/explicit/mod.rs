//! Explicit Runge–Kutta methods, with a fixed step or with error control.

mod dense;
mod dop853;
mod dopri5;
mod euler;
mod midpoint;
mod rk4;
mod step;
mod tableau;
#[cfg(test)]
mod tests;

pub(crate) use dop853::DOP853;
pub(crate) use dopri5::DOPRI5;
pub(crate) use euler::EULER;
pub(crate) use midpoint::MIDPOINT;
pub(crate) use rk4::RK4;
pub(crate) use step::ExplicitRungeKutta;
pub(crate) use tableau::{Control, Tableau};
