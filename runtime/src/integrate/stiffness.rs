//! Whether a step is limited by stability instead of accuracy.

/// Counts steps at whose end h|λ| is near the method's stability limit.
///
/// Source: Hairer and Wanner, Solving Ordinary Differential Equations II (1996), section IV.2.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StiffnessDetector {
    limit: f64,
    near: u32,
    away: u32,
}

impl StiffnessDetector {
    /// For a method that is stable on the negative real axis up to about `limit`.
    pub fn new(limit: f64) -> Self {
        StiffnessDetector { limit, near: 0, away: 0 }
    }

    /// What h|λ| says something from: the dense output of such steps is poor.
    pub fn least(&self) -> f64 {
        0.25 * self.limit
    }

    /// How long a step may be, s, within which the dense output is good too, after one of `h` with this h|λ|.
    ///
    /// A run to compare with takes such: where the motion settles, steps grow until stability limits them, and between their
    /// ends they are off by some hundred times what they are at them.
    pub fn between_ends(&self, h: f64, step_times_rate: f64) -> f64 {
        let most = 2.0 * self.least();
        if step_times_rate > most { h * most / step_times_rate } else { f64::INFINITY }
    }

    /// Notes a step; true once fifteen were near the limit, with fewer than six others in a row between them.
    pub fn observe(&mut self, step_times_rate: f64) -> bool {
        if step_times_rate > self.limit {
            self.away = 0;
            self.near += 1;
        } else {
            self.away += 1;
            if self.away == 6 {
                self.near = 0;
            }
        }
        self.near >= 15
    }
}
