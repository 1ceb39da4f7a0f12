//! The scalar that generated code is generic over.
//!
//! Every method is `#[inline]`: in an incremental build these calls would otherwise stay calls in generated code.

use super::noise::normal;
use super::{Table, Table2d};
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or several side by side (lanes): what generated functions compute with.
///
/// Small on purpose: generated text instantiates for `f64`, `f32`, dual numbers, SIMD lanes and
/// double-double alike, at no cost for `f64`.  Without the standard library functions are those of the crate `libm`.
pub trait Real:
    Copy
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// How many numbers travel together.
    const LANES: usize;

    /// Collects one number per lane.
    fn gather(lane: impl Fn(usize) -> f64) -> Self;

    /// The number in a lane, 0 the first.
    fn lane(self, lane: usize) -> f64;

    /// The constant n/d; types wider than `f64` divide at their own precision.
    fn ratio(n: f64, d: f64) -> Self;

    /// √x.
    fn sqrt(self) -> Self;
    /// (sin x, cos x), x in radians.
    fn sin_cos(self) -> (Self, Self);
    /// tan x.
    fn tan(self) -> Self;
    /// arcsin x.
    fn asin(self) -> Self;
    /// arccos x.
    fn acos(self) -> Self;
    /// arctan x.
    fn atan(self) -> Self;
    /// The angle of the point (x, y), with `self` = y.
    fn atan2(self, x: Self) -> Self;
    /// sinh x.
    fn sinh(self) -> Self;
    /// cosh x.
    fn cosh(self) -> Self;
    /// tanh x.
    fn tanh(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// ln x.
    fn ln(self) -> Self;
    /// xʸ for a y that is no small integer.
    fn powf(self, y: Self) -> Self;

    /// `yes` where `self` ≥ 0, `no` elsewhere (NaN counts as elsewhere), without a branch.
    fn select_nonnegative(self, yes: Self, no: Self) -> Self;

    /// True when every lane of `self` is greater than that of `floor`; false for NaN.
    fn exceeds(self, floor: Self) -> bool;

    /// A pivot of M smaller than this, relative to M's diagonal, is rounding.
    #[inline]
    fn pivot_floor() -> Self {
        Self::from_f64(1e-15)
    }

    /// The constant `x`.
    #[inline]
    fn from_f64(x: f64) -> Self {
        Self::ratio(x, 1.0)
    }

    /// |x|.
    #[inline]
    fn abs(self) -> Self {
        self.select_nonnegative(self, -self)
    }

    /// −1, 0 or 1; `sign(0)` is 0, and NaN is that of NaN.
    #[inline]
    fn sign(self) -> Self {
        self.step() - (-self).step()
    }

    /// Heaviside's function, 1 at 0; NaN of NaN.
    #[inline]
    fn step(self) -> Self {
        by_sign(self, [1.0, 0.0].map(Self::from_f64), Self::from_f64(f64::NAN))
    }

    /// A table at this argument, or one of its derivatives there.
    #[inline]
    fn table(self, table: &Table, order: usize) -> Self {
        table.evaluate(self, order)
    }

    /// A table of two arguments at this one and another, or one of its derivatives by both there.
    #[inline]
    fn table_2d(self, other: Self, table: &Table2d, order: [usize; 2]) -> Self {
        table.evaluate(self, other, order)
    }

    /// The number of standard normal distribution of this seed and a place in the stream of a key.
    #[inline]
    fn normal(self, place: Self, key: u64) -> Self {
        Self::gather(|lane| normal(key, self.lane(lane), place.lane(lane)))
    }

    /// The smaller of two; NaN where one of them is.
    #[inline]
    fn min(self, other: Self) -> Self {
        by_sign(other - self, [self, other], self + other)
    }

    /// The larger of two; NaN where one of them is.
    #[inline]
    fn max(self, other: Self) -> Self {
        by_sign(self - other, [self, other], self + other)
    }
}

/// The first where x ≥ 0, the second where x < 0, `neither` where x is NaN: as the difference of a NaN and anything is, and that of two equal infinities.
#[inline]
fn by_sign<T: Real>(x: T, [nonnegative, negative]: [T; 2], neither: T) -> T {
    x.select_nonnegative(nonnegative, (-x).select_nonnegative(negative, neither))
}

