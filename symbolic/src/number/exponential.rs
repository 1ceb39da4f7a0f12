//! Exponential, logarithm, powers and hyperbolic functions of double-doubles.

use std::sync::LazyLock;

use super::double_double::DoubleDouble;

/// ln 2 in three parts that do not overlap.
const LN_2: [f64; 3] = [std::f64::consts::LN_2, 2.3190468138462996e-17, 5.707708438416212e-34];

/// 1/n! for n = 0, 1, …, 33.
pub(super) static INVERSE_FACTORIALS: LazyLock<[DoubleDouble; 34]> = LazyLock::new(|| {
    let mut table = [DoubleDouble::ONE; 34];
    for n in 1..table.len() {
        table[n] = table[n - 1] / DoubleDouble::from(n as f64);
    }
    table
});

impl DoubleDouble {
    /// eˣ.
    pub fn exp(self) -> DoubleDouble {
        self.exp_scaled(0)
    }

    /// eˣ − 1, to its own digits near 0.
    pub fn exp_m1(self) -> DoubleDouble {
        if self.to_f64().abs() < 0.34 { exp_m1_near_zero(self) } else { self.exp() + -1.0 }
    }

    /// eˣ 2ⁿ, which may be finite where eˣ is not.
    fn exp_scaled(self, n: i32) -> DoubleDouble {
        let x = self.to_f64();
        if x.is_nan() || x == 0.0 {
            return DoubleDouble::from(x.exp()).scaled(n);
        }
        if x.abs() > 800.0 {
            return if x > 0.0 { f64::INFINITY } else { 0.0 }.into();
        }
        // x = k ln 2 + r
        let k = (x / LN_2[0]).round();
        let mut r = self;
        for part in LN_2 {
            let product = DoubleDouble::product(-k, part);
            r = r + product.to_f64() + product.rest();
        }
        (exp_m1_near_zero(r) + 1.0).scaled(k as i32 + n)
    }

    /// ln x; −∞ at 0, NaN below.
    pub fn ln(self) -> DoubleDouble {
        let x = self.to_f64();
        if !(x > 0.0 && x.is_finite()) {
            return x.ln().into();
        }
        if (x - 1.0).abs() < 0.03 {
            return ln_near_one(self);
        }
        // x = m 2ⁿ with m near 1, so that nothing here leaves the range of exponents.
        let n = x.log2().round() as i32;
        let m = self.scaled(-n);
        let guess = m.to_f64().ln();
        // m = e^guess (1 + d)
        let d = m * DoubleDouble::from(-guess).exp() + -1.0;
        let correction = d - d * d * 0.5;
        let mut sum = correction + guess;
        for part in LN_2 {
            let product = DoubleDouble::product(f64::from(n), part);
            sum += product;
        }
        sum
    }

    /// xʸ = e^(y ln x); of a negative x for integers y only, else NaN.
    pub fn pow(self, exponent: DoubleDouble) -> DoubleDouble {
        let (x, y) = (self.to_f64(), exponent.to_f64());
        let ordinary = x != 0.0 && x.is_finite() && y.is_finite() && y != 0.0;
        if !ordinary {
            return x.powf(y).into();
        }
        let power = (exponent * self.abs().ln()).exp();
        if x > 0.0 {
            return power;
        }
        let rest = exponent.rest();
        if y.fract() != 0.0 || rest.fract() != 0.0 {
            return f64::NAN.into();
        }
        if (y % 2.0 + rest % 2.0) % 2.0 == 0.0 { power } else { -power }
    }

    /// Hyperbolic sine.
    pub fn sinh(self) -> DoubleDouble {
        let size = self.abs();
        let value = if size.to_f64() < 0.34 {
            let s = size.exp_m1();
            (s + s / (s + 1.0)) * 0.5
        } else {
            size.exp_scaled(-1) - (-size).exp_scaled(-1)
        };
        if self.to_f64().is_sign_negative() { -value } else { value }
    }

    /// Hyperbolic cosine.
    pub fn cosh(self) -> DoubleDouble {
        let size = self.abs();
        size.exp_scaled(-1) + (-size).exp_scaled(-1)
    }

    /// Hyperbolic tangent.
    pub fn tanh(self) -> DoubleDouble {
        let size = self.abs();
        let value = if size.to_f64() > 40.0 {
            DoubleDouble::ONE
        } else {
            let s = (size * 2.0).exp_m1();
            s / (s + 2.0)
        };
        if self.to_f64().is_sign_negative() { -value } else { value }
    }
}

/// eʳ − 1 for |r| < 0.35: the series at r/32, then five times e²ˢ − 1 = (eˢ − 1)(2 + (eˢ − 1)).
fn exp_m1_near_zero(r: DoubleDouble) -> DoubleDouble {
    const HALVINGS: i32 = 5;
    if r.to_f64().abs() < 1e-200 {
        return r;
    }
    let inverse = &*INVERSE_FACTORIALS;
    let s = r * (1.0 / f64::from(1 << HALVINGS));
    // Terms that are 2⁻⁵³ of the sum want no more digits than an `f64` has.
    let small = (7..=13).rev().fold(0.0, |sum, n| sum * s.to_f64() + inverse[n].to_f64());
    let mut sum = DoubleDouble::from(small);
    for n in (1..=6).rev() {
        sum = sum * s + inverse[n];
    }
    let mut value = sum * s;
    for _ in 0..HALVINGS {
        value = value * (value + 2.0);
    }
    value
}

/// ln x = 2 artanh z, z = (x − 1)/(x + 1), by its series in z² < 3e-4.
fn ln_near_one(x: DoubleDouble) -> DoubleDouble {
    let z = (x + -1.0) / (x + 1.0);
    let square = z * z;
    let mut sum = DoubleDouble::ZERO;
    for n in (1..=9).rev() {
        sum = (sum + DoubleDouble::ONE / DoubleDouble::from(f64::from(2 * n + 1))) * square;
    }
    (z + z * sum) * 2.0
}
