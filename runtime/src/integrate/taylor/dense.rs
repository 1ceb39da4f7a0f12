//! A power series between the ends of a step.

use crate::mechanism::SERIES_TERMS;

/// Brings Σ cₖ θᵏ, which adds `change` from θ = 0 to 1, to the nested form of [`crate::integrate::Segment`], `stride` numbers apart: what stands inside
/// the brackets is divided by θ and by 1 − θ in turn.
pub(super) fn nest(mut c: [f64; SERIES_TERMS], change: f64, stride: usize, pieces: &mut [f64]) {
    let mut left = SERIES_TERMS;
    for (piece, out) in pieces.iter_mut().step_by(stride).enumerate() {
        let rest = &mut c[..left];
        if piece % 2 == 0 {
            // At θ = 0; (p − p(0))/θ.
            *out = rest[0];
            rest.copy_within(1.., 0);
        } else {
            // At θ = 1; (p − p(1))/(1 − θ) has the coefficients −Σ cⱼ over j > k.
            *out = if piece == 1 { change } else { rest.iter().sum() };
            let mut sum = 0.0;
            for k in (0..left).rev() {
                let own = rest[k];
                rest[k] = -sum;
                sum += own;
            }
        }
        left -= 1;
        if left == 0 {
            break;
        }
    }
}
