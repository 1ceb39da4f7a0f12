//! Gauss–Legendre quadrature on [−1, 1].

/// Nodes and weights of the n-point rule, exact for polynomials up to degree 2n − 1.
///
/// The nodes are the roots of the Legendre polynomial Pₙ, found by Newton's method from cos(π(k − ¼)/(n + ½));
/// the weights are 2/((1 − x²) Pₙ'(x)²).  Source: Abramowitz and Stegun (1964), 25.4.29.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let node = |k: usize| {
        let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        for _ in 0..100 {
            let (value, slope) = legendre(n, x);
            let step = value / slope;
            x -= step;
            if step.abs() <= 1e-16 {
                break;
            }
        }
        x
    };
    let rule = |k: usize| {
        // The rule is symmetric: its negative half mirrors the positive one, and an odd rule has a node at 0.
        let mirrored = n - 1 - k;
        let x = match k.cmp(&mirrored) {
            std::cmp::Ordering::Less => node(k),
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => -node(mirrored),
        };
        let (_, slope) = legendre(n, x);
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(rule).collect()
}

/// Pₙ(x) and Pₙ'(x) by the three-term recurrence, for |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut current) = (1.0, x);
    if n == 0 {
        return (1.0, 0.0);
    }
    for k in 2..=n {
        let k = k as f64;
        (previous, current) = (current, ((2.0 * k - 1.0) * x * current - (k - 1.0) * previous) / k);
    }
    let slope = n as f64 * (previous - x * current) / (1.0 - x * x);
    (current, slope)
}

#[cfg(test)]
mod tests {
    use super::gauss_legendre;

    #[test]
    fn exact_up_to_degree_31() {
        for n in 1..=16 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert!((sum - exact).abs() < 4e-15, "{n} points, degree {degree}: {sum} {exact}");
            }
        }
    }

    #[test]
    fn two_points_are_at_the_roots_of_a_third() {
        let rule = gauss_legendre(2);
        assert!((rule[0].0 - (1.0_f64 / 3.0).sqrt()).abs() < 1e-16);
        assert_eq!(rule[0].0, -rule[1].0);
    }
}
