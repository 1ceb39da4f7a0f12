//! Exact rational numbers of 128 bits.

use super::DoubleDouble;

/// n/d in lowest terms, d > 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rational {
    numerator: i128,
    denominator: i128,
}

impl Rational {
    /// 0.
    pub const ZERO: Rational = Rational { numerator: 0, denominator: 1 };
    /// 1.
    pub const ONE: Rational = Rational { numerator: 1, denominator: 1 };

    /// ½.
    pub const HALF: Rational = Rational { numerator: 1, denominator: 2 };

    /// n/d in lowest terms; `None` for d = 0 or beyond 128 bits.
    pub fn new(numerator: i128, denominator: i128) -> Option<Rational> {
        if denominator == 0 {
            return None;
        }
        let divisor = gcd(numerator.unsigned_abs(), denominator.unsigned_abs());
        let divisor = i128::try_from(divisor).ok()?;
        let (n, d) = (numerator.checked_div(divisor)?, denominator.checked_div(divisor)?);
        if d < 0 {
            return Some(Rational { numerator: n.checked_neg()?, denominator: d.checked_neg()? });
        }
        Some(Rational { numerator: n, denominator: d })
    }

    /// An integer.
    pub fn integer(n: i64) -> Rational {
        Rational { numerator: i128::from(n), denominator: 1 }
    }

    /// Reads decimal text exactly: `0.1` is 1/10, `2.5e-3` is 1/400.  `None` beyond 128 bits or for other text.
    pub fn from_decimal(text: &str) -> Option<Rational> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((m, e)) => (m, e.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let fraction = fraction.trim_end_matches('0');
        let mut numerator: i128 = 0;
        let mut digits = 0;
        for c in whole.chars().chain(fraction.chars()) {
            let digit = c.to_digit(10)?;
            numerator = numerator.checked_mul(10)?.checked_add(i128::from(digit))?;
            digits += 1;
        }
        if digits == 0 && !mantissa.contains('0') {
            return None;
        }
        let power = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        let scale = 10_i128.checked_pow(power.unsigned_abs())?;
        if power >= 0 { Rational::new(numerator.checked_mul(scale)?, 1) } else { Rational::new(numerator, scale) }
    }

    /// The numerator.
    pub fn numerator(self) -> i128 {
        self.numerator
    }

    /// The denominator, > 0.
    pub fn denominator(self) -> i128 {
        self.denominator
    }

    /// The nearest `f64`.
    pub fn to_f64(self) -> f64 {
        let short = |n: i128| n.unsigned_abs() <= 1 << 53;
        if short(self.numerator) && short(self.denominator) {
            return self.numerator as f64 / self.denominator as f64;
        }
        self.to_double_double().to_f64()
    }

    /// The nearest double-double, but for 2⁻¹²⁵ of it.
    pub fn to_double_double(self) -> DoubleDouble {
        let d = self.denominator.unsigned_abs();
        let (mut quotient, mut rest) = (self.numerator.unsigned_abs() / d, self.numerator.unsigned_abs() % d);
        // Long division, bit by bit, until the quotient has 127 bits.
        let mut bits = 0;
        while quotient >> 126 == 0 && rest != 0 {
            rest <<= 1;
            let bit = u128::from(rest >= d);
            rest -= bit * d;
            quotient = quotient << 1 | bit;
            bits -= 1;
        }
        // What remains decides between two neighbours only.
        let quotient = quotient | u128::from(rest != 0);
        let hi = quotient as f64;
        let nearest = hi as u128;
        let lo = if nearest > quotient { -((nearest - quotient) as f64) } else { (quotient - nearest) as f64 };
        let value = DoubleDouble::sum(hi, lo).scaled(bits);
        if self.numerator < 0 { -value } else { value }
    }

    /// The value, if it is an integer that fits.
    pub fn to_integer(self) -> Option<i64> {
        if self.denominator == 1 { i64::try_from(self.numerator).ok() } else { None }
    }

    /// Sum, unless it needs more than 128 bits.
    pub fn checked_add(self, other: Rational) -> Option<Rational> {
        let n = self
            .numerator
            .checked_mul(other.denominator)?
            .checked_add(other.numerator.checked_mul(self.denominator)?)?;
        Rational::new(n, self.denominator.checked_mul(other.denominator)?)
    }

    /// Product, unless it needs more than 128 bits.
    pub fn checked_mul(self, other: Rational) -> Option<Rational> {
        Rational::new(self.numerator.checked_mul(other.numerator)?, self.denominator.checked_mul(other.denominator)?)
    }

    /// 1/x, unless x is 0.
    pub fn recip(self) -> Option<Rational> {
        Rational::new(self.denominator, self.numerator)
    }

    /// −x.
    pub fn negated(self) -> Option<Rational> {
        Some(Rational { numerator: self.numerator.checked_neg()?, denominator: self.denominator })
    }

    /// √x when it is rational.
    pub fn sqrt(self) -> Option<Rational> {
        let root = |n: i128| {
            let guess = (n as f64).sqrt() as i128;
            (guess - 1..=guess + 1).find(|r| r.checked_mul(*r) == Some(n))
        };
        if self.numerator < 0 {
            return None;
        }
        Rational::new(root(self.numerator)?, root(self.denominator)?)
    }
}

fn gcd(mut a: u128, mut b: u128) -> u128 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a.max(1)
}

#[cfg(test)]
mod tests {
    use super::Rational;

    #[test]
    fn decimal_text_is_read_exactly() {
        assert_eq!(Rational::from_decimal("0.1"), Rational::new(1, 10));
        assert_eq!(Rational::from_decimal("2.5e-3"), Rational::new(1, 400));
        assert_eq!(Rational::from_decimal("12e2"), Rational::new(1200, 1));
        assert_eq!(Rational::from_decimal("1e400"), None);
        assert_eq!(Rational::from_decimal("."), None);
    }

    #[test]
    fn the_nearest_double_double_is_exact_to_its_last_digit() {
        let near = |n, d| {
            let value = Rational::new(n, d).unwrap().to_double_double();
            (value.to_f64(), value.rest())
        };
        assert_eq!(near(1, 3), (1.0 / 3.0, 1.850371707708594e-17));
        assert_eq!(near(-1, 10), (-0.1, 5.551115123125783e-18));
        assert_eq!(near((1 << 60) + 1, 1), ((1_u64 << 60) as f64, 1.0));
        assert_eq!(near(i128::MAX, 1), (2_f64.powi(127), -1.0));
        assert_eq!(near(7, 4), (1.75, 0.0));
        // 10^30/(10^30 + 1) = 1 − 10⁻³⁰ + …
        let (hi, lo) = near(10_i128.pow(30), 10_i128.pow(30) + 1);
        assert!(hi == 1.0 && (lo + 1e-30).abs() < 2_f64.powi(-125), "{lo:e}");
        // Parts of 127 bits each.
        assert_eq!(near(i128::MAX, i128::MAX - 1).0, 1.0);
        assert_eq!(near(1, i128::MAX).0, 2_f64.powi(-127));
        // The quotient of the rounded parts would be the next float.
        assert_eq!(Rational::new(9_007_199_254_740_993, 9_007_199_254_740_992).unwrap().to_f64(), 1.0);
    }

    #[test]
    fn overflow_is_none_not_a_panic() {
        let huge = Rational::new(i128::MAX, 3).unwrap();
        assert_eq!(huge.checked_mul(huge), None);
        assert_eq!(Rational::new(i128::MIN, -1), None);
        assert_eq!(Rational::new(9, 4).unwrap().sqrt(), Rational::new(3, 2));
    }
}
