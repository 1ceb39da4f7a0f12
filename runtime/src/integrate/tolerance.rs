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
    /// Scales from the state at the start; work and padding, beyond `controlled`, are not controlled.
    pub fn new(relative: f64, start: &[f64], controlled: usize) -> Self {
        Tolerance { relative, scale: start[..controlled].iter().map(|y| y.abs().max(1.0)).collect() }
    }

    /// The mean square of `error` in units of the tolerance, over a step from `y` to `y + increment`.
    pub fn mean_square(&self, error: &[f64], y: &[f64], increment: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (i, scale) in self.scale.iter().enumerate() {
            let size = y[i].abs().max((y[i] + increment[i]).abs());
            sum += (error[i] / (self.relative * (scale + size))).powi(2);
        }
        if self.scale.is_empty() { 0.0 } else { sum / self.scale.len() as f64 }
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
