//! Taylor coefficients of M, h, J and γ along a motion, order by order.

use super::{Recurrence, Series};

/// Coefficients of all rows of a [`Series`], up to an order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Jets {
    width: usize,
    /// xₖ, one row after the other.
    forward: Vec<f64>,
    /// The same backwards: xₖ at the place `width` − 1 − k.
    backward: Vec<f64>,
    /// k xₖ.
    rates: Vec<f64>,
}

/// Coefficients of a motion: time in units of a step, q and q' in SI.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionJets<'a> {
    /// s.
    pub t: f64,
    /// The unit of time, s.
    pub unit: f64,
    /// Of q, then of q', with as many numbers each as `width` says.
    pub state: &'a [f64],
    pub width: usize,
    pub n: usize,
}

impl Jets {
    /// Makes room for the coefficients of orders 0 to `order`.
    pub fn new(rows: usize, order: usize) -> Jets {
        let room = || vec![0.0; rows * (order + 1)];
        Jets { width: order + 1, forward: room(), backward: room(), rates: room() }
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.forward.len() / self.width.max(1)
    }

    /// A row's coefficients.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.forward[row * self.width..(row + 1) * self.width]
    }

    /// A row's coefficient.
    pub fn get(&self, row: usize, k: usize) -> f64 {
        self.forward[row * self.width + k]
    }

    /// Σ aⱼ bₖ₋ⱼ from j = `from` to `to`.
    fn convolve(&self, a: &[f64], b: usize, k: usize, (from, to): (usize, usize)) -> f64 {
        let last = (b + 1) * self.width - 1 - k;
        dot(&a[from..=to], &self.backward[last + from..=last + to])
    }

    /// Coefficients of order k of all rows, those of lower orders being there.
    pub fn extend(&mut self, series: &Series, constants: &[f64], motion: MotionJets<'_>, k: usize) {
        let width = self.width;
        for (row, recurrence) in series.rows.iter().enumerate() {
            let value = self.coefficient(row, *recurrence, constants, motion, k);
            self.forward[row * width + k] = value;
            self.backward[(row + 1) * width - 1 - k] = value;
            self.rates[row * width + k] = k as f64 * value;
        }
    }

    #[inline]
    fn coefficient(&self, row: usize, recurrence: Recurrence, c: &[f64], motion: MotionJets<'_>, k: usize) -> f64 {
        let width = self.width;
        let of = |row: usize| &self.forward[row * width..(row + 1) * width];
        let rates = |row: usize| &self.rates[row * width..(row + 1) * width];
        let at = |row: usize| self.forward[row * width + k];
        let first = k == 0;
        let order = k as f64;
        match recurrence {
            Recurrence::Time => match k {
                0 => motion.t,
                1 => motion.unit,
                _ => 0.0,
            },
            Recurrence::Coordinate(i) => motion.state[i * motion.width + k],
            Recurrence::Speed(i) => motion.state[(motion.n + i) * motion.width + k],
            Recurrence::Constant(constant) if first => c[constant],
            Recurrence::Constant(_) => 0.0,
            Recurrence::Sum(a, b) => at(a) + at(b),
            Recurrence::Difference(a, b) => at(a) - at(b),
            Recurrence::Negative(a) => -at(a),
            Recurrence::Shifted(a, constant) if first => at(a) + c[constant],
            Recurrence::Reduced(a, constant) if first => at(a) - c[constant],
            Recurrence::Shifted(a, _) | Recurrence::Reduced(a, _) => at(a),
            Recurrence::Scaled(a, constant) => c[constant] * at(a),
            Recurrence::Parted(a, constant) => at(a) / c[constant],
            Recurrence::Product(a, b) => self.convolve(of(a), b, k, (0, k)),
            Recurrence::Square(a) => {
                let half = k.div_ceil(2);
                let pairs = if half > 0 { self.convolve(of(a), a, k, (0, half - 1)) } else { 0.0 };
                let middle = if k.is_multiple_of(2) { of(a)[k / 2] } else { 0.0 };
                2.0 * pairs + middle * middle
            }
            Recurrence::Quotient(a, b) if first => of(a)[0] / of(b)[0],
            // b₀ sₖ = aₖ − Σ sⱼ bₖ₋ⱼ.
            Recurrence::Quotient(a, b) => (at(a) - self.convolve(of(row), b, k, (0, k - 1))) / of(b)[0],
            Recurrence::Root(a) if first => of(a)[0].sqrt(),
            Recurrence::Root(a) => {
                // 2 s₀ sₖ = aₖ − Σ sⱼ sₖ₋ⱼ over 0 < j < k.
                let among = if k > 1 { self.convolve(of(row), row, k, (1, k - 1)) } else { 0.0 };
                (at(a) - among) / (2.0 * of(row)[0])
            }
            Recurrence::Power(a, constant) if first => of(a)[0].powf(c[constant]),
            Recurrence::Power(a, constant) => {
                // k a₀ sₖ = Σ (c j − (k − j)) aⱼ sₖ₋ⱼ = (c + 1) Σ j aⱼ sₖ₋ⱼ − k Σ aⱼ sₖ₋ⱼ over 0 < j ≤ k.
                let moved = self.convolve(rates(a), row, k, (1, k));
                let plain = self.convolve(of(a), row, k, (1, k));
                ((c[constant] + 1.0) * moved - order * plain) / (order * of(a)[0])
            }
            Recurrence::Grown { function, of: a, .. } | Recurrence::Divided { function, of: a, .. } if first => {
                function(of(a)[0])
            }
            // k sₖ = ± Σ j aⱼ gₖ₋ⱼ.
            Recurrence::Grown { of: a, by, falls, .. } => {
                let sum = self.convolve(rates(a), by, k, (1, k)) / order;
                if falls { -sum } else { sum }
            }
            // k g₀ sₖ = ± k aₖ − Σ j sⱼ gₖ₋ⱼ over 0 < j < k.
            Recurrence::Divided { of: a, by, falls, .. } => {
                let moved = if falls { -at(a) } else { at(a) };
                let among = if k > 1 { self.convolve(rates(row), by, k, (1, k - 1)) } else { 0.0 };
                (moved - among / order) / of(by)[0]
            }
            Recurrence::Angle { y, x, .. } if first => of(y)[0].atan2(of(x)[0]),
            // (x² + y²) s' = x y' − y x'.
            Recurrence::Angle { y, x, square } => {
                let turned = self.convolve(rates(y), x, k, (1, k)) - self.convolve(rates(x), y, k, (1, k));
                let among = if k > 1 { self.convolve(rates(row), square, k, (1, k - 1)) } else { 0.0 };
                (turned - among) / (order * of(square)[0])
            }
        }
    }
}

/// Σ aᵢ bᵢ, in four sums.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (a_blocks, b_blocks) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a_blocks.remainder().iter().zip(b_blocks.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a_blocks.zip(b_blocks) {
        for lane in 0..4 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}
