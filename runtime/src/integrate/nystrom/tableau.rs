//! The coefficients of a Runge–Kutta–Nyström method.

use nalgebra::Complex;

use crate::integrate::Control;
use crate::integrate::explicit::Term;

/// Accelerations of a step: those of the stages, of the end, and of what only dense output needs.
pub(super) const STAGES: usize = END + 4;
/// The place of the acceleration at the end of the step.
pub(super) const END: usize = 8;

/// A method of eight stages and the end, gᵢ = a(t + cᵢh, q + cᵢh q' + h² Σ aᵢⱼgⱼ), q₁ = q + h q' + h² Σ bᵢgᵢ,
/// q'₁ = q' + h Σ b'ᵢgᵢ.
#[derive(Debug)]
pub(crate) struct Tableau {
    /// Order of the solution.
    pub order: u32,
    /// (cᵢ, the non-zero aᵢⱼ) of each stage; the first is (0, nothing).
    pub rows: &'static [(f64, &'static [Term]); END],
    /// The non-zero bᵢ.
    pub places: &'static [Term],
    /// The non-zero b'ᵢ.
    pub speeds: &'static [Term],
    /// Weights of places and of speeds less those of the embedded method, which may take the end.
    pub errors: [&'static [Term]; 2],
    /// This part of the difference to the embedded method counts as the error of a step.
    pub counts: f64,
    /// Nodes and rows of places between the ends, whose accelerations dense output takes; they may take the end.
    pub dense_rows: &'static [(f64, &'static [Term]); STAGES - END - 1],
    /// Rows a'ᵢⱼ that give the stages' speeds q' + h Σ a'ᵢⱼgⱼ once all accelerations are known, where b'ᵢ is not 0.
    ///
    /// With Σᵢ b'ᵢ a'ᵢⱼ = bⱼ and Σᵢ b'ᵢ cᵢ a'ᵢⱼ = b'ⱼ (1 − cⱼ²)/2 a power that is linear in the speeds is integrated with
    /// the order of the method though the speeds themselves have a lower one.
    pub speed_rows: &'static [&'static [Term]; END],
    /// Step-size control.
    pub control: Control,
}

impl Tableau {
    /// The larger size of the eigenvalues of a step for q'' = λ² q, z = hλ: what it multiplies a mode by.
    pub fn amplification(&self, z: Complex<f64>) -> f64 {
        // The columns of the matrix that takes (q, h q') through the step.
        let column = |q: f64, speed: f64| {
            let mut stages = [Complex::new(0.0, 0.0); END];
            let sum = |terms: &[Term], stages: &[Complex<f64>; END]| {
                terms.iter().map(|term| stages[term.stage] * term.value).sum::<Complex<f64>>()
            };
            for (i, (node, row)) in self.rows.iter().enumerate() {
                stages[i] = z * z * (sum(row, &stages) + (q + node * speed));
            }
            [sum(self.places, &stages) + (q + speed), sum(self.speeds, &stages) + speed]
        };
        let [[a, c], [b, d]] = [column(1.0, 0.0), column(0.0, 1.0)];
        let half = 0.5 * (a + d);
        let root = (half * half - (a * d - b * c)).sqrt();
        (half + root).norm().max((half - root).norm())
    }
}
