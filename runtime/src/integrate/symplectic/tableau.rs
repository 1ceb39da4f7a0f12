//! The coefficients of a splitting method.

use nalgebra::Complex;

/// Kicks and drifts in turn, kicks first and last: q' jumps by bᵢ h q''(t, q), then q moves by aᵢ h q' and t by aᵢ h.
///
/// Palindromes, so that the method is symmetric in time and of even order.
#[derive(Debug)]
pub(crate) struct Splitting {
    /// Order of the solution.
    pub order: u32,
    /// b₀, b₁, …, one more than drifts.
    pub kicks: &'static [f64],
    /// a₁, a₂, …
    pub drifts: &'static [f64],
    /// Whether dense output between the ends of a step is of lower order than the method.
    pub needs_middle: bool,
}

impl Splitting {
    /// The larger size of the eigenvalues of a step for q'' = λ² q, z = hλ: what it multiplies a mode by.
    pub fn amplification(&self, z: Complex<f64>) -> f64 {
        let (one, zero, square) = (Complex::new(1.0, 0.0), Complex::new(0.0, 0.0), z * z);
        // Rows of the matrix that takes (q, h q') through the step.
        let (mut place, mut speed) = ([one, zero], [zero, one]);
        for (i, kick) in self.kicks.iter().enumerate() {
            for k in 0..2 {
                speed[k] += square * *kick * place[k];
                if let Some(drift) = self.drifts.get(i) {
                    place[k] += speed[k] * *drift;
                }
            }
        }
        // The determinant is 1.
        let half = 0.5 * (place[0] + speed[1]);
        let root = (half * half - 1.0).sqrt();
        (half + root).norm().max((half - root).norm())
    }
}

/// Kicks and drifts of steps of Störmer and Verlet with these parts of h, one after the other; kicks that meet are one.
pub(crate) const fn composed<const N: usize, const M: usize>(parts: [f64; N]) -> ([f64; M], [f64; N]) {
    let mut kicks = [0.0; M];
    let mut i = 0;
    while i < N {
        kicks[i] += 0.5 * parts[i];
        kicks[i + 1] += 0.5 * parts[i];
        i += 1;
    }
    (kicks, parts)
}
