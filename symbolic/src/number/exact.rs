//! Constants: exact where 128 bits suffice, else double-doubles.

use super::{DoubleDouble, Rational};

/// A constant: exact where 128 bits suffice.
#[derive(Clone, Copy, Debug)]
pub enum Number {
    /// An exact rational.
    Exact(Rational),
    /// About 32 digits, where the exact value needs more than 128 bits or is irrational.
    Float(DoubleDouble),
}

/// Parts of a double-double below this are rounding of a few operations, its last six bits.
const ROUNDING: f64 = 1.0 / (1_u128 << 100) as f64;

impl Number {
    /// 0.
    pub const ZERO: Number = Number::Exact(Rational::ZERO);
    /// 1.
    pub const ONE: Number = Number::Exact(Rational::ONE);

    /// The nearest `f64`.
    pub fn to_f64(self) -> f64 {
        match self {
            Number::Exact(r) => r.to_f64(),
            Number::Float(x) => x.to_f64(),
        }
    }

    /// The nearest double-double.
    pub fn to_double_double(self) -> DoubleDouble {
        match self {
            Number::Exact(r) => r.to_double_double(),
            Number::Float(x) => x,
        }
    }

    /// True unless it is infinite or NaN.
    pub fn is_finite(self) -> bool {
        matches!(self, Number::Exact(_)) || self.to_double_double().is_finite()
    }

    /// x + y; 0 where they cancel but for their rounding, as √3·√3 − 3 does.
    pub fn plus(self, other: Number) -> Number {
        let cancel = |sum: DoubleDouble, x: DoubleDouble| sum.to_f64().abs() <= ROUNDING * x.to_f64().abs();
        self.joined(other, Rational::checked_add, |x, y| {
            let sum = x + y;
            if cancel(sum, x) && cancel(sum, y) { DoubleDouble::ZERO } else { sum }
        })
    }

    /// x y.
    pub fn times(self, other: Number) -> Number {
        self.joined(other, Rational::checked_mul, |x, y| x * y)
    }

    /// −x.
    pub fn negated(self) -> Number {
        self.mapped(Rational::negated, |x| -x)
    }

    /// 1/x; infinite for 0.
    pub fn recip(self) -> Number {
        self.mapped(Rational::recip, |x| DoubleDouble::ONE / x)
    }

    /// |x|.
    pub fn abs(self) -> Number {
        if self.to_f64() < 0.0 { self.negated() } else { self }
    }

    /// √x, exact where it is rational.
    pub fn sqrt(self) -> Number {
        self.mapped(Rational::sqrt, DoubleDouble::sqrt)
    }

    /// Equal bits for equal numbers, different ones for different numbers.
    pub fn bits(self) -> (u8, i128, i128) {
        match self {
            Number::Exact(r) => (0, r.numerator(), r.denominator()),
            Number::Float(x) => {
                let [hi, lo] = x.bits();
                (1, i128::from(hi), i128::from(lo))
            }
        }
    }

    fn joined(
        self,
        other: Number,
        exact: impl Fn(Rational, Rational) -> Option<Rational>,
        float: impl Fn(DoubleDouble, DoubleDouble) -> DoubleDouble,
    ) -> Number {
        if let (Number::Exact(a), Number::Exact(b)) = (self, other)
            && let Some(value) = exact(a, b)
        {
            return Number::Exact(value);
        }
        float(self.to_double_double(), other.to_double_double()).into()
    }

    fn mapped(
        self,
        exact: impl Fn(Rational) -> Option<Rational>,
        float: impl Fn(DoubleDouble) -> DoubleDouble,
    ) -> Number {
        if let Number::Exact(a) = self
            && let Some(value) = exact(a)
        {
            return Number::Exact(value);
        }
        float(self.to_double_double()).into()
    }
}

impl From<f64> for Number {
    /// Exactly; integers of moderate size as rationals.
    fn from(value: f64) -> Number {
        DoubleDouble::from(value).into()
    }
}

impl From<DoubleDouble> for Number {
    /// Integers of moderate size as rationals, but for what is rounding: √3·√3 is 3, and 1 + 1e-300 is 1.
    fn from(value: DoubleDouble) -> Number {
        let hi = value.to_f64();
        let whole = value.rest().abs() <= hi.abs() * ROUNDING;
        if whole && hi.fract() == 0.0 && hi.abs() < 1e15 {
            return Number::Exact(Rational::integer(hi as i64));
        }
        Number::Float(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn integer(x: i64) -> Number {
        Number::Exact(Rational::integer(x))
    }

    #[test]
    fn what_cancels_but_for_rounding_is_nothing() {
        let root = integer(3).sqrt();
        assert_eq!(root.times(root).bits(), integer(3).bits());
        let third = root.recip().times(root.recip());
        assert_eq!(third.plus(third).plus(third).bits(), integer(1).bits());
        assert_eq!(third.plus(third).plus(integer(2).times(third).negated()).bits(), Number::from(0.0).bits());
        // What is more than rounding stays, and what is small by itself.
        assert!(
            (root.times(root).plus(Number::from(1e-25)).to_double_double() - DoubleDouble::from(3.0)).to_f64()
                > 0.9e-25
        );
        assert!(root.times(Number::from(1e-200)).plus(root.times(Number::from(1e-210))).to_f64() > 1.7e-200);
    }
}
