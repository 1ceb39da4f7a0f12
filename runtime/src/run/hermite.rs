//! The polynomial through values, slopes and second derivatives.

/// A function at x.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Knot {
    pub x: f64,
    pub value: f64,
    pub slope: f64,
    /// The second derivative.
    pub bend: f64,
}

/// Conditions that four knots are.
const MOST: usize = 12;

/// Value and slope at x = 0 of the polynomial through up to four knots at different x, of degree 11 through four.
///
/// Newton's form on threefold nodes: divided differences whose nodes are the same are derivatives (Stoer and Bulirsch,
/// Introduction to Numerical Analysis, section 2.1.5).
pub(super) fn hermite(knots: &[Knot]) -> (f64, f64) {
    let (node, size) = (|i: usize| &knots[i / 3], 3 * knots.len());
    let mut differences = [0.0; MOST];
    differences[..size].iter_mut().enumerate().for_each(|(i, difference)| *difference = node(i).value);
    for order in 1..size {
        // From the end, so that those of the order before are still there.
        for i in (order..size).rev() {
            let (from, to) = (node(i - order), node(i));
            differences[i] = match (i / 3 == (i - order) / 3, order) {
                (true, 1) => to.slope,
                (true, _) => 0.5 * to.bend,
                (false, _) => (differences[i] - differences[i - 1]) / (to.x - from.x),
            };
        }
    }
    // Horner's scheme at 0 for the value and its derivative together.
    let (mut value, mut slope) = (0.0, 0.0);
    for i in (0..size).rev() {
        slope = value - node(i).x * slope;
        value = differences[i] - node(i).x * value;
    }
    (value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_degree_eleven_is_met() {
        let derivative = |order: i32, x: f64| -> f64 {
            // Σ xᵏ/(k + 1), differentiated.
            (order..12)
                .map(|k| {
                    let factor: f64 = (0..order).map(|j| f64::from(k - j)).product();
                    factor * x.powi(k - order) / f64::from(k + 1)
                })
                .sum()
        };
        for at in [-0.4, 0.03, 0.5, 1.3] {
            let knots = [-1.0, -0.3, 0.4, 1.7].map(|x| Knot {
                x: x - at,
                value: derivative(0, x),
                slope: derivative(1, x),
                bend: derivative(2, x),
            });
            let (value, slope) = hermite(&knots);
            let scale = derivative(0, 1.7);
            assert!((value - derivative(0, at)).abs() < 1e-13 * scale, "{at}: {value}");
            assert!((slope - derivative(1, at)).abs() < 1e-12 * scale, "{at}: {slope}");
        }
    }
}