macro_rules! real_for_float {
    ($float:ident, $functions:ident) => {
        impl Real for $float {
            const LANES: usize = 1;

            #[inline]
            fn gather(lane: impl Fn(usize) -> f64) -> Self {
                lane(0) as $float
            }
            #[inline]
            fn lane(self, _: usize) -> f64 {
                f64::from(self)
            }
            #[inline]
            fn ratio(n: f64, d: f64) -> Self {
                (n / d) as $float
            }
            $functions!($float);
            #[inline]
            fn select_nonnegative(self, yes: Self, no: Self) -> Self {
                if self >= 0.0 { yes } else { no }
            }
            #[inline]
            fn exceeds(self, floor: Self) -> bool {
                self > floor
            }
            #[inline]
            fn pivot_floor() -> Self {
                4.0 * $float::EPSILON
            }
            #[inline]
            fn abs(self) -> Self {
                $float::abs(self)
            }
        }
    };
}

/// The functions of the trait, by those of these paths.
macro_rules! functions {
    ($($name:ident($($y:ident)?) = $of:path;)*) => {$(
        #[inline]
        fn $name(self $(, $y: Self)?) -> Self {
            $of(self $(, $y)?)
        }
    )*};
}

#[cfg(feature = "std")]
macro_rules! functions_of_std {
    ($float:ident) => {
        #[inline]
        fn sin_cos(self) -> (Self, Self) {
            $float::sin_cos(self)
        }
        functions! {
            sqrt() = $float::sqrt; tan() = $float::tan; asin() = $float::asin; acos() = $float::acos; atan() = $float::atan;
            atan2(x) = $float::atan2; sinh() = $float::sinh; cosh() = $float::cosh; tanh() = $float::tanh; exp() = $float::exp;
            ln() = $float::ln; powf(y) = $float::powf;
        }
    };
}

#[cfg(not(feature = "std"))]
macro_rules! functions_of_libm {
    (f64) => {
        #[inline]
        fn sin_cos(self) -> (Self, Self) {
            libm::sincos(self)
        }
        functions! {
            sqrt() = libm::sqrt; tan() = libm::tan; asin() = libm::asin; acos() = libm::acos; atan() = libm::atan; atan2(x) = libm::atan2;
            sinh() = libm::sinh; cosh() = libm::cosh; tanh() = libm::tanh; exp() = libm::exp; ln() = libm::log; powf(y) = libm::pow;
        }
    };
    (f32) => {
        #[inline]
        fn sin_cos(self) -> (Self, Self) {
            libm::sincosf(self)
        }
        functions! {
            sqrt() = libm::sqrtf; tan() = libm::tanf; asin() = libm::asinf; acos() = libm::acosf; atan() = libm::atanf; atan2(x) = libm::atan2f;
            sinh() = libm::sinhf; cosh() = libm::coshf; tanh() = libm::tanhf; exp() = libm::expf; ln() = libm::logf; powf(y) = libm::powf;
        }
    };
}

#[cfg(feature = "std")]
real_for_float!(f64, functions_of_std);
#[cfg(feature = "std")]
real_for_float!(f32, functions_of_std);
#[cfg(not(feature = "std"))]
real_for_float!(f64, functions_of_libm);
#[cfg(not(feature = "std"))]
real_for_float!(f32, functions_of_libm);

/// The largest whole number that is not above x.
#[inline]
pub(crate) fn floor(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.floor();
    #[cfg(not(feature = "std"))]
    return libm::floor(x);
}

/// The nearest whole number; of two, that farther from 0.
#[inline]
pub(crate) fn round(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.round();
    #[cfg(not(feature = "std"))]
    return libm::round(x);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nan_stays_nan<T: Real>() {
        let of = |x: f64| T::from_f64(x);
        let nan = of(f64::NAN);
        assert!([nan.step(), nan.sign(), nan.abs()].iter().all(|x| x.lane(0).is_nan()));
        let infinity = f64::INFINITY;
        for x in [-infinity, -1.0, -0.0, 0.0, 1.0, infinity] {
            let of_both = [nan.min(of(x)), of(x).min(nan), nan.max(of(x)), of(x).max(nan)];
            assert!(of_both.iter().all(|x| x.lane(0).is_nan()), "{x}");
            assert_eq!(of(x).step().lane(0), f64::from(u8::from(x >= 0.0)), "{x}");
            assert_eq!(of(x).sign().lane(0), if x == 0.0 { 0.0 } else { x.signum() }, "{x}");
            for y in [-infinity, -0.0, 0.0, 1.0, infinity] {
                assert_eq!(of(x).min(of(y)).lane(0), f64::min(x, y), "{x}, {y}");
                assert_eq!(of(x).max(of(y)).lane(0), f64::max(x, y), "{x}, {y}");
            }
        }
    }

    #[test]
    fn floats_keep_nan() {
        nan_stays_nan::<f64>();
        nan_stays_nan::<f32>();
    }
}
