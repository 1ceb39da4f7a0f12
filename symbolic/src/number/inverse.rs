//! Inverse circular functions of double-doubles.

use super::double_double::DoubleDouble;

impl DoubleDouble {
    /// The angle whose sine it is; NaN beyond ±1.
    pub fn asin(self) -> DoubleDouble {
        self.atan2(self.complement())
    }

    /// The angle whose cosine it is; NaN beyond ±1.
    pub fn acos(self) -> DoubleDouble {
        self.complement().atan2(self)
    }

    /// The angle whose tangent it is.
    pub fn atan(self) -> DoubleDouble {
        let size = self.abs();
        let value = if size.to_f64() > 1.0 {
            DoubleDouble::FRAC_PI_2 - atan_up_to_one(DoubleDouble::ONE / size)
        } else {
            atan_up_to_one(size)
        };
        if self.to_f64().is_sign_negative() { -value } else { value }
    }

    /// The angle of the point (x, self).
    pub fn atan2(self, x: DoubleDouble) -> DoubleDouble {
        let (y, z) = (self.to_f64(), x.to_f64());
        if y.is_nan() || z.is_nan() {
            return f64::NAN.into();
        }
        let (rise, run) = (self.abs(), x.abs());
        let angle = if rise.to_f64() == 0.0 || (run.to_f64().is_infinite() && rise.is_finite()) {
            DoubleDouble::ZERO
        } else if run.to_f64() == 0.0 || (rise.to_f64().is_infinite() && run.is_finite()) {
            DoubleDouble::FRAC_PI_2
        } else if !rise.is_finite() {
            DoubleDouble::FRAC_PI_2 * 0.5
        } else if rise <= run {
            atan_up_to_one(rise / run)
        } else {
            DoubleDouble::FRAC_PI_2 - atan_up_to_one(run / rise)
        };
        let angle = if z.is_sign_negative() { DoubleDouble::PI - angle } else { angle };
        if y.is_sign_negative() { -angle } else { angle }
    }

    /// √(1 − x²), to its own digits near x = ±1.
    fn complement(self) -> DoubleDouble {
        ((-self + 1.0) * (self + 1.0)).sqrt()
    }
}

/// For 0 ≤ t ≤ 1: t = tan(g + d) with g from `f64`, so that tan d = (t cos g − sin g)/(cos g + t sin g) is small.
fn atan_up_to_one(t: DoubleDouble) -> DoubleDouble {
    let guess = t.to_f64().atan();
    if t.is_nan() || guess.abs() < 1e-140 {
        return t;
    }
    let [sine, cosine] = DoubleDouble::from(guess).sin_cos_small();
    // d is 2⁻⁵³ of the angle, so that d³/3 is beyond its digits.
    let d = (t * cosine - sine) / (cosine + t * sine);
    d + guess
}
