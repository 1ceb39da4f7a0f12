//! Zeros and extrema of a function of one variable between two points.

/// A zero of f between a and b, where f has the values fa and fb of opposite signs, to rounding.
///
/// Bisection and inverse quadratic interpolation after Chandrupatla, Adv. Eng. Software 28 (1997) 145.
pub(crate) fn root(mut f: impl FnMut(f64) -> f64, a: (f64, f64), b: (f64, f64)) -> f64 {
    let (mut a, mut fa) = a;
    let (mut b, mut fb) = b;
    let (mut c, mut fc): (f64, f64);
    let mut fraction = 0.5;
    for _ in 0..200 {
        let x = a + fraction * (b - a);
        let fx = f(x);
        if fx.is_nan() {
            break;
        }
        (c, fc) = (a, fa);
        if (fx > 0.0) == (fa > 0.0) {
            (a, fa) = (x, fx);
        } else {
            (c, fc, b, fb) = (b, fb, a, fa);
            (a, fa) = (x, fx);
        }
        let (best, least) = if fa.abs() < fb.abs() { (a, fa) } else { (b, fb) };
        let resolution = 2.0 * f64::EPSILON * best.abs() + f64::MIN_POSITIVE;
        let width = (b - a).abs();
        if least == 0.0 || width <= resolution {
            return best;
        }
        let xi = (a - b) / (c - b);
        let phi = (fa - fb) / (fc - fb);
        fraction = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            fa / (fb - fa) * (fc / (fb - fc)) + (c - a) / (b - a) * (fa / (fc - fa)) * (fb / (fc - fb))
        } else {
            0.5
        };
        let least_fraction = 0.5 * resolution / width;
        fraction = fraction.clamp(least_fraction, 1.0 - least_fraction);
    }
    if fa.abs() < fb.abs() { a } else { b }
}

/// Looks between a and b for a point where f, positive there and smallest in between at m, is not positive.
///
/// Golden sections of the bracket; ends as soon as such a point is found, or when the function's variation
/// shows that there is none.
pub(crate) fn dip(mut f: impl FnMut(f64) -> f64, a: (f64, f64), m: (f64, f64), b: (f64, f64)) -> Option<(f64, f64)> {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    let (mut a, mut m, mut b) = (a, m, b);
    for iteration in 0..60 {
        let x = if b.0 - m.0 > m.0 - a.0 { m.0 + GOLDEN * (b.0 - m.0) } else { m.0 - GOLDEN * (m.0 - a.0) };
        let fx = f(x);
        if fx <= 0.0 {
            return Some((x, fx));
        }
        if fx.is_nan() {
            return None;
        }
        match (fx < m.1, x > m.0) {
            (true, true) => (a, m) = (m, (x, fx)),
            (true, false) => (b, m) = (m, (x, fx)),
            (false, true) => b = (x, fx),
            (false, false) => a = (x, fx),
        }
        let variation = a.1.max(b.1) - m.1;
        if iteration >= 4 && variation < 0.5 * m.1 || b.0 - a.0 < 1e-12 {
            return None;
        }
    }
    None
}

