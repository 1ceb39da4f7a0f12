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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_found_to_rounding() {
        let mut count = 0;
        let found = root(
            |x| {
                count += 1;
                x * x - 2.0
            },
            (0.0, -2.0),
            (2.0, 2.0),
        );
        assert!((found - 2.0_f64.sqrt()).abs() <= 4e-16 && count < 15, "{found} after {count}");
        let steep = root(|x| (x - 0.3).powi(9), (0.0, -0.3_f64.powi(9)), (1.0, 0.7_f64.powi(9)));
        assert!((steep - 0.3).abs() < 1e-10, "{steep}");
        let jump = root(|x| if x < 0.7 { -1.0 } else { 1.0 }, (0.0, -1.0), (1.0, 1.0));
        assert!((jump - 0.7).abs() < 1e-15, "{jump}");
    }

    #[test]
    fn a_narrow_dip_is_found_and_a_shallow_one_refused() {
        let f = |d: f64| move |x: f64| (x - 0.37).powi(2) - d;
        let at = |f: &dyn Fn(f64) -> f64, x: f64| (x, f(x));
        for d in [1e-3, 1e-6, 1e-9] {
            let f = f(d);
            let found = dip(f, at(&f, 0.0), at(&f, 0.25), at(&f, 1.0));
            assert!(found.is_some_and(|(x, value)| value <= 0.0 && f(x) == value), "{d}");
        }
        let f = f(-1e-3);
        assert_eq!(dip(f, at(&f, 0.0), at(&f, 0.25), at(&f, 1.0)), None);
    }
}
