//! Decimal text to the nearest double-double.

use super::double_double::DoubleDouble;

impl DoubleDouble {
    /// Reads decimal text such as `0.1` or `2.5e-3` to the nearest double-double: the upper half is the nearest `f64`,
    /// the lower half the `f64` nearest to the rest.  `None` for other text, and beyond the range of `f64`.
    pub fn from_decimal(text: &str) -> Option<DoubleDouble> {
        let plain = text.bytes().all(|c| c.is_ascii_digit() || b".eE+-".contains(&c));
        let hi = text.parse::<f64>().ok().filter(|x| plain && x.is_finite())?;
        if hi == 0.0 {
            return Some(hi.into());
        }
        // A float has finitely many decimals, all of which are printed: the rest is a subtraction on paper.
        let (value, near) = (Decimal::read(text)?, Decimal::read(&format!("{hi:.1074}"))?);
        let lo = value.without(&near)?;
        Some(DoubleDouble::sum(hi, if hi < 0.0 { -lo } else { lo }))
    }
}

/// The decimals of a number without its sign: Σ digit·10^(−k).
struct Decimal {
    digits: Vec<u8>,
    /// The power of ten of the first digit.
    first: i64,
}

impl Decimal {
    fn read(text: &str) -> Option<Decimal> {
        let text = text.trim_start_matches(['+', '-']);
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i64>().ok()?),
            None => (text, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits: Vec<u8> = whole.bytes().chain(fraction.bytes()).map(|c| c.wrapping_sub(b'0')).collect();
        let zeros = digits.iter().take_while(|digit| **digit == 0).count();
        let first = exponent.checked_add(whole.len() as i64)?.checked_sub(1 + zeros as i64)?;
        Some(Decimal { digits: digits[zeros..].to_vec(), first })
    }

    fn digit(&self, power: i64) -> i8 {
        let place = usize::try_from(self.first - power).ok();
        place.and_then(|place| self.digits.get(place)).map_or(0, |digit| *digit as i8)
    }

    fn last(&self) -> i64 {
        self.first - self.digits.len() as i64
    }

    /// The `f64` nearest to the difference.
    fn without(&self, other: &Decimal) -> Option<f64> {
        let (top, bottom) = (self.first.max(other.first), self.last().min(other.last()));
        let larger = (bottom..=top).rev().map(|power| self.digit(power).cmp(&other.digit(power))).find(|o| o.is_ne());
        let (a, b) = if larger == Some(std::cmp::Ordering::Less) { (other, self) } else { (self, other) };
        let mut borrowed = 0;
        let mut digits: Vec<u8> = Vec::new();
        for power in bottom..=top {
            let difference = a.digit(power) - b.digit(power) - borrowed;
            borrowed = i8::from(difference < 0);
            digits.push(b'0' + difference.rem_euclid(10) as u8);
        }
        digits.reverse();
        let text = format!("{}e{bottom}", String::from_utf8(digits).ok()?);
        let size = text.parse::<f64>().ok()?;
        Some(if larger == Some(std::cmp::Ordering::Less) { -size } else { size })
    }
}

#[cfg(test)]
mod tests {
    use super::DoubleDouble;

    #[test]
    fn decimals_are_read_to_the_nearest_double_double() {
        let pi = "3.14159265358979323846264338327950288419716939937510582097494459230781640628620899";
        assert_eq!(DoubleDouble::from_decimal(pi), Some(DoubleDouble::PI));
        assert_eq!(DoubleDouble::from_decimal(&format!("-{pi}")), Some(-DoubleDouble::PI));
        assert_eq!(DoubleDouble::from_decimal("31415926535897932384626433832795028841971.69e-40"), Some(DoubleDouble::PI));
        let tenth = DoubleDouble::from_decimal("0.1").unwrap();
        assert_eq!((tenth.to_f64(), tenth.rest()), (0.1, -5.551115123125783e-18));
        assert_eq!(DoubleDouble::from_decimal("0.5e1"), Some(5.0.into()));
        assert_eq!(DoubleDouble::from_decimal("0e5"), Some(0.0.into()));
        assert_eq!(DoubleDouble::from_decimal("5e-324").map(DoubleDouble::to_f64), Some(5e-324));
    }

    #[test]
    fn what_is_no_decimal_or_beyond_f64_is_refused() {
        for text in ["", ".", "1e", "1e999", "inf", "NaN", "0x10", "1.2.3", "--1", "e5"] {
            assert_eq!(DoubleDouble::from_decimal(text), None, "{text}");
        }
        assert_eq!(DoubleDouble::from_decimal("1e-99999"), Some(0.0.into()));
    }
}
