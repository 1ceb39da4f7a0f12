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

impl Number {
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

    /// x + y.
    pub fn plus(self, other: Number) -> Number {
        self.joined(other, Rational::checked_add, |x, y| x + y)
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
    /// Integers of moderate size as rationals, but for 2⁻¹¹⁰, which is rounding: 1 + 1e-300 is 1.
    fn from(value: DoubleDouble) -> Number {
        let hi = value.to_f64();
        let whole = value.rest().abs() <= hi.abs() * 2_f64.powi(-110);
        if whole && hi.fract() == 0.0 && hi.abs() < 1e15 {
            return Number::Exact(Rational::integer(hi as i64));
        }
        Number::Float(value)
    }
}
