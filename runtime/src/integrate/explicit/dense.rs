//! Dense output of an explicit Runge–Kutta method.

use super::sums::sum;
use super::tableau::Tableau;
use crate::integrate::Block;

/// Writes the pieces r₀, r₁, … of the nested form that [`crate::integrate::Segment`] evaluates.
///
/// The cubic Hermite interpolant is r₀ = y₀, r₁ = Δ = y₁ − y₀, r₂ = h k₀ − Δ, r₃ = Δ − h k_end − r₂; what a
/// method knows beyond it (order 4 of DOPRI5, order 7 of DOP853) are h Σ dᵢkᵢ.
pub(super) fn write_dense<Y: Block>(tableau: &Tableau, h: f64, y: &Y, end: &Y, stages: &[Y], pieces: &mut [f64]) {
    let (y, end) = (y.all(), end.all());
    let (first, last) = (stages[0].all(), stages[tableau.end_stage()].all());
    let width = y.len();
    for i in 0..width {
        let change = end[i] - y[i];
        let bend = h * first[i] - change;
        pieces[i] = y[i];
        pieces[width + i] = change;
        pieces[2 * width + i] = bend;
        pieces[3 * width + i] = change - h * last[i] - bend;
    }
    if width == 0 {
        return;
    }
    for (terms, piece) in tableau.dense.iter().zip(pieces[4 * width..].chunks_exact_mut(width)) {
        for (k, out) in piece.chunks_exact_mut(2).enumerate() {
            out.copy_from_slice(&sum(terms, stages, 2 * k).map(|sum| h * sum));
        }
    }
}
