//! Numbers side by side.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::sine;
use crate::mechanism::Real;

/// Several numbers in one SIMD register: what the runs of an ensemble are computed with, one run a lane.
///
/// `f64x8` is the usual choice; `f64x4` serves processors with registers of 256 bits as well, and `f64` takes one run at a
/// time.  Results do not depend on it by more than a unit in the last place of a sine.
pub trait Lanes: Real + 'static {}

impl Lanes for f64 {}

/// Operations of two registers, lane by lane.
macro_rules! operations {
    ($lanes:ident: $($trait:ident::$name:ident),*) => {$(
        impl $trait for $lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0.$name(other.0))
            }
        }
    )*};
}

macro_rules! lanes {
    ($lanes:ident, $count:literal) => {
        #[doc = concat!($count, " numbers in one SIMD register.")]
        #[derive(Clone, Copy, Debug)]
        #[expect(non_camel_case_types, reason = "as the primitive types are called")]
        pub struct $lanes(wide::$lanes);

        impl $lanes {
            /// One number a lane.
            pub fn new(numbers: [f64; $count]) -> Self {
                Self(wide::$lanes::new(numbers))
            }
            /// The numbers of all lanes.
            pub fn to_array(self) -> [f64; $count] {
                self.0.to_array()
            }
        }

        impl Lanes for $lanes {}

        operations! { $lanes: Add::add, Sub::sub, Mul::mul, Div::div }

        impl Neg for $lanes {
            type Output = Self;

            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Real for $lanes {
            const LANES: usize = $count;

            #[inline]
            fn gather(lane: impl Fn(usize) -> f64) -> Self {
                Self::new(std::array::from_fn(lane))
            }
            #[inline]
            fn lane(self, lane: usize) -> f64 {
                self.to_array()[lane]
            }
            #[inline]
            fn ratio(n: f64, d: f64) -> Self {
                Self(wide::$lanes::splat(n / d))
            }
            #[inline]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            // Inlined always: sines of several angles wait for each other otherwise.
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let both = sine::sin_cos(self);
                if self.0.abs().simd_le(wide::$lanes::splat(sine::LARGEST)).all() {
                    return both;
                }
                let (sine, cosine) = far_sin_cos(self.to_array(), (both.0.to_array(), both.1.to_array()));
                (Self::new(sine), Self::new(cosine))
            }
            #[inline]
            fn tan(self) -> Self {
                Self::new(each(self.to_array(), f64::tan))
            }
            #[inline]
            fn asin(self) -> Self {
                Self::new(each(self.to_array(), f64::asin))
            }
            #[inline]
            fn acos(self) -> Self {
                Self::new(each(self.to_array(), f64::acos))
            }
            #[inline]
            fn atan(self) -> Self {
                Self::new(each(self.to_array(), f64::atan))
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                Self::new(both(self.to_array(), x.to_array(), f64::atan2))
            }
            #[inline]
            fn sinh(self) -> Self {
                Self::new(each(self.to_array(), f64::sinh))
            }
            #[inline]
            fn cosh(self) -> Self {
                Self::new(each(self.to_array(), f64::cosh))
            }
            #[inline]
            fn tanh(self) -> Self {
                Self::new(each(self.to_array(), f64::tanh))
            }
            #[inline]
            fn exp(self) -> Self {
                Self::new(each(self.to_array(), f64::exp))
            }
            #[inline]
            fn ln(self) -> Self {
                Self::new(each(self.to_array(), f64::ln))
            }
            #[inline]
            fn powf(self, y: Self) -> Self {
                Self::new(both(self.to_array(), y.to_array(), f64::powf))
            }
            #[inline]
            fn select_nonnegative(self, yes: Self, no: Self) -> Self {
                Self(self.0.simd_ge(wide::$lanes::splat(0.0)).select(yes.0, no.0))
            }
            #[inline]
            fn exceeds(self, floor: Self) -> bool {
                self.0.simd_gt(floor.0).all()
            }
            #[inline]
            fn pivot_floor() -> Self {
                Self::from_f64(f64::pivot_floor())
            }
            #[inline]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
        }
    };
}

