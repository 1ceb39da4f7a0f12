//! The code behind each method's name.

use super::OneStep;
use super::explicit::{DOP853, DOPRI5, Dop853, Dopri5, EULER, Euler, ExplicitRungeKutta, MIDPOINT, Midpoint, RK4, Rk4};
use super::explicit::{Scheme, Tableau};
use crate::mechanism::Method;

/// A stepper for n coordinates; `work` tells whether it integrates the power of what has no potential.
pub(crate) fn stepper(method: Method, n: usize, work: bool) -> Box<dyn OneStep> {
    match method {
        Method::Euler => sized::<Euler>(n, work),
        Method::Midpoint => sized::<Midpoint>(n, work),
        Method::Rk4 => sized::<Rk4>(n, work),
        Method::Dopri5 => sized::<Dopri5>(n, work),
        Method::Dop853 | Method::Auto => sized::<Dop853>(n, work),
    }
}

/// Coefficients c₀, c₁, … of a method's stability function R(z) = Σ cₖzᵏ: a step multiplies y' = λy by R(hλ).
pub(crate) fn stability(method: Method) -> Vec<f64> {
    tableau(method).stability()
}

fn tableau(method: Method) -> &'static Tableau {
    match method {
        Method::Euler => EULER,
        Method::Midpoint => MIDPOINT,
        Method::Rk4 => RK4,
        Method::Dopri5 => DOPRI5,
        Method::Dop853 | Method::Auto => DOP853,
    }
}

/// Arrays up to ten coordinates, beyond which evaluating the accelerations takes most of the time; a box above.
fn sized<T: Scheme>(n: usize, work: bool) -> Box<dyn OneStep> {
    macro_rules! arrays {
        ($($size:literal)*) => {
            match n {
                $($size => Box::new(ExplicitRungeKutta::<T, [[f64; $size]; 2]>::new(n, work)),)*
                _ => Box::new(ExplicitRungeKutta::<T, Box<[f64]>>::new(n, work)),
            }
        };
    }
    arrays!(1 2 3 4 5 6 7 8 9 10)
}
