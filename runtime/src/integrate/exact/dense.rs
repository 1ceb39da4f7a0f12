//! The polynomial between the ends of a step.

use super::step::Exact;

/// So many derivatives, from the zeroth on, are met at both ends.
pub(super) const DERIVATIVES: usize = 6;

/// Lobatto's nodes and weights on [0, 1], exact up to degree 11.
pub(super) const LOBATTO: [(f64, f64); 7] = [
    (0.0, 1.0 / 42.0),
    (0.084_888_051_860_716_53, 0.138_413_023_680_782_97),
    (0.265_575_603_264_642_9, 0.215_872_690_604_931_3),
    (0.5, 0.243_809_523_809_523_8),
    (0.734_424_396_735_357_1, 0.215_872_690_604_931_3),
    (0.915_111_948_139_283_5, 0.138_413_023_680_782_97),
    (1.0, 1.0 / 42.0),
];

/// h|λ| at which the polynomial misses a mode by this part of it: (h|λ|)^{2m}/((2m)! 4ᵐ) for m derivatives.
pub(super) fn resolved(tolerance: f64) -> f64 {
    let m = DERIVATIVES as u32;
    let factorial: f64 = (1..=2 * m).map(f64::from).product();
    (tolerance * factorial * 4f64.powi(m as i32)).powf(1.0 / f64::from(2 * m))
}

impl Exact {
    /// Hermite's polynomial through six derivatives at both ends, in Newton's form with the nodes 0, 1, 0, 1, …: piece k is the
    /// divided difference over the first k + 1 of them, with the sign that (1 − θ) for (θ − 1) asks.
    pub(super) fn write_dense(&mut self, h: f64) {
        let width = 2 * self.ends.n;
        self.write_derivatives(h);
        let [first, last] = &self.taylor;
        for j in 0..width {
            // f[0ⁱ, 1ʲ], built up from the derivatives over their factorials.
            let mut table = [[0.0; DERIVATIVES + 1]; DERIVATIVES + 1];
            for k in 0..DERIVATIVES {
                (table[k + 1][0], table[0][k + 1]) = (first[k * width + j], last[k * width + j]);
            }
            for i in 1..=DERIVATIVES {
                for k in 1..=DERIVATIVES {
                    table[i][k] = table[i - 1][k] - table[i][k - 1];
                }
            }
            for piece in 0..2 * DERIVATIVES {
                let (zeros, ones) = (piece / 2 + 1, piece.div_ceil(2));
                let sign = if (piece / 2) % 2 == 0 { 1.0 } else { -1.0 };
                self.pieces[piece * width + j] = sign * table[zeros][ones];
            }
        }
    }
}
