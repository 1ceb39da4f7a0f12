//! Steps of another run that steps of this one follow.

use std::sync::Arc;

/// The ends of another run's steps, and how many of them one step of this run spans.
///
/// With N(t) the number of steps that the other run took until t, linear within each, a step from t ends where N is `stretch` more.
/// Where steps are h(t) in one run and c h(t) in the other, errors of a method of order p are in the proportion 1 : cᵖ up to
/// terms of higher order in h, whatever the motion makes of them.
///
/// Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.8, theorem 8.1 and what follows it
/// on variable steps.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Followed {
    ends: Arc<[f64]>,
    stretch: f64,
}

impl Followed {
    /// Follows a run whose steps begin and end at these times, the start first; `None` if it took fewer steps than one spans.
    pub fn new(ends: &[f64], stretch: f64) -> Option<Self> {
        (ends.len() as f64 > stretch + 1.0).then(|| Followed { ends: ends.into(), stretch })
    }

    /// The longest step from t, s; where the other run has ended, as there.
    pub fn longest(&self, t: f64) -> f64 {
        let last = self.ends.len() - 1;
        let step = self.ends.partition_point(|end| *end <= t).clamp(1, last);
        let (from, to) = (self.ends[step - 1], self.ends[step]);
        let number = (step - 1) as f64 + (t - from) / (to - from) + self.stretch;
        let step = (number as usize).clamp(0, last - 1);
        let (from, to) = (self.ends[step], self.ends[step + 1]);
        from + (number - step as f64) * (to - from) - t
    }
}

#[cfg(test)]
mod tests {
    use super::Followed;

    #[test]
    fn a_step_spans_as_many_as_it_is_stretched_by() {
        let followed = Followed::new(&[0.0, 1.0, 2.0, 4.0, 8.0], 1.5).unwrap();
        // From 2.5, the second and a quarter, to the third and three quarters, 7; beyond the end steps are as long as the last.
        for (t, longest) in [(0.0, 1.5), (1.0, 2.0), (2.5, 4.5), (6.0, 6.0), (9.0, 6.0)] {
            assert!((followed.longest(t) - longest).abs() < 1e-12, "{t}: {}", followed.longest(t));
        }
        assert!(Followed::new(&[0.0, 1.0], 1.5).is_none());
    }
}
