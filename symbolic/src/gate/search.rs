//! Zeros, extrema and values of order one of a function of one number.

use super::arguments::Argument;
use super::lines::{Line, moved};
use super::motion::Motion;
use super::state::State;
use crate::number::DoubleDouble;

/// Values between which a function that is local through its argument changes: ±1, a half, and, for what keeps away from
/// zero, twice the least.
pub(super) fn local_targets(samples: &[(f64, f64)]) -> Vec<f64> {
    let least = samples.iter().map(|s| s.1).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let same_sign = samples.iter().all(|s| s.1 * least > 0.0);
    let mut targets = vec![1.0, -1.0, 0.5, -0.5];
    if same_sign {
        targets.extend([2.0 * least, 1.1 * least]);
    }
    targets
}

/// Extrema between samples, so that a touch or a narrow band is met.
pub(super) fn extrema(samples: &[(f64, f64)], at: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for w in samples.windows(3) {
        let (low, high) = (w[1].1 < w[0].1 && w[1].1 <= w[2].1, w[1].1 > w[0].1 && w[1].1 >= w[2].1);
        if (low || high) && found.len() < 6 {
            let sign = if low { 1.0 } else { -1.0 };
            let z = golden((w[0].0, w[2].0), &|z| sign * at(z));
            let value = at(z);
            if value.is_finite() && w.iter().all(|s| s.0 != z) {
                found.push((z, value));
            }
        }
    }
    found
}

/// Where a function is least in size.
pub(super) fn least(samples: &[(f64, f64)], at: &dyn Fn(f64) -> f64) -> Option<(f64, f64)> {
    let finite = (0..samples.len()).filter(|k| samples[*k].1.is_finite());
    let k = finite.min_by(|i, j| samples[*i].1.abs().total_cmp(&samples[*j].1.abs()))?;
    let beside = (samples[k.saturating_sub(1)].0, samples[(k + 1).min(samples.len() - 1)].0);
    let z = golden(beside, &|z| at(z).abs());
    let value = at(z);
    let found = value.abs() < samples[k].1.abs();
    Some(if found { (z, value) } else { samples[k] })
}

/// The place of the least value within an interval, by golden sections.
fn golden((mut a, mut b): (f64, f64), f: &dyn Fn(f64) -> f64) -> f64 {
    const SECTION: f64 = 0.618_033_988_749_894_9;
    let (mut c, mut d) = (b - SECTION * (b - a), a + SECTION * (b - a));
    let (mut at_c, mut at_d) = (f(c), f(d));
    for _ in 0..60 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - SECTION * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + SECTION * (b - a);
            at_d = f(d);
        }
    }
    0.5 * (a + b)
}

/// The place where a function changes its sign, to the last bit.
pub(super) fn bisect(f: &dyn Fn(f64) -> f64, (mut a, mut b): (f64, f64)) -> f64 {
    let side = f(a) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            break;
        }
        if (f(middle) > 0.0) == side { a = middle } else { b = middle }
    }
    b
}

/// The zero of an argument to all digits, by secants.
pub(super) fn polished(motion: &Motion, argument: &Argument, base: &State, line: &Line<'_>, z: f64) -> DoubleDouble {
    let at = |z: DoubleDouble| argument.exactly(motion, &moved(motion, base, line, z));
    let mut z0 = DoubleDouble::from(z);
    let mut z1 = DoubleDouble::from(z * (1.0 + 1e-12) + f64::MIN_POSITIVE);
    let (mut f0, mut f1) = (at(z0), at(z1));
    for _ in 0..6 {
        let slope = f1 - f0;
        if slope == DoubleDouble::ZERO || f1 == DoubleDouble::ZERO {
            break;
        }
        let next = z1 - f1 * (z1 - z0) / slope;
        if !next.is_finite() || (next - DoubleDouble::from(z)).abs().to_f64() > 1e-6 * z.abs().max(f64::MIN_POSITIVE) {
            break;
        }
        (z0, f0) = (z1, f1);
        z1 = next;
        f1 = at(z1);
    }
    if f1.abs().to_f64() <= f0.abs().to_f64() { z1 } else { z0 }
}
