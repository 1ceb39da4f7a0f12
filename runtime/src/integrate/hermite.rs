//! Polynomials through states with their rates, in the form that [`super::Segment`] evaluates.

use super::Endpoint;

/// Pieces of the dense output of a step whose ends alone are known.
pub(crate) const BY_ENDS: usize = 6;
/// Pieces where a state in its middle is known too.
pub(crate) const BY_MIDDLE: usize = 9;

/// q is the polynomial of degree 5 through (q, q', q'') at both ends of a step of h, q' its derivative.
///
/// Its error is O(h⁶) in q and O(h⁵) in q', and costs no evaluation.
pub(crate) fn write_by_ends(h: f64, ends: [Endpoint<'_>; 2], pieces: &mut [f64]) {
    write(h, ends, differ(ends), pieces, |_, _| ());
}

/// q is the polynomial of degree 8 through (q, q', q'') at both ends of a step of h and in its middle, q' its
/// derivative.
///
/// Its error is O(h⁹) in q and O(h⁸) in q'.
pub(crate) fn write_by_middle(h: f64, ends: [Endpoint<'_>; 2], middle: (&[f64], &[f64]), pieces: &mut [f64]) {
    let n = ends[0].y.len() / 2;
    let (y, rate) = middle;
    write(h, ends, differ(ends), pieces, |i, nested| correct(nested, [y[i], h * y[n + i], h * h * rate[n + i]]));
}

/// q is the polynomial of degree 8 through (q, q', q'') at both ends of a step of h that has these q'' at points (θ, q'')
/// between them, 1/2 − s, 1/2 and 1/2 + s; q' is its derivative.
///
/// Its error is O(h⁹) in q and O(h⁸) in q' where those of q'' are O(h⁷).  `change` is what the step adds to each coordinate: between ends
/// that are rounded it is known to ε|q| only, of which the derivative would be ε|q|/h, the more the shorter the step.
pub(crate) fn write_by_bends(
    h: f64,
    ends: [Endpoint<'_>; 2],
    change: impl Fn(usize) -> f64,
    bends: [(f64, &[f64]); 3],
    pieces: &mut [f64],
) {
    write(h, ends, change, pieces, |i, nested| bend(nested, bends.map(|(theta, q2)| (theta, h * h * q2[i]))));
}

/// The change of each coordinate between two ends as they are.
fn differ(ends: [Endpoint<'_>; 2]) -> impl Fn(usize) -> f64 {
    move |i| ends[1].y[i] - ends[0].y[i]
}

/// What is known between the ends completes the polynomial of each coordinate.
fn write(
    h: f64,
    ends: [Endpoint<'_>; 2],
    change: impl Fn(usize) -> f64,
    pieces: &mut [f64],
    complete: impl Fn(usize, &mut [f64; BY_MIDDLE]),
) {
    let width = ends[0].y.len();
    let n = width / 2;
    let count = pieces.len().checked_div(width).unwrap_or(0);
    for i in 0..n {
        // (q, h q', h² q'') in units of q.
        let knot = |y: &[f64], rate: &[f64]| [y[i], h * y[n + i], h * h * rate[n + i]];
        let [start, end] = ends.map(|end| knot(end.y, end.rate));
        let mut nested = [0.0; BY_MIDDLE];
        nested[..BY_ENDS].copy_from_slice(&quintic(start, change(i), end));
        complete(i, &mut nested);
        let mut slope = derivative(&nested);
        slope.iter_mut().for_each(|r| *r /= h);
        // The ends are met to the last digit.
        slope[0] = ends[0].y[n + i];
        slope[1] = ends[1].y[n + i] - ends[0].y[n + i];
        nested[1] = end[0] - start[0];
        for (k, (place, speed)) in nested.iter().zip(slope).take(count).enumerate() {
            pieces[k * width + i] = *place;
            pieces[k * width + n + i] = speed;
        }
    }
}

/// r₀ … r₅ from values, slopes and second derivatives at θ = 0 and 1, between which the values change by so much.
fn quintic(start: [f64; 3], change: f64, end: [f64; 3]) -> [f64; BY_ENDS] {
    let (r2, r3) = (start[1] - change, 2.0 * change - start[1] - end[1]);
    let r4 = 0.5 * start[2] + r2 - r3;
    [start[0], change, r2, r3, r4, 0.5 * end[2] + r2 + 2.0 * r3 - r4]
}

/// Adds (θ(1−θ))³ (r₆ + θ(r₇ + (1−θ) r₈)), which vanishes thrice at the ends, so that the middle is met too.
fn correct(nested: &mut [f64; BY_MIDDLE], middle: [f64; 3]) {
    let monomials = expanded(nested);
    let [value, slope, bend] = [0, 1, 2].map(|order| middle[order as usize] - at(&monomials, 0.5, order));
    let r8 = -32.0 * (bend + 24.0 * value);
    let r7 = 64.0 * slope;
    nested[6..].copy_from_slice(&[64.0 * value - 0.5 * r7 - 0.25 * r8, r7, r8]);
}

/// Adds the same so that the second derivatives at 1/2 − s, 1/2 and 1/2 + s are these.
///
/// With u = θ(1−θ) = 1/4 − s² it is u³ (r₆ + r₇/2) + u⁴ r₈, which is even in s, and s u³ r₇, which is odd.  Their second
/// derivatives are (uᵐ)'' = 4m(m−1) s² uᵐ⁻² − 2m uᵐ⁻¹ and (s u³)'' = s u (42 s² − 9/2); the last is 0 at s² = 3/28, where
/// no point may lie.
fn bend(nested: &mut [f64; BY_MIDDLE], points: [(f64, f64); 3]) {
    let monomials = expanded(nested);
    let [before, middle, after] = points.map(|(theta, bend)| bend - at(&monomials, theta, 2));
    let s = points[2].0 - 0.5;
    let u = 0.25 - s * s;
    let (cube, fourth) = (24.0 * s * s * u - 6.0 * u * u, 48.0 * (s * u).powi(2) - 8.0 * u.powi(3));
    let even = 0.5 * (before + after);
    // Of u³ and u⁴ in the middle: −3/8 and −1/8.
    let r8 = (even * 0.375 + cube * middle) / (0.375 * fourth - 0.125 * cube);
    let r7 = 0.5 * (after - before) / (s * u * (42.0 * s * s - 4.5));
    nested[6..].copy_from_slice(&[-(middle + 0.125 * r8) / 0.375 - 0.5 * r7, r7, r8]);
}

/// The derivative of this order of Σ cₖθᵏ.
fn at(monomials: &[f64; BY_MIDDLE], theta: f64, order: i32) -> f64 {
    let falling = |k: usize| (0..order).map(|j| k as f64 - f64::from(j)).product::<f64>();
    let terms = monomials.iter().enumerate().skip(order as usize);
    terms.map(|(k, c)| c * falling(k) * theta.powi(k as i32 - order)).sum()
}

/// The derivative of a nested polynomial, nested.
fn derivative(nested: &[f64; BY_MIDDLE]) -> [f64; BY_MIDDLE] {
    let monomials = expanded(nested);
    let slope = std::array::from_fn(|k| monomials.get(k + 1).map_or(0.0, |c| (k + 1) as f64 * c));
    nest(slope)
}

/// Coefficients of 1, θ, θ², … of r₀ + θ(r₁ + (1−θ)(r₂ + θ(r₃ + …))).
fn expanded(nested: &[f64; BY_MIDDLE]) -> [f64; BY_MIDDLE] {
    let mut sum = [0.0; BY_MIDDLE];
    for index in (0..BY_MIDDLE).rev() {
        sum[0] += nested[index];
        let factor_of_end = index > 0 && index % 2 == 0;
        if index == 0 {
            break;
        }
        // Times θ, or times 1 − θ.
        for k in (0..BY_MIDDLE).rev() {
            let below = if k == 0 { 0.0 } else { sum[k - 1] };
            sum[k] = if factor_of_end { sum[k] - below } else { below };
        }
    }
    sum
}

/// The nested form of Σ cₖθᵏ: r₀, r₁, … are what divisions by θ and by 1 − θ in turn leave.
pub(crate) fn nest<const N: usize>(mut monomials: [f64; N]) -> [f64; N] {
    let mut nested = [0.0; N];
    for (index, r) in nested.iter_mut().enumerate() {
        if index % 2 == 0 {
            *r = monomials[0];
            monomials.rotate_left(1);
            monomials[N - 1] = 0.0;
        } else {
            // p(θ) = p(1) − (1 − θ) Σ (cₖ₊₁ + cₖ₊₂ + …) θᵏ.
            *r = monomials.iter().sum();
            let mut above = 0.0;
            for c in monomials.iter_mut().rev() {
                (*c, above) = (-above, above + *c);
            }
        }
    }
    nested
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::Segment;

    /// Dense output of q = t^degree over [1, 1.5], its errors in q and q' at a point inside.
    fn errors(degree: i32, with_middle: bool) -> [f64; 2] {
        let (t, h) = (1.0_f64, 0.5);
        let q = |t: f64| t.powi(degree);
        let v = |t: f64| f64::from(degree) * t.powi(degree - 1);
        let a = |t: f64| f64::from(degree * (degree - 1)) * t.powi(degree - 2);
        let states = [t, t + h, t + 0.5 * h].map(|t| ([q(t), v(t)], [v(t), a(t)]));
        let [start, end, middle] = &states;
        let ends = [start, end].map(|(y, rate)| Endpoint { y, rate, work: 0.0 });
        let mut pieces = vec![0.0; 2 * if with_middle { BY_MIDDLE } else { BY_ENDS }];
        if with_middle {
            write_by_middle(h, ends, (&middle.0, &middle.1), &mut pieces);
        } else {
            write_by_ends(h, ends, &mut pieces);
        }
        let segment = Segment { t, h, width: 2, pieces: &pieces };
        let mut out = [0.0; 2];
        segment.evaluate(0.3, &mut out);
        [out[0] - q(t + 0.3 * h), out[1] - v(t + 0.3 * h)].map(f64::abs)
    }

    #[test]
    fn polynomials_are_reproduced_from_their_second_derivatives() {
        let h = 0.5_f64;
        for degree in 0..=9 {
            let power = |falling: i32, t: f64| f64::from(falling) * t.powi(degree);
            let q = |t: f64| power(1, t);
            let v = |t: f64| power(degree, t) / t;
            let a = |t: f64| power(degree * (degree - 1), t) / (t * t);
            let [start, end] = [1.0, 1.0 + h].map(|t| ([q(t), v(t)], [v(t), a(t)]));
            let ends = [&start, &end].map(|(y, rate)| Endpoint { y, rate, work: 0.0 });
            let points = [0.3, 0.5, 0.7].map(|theta| (theta, [a(1.0 + theta * h)]));
            let mut pieces = [0.0; 2 * BY_MIDDLE];
            write_by_bends(
                h,
                ends,
                differ(ends),
                [0, 1, 2].map(|k| (points[k].0, points[k].1.as_slice())),
                &mut pieces,
            );
            let mut out = [0.0; 2];
            Segment { t: 1.0, h, width: 2, pieces: &pieces }.evaluate(0.4, &mut out);
            let (place, speed) = ((out[0] - q(1.2)).abs(), (out[1] - v(1.2)).abs());
            assert_eq!(place < 1e-12 && speed < 1e-10, degree <= 8, "degree {degree}: {place}, {speed}");
        }
    }

    #[test]
    fn polynomials_are_reproduced_up_to_their_degree() {
        for (with_middle, most) in [(false, 5), (true, 8)] {
            for degree in 0..=most {
                let [place, speed] = errors(degree, with_middle);
                assert!(place < 1e-13 && speed < 1e-11, "degree {degree}: {place}, {speed}");
            }
            assert!(errors(most + 1, with_middle)[0] > 1e-7);
        }
    }
}
