//! How large an error may be.

/// The tolerance as a norm: error component i counts in units of ε (sᵢ + max(|yᵢ| before, after)).
///
/// sᵢ, the component's scale, is the larger of its start and 1.
#[derive(Clone, Debug)]
pub(crate) struct Tolerance {
    /// ε.
    pub relative: f64,
    scale: Vec<f64>,
}

impl Tolerance {
    /// Scales from the state at the start.
    pub fn new(relative: f64, start: &[f64]) -> Self {
        Tolerance { relative, scale: start.iter().map(|y| y.abs().max(1.0)).collect() }
    }

    /// The error of component i that counts as 1, over a step from `start` to `end`.
    #[inline(always)]
    pub fn unit(&self, i: usize, start: f64, end: f64) -> f64 {
        self.relative * (self.scale[i] + start.abs().max(end.abs()))
    }

    /// The norm of `x` at the state `y`, without the factor ε⁻¹ under the mean.
    pub fn norm(&self, x: &[f64], y: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, scale) in self.scale.iter().enumerate() {
            sum += (x[i] / (self.relative * (scale + y[i].abs()))).powi(2);
        }
        if self.scale.is_empty() { 0.0 } else { (sum / self.scale.len() as f64).sqrt() }
    }
}
