//! Runge–Kutta–Nyström methods for q'' = a(t, q), with error control or a fixed step.
//!
//! Where accelerations do not depend on speeds, stages of speeds need not be computed: an order takes fewer evaluations than
//! with methods for equations of first order, 8 instead of 12 at order 8 (Hairer, Nørsett, Wanner, Solving Ordinary
//! Differential Equations I, 1993, II.14).

mod dense;
mod rkn8;
mod step;
mod tableau;
#[cfg(test)]
mod tests;

pub(crate) use rkn8::RKN8;
pub(crate) use step::Nystrom;
#[cfg(feature = "ensemble")]
pub(crate) use step::Stage;
pub(crate) use tableau::Tableau;
