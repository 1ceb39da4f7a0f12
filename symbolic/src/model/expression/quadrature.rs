//! Rules of quadrature, in double-double.

use std::sync::OnceLock;

use crate::number::DoubleDouble;

/// Nodes on [−1, 1] and weights of the n-point rule of Gauss and Legendre, exact for polynomials up to degree 2n − 1;
/// n is at most [`LARGEST`].
///
/// The nodes are the roots of the Legendre polynomial Pₙ, found by Newton's method from cos(π(k − ¼)/(n + ½));
/// the weights are 2/((1 − x²) Pₙ'(x)²).  Source: Abramowitz and Stegun (1964), 25.4.29.
pub fn gauss_legendre(n: usize) -> &'static [(DoubleDouble, DoubleDouble)] {
    static RULES: [OnceLock<Vec<(DoubleDouble, DoubleDouble)>>; LARGEST + 1] = [const { OnceLock::new() }; LARGEST + 1];
    RULES[n.min(LARGEST)].get_or_init(|| {
        let rule = |k: usize| {
            // The rule is symmetric: its negative half mirrors the positive one, and an odd rule has a node at 0.
            let mirrored = n - 1 - k;
            let x = match k.cmp(&mirrored) {
                std::cmp::Ordering::Less => root_of_legendre(n, k),
                std::cmp::Ordering::Equal => DoubleDouble::ZERO,
                std::cmp::Ordering::Greater => -root_of_legendre(n, mirrored),
            };
            let (_, slope) = legendre(n, x);
            (x, DoubleDouble::from(2.0) / ((-(x * x) + 1.0) * slope * slope))
        };
        (0..n).map(rule).collect()
    })
}

/// Points of the largest rule of Gauss, and steps to a unit of the densest rule of Takahasi and Mori.
pub const LARGEST: usize = 512;

/// The k-th largest root, by Newton's method: a step doubles the digits.
fn root_of_legendre(n: usize, k: usize) -> DoubleDouble {
    let mut x = DoubleDouble::from((std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos());
    for _ in 0..100 {
        let (value, slope) = legendre(n, x);
        let step = value / slope;
        x = x - step;
        if step.to_f64().abs() <= 1e-18 {
            break;
        }
    }
    x
}

/// Pₙ(x) and Pₙ'(x) by the three-term recurrence, for |x| < 1.
fn legendre(n: usize, x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let (mut previous, mut current) = (DoubleDouble::ONE, x);
    if n == 0 {
        return (DoubleDouble::ONE, DoubleDouble::ZERO);
    }
    for k in 2..=n {
        let k = k as f64;
        let next = (x * current * (2.0 * k - 1.0) - previous * (k - 1.0)) / DoubleDouble::from(k);
        (previous, current) = (current, next);
    }
    let slope = (previous - x * current) * (n as f64) / (-(x * x) + 1.0);
    (current, slope)
}

/// Nodes and weights on [0, 1] of the rule of Takahasi and Mori (1974), x = (1 + tanh(π/2 sinh t))/2 for t in steps of
/// 1/`density`: a node is given by its distance from the nearer end, and by whether that is the right one.  Exact to
/// rounding for functions that are analytic inside, with any integrable powers and logarithms at the ends.
pub fn tanh_sinh(density: usize) -> &'static [(DoubleDouble, bool, DoubleDouble)] {
    /// Where distances are 1e-70, so that a root's inverse has 35 digits.
    const REACH: f64 = 4.63;
    static RULES: [OnceLock<Vec<(DoubleDouble, bool, DoubleDouble)>>; LARGEST + 1] =
        [const { OnceLock::new() }; LARGEST + 1];
    RULES[density.min(LARGEST)].get_or_init(|| {
        let last = (REACH * density as f64).floor() as i64;
        let step = DoubleDouble::ONE / DoubleDouble::from(density as f64);
        let node = |k: i64| {
            let t = step * k.unsigned_abs() as f64;
            let tail = (DoubleDouble::PI * -t.sinh()).exp();
            let below = tail + 1.0;
            (tail / below, k > 0, step * DoubleDouble::PI * t.cosh() * tail / (below * below))
        };
        (-last..=last).map(node).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_up_to_degree_31() {
        for n in 1..=16 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let power = |x: DoubleDouble| (0..degree).fold(DoubleDouble::ONE, |power, _| power * x);
                let sum = rule.iter().fold(DoubleDouble::ZERO, |sum, (x, w)| sum + *w * power(*x));
                let exact =
                    if degree % 2 == 0 { DoubleDouble::from(2.0) / ((degree + 1) as f64).into() } else { 0.0.into() };
                assert!((sum - exact).abs().to_f64() < 1e-30, "{n} points, degree {degree}: {sum:?} {exact:?}");
            }
        }
    }

    #[test]
    fn two_points_are_at_the_roots_of_a_third() {
        let rule = gauss_legendre(2);
        let root = (DoubleDouble::ONE / 3.0.into()).sqrt();
        assert!((rule[0].0 - root).abs().to_f64() < 1e-31);
        assert_eq!(rule[0].0, -rule[1].0);
    }

    #[test]
    fn inverse_roots_and_logarithms_at_an_end_are_integrated() {
        let integrate = |f: fn(DoubleDouble) -> DoubleDouble| {
            let term = |&(distance, right, weight): &(DoubleDouble, bool, DoubleDouble)| {
                weight * f(if right { -distance + 1.0 } else { distance })
            };
            tanh_sinh(16).iter().map(term).fold(DoubleDouble::ZERO, |sum, term| sum + term)
        };
        let near = |found: DoubleDouble, exact: f64| (found + -exact).abs().to_f64() < 1e-28;
        assert!(near(integrate(|x| DoubleDouble::ONE / x.sqrt()), 2.0));
        assert!(near(integrate(DoubleDouble::ln), -1.0));
        assert!(near(integrate(DoubleDouble::sqrt) * 3.0, 2.0));
    }
}
