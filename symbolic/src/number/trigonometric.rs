//! Sine, cosine and tangent of double-doubles.

use super::double_double::DoubleDouble;
use super::exponential::INVERSE_FACTORIALS;
use super::reduction::reduced;

impl DoubleDouble {
    /// Sine.
    pub fn sin(self) -> DoubleDouble {
        if !self.is_finite() || self.to_f64() == 0.0 {
            return self.to_f64().sin().into();
        }
        let (quadrant, r) = reduced(self);
        turned(quadrant, r)
    }

    /// Cosine.
    pub fn cos(self) -> DoubleDouble {
        if !self.is_finite() {
            return f64::NAN.into();
        }
        let (quadrant, r) = reduced(self);
        turned((quadrant + 1) % 4, r)
    }

    /// Tangent.
    pub fn tan(self) -> DoubleDouble {
        if !self.is_finite() || self.to_f64() == 0.0 {
            return self.to_f64().tan().into();
        }
        let (quadrant, r) = reduced(self);
        let (sine, cosine) = (sine(r), cosine(r));
        if quadrant.is_multiple_of(2) { sine / cosine } else { -cosine / sine }
    }

    /// Sine and cosine for |x| ≤ π/4.
    pub(super) fn sin_cos_small(self) -> [DoubleDouble; 2] {
        [sine(self), cosine(self)]
    }
}

/// sin(r + quadrant π/2) for |r| ≤ π/4.
fn turned(quadrant: u8, r: DoubleDouble) -> DoubleDouble {
    let value = if quadrant.is_multiple_of(2) { sine(r) } else { cosine(r) };
    if quadrant >= 2 { -value } else { value }
}

/// The series of the sine.
fn sine(r: DoubleDouble) -> DoubleDouble {
    if r.to_f64().abs() < 1e-140 {
        return r;
    }
    let square = r * r;
    r + r * (square * series(square, 3))
}

/// The series of the cosine.
fn cosine(r: DoubleDouble) -> DoubleDouble {
    let square = r * r;
    square * series(square, 2) + 1.0
}

/// −1/n! + z/(n + 2)! − z²/(n + 4)! + … for z < 0.62.
fn series(z: DoubleDouble, n: usize) -> DoubleDouble {
    /// Terms in double-double; the rest is below 2⁻⁵³ of the sum and has digits enough in `f64`.
    const LEADING: usize = 8;
    const ALL: usize = 14;
    let inverse = &*INVERSE_FACTORIALS;
    let small = (LEADING..ALL).rev().fold(0.0, |sum, k| inverse[n + 2 * k].to_f64() - sum * z.to_f64());
    let mut sum = DoubleDouble::from(small);
    for k in (0..LEADING).rev() {
        sum = inverse[n + 2 * k] - sum * z;
    }
    -sum
}