lanes!(f64x4, 4);
lanes!(f64x8, 8);

/// (sin x, cos x) of those lanes for whose x the fast ones do not serve.
#[cold]
#[inline(never)]
fn far_sin_cos<const L: usize>(x: [f64; L], both: ([f64; L], [f64; L])) -> ([f64; L], [f64; L]) {
    let (mut sine, mut cosine) = both;
    for (index, x) in x.into_iter().enumerate() {
        if x.is_nan() || x.abs() > sine::LARGEST {
            (sine[index], cosine[index]) = x.sin_cos();
        }
    }
    (sine, cosine)
}

/// A function that no processor has, lane by lane: as exact as that of `f64`.
fn each<const L: usize>(x: [f64; L], function: impl Fn(f64) -> f64) -> [f64; L] {
    x.map(function)
}

fn both<const L: usize>(x: [f64; L], y: [f64; L], function: impl Fn(f64, f64) -> f64) -> [f64; L] {
    std::array::from_fn(|i| function(x[i], y[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance in units of the last place of the second.
    fn places(a: f64, b: f64) -> f64 {
        (a - b).abs() / (f64::EPSILON * b.abs().max(f64::MIN_POSITIVE / f64::EPSILON))
    }

    #[test]
    fn sines_are_those_of_the_standard_library() {
        let mut worst = 0.0_f64;
        for k in 0..200_000 {
            let x = match k % 5 {
                0 => 1e-3 * f64::from(k),
                1 => -1.37e1 * f64::from(k),
                2 => std::f64::consts::FRAC_PI_4 * f64::from(k),
                3 => std::f64::consts::FRAC_PI_2 * f64::from(k - 100_000),
                _ => 1e-9 / f64::from(k),
            };
            let (sine, cosine) = Real::sin_cos(f64x8::from_f64(x));
            worst = worst.max(places(sine.lane(k as usize % 8), x.sin())).max(places(cosine.lane(0), x.cos()));
        }
        assert!(worst <= 1.0, "{worst} units in the last place");
    }

    #[test]
    fn no_lane_is_touched_by_its_neighbours() {
        let all = [1e300, f64::NAN, -0.0, 0.5, f64::INFINITY, -2e6, 3.0, 1e-320];
        let (sine, cosine) = Real::sin_cos(f64x8::new(all));
        for (index, x) in all.into_iter().enumerate() {
            let alone = Real::sin_cos(f64x8::from_f64(x));
            assert_eq!(sine.lane(index).to_bits(), alone.0.lane(0).to_bits(), "sin {x}");
            assert_eq!(cosine.lane(index).to_bits(), alone.1.lane(0).to_bits(), "cos {x}");
        }
        assert!(sine.lane(1).is_nan() && sine.lane(4).is_nan());
    }

    #[test]
    fn selections_follow_each_lane() {
        let x = f64x4::new([-1.0, 0.0, 2.0, f64::NAN]);
        let chosen = x.select_nonnegative(f64x4::from_f64(1.0), f64x4::from_f64(-1.0));
        assert_eq!(chosen.to_array(), [-1.0, 1.0, 1.0, -1.0]);
        assert!(x.step().lane(3).is_nan() && x.sign().lane(3).is_nan() && x.abs().lane(3).is_nan());
        let one = f64x4::from_f64(1.0);
        for both in [x.min(one), one.min(x), x.max(one), one.max(x)] {
            assert!(both.lane(3).is_nan() && both.to_array()[..3].iter().all(|x| x.is_finite()));
        }
        assert!(!f64x4::from_f64(1.0).exceeds(x) && f64x4::from_f64(1.0).exceeds(f64x4::from_f64(0.5)));
    }
}
