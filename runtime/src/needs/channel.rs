//! A quantity known at equal times, twice differentiable between them.

/// f, f' and f'' at each of equally spaced times.
pub(super) struct Channel {
    from: f64,
    step: f64,
    nodes: Vec<[f64; 3]>,
}

/// Weights of five neighbours for h f' and h² f'' at each of them, twelvefold (Fornberg, Math. Comp. 51, 1988).
const FIRST: [[f64; 5]; 5] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];
const SECOND: [[f64; 5]; 5] = [
    [35.0, -104.0, 114.0, -56.0, 11.0],
    [11.0, -20.0, 6.0, 4.0, -1.0],
    [-1.0, 16.0, -30.0, 16.0, -1.0],
    [-1.0, 4.0, 6.0, -20.0, 11.0],
    [11.0, -56.0, 114.0, -104.0, 35.0],
];

impl Channel {
    /// Of values at equal times, with slopes from polynomials of degree 4; `None` of fewer than five.
    pub fn of_values((from, step): (f64, f64), values: &[f64]) -> Option<Channel> {
        let last = values.len().checked_sub(FIRST.len())?;
        let node = |(place, value): (usize, &f64)| {
            let start = place.saturating_sub(2).min(last);
            let weigh = |weights: &[[f64; 5]; 5]| -> f64 {
                weights[place - start].iter().zip(&values[start..]).map(|(weight, value)| weight * value).sum::<f64>()
                    / 12.0
            };
            [*value, weigh(&FIRST) / step, weigh(&SECOND) / (step * step)]
        };
        Some(Channel { from, step, nodes: values.iter().enumerate().map(node).collect() })
    }

    /// Of values with their slopes.
    pub fn of_nodes((from, step): (f64, f64), nodes: Vec<[f64; 3]>) -> Channel {
        Channel { from, step, nodes }
    }

    pub fn nodes(&self) -> &[[f64; 3]] {
        &self.nodes
    }

    /// (f, f', f'') at a time, from the polynomial of degree 5 that has all three at both neighbours.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let h = self.step;
        let place = ((t - self.from) / h).floor().clamp(0.0, (self.nodes.len() - 2) as f64) as usize;
        let x = (t - self.from) / h - place as f64;
        let [f, df, ddf] = self.nodes[place];
        let [g, dg, ddg] = self.nodes[place + 1];
        let low = [f, h * df, 0.5 * h * h * ddf];
        let rest = [g - low[0] - low[1] - low[2], h * dg - low[1] - 2.0 * low[2], h * h * ddg - 2.0 * low[2]];
        let c = [
            low[0],
            low[1],
            low[2],
            10.0 * rest[0] - 4.0 * rest[1] + 0.5 * rest[2],
            -15.0 * rest[0] + 7.0 * rest[1] - rest[2],
            6.0 * rest[0] - 3.0 * rest[1] + 0.5 * rest[2],
        ];
        let mut found = [0.0; 3];
        for c in c.into_iter().rev() {
            // Horner's rule for the value and both slopes at once.
            found[2] = found[2] * x + 2.0 * found[1];
            found[1] = found[1] * x + found[0];
            found[0] = found[0] * x + c;
        }
        [found[0], found[1] / h, found[2] / (h * h)]
    }

    /// Whether the times are dense enough: fourth differences are a small part of the range.
    pub fn is_resolved(&self) -> bool {
        const PART: f64 = 0.02;
        const ROUNDING: f64 = 1e-11;
        let values = || self.nodes.iter().map(|node| node[0]);
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let rough = |five: &[[f64; 3]]| {
            (five[0][0] - 4.0 * five[1][0] + 6.0 * five[2][0] - 4.0 * five[3][0] + five[4][0]).abs()
        };
        let most = self.nodes.windows(5).map(rough).fold(0.0, f64::max);
        most <= PART * (high - low) || most <= ROUNDING * low.abs().max(high.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::Channel;

    #[test]
    fn slopes_are_those_of_the_function() {
        let step = 0.05;
        let values: Vec<f64> = (0..60).map(|k| (1.0 + f64::from(k) * step).sin()).collect();
        let channel = Channel::of_values((1.0, step), &values).unwrap();
        assert!(channel.is_resolved());
        for t in [1.0_f64, 1.013, 2.5, 3.949, 3.95] {
            let exact = [t.sin(), t.cos(), -t.sin()];
            for (found, exact) in channel.at(t).iter().zip(exact) {
                // At the ends f'' is of third order: 5/6 h³.
                assert!((found - exact).abs() < 1e-4, "{t}: {found} {exact}");
            }
        }
        let rough: Vec<f64> = (0..60).map(|k| (3.0 * f64::from(k)).sin()).collect();
        assert!(!Channel::of_values((0.0, 1.0), &rough).unwrap().is_resolved());
        assert!(Channel::of_values((0.0, 1.0), &rough[..4]).is_none());
    }
}
