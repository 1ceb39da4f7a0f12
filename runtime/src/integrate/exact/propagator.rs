//! What a step of one length does to a linear system.

use nalgebra::{DMatrix, DVector};

use super::force::{TERMS, legendre_coefficients};

/// y(t + h) = e^{Ah} y(t) + Σ Wₖ cₖ for y' = A y + B Σ cₖ Pₖ(τ), Wₖ = ∫ e^{A(h − s)} B Pₖ(τ(s)) ds with τ from −1 to 1.
pub(super) struct Propagator {
    /// s.
    pub h: f64,
    over: DMatrix<f64>,
    /// W₀, W₁, … side by side.
    weights: DMatrix<f64>,
}

/// Where ‖A‖h is no more than 1 so many terms of e^{Ah} are all of it.
const SERIES: u32 = 18;
/// Steps that double more often are not finite, or no steps.
const MOST_DOUBLINGS: f64 = 1000.0;

impl Propagator {
    /// For steps of h, and forces of so many polynomials that act as `input`, B, says.
    ///
    /// Both integrals and exponential are those of a short step, doubled as often as need be.  So polynomials of whatever degree
    /// are integrated to rounding, however fast the system is beside the step.
    ///
    /// Source: Moler and Van Loan, *Nineteen dubious ways to compute the exponential of a matrix, twenty-five years later*, SIAM
    /// Rev. 45 (2003) 3, method 3; the integrals are doubled as φ-functions are by Skaflestad and Wright, *The scaling and
    /// modified squaring method for matrix functions related to the exponential*, Appl. Numer. Math. 59 (2009) 783.
    pub fn new(field: &DMatrix<f64>, input: &DMatrix<f64>, h: f64, terms: usize) -> Self {
        let norm = field.row_iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
        let doublings = (norm * h).log2().ceil().clamp(0.0, MOST_DOUBLINGS) as i32;
        let short = h / 2.0_f64.powi(doublings);
        let mut over = (field * short).exp();
        let mut moments = series(field, input, short, terms);
        for _ in 0..doublings {
            moments = doubled(&over, &moments);
            over = &over * &over;
        }
        let n = input.ncols();
        let mut weights = DMatrix::zeros(field.nrows(), n * terms);
        for (k, coefficients) in legendre_coefficients().iter().enumerate().take(terms) {
            let mut weight = weights.columns_mut(k * n, n);
            for (coefficient, moment) in coefficients.iter().zip(&moments) {
                weight.zip_apply(moment, |w, x| *w += coefficient * x);
            }
        }
        Propagator { h, over, weights }
    }

    /// The state at the end of a step, from the state at its start and the coefficients of the force.
    pub fn apply(&self, start: &DVector<f64>, coefficients: &[f64], end: &mut DVector<f64>) {
        end.gemv(1.0, &self.over, start, 0.0);
        for (column, c) in self.weights.column_iter().zip(coefficients) {
            end.axpy(*c, &column, 1.0);
        }
    }
}

/// Xₖ = ∫ e^{A(h − s)} B τᵏ ds = h/2 Σⱼ (hA/2)ʲ/j! B ∫ (1 − τ)ʲ τᵏ dτ, for ‖A‖h ≤ 1.
fn series(field: &DMatrix<f64>, input: &DMatrix<f64>, h: f64, terms: usize) -> Vec<DMatrix<f64>> {
    let mut moments = vec![DMatrix::zeros(input.nrows(), input.ncols()); terms];
    if terms == 0 {
        return moments;
    }
    // ∫ (1 − τ)ʲ τᵏ dτ for j = 0, then one more each time: all have the sign of (−1)ᵏ, so that no difference cancels.
    let mut integrals = [0.0; TERMS + SERIES as usize + 1];
    integrals.iter_mut().enumerate().step_by(2).for_each(|(k, integral)| *integral = 2.0 / (k + 1) as f64);
    let mut term = input * (0.5 * h);
    for j in 1..=SERIES {
        for (moment, integral) in moments.iter_mut().zip(integrals) {
            moment.zip_apply(&term, |sum, x| *sum += integral * x);
        }
        for k in 0..integrals.len() - 1 {
            integrals[k] -= integrals[k + 1];
        }
        term = field * term * (0.5 * h / f64::from(j));
    }
    moments
}

/// Xₖ of a step twice as long: τ is (τ − 1)/2 of its first half, which e^{Ah} takes through the second, and (τ + 1)/2 of that.
fn doubled(over: &DMatrix<f64>, moments: &[DMatrix<f64>]) -> Vec<DMatrix<f64>> {
    let mut found = Vec::with_capacity(moments.len());
    for k in 0..moments.len() {
        let scale = 0.5_f64.powi(k as i32);
        let mut halves = [0, 1].map(|_| DMatrix::zeros(moments[0].nrows(), moments[0].ncols()));
        let mut binomial = scale;
        for (i, moment) in moments.iter().enumerate().take(k + 1) {
            let sign = if (k - i) % 2 == 0 { 1.0 } else { -1.0 };
            halves[0].zip_apply(moment, |sum, x| *sum += sign * binomial * x);
            halves[1].zip_apply(moment, |sum, x| *sum += binomial * x);
            binomial *= (k - i) as f64 / (i + 1) as f64;
        }
        let [first, second] = halves;
        found.push(over * first + second);
    }
    found
}
