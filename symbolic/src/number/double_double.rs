//! Double-double arithmetic: the unevaluated sum of two `f64`, 106 bits.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

use super::Rational;

/// A number hi + lo with |lo| at most half a unit in the last place of hi.
///
/// Sums, products, quotients and roots are right to 2e-31 of their value, functions to 1e-30 of theirs, at huge
/// arguments and beside zeros, too; powers to 1e-28.  The tests of this folder assert it.  Where a value is below 1e-290
/// the lower half runs out of exponents and the error is 5e-324; infinities, NaN and signed zeros are those of `f64`.
///
/// Source of the algorithms of arithmetic: Joldes, Muller, Popescu (2017), Tight and rigorous error bounds for basic
/// building blocks of double-word arithmetic.
#[derive(Clone, Copy, Debug, Default)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

impl DoubleDouble {
    /// 0.
    pub const ZERO: DoubleDouble = DoubleDouble { hi: 0.0, lo: 0.0 };
    /// 1.
    pub const ONE: DoubleDouble = DoubleDouble { hi: 1.0, lo: 0.0 };
    /// π.
    pub const PI: DoubleDouble = DoubleDouble { hi: std::f64::consts::PI, lo: 1.2246467991473532e-16 };
    /// π/2.
    pub const FRAC_PI_2: DoubleDouble = DoubleDouble { hi: std::f64::consts::FRAC_PI_2, lo: 6.123233995736766e-17 };
    /// The unit of rounding, 2⁻¹⁰⁴: sums and products are right to a few of it.
    pub const UNIT: f64 = 1.0 / (1_u128 << 104) as f64;

    /// The sum of two `f64`, exactly.
    pub fn sum(a: f64, b: f64) -> DoubleDouble {
        let s = a + b;
        let part = s - a;
        let error = (a - (s - part)) + (b - part);
        normal(s, error)
    }

    /// The product of two `f64`, exactly while it is above 1e-290.
    pub fn product(a: f64, b: f64) -> DoubleDouble {
        let p = a * b;
        normal(p, a.mul_add(b, -p))
    }

    /// The nearest `f64`.
    pub fn to_f64(self) -> f64 {
        self.hi
    }

    /// What the nearest `f64` leaves out.
    pub fn rest(self) -> f64 {
        self.lo
    }

    /// True unless it is infinite or NaN.
    pub fn is_finite(self) -> bool {
        self.hi.is_finite()
    }

    /// True for NaN.
    pub fn is_nan(self) -> bool {
        self.hi.is_nan()
    }

    /// Without its sign.
    pub fn abs(self) -> DoubleDouble {
        if self.hi.is_sign_negative() { -self } else { self }
    }

    /// −1, 0 or 1; NaN of NaN.
    pub fn sign(self) -> DoubleDouble {
        if self.hi == 0.0 { DoubleDouble::ZERO } else { self.hi.signum().into() }
    }

    /// 0 below 0, 1 from 0 on; NaN of NaN.
    pub fn step(self) -> DoubleDouble {
        if self.is_nan() { self } else { f64::from(u8::from(self.hi >= 0.0)).into() }
    }

    /// The smaller of two; NaN where one of them is.
    pub fn min(self, other: DoubleDouble) -> DoubleDouble {
        if other.is_nan() || other < self { other } else { self }
    }

    /// The larger of two; NaN where one of them is.
    pub fn max(self, other: DoubleDouble) -> DoubleDouble {
        if other.is_nan() || other > self { other } else { self }
    }

    /// √x; NaN below 0.
    pub fn sqrt(self) -> DoubleDouble {
        let root = self.hi.sqrt();
        if root == 0.0 || !root.is_finite() {
            return root.into();
        }
        // One step of Newton's method doubles the digits.
        let rest = self - DoubleDouble::product(root, root);
        normal(root, rest.hi / (2.0 * root))
    }

