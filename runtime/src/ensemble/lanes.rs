//! Numbers side by side.

use wide::{f64x4, f64x8};

use super::sine;
use crate::mechanism::Real;

/// Several numbers in one SIMD register: what the runs of an ensemble are computed with, one run a lane.
///
/// `f64x8` is the usual choice; `f64x4` serves processors with registers of 256 bits as well, and `f64` takes one run at a
/// time.  Results do not depend on it by more than a unit in the last place of a sine.
pub trait Lanes: Real + 'static {}

impl Lanes for f64 {}

macro_rules! lanes {
    ($lanes:ident, $count:literal) => {
        impl Lanes for $lanes {}

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
                Self::splat(n / d)
            }
            #[inline]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            // Inlined always: sines of several angles wait for each other otherwise.
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                let both = sine::sin_cos(self);
                if self.abs().simd_le(Self::splat(sine::LARGEST)).all() {
                    return both;
                }
                let (sine, cosine) = far_sin_cos(self.to_array(), (both.0.to_array(), both.1.to_array()));
                (sine.into(), cosine.into())
            }
            #[inline]
            fn tan(self) -> Self {
                each(self.to_array(), f64::tan).into()
            }
            #[inline]
            fn asin(self) -> Self {
                each(self.to_array(), f64::asin).into()
            }
            #[inline]
            fn acos(self) -> Self {
                each(self.to_array(), f64::acos).into()
            }
            #[inline]
            fn atan(self) -> Self {
                each(self.to_array(), f64::atan).into()
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                both(self.to_array(), x.to_array(), f64::atan2).into()
            }
            #[inline]
            fn sinh(self) -> Self {
                each(self.to_array(), f64::sinh).into()
            }
            #[inline]
            fn cosh(self) -> Self {
                each(self.to_array(), f64::cosh).into()
            }
            #[inline]
            fn tanh(self) -> Self {
                each(self.to_array(), f64::tanh).into()
            }
            #[inline]
            fn exp(self) -> Self {
                each(self.to_array(), f64::exp).into()
            }
            #[inline]
            fn ln(self) -> Self {
                each(self.to_array(), f64::ln).into()
            }
            #[inline]
            fn powf(self, y: Self) -> Self {
                both(self.to_array(), y.to_array(), f64::powf).into()
            }
            #[inline]
            fn select_nonnegative(self, yes: Self, no: Self) -> Self {
                self.simd_ge(Self::splat(0.0)).select(yes, no)
            }
            #[inline]
            fn exceeds(self, floor: Self) -> bool {
                self.simd_gt(floor).all()
            }
            #[inline]
            fn pivot_floor() -> Self {
                Self::splat(f64::pivot_floor())
            }
            #[inline]
            fn abs(self) -> Self {
                self.abs()
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
            let (sine, cosine) = Real::sin_cos(f64x8::splat(x));
            worst = worst.max(places(sine.lane(k as usize % 8), x.sin())).max(places(cosine.lane(0), x.cos()));
        }
        assert!(worst <= 1.0, "{worst} units in the last place");
    }

    #[test]
    fn no_lane_is_touched_by_its_neighbours() {
        let all = [1e300, f64::NAN, -0.0, 0.5, f64::INFINITY, -2e6, 3.0, 1e-320];
        let (sine, cosine) = Real::sin_cos(f64x8::new(all));
        for (index, x) in all.into_iter().enumerate() {
            let alone = Real::sin_cos(f64x8::splat(x));
            assert_eq!(sine.lane(index).to_bits(), alone.0.lane(0).to_bits(), "sin {x}");
            assert_eq!(cosine.lane(index).to_bits(), alone.1.lane(0).to_bits(), "cos {x}");
        }
        assert!(sine.lane(1).is_nan() && sine.lane(4).is_nan());
    }

    #[test]
    fn selections_follow_each_lane() {
        let x = f64x4::new([-1.0, 0.0, 2.0, f64::NAN]);
        let chosen = x.select_nonnegative(f64x4::splat(1.0), f64x4::splat(-1.0));
        assert_eq!(chosen.to_array(), [-1.0, 1.0, 1.0, -1.0]);
        assert!(!f64x4::splat(1.0).exceeds(x) && f64x4::splat(1.0).exceeds(f64x4::splat(0.5)));
    }
}
