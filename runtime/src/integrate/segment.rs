//! The motion between accepted steps.

/// Dense output of one accepted step, from t to t + h.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<'a> {
    /// Where it starts, s.
    pub t: f64,
    /// Its length, s.
    pub h: f64,
    /// Numbers per piece.
    pub width: usize,
    /// r₀, r₁, … one after the other.
    pub pieces: &'a [f64],
}

impl Segment<'_> {
    /// y(t + θh) = r₀ + θ(r₁ + (1−θ)(r₂ + θ(r₃ + (1−θ)(r₄ + …)))) into as many numbers as `out` has.
    ///
    /// Every method's dense output is brought to this form (Hairer, Nørsett, Wanner I, section II.6).
    pub fn evaluate(&self, theta: f64, out: &mut [f64]) {
        let count = self.pieces.len() / self.width;
        out.fill(0.0);
        for index in (0..count).rev() {
            let factor = match index {
                0 => 1.0,
                odd if odd % 2 == 1 => theta,
                _ => 1.0 - theta,
            };
            // What stands inside the bracket of piece `index` is multiplied by the next factor.
            for (out, piece) in out.iter_mut().zip(&self.pieces[index * self.width..]) {
                *out = (*out + piece) * factor;
            }
        }
    }

    /// As [`Segment::evaluate`], with dy/dθ into `slope`.
    pub fn evaluate_with_slope(&self, theta: f64, out: &mut [f64], slope: &mut [f64]) {
        let count = self.pieces.len() / self.width;
        out.fill(0.0);
        slope.fill(0.0);
        for index in (0..count).rev() {
            let (factor, rate) = match index {
                0 => (1.0, 0.0),
                odd if odd % 2 == 1 => (theta, 1.0),
                _ => (1.0 - theta, -1.0),
            };
            let pieces = &self.pieces[index * self.width..];
            for ((out, slope), piece) in out.iter_mut().zip(slope.iter_mut()).zip(pieces) {
                let inside = *out + piece;
                *slope = *slope * factor + inside * rate;
                *out = inside * factor;
            }
        }
    }
}
