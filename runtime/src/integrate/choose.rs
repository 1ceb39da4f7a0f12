//! The code behind each method's name.

use super::OneStep;
use super::explicit::{DOP853, DOPRI5, EULER, ExplicitRungeKutta, MIDPOINT, RK4, Tableau};
use crate::mechanism::{Method, System};

pub(crate) fn tableau(method: Method) -> &'static Tableau {
    match method {
        Method::Euler => &EULER,
        Method::Midpoint => &MIDPOINT,
        Method::Rk4 => &RK4,
        Method::Dopri5 => &DOPRI5,
        Method::Dop853 | Method::Auto => &DOP853,
    }
}

/// A stepper for states of this width.
pub(crate) fn stepper<S: System + ?Sized>(method: Method, width: usize) -> Box<dyn OneStep<S>> {
    Box::new(ExplicitRungeKutta::new(tableau(method), width))
}

/// Coefficients c₀, c₁, … of a method's stability function R(z) = Σ cₖzᵏ: a step multiplies y' = λy by R(hλ).
pub(crate) fn stability(method: Method) -> Vec<f64> {
    tableau(method).stability()
}
