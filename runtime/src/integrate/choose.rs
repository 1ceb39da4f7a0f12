//! The code behind each method's name.

use super::exact::Exact;
use super::explicit::Scheme;
use super::explicit::{DOP853, DOPRI5, Dop853, Dopri5, EULER, Euler, ExplicitRungeKutta, MIDPOINT, Midpoint, RK4, Rk4};
use super::implicit::{Collocation, GAUSS_2, GAUSS_4, GAUSS_6, RADAU_5};
use super::moreau::TimeStepping;
use super::nystrom::{Nystrom, RKN8};
use super::rosenbrock::{RODAS5P, Rosenbrock};
use super::symplectic::{KAHAN_LI_8, SRKN4, SUZUKI_4, Splitting, Symplectic, VERLET};
use super::taylor::{ORDER, Taylor};
use super::{OneStep, Stability};
use crate::mechanism::Method;

/// Calls a constructor with arrays up to ten coordinates, beyond which evaluating the accelerations takes most of the time,
/// and with a box above.  In a browser, where code is sent and models are interpreted, always with a box.
macro_rules! sized {
    ($n:expr, $block:ident => $new:expr) => {{
        #[cfg(not(target_family = "wasm"))]
        let stepper = sized!(@ $n, $block => $new, 1 2 3 4 5 6 7 8 9 10);
        #[cfg(target_family = "wasm")]
        let stepper = sized!(@ $n, $block => $new,);
        stepper
    }};
    (@ $n:expr, $block:ident => $new:expr, $($size:literal)*) => {
        match $n {
            $($size => { type $block = [[f64; $size]; 2]; Box::new($new) as Box<dyn OneStep> })*
            _ => { type $block = Box<[f64]>; Box::new($new) }
        }
    };
}

/// A stepper for n coordinates; `work` tells whether it integrates the power of what has no potential.
pub(crate) fn stepper(method: Method, n: usize, work: bool) -> Box<dyn OneStep> {
    match method {
        Method::Euler => explicit::<Euler>(n, work),
        Method::Midpoint => explicit::<Midpoint>(n, work),
        Method::Rk4 => explicit::<Rk4>(n, work),
        Method::Dopri5 => explicit::<Dopri5>(n, work),
        Method::Dop853 | Method::Auto => explicit::<Dop853>(n, work),
        Method::Rkn8 => sized!(n, Y => Nystrom::<Y>::new(n, work)),
        Method::Verlet => symplectic(VERLET, n, work),
        Method::Srkn4 => symplectic(SRKN4, n, work),
        Method::Suzuki4 => symplectic(SUZUKI_4, n, work),
        Method::KahanLi8 => symplectic(KAHAN_LI_8, n, work),
        Method::Gauss2 => Box::new(Collocation::new(GAUSS_2, n, work)),
        Method::Gauss4 => Box::new(Collocation::new(GAUSS_4, n, work)),
        Method::Gauss6 => Box::new(Collocation::new(GAUSS_6, n, work)),
        Method::Radau5 => Box::new(Collocation::new(RADAU_5, n, work)),
        Method::Rodas5P => Box::new(Rosenbrock::new(RODAS5P, n, work)),
        Method::Exact => Box::new(Exact::new(n, work)),
        Method::Taylor => Box::new(Taylor::new(n, work)),
        Method::Moreau => Box::new(TimeStepping::new(n, work)),
    }
}

/// The order of a method's solution.
pub(crate) fn order(method: Method) -> u32 {
    match method {
        Method::Euler => EULER.order,
        Method::Midpoint => MIDPOINT.order,
        Method::Rk4 => RK4.order,
        Method::Dopri5 => DOPRI5.order,
        Method::Dop853 | Method::Auto => DOP853.order,
        Method::Rkn8 => RKN8.order,
        Method::Verlet => VERLET.order,
        Method::Srkn4 => SRKN4.order,
        Method::Suzuki4 => SUZUKI_4.order,
        Method::KahanLi8 => KAHAN_LI_8.order,
        Method::Gauss2 => GAUSS_2.order,
        Method::Gauss4 => GAUSS_4.order,
        Method::Gauss6 => GAUSS_6.order,
        Method::Radau5 => RADAU_5.order,
        Method::Rodas5P => RODAS5P.order,
        // That of its polynomial between the ends.
        Method::Exact => 12,
        Method::Taylor => ORDER as u32,
        Method::Moreau => 1,
    }
}

/// What a step of a method multiplies modes by.
pub(crate) fn stability(method: Method) -> Stability {
    match method {
        Method::Euler => Stability::Polynomial(EULER.stability()),
        Method::Midpoint => Stability::Polynomial(MIDPOINT.stability()),
        Method::Rk4 => Stability::Polynomial(RK4.stability()),
        Method::Dopri5 => Stability::Polynomial(DOPRI5.stability()),
        Method::Dop853 | Method::Auto => Stability::Polynomial(DOP853.stability()),
        Method::Rkn8 => Stability::Nystrom(&RKN8),
        // Between impulses a drift, a kick and a drift are those of Störmer and Verlet from middle to middle.
        Method::Verlet | Method::Moreau => Stability::Splitting(VERLET),
        Method::Srkn4 => Stability::Splitting(SRKN4),
        Method::Suzuki4 => Stability::Splitting(SUZUKI_4),
        Method::KahanLi8 => Stability::Splitting(KAHAN_LI_8),
        Method::Gauss2 => Stability::Rational(GAUSS_2.stability),
        Method::Gauss4 => Stability::Rational(GAUSS_4.stability),
        Method::Gauss6 => Stability::Rational(GAUSS_6.stability),
        Method::Radau5 => Stability::Rational(RADAU_5.stability),
        Method::Rodas5P => Stability::Rational(RODAS5P.stability),
        Method::Exact => Stability::Exponential,
        Method::Taylor => Stability::Polynomial(exponential()),
    }
}

/// The powers 0 to [`ORDER`] of the exponential.
fn exponential() -> Vec<f64> {
    let mut term = 1.0;
    let next = |k: usize| {
        term /= k.max(1) as f64;
        term
    };
    (0..=ORDER).map(next).collect()
}

fn explicit<T: Scheme>(n: usize, work: bool) -> Box<dyn OneStep> {
    sized!(n, Y => ExplicitRungeKutta::<T, Y>::new(n, work))
}

fn symplectic(scheme: &'static Splitting, n: usize, work: bool) -> Box<dyn OneStep> {
    sized!(n, Y => Symplectic::<Y>::new(scheme, n, work))
}
