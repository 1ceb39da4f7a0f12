//! Sums over the stages, in pairs of components: two numbers travel together on every processor of 64 bits.

use super::tableau::Term;
use crate::integrate::Block;

/// Σ aⱼkⱼ of one pair of components.
#[inline(always)]
pub(super) fn sum<Y: Block>(terms: &[Term], stages: &[Y], place: usize) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for term in terms {
        let rates = &stages[term.stage].all()[place..place + 2];
        sum[0] += term.value * rates[0];
        sum[1] += term.value * rates[1];
    }
    sum
}

/// out = y + h Σ aⱼkⱼ, the last term last: what waits for the rate just evaluated is one product and one sum.
#[inline(always)]
pub(super) fn argument<Y: Block>(out: &mut Y, y: &Y, h: f64, terms: &[Term], stages: &[Y]) {
    let [earlier @ .., last] = terms else { return };
    let (y, latest, factor) = (y.all(), stages[last.stage].all(), h * last.value);
    for (k, out) in out.all_mut().chunks_exact_mut(2).enumerate() {
        let sum = sum(earlier, stages, 2 * k);
        out[0] = (y[2 * k] + h * sum[0]) + factor * latest[2 * k];
        out[1] = (y[2 * k + 1] + h * sum[1]) + factor * latest[2 * k + 1];
    }
}