    /// x 2ⁿ for n within ±2200.
    pub(super) fn scaled(self, n: i32) -> DoubleDouble {
        // Three factors, since one of 2ⁿ would leave the range of exponents before the product does.
        let factor = |n: i32| f64::from_bits(((1023 + i64::from(n)) as u64) << 52);
        let third = n / 3;
        [third, third, n - 2 * third].into_iter().fold(self, |x, n| {
            let hi = x.hi * factor(n);
            if hi.is_finite() { normal(hi, x.lo * factor(n)) } else { hi.into() }
        })
    }

    /// The two halves as bits, by which constants are told apart.
    pub fn bits(self) -> [u64; 2] {
        [self.hi.to_bits(), self.lo.to_bits()]
    }
}

/// hi + lo for |hi| ≥ |lo|, or hi where that is no finite number.
#[inline]
pub(super) fn normal(hi: f64, lo: f64) -> DoubleDouble {
    let sum = hi + lo;
    if !sum.is_finite() {
        return DoubleDouble { hi, lo: 0.0 };
    }
    DoubleDouble { hi: sum, lo: lo - (sum - hi) }
}

impl From<f64> for DoubleDouble {
    fn from(x: f64) -> DoubleDouble {
        DoubleDouble { hi: x, lo: 0.0 }
    }
}

impl From<Rational> for DoubleDouble {
    /// The nearest.
    fn from(value: Rational) -> DoubleDouble {
        value.to_double_double()
    }
}

impl PartialEq for DoubleDouble {
    fn eq(&self, other: &DoubleDouble) -> bool {
        self.hi == other.hi && self.lo == other.lo
    }
}

impl PartialOrd for DoubleDouble {
    fn partial_cmp(&self, other: &DoubleDouble) -> Option<Ordering> {
        match self.hi.partial_cmp(&other.hi)? {
            Ordering::Equal => self.lo.partial_cmp(&other.lo),
            order => Some(order),
        }
    }
}

impl Neg for DoubleDouble {
    type Output = DoubleDouble;
    fn neg(self) -> DoubleDouble {
        DoubleDouble { hi: -self.hi, lo: -self.lo }
    }
}

impl Add for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn add(self, other: DoubleDouble) -> DoubleDouble {
        let high = DoubleDouble::sum(self.hi, other.hi);
        let low = DoubleDouble::sum(self.lo, other.lo);
        let high = normal(high.hi, high.lo + low.hi);
        let sum = normal(high.hi, high.lo + low.lo);
        // The sign of a zero is that of `f64`.
        if sum.hi == 0.0 { (self.hi + other.hi).into() } else { sum }
    }
}

impl Sub for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn sub(self, other: DoubleDouble) -> DoubleDouble {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn mul(self, other: DoubleDouble) -> DoubleDouble {
        let high = self.hi * other.hi;
        if high == 0.0 || !high.is_finite() {
            return high.into();
        }
        let error = self.hi.mul_add(other.hi, -high);
        normal(high, error + (self.hi * other.lo + self.lo * other.hi))
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn mul(self, other: f64) -> DoubleDouble {
        let high = self.hi * other;
        if high == 0.0 || !high.is_finite() {
            return high.into();
        }
        normal(high, self.hi.mul_add(other, -high) + self.lo * other)
    }
}

impl Add<f64> for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn add(self, other: f64) -> DoubleDouble {
        let high = DoubleDouble::sum(self.hi, other);
        let sum = normal(high.hi, high.lo + self.lo);
        if sum.hi == 0.0 { (self.hi + other).into() } else { sum }
    }
}

impl Div for DoubleDouble {
    type Output = DoubleDouble;
    #[inline]
    fn div(self, other: DoubleDouble) -> DoubleDouble {
        let first = self.hi / other.hi;
        if first == 0.0 || !first.is_finite() || !other.hi.is_finite() {
            return first.into();
        }
        // Long division in digits of base 2⁵³.
        let rest = self - other * first;
        let second = rest.hi / other.hi;
        if !second.is_finite() {
            return first.into();
        }
        let rest = rest - other * second;
        normal(first, second) + rest.hi / other.hi
    }
}

impl AddAssign for DoubleDouble {
    fn add_assign(&mut self, other: DoubleDouble) {
        *self = *self + other;
    }
}
