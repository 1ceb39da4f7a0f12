//! Dense output of an explicit Runge–Kutta method.

use super::step::combine;
use super::tableau::Tableau;

/// Writes the pieces r₀, r₁, … of the nested form that [`crate::integrate::Segment`] evaluates.
///
/// The cubic Hermite interpolant is r₀ = y₀, r₁ = Δ = y₁ − y₀, r₂ = h k₀ − Δ, r₃ = Δ − h k_end − r₂; what a
/// method knows beyond it (order 4 of DOPRI5, order 7 of DOP853) are h Σ dᵢkᵢ.
pub(super) fn write_dense(
    tableau: &Tableau,
    h: f64,
    y: &[f64],
    end: &[f64],
    stages: &[f64],
    width: usize,
    pieces: &mut [f64],
) {
    let first = &stages[..width];
    let last = &stages[tableau.end_stage() * width..][..width];
    for i in 0..width {
        let change = end[i] - y[i];
        let bend = h * first[i] - change;
        pieces[i] = y[i];
        pieces[width + i] = change;
        pieces[2 * width + i] = bend;
        pieces[3 * width + i] = change - h * last[i] - bend;
    }
    for (terms, piece) in tableau.dense.iter().zip(pieces[4 * width..].chunks_exact_mut(width)) {
        combine(piece, h, terms, stages, width);
    }
}
